//! The material law: energy -> stress -> tangent, limits, closed forms.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use lut_gen::scalar::{Dual, Real};
use lut_gen::solid::law::{
    Elastic, Gradient, Hencky, Hyperfoam, Law, Material, Ogden, OgdenRoxburgh, OgdenTerm, Parameter, PronyTerm, Term,
    first_piola, first_piola_dual, respond,
};
use lut_gen::solid::verify::{central_gradient, worst_mismatch};
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

/// Step for a law at a gradient.
fn step(law: &Elastic, f: &Gradient) -> f64 {
    let det = f[0] * f[3] - f[1] * f[2];
    let length = f[4].min(det / f[..4].iter().fold(0.0_f64, |m, x| m.max(x.abs()))).min(1.0);
    let powers = match law {
        Elastic::Hyperfoam(law) => law.terms().iter().map(power).fold(0.0, f64::max),
        Elastic::Ogden(law) => law.terms().iter().map(|t| t.alpha.abs() + 8.0).fold(0.0, f64::max),
        Elastic::Hencky(_) => 4.0,
    };
    STEP * length / powers
}

/// Checks a law at one deformation gradient; every law is checked by this function:
/// energy to stress to tangent, and the stress carried as a dual number by a parameter and by
/// the gradient at once.
fn check_derivatives(law: &Elastic, f: &Gradient) {
    let h = step(law, f);
    let exact = respond(law, f).expect("orientation is preserved");
    let energy = |f: &Gradient| first_piola(law, f).expect("orientation is preserved").0;
    let stress = central_gradient(energy, f, h);
    assert!(worst_mismatch(&exact.stress, &stress) < BY_DIFFERENCES, "stress at {f:?}: {:?} {stress:?}", exact.stress);
    for i in 0..5 {
        let row = central_gradient(|f| first_piola(law, f).unwrap().1[i], f, h);
        let scale = exact.tangent.iter().flatten().fold(0.0_f64, |m, x| m.max(x.abs()));
        for (j, (by_difference, value)) in row.iter().zip(exact.tangent[i]).enumerate() {
            let miss = (by_difference - value).abs() / scale;
            assert!(miss < BY_DIFFERENCES, "tangent {i}{j} at {f:?}: {value} {by_difference}");
        }
    }
    let material = Material { elastic: law.clone(), prony: Vec::new(), softening: None, thermal: None };
    for (parameter, value) in material.parameters() {
        let direction = [0.3, -0.2, 0.5, 0.4, -0.6];
        let moving: [Dual; 5] = std::array::from_fn(|i| Dual::new(f[i], direction[i]));
        let dual = first_piola_dual(&material.lift(parameter).elastic, &moving).unwrap().1.map(Real::derivative);
        // both at once along the line, with the same relative step for parameter and gradient
        let pole = if matches!(parameter, Parameter::Nu(_)) { (0.5 - value).min(1.0) } else { 1.0 };
        let scale = h * pole / value.abs().max(1.0);
        let at = |s: f64| {
            let g = std::array::from_fn(|i| f[i] + s * direction[i]);
            first_piola(&material.shifted(parameter, s).elastic, &g).unwrap().1
        };
        let quotient: [f64; 5] = std::array::from_fn(|i| {
            let central = |s: f64| (at(s)[i] - at(-s)[i]) / (2.0 * s);
            (4.0 * central(0.5 * scale) - central(scale)) / 3.0
        });
        // rounding: the stress over the step; 1e-15 * 50 / 1e-4
        assert!(worst_mismatch(&dual, &quotient) < 1e-5, "{parameter} at {f:?}: {dual:?} {quotient:?}");
    }
}

