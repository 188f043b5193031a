//! Homogeneous tests against closed forms, and their derivatives against differences.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use lut_gen::solid::homogeneous::{Coupon, Mode, Programme};
use lut_gen::solid::law::{Hencky, Hyperfoam, Material, Ogden, OgdenRoxburgh, OgdenTerm, Parameter, PronyTerm, Term};
use lut_gen::solid::verify::{confined_stress_mpa, relaxing_column_mpa};

const MODES: [Mode; 5] = [Mode::Uniaxial, Mode::Confined, Mode::Equibiaxial, Mode::Planar, Mode::SimpleShear];

fn coupon(material: impl Into<Material>, mode: Mode) -> Coupon {
    Coupon { material: material.into(), mode, area_mm2: 10.0 }
}

fn even(stretch: Vec<f64>) -> Programme {
    Programme { time_s: (0..stretch.len()).map(|i| i as f64).collect(), stretch }
}

fn two_terms() -> Hyperfoam {
    Hyperfoam::new(vec![Term { mu_mpa: 0.1, alpha: 8.0, nu: 0.2 }, Term { mu_mpa: 0.02, alpha: -2.0, nu: 0.1 }])
        .unwrap()
}

fn nearly(mu: f64, alpha: f64, d: f64) -> Ogden {
    Ogden::one_term(mu, alpha, d).unwrap()
}

#[test]
fn reference_is_free_of_stress() {
    let laws: [Material; 3] =
        [two_terms().into(), nearly(0.1, 3.0, 1e-3).into(), Hencky::new(0.1, 0.3).unwrap().into()];
    for (law, mode) in laws.iter().flat_map(|l| MODES.map(|m| (l, m))) {
        let r = coupon(law.clone(), mode).follow(&even(vec![1.0, 1.0]), &[]).unwrap();
        assert!(r.stress_mpa.iter().all(|p| p.abs() < 1e-14), "{mode}: {:?}", r.stress_mpa);
        assert_eq!(r.side, [1.0, 1.0]);
    }
}

/// One Hyperfoam term has the lateral stretch `l^-nu` at any strain (thesis Eq. 1), hence
/// `P = 2 mu / alpha (l^alpha - l^(-nu alpha)) / l`; with alpha = 2, nu = 0 that is `mu (l - 1/l)`.
#[test]
fn one_foam_term_in_closed_form() {
    let path = even(vec![0.8, 0.3, 1.5, 0.1]);
    for (alpha, nu) in [(2.0, 0.0), (8.0, 0.3), (-3.0, 0.1), (20.0, -0.2)] {
        let law = Hyperfoam::new(vec![Term { mu_mpa: 0.1, alpha, nu }]).unwrap();
        let uniaxial = coupon(law.clone(), Mode::Uniaxial);
        let r = uniaxial.follow(&path, &[]).unwrap();
        for ((p, side), l) in r.stress_mpa.iter().zip(&r.side).zip(&path.stretch) {
            let exact = 0.2 / alpha * (l.powf(alpha) - l.powf(-nu * alpha)) / l;
            assert!((side - l.powf(-nu)).abs() < 1e-12 * side, "{alpha} {nu} {l}: {side}");
            assert!((p - exact).abs() < 1e-11 * exact.abs(), "{alpha} {nu} {l}: {p} {exact}");
            if alpha == 2.0 {
                assert!((p - 0.1 * (l - 1.0 / l)).abs() < 1e-11 * p.abs());
            }
        }
        assert_eq!(r.force_n(&uniaxial)[1], 10.0 * r.stress_mpa[1]);
    }
}

#[test]
fn confined_foam_is_the_closed_form() {
    let path = even(vec![0.9, 0.5, 1.2]);
    let r = coupon(two_terms(), Mode::Confined).follow(&path, &[]).unwrap();
    for (p, l) in r.stress_mpa.iter().zip(&path.stretch) {
        let exact = confined_stress_mpa(&two_terms(), *l);
        assert!((p - exact).abs() < 1e-13 + 1e-12 * exact.abs(), "{l}: {p} {exact}");
    }
}

