#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
use super::*;
use crate::testbed::{Chance, LIBRARY, Press, expanded_table, factored_table};

fn palpate(table: &Table<'_>, samples: &[Sample], depth_mm: f32) -> (Verdict, Palpation) {
    palpate_at(table, samples, depth_mm, 1.0)
}

fn palpate_at(table: &Table<'_>, samples: &[Sample], depth_mm: f32, rate_mm_s: f32) -> (Verdict, Palpation) {
    let config = PalpationConfig::default();
    let mut palpation = Palpation::new();
    palpation.start(rate_mm_s);
    let mut ended = Outcome::NoContact;
    for sample in samples {
        let progress = palpation.step(&config, table, *sample);
        if let Some(refused) = progress.refused() {
            ended = refused;
            break;
        }
        if palpation.has_contact() && palpation.depth_mm(sample.probe_mm) >= depth_mm {
            ended = Outcome::Identified;
            break;
        }
    }
    for _ in 0..400 {
        if palpation.analyse(&config, table) {
            break;
        }
    }
    let motion = Motion { number: 1, rate_mm_s, tick_max_us: 0, tick_mean_us: 0.0 };
    (palpation.verdict(&config, Some(table), ended, motion), palpation)
}

/// Deviation and bias that white noise of 1 %, gain jitter and the free contact point leave; see `docs/board.md`.
#[test]
fn noisy_foams_are_recognised_at_every_rate() {
    let bytes = factored_table();
    let table = Table::parse(&bytes).unwrap();
    let mut chance = Chance(7);
    let (mut right, mut all) = (0u32, 0u32);
    for rate in [1.0, 2.0, 4.0] {
        for (i, foam) in LIBRARY.iter().enumerate() {
            let mut squares = 0.0;
            for _ in 0..12 {
                let press = Press::noisy(*foam, rate, &mut chance);
                let (verdict, _) = palpate(&table, &press.samples(&mut chance), 4.0);
                right += u32::from(usize::from(verdict.material.index) == i);
                all += 1;
                squares += (f64::from(verdict.height_mm) - press.surface_mm()).powi(2);
            }
            let rms_mm = (squares / 12.0).sqrt();
            // Measured 0.04 to 0.09 mm over 60 presses each; 0.15 leaves room for 12.
            assert!(rms_mm < 0.15, "{} at {rate} mm/s: surface off by {rms_mm} mm", foam.name);
        }
    }
    // Issue A asks for 98 %.
    assert!(f64::from(right) >= 0.98 * f64::from(all), "{right} of {all}");
}

#[test]
fn clean_presses_give_the_parameters_in_both_forms_of_the_table() {
    let factored = factored_table();
    for foam in &LIBRARY[..4] {
        let expanded = expanded_table(foam.height_mm);
        for bytes in [&factored, &expanded] {
            let table = Table::parse(bytes).unwrap();
            let press = Press::clean(*foam, 1.0);
            let (v, _) = palpate(&table, &press.samples(&mut Chance(1)), 4.0);
            assert_eq!(v.outcome, Outcome::Identified, "{}", foam.name);
            // Misfits are differences of f32 sums, so 1e-7 of the sum of squares cannot be seen; after mu and alpha have made up for it,
            // 0.015 mm, 8 % and 2 are as much (measured: 0.010 mm, 7 %, 1.5). 1 % of noise costs far more.
            assert!((f64::from(v.height_mm) - foam.height_mm).abs() < 0.015, "{}: {}", foam.name, v.height_mm);
            assert!((f64::from(v.mu_mpa) / foam.mu_mpa - 1.0).abs() < 0.08, "{}: mu {}", foam.name, v.mu_mpa);
            assert!((f64::from(v.alpha) - foam.alpha).abs() < 2.0, "{}: alpha {}", foam.name, v.alpha);
            assert!(v.error_n < 0.02 * v.peak_force_n && v.margin > 0.0);
            assert_eq!(LIBRARY[usize::from(v.material.index)].name, foam.name);
        }
    }
}

#[test]
fn a_height_far_from_every_slice_is_refused_and_a_foam_that_is_not_in_the_library_is_not_named() {
    let bytes = factored_table();
    let table = Table::parse(&bytes).unwrap();
    let mut odd = LIBRARY[0];
    odd.height_mm = 15.9;
    let (v, _) = palpate(&table, &Press::clean(odd, 2.0).samples(&mut Chance(1)), 4.0);
    assert_eq!((v.outcome, v.material.index), (Outcome::NoSuchHeight, Recognition::NONE));
    let stranger = crate::testbed::Foam { name: "stranger", mu_mpa: 0.083, alpha: 10.0, height_mm: 19.05 };
    let (v, _) = palpate(&table, &Press::clean(stranger, 2.0).samples(&mut Chance(1)), 4.0);
    assert_eq!((v.outcome, v.material.index), (Outcome::Identified, Recognition::NONE));
}

