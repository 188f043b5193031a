#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
use super::*;
use crate::contact::Sample;
use crate::palpation::{Motion, Palpation, PalpationConfig};
use crate::testbed::{self, Chance, Foam, LIBRARY};
use protocol::message::{Recognition, Verdict};

const FOAM: Foam = LIBRARY[0];
const NOISE_N: f64 = 0.005;

/// A press that goes well: EVA at 2 mm/s and 50 Hz to 4 mm, with its approach.
struct Good {
    foam: Foam,
    height_mm: f64,
    rate_mm_s: f32,
    depth_mm: f64,
    gain: f64,
}

const GOOD: Good = Good { foam: FOAM, height_mm: 12.7, rate_mm_s: 2.0, depth_mm: 4.0, gain: 1.0 };

impl Good {
    /// (depth, force) from 3 mm above the surface.
    fn samples(&self, spoil: impl Fn(usize, f64, &mut f64)) -> Vec<(f32, f32)> {
        let mut chance = Chance(3);
        let count = ((3.0 + self.depth_mm) / 0.04) as usize;
        (0..=count)
            .map(|i| {
                let depth = 0.04 * i as f64 - 3.0;
                let clean = if depth > 0.0 { self.gain * self.foam.force_n(depth) } else { 0.0 };
                let mut force = clean + NOISE_N * chance.normal();
                spoil(i, depth, &mut force);
                (depth as f32, force as f32)
            })
            .collect()
    }
}

/// What every method and the board make of the same samples.
struct Outcomes {
    variance: Result<Found, Outcome>,
    rows: Result<Fitted, Outcome>,
    filter: Result<Estimator<2>, Outcome>,
    board: (Verdict, bool),
}

fn outcomes(table: &Table<'_>, press: &Good, samples: &[(f32, f32)]) -> Outcomes {
    let (height_mm, rate_mm_s) = (press.height_mm as f32, press.rate_mm_s);
    let known = Press { height_mm, rate_mm_s, samples, noise_n: NOISE_N as f32 };
    Outcomes {
        variance: known.by_variance(table, &mut Search::new()),
        rows: known.by_rows(table),
        filter: known.by_filter(table, 3),
        board: palpated(table, press, samples),
    }
}

/// The board's own palpation of the samples: its verdict, and whether it would send an estimate.
fn palpated(table: &Table<'_>, press: &Good, samples: &[(f32, f32)]) -> (Verdict, bool) {
    let config = PalpationConfig::default();
    let mut palpation = Palpation::new();
    palpation.start(press.rate_mm_s);
    let mut ended = Outcome::NoContact;
    for (depth_mm, force_n) in samples {
        let sample = Sample { probe_mm: press.height_mm as f32 - depth_mm, force_n: *force_n };
        if let Some(refused) = palpation.step(&config, table, sample).refused() {
            ended = refused;
            break;
        }
        if palpation.has_contact() {
            ended = Outcome::Identified;
        }
    }
    while !palpation.analyse(&config, table) {}
    let motion = Motion { number: 1, rate_mm_s: press.rate_mm_s, tick_max_us: 0, tick_mean_us: 0.0 };
    let (estimate, verdict) = palpation.report(&config, Some(table), ended, motion);
    (verdict, estimate.is_some())
}

#[test]
fn a_good_press_is_identified_by_every_method() {
    let bytes = testbed::rated_table();
    let table = Table::parse(&bytes).unwrap();
    // The table's foams are stiffer at 2 mm/s.
    let press = Good { gain: testbed::STIFFENING[1], ..GOOD };
    let found = outcomes(&table, &press, &press.samples(|_, _, _| ()));
    let slice = Slice::choose(&table, 12.7, 2.0, &Tolerance::default()).unwrap();
    let (mu, _) = slice.parameters(&table, found.variance.unwrap().index);
    // A step of the grid in mu is a factor of 1.25; the others lie between the columns.
    assert!((f64::from(mu) / FOAM.mu_mpa).ln().abs() < 0.25, "{mu}");
    for mu in [found.rows.unwrap().mu_mpa, found.filter.unwrap().filter.state[0]] {
        assert!((f64::from(mu) / FOAM.mu_mpa - 1.0).abs() < 0.05, "{mu}");
    }
    assert_eq!((found.board.0.outcome, found.board.1), (Outcome::Identified, true));
}

