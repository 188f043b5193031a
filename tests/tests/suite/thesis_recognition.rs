//! A part of what `docs/thesis-numbers.md` reports: 60 palpations a rate on coarser meshes.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use lut_gen::solid::model::Resolution;
use protocol::lut::Table;
use tests::palpations::{Conditions, RATES_MM_S, Study, pressed_foams, tables};

/// Presses of EVA, B1, ICF and A2: the thesis' shares of 60.
const COUNTS: [usize; 4] = [14, 20, 9, 17];

/// Failures that are let pass at each rate. A method that fails once in a hundred, the goal, fails more than twice in 60 with a probability of 2 %;
/// one that fails once in ten, as the thesis' at 2 mm/s, passes with 5 %. The seeds are fixed, so that a run that has passed passes again.
const FAILURES: usize = 2;

#[test]
fn the_board_and_its_filter_recognise_the_foams_and_alpha_of_b1_spreads_less_than_half_as_far_as_in_the_thesis() {
    let bytes = tables(Resolution::Refined(0.7), &|_, _| ()).unwrap();
    let foams = pressed_foams(Resolution::Standard).unwrap();
    let conditions = Conditions::default();
    let b1 = foams.iter().position(|f| f.name == "B1").unwrap();
    // Half of the thesis' 28, 21.3 and 7.3 %. The standard deviation of 20 values is itself known to 16 %; measured are 1 to 2.5 %.
    for (rate, goal) in [0.14, 0.1065, 0.0365].into_iter().enumerate() {
        let table = Table::parse(&bytes[rate]).unwrap();
        let study = Study::run(&foams, &table, rate, (1, &COUNTS), &conditions, &mut || ());
        let at = RATES_MM_S[rate];
        for (way, count) in
            [("board", study.recognised(&foams, None)), ("filter", study.recognised_by_filter(&foams, None))]
        {
            assert_eq!(count.of, 60);
            assert!(count.of - count.right <= FAILURES, "{way} at {at} mm/s: {count:?}");
        }
        let spread = study.alpha(b1);
        assert!(spread.count == 20 && spread.deviation < goal, "{at} mm/s: {spread:?}");
        // The thesis' way on the same samples scatters as in the thesis: the data are not easier than its bench.
        let thesis = study.alpha_by_threshold(b1);
        assert!(thesis.deviation > 3.0 * spread.deviation, "{at} mm/s: {thesis:?} against {spread:?}");
    }
}

#[test]
fn a_session_repeats_and_b1_softens_in_it() {
    let foams = pressed_foams(Resolution::Refined(0.5)).unwrap();
    let conditions = Conditions::default();
    let once = tests::palpations::session(&foams, &COUNTS, 1, &conditions, 7);
    assert_eq!(once, tests::palpations::session(&foams, &COUNTS, 1, &conditions, 7));
    assert_ne!(once[0].samples, tests::palpations::session(&foams, &COUNTS, 1, &conditions, 8)[0].samples);
    let softening = conditions.softening;
    // The first press stands for the fresh foam, the mean of a session for the library: 1 / (1 - 0.1 * 0.791).
    assert!((softening.factor(1) - 1.0859).abs() < 1e-3, "{}", softening.factor(1));
    let mean = (1..=50).map(|n| softening.factor(n)).sum::<f64>() / 50.0;
    // rounding only
    assert!((mean - 1.0).abs() < 1e-12);
    let b1 = &foams[foams.iter().position(|f| f.softens).unwrap()];
    // A faster ramp leaves less time to relax: the thesis' order, and 2 and 4 mm/s closer than 1 and 2 mm/s.
    let peaks = [0, 1, 2].map(|rate| b1.peak_n(rate));
    assert!(peaks[1] > peaks[0] && peaks[2] > peaks[1] && peaks[2] - peaks[1] < peaks[1] - peaks[0], "{peaks:?}");
}
