//! Scores of worlds added up.

use std::collections::BTreeMap;
use std::fmt::Write;

use super::score::{Mark, Scored};
use super::{DESIGNS, Truth, What};
use crate::document;
use crate::score::rate::{bounded, middle_and_worst};

/// Scored worlds, and how many were not worlds at all.
#[derive(Debug, Clone, Copy)]
pub struct Score<'a> {
    /// The scores, in any order.
    pub list: &'a [Scored],
    /// Seeds of which no amounts were found with which what should dominate does.
    pub discarded: usize,
}

/// Worlds in which a cause of the catalogue dominates and shows.
fn is_seen(s: &Scored) -> bool {
    s.truth.what == What::Catalogue && s.truth.visible()
}

fn is_outside(s: &Scored) -> bool {
    s.truth.what == What::Outside && s.truth.visible()
}

impl Score<'_> {
    fn of<'a>(list: &[&'a Scored], within: impl Fn(&Scored) -> bool) -> Vec<&'a Scored> {
        list.iter().copied().filter(|s| within(s)).collect()
    }

    fn share(list: &[&Scored], marks: &[Mark]) -> String {
        bounded(list.iter().filter(|s| marks.contains(&s.mark)).count(), list.len())
    }

    /// Everything, as Markdown.
    #[must_use]
    pub fn markdown(&self) -> String {
        [self.by_design(), self.by_code(), self.mistakes()].join("\n")
    }

    /// One row a design: rates with Wilson's 95 % bounds.
    #[must_use]
    pub fn by_design(&self) -> String {
        let all: Vec<&Scored> = self.list.iter().collect();
        let mut rows = Vec::new();
        for design in DESIGNS {
            let own = Self::of(&all, |s| s.world.design == design);
            if !own.is_empty() {
                rows.push(Self::row(&design.name(), &own));
            }
        }
        rows.push(Self::row("all", &all));
        let head = [
            "design",
            "worlds",
            "dominating and visible: named or in a set of three",
            "named",
            "unknown or silent",
            "wrong name, all worlds",
            "clean: no name",
            "outside, visible: unknown or right kind",
            "two, both visible: both found",
            "mu held",
            "alpha held",
            "s a diagnosis: median, worst",
        ];
        let note = format!(
            "Rates with their 95 % bounds (Wilson). {} more seeds are no worlds: nothing dominated in them.\n\n",
            self.discarded
        );
        note + &document::table(&head, &rows)
    }

    fn row(name: &str, own: &[&Scored]) -> Vec<String> {
        let seen = Self::of(own, is_seen);
        let held = |parameter: &str| {
            let hits = own.iter().flat_map(|s| &s.hits).filter(|hit| hit.name == parameter);
            let (count, held) = hits.fold((0, 0), |(n, held), hit| (n + 1, held + usize::from(hit.held)));
            bounded(held, count)
        };
        let (middle, worst) = middle_and_worst(own.iter().map(|s| s.answer.seconds)).unwrap_or_default();
        vec![
            name.to_owned(),
            own.len().to_string(),
            Self::share(&seen, &[Mark::Right, Mark::InSet]),
            Self::share(&seen, &[Mark::Right]),
            Self::share(&seen, &[Mark::Unknown, Mark::Silent, Mark::Minor]),
            Self::share(own, &[Mark::Wrong]),
            Self::share(&Self::of(own, |s| s.truth.what == What::Clean), &[Mark::Right]),
            Self::share(&Self::of(own, is_outside), &[Mark::Unknown, Mark::RightKind]),
            Self::share(
                &Self::of(own, |s| s.truth.what == What::Two && s.truth.visible()),
                &[Mark::Right, Mark::InSet],
            ),
            held("mu_MPa"),
            held("alpha"),
            format!("{middle:.1}, {worst:.1}"),
        ]
    }

    /// One row a dominating cause: how its answers count, and the names that were given instead.
    #[must_use]
    pub fn by_code(&self) -> String {
        let key = |truth: &Truth| match truth.what {
            What::Clean => "clean".to_owned(),
            What::Two => "two".to_owned(),
            What::Catalogue | What::Outside => truth.codes().join(" + "),
        };
        let mut groups: BTreeMap<(What, String), Vec<&Scored>> = BTreeMap::new();
        for one in self.list {
            groups.entry((one.truth.what, key(&one.truth))).or_default().push(one);
        }
        let mut rows = Vec::new();
        for ((_, name), own) in &groups {
            let count = |within: &dyn Fn(&Scored) -> bool| own.iter().filter(|s| within(s)).count().to_string();
            let mut row = vec![name.clone(), own.len().to_string(), count(&|s| s.truth.visible())];
            row.extend(Mark::ALL.map(|mark| count(&|s| s.mark == mark)));
            row.push(others(own));
            rows.push(row);
        }
        let mut head = vec!["dominates", "worlds", "visible"];
        head.extend(Mark::ALL.map(Mark::word));
        head.push("other names given");
        document::table(&head, &rows)
    }

    /// Every wrong name and every refusal on a line.
    #[must_use]
    pub fn mistakes(&self) -> String {
        let mut text = "Wrong names and refusals:\n\n".to_owned();
        for one in self.list.iter().filter(|s| matches!(s.mark, Mark::Wrong | Mark::Refused)) {
            let truth = &one.truth;
            let strength: Vec<String> = truth.dominating.iter().map(|one| format!("{:.1}", one.strength)).collect();
            let minors: Vec<&str> = truth.minors.iter().map(palpate::simulate::Effect::code).collect();
            let _ = writeln!(
                text,
                "- {} {}: {} [{}] of {:.0} % of the misfit, strength {}, beside [{}] and rests of {:.1} %: {}",
                one.world.design.name(),
                one.world.seed,
                truth.what.word(),
                truth.codes().join(" + "),
                100.0 * truth.share,
                strength.join(" "),
                minors.join(" + "),
                100.0 * truth.rests_rms,
                one.answer.line(),
            );
        }
        text
    }
}

/// Sets of names that hold nothing which dominates, with how often they were given.
fn others(own: &[&Scored]) -> String {
    let mut given: BTreeMap<String, usize> = BTreeMap::new();
    for one in own {
        let codes = one.truth.codes();
        for finding in &one.answer.findings {
            let mut names = std::iter::once(finding.code).chain(finding.ambiguous_with.iter().copied());
            if !names.clone().any(|name| codes.contains(&name)) {
                let first = names.next().unwrap_or_default().to_owned();
                *given.entry(names.fold(first, |set, name| set + "/" + name)).or_default() += 1;
            }
        }
    }
    given.iter().map(|(names, count)| format!("{names} {count}")).collect::<Vec<_>>().join(", ")
}
