//! Relaxation of a homogeneous column in ramp and hold, against the convolution integral.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use lut_gen::solid::contact::{Ball, Interface};
use lut_gen::solid::law::{Hyperfoam, Material, Ogden, PronyTerm, relaxed};
use lut_gen::solid::model::{Record, Resolution, Simulation, Specimen};
use lut_gen::solid::solve::{Base, Motion, Newton, Stepping};
use lut_gen::solid::verify::relaxing_column_mpa;

const STRETCH: f64 = 0.6;
const RAMP_S: f64 = 1.0;

fn series() -> Vec<PronyTerm> {
    vec![PronyTerm { g: 0.3, k: 0.3, tau_s: 0.4 }, PronyTerm { g: 0.25, k: 0.25, tau_s: 7.0 }]
}

/// Axial stress (MPa) at the end of `steps` steps of a ramp of `ramp_s` and a hold in `holds` steps up
/// to `time_s`; the sides do not move, nor do they need to for the foam with `nu = 0`.
fn driven(material: &Material, ramp_s: f64, steps: usize, time_s: f64, holds: usize) -> f64 {
    let mut old = vec![0.0; material.history()];
    let mut new = old.clone();
    let mut last = 0.0;
    let ramp = (1..=steps).map(|i| (ramp_s / steps as f64, i as f64 / steps as f64));
    let hold = (0..holds).map(|_| ((time_s - ramp_s) / holds as f64, 1.0));
    for (dt, part) in ramp.chain(hold) {
        let f = [1.0, 0.0, 0.0, 1.0 + (STRETCH - 1.0) * part, 1.0];
        let (_, p) = material.stress(&material.relaxation(dt), &f, &old, Some(&mut new)).unwrap();
        std::mem::swap(&mut old, &mut new);
        last = p[3];
        if matches!(material.elastic, lut_gen::solid::law::Elastic::Hyperfoam(_)) {
            assert!(p[0].abs() < 1e-12 && p[4].abs() < 1e-12, "the sides of a foam with nu = 0 are free");
        }
    }
    last
}

fn foam() -> Material {
    Hyperfoam::one_term(0.1, 8.0).unwrap().into()
}

/// A step of stretch relaxes by the factor of the series, exactly, in any number of steps.
#[test]
fn a_step_relaxes_by_the_series() {
    for elastic in [foam(), Ogden::one_term(0.1, 4.0, 1.0).unwrap().into()] {
        let instant = driven(&elastic, 1e-9, 1, 0.0, 0);
        let material = elastic.relaxing(series()).unwrap();
        for (time, steps) in [(0.1, 1), (0.1, 7), (3.0, 1), (50.0, 3)] {
            let ratio = driven(&material, 1e-9, 1, time, steps) / instant;
            // what relaxes within the ramp of a nanosecond, and rounding
            assert!((ratio / relaxed(&series(), time) - 1.0).abs() < 1e-8, "{time} s: {ratio}");
        }
    }
}

/// The uniaxial stress of a foam with `nu = 0`, `2 mu / alpha (l^(alpha - 1) - 1 / l)`, and of a confined
/// Ogden column, from the law itself; ramp and hold. A step takes the elastic stress as linear in
/// time: an error of second order, which a tenth of the step must divide by a hundred.
#[test]
fn a_ramp_and_hold_is_the_convolution() {
    let ogden: Material = Ogden::one_term(0.1, 4.0, 1.0).unwrap().into();
    let uniaxial = |l: f64| 0.2 / 8.0 * (l.powi(7) - 1.0 / l);
    let confined = |l: f64| {
        let f = [1.0, 0.0, 0.0, l, 1.0];
        ogden.stress(&ogden.relaxation(0.0), &f, &[], None).unwrap().1[3]
    };
    assert!((driven(&foam(), RAMP_S, 1, RAMP_S, 0) / uniaxial(STRETCH) - 1.0).abs() < 1e-12);
    let cases: [(Material, &dyn Fn(f64) -> f64); 2] = [(foam(), &uniaxial), (ogden.clone(), &confined)];
    for (elastic, stress) in cases {
        let material = elastic.relaxing(series()).unwrap();
        for (time, holds) in [(RAMP_S, 0), (1.3, 2), (6.0, 5)] {
            let exact = relaxing_column_mpa(stress, &series(), STRETCH, RAMP_S, time);
            let error = |steps: usize| (driven(&material, RAMP_S, steps, time, holds) / exact - 1.0).abs();
            let (coarse, fine) = (error(10), error(100));
            println!("{time} s: {exact} MPa, error {coarse:.1e} with 10 steps, {fine:.1e} with 100");
            assert!(coarse < 2e-3 && fine < 2e-5, "{time} s: {coarse} {fine}");
            assert!(fine < 0.02 * coarse + 1e-7, "{time} s: {coarse} {fine}");
        }
    }
}

/// What the record takes off for the penalty's softness leaves the force of a penalty that is five times stiffer, on the way down, in the hold, and on the way
/// back, where the energy in the penalty falls because the foam has relaxed as well as because the ball withdraws.
#[test]
fn the_penalty_is_taken_off_on_the_way_back_too() {
    const PIECES: usize = 30;
    let term = PronyTerm { g: 0.4, k: 0.4, tau_s: 0.65 };
    // pieces, so that both have equilibria at the same times
    let depth = |k: usize| 3.0 * k as f64 / PIECES as f64;
    let down = (1..=PIECES).fold(Motion::from_touch(), |m, k| m.to_depth(depth(k), 2.0));
    let motion = (0..PIECES).rev().fold(down.hold(5.0), |m, k| m.to_depth(depth(k), 2.0));
    let case = Simulation {
        material: foam().relaxing(vec![term]).unwrap(),
        specimen: Specimen { height_mm: 12.7, radius_mm: 25.0, base: Base::Bonded },
        ball: Ball { radius_mm: 4.0 },
        interface: Interface::default(),
        motion,
        resolution: Resolution::Refined(1.0),
    };
    let record = |stiffer: f64| {
        let stepping = Stepping::of_ball(case.ball.radius_mm);
        Record::new(case.follow(&case.mesh(1.0), stiffer, Newton::default(), stepping, &mut ()).unwrap().0)
    };
    let (soft, stiff) = (record(1.0), record(5.0));
    let peak = soft.force_n.iter().copied().fold(0.0, f64::max);
    let mut worst = [(0.0_f64, 0.0_f64); 3];
    for (station, force_n) in soft.stations.iter().zip(&soft.force_n) {
        let Some(k) = stiff.stations.iter().position(|s| (s.time_s - station.time_s).abs() < 1e-9) else { continue };
        let own = &mut worst[1 + usize::from(station.segment > PIECES) - usize::from(station.segment < PIECES)];
        own.0 = own.0.max((force_n - stiff.force_n[k]).abs() / peak);
        own.1 = own.1.max((station.force_n - stiff.force_n[k]).abs() / peak);
    }
    println!("worst of the peak on the way down, in the hold, back (as recorded, with the penalty): {worst:?}");
    // a third of what is taken off is left on the way down, where the lines of the mesh leave their marks, an eighth in the hold; differentiated on the way back, where the
    // energy also relaxes, 0.14 % of the peak would be left there
    let limits = [0.0012, 0.0004, 0.0008];
    for ((recorded, with_penalty), limit) in worst.into_iter().zip(limits) {
        assert!(recorded < limit && with_penalty > 1.5 * recorded, "{worst:?}");
    }
}
