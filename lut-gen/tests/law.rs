//! The material law: energy -> stress -> tangent, limits, closed forms.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use lut_gen::law::{Gradient, Hyperfoam, Law, Term, first_piola, respond};
use lut_gen::verify::{central_gradient, worst_mismatch};
use proptest::prelude::*;

/// Central differences with Richardson: a power `n` of a stretch or of `J` has a truncation
/// near `(n STEP)^4` with the step taken relative to `n` and to the smallest length, so 1e-7
/// for `n STEP = 0.02`; rounding is 1e-16 over that.
const BY_DIFFERENCES: f64 = 2e-6;
const STEP: f64 = 0.02;

/// Largest power that a term raises a stretch or `J` to in its second derivative.
fn power(t: &Term) -> f64 {
    t.alpha.abs() * (t.nu / (1.0 - 2.0 * t.nu)).abs().max(1.0) + 2.0
}

/// Checks a law at one deformation gradient; every law is checked by this function.
fn check_derivatives(law: &Hyperfoam, f: &Gradient) {
    let det = f[0] * f[3] - f[1] * f[2];
    let length = f[4].min(det / f[..4].iter().fold(0.0_f64, |m, x| m.max(x.abs()))).min(1.0);
    let step = STEP * length / law.terms().iter().map(power).fold(0.0, f64::max);
    let exact = respond(law, f).expect("orientation is preserved");
    let energy = |f: &Gradient| first_piola(law, f).expect("orientation is preserved").0;
    let stress = central_gradient(energy, f, step);
    assert!(worst_mismatch(&exact.stress, &stress) < BY_DIFFERENCES, "stress at {f:?}: {:?} {stress:?}", exact.stress);
    for i in 0..5 {
        let row = central_gradient(|f| first_piola(law, f).unwrap().1[i], f, step);
        let scale = exact.tangent.iter().flatten().fold(0.0_f64, |m, x| m.max(x.abs()));
        for (j, (by_difference, value)) in row.iter().zip(exact.tangent[i]).enumerate() {
            let miss = (by_difference - value).abs() / scale;
            assert!(miss < BY_DIFFERENCES, "tangent {i}{j} at {f:?}: {value} {by_difference}");
        }
    }
}

fn two_terms() -> Hyperfoam {
    Hyperfoam::new(vec![Term { mu_mpa: 0.15, alpha: 8.0, nu: 0.0 }, Term { mu_mpa: 0.05, alpha: -4.0, nu: 0.2 }])
        .unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn energy_stress_and_tangent_agree(
        alpha in 1.0..24.0_f64,
        nu in prop_oneof![Just(0.0), -0.3..0.45_f64],
        rr in 0.6..1.3_f64, zz in 0.4..1.2_f64, tt in 0.7..1.3_f64,
        rz in -0.3..0.3_f64, zr in -0.3..0.3_f64,
    ) {
        let f = [rr, rz, zr, zz, tt];
        prop_assume!(rr * zz - rz * zr > 0.2);
        let law = Hyperfoam::new(vec![Term { mu_mpa: 0.1, alpha, nu }]).unwrap();
        check_derivatives(&law, &f);
        check_derivatives(&two_terms(), &f);
    }

    #[test]
    fn stress_turns_with_the_body(angle in -3.1..3.1_f64, rr in 0.6..1.3_f64, zz in 0.4..1.2_f64, rz in -0.2..0.2_f64) {
        let law = two_terms();
        let (c, s) = (angle.cos(), angle.sin());
        let f = [rr, rz, 0.0, zz, 1.1];
        let turned = [c * f[0] - s * f[2], c * f[1] - s * f[3], s * f[0] + c * f[2], s * f[1] + c * f[3], f[4]];
        let p = first_piola(&law, &f).unwrap().1;
        let expected = [c * p[0] - s * p[2], c * p[1] - s * p[3], s * p[0] + c * p[2], s * p[1] + c * p[3], p[4]];
        // rounding of a few hundred operations
        prop_assert!(worst_mismatch(&first_piola(&law, &turned).unwrap().1, &expected) < 1e-12);
    }
}

