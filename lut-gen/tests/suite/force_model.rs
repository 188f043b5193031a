//! The continuous model against solves it was not made from, and its derivatives.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::hint::black_box;
use std::time::Instant;

use lut_gen::solid::contact::Ball;
use lut_gen::solid::law::{Hyperfoam, Term};
use lut_gen::solid::model::{ForceModel, Indentation, ModelSpec, Resolution, Specimen};

const BALL: Ball = Ball { radius_mm: 4.0 };

/// Largest miss of the force over depth, relative to the force at 4 mm, at one point of the parameters.
fn miss(model: &ForceModel, alpha: f64, nu: f64, height_mm: f64) -> f64 {
    let curve = Indentation {
        law: Hyperfoam::new(vec![Term { mu_mpa: 0.2, alpha, nu }]).unwrap(),
        specimen: Specimen { height_mm, ..model.spec().specimen },
        ball: BALL,
        depth_mm: 4.0,
        resolution: model.spec().resolution,
    }
    .solve()
    .unwrap();
    let pairs = curve.depth_mm.iter().zip(&curve.force_n);
    let worst = pairs.map(|(&d, f)| (model.gradient_of(0.2, alpha, nu, d, height_mm).force_n - f).abs());
    worst.fold(0.0, f64::max) / curve.force_n.last().unwrap()
}

/// Issue: below 0.1 % of the force at 4 mm over alpha 1 to 24, here with heights 5 to 25.4 mm.
#[test]
fn interpolation_is_below_a_thousandth_over_exponent_and_height() {
    let spec = ModelSpec {
        heights_mm: Some((5.0, 25.4, 6)),
        alpha_nodes: 8,
        ..ModelSpec::new(Specimen::of_height(12.7), BALL, 4.0)
    };
    let model = ForceModel::build(&spec, &|_, _| {}).unwrap();
    println!("{:?} after {} solves", model.error(), model.solves());
    assert!(model.error().interpolation < 1e-3, "{:?}", model.error());
    // drawn once, uniformly in ln alpha and 1/h
    for (alpha, height) in [(1.13, 5.4), (2.17, 21.0), (4.6, 12.7), (9.3, 7.1), (13.9, 12.7), (22.6, 5.9), (23.4, 17.3)]
    {
        let found = miss(&model, alpha, 0.0, height);
        println!("alpha {alpha}, {height} mm: {found:.2e}");
        assert!(found < 1e-3, "alpha {alpha}, {height} mm: {found}");
    }
    check_derivatives(&model, 0.0);
    let small = model.rescaled(2.0).unwrap();
    for (alpha, d, h) in [(3.0, 1.0, 8.0), (20.0, 4.5, 20.0)] {
        let (one, half) =
            (model.gradient_of(0.2, alpha, 0.0, d, h), small.gradient_of(0.2, alpha, 0.0, d / 2.0, h / 2.0));
        assert!((one.force_n / half.force_n / 4.0 - 1.0).abs() < 1e-12);
        // the block's radius goes with the ball's: a difference of two models
        let e = 1e-4;
        let force = |r: f64| model.rescaled(r).unwrap().gradient_of(0.2, alpha, 0.0, d, h).force_n;
        let quotient = (force(4.0 + e) - force(4.0 - e)) / (2.0 * e);
        // beyond the largest depth the continuation begins elsewhere for another ball: inside only
        if d < 4.0 {
            assert!((one.d_radius / quotient - 1.0).abs() < 1e-6, "{} {quotient}", one.d_radius);
        }
    }
    assert_eq!(model.rescaled(0.0).unwrap_err().to_string(), "radius_mm of the ball = 0 must be positive");
    println!("{:.2} us an evaluation", microseconds(&model));
    assert!(microseconds(&model) < 20.0);
}