#[test]
fn a_foam_outside_the_grid_is_said_to_be_on_its_edge() {
    let bytes = factored_table();
    let table = Table::parse(&bytes).unwrap();
    let hard = crate::testbed::Foam { name: "hard", mu_mpa: 0.9, alpha: 10.0, height_mm: 12.7 };
    let (v, _) = palpate(&table, &Press::clean(hard, 2.0).samples(&mut Chance(1)), 4.0);
    assert_eq!(v.outcome, Outcome::GridEdge);
}

#[test]
fn a_few_samples_are_too_short() {
    let bytes = factored_table();
    let table = Table::parse(&bytes).unwrap();
    let (v, _) = palpate(&table, &Press::clean(LIBRARY[0], 4.0).samples(&mut Chance(1)), 0.3);
    assert_eq!(v.outcome, Outcome::TooShort);
    assert_eq!((v.mu_mpa, v.material.index), (0.0, Recognition::NONE));
}

#[test]
fn a_shallow_palpation_is_held_against_the_force_it_has_reached() {
    let bytes = factored_table();
    let table = Table::parse(&bytes).unwrap();
    // Between dummy 1 and ICF; its error is less than 3 % of the force ICF has at 4 mm, but not of the force at 1.5 mm.
    let stranger = crate::testbed::Foam { name: "stranger", mu_mpa: 0.008, alpha: 12.0, height_mm: 25.4 };
    let (v, _) = palpate(&table, &Press::clean(stranger, 1.0).samples(&mut Chance(1)), 1.5);
    let icf_peak_n = LIBRARY[2].force_n(4.0) as f32;
    assert!(v.material.error_n < 0.03 * icf_peak_n && v.samples > 60, "{v:?}");
    assert_eq!(v.material.index, Recognition::NONE);
    let (v, _) = palpate(&table, &Press::clean(LIBRARY[2], 1.0).samples(&mut Chance(1)), 1.5);
    assert_eq!(v.material.index, 2);
}

#[test]
fn every_press_that_cannot_be_identified_says_why() {
    let bytes = factored_table();
    let table = Table::parse(&bytes).unwrap();
    // 5 mm into a table of 4 mm.
    let (v, p) = palpate(&table, &Press::clean(LIBRARY[0], 1.0).samples(&mut Chance(1)), 4.9);
    assert_eq!((v.outcome, v.mu_mpa, v.material.index), (Outcome::DeeperThanTable, 0.0, Recognition::NONE));
    assert!(p.estimate(&PalpationConfig::default(), 1).is_some(), "the board does not send it");
    // A little beyond is the contact point's refinement.
    let (v, _) = palpate(&table, &Press::clean(LIBRARY[0], 1.0).samples(&mut Chance(1)), 4.1);
    assert_eq!(v.outcome, Outcome::Identified);
    // Nothing under the probe.
    let mut nothing = Press::clean(LIBRARY[0], 1.0);
    nothing.gain = 0.0;
    let (v, p) = palpate(&table, &nothing.samples(&mut Chance(1)), 4.0);
    assert_eq!((v.outcome, v.height_mm, p.estimate(&PalpationConfig::default(), 1)), (Outcome::NoContact, 0.0, None));
}

#[test]
fn a_table_of_rates_is_searched_at_the_commanded_rate_and_refuses_others() {
    let bytes = crate::testbed::rated_table();
    let table = Table::parse(&bytes).unwrap();
    let foam = LIBRARY[0];
    for (rate, expected) in [(1.0, 1.0), (2.0, 2.0), (4.0, 4.0), (2.1, 2.0)] {
        let slice = Slice::choose(&table, 12.7, rate, &Tolerance::default()).unwrap();
        assert_eq!((slice.rate_mm_s, slice.len()), (expected, 900));
    }
    // The foam is as stiff as the table says for 4 mm/s.
    let mut press = Press::clean(foam, 4.0);
    press.gain = crate::testbed::STIFFENING[2];
    let (v, _) = palpate_at(&table, &press.samples(&mut Chance(1)), 4.0, 4.0);
    assert_eq!(v.outcome, Outcome::Identified);
    assert!((f64::from(v.mu_mpa) / foam.mu_mpa - 1.0).abs() < 0.08, "{v:?}");
    for rate in [3.0, 1.2, 0.0, f32::NAN] {
        let (v, _) = palpate_at(&table, &press.samples(&mut Chance(1)), 4.0, rate);
        assert_eq!((v.outcome, v.mu_mpa), (Outcome::NoSuchRate, 0.0), "{rate}");
    }
    // A rate that fits does not excuse a height that does not.
    let mut odd = press;
    odd.foam.height_mm = 15.9;
    let (v, _) = palpate_at(&table, &odd.samples(&mut Chance(1)), 4.0, 4.0);
    assert_eq!(v.outcome, Outcome::NoSuchHeight);
}