/// Every kind of bad input, for the three methods and for the board: the same named outcome, and no number.
#[test]
fn bad_input_is_a_named_outcome_and_no_number() {
    let bytes = testbed::rated_table();
    let table = Table::parse(&bytes).unwrap();
    let stiff = Good { gain: testbed::STIFFENING[1], ..GOOD };
    let clean = |_: usize, _: f64, _: &mut f64| ();
    type Spoil<'a> = &'a dyn Fn(usize, f64, &mut f64);
    let cases: [(&str, Good, Spoil<'_>, Outcome); 11] = [
        ("too few points", Good { depth_mm: 0.38, ..stiff }, &clean, Outcome::TooShort),
        ("deeper than the table", Good { depth_mm: 5.2, ..stiff }, &clean, Outcome::DeeperThanTable),
        ("nothing under the ball", Good { gain: 0.0, ..stiff }, &clean, Outcome::NoContact),
        ("ends above the surface", Good { depth_mm: -0.1, ..stiff }, &clean, Outcome::NoContact),
        ("stiffer than the grid", Good { gain: 5.0, ..stiff }, &clean, Outcome::GridEdge),
        ("no numbers", stiff_again(), &|i, _, f| set(f, i % 4 == 0, f64::NAN), Outcome::BadReadings),
        ("nothing but no numbers", stiff_again(), &|_, _, f| *f = f64::NAN, Outcome::BadReadings),
        ("infinite", stiff_again(), &|i, _, f| set(f, i % 5 == 0, f64::INFINITY), Outcome::BadReadings),
        ("the cell ends at 3 N", stiff_again(), &|_, _, f| *f = f.min(3.0), Outcome::Saturated),
        ("no such height", Good { height_mm: 15.9, ..stiff }, &clean, Outcome::NoSuchHeight),
        ("no such rate", Good { rate_mm_s: 3.0, ..stiff }, &clean, Outcome::NoSuchRate),
    ];
    for (name, press, spoil, expected) in cases {
        let found = outcomes(&table, &press, &press.samples(spoil));
        assert_eq!(found.variance, Err(expected), "{name}: variance search");
        assert_eq!(found.rows, Err(expected), "{name}: fast search");
        assert_eq!(found.filter.err(), Some(expected), "{name}: filter");
        let (verdict, estimated) = found.board;
        assert_eq!(verdict.outcome, expected, "{name}: board");
        assert_eq!((verdict.mu_mpa, verdict.alpha, estimated), (0.0, 0.0, false), "{name}: board");
        // What lies outside the grid may still be compared with the library, and is not in it.
        assert_eq!(verdict.material.index, Recognition::NONE, "{name}: board");
    }
}

const fn stiff_again() -> Good {
    Good { gain: testbed::STIFFENING[1], ..GOOD }
}

fn set(force: &mut f64, when: bool, to: f64) {
    if when {
        *force = to;
    }
}

/// One glitch in twenty is left out and does no harm.
#[test]
fn a_few_readings_that_are_no_numbers_are_left_out() {
    let bytes = testbed::rated_table();
    let table = Table::parse(&bytes).unwrap();
    let press = stiff_again();
    let clean = outcomes(&table, &press, &press.samples(|_, _, _| ()));
    let spoilt = outcomes(&table, &press, &press.samples(|i, _, f| set(f, i % 20 == 7, f64::NAN)));
    assert_eq!(spoilt.variance.unwrap().index, clean.variance.unwrap().index);
    let (a, b) = (spoilt.rows.unwrap().mu_mpa, clean.rows.unwrap().mu_mpa);
    // Other samples, other noise: 5 mN of 6 N.
    assert!((a / b - 1.0).abs() < 0.01, "{a} {b}");
    assert_eq!((spoilt.board.0.outcome, spoilt.board.1), (Outcome::Identified, true));
    assert_eq!(spoilt.board.0.material.index, clean.board.0.material.index);
}

/// Forces that are numbers, but no sum of them is.
#[test]
fn forces_beyond_any_sum_are_bad_readings() {
    let bytes = testbed::factored_table();
    let table = Table::parse(&bytes).unwrap();
    let huge: Vec<(f32, f32)> = (1..=50).map(|i| (0.08 * i as f32, f32::MAX * (0.5 + 0.01 * i as f32))).collect();
    let press = Press { height_mm: 12.7, rate_mm_s: 2.0, samples: &huge, noise_n: 0.005 };
    assert_eq!(press.by_variance(&table, &mut Search::new()), Err(Outcome::BadReadings));
    assert_eq!(press.by_rows(&table), Err(Outcome::BadReadings));
    assert!(matches!(press.by_filter(&table, 3), Err(Outcome::BadReadings | Outcome::GridEdge)));
}