#[test]
fn equal_stretches_have_the_limit_of_the_shear_terms() {
    for difference in [0.0, 1e-12, 1e-7, 0.9e-5, 1.1e-5, 1e-4] {
        check_derivatives(&two_terms(), &[0.8 + difference, 0.0, 0.0, 0.8, 0.9]);
    }
    check_derivatives(&two_terms(), &[1.02, 0.0, 0.0, 1.02, 1.02]);
}

#[test]
fn the_rest_state_has_no_stress_and_linear_elastic_moduli() {
    let law = Hyperfoam::new(vec![Term { mu_mpa: 0.1, alpha: 7.0, nu: 0.3 }]).unwrap();
    let r = respond(&law, &[1.0, 0.0, 0.0, 1.0, 1.0]).unwrap();
    assert!(r.energy.abs() < 1e-15 && r.stress.iter().all(|p| p.abs() < 1e-15));
    // Hooke: lambda = 2 mu nu / (1 - 2 nu); the rest is rounding
    let lambda = 2.0 * 0.1 * 0.3 / 0.4;
    assert!((r.tangent[0][0] - (lambda + 0.2)).abs() < 1e-12);
    assert!((r.tangent[0][3] - lambda).abs() < 1e-12);
    assert!((r.tangent[1][1] - 0.1).abs() < 1e-12 && (r.tangent[1][2] - 0.1).abs() < 1e-12);
    assert!((law.poisson_ratio() - 0.3).abs() < 1e-12 && (law.shear_modulus_mpa() - 0.1).abs() < 1e-12);
}

#[test]
fn poisson_zero_is_the_limit_of_small_poisson() {
    let law = |nu| Hyperfoam::new(vec![Term { mu_mpa: 0.1, alpha: 11.0, nu }]).unwrap();
    let f = [1.1, 0.1, -0.05, 0.5, 0.9];
    let (zero, small) = (respond(&law(0.0), &f).unwrap(), respond(&law(1e-9), &f).unwrap());
    // the laws differ by O(alpha nu) = 1e-8
    assert!(worst_mismatch(&zero.stress, &small.stress) < 1e-7);
    assert!((zero.energy / small.energy - 1.0).abs() < 1e-7);
}

/// Uniaxial stress with `nu = 0`: the sides stay, `P = 2 mu/alpha (l^(alpha-1) - 1/l)`.
#[test]
fn uniaxial_closed_form() {
    let (mu, alpha) = (0.22, 10.53);
    let law = Hyperfoam::one_term(mu, alpha).unwrap();
    for l in [0.2_f64, 0.5, 0.9, 1.0, 1.2] {
        let closed = 2.0 * mu / alpha * (l.powf(alpha - 1.0) - 1.0 / l);
        let p = first_piola(&law, &[1.0, 0.0, 0.0, l, 1.0]).unwrap().1;
        assert!((p[3] - closed).abs() < 1e-14 && p[0].abs() < 1e-15 && p[4].abs() < 1e-15);
        assert!((law.uniaxial_stress_mpa(l) - closed).abs() < 1e-14);
    }
}

#[test]
fn an_inverted_gradient_has_no_response() {
    let law = two_terms();
    assert!(respond(&law, &[-1.0, 0.0, 0.0, 1.0, 1.0]).is_none());
    assert!(first_piola(&law, &[1.0, 0.0, 0.0, 1.0, 0.0]).is_none());
    assert!(respond(&law, &[f64::NAN, 0.0, 0.0, 1.0, 1.0]).is_none());
}

#[test]
fn parameters_out_of_range_are_named() {
    let say = |terms| Hyperfoam::new(terms).unwrap_err().to_string();
    let t = Term { mu_mpa: 0.1, alpha: 8.0, nu: 0.0 };
    assert_eq!(say(vec![]), "hyperfoam term 0: number of terms = 0 but at least one is needed");
    assert_eq!(say(vec![t, Term { alpha: 0.0, ..t }]), "hyperfoam term 2: alpha = 0 must be finite and not zero");
    assert_eq!(say(vec![Term { nu: 0.5, ..t }]), "hyperfoam term 1: nu = 0.5 must lie in (-1, 0.5)");
    assert_eq!(say(vec![Term { mu_mpa: -0.1, ..t }]), "hyperfoam term 0: sum of mu_mpa = -0.1 must be positive");
    assert_eq!(say(vec![Term { mu_mpa: f64::NAN, ..t }]), "hyperfoam term 1: mu_mpa = NaN must be finite and not zero");
}
