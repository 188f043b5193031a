//! The explicit method as a whole: agreement with the implicit one, energy, inertia report.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use lut_gen::solid::contact::{Ball, Interface};
use lut_gen::solid::dynamics::{DynamicsError, Explicit, LIMIT, Press};
use lut_gen::solid::law::{Hyperfoam, Ogden, OgdenTerm, PronyTerm};
use lut_gen::solid::model::{Resolution, Simulation, Specimen};
use lut_gen::solid::solve::Motion;

fn press(rate_mm_s: f64) -> Press {
    let simulation = Simulation {
        material: Hyperfoam::one_term(0.22, 10.526).unwrap().into(),
        specimen: Specimen::of_height(12.7),
        ball: Ball { radius_mm: 4.0 },
        interface: Interface::default(),
        motion: Motion::ramp(1.5, rate_mm_s),
        resolution: Resolution::Refined(0.4),
    };
    Press { simulation, smooth: 0.5, explicit: Explicit::of_density(100.0) }
}

#[test]
fn force_tends_to_the_implicit_one_as_the_rate_falls() {
    let stations = press(1.0).simulation.solve().unwrap().stations;
    let mut before = f64::INFINITY;
    for rate in [4000.0, 1000.0, 250.0] {
        let pressed = press(rate).solve().unwrap();
        let inertia = pressed.inertia();
        let late = stations.iter().filter(|s| s.depth_mm >= inertia.from_mm);
        let misses: Vec<f64> = late.map(|s| pressed.force_at(s.depth_mm) / s.force_n - 1.0).collect();
        let rms = (misses.iter().map(|x| x * x).sum::<f64>() / misses.len() as f64).sqrt();
        println!("{rate} mm/s: difference {:.2} % rms; {inertia}", 100.0 * rms);
        assert!(rms < 0.5 * before, "{rate}: {rms} after {before}");
        assert_eq!(inertia.quasi_static(), rate < 2000.0, "{inertia}");
        // trapezoids of the ball's work and the time integration, second order in the step
        assert!(inertia.balance < 1e-3, "{inertia}");
        assert!((pressed.moments.last().unwrap().depth_mm - 1.5).abs() < 1e-12);
        before = rms;
    }
    // same mesh, same penalty: what is left are waves of the start
    assert!(before < 0.005, "{before}");
}

#[test]
fn damping_takes_energy_and_the_balance_keeps_it() {
    let mut damped = press(2000.0);
    damped.explicit.damping_per_s = 2000.0;
    let pressed = damped.solve().unwrap();
    let end = pressed.moments.last().unwrap();
    assert!(end.damping > 0.01 * end.external, "{end:?}");
    assert!(pressed.balance_error() < 1e-3, "{}", pressed.balance_error());
    for pair in pressed.moments.windows(2) {
        assert!(pair[1].damping >= pair[0].damping && pair[1].depth_mm > pair[0].depth_mm);
    }
    assert!(pressed.moments.len() >= damped.explicit.moments);
}

/// Root mean square difference of an explicit run to the implicit one of the same motion, whose smooth start is
/// taken in 60 straight pieces.
fn implicit_difference(pressed: &Press) -> f64 {
    let ramp = pressed.ramp().unwrap();
    let mut motion = Motion::from_touch();
    let pieces = 60;
    for i in 1..=pieces {
        let [from, to] = [i - 1, i].map(|k| ramp.duration_s() * f64::from(k) / f64::from(pieces));
        motion = motion.to_depth(ramp.at(to), (ramp.at(to) - ramp.at(from)) / (to - from));
    }
    let quiet = Simulation { motion, ..pressed.simulation.clone() }.solve().unwrap();
    let run = pressed.solve().unwrap();
    assert!(run.inertia().quasi_static() && run.balance_error() < 1e-3, "{}", run.inertia());
    let late: Vec<_> = quiet.stations.iter().filter(|s| s.depth_mm > 0.5).collect();
    assert!(late.len() > 20);
    let square: f64 = late.iter().map(|s| (run.force_at(s.depth_mm) / s.force_n - 1.0).powi(2)).sum();
    (square / late.len() as f64).sqrt()
}