/// Five exponents with their slopes against sixteen without, over all of a diagnosis' exponents, from a fifth of the depth on. Nine without miss 0.006 % (rms),
/// six 0.04 %; these 0.007 %, with other balls up to 0.011: below the waves of the mesh (0.03 %).
#[test]
fn slopes_by_the_exponent_are_worth_as_many_solves() {
    let spec = |alpha_nodes, alpha_slopes| ModelSpec {
        alpha: (1.8, 26.0),
        alpha_nodes,
        alpha_slopes,
        checked: false,
        resolution: Resolution::Refined(1.1),
        ..ModelSpec::new(Specimen::of_height(12.7), BALL, 3.5)
    };
    let model = |nodes, slopes| ForceModel::build(&spec(nodes, slopes), &|_, _| {}).unwrap();
    let best = model(16, false);
    let missed = |model: &ForceModel| {
        let places = (0..=40).flat_map(|a| (8..=40).map(move |k| (f64::from(a) / 40.0, f64::from(k) / 40.0)));
        let off = places.map(|(a, share)| {
            let (alpha, d) = (1.8 * (26.0_f64 / 1.8).powf(a), 3.5 * share);
            model.force_n(1.0, alpha, d) / best.force_n(1.0, alpha, d) - 1.0
        });
        let (mut square, mut count, mut worst) = (0.0, 0.0, 0.0_f64);
        for x in off {
            (square, count, worst) = (square + x * x, count + 1.0, worst.max(x.abs()));
        }
        ((square / count).sqrt(), worst)
    };
    let (five, four, values) = (missed(&model(5, true)), missed(&model(4, true)), missed(&model(5, false)));
    println!("five with slopes {five:?}, four {four:?}, five without {values:?}");
    assert!(five.0 < 1.5e-4 && five.1 < 1e-3, "{five:?}");
    assert!(four.0 < 2.5e-4 && values.0 > 3.0 * four.0, "{four:?} {values:?}");
}

/// What another Poisson's ratio changes, by three of them with slopes against eight without, at exponents to 20 and from a fifth of the depth on: 0.17 % of it is missed (rms), 0.19 % of the force at
/// worst; with five without 0.08 and 0.17 %.
#[test]
fn slopes_by_poissons_ratio_are_worth_more_solves() {
    let spec = |nus, alpha_nodes, nu_slopes| ModelSpec {
        nus: Some((0.0, 0.38, nus)),
        alpha: (1.8, 26.0),
        alpha_nodes,
        alpha_slopes: true,
        nu_slopes,
        checked: false,
        resolution: Resolution::Refined(1.1),
        ..ModelSpec::new(Specimen::of_height(12.7), BALL, 3.0)
    };
    let model = |nus, alphas, slopes| ForceModel::build(&spec(nus, alphas, slopes), &|_, _| {}).unwrap();
    let best = model(8, 6, false);
    let missed = |model: &ForceModel| {
        let ratio = |model: &ForceModel, alpha: f64, nu: f64, d: f64| {
            let force = |nu: f64| model.slice(alpha, nu, 12.7).force(d);
            force(nu) / force(0.0)
        };
        let (mut square, mut added, mut worst) = (0.0, 0.0, 0.0_f64);
        for nu in [0.03, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35] {
            for (a, k) in (0..=20).flat_map(|a| (2..=10).map(move |k| (a, k))) {
                let (alpha, d) = (2.0 * 10.0_f64.powf(f64::from(a) / 20.0), 0.3 * f64::from(k));
                let (own, true_one) = (ratio(model, alpha, nu, d), ratio(&best, alpha, nu, d));
                square += (own / true_one - 1.0).powi(2);
                added += (1.0 - 1.0 / true_one).powi(2);
                worst = worst.max((own / true_one - 1.0).abs());
            }
        }
        ((square / added).sqrt(), worst)
    };
    let (three, values) = (missed(&model(3, 4, true)), missed(&model(3, 4, false)));
    println!("three with slopes {three:?}, three without {values:?}");
    assert!(three.0 < 2.5e-3 && three.1 < 3e-3, "{three:?}");
    assert!(values.0 > 3.0 * three.0, "{values:?}");
}

