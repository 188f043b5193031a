use lut_gen::solid::homogeneous::{Coupon, Mode, Programme};
use lut_gen::solid::law::{Hyperfoam, Material, PronyTerm, Term};
use lut_gen::solid::verify::confined_stress_mpa;

use super::*;
use crate::experiment::Test;

const AREA_MM2: f64 = std::f64::consts::PI * 100.0;

/// A coupon of 20 mm diameter, shortened by 6 of 12.7 mm at 3 mm/s, held for 2 s and back; no noise.
fn compressed(test: Test) -> Spec {
    let mut spec = Spec::new("coupon", 7).foam("coupon", 0.1, 8.0, 12.7).ball("r4", 4.0);
    spec.specimens[0].radius_mm = 10.0;
    let ramp = RunTemplate::ramp("coupon", "", 6.0, 3.0);
    spec.runs.push(RunTemplate { test, indenter: None, hold_s: 2.0, unload: true, ..ramp });
    spec
}

fn law(nu: f64) -> Hyperfoam {
    Hyperfoam::new(vec![Term { mu_mpa: 0.1, alpha: 8.0, nu }]).unwrap()
}

/// The forces are the law's; recorded depths are written to 1e-6 mm, which is 1e-5 N of 30.
#[test]
fn a_confined_coupon_is_the_closed_form() {
    let made = made(&compressed(Test::Confined).with(Effect::Poisson { nu: 0.2 }));
    assert_eq!((made.solves, made.runs.len()), (0, 1));
    let run = &made.runs[0];
    assert_eq!((run.file.as_str(), run.test, run.indenter), ("001-coupon-confined-v3-s1-c1.csv", Test::Confined, None));
    let mut largest = 0.0_f64;
    for (d, f) in run.depth_mm.iter().zip(&run.force_n) {
        let exact = -AREA_MM2 * confined_stress_mpa(&law(0.2), 1.0 - d / 12.7);
        assert!((f - exact).abs() < 1e-5, "{d}: {f} {exact}");
        largest = largest.max(*f);
    }
    assert!(largest > 10.0, "{largest}");
}

/// What acts between ball and specimen, or where a ball is pressed, is nothing to a coupon.
#[test]
fn what_a_ball_meets_a_coupon_does_not() {
    let plain = made(&compressed(Test::Uniaxial)).runs;
    let effects = [
        Effect::Friction { coefficient: 0.5 },
        Effect::Adhesion { work_n_per_mm: 0.01, range_mm: 0.1 },
        Effect::Radius { indenter: "r4".to_owned(), error_mm: 0.3 },
        Effect::SlidingBase,
        Effect::Numerics { mesh: Some(0.5), alpha_step: Some(4.0) },
        Effect::StiffSkin { stiffness_n_per_mm2: 0.1 },
        Effect::Anisotropic { depth_power: 0.2, radius_power: 0.1 },
        Effect::Tilt { angle_deg: 5.0, distance_mm: 8.0 },
        Effect::Placebo { variable: Variable::Depth, amplitude: 0.03 },
        Effect::Rest(Rest {
            along: Along::Depth,
            by: None,
            kernel: Kernel::Matern52,
            length: 0.3,
            amplitude: 0.03,
            of: ShareOf::Force,
            draw: 0,
        }),
    ];
    for effect in effects {
        assert_eq!(made(&compressed(Test::Uniaxial).with(effect.clone())).runs, plain, "{effect:?}");
    }
    for effect in [
        Effect::Thickness { height_error_mm: 0.5 },
        Effect::Relaxation(vec![PronyTerm::alike(0.1, 1.0)]),
        Effect::ContactOffset { offset_mm: 0.1 },
        Effect::SensorGain { gain: 1.1 },
        Effect::Lag { lag_s: 0.1 },
        Effect::PlasticSet { share: 0.1 },
        Effect::PowerLaw { amplitude: 0.3, t0_s: 0.1, beta: 0.3 },
    ] {
        assert_ne!(made(&compressed(Test::Uniaxial).with(effect.clone())).runs, plain, "{effect:?}");
    }
}

/// A machine of 0.05 mm/N takes its share of the depth, whatever the material remembers: the force is that of the depth that is left.
#[test]
fn machine_and_coupon_share_the_depth() {
    let terms = vec![PronyTerm::alike(0.3, 0.5)];
    let spec =
        compressed(Test::Uniaxial).with(Effect::Relaxation(terms.clone())).with(Effect::Compliance { mm_per_n: 0.05 });
    let run = &made(&spec).runs[0];
    let left = |(d, f): (&f64, &f64)| 1.0 - (d - 0.05 * f).max(0.0) / 12.7;
    let stretch = run.depth_mm.iter().zip(&run.force_n).map(left).collect();
    let material = Material::from(law(0.0)).relaxing(terms);
    let coupon = Coupon { material: material.unwrap(), mode: Mode::Uniaxial, area_mm2: AREA_MM2 };
    let exact = coupon.follow(&Programme { time_s: run.time_s.clone(), stretch }, &[]).unwrap().force_n(&coupon);
    let peak = run.force_n.iter().copied().fold(0.0, f64::max);
    // the simulation follows four times as many moments: a memory that moves straight between them differs by a ten-thousandth
    for ((t, f), e) in run.time_s.iter().zip(&run.force_n).zip(&exact).filter(|((t, _), _)| **t < 4.0) {
        assert!((f + e).abs() < 5e-4 * peak, "{t}: {f} {e}");
    }
    assert!(0.05 * peak > 0.4, "{peak}");
}

