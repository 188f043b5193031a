#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
use super::*;

/// Piecewise linear depth through the given (time, depth) corners, sampled every 0.1 s.
fn ramps(corners: &[(f64, f64)]) -> Recording {
    let mut time = Vec::new();
    let mut depth = Vec::new();
    for pair in corners.windows(2) {
        let ((t0, d0), (t1, d1)) = (pair[0], pair[1]);
        let steps = ((t1 - t0) / 0.1).round() as usize;
        for i in 0..steps {
            let t = t0 + i as f64 * 0.1;
            time.push(t);
            depth.push(d0 + (d1 - d0) * (t - t0) / (t1 - t0));
        }
    }
    let force = depth.iter().map(|d: &f64| d.max(0.0).powf(1.5)).collect();
    Recording::from_samples(time, depth, force)
}

#[test]
fn ramp_hold_unload() {
    let run = ramps(&[(0.0, 0.0), (1.0, 0.0), (5.0, 4.0), (15.0, 4.0), (17.0, 0.0)]);
    let motion = of(&run).unwrap();
    assert!((motion.rate_mm_per_s - 1.0).abs() < 0.02, "{motion:?}");
    assert!(motion.loading.start.abs_diff(10) <= 1, "{motion:?}");
    assert!(motion.loading.end.abs_diff(50) <= 2, "{motion:?}");
    let hold = motion.hold.unwrap();
    assert!(hold.end.abs_diff(150) <= 2, "{hold:?}");
    assert!(motion.unloading.unwrap().end.abs_diff(170) <= 2);
    assert_eq!(motion.loadings.len(), 1);
    assert!(motion.events.is_empty());
}

#[test]
fn a_stop_on_the_way_is_told_and_ends_the_branch() {
    let run = ramps(&[(0.0, 0.0), (3.0, 3.0), (5.0, 3.0), (8.0, 6.0)]);
    let motion = of(&run).unwrap();
    assert!(motion.loading.end.abs_diff(30) <= 2, "{motion:?}");
    let [Event::Restarted { pause_s, .. }] = motion.events[..] else { panic!("{:?}", motion.events) };
    assert!((pause_s - 2.0).abs() < 0.3);
}

#[test]
fn a_fall_of_force_ends_the_branch_and_an_outlier_does_not() {
    let mut run = ramps(&[(0.0, 0.0), (10.0, 5.0), (12.0, 5.0)]);
    run.force_n[40] += 1.0;
    assert!(of(&run).unwrap().events.is_empty());
    for force in &mut run.force_n[80..] {
        *force -= 2.0;
    }
    let motion = of(&run).unwrap();
    assert_eq!(motion.loading.end, 80);
    assert!(matches!(motion.events[..], [Event::ForceDrop { .. }]));
}

/// A sensor of 2 % has 2 % of a large force as noise, and next to none of the small forces that most of a ramp is.
#[test]
fn noise_in_proportion_to_the_force_is_no_fall() {
    let clean = ramps(&[(0.0, 0.0), (20.0, 5.0), (22.0, 5.0)]);
    let noisy = |seed: u64| {
        let mut run = clean.clone();
        let mut state = seed;
        for (force, depth) in run.force_n.iter_mut().zip(&run.depth_mm) {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            // evenly within a band of 2 % standard deviation; the foam hardens
            *force = depth.max(0.0).powi(4) * (1.0 + 0.035 * ((state >> 33) as f64 / (1_u64 << 30) as f64 - 1.0));
        }
        run
    };
    for seed in 1..200 {
        let mut run = noisy(seed);
        assert_eq!(of(&run).unwrap().events, [], "seed {seed}");
        for force in &mut run.force_n[170..] {
            *force -= 0.4 * 5.0_f64.powi(4);
        }
        assert!(matches!(of(&run).unwrap().events[..], [Event::ForceDrop { .. }]), "seed {seed}");
    }
}

