//! Which cases are scored: strata, so that a few hundred reach every effect, level, pair and kind of noise.

use palpate::simulate::Variable;

use crate::hidden::{CATALOGUE, Case, Design, LEVELS, NoiseKind, OUTSIDE, PAIRS, What};

/// First seed of a suite unless stated: far from those that the diagnosis is developed on.
pub const FIRST_SEED: u64 = 20_000;
/// Kinds of twenty cases in a row: clean, of the catalogue, outside of it, pairs, placebos. Of a hundred cases 25, 45, 15, 10 and 5.
const KINDS: &[u8; 20] = b"ckokckpkckokckokpkcx";
/// Steps through the cells of a stratum, coprime to their number: neighbours differ in code and level.
const STEP: usize = 37;

/// The cases of a design: seeds from `first` on, what is hidden and the noise's kind by turns.
///
/// Suites of all four designs with a hundred cases each reach each of the catalogue's codes at each level at least twice, outside effects at each
/// level, every pair four times, every placebo three times, and a hundred clean ones, half of them with mismatched noise.
#[must_use]
pub fn cases(design: Design, count: usize, first: u64) -> Vec<Case> {
    let place = Design::ALL.iter().position(|d| *d == design).unwrap_or(0);
    let mut of_kind = [0_usize; 256];
    (0..count)
        .map(|at| {
            let kind = KINDS[at % KINDS.len()];
            let nth = of_kind[usize::from(kind)];
            of_kind[usize::from(kind)] += 1;
            let case = Case::new(design, first + at as u64).hiding(what(kind, nth, place));
            let noise = if (nth + place) % 2 == 0 { NoiseKind::Matched } else { NoiseKind::Mismatched };
            if kind == b'c' { case.in_noise(noise) } else { case }
        })
        .collect()
}

/// The `nth` case of its kind in the design of that place.
fn what(kind: u8, nth: usize, place: usize) -> What {
    // designs begin where the one before them has ended after a hundred cases
    let cell = |cells: usize, a_hundred: usize| ((nth + place * a_hundred) * STEP) % cells;
    match kind {
        b'k' => {
            let cell = cell(CATALOGUE.len() * LEVELS, 45);
            What::Catalogue(CATALOGUE[cell / LEVELS], cell % LEVELS)
        }
        b'o' => {
            let cell = cell(OUTSIDE.len() * LEVELS, 15);
            What::Outside(OUTSIDE[cell / LEVELS], cell % LEVELS)
        }
        b'p' => What::Pair(PAIRS[cell(PAIRS.len(), 10)], 3 + (nth + place) % 2),
        b'x' => What::Placebo(Variable::ALL[cell(Variable::ALL.len(), 5)].1),
        _ => What::Clean,
    }
}

/// The cases of a design that hide one code (or "clean", "matched", "mismatched", "pairs", "placebos", "deleted"), at all levels by turns; `None` for an
/// unknown word.
#[must_use]
pub fn cases_of(code: &str, design: Design, count: usize, first: u64) -> Option<Vec<Case>> {
    let find = |list: &[&'static str]| list.iter().find(|c| **c == code).copied();
    let one = |at: usize| {
        let case = Case::new(design, first + at as u64);
        match code {
            "clean" => Some(case.hiding(What::Clean)),
            "matched" => Some(case.hiding(What::Clean).in_noise(NoiseKind::Matched)),
            "mismatched" => Some(case.hiding(What::Clean).in_noise(NoiseKind::Mismatched)),
            "pairs" => Some(case.hiding(what(b'p', at, 0))),
            "deleted" => {
                let cell = (at * STEP) % (CATALOGUE.len() * 2);
                Some(case.hiding(What::Deleted(CATALOGUE[cell / 2], 3 + cell % 2)))
            }
            "placebos" => Some(case.hiding(what(b'x', at, 0))),
            _ => match (find(&CATALOGUE), find(&OUTSIDE)) {
                (Some(code), _) => Some(case.hiding(What::Catalogue(code, at % LEVELS))),
                (_, Some(code)) => Some(case.hiding(What::Outside(code, at % LEVELS))),
                _ => None,
            },
        }
    };
    (0..count).map(one).collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;
    use std::collections::BTreeMap;

    #[test]
    fn a_suite_of_four_hundred_reaches_everything() {
        let mut cells: BTreeMap<String, usize> = BTreeMap::new();
        let mut clean = [0, 0];
        for design in Design::ALL {
            for case in cases(design, 100, FIRST_SEED) {
                let truth = case.truth();
                if truth.what == What::Clean {
                    clean[usize::from(truth.noise == NoiseKind::Mismatched)] += 1;
                }
                let key = match truth.what {
                    What::Pair(codes, _) => format!("{codes:?}"),
                    other => format!("{other:?}"),
                };
                *cells.entry(key).or_default() += 1;
            }
        }
        assert_eq!(clean, [50, 50]);
        let of = |what: What| cells.get(&format!("{what:?}")).copied().unwrap_or(0);
        for level in 0..LEVELS {
            assert!(CATALOGUE.iter().all(|code| of(What::Catalogue(code, level)) >= 2), "{cells:#?}");
            assert!(OUTSIDE.iter().all(|code| of(What::Outside(code, level)) >= 1), "{cells:#?}");
        }
        assert!(PAIRS.iter().all(|codes| cells[&format!("{codes:?}")] == 4), "{cells:#?}");
        assert!(Variable::ALL.iter().all(|(_, variable)| of(What::Placebo(*variable)) >= 3), "{cells:#?}");
    }

    #[test]
    fn a_suite_of_one_code_goes_through_the_levels() {
        let levels: Vec<What> =
            cases_of("lag", Design::D18, 6, 3).unwrap().into_iter().filter_map(|c| c.what).collect();
        assert_eq!(levels[4..], [What::Catalogue("lag", 4), What::Catalogue("lag", 0)]);
        assert_eq!(cases_of("outside-hum", Design::D6, 2, 0).unwrap()[1].what, Some(What::Outside("outside-hum", 1)));
        assert!(cases_of("lagg", Design::D6, 2, 0).is_none());
    }
}
