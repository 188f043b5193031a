//! Whole indentations: Hertz, convergence, scaling, balance, errors.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use lut_gen::solid::contact::{Ball, Interface, Penalty, Surface};
use lut_gen::solid::element::Quadrature;
use lut_gen::solid::law::{Hyperfoam, Term};
use lut_gen::solid::mesh::{BlockMesh, Sizes};
use lut_gen::solid::model::{Indentation, Resolution, Specimen};
use lut_gen::solid::solve::{Base, Course, Motion, Newton, Stepping, System};
use lut_gen::solid::verify::hertz_force_n;

fn block(alpha: f64, height_mm: f64, radius_mm: f64, depth_mm: f64) -> Indentation {
    Indentation {
        law: Hyperfoam::one_term(0.1, alpha).unwrap(),
        specimen: Specimen::of_height(height_mm),
        ball: Ball { radius_mm },
        depth_mm,
        resolution: Resolution::Standard,
    }
}

/// Hertz at small depth, with `E = 2 mu (1 + nu)`, on the raw equilibria: nothing of
/// Hertz is put in.
///
/// Ball R = 1 mm, block of 60 R; at d = 0.01 mm the contact radius a = 0.1 mm spans 12
/// elements. Hertz neglects that compressible surface points move inward with the
/// load, an effect of order a/R: measured 2 % at d = 0.01 and half of that at a quarter of
/// the depth. So `2 F(d/4)/H(d/4) - F(d)/H(d)` is freed from it; what remains is a/h
/// (0.2 %), (a/R)^2 and the scatter of the mesh with 6 elements in contact: tolerance 0.6 %.
#[test]
fn small_depth_is_hertz() {
    for nu in [0.0, 0.3] {
        let (deep, shallow) = (force_over_hertz(nu, 0.01), force_over_hertz(nu, 0.0025));
        println!("nu {nu}: force over Hertz {deep} at 0.01, {shallow} at 0.0025");
        assert!((deep - 1.0).abs() < 0.03, "nu {nu}: {deep}");
        assert!((2.0 * shallow - deep - 1.0).abs() < 0.006, "nu {nu}: {shallow} {deep}");
    }
}

fn force_over_hertz(nu: f64, depth_mm: f64) -> f64 {
    let sizes = Sizes {
        axis: 0.006,
        growth_under: 0.05,
        near: 0.2,
        growth_far: 0.5,
        surface: 0.008,
        growth_down: 0.35,
        refinement: 1.0,
    };
    let ball = Ball { radius_mm: 1.0 };
    let law = Hyperfoam::new(vec![Term { mu_mpa: 0.1, alpha: 2.0, nu }]).unwrap();
    let mesh = BlockMesh::new(60.0, 60.0, ball.radius_mm, &sizes);
    let surface =
        Surface::new(ball, Interface::default(), &mesh.nodes, &mesh.top, 0.3, 8, Penalty::linear(1000.0 * 0.1));
    let system = System::new(&mesh, Base::Bonded, surface, Quadrature::Reduced);
    let stepping = Stepping { first: 0.001, stations: 8, ..Stepping::of_ball(1.0) };
    let (material, motion) = (law.into(), Motion::ramp(depth_mm, 1.0));
    let course = Course {
        system: &system,
        material: &material,
        motion: &motion,
        newton: Newton::default(),
        stepping,
        hertz: 1.0,
        label: "Hertz",
    };
    let path = course.follow(&mut ()).unwrap();
    let [.., before, last] = path.stations.as_slice() else { panic!("no stations") };
    // dF/dd of d^(3/2), to the mesh's scatter; a = sqrt(R d) to the width of an element
    assert!((last.slope * last.depth_mm / last.force_n - 1.5).abs() < 0.06);
    assert!((last.contact_radius_mm / last.depth_mm.sqrt() - 1.0).abs() < 0.15);
    // the penalty's share, 1 to 2 %, to first order (its energy grows with d^2: factor 1 at the middle)
    let rise = (last.penalty_energy - before.penalty_energy) / (last.depth_mm - before.depth_mm);
    let correction = rise * 2.0 * last.depth_mm / (last.depth_mm + before.depth_mm);
    (last.force_n + correction) / hertz_force_n(0.1, nu, 1.0, last.depth_mm)
}

/// Force converges with the mesh: the difference to a fine mesh falls with refinement.
/// The curve is smooth to 0.2 % on the standard mesh (figures in docs/physics.md).
#[test]
fn force_converges_with_the_mesh() {
    let depths: Vec<f64> = (2..=16).map(|i| 0.25 * f64::from(i)).collect();
    let error = |factor: f64, truth: &[f64]| {
        let problem = Indentation { resolution: Resolution::Refined(factor), ..block(10.526, 12.7, 4.0, 4.0) };
        let curve = problem.solve_at(&depths).unwrap();
        let square: f64 = curve.force_n.iter().zip(truth).map(|(a, b)| (a / b - 1.0).powi(2)).sum();
        (square / depths.len() as f64).sqrt()
    };
    let fine = Indentation { resolution: Resolution::Refined(2.0), ..block(10.526, 12.7, 4.0, 4.0) };
    let truth = fine.solve_at(&depths).unwrap().force_n;
    let (coarse, standard) = (error(0.5, &truth), error(1.0, &truth));
    assert!(standard < 0.002, "{standard}");
    // at least first order with margin for the scatter of the contact edge
    assert!(standard < 0.5 * coarse, "{coarse} {standard}");
}