/// A knock that the sensor's electronics forget in half a second is none either, where others as large go the other way.
#[test]
fn noise_with_long_tails_and_a_memory_is_no_fall() {
    let mut run = ramps(&[(0.0, 0.0), (20.0, 5.0), (22.0, 5.0)]);
    let knock = |run: &mut Recording, at: usize, by: f64| {
        for (k, force) in run.force_n[at..at + 15].iter_mut().enumerate() {
            *force += by * (-0.2 * k as f64).exp();
        }
    };
    knock(&mut run, 60, 1.0);
    knock(&mut run, 120, -1.3);
    assert_eq!(of(&run).unwrap().events, []);
    knock(&mut run, 160, -2.5);
    assert!(matches!(of(&run).unwrap().events[..], [Event::ForceDrop { .. }]));
}

#[test]
fn noise_of_depth_does_not_break_the_ramp() {
    let mut run = ramps(&[(0.0, 0.0), (20.0, 4.0), (25.0, 4.0), (27.0, 0.0)]);
    // A fixed irregular sequence of about 0.02 mm; a step is 0.02 mm.
    let mut state = 1_u64;
    for depth in &mut run.depth_mm {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        *depth += 0.02 * ((state >> 33) as f64 / (1_u64 << 30) as f64 - 1.0);
    }
    let motion = of(&run).unwrap();
    assert!((motion.rate_mm_per_s - 0.2).abs() < 0.01, "{motion:?}");
    assert!(motion.loading.end.abs_diff(200) < 15, "{motion:?}");
    assert_eq!(motion.loadings.len(), 1);
}

#[test]
fn a_depth_read_less_often_than_written_is_no_standstill() {
    let mut run = ramps(&[(0.0, 0.0), (3.0, 0.0), (23.0, 4.0), (28.0, 4.0), (48.0, 0.0)]);
    let read: Vec<f64> = (0..run.depth_mm.len()).map(|i| run.depth_mm[i / 6 * 6]).collect();
    run.depth_mm = read;
    let motion = of(&run).unwrap();
    assert!((motion.rate_mm_per_s - 0.2).abs() < 0.01, "{motion:?}");
    assert!(motion.loading.start.abs_diff(30) < 8 && motion.loading.end.abs_diff(230) < 8, "{motion:?}");
    assert!(motion.hold.is_some() && motion.events.is_empty(), "{motion:?}");
}

/// A press ten times slower than a long approach, and one less than twice as slow: both begin where their own speed does.
#[test]
fn a_fast_approach_is_no_part_of_a_slow_press() {
    let run = ramps(&[(0.0, -40.0), (8.0, 0.0), (16.0, 4.0)]);
    let motion = of(&run).unwrap();
    assert!((motion.rate_mm_per_s - 0.5).abs() < 0.02, "{motion:?}");
    assert!(motion.loading.start.abs_diff(80) < 8 && motion.loading.end.abs_diff(160) < 3, "{motion:?}");
    let run = ramps(&[(0.0, -10.0), (5.0, -1.0), (10.0, 4.0), (20.0, 4.0)]);
    let motion = of(&run).unwrap();
    assert!((motion.rate_mm_per_s - 1.0).abs() < 0.05, "{motion:?}");
    assert!(motion.loading.start.abs_diff(50) < 10 && motion.hold.is_some(), "{motion:?}");
    // a creep under a constant force is no press
    let mut creep = ramps(&[(0.0, 0.0), (4.0, 4.0), (40.0, 4.5)]);
    creep.force_n[40..].iter_mut().for_each(|force| *force = 8.0);
    let motion = of(&creep).unwrap();
    assert!(motion.loading.end.abs_diff(40) < 3 && motion.hold.is_some(), "{motion:?}");
}

#[test]
fn two_cycles_and_no_motion() {
    let run = ramps(&[(0.0, 0.0), (2.0, 2.0), (4.0, 0.0), (6.0, 2.0), (8.0, 0.0)]);
    assert_eq!(of(&run).unwrap().loadings.len(), 2);
    assert_eq!(of(&ramps(&[(0.0, 1.0), (9.0, 1.0)])), None);
}
