//! What lies behind a score: truth against answer, curves over strength, pairs, intervals, mistakes.

use std::collections::BTreeMap;
use std::fmt::Write;

use crate::hidden::{CATALOGUE, LEVELS, OUTSIDE, What};

use super::outcome::Outcome;
use super::rate::{lower95, share, upper95};
use super::table::{Score, is_catalogue, is_outside};
use super::{Scored, strength};

/// Edges between the classes of strength, in standard deviations; one is where an effect counts as visible.
const EDGES: [f64; 4] = [2.0, strength::SEEN, 8.0, 20.0];

impl Score<'_> {
    /// Truth against answer.
    #[must_use]
    pub fn confusion(&self) -> String {
        let mut text = "| hidden | cases | visible | exact | silent, rightly | in set | unknown | missed | wrong name | refused | other names given |\n\
            |---|---|---|---|---|---|---|---|---|---|---|\n"
            .to_owned();
        let mut keys = vec!["clean".to_owned()];
        keys.extend(CATALOGUE.iter().chain(&OUTSIDE).map(|code| (*code).to_owned()));
        keys.extend(["placebo".to_owned(), "deleted".to_owned()]);
        for key in keys {
            let own: Vec<&Scored> = self.list.iter().filter(|s| hidden(s) == Some(key.as_str())).collect();
            if own.is_empty() {
                continue;
            }
            let of = |list: &[Outcome]| own.iter().filter(|s| list.contains(&s.outcome)).count();
            let mut others: BTreeMap<String, usize> = BTreeMap::new();
            for s in &own {
                for finding in s.answer.findings.iter().filter(|f| f.code != key) {
                    let set: Vec<&str> =
                        std::iter::once(finding.code).chain(finding.ambiguous_with.iter().copied()).collect();
                    *others.entry(set.join("/")).or_default() += 1;
                }
            }
            let others: Vec<String> = others.iter().map(|(set, count)| format!("{set} {count}")).collect();
            let _ = writeln!(
                text,
                "| {key} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} |",
                own.len(),
                own.iter().filter(|s| s.any_visible()).count(),
                of(&[Outcome::Exact, Outcome::CleanRight]),
                of(&[Outcome::SilentRight]),
                of(&[Outcome::InSet, Outcome::OtherForm]),
                of(&[Outcome::Unknown, Outcome::OutsideUnknown]),
                of(&[Outcome::Missed, Outcome::OutsideClean]),
                of(&[Outcome::Wrong, Outcome::FalseAlarm]),
                of(&[Outcome::Refused]),
                others.join(", "),
            );
        }
        text
    }

    /// Effects of the catalogue by level.
    #[must_use]
    pub fn by_level(&self) -> String {
        let classes: Vec<(String, Vec<&Scored>)> = (0..LEVELS)
            .map(|level| {
                let own = |s: &&Scored| matches!(s.truth.what, What::Catalogue(_, l) if l == level);
                (format!("{level}"), self.list.iter().filter(own).collect())
            })
            .collect();
        curve("level", &classes)
    }

    /// Effects of the catalogue, and those from outside it, by how far they move the data.
    #[must_use]
    pub fn by_strength(&self) -> String {
        let catalogue = self.classes(is_catalogue);
        let mut text = curve("strength (standard deviations)", &catalogue);
        text.push_str("\n| strength, outside the catalogue | cases | unknown | missed | right cause, other form | wrong name |\n|---|---|---|---|---|---|\n");
        for (name, own) in self.classes(is_outside) {
            let of = |outcome: Outcome| own.iter().filter(|s| s.outcome == outcome).count().to_string();
            let counts = [Outcome::OutsideUnknown, Outcome::OutsideClean, Outcome::OtherForm, Outcome::Wrong].map(of);
            let _ = writeln!(text, "| {name} | {} | {} |", own.len(), counts.join(" | "));
        }
        text
    }

    /// Cases of one kind by how far what is hidden moves the data.
    fn classes(&self, kind: fn(&Scored) -> bool) -> Vec<(String, Vec<&Scored>)> {
        let ends = |class: usize| {
            let low = if class == 0 { 0.0 } else { EDGES[class - 1] };
            (low, EDGES.get(class).copied().unwrap_or(f64::INFINITY))
        };
        (0..=EDGES.len())
            .map(|class| {
                let (low, high) = ends(class);
                let within = |s: &&Scored| {
                    kind(s) && s.strength.as_ref().and_then(|s| s.first()).is_some_and(|s| *s > low && *s <= high)
                };
                let name = if high.is_finite() { format!("{low:.1} to {high:.1}") } else { format!("above {low:.1}") };
                (name, self.list.iter().filter(within).collect())
            })
            .collect()
    }

    /// Pairs.
    #[must_use]
    pub fn pairs(&self) -> String {
        let mut text =
            "| pair | cases | both visible | both | one | none | wrong |\n|---|---|---|---|---|---|---|\n".to_owned();
        for codes in crate::hidden::PAIRS {
            let own: Vec<&Scored> =
                self.list.iter().filter(|s| matches!(&s.truth.what, What::Pair(c, _) if *c == codes)).collect();
            if own.is_empty() {
                continue;
            }
            let of = |outcome: Outcome| own.iter().filter(|s| s.outcome == outcome).count();
            let _ = writeln!(
                text,
                "| {} | {} | {} | {} | {} | {} | {} |",
                codes.join(" + "),
                own.len(),
                own.iter().filter(|s| s.all_visible()).count(),
                of(Outcome::Both),
                of(Outcome::One),
                of(Outcome::Neither),
                of(Outcome::Wrong),
            );
        }
        text
    }

    /// Coverage of intervals, parameter by parameter.
    #[must_use]
    pub fn coverage(&self) -> String {
        let mut found: BTreeMap<&str, Vec<&super::Hit>> = BTreeMap::new();
        for hit in self.list.iter().flat_map(|s| &s.hits) {
            found.entry(hit.name).or_default().push(hit);
        }
        let mut text = "| parameter | intervals that hold the truth | 95 % bounds of the share | of right answers | mean of (estimate - truth)/error |\n\
            |---|---|---|---|---|\n"
            .to_owned();
        for (name, hits) in found {
            let held = hits.iter().filter(|h| h.held).count();
            let right = hits.iter().filter(|h| h.right).count();
            let rightly = hits.iter().filter(|h| h.right && h.held).count();
            let mean = hits.iter().map(|h| h.deviation).sum::<f64>() / hits.len() as f64;
            let _ = writeln!(
                text,
                "| {name} | {} | {:.0} to {:.0} % | {} | {mean:+.2} |",
                share(held, hits.len()),
                100.0 * lower95(held, hits.len()),
                100.0 * upper95(held, hits.len()),
                share(rightly, right),
            );
        }
        text
    }

    /// Every case with a false alarm, a wrong name or no diagnosis.
    #[must_use]
    pub fn mistakes(&self) -> String {
        let mut text = "False alarms, wrong names and refusals:\n\n".to_owned();
        let wrong = |s: &&Scored| matches!(s.outcome, Outcome::Wrong | Outcome::FalseAlarm | Outcome::Refused);
        let mut none = true;
        for s in self.list.iter().filter(wrong) {
            none = false;
            let strength: Vec<String> = s.strength.iter().flatten().map(|s| format!("{s:.1}")).collect();
            let (design, seed, what, noise) = (s.design.name(), s.seed, &s.truth.what, s.truth.noise);
            let _ = writeln!(
                text,
                "- {design} {seed}: {what:?}, {noise:?} noise, strength {}: {}",
                strength.join(" "),
                s.answer.line()
            );
        }
        if none {
            text.push_str("none.\n");
        }
        text
    }
}
/// Exact, in a set, and the rest over classes of cases.
fn curve(variable: &str, classes: &[(String, Vec<&Scored>)]) -> String {
    let mut text = format!(
        "| {variable} | cases | exact | silent, rightly | in set | unknown | missed | wrong name |\n|---|---|---|---|---|---|---|---|\n"
    );
    for (name, own) in classes {
        let of = |outcome: Outcome| own.iter().filter(|s| s.outcome == outcome).count();
        let counts =
            [Outcome::Exact, Outcome::SilentRight, Outcome::InSet, Outcome::Unknown, Outcome::Missed, Outcome::Wrong];
        let counts: Vec<String> = counts.into_iter().map(|outcome| of(outcome).to_string()).collect();
        let _ = writeln!(text, "| {name} | {} | {} |", own.len(), counts.join(" | "));
    }
    text
}

/// Row of the confusion table.
fn hidden(s: &Scored) -> Option<&'static str> {
    match s.truth.what {
        What::Clean => Some("clean"),
        What::Catalogue(code, _) | What::Outside(code, _) => Some(code),
        What::Deleted(..) => Some("deleted"),
        What::Placebo(_) => Some("placebo"),
        What::Pair(..) => None,
    }
}