/// `F = mu R^2 phi(alpha, d/R, h/R, W/R)`: exact for the equations, hence equal to the
/// solver's tolerance (1e-4 of the contact force, its effect on the total force below 1e-5).
#[test]
fn force_is_linear_in_mu_and_scales_with_the_ball() {
    let one = block(7.0, 12.0, 4.0, 3.0);
    let mut other = block(7.0, 6.0, 2.0, 1.5);
    other.specimen.radius_mm = 12.5;
    other.law = Hyperfoam::one_term(0.013, 7.0).unwrap();
    let a = one.solve().unwrap().force_n;
    let b = other.solve().unwrap().force_n;
    for (x, y) in a.iter().zip(&b) {
        assert!((y / x * (0.1 / 0.013) * 4.0 - 1.0).abs() < 1e-5, "{x} {y}");
    }
}

/// The force from the contact is the reaction of the base (global equilibrium), and the
/// slope from the tangent is the derivative of the force.
#[test]
fn contact_force_and_base_reaction_agree_and_the_slope_is_the_derivative() {
    let problem = block(10.526, 12.7, 4.0, 4.0);
    let curve = problem.solve().unwrap();
    // bounded by the residual Newton's method leaves
    assert!(curve.stats.imbalance < 1e-3, "{}", curve.stats.imbalance);
    assert!(curve.discretisation < 2e-3);
    let stations = problem.stations().unwrap();
    for w in stations.windows(3).filter(|w| w[0].depth_mm > 0.5) {
        // Force over three stations by Simpson's rule on the slopes of a nearly equal pair of steps;
        // mesh scatter of the slope is a few percent (surface points entering one by one).
        let rise = w[2].force_n - w[0].force_n;
        let h = w[2].depth_mm - w[0].depth_mm;
        let simpson = h / 6.0 * (w[0].slope + 4.0 * w[1].slope + w[2].slope);
        assert!((simpson / rise - 1.0).abs() < 0.06, "{} {simpson} {rise}", w[1].depth_mm);
    }
}

/// The corners of the parameter box that the tables need, all of which must be solved.
#[test]
fn corners_of_the_parameter_box_converge() {
    for (alpha, height) in [(1.0, 5.0), (1.0, 25.4), (24.0, 5.0), (24.0, 25.4)] {
        let curve = block(alpha, height, 4.0, 4.0).solve().unwrap();
        assert!(curve.force_n.windows(2).all(|w| w[1] > w[0]), "alpha {alpha}, height {height}: not rising");
        assert!(curve.stats.iterations < 600, "{}", curve.stats.iterations);
    }
}

/// Beyond the equator the ball goes on as a shank: the force keeps rising, without a jump.
#[test]
fn deeper_than_the_equator() {
    let curve = block(6.0, 20.0, 2.0, 3.0).solve().unwrap();
    let near: Vec<f64> = curve.force_n[120..150].to_vec();
    for w in near.windows(3) {
        // second difference of a smooth curve: F'' d^2 is 1e-4 of F here
        assert!((w[2] - 2.0 * w[1] + w[0]).abs() < 1e-3 * w[1]);
        assert!(w[1] > w[0]);
    }
}

#[test]
fn a_sliding_base_is_softer_and_a_thinner_block_stiffer() {
    let bonded = block(8.0, 6.0, 4.0, 3.0);
    let mut sliding = bonded.clone();
    sliding.specimen.base = Base::Sliding;
    let at = |p: &Indentation| p.solve_at(&[3.0]).unwrap().force_n[0];
    assert!(at(&sliding) < at(&bonded));
    assert!(at(&block(8.0, 12.0, 4.0, 3.0)) < at(&bonded));
}

#[test]
fn senseless_input_is_refused_by_name() {
    let good = block(8.0, 12.7, 4.0, 4.0);
    let say = |p: Indentation| p.solve().unwrap_err().to_string();
    assert_eq!(
        say(Indentation { depth_mm: 12.5, ..good.clone() }),
        "depth_mm = 12.5 must stay below 95 % of the height, 12.7 mm"
    );
    assert_eq!(say(Indentation { depth_mm: f64::NAN, ..good.clone() }), "depth_mm = NaN must be positive");
    assert_eq!(
        say(Indentation { ball: Ball { radius_mm: 0.0 }, ..good.clone() }),
        "radius_mm of the ball = 0 must be positive"
    );
    assert_eq!(
        say(Indentation { ball: Ball { radius_mm: 20.0 }, ..good.clone() }),
        "radius_mm of the specimen = 25 must be at least 1.5 ball radii, 30 mm"
    );
    assert_eq!(
        say(Indentation { resolution: Resolution::Refined(0.0), ..good.clone() }),
        "refinement = 0 must lie in 0.3..6"
    );
    assert_eq!(
        good.solve_at(&[4.5]).unwrap_err().to_string(),
        "depth_mm = 4.5 must not exceed the largest depth, 4 mm"
    );
}