/// Incompressible solids (Ogden, Non-linear Elastic Deformations, sec. 7.2): `P = sum 2 mu / alpha (l^(alpha - 1) - l^-q)`
/// with `q` = 1 + alpha / 2 in uniaxial, 1 + 2 alpha in equibiaxial and 1 + alpha in planar tests. With `K = 2 / D` the
/// miss is of order `p^2 / K`, `p` the pressure the side bears: 3e-3 of the stress here (equibiaxial stretch 2), and ten
/// times less for a tenth of D.
#[test]
fn nearly_incompressible_solid_tends_to_the_incompressible_one() {
    let path = even(vec![1.3, 0.6, 2.0]);
    for (mode, times) in [(Mode::Uniaxial, 0.5), (Mode::Equibiaxial, 2.0), (Mode::Planar, 1.0)] {
        let miss = |d: f64| {
            let terms = [(0.1, 3.0), (0.02, -4.0)];
            let term = |(mu_mpa, alpha): (f64, f64)| OgdenTerm { mu_mpa, alpha, d_per_mpa: d };
            let law = Ogden::new(terms.map(term).to_vec()).unwrap();
            let r = coupon(law, mode).follow(&path, &[]).unwrap();
            let pairs = r.stress_mpa.iter().zip(&path.stretch);
            pairs.fold(0.0_f64, |worst, (p, l)| {
                let one = |(mu, a): (f64, f64)| 2.0 * mu / a * (l.powf(a - 1.0) - l.powf(-1.0 - times * a));
                let exact: f64 = terms.map(one).iter().sum();
                worst.max((p / exact - 1.0).abs())
            })
        };
        let (first, second) = (miss(1e-3), miss(1e-4));
        println!("{mode}: {first:.1e} {second:.1e}");
        assert!(first < 3e-3, "{mode}: {first}");
        assert!((first / second - 10.0).abs() < 0.1, "{mode}: {first} {second}");
    }
}

/// Simple shear keeps the volume: with alpha = 2 the stress is `mu gamma` exactly, for either law and any nu or D.
#[test]
fn simple_shear_of_neo_hookean_solids_is_linear() {
    let foam = Hyperfoam::new(vec![Term { mu_mpa: 0.1, alpha: 2.0, nu: 0.3 }]).unwrap();
    let path = even(vec![1.5, 3.0, 0.0, -1.0]);
    for law in [Material::from(foam), Material::from(nearly(0.1, 2.0, 1e-2))] {
        let r = coupon(law, Mode::SimpleShear).follow(&path, &[]).unwrap();
        for (p, l) in r.stress_mpa.iter().zip(&path.stretch) {
            assert!((p - 0.1 * (l - 1.0)).abs() < 1e-13, "{p} {l}");
        }
    }
}

/// Between the samples of a ramp of 40 percent the elastic stress is straight in pieces of one percent.
#[test]
fn relaxing_column_is_the_convolution() {
    let series = vec![PronyTerm { g: 0.3, k: 0.3, tau_s: 0.5 }, PronyTerm { g: 0.2, k: 0.2, tau_s: 20.0 }];
    let law = Hyperfoam::new(vec![Term { mu_mpa: 0.1, alpha: 10.0, nu: 0.25 }]).unwrap();
    let material = Material::from(law).relaxing(series.clone()).unwrap();
    let elastic = |l: f64| 0.02 * (l.powf(10.0) - l.powf(-2.5)) / l;
    let path = Programme { time_s: vec![0.0, 0.5, 1.0, 1.2, 3.0, 60.0], stretch: vec![1.0, 0.8, 0.6, 0.6, 0.6, 0.6] };
    let r = coupon(material, Mode::Uniaxial).follow(&path, &[]).unwrap();
    for (p, t) in r.stress_mpa.iter().zip(&path.time_s).skip(1) {
        let exact = relaxing_column_mpa(elastic, &series, 0.6, 1.0, *t);
        println!("{t}: {:.1e}", p / exact - 1.0);
        assert!((p / exact - 1.0).abs() < 1e-4, "{t}: {p} {exact}");
    }
}

/// What was loaded once is softer on the second way up, by `eta` of its largest energy, and as before at the top.
#[test]
fn softening_shows_below_the_largest_stretch_only() {
    let softening = OgdenRoxburgh::new(1.5, 0.001, 0.1).unwrap();
    let path = even(vec![0.8, 0.6, 0.8, 0.6, 0.5]);
    let hard = coupon(two_terms(), Mode::Uniaxial).follow(&path, &[]).unwrap().stress_mpa;
    let soft = Material::from(two_terms()).softening(softening);
    let soft = coupon(soft, Mode::Uniaxial).follow(&path, &[]).unwrap().stress_mpa;
    for i in [0, 1, 3, 4] {
        assert!((soft[i] / hard[i] - 1.0).abs() < 1e-12, "{i}: {soft:?} {hard:?}");
    }
    assert!(soft[2] / hard[2] < 0.8 && soft[2] / hard[2] > 1.0 / 3.0, "{}", soft[2] / hard[2]);
}