fn ogden(alpha: f64, d: f64) -> Ogden {
    let first = OgdenTerm { mu_mpa: 0.1, alpha, d_per_mpa: d };
    Ogden::new(vec![first, OgdenTerm { mu_mpa: 0.02, alpha: -2.0, d_per_mpa: 5.0 * d }]).unwrap()
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
        check_derivatives(&Elastic::Hyperfoam(law), &f);
        check_derivatives(&Elastic::Hyperfoam(two_terms()), &f);
    }

    #[test]
    fn ogden_and_linear_energy_stress_and_tangent_agree(
        alpha in prop_oneof![-8.0..-1.0_f64, 1.0..12.0_f64],
        d in 0.1..20.0_f64, nu in -0.3..0.49_f64,
        rr in 0.6..1.3_f64, zz in 0.4..1.2_f64, tt in 0.7..1.3_f64,
        rz in -0.3..0.3_f64, zr in -0.3..0.3_f64,
    ) {
        let f = [rr, rz, zr, zz, tt];
        prop_assume!(rr * zz - rz * zr > 0.2);
        check_derivatives(&Elastic::Ogden(ogden(alpha, d)), &f);
        check_derivatives(&Elastic::Hencky(Hencky::new(0.1, nu).unwrap()), &f);
    }

    /// A relaxing, softening material: stress and tangent at the end of a step, from any history
    /// that two earlier steps leave behind, also on the unloading side.
    #[test]
    fn the_tangent_of_a_step_is_the_derivative_of_its_stress(
        g in 0.0..0.6_f64, k in 0.0..0.6_f64, tau in 0.01..10.0_f64, dt in 0.0..3.0_f64, softens in any::<bool>(), warms in any::<bool>(),
        rr in 0.7..1.2_f64, zz in 0.5..1.1_f64, tt in 0.8..1.2_f64, rz in -0.2..0.2_f64, zr in -0.2..0.2_f64,
    ) {
        let series = vec![PronyTerm { g, k, tau_s: tau }, PronyTerm { g: 0.1, k: 0.2, tau_s: 1.0 }];
        let mut material = Material::from(two_terms()).relaxing(series).unwrap();
        if softens {
            material = material.softening(OgdenRoxburgh::new(1.5, 0.001, 0.2).unwrap());
        }
        if warms {
            material = material.warmed(0.07).unwrap();
        }
        let mut history = vec![0.0; material.history()];
        for early in [[0.9, 0.1, 0.0, 0.6, 0.95], [0.8, 0.1, 0.1, 0.45, 0.9]] {
            let old = history.clone();
            material.stress(&material.relaxation(0.3), &early, &old, Some(&mut history)).unwrap();
        }
        let step = material.relaxation(dt);
        let f = [rr, rz, zr, zz, tt];
        prop_assume!(rr * zz - rz * zr > 0.3);
        let exact = material.respond(&step, &f, &history).unwrap();
        let h = 2e-4 * 0.3;
        for i in 0..5 {
            let stress = |f: &Gradient| material.stress(&step, f, &history, None).unwrap().1[i];
            let row = central_gradient(stress, &f, h);
            prop_assert!((exact.stress[i] - stress(&f)).abs() < 1e-12);
            let scale = exact.tangent.iter().flatten().fold(0.0_f64, |m, x| m.max(x.abs()));
            for (difference, value) in row.iter().zip(exact.tangent[i]) {
                // the step relative to the power 12 is 0.002; rounding 1e-16 / 6e-5
                prop_assert!((difference - value).abs() < BY_DIFFERENCES * scale, "row {i}: {difference} {value}");
            }
        }
        if material.is_symmetric() {
            for i in 0..5 { for j in 0..i {
                prop_assert!((exact.tangent[i][j] - exact.tangent[j][i]).abs() < 1e-10);
            }}
        }
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
        check_derivatives(&Elastic::Hyperfoam(two_terms()), &[0.8 + difference, 0.0, 0.0, 0.8, 0.9]);
    }
    check_derivatives(&Elastic::Hyperfoam(two_terms()), &[1.02, 0.0, 0.0, 1.02, 1.02]);
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

