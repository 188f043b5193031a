//! A cylinder between platens: against the homogeneous state, a published factor, finer meshes and differences.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::f64::consts::PI;

use lut_gen::solid::homogeneous::{Coupon, Mode, Programme};
use lut_gen::solid::law::{Hyperfoam, Material, Ogden, OgdenTerm, Parameter, PronyTerm, Term};
use lut_gen::solid::model::{Compression, Ends, Resolution};
use lut_gen::solid::solve::Motion;

/// 50 mm by 30 mm.
fn cylinder(material: impl Into<Material>, ends: Ends, strain: f64) -> Compression {
    let motion = Motion::ramp(30.0 * strain, 1.0);
    let material = material.into();
    Compression { material, height_mm: 30.0, radius_mm: 25.0, ends, motion, resolution: Resolution::Standard }
}

fn silicone() -> Ogden {
    Ogden::one_term(0.0166, 2.0, 0.2).unwrap()
}

/// Without friction the state is homogeneous at half the height: the force differs by what the penalty leaves behind in
/// the second order and by the tolerance of the equilibrium, 1e-6.
#[test]
fn without_friction_it_is_homogeneous() {
    let solid = Ogden::new(vec![
        OgdenTerm { mu_mpa: 0.01, alpha: 3.0, d_per_mpa: 0.2 },
        OgdenTerm { mu_mpa: 0.006, alpha: -2.0, d_per_mpa: 0.0 },
    ]);
    let foam = Hyperfoam::new(vec![Term { mu_mpa: 0.1, alpha: 6.0, nu: 0.3 }]);
    let laws: [Material; 2] = [solid.unwrap().into(), foam.unwrap().into()];
    for law in laws {
        let case = cylinder(law.clone(), Ends::Friction(0.0), 0.5);
        let record = case.solve().unwrap();
        let coupon = Coupon { material: law, mode: Mode::Uniaxial, area_mm2: PI * 625.0 };
        let stretch: Vec<f64> = record.depth_mm.iter().map(|d| 1.0 - d / 30.0).collect();
        let path = Programme { time_s: record.stations.iter().map(|s| s.time_s).collect(), stretch };
        let exact = coupon.follow(&path, &[]).unwrap().force_n(&coupon);
        let misses = record.force_n.iter().zip(&exact).map(|(f, e)| (f / -e - 1.0).abs());
        let worst = misses.fold(0.0, f64::max);
        println!("{}: {worst:.1e} at {} stations", case.label(), exact.len());
        assert!(worst < 5e-6, "{worst:e}");
    }
}

/// The same through load, hold and unload of a relaxing foam: both take the elastic stress as straight over steps of
/// 1 to 2 percent of strain, which is worth 1e-4 of the peak.
#[test]
fn a_relaxing_cylinder_is_homogeneous_too() {
    let foam = Hyperfoam::new(vec![Term { mu_mpa: 0.1, alpha: 6.0, nu: 0.3 }]).unwrap();
    let series = vec![PronyTerm { g: 0.4, k: 0.2, tau_s: 3.0 }];
    let material = Material::from(foam).relaxing(series).unwrap();
    let motion = Motion::ramp(9.0, 3.0).hold(5.0).to_depth(4.0, 3.0);
    let case = Compression { motion, ..cylinder(material.clone(), Ends::Friction(0.0), 0.3) };
    let record = case.solve().unwrap();
    let coupon = Coupon { material, mode: Mode::Uniaxial, area_mm2: PI * 625.0 };
    let path =
        Programme { time_s: vec![0.0, 3.0, 8.0, 8.0 + 5.0 / 3.0], stretch: vec![1.0, 0.7, 0.7, 1.0 - 4.0 / 30.0] };
    let exact = coupon.follow(&path, &[]).unwrap().force_n(&coupon);
    for (t, e) in path.time_s.iter().zip(&exact).skip(1) {
        let f = record.force_at(*t);
        println!("{t}: {f} {e}");
        assert!((f + e).abs() < 1e-4 * exact[1].abs(), "{t}: {f} {e}");
    }
}