/// Large balls are pressed in little: the mesh is that of the contact. That of the ball left 0.25 % at a tenth of its radius (0.5 % at worst), of which a diagnosis of 36 runs
/// made a base that slides: it takes elastic forces to be within 0.1 to 0.2 %.
#[test]
fn shallow_presses_are_as_exact_as_deep_ones() {
    for (depth_mm, alpha) in [(0.35, 15.0), (1.1, 5.0), (1.1, 15.0), (1.9, 15.0), (4.0, 15.0)] {
        let curve = |resolution| {
            let law = Hyperfoam::new(vec![Term { mu_mpa: 0.02, alpha, nu: 0.0 }]).unwrap();
            let specimen = Specimen { radius_mm: 30.0, ..Specimen::of_height(20.0) };
            Indentation { law, specimen, ball: Ball { radius_mm: 10.0 }, depth_mm, resolution }.solve().unwrap()
        };
        let (standard, fine) = (curve(Resolution::Standard), curve(Resolution::Refined(2.25)));
        let off =
            |share: f64| standard.profile.force_n(share * depth_mm) / fine.profile.force_n(share * depth_mm) - 1.0;
        let square: f64 = (4..=20).map(|k| off(f64::from(k) / 20.0).powi(2)).sum();
        let scatter = (square / 17.0).sqrt();
        println!("{depth_mm} mm of 10 mm, alpha {alpha}: {:.3} %", 100.0 * scatter);
        assert!(scatter < 0.0015, "{depth_mm} mm, alpha {alpha}: {scatter}");
    }
}

#[test]
fn poissons_ratio_is_an_axis_when_wanted() {
    let spec = ModelSpec {
        nus: Some((0.0, 0.45, 6)),
        alpha: (4.0, 14.0),
        alpha_nodes: 5,
        resolution: Resolution::Refined(0.7),
        ..ModelSpec::new(Specimen::of_height(12.7), BALL, 4.0)
    };
    let model = ForceModel::build(&spec, &|_, _| {}).unwrap();
    println!("{:?} after {} solves", model.error(), model.solves());
    for (alpha, nu) in [(5.1, 0.07), (8.8, 0.23), (12.9, 0.41)] {
        let found = miss(&model, alpha, nu, 12.7);
        println!("alpha {alpha}, nu {nu}: {found:.2e}");
        // the scatter of the coarser mesh, 0.1 %, is in it
        assert!(found < 2e-3, "alpha {alpha}, nu {nu}: {found}");
    }
    check_derivatives(&model, 0.2);
    let refused = ForceModel::build(&ModelSpec { nus: Some((0.0, 0.5, 4)), ..spec }, &|_, _| {}).unwrap_err();
    assert_eq!(
        refused.to_string(),
        "nus = 0 must not be negative and lie below the upper end of its range, that below 0.5"
    );
}

/// Against central differences of step 1e-4 of the parameter: truncation of order 1e-8 times
/// the third logarithmic derivative, below 1e-5 for powers up to the tenth.
fn check_derivatives(model: &ForceModel, nu: f64) {
    for (alpha, d, h) in [(4.5, 0.05, 12.7), (7.0, 1.3, 9.0), (11.0, 3.9, 12.7), (13.0, 4.4, 12.7)] {
        let g = model.gradient_of(0.2, alpha, nu, d, h);
        let force = |a: f64, v: f64, d: f64, h: f64| model.gradient_of(0.2, a, v, d, h).force_n;
        let e = 1e-4;
        let pairs = [
            (g.d_alpha * alpha, (force(alpha * (1.0 + e), nu, d, h) - force(alpha * (1.0 - e), nu, d, h)) / (2.0 * e)),
            (g.d_depth * d, (force(alpha, nu, d * (1.0 + e), h) - force(alpha, nu, d * (1.0 - e), h)) / (2.0 * e)),
            (g.d_height * h, (force(alpha, nu, d, h * (1.0 + e)) - force(alpha, nu, d, h * (1.0 - e))) / (2.0 * e)),
            (
                g.d_nu,
                if nu > 0.0 { (force(alpha, nu + e, d, h) - force(alpha, nu - e, d, h)) / (2.0 * e) } else { 0.0 },
            ),
            (g.d_mu * 0.2, g.force_n),
        ];
        for (i, (exact, quotient)) in pairs.iter().enumerate() {
            assert!((exact - quotient).abs() < 1e-5 * g.force_n, "{i} at alpha {alpha}, {d} mm: {exact} {quotient}");
        }
    }
}

/// Time of one evaluation with all derivatives; printed, and bounded generously since tests share cores.
fn microseconds(model: &ForceModel) -> f64 {
    let (count, start) = (20_000, Instant::now());
    for i in 0..count {
        let alpha = 1.0 + 23.0 * f64::from(i) / f64::from(count);
        black_box(model.gradient_of(0.2, alpha, 0.0, black_box(2.0), 12.7));
    }
    start.elapsed().as_secs_f64() * 1e6 / f64::from(count)
}
