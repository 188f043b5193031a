//! Hidden cases that each led to a rule of the diagnosis. They are kept so that no rule is lost, and count in no score.
//!
//! `cargo run --release -p tests --example regressions` runs all of them in some minutes; what runs with every test is `tests/tests/diagnose_hidden.rs`.

use palpate::diagnose::Models;
use palpate::simulate::Solver;

use crate::hidden::{Case, Design, NoiseKind, What};
use crate::score::outcome::Outcome::{self, Both, Exact, InSet, OutsideUnknown, Unknown};
use crate::score::{ScoreError, Scored};

/// A case, what may come of it, and why it is kept.
#[derive(Debug, Clone)]
pub struct Regression {
    /// The case.
    pub case: Case,
    /// Outcomes that are right.
    pub right: &'static [Outcome],
    /// What went wrong before, as one sentence.
    pub why: &'static str,
}

/// What became of a case.
#[derive(Debug, Clone)]
pub struct Judged {
    /// The answer.
    pub scored: Scored,
    /// It is one of those that are right.
    pub holds: bool,
}

impl Regression {
    /// Makes the case and has it diagnosed.
    ///
    /// # Errors
    /// [`ScoreError`]: when a solve fails.
    pub fn judge(&self, solver: &Solver, models: &Models) -> Result<Judged, ScoreError> {
        let scored = Scored::of(&self.case, solver, models)?;
        Ok(Judged { holds: self.right.contains(&scored.outcome), scored })
    }
}

fn one(design: Design, seed: u64, code: &'static str, level: usize) -> Case {
    Case::new(design, seed).hiding(What::Catalogue(code, level))
}

fn pair(design: Design, seed: u64, codes: [&'static str; 2], level: usize) -> Case {
    Case::new(design, seed).hiding(What::Pair(codes, level))
}

fn outside(seed: u64, code: &'static str, level: usize) -> Case {
    Case::new(Design::D18, seed).hiding(What::Outside(code, level))
}

/// All cases, grouped by what went wrong.
#[must_use]
pub fn all() -> Vec<Regression> {
    use Design::{D6, D18, D36, D60};
    use NoiseKind::{Matched, Mismatched};
    const GROUPS: [&str; 9] = [
        "six runs of 1.5 s were told a memory of five seconds, in which a drift was lost",
        "a compliance of a millimetre paid for a freedom that its exact form does not need",
        "an elastic law was named by its twin alone",
        "an elastic departure without a name was given one, or a wrong radius lost its own",
        "the ends of ways back, where contacts lift off, were taken for drift or adhesion",
        "what softening at material points leaves hid a second effect",
        "more than all of the stress relaxed where a machine gave way",
        "creep of the sensor and a machine that gives way hid each other",
        "an error of the mesh was solved to its end as friction beside a second term",
    ];
    let of = |group: usize, right: &'static [Outcome], case: Case| Regression { case, right, why: GROUPS[group] };
    vec![
        of(0, &[Exact], one(D6, 570_153, "drift", 3).in_noise(Matched)),
        of(1, &[Exact], one(D36, 495_005, "compliance", 4)),
        of(2, &[Exact, InSet, Unknown], one(D36, 53_009, "second-term", 4)),
        of(2, &[Exact, InSet, Unknown], one(D36, 53_003, "poisson", 3)),
        of(2, &[Exact], one(D36, 60_061, "poisson", 4)),
        of(3, &[OutsideUnknown], outside(70_062, "outside-stiff-skin", 3)),
        of(3, &[OutsideUnknown], outside(70_074, "outside-anisotropic", 2)),
        of(3, &[Exact], one(D18, 70_071, "radius", 4)),
        of(3, &[Exact, Unknown], one(D18, 60_043, "radius", 3)),
        of(4, &[Exact], one(D36, 70_065, "relaxation", 3)),
        of(4, &[Exact], one(D36, 70_043, "adhesion", 3)),
        of(5, &[Both], pair(D36, 54_002, ["softening", "contact-offset"], 3)),
        of(5, &[Both], pair(D36, 670_056, ["softening", "sensor-nonlinearity"], 4).in_noise(Matched)),
        of(6, &[Both], pair(D18, 570_006, ["relaxation", "compliance"], 4).in_noise(Matched)),
        of(7, &[Both], pair(D18, 650_046, ["compliance", "sensor-creep"], 4).in_noise(Matched)),
        of(7, &[Both], pair(D60, 620_046, ["compliance", "sensor-creep"], 4).in_noise(Mismatched)),
        of(7, &[Both], pair(D60, 650_046, ["compliance", "sensor-creep"], 4).in_noise(Mismatched)),
        of(8, &[Unknown], one(D36, 620_127, "numerics", 4)),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// No case is kept twice, and every group has one.
    #[test]
    fn every_case_is_kept_once() {
        let all = all();
        for (at, one) in all.iter().enumerate() {
            let again =
                all.iter().skip(at + 1).any(|o| (o.case.design, o.case.seed) == (one.case.design, one.case.seed));
            assert!(!again && !one.right.is_empty() && !one.why.is_empty(), "{:?}", one.case);
        }
    }
}