/// Glued, incompressible and little strained: `E_eff = E (1 + 2 S^2)`, `S = a / (2 h)` (Gent and Lindley 1959,
/// doi:10.1243/PIME_PROC_1959_173_022_02), for discs: their assumption of parabolic bulging neglects the shear of the
/// free edge and leaves the factor 1 + 2 S^2 low for S < 1/2 (7 percent at 0.25) and high beyond 1 (3 percent at 2).
/// Their correction for compressibility, `1/E_eff + 1/K`, is included. For S -> 0 the factor tends to 1, but each glued
/// end stiffens a length of its radius: 3 percent at 0.05.
#[test]
fn glued_discs_are_stiffer_by_the_shape_factor() {
    for (s, low, high) in
        [(0.05, 1.01, 1.04), (0.25, 1.05, 1.08), (0.5, 1.02, 1.05), (1.0, 0.98, 1.01), (2.0, 0.96, 0.99)]
    {
        let (mu, bulk) = (0.1, 1e3);
        let height = 25.0 / (2.0 * s);
        let case = Compression {
            height_mm: height,
            motion: Motion::ramp(1e-3 * height, 1.0),
            ..cylinder(Ogden::one_term(mu, 2.0, 2.0 / bulk).unwrap(), Ends::Bonded, 0.1)
        };
        let force = *case.solve().unwrap().force_n.last().unwrap();
        let young = 9.0 * bulk * mu / (3.0 * bulk + mu);
        let factor = 1.0 / (1.0 / (1.0 + 2.0 * s * s) + young / bulk);
        let ratio = force / (PI * 625.0 * 1e-3) / young / factor;
        println!("S {s}: over Gent and Lindley {ratio:.4}");
        assert!((low..high).contains(&ratio), "S {s}: {ratio}");
    }
}

/// Glued and rubbing cylinders at half their height, where the side has folded onto the platen, against a finer mesh.
#[test]
fn barrelling_converges_with_the_mesh() {
    for ends in [Ends::Bonded, Ends::Friction(0.3)] {
        let force = |resolution| {
            let record = Compression { resolution, ..cylinder(silicone(), ends, 0.5) }.solve().unwrap();
            let last = record.stations.last().unwrap();
            assert!(last.contact_radius_mm > 28.0, "{}", last.contact_radius_mm);
            // what presses on the platen rests on the middle plane
            assert!((last.base_force_n.abs() / last.force_n - 1.0).abs() < 1e-5);
            record.force_n.last().copied().unwrap()
        };
        let (coarse, standard) = (force(Resolution::Refined(0.7)), force(Resolution::Standard));
        println!("{ends:?}: {coarse} {standard}, {:.1e}", coarse / standard - 1.0);
        assert!((coarse / standard - 1.0).abs() < 0.01);
    }
}

/// More friction, more force: between the homogeneous state and, to where the side folds, the glued faces.
#[test]
fn friction_lies_between_sliding_and_glued() {
    let force = |ends| *cylinder(silicone(), ends, 0.2).solve().unwrap().force_n.last().unwrap();
    let list = [Ends::Friction(0.0), Ends::Friction(0.1), Ends::Friction(0.3), Ends::Bonded].map(force);
    println!("{list:?}");
    assert!(list.windows(2).all(|w| w[1] > w[0]), "{list:?}");
}

/// Elastic and without friction the force depends on the shortening only: whole solves may be differenced.
#[test]
fn derivatives_of_a_glued_cylinder_are_those_of_differences() {
    let case = cylinder(silicone(), Ends::Bonded, 0.3);
    let list = case.material.parameters();
    let names: Vec<Parameter> = list.iter().map(|(p, _)| *p).collect();
    let (record, exact) = case.sensitivities(&names).unwrap();
    let force = *record.force_n.last().unwrap();
    for (s, (parameter, value)) in exact.iter().zip(list) {
        let h = 1e-3 * value;
        let at = |h: f64| -> f64 {
            let case = Compression { material: case.material.shifted(parameter, h), ..case.clone() };
            case.solve().unwrap().force_n.last().copied().unwrap()
        };
        let difference = (at(h) - at(-h)) / (2.0 * h);
        let x = s.force.last().copied().unwrap();
        let miss = (difference - x).abs() * value / force;
        println!("{parameter}: {x} {difference}, miss {miss:.1e}");
        // equilibria are known to 1e-6 of the force, the parameter moves by 1e-3
        assert!(miss < 1e-3 * (x * value / force).abs().max(0.1), "{parameter}: {x} {difference}");
    }
}

#[test]
fn what_makes_no_sense_is_refused() {
    let good = cylinder(silicone(), Ends::Friction(0.1), 0.1);
    let say = |c: &Compression| c.solve().unwrap_err().to_string();
    assert_eq!(say(&Compression { height_mm: -1.0, ..good.clone() }), "height_mm = -1 must be positive");
    let deep = Compression { motion: Motion::ramp(29.0, 1.0), ..good.clone() };
    assert_eq!(say(&deep), "shortening of the cylinder = 29 must stay below 95 % of the height, 30 mm");
    let forced = Compression { motion: Motion::from_touch().to_force(1.0, 1.0), ..good.clone() };
    assert!(say(&forced).starts_with("force_n of a segment = 1 cannot be prescribed between platens"));
    assert_eq!(say(&Compression { ends: Ends::Friction(-0.1), ..good.clone() }), "friction = -0.1 must lie in 0..2");
    let glued = Compression { ends: Ends::Bonded, ..good };
    let said = glued.sensitivities(&[Parameter::Friction]).unwrap_err().to_string();
    assert!(said.starts_with("friction is no parameter of ogden mu_1 0.0166"), "{said}");
}