/// A coupon is its own spot: two of them differ by touch and gain, two runs on one by neither.
#[test]
fn a_coupon_is_its_own_spot() {
    let mut spec = compressed(Test::Confined);
    (spec.runs[0].replicates, spec.runs[0].cycles) = (2, 2);
    (spec.noise.contact_jitter_mm, spec.noise.gain_jitter) = (0.02, 0.01);
    let made = made(&spec);
    let of = |spot: i64, cycle: i64| {
        &made.runs.iter().find(|r| (r.spot, r.cycle) == (Some(spot), Some(cycle))).unwrap().force_n
    };
    assert_eq!(of(1, 1), of(1, 2));
    assert_ne!(of(1, 1), of(2, 1));
    // and what softens remembers
    let made = self::made(&spec.with(Effect::Softening { r: 2.0, m_mpa: 0.001, beta: 0.1 }));
    let of = |cycle| &made.runs.iter().find(|r| (r.spot, r.cycle) == (Some(1), Some(cycle))).unwrap().force_n;
    assert!(of(1)[50] > 1.1 * of(2)[50], "{} {}", of(1)[50], of(2)[50]);
}

#[test]
fn mistakes_about_coupons_are_told() {
    let error = |spec: &Spec| simulate(spec, &SOLVER, &|_, _, _| {}).unwrap_err().to_string();
    let mut spec = compressed(Test::Confined);
    spec.runs[0].depth_mm = 12.0;
    assert_eq!(
        error(&spec),
        "coupon \"coupon\": depth_mm with offset and jitter = 12; expected at most 11.43 mm, 90 % of the true height"
    );
    spec.runs[0].indenter = Some("r4".to_owned());
    assert_eq!(error(&spec), "[[run]] 1: there is no ball in the compression of a coupon, such as \"r4\"; known: none");
    spec.runs[0].indenter = None;
    spec.specimens[0].law = TrueLaw::Rigid { reduced_modulus_mpa: 3000.0 };
    assert_eq!(error(&spec), "[[run]] 1: there is no specimen that is not rigid \"coupon\"; known: none");
}

/// At small strain a confined coupon has the modulus `K + 4/3 G`, of which the shear loses `g` and the bulk `k` (thesis Eqs. 10 and 11);
/// with `nu = 0` that is `2/3 mu (1 - k) + 4/3 mu (1 - g)`. A strain of 0.4 % changes the share by about as much.
#[test]
fn shear_and_bulk_relax_by_their_own_parts() {
    for (g, k) in [(0.3, 0.0), (0.0, 0.6), (0.8, 0.1)] {
        let press = |spec: Spec| made(&spec).runs[0].force_n.clone();
        let mut spec = compressed(Test::Confined);
        (spec.runs[0].depth_mm, spec.runs[0].hold_s, spec.runs[0].unload) = (0.05, 4.0, false);
        let elastic = press(spec.clone());
        let relaxed = press(spec.with(Effect::Relaxation(vec![PronyTerm { g, k, tau_s: 0.2 }])));
        let left = relaxed.last().unwrap() / elastic.last().unwrap();
        let expected = ((1.0 - k) + 2.0 * (1.0 - g)) / 3.0;
        assert!((left - expected).abs() < 4e-3, "{g} {k}: {left} {expected}");
    }
}

/// A coupon that is warmed between platens is one that was made larger; in a ring it is squeezed: stretches `[l, 1, 1]`, elastic ones
/// `[l, 1, 1] / (1 + e)`, so that `P = sum 2 mu / (alpha l) [(l/(1+e))^alpha - (l/(1+e)^3)^(-alpha b)]`, none of it at rest.
#[test]
fn a_warmed_coupon_has_grown_and_its_ring_has_not() {
    const STRAIN: f64 = 0.03;
    let grown = 1.0 + STRAIN;
    let warm = |test| {
        let mut spec = compressed(test).with(Effect::Poisson { nu: 0.2 });
        spec.specimens[0].thermal_strain = STRAIN;
        made(&spec).runs[0].clone()
    };
    let mut larger = compressed(Test::Uniaxial).with(Effect::Poisson { nu: 0.2 });
    let one = &mut larger.specimens[0];
    (one.height_mm, one.radius_mm, one.mu_mpa) = (12.7 * grown, 10.0 * grown, one.mu_mpa / grown.powi(3));
    let larger = &made(&larger).runs[0];
    for (a, b) in warm(Test::Uniaxial).force_n.iter().zip(&larger.force_n) {
        // forces are written to 1e-6 N
        assert!((a - b).abs() < 1e-5, "{a} {b}");
    }
    let (alpha, beta) = (8.0, 0.2 / 0.6);
    let stress = |l: f64| 0.2 / (alpha * l) * ((l / grown).powf(alpha) - (l / grown.powi(3)).powf(-alpha * beta));
    // free of stress at (l/g)^alpha = (l/g^3)^(-alpha b): l^(1 + b) = g^(1 + 3 b)
    let rest = grown.powf((1.0 + 3.0 * beta) / (1.0 + beta));
    let ring = warm(Test::Confined);
    for (d, f) in ring.depth_mm.iter().zip(&ring.force_n) {
        let exact = -AREA_MM2 * stress(rest - d.max(0.0) / 12.7);
        assert!((f - exact).abs() < 2e-5, "{d}: {f} {exact}");
    }
}