#[test]
fn relaxation_friction_and_other_laws_agree_with_the_implicit_solver() {
    // 1.5 mm at 250 mm/s take 9 ms with the start: relaxation within that time
    let series = vec![PronyTerm { g: 0.4, k: 0.2, tau_s: 0.003 }];
    let mut relaxing = press(250.0);
    relaxing.simulation.material = relaxing.simulation.material.relaxing(series).unwrap();
    let mut rubbing = press(250.0);
    rubbing.simulation.interface.friction = 0.4;
    let mut rubber = press(500.0);
    let term = OgdenTerm { mu_mpa: 0.2, alpha: 3.0, d_per_mpa: 1.0 };
    rubber.simulation.material = Ogden::new(vec![term]).unwrap().into();
    for (what, case) in [("relaxing", relaxing), ("rubbing", rubbing), ("rubber", rubber)] {
        let difference = implicit_difference(&case);
        println!("{what}: {:.2} % rms", 100.0 * difference);
        // as the elastic foam at this rate: what is left are waves
        assert!(difference < 0.01, "{what}: {difference}");
    }
}

#[test]
fn mass_scaling_is_another_unit_of_time() {
    let quick = press(4000.0).solve().unwrap();
    let mut slow = press(40.0);
    slow.explicit.mass_scaling = 1e4;
    let slow = slow.solve().unwrap();
    assert_eq!(quick.steps, slow.steps);
    for (a, b) in quick.moments.iter().zip(&slow.moments) {
        assert!((a.force_n - b.force_n).abs() < 1e-9, "{a:?} {b:?}");
        assert!((a.kinetic - b.kinetic).abs() < 1e-9);
    }
}

#[test]
fn the_report_flags_the_fast_run_and_its_advice_is_sound() {
    let fast = press(4000.0).solve().unwrap().inertia();
    assert!(!fast.quasi_static() && fast.kinetic > LIMIT);
    let sentence = fast.to_string();
    assert!(sentence.starts_with("not quasi-static: beyond 0.300 mm kinetic energy reaches"), "{sentence}");
    assert!(sentence.contains("mm/s or slower, or scale the mass by 0.0"), "{sentence}");
    let advised = press(4000.0 * fast.slower()).solve().unwrap().inertia();
    assert!(advised.quasi_static(), "{advised}");
    assert!(advised.to_string().starts_with("quasi-static: ") && !advised.to_string().contains("slower"));
    assert!((advised.slower() - 1.0).abs() < 1e-15);
}

#[test]
fn what_cannot_run_is_refused_by_name() {
    let refused = |change: fn(&mut Press)| {
        let mut asked = press(1000.0);
        change(&mut asked);
        asked.solve().unwrap_err().to_string()
    };
    assert_eq!(
        refused(|p| p.simulation.motion = Motion::ramp(1.0, 0.0)),
        "duration_s of a segment = inf must be positive; after a prescribed force it must be given, not a rate"
    );
    assert_eq!(
        refused(|p| p.simulation.motion = Motion::ramp(1.0, 9.0).hold(1.0)),
        "segments of the motion = 2 but an explicit run needs one ramp from touch"
    );
    assert_eq!(refused(|p| p.simulation.motion = Motion::from_touch().to_force(1.0, 1.0)), "force_n = 1 is no depth");
    assert_eq!(refused(|p| p.smooth = 1.5), "smooth = 1.5 must lie in (0, 1]");
    assert_eq!(refused(|p| p.explicit.density_kg_m3 = f64::NAN), "density_kg_m3 = NaN must be positive");
    assert_eq!(refused(|p| p.explicit.mass_scaling = -1.0), "mass_scaling = -1 must be positive");
    assert_eq!(refused(|p| p.explicit.damping_per_s = -1.0), "damping_per_s = -1 must not be negative");
    assert_eq!(refused(|p| p.explicit.safety = 1.2), "safety = 1.2 must lie in (0, 1]");
    assert_eq!(refused(|p| p.explicit.renewal = 0), "renewal = 0 must be at least 1");
    assert_eq!(refused(|p| p.explicit.moments = 1), "moments = 1 must be at least 4");
    let deep = refused(|p| p.simulation.motion = Motion::ramp(13.0, 1.0));
    assert!(deep.starts_with("depth_mm = 13 must stay below 95 %"), "{deep}");
    let slow = refused(|p| p.simulation.motion = Motion::ramp(1.5, 0.1));
    assert!(slow.contains("more than the 2000000 allowed: press faster than 0.1 mm/s or scale the mass"), "{slow}");
    let inverted = DynamicsError::Inverted { element: 3, depth_mm: 1.0, steps: 7, step_s: 1e-6 };
    assert!(inverted.to_string().starts_with("element 3 was turned inside out at depth 1.0000 mm, after 7 steps"));
}