#[test]
fn parameters_of_the_other_laws_out_of_range_are_named() {
    let ogden = |alpha, d| Ogden::one_term(0.1, alpha, d).unwrap_err().to_string();
    assert_eq!(ogden(0.0, 1.0), "ogden term 1: alpha = 0 must be finite and not zero");
    assert_eq!(ogden(2.0, 0.0), "ogden term 1: d_per_mpa = 0 must be positive");
    let five = vec![OgdenTerm { mu_mpa: 0.1, alpha: 2.0, d_per_mpa: 1.0 }; 5];
    assert_eq!(Ogden::new(five).unwrap_err().to_string(), "ogden term 0: number of terms = 5 but 1 to 4 are allowed");
    assert_eq!(Hencky::new(0.1, 0.5).unwrap_err().to_string(), "linear elastic term 1: nu = 0.5 must lie in (-1, 0.5)");
    let relax = |g, tau_s| {
        Material::from(two_terms()).relaxing(vec![PronyTerm { g, k: 0.0, tau_s }; 2]).unwrap_err().to_string()
    };
    assert_eq!(relax(1.0, 1.0), "prony term 1: g = 1 must lie in [0, 1)");
    assert_eq!(relax(0.5, 1.0), "prony term 0: sum of g = 1 must be below 1");
    assert_eq!(relax(0.2, 0.0), "prony term 1: tau_s = 0 must be positive");
    assert_eq!(
        OgdenRoxburgh::new(1.0, 0.1, 0.1).unwrap_err().to_string(),
        "ogden-roxburgh term 1: r = 1 must be above 1"
    );
}

/// Ogden's initial moduli, from the tangent at rest: `mu_0 = sum mu`, `K_0 = 2 / D_1`.
#[test]
fn ogden_at_rest_is_linear_elastic() {
    let law = ogden(7.0, 4.0);
    let r = respond(&law, &[1.0, 0.0, 0.0, 1.0, 1.0]).unwrap();
    let (mu, bulk) = (0.12, 0.5);
    assert!(r.stress.iter().all(|p| p.abs() < 1e-15));
    assert!((r.tangent[0][0] - (bulk + 4.0 / 3.0 * mu)).abs() < 1e-12);
    assert!((r.tangent[0][3] - (bulk - 2.0 / 3.0 * mu)).abs() < 1e-12);
    let nu = (3.0 * bulk - 2.0 * mu) / (6.0 * bulk + 2.0 * mu);
    assert!((law.poisson_ratio() - nu).abs() < 1e-14);
}

/// A warmed block of the law is the grown block of `mu (1 + e)^-3`: stress over the grown faces at the stretches from the grown state.
#[test]
fn a_warmed_block_is_a_grown_one() {
    let strain = 0.06;
    let grown: f64 = 1.0 + strain;
    let law = |part: f64| {
        Hyperfoam::new(vec![
            Term { mu_mpa: 0.15 * part, alpha: 8.0, nu: 0.1 },
            Term { mu_mpa: 0.05 * part, alpha: -4.0, nu: 0.2 },
        ])
        .unwrap()
    };
    let warm = Material::from(law(1.0)).warmed(strain).unwrap();
    let f = [0.9, 0.1, -0.05, 0.6, 1.05];
    let step = warm.relaxation(1.0);
    let p = warm.stress(&step, &f, &[], None).unwrap().1;
    let of_grown = first_piola(&law(grown.powi(-3)), &f.map(|x| x / grown)).unwrap().1.map(|x| x * grown * grown);
    // rounding of a few hundred operations
    assert!(worst_mismatch(&p, &of_grown) < 1e-12, "{p:?} {of_grown:?}");
    assert_eq!(
        Material::from(law(1.0)).warmed(-1.0).unwrap_err().to_string(),
        "thermal expansion term 0: strain = -1 must be above -1"
    );
}

