#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;

use super::*;

/// A ball that goes down to 4 mm at 1 mm/s from 1 mm above, 20 readings a second, and stands; noise of 3 mN of 2.5 N.
fn press(seed: u64) -> Recording {
    let mut chance = Pcg64::seed_from_u64(seed);
    let time_s: Vec<f64> = (0..140).map(|i| 0.05 * f64::from(i)).collect();
    let depth_mm: Vec<f64> = time_s.iter().map(|t| (t - 1.0).min(4.0)).collect();
    let mut noise = || 0.003 * (0..12).map(|_| chance.random::<f64>() - 0.5).sum::<f64>();
    let force_n = depth_mm.iter().map(|d| 0.3125 * d.max(0.0).powf(1.5) + noise()).collect();
    Recording::from_samples(time_s, depth_mm, force_n)
}

fn told(recording: &mut Recording) -> Vec<String> {
    cleaned(recording).unwrap().iter().map(ToString::to_string).collect()
}

#[test]
fn sound_readings_stay() {
    for seed in 0..300 {
        let mut run = press(seed);
        let before = run.clone();
        assert_eq!(told(&mut run), Vec::<String>::new(), "seed {seed}");
        assert_eq!(run, before);
    }
}

/// Noise in proportion to the force, steps of a coarse converter, a sharp turn at the peak: nothing of it is a glitch.
#[test]
fn what_looks_like_trouble_stays() {
    let mut chance = Pcg64::seed_from_u64(7);
    for _ in 0..200 {
        let mut run = press(1);
        for force in &mut run.force_n {
            *force *= 1.0 + 0.05 * (chance.random::<f64>() - 0.5);
            *force = (*force / 0.02).round() * 0.02;
        }
        assert_eq!(told(&mut run), Vec::<String>::new());
    }
    let depth: Vec<f64> = (0..41).map(|i| 2.0 - 0.2 * f64::from((i - 20_i32).abs()).min(10.0)).collect();
    let force = depth.iter().map(|d| d.powf(3.0)).collect();
    let mut triangle = Recording::from_samples((0..41).map(f64::from).collect(), depth, force);
    assert_eq!(told(&mut triangle), Vec::<String>::new());
}

#[test]
fn glitches_and_codes_are_left_out_with_their_lines() {
    let mut run = press(3);
    run.force_n[60] += 20.0;
    run.force_n[90] -= 0.4;
    run.force_n[91] -= 0.5;
    run.force_n[10] = 9999.0;
    run.force_n[12] = 9999.0;
    let codes = "lines 12, 14: 2 readings of force_N, up to 9999, a code of the device for \"no reading\"; left out";
    let [code, glitch] = told(&mut run).try_into().unwrap();
    assert_eq!(code, codes);
    assert!(glitch.starts_with("lines 62, 92, 93: 3 readings of force_N, up to 20.8"), "{glitch}");
    assert!(glitch.ends_with(", far off their neighbours: a glitch of the sensor; left out"), "{glitch}");
    assert_eq!(run.len(), 135);
    assert!(!run.line.contains(&62) && run.line.contains(&61));
    let mut run = press(3);
    run.force_n[40] += 0.5;
    let [one] = told(&mut run).try_into().unwrap();
    assert!(one.starts_with("line 42: force_N is 0."), "{one}");
    assert!(one.ends_with(", far off its neighbours: a glitch of the sensor; left out"), "{one}");
}

#[test]
fn a_saturated_sensor_ends_the_run_and_a_hold_does_not() {
    let mut run = press(4);
    run.force_n.iter_mut().for_each(|force| *force = force.min(1.5));
    let [told] = told(&mut run).try_into().unwrap();
    let start = "the force sensor is saturated: from line ";
    assert!(told.starts_with(start) && told.contains("it stands at 1.5 N while the ball goes 1."), "{told}");
    assert!(run.force_n.iter().all(|force| *force < 1.5));
    let mut still = press(5);
    // a hold whose last readings are equal, at the largest force
    still.force_n[100..].iter_mut().for_each(|force| *force = 2.6);
    assert_eq!(cleaned(&mut still).unwrap(), Vec::new());
}

#[test]
fn columns_that_count_the_other_way_are_turned_or_refused() {
    let sound = press(6);
    let mut both = sound.clone();
    both.turn();
    assert_eq!(cleaned(&mut both).unwrap(), vec![Trouble::Turned]);
    assert_eq!(both.force_n, sound.force_n);
    let mut force = sound.clone();
    force.force_n.iter_mut().for_each(|f| *f = -*f);
    let problem = cleaned(&mut force).unwrap_err().to_string();
    assert!(problem.starts_with("the force falls to -2.5"), "{problem}");
    assert!(problem.ends_with("write force_N = { name = \"...\", sign = -1 } in [columns]"), "{problem}");
    let mut depth = sound.clone();
    depth.depth_mm.iter_mut().for_each(|d| *d = -*d);
    let problem = cleaned(&mut depth).unwrap_err().to_string();
    assert!(problem.starts_with("the depth falls to -4.000 mm while the force rises to 2.5"), "{problem}");
    // a way back alone
    let mut back = sound.clone();
    back.depth_mm.reverse();
    back.force_n.reverse();
    assert_eq!(cleaned(&mut back).unwrap(), Vec::new());
    // a soft, sticky gel holds the ball back harder than it was pressed
    let mut sticky = sound.clone();
    let way_back: Vec<f64> = (0..100).map(|i| 4.0 - 0.05 * f64::from(i)).collect();
    sticky.time_s.extend((0..100).map(|i| 7.0 + 0.05 * f64::from(i)));
    sticky
        .force_n
        .extend(way_back.iter().map(|d| if *d > 0.0 { 0.3 * d.powf(1.5) - 9.0 * (1.0 - d / 4.0) } else { 0.0 }));
    sticky.depth_mm.extend(way_back);
    sticky.line = (2..sticky.time_s.len() + 2).collect();
    assert_eq!(cleaned(&mut sticky).unwrap(), Vec::new());
}