/// Every derivative along a load, hold, unload and reload against central differences with Richardson's rule, over the
/// largest derivative on the way (or the change of force per parameter, where that is larger).
#[test]
fn derivatives_are_those_of_differences() {
    let series = vec![PronyTerm { g: 0.3, k: 0.1, tau_s: 0.5 }, PronyTerm { g: 0.2, k: 0.3, tau_s: 20.0 }];
    let softening = OgdenRoxburgh::new(1.5, 0.001, 0.1).unwrap();
    let ogden = Ogden::new(vec![
        OgdenTerm { mu_mpa: 0.1, alpha: 3.0, d_per_mpa: 0.02 },
        OgdenTerm { mu_mpa: 0.02, alpha: -4.0, d_per_mpa: 0.01 },
    ]);
    let elastic: [Material; 2] = [two_terms().into(), ogden.unwrap().into()];
    let path = Programme {
        time_s: vec![0.0, 0.5, 1.0, 8.0, 8.6, 9.0, 10.0],
        stretch: vec![1.0, 0.8, 0.6, 0.6, 0.85, 1.1, 0.55],
    };
    let mut worst = 0.0_f64;
    for (law, mode) in elastic.iter().flat_map(|l| MODES.map(|m| (l.clone(), m))) {
        let full = law.clone().relaxing(series.clone()).unwrap().softening(softening);
        for material in [law, full] {
            let listed = material.parameters();
            let names: Vec<Parameter> = listed.iter().map(|(p, _)| *p).collect();
            let exact = coupon(material.clone(), mode).follow(&path, &names).unwrap();
            let force = exact.stress_mpa.iter().fold(0.0_f64, |m, p| m.max(p.abs()));
            for (s, (parameter, value)) in exact.sensitivities.iter().zip(listed) {
                let difference = |h: f64| -> Vec<f64> {
                    let [a, b] = [h, -h]
                        .map(|h| coupon(material.shifted(parameter, h), mode).follow(&path, &[]).unwrap().stress_mpa);
                    a.iter().zip(&b).map(|(a, b)| (a - b) / (2.0 * h)).collect()
                };
                let h = 1e-3 * value.abs();
                let (one, two) = (difference(h), difference(0.5 * h));
                let scale = s.stress_mpa.iter().fold(0.01 * force / value.abs(), |m, x| m.max(x.abs()));
                for ((a, b), x) in one.iter().zip(&two).zip(&s.stress_mpa) {
                    let miss = ((4.0 * b - a) / 3.0 - x).abs() / scale;
                    worst = worst.max(miss);
                    assert!(miss < 1e-6, "{mode} {parameter}: {miss:.1e} {x} {b}");
                }
            }
        }
    }
    println!("largest miss {worst:.1e}");
}

/// At tiny strain a fitted foam and a fitted solid differ between modes as nu says: confined over uniaxial modulus is
/// `(1 - nu) / ((1 + nu)(1 - 2 nu))`.
#[test]
fn modes_differ_as_poisson_s_ratio_says() {
    for nu in [0.0, 0.3, 0.49] {
        let law = Hyperfoam::new(vec![Term { mu_mpa: 0.1, alpha: 5.0, nu }]).unwrap();
        let [u, c] = [Mode::Uniaxial, Mode::Confined].map(|mode| {
            let r = coupon(law.clone(), mode).follow(&even(vec![1.0 - 1e-6, 1.0 + 1e-6]), &[]).unwrap();
            r.stress_mpa[1] - r.stress_mpa[0]
        });
        let exact = (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu));
        assert!((c / u / exact - 1.0).abs() < 1e-6, "nu {nu}: {} {exact}", c / u);
    }
}

#[test]
fn what_makes_no_sense_is_refused() {
    let good = coupon(two_terms(), Mode::Uniaxial);
    let say = |coupon: &Coupon, programme: &Programme| coupon.follow(programme, &[]).unwrap_err().to_string();
    assert_eq!(say(&Coupon { area_mm2: 0.0, ..good.clone() }, &even(vec![1.0])), "area_mm2 = 0 must be positive");
    assert_eq!(say(&good, &even(vec![1.0, -0.1])), "stretch = -0.1 (sample 1) must be finite and positive");
    let uneven = Programme { time_s: vec![0.0, 1.0], stretch: vec![1.0] };
    assert_eq!(say(&good, &uneven), "number of stretches = 1 must equal the number of times, 2, and not be 0");
    let back = Programme { time_s: vec![0.0, 0.0], stretch: vec![1.0, 1.0] };
    assert_eq!(say(&good, &back), "time_s = 0 (sample 1) must be finite and above the time before it");
    let unknown = good.follow(&even(vec![1.0]), &[Parameter::PronyTau(0)]).unwrap_err().to_string();
    assert!(unknown.starts_with("tau_1 is no parameter of hyperfoam mu_1 0.1"), "{unknown}");
}