/// Two stretches are one rotation apart from a ramp with a corner: the update must not depend on
/// how a straight ramp of the stress is cut into steps (it is exact), and a long hold must end at
/// the long-time modulus.
#[test]
fn relaxation_is_exact_for_a_ramp_of_the_stress_and_ends_at_the_long_time_modulus() {
    let series = vec![PronyTerm { g: 0.3, k: 0.3, tau_s: 0.7 }, PronyTerm { g: 0.2, k: 0.2, tau_s: 5.0 }];
    let elastic = Material::from(Hencky::new(1e-3, 0.0).unwrap());
    let material = elastic.clone().relaxing(series.clone()).unwrap();
    // so small a strain that the stress is a straight line in time to 1e-9
    let at = |t: f64| [1.0, 0.0, 0.0, 1.0 - 1e-9 * t.min(2.0), 1.0];
    let follow = |steps: usize, end: f64| {
        let mut history = vec![0.0; material.history()];
        let mut stress = 0.0;
        for i in 1..=steps {
            let old = history.clone();
            let f = at(end * i as f64 / steps as f64);
            stress =
                material.stress(&material.relaxation(end / steps as f64), &f, &old, Some(&mut history)).unwrap().1[3];
        }
        stress
    };
    let (one, many) = (follow(1, 2.0), follow(50, 2.0));
    assert!((one / many - 1.0).abs() < 1e-7, "{one} {many}");
    // closed form of a ramp: sum over elements of tau/t (1 - exp(-t/tau))
    let left: f64 =
        1.0 - series.iter().map(|t| t.g * (1.0 - t.tau_s / 2.0 * (1.0 - (-2.0 / t.tau_s).exp()))).sum::<f64>();
    let instant = first_piola(&elastic.elastic, &at(2.0)).unwrap().1[3];
    assert!((one / (instant * left) - 1.0).abs() < 1e-7);
    let late = follow(400, 200.0);
    assert!((late / (0.5 * instant) - 1.0).abs() < 1e-6, "{late} {instant}");
}

/// First loading is not softened; unloading follows Ogden and Roxburgh's factor, and so does
/// reloading up to the largest energy.
#[test]
fn softening_follows_its_formula() {
    let soft = OgdenRoxburgh::new(1.6, 0.002, 0.1).unwrap();
    let material = Material::from(two_terms()).softening(soft);
    let mut history = vec![0.0; material.history()];
    let step = material.relaxation(1.0);
    let column = |l: f64| [1.0, 0.0, 0.0, l, 1.0];
    let mut follow = |l: f64| {
        let old = history.clone();
        material.stress(&step, &column(l), &old, Some(&mut history)).unwrap()
    };
    let virgin = |l: f64| first_piola(&material.elastic, &column(l)).unwrap();
    for l in [0.8, 0.5] {
        assert_eq!(follow(l), virgin(l));
    }
    let largest = virgin(0.5).0;
    for l in [0.7, 0.6] {
        let (energy, p) = virgin(l);
        let eta = 1.0 - libm::erf((largest - energy) / (0.002 + 0.1 * largest)) / 1.6;
        assert!((follow(l).1[3] / (eta * p[3]) - 1.0).abs() < 1e-14 && eta < 0.9);
    }
    assert_eq!(follow(0.45), virgin(0.45));
}

#[test]
fn parameters_are_listed_and_named() {
    let material = Material::from(ogden(3.0, 1.0)).relaxing(vec![PronyTerm { g: 0.1, k: 0.2, tau_s: 3.0 }]).unwrap();
    let names: Vec<String> = material.parameters().iter().map(|(p, v)| format!("{p}={v}")).collect();
    let wanted =
        ["mu_1=0.1", "alpha_1=3", "d_1=1", "mu_2=0.02", "alpha_2=-2", "d_2=5", "g_1=0.1", "k_1=0.2", "tau_1=3"];
    assert_eq!(names, wanted);
    assert!(material.label().starts_with("ogden mu_1 0.1, alpha_1 3, d_1 1, "));
    let law = material.lift(Parameter::PronyTau(0));
    assert_eq!((law.prony[0].tau_s, law.prony[0].g), (Dual::new(3.0, 1.0), Dual::new(0.1, 0.0)));
}
