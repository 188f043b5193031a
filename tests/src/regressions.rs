//! Hidden cases that each led to a rule of the diagnosis. They are kept so that no rule is lost, and count in no score.
//!
//! `cargo run --release -p tests --example regressions` runs all of them in some minutes; what runs with every test is `tests/tests/suite/diagnose_hidden.rs`.

use crate::hidden::{Case, Design, NoiseKind, What};
use crate::score::outcome::Outcome::{self, Both, Exact, InSet, OutsideUnknown, Unknown};

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
    let mut all = Vec::new();
    let mut kept = |why: &'static str, cases: Vec<(&'static [Outcome], Case)>| {
        all.extend(cases.into_iter().map(|(right, case)| Regression { case, right, why }));
    };
    kept(
        "six runs of 1.5 s were told a memory of five seconds, in which a drift was lost",
        vec![(&[Exact], one(D6, 570_153, "drift", 3).in_noise(Matched))],
    );
    kept(
        "a compliance of a millimetre paid for a freedom that its exact form does not need",
        vec![(&[Exact], one(D36, 495_005, "compliance", 4))],
    );
    kept(
        "an elastic law was named by its twin alone",
        vec![
            (&[Exact, InSet, Unknown], one(D36, 53_009, "second-term", 4)),
            (&[Exact, InSet, Unknown], one(D36, 53_003, "poisson", 3)),
            (&[Exact], one(D36, 60_061, "poisson", 4)),
        ],
    );
    kept(
        "an elastic departure without a name was given one, or a wrong radius lost its own",
        vec![
            (&[OutsideUnknown], outside(70_062, "outside-stiff-skin", 3)),
            (&[OutsideUnknown], outside(70_074, "outside-anisotropic", 2)),
            (&[Exact], one(D18, 70_071, "radius", 4)),
            (&[Exact, Unknown], one(D18, 60_043, "radius", 3)),
        ],
    );
    kept(
        "the ends of ways back, where contacts lift off, were taken for drift or adhesion",
        vec![(&[Exact], one(D36, 70_065, "relaxation", 3)), (&[Exact], one(D36, 70_043, "adhesion", 3))],
    );
    kept(
        "what softening at material points leaves hid a second effect",
        vec![
            (&[Both], pair(D36, 54_002, ["softening", "contact-offset"], 3)),
            (&[Both], pair(D36, 670_056, ["softening", "sensor-nonlinearity"], 4).in_noise(Matched)),
        ],
    );
    kept(
        "more than all of the stress relaxed where a machine gave way",
        vec![(&[Both], pair(D18, 570_006, ["relaxation", "compliance"], 4).in_noise(Matched))],
    );
    kept(
        "creep of the sensor and a machine that gives way hid each other",
        vec![
            (&[Both], pair(D18, 650_046, ["compliance", "sensor-creep"], 4).in_noise(Matched)),
            (&[Both], pair(D60, 620_046, ["compliance", "sensor-creep"], 4).in_noise(Mismatched)),
            (&[Both], pair(D60, 650_046, ["compliance", "sensor-creep"], 4).in_noise(Mismatched)),
        ],
    );
    kept(
        "an error of the mesh was solved to its end as friction beside a second term",
        vec![(&[Unknown], one(D36, 620_127, "numerics", 4))],
    );
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    /// No case is kept twice, and each says what is right and why.
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