/// Estimate less truth in standard errors: mu, alpha, height of the surface.
fn off(p: &Palpation, press: &Press) -> [f64; 3] {
    let e = p.estimate(&PalpationConfig::default(), 1).unwrap();
    [
        (f64::from(e.mu_mpa) - press.foam.mu_mpa) / f64::from(e.mu_error_mpa),
        (f64::from(e.alpha) - press.foam.alpha) / f64::from(e.alpha_error),
        (f64::from(e.height_mm) - press.surface_mm()) / f64::from(e.height_error_mm),
    ]
}

/// Where noise and gain scatter as the board is told: the share within two stated errors of 160 presses is 95.4 % if errors are normal, and
/// below 90 % or at 100 % in one series of a thousand (binomial).
#[test]
fn two_stated_errors_hold_nineteen_of_twenty() {
    let bytes = factored_table();
    let table = Table::parse(&bytes).unwrap();
    let mut chance = Chance(29);
    for rate in [1.0, 4.0] {
        let (mut held, mut n) = ([0u32; 2], 0);
        for i in 0..160 {
            let press = Press::noisy(LIBRARY[i % 4], rate, &mut chance);
            let (v, p) = palpate(&table, &press.samples(&mut chance), 4.0);
            if v.outcome == Outcome::Identified {
                n += 1;
                held.iter_mut().zip(off(&p, &press)).for_each(|(h, o)| *h += u32::from(o.abs() <= 2.0));
            }
        }
        println!("{rate} mm/s: {held:?} of {n}");
        assert!(held.iter().all(|h| f64::from(*h) > 0.9 * f64::from(n)) && n > 120, "{rate} mm/s: {held:?} of {n}");
    }
}

/// A press without noise, or without any of what the errors hold, is not said to be exact: gains, table and transducer remain.
#[test]
fn errors_do_not_vanish_with_the_noise() {
    let bytes = factored_table();
    let table = Table::parse(&bytes).unwrap();
    let config = PalpationConfig::default();
    for foam in &LIBRARY[..4] {
        let press = Press::clean(*foam, 1.0);
        let (_, p) = palpate(&table, &press.samples(&mut Chance(1)), 4.0);
        let e = p.estimate(&config, 1).unwrap();
        let gains = config.analysis.valley.press_gain.hypot(config.analysis.valley.cell_gain);
        assert!(e.mu_error_mpa > gains * e.mu_mpa && e.mu_error_mpa < 0.1 * e.mu_mpa, "{}: {e:?}", foam.name);
        assert!(e.alpha_error > 1e-3 * e.alpha && e.alpha_error < 0.1 * e.alpha, "{}: {e:?}", foam.name);
        assert!(off(&p, &press).iter().all(|o| o.abs() < 2.0), "{}: {e:?}", foam.name);
    }
}

/// Two materials whose curves differ by 2 % of their peak, at 0.2 % of noise without gain jitter: each is told from the other, with a margin that says how near
/// the other is; what lies farther off than the acceptance is neither.
#[test]
fn two_near_equal_dummies_are_told_apart_and_the_margin_says_how_near_they_are() {
    let twin = crate::testbed::Foam { name: "twin", mu_mpa: 0.188 * 1.02, alpha: 11.16, height_mm: 19.05 };
    let bytes = crate::testbed::factored_table_with(&[LIBRARY[1], twin, LIBRARY[6]]);
    let table = Table::parse(&bytes).unwrap();
    let mut chance = Chance(23);
    let press = |foam, chance: &mut Chance| {
        let press = Press { noise: 0.002, start_mm: 3.0 + chance.even(), ..Press::clean(foam, 1.0) };
        palpate(&table, &press.samples(chance), 4.0).0.material
    };
    let (mut right, mut near) = (0, 0.0);
    for i in 0..40u8 {
        let m = press(if i % 2 == 0 { LIBRARY[1] } else { twin }, &mut chance);
        right += u8::from(m.index == i % 2 && m.runner_up == 1 - i % 2);
        near += m.margin / 40.0;
    }
    // Contact offsets make up for some of the 2 %.
    assert!(right >= 38, "{right} of 40");
    let mut clear = 0.0;
    for _ in 0..10 {
        let m = press(LIBRARY[6], &mut chance);
        assert_eq!(m.index, 2);
        clear += m.margin / 10.0;
    }
    assert!(near < 0.9 && clear > near + 0.05, "{near} {clear}");
    for by in [0.78, 1.28] {
        let m = press(crate::testbed::Foam { mu_mpa: by * 0.188, ..LIBRARY[1] }, &mut chance);
        assert_eq!(m.index, Recognition::NONE, "{by}: {m:?}");
        assert!(m.runner_up != Recognition::NONE && m.error_n > 0.0);
    }
}
