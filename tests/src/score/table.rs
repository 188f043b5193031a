//! Scores added up: tables in Markdown.

use std::collections::BTreeMap;
use std::fmt::Write;

use crate::hidden::{CATALOGUE, Design, LEVELS, NoiseKind, OUTSIDE, What};

use super::outcome::Outcome;
use super::rate::{lower95, percent, share, upper95};
use super::{Scored, oracle};

/// What a surrogate study of the algorithm reached, percent (DIAGNOSIS.md): false alarm, exact, in a set, wrong name, outside unknown.
fn surrogate(design: Design) -> [u32; 5] {
    match design {
        Design::D6 => [10, 24, 21, 5, 81],
        Design::D18 => [2, 42, 21, 1, 80],
        Design::D36 => [0, 58, 21, 1, 100],
        Design::D60 => [0, 65, 20, 1, 100],
    }
}

/// Edges between the classes of strength, in standard deviations; one is where an effect counts as visible.
const EDGES: [f64; 4] = [2.0, oracle::SEEN, 8.0, 20.0];

/// Scores to be added up.
#[derive(Debug, Clone, Copy)]
pub struct Score<'a> {
    /// The scores, in any order.
    pub list: &'a [Scored],
}

impl Score<'_> {
    fn count(&self, within: impl Fn(&Scored) -> bool) -> usize {
        self.list.iter().filter(|s| within(s)).count()
    }

    fn designs(&self) -> Vec<Design> {
        Design::ALL.into_iter().filter(|d| self.list.iter().any(|s| s.design == *d)).collect()
    }

    /// Everything, as Markdown.
    #[must_use]
    pub fn markdown(&self) -> String {
        let parts = [
            self.by_design(),
            self.goals(),
            self.confusion(),
            self.by_level(),
            self.by_strength(),
            self.pairs(),
            self.coverage(),
            self.mistakes(),
        ];
        parts.join("\n")
    }

    /// One row a design.
    #[must_use]
    pub fn by_design(&self) -> String {
        let mut text = "Percent of the cases; what the surrogate study reached in brackets.\n\n\
            | design | cases | false alarm (upper 95 %) | exact | in set | wrong name | outside, visible: unknown | s a diagnosis: median, worst |\n\
            |---|---|---|---|---|---|---|---|\n"
            .to_owned();
        for design in self.designs() {
            let of = |within: &dyn Fn(&Scored) -> bool| self.count(|s| s.design == design && within(s));
            let clean = of(&|s| s.truth.what == What::Clean);
            let alarms = of(&|s| s.outcome == Outcome::FalseAlarm);
            let catalogue = of(&is_catalogue);
            let exact = of(&|s| matches!(s.outcome, Outcome::Exact | Outcome::SilentRight));
            let in_set = of(&|s| s.outcome == Outcome::InSet);
            let wrong = of(&|s| is_catalogue(s) && s.outcome == Outcome::Wrong);
            let outside = of(&|s| is_outside(s) && s.any_visible());
            let unknown = of(&|s| is_outside(s) && s.any_visible() && s.outcome == Outcome::OutsideUnknown);
            let [a, b, c, d, e] = surrogate(design);
            let mut seconds: Vec<f64> =
                self.list.iter().filter(|s| s.design == design).map(|s| s.answer.seconds).collect();
            seconds.sort_by(f64::total_cmp);
            let middle = seconds.get(seconds.len() / 2).copied().unwrap_or(0.0);
            let worst = seconds.last().copied().unwrap_or(0.0);
            let _ = writeln!(
                text,
                "| {} | {} | {} of {clean}: {:.0} (<= {:.1}) [{a}] | {:.0} [{b}] | {:.0} [{c}] | {:.1} [{d}] | {} [{e}] | {middle:.1}, {worst:.1} |",
                design.name(),
                of(&|_| true),
                alarms,
                percent(alarms, clean),
                100.0 * upper95(alarms, clean),
                percent(exact, catalogue),
                percent(in_set, catalogue),
                percent(wrong, catalogue),
                share(unknown, outside),
            );
        }
        text
    }

    /// The goals of the whole suite, each met or not.
    #[must_use]
    pub fn goals(&self) -> String {
        let mut text = "| goal | measured | |\n|---|---|---|\n".to_owned();
        let mut row = |goal: &str, measured: String, met: Option<bool>| {
            let word = met.map_or("no cases", |met| if met { "met" } else { "MISSED" });
            let _ = writeln!(text, "| {goal} | {measured} | {word} |");
        };
        let judged = |cases: usize, met: bool| (cases > 0).then_some(met);
        for (kind, noise) in
            [("matched", Some(NoiseKind::Matched)), ("mismatched", Some(NoiseKind::Mismatched)), ("all", None)]
        {
            let own = |s: &Scored| s.truth.what == What::Clean && noise.is_none_or(|n| s.truth.noise == n);
            let (cases, alarms) = (self.count(own), self.count(|s| own(s) && s.outcome == Outcome::FalseAlarm));
            let refused = self.count(|s| own(s) && s.outcome == Outcome::Refused);
            let bound = 100.0 * upper95(alarms, cases);
            let measured = format!("{}, upper 95 % bound {bound:.1} %; {refused} refused", share(alarms, cases));
            row(&format!("false alarm <= 5 %, {kind} noise"), measured, judged(cases, percent(alarms, cases) <= 5.0));
        }
        let named = |s: &Scored| is_catalogue(s) || is_pair(s);
        let (cases, wrong) = (self.count(named), self.count(|s| named(s) && s.outcome == Outcome::Wrong));
        row(
            "wrong name <= 2 %, effects of the catalogue, alone or two",
            share(wrong, cases),
            judged(cases, percent(wrong, cases) <= 2.0),
        );
        let outside = |s: &Scored| is_outside(s) && s.any_visible();
        let (cases, unknown) =
            (self.count(outside), self.count(|s| outside(s) && s.outcome == Outcome::OutsideUnknown));
        let other = self.count(|s| outside(s) && s.outcome == Outcome::OtherForm);
        let measured = format!("{}; {other} more have the right cause in another form", share(unknown, cases));
        row(
            "outside the catalogue and visible: unknown >= 90 %",
            measured,
            judged(cases, percent(unknown, cases) >= 90.0),
        );
        let placebo = |s: &Scored| matches!(s.truth.what, What::Placebo(_));
        let (cases, placebos) = (self.count(placebo), self.count(|s| placebo(s) && s.outcome == Outcome::Wrong));
        row("placebos named <= 1 %", share(placebos, cases), judged(cases, percent(placebos, cases) <= 1.0));
        let pairs = |s: &Scored| is_pair(s) && s.all_visible();
        let (cases, both) = (self.count(pairs), self.count(|s| pairs(s) && s.outcome == Outcome::Both));
        row(
            "two effects, both visible: both named or in sets >= 85 %",
            share(both, cases),
            judged(cases, percent(both, cases) >= 85.0),
        );
        let (cases, gained) = self.gained();
        row(
            "fall of the held-out error >= 80 % of an oracle's, visible effects",
            if cases == 0 { "none".to_owned() } else { format!("{gained:.0} % (mean of {cases})") },
            judged(cases, gained >= 80.0),
        );
        let hits: Vec<bool> = self.list.iter().flat_map(|s| &s.hits).map(|h| h.held).collect();
        let held = hits.iter().filter(|h| **h).count();
        let fine = (92.0..=97.0).contains(&percent(held, hits.len()));
        row("coverage of 95 % intervals 92 to 97 %", share(held, hits.len()), judged(hits.len(), fine));
        text
    }

    /// Mean share of an oracle's gain over cases with a visible effect, percent, missed ones as nothing.
    fn gained(&self) -> (usize, f64) {
        let own = |s: &&Scored| (is_catalogue(s) || is_pair(s)) && s.any_visible();
        let shares: Vec<f64> = self
            .list
            .iter()
            .filter(own)
            .filter_map(|s| match (&s.gain, s.outcome) {
                (Some(gain), _) => gain.share().map(|share| share.clamp(0.0, 1.0)),
                (None, Outcome::Missed) => Some(0.0),
                _ => None,
            })
            .collect();
        (shares.len(), 100.0 * shares.iter().sum::<f64>() / shares.len().max(1) as f64)
    }

    /// Truth against answer.
    #[must_use]
    pub fn confusion(&self) -> String {
        let mut text = "| hidden | cases | visible | exact | silent, rightly | in set | unknown | missed | wrong name | refused | other names given |\n\
            |---|---|---|---|---|---|---|---|---|---|---|\n"
            .to_owned();
        let mut keys = vec!["clean".to_owned()];
        keys.extend(CATALOGUE.iter().chain(&OUTSIDE).map(|code| (*code).to_owned()));
        keys.push("placebo".to_owned());
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

    /// Effects of the catalogue by how far they move the data.
    #[must_use]
    pub fn by_strength(&self) -> String {
        let ends = |class: usize| {
            let low = if class == 0 { 0.0 } else { EDGES[class - 1] };
            (low, EDGES.get(class).copied().unwrap_or(f64::INFINITY))
        };
        let classes: Vec<(String, Vec<&Scored>)> = (0..=EDGES.len())
            .map(|class| {
                let (low, high) = ends(class);
                let within = |s: &&Scored| {
                    is_catalogue(s)
                        && s.strength.as_ref().and_then(|s| s.first()).is_some_and(|s| *s > low && *s <= high)
                };
                let name = if high.is_finite() { format!("{low:.1} to {high:.1}") } else { format!("above {low:.1}") };
                (name, self.list.iter().filter(within).collect())
            })
            .collect();
        curve("strength (standard deviations)", &classes)
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
        let mut text = "| parameter | intervals that hold the truth | 95 % bounds of the share | mean of (estimate - truth)/error |\n\
            |---|---|---|---|\n"
            .to_owned();
        for (name, hits) in found {
            let held = hits.iter().filter(|h| h.held).count();
            let mean = hits.iter().map(|h| h.deviation).sum::<f64>() / hits.len() as f64;
            let _ = writeln!(
                text,
                "| {name} | {} | {:.0} to {:.0} % | {mean:+.2} |",
                share(held, hits.len()),
                100.0 * lower95(held, hits.len()),
                100.0 * upper95(held, hits.len()),
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

fn is_catalogue(s: &Scored) -> bool {
    matches!(s.truth.what, What::Catalogue(..))
}

fn is_outside(s: &Scored) -> bool {
    matches!(s.truth.what, What::Outside(..))
}

fn is_pair(s: &Scored) -> bool {
    matches!(s.truth.what, What::Pair(..))
}

/// Row of the confusion table.
fn hidden(s: &Scored) -> Option<&'static str> {
    match s.truth.what {
        What::Clean => Some("clean"),
        What::Catalogue(code, _) | What::Outside(code, _) => Some(code),
        What::Placebo(_) => Some("placebo"),
        What::Pair(..) => None,
    }
}