/// A term of negative modulus that takes over when the volume shrinks leaves no lateral stretch without stress.
#[test]
fn a_state_that_does_not_exist_is_named() {
    let terms = [(0.3, 1.0), (-0.2, 3.0)].map(|(mu_mpa, alpha)| Term { mu_mpa, alpha, nu: 0.4 });
    let law = Hyperfoam::new(terms.to_vec()).unwrap();
    let said = coupon(law, Mode::Uniaxial).follow(&even(vec![1.0, 0.3]), &[]).unwrap_err().to_string();
    assert!(said.starts_with("no uniaxial state without lateral stress at stretch 0."), "{said}");
    assert!(said.contains("alpha_2 3"), "{said}");
}

/// Free expansion is stress free, whatever the law, and every stretch is then `1 + e` (thesis Eqs. 3 to 5).
#[test]
fn a_free_specimen_grows_without_stress() {
    let laws: [Material; 3] =
        [two_terms().into(), nearly(0.1, 3.0, 1e-3).into(), Hencky::new(0.1, 0.3).unwrap().into()];
    for (law, strain) in laws.iter().flat_map(|l| [0.02, -0.05, 0.3].map(|e| (l, e))) {
        let warm = law.clone().warmed(strain).unwrap();
        for mode in [Mode::Uniaxial, Mode::Equibiaxial] {
            let grown = 1.0 + strain;
            let coupon = coupon(warm.clone(), mode);
            // rounding: a stress of K = 2000 MPa is known to 1e-12 MPa, over Young's modulus of 0.3 MPa and the lateral stretch
            assert!((coupon.rest_stretch().unwrap() - grown).abs() < 1e-10, "{mode} {strain}");
            let r = coupon.follow(&even(vec![grown, grown]), &[]).unwrap();
            // the lateral stretch is settled to 1e-13, which is K 1e-13
            assert!(r.stress_mpa.iter().all(|p| p.abs() < 1e-9), "{mode} {strain}: {:?}", r.stress_mpa);
            assert!((r.side[1] - grown).abs() < 1e-12, "{mode} {strain}: {:?}", r.side);
        }
    }
}

/// A foam that is warmed in a ring between fixed faces: all stretches stay 1, the elastic ones are `1 / (1 + e)`, so that
/// `P = 1/(1+e) sum 2 mu/alpha (1+e) [(1+e)^-alpha - (1+e)^(3 alpha b)]`. To first order that is `-3 K e`.
#[test]
fn confined_heating_is_the_closed_form() {
    for strain in [0.001, 0.05, -0.1] {
        let grown: f64 = 1.0 + strain;
        let warm = Material::from(two_terms()).warmed(strain).unwrap();
        let p = coupon(warm, Mode::Confined).follow(&even(vec![1.0, 1.0]), &[]).unwrap().stress_mpa[1];
        let term = |mu: f64, alpha: f64, nu: f64| {
            let beta = nu / (1.0 - 2.0 * nu);
            (2.0 * mu / alpha * (grown.powf(-alpha) - grown.powf(3.0 * alpha * beta)), 2.0 * mu * (1.0 / 3.0 + beta))
        };
        let ((a, bulk_a), (b, bulk_b)) = (term(0.1, 8.0, 0.2), term(0.02, -2.0, 0.1));
        assert!((p - (a + b)).abs() < 1e-13, "{strain}: {p} {}", a + b);
        let linear = -3.0 * (bulk_a + bulk_b) * strain;
        // the next term is of the order alpha e
        assert!((p / linear - 1.0).abs() < 10.0 * strain.abs(), "{strain}: {p} {linear}");
    }
}

/// Derivatives of a warmed, relaxing specimen by every parameter, the thermal strain among them, against differences.
#[test]
fn a_warmed_specimen_has_its_derivatives() {
    let series = vec![PronyTerm { g: 0.3, k: 0.1, tau_s: 0.8 }];
    let warm = Material::from(two_terms()).relaxing(series).unwrap().warmed(0.04).unwrap();
    let path = even(vec![1.04, 0.9, 0.7, 0.7, 0.8]);
    for mode in [Mode::Uniaxial, Mode::Confined, Mode::Planar] {
        let parameters: Vec<Parameter> = warm.parameters().iter().map(|(p, _)| *p).collect();
        assert!(parameters.contains(&Parameter::ThermalStrain));
        let exact = coupon(warm.clone(), mode).follow(&path, &parameters).unwrap();
        for sensitivity in &exact.sensitivities {
            let at =
                |by: f64| coupon(warm.shifted(sensitivity.parameter, by), mode).follow(&path, &[]).unwrap().stress_mpa;
            let h = 1e-5;
            let scale = sensitivity.stress_mpa.iter().fold(1e-3_f64, |m, s| m.max(s.abs()));
            for ((low, high), value) in at(-h).iter().zip(at(h)).zip(&sensitivity.stress_mpa) {
                // h^2 alpha^3 of the quotient, and rounding of the lateral stretch over h
                assert!(((high - low) / (2.0 * h) - value).abs() < 1e-6 * scale, "{mode} {}", sensitivity.parameter);
            }
        }
    }
}
