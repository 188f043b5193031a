//! Element, contact and system: patch test, consistent derivatives, symmetry.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use lut_gen::fem::quadrature::gauss;
use lut_gen::fem::shape::quad8;
use lut_gen::solid::contact::{Adhesion, Ball, Interface, Penalty, Surface};
use lut_gen::solid::element::{DOFS, Matter, Quadrature, Solid};
use lut_gen::solid::law::{Hyperfoam, Material, PronyTerm, Relaxation, Term};
use lut_gen::solid::mesh::{BlockMesh, Sizes, graded};
use lut_gen::solid::solve::{Base, HELD, History, Step, System};
use lut_gen::solid::verify::worst_mismatch;

fn foam() -> Material {
    Hyperfoam::new(vec![Term { mu_mpa: 0.1, alpha: 8.0, nu: 0.2 }]).unwrap().into()
}

/// Internal force of an element of an elastic material.
fn internal(solid: &Solid, material: &Material, u: &[f64; DOFS]) -> [f64; DOFS] {
    let mut force = [0.0; DOFS];
    let step = material.relaxation(0.0);
    let matter = Matter { material, step: &step };
    solid.force(&matter, &[], u, &mut force, None).unwrap();
    force
}

/// Patch test: four distorted elements around one free corner,
///
/// ```text
///   +----+----+
///   |    /    |     every node moved by u_r = a r, u_z = b z:
///   +---*-----+     a homogeneous state, so the nodes inside
///   |    \    |     the patch must be in equilibrium
///   +----+----+
/// ```
#[test]
fn patch_of_distorted_elements_is_in_equilibrium() {
    let corners = [
        [[2.0, 0.0], [3.0, 0.0], [4.0, 0.0]],
        [[2.0, 1.0], [2.8, 1.15], [4.0, 0.9]],
        [[2.0, 2.0], [3.1, 2.0], [4.0, 2.0]],
    ];
    for quadrature in [Quadrature::Reduced, Quadrature::Full] {
        // all nodes, found again by their position
        let mut nodes: Vec<[f64; 2]> = Vec::new();
        let mut residual: Vec<[f64; 2]> = Vec::new();
        for j in 0..2 {
            for i in 0..2 {
                let c = [corners[j][i], corners[j][i + 1], corners[j + 1][i + 1], corners[j + 1][i]];
                let x: [[f64; 2]; 8] = std::array::from_fn(|k| {
                    let (a, b) = (c[k % 4], c[(k + 1) % 4]);
                    if k < 4 { a } else { [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])] }
                });
                let u: [f64; DOFS] =
                    std::array::from_fn(|k| if k % 2 == 0 { 0.08 * x[k / 2][0] } else { -0.3 * x[k / 2][1] });
                let solid = Solid::new([0; 8], &x, quadrature);
                let force = internal(&solid, &foam(), &u);
                for (k, p) in x.iter().enumerate() {
                    let same = |q: &[f64; 2]| (q[0] - p[0]).hypot(q[1] - p[1]) < 1e-9;
                    let at = nodes.iter().position(same).unwrap_or_else(|| {
                        nodes.push(*p);
                        residual.push([0.0; 2]);
                        nodes.len() - 1
                    });
                    residual[at][0] += force[2 * k];
                    residual[at][1] += force[2 * k + 1];
                }
            }
        }
        let largest = residual.iter().flatten().fold(0.0_f64, |m, x| m.max(x.abs()));
        let inside = nodes.iter().zip(&residual).filter(|(x, _)| x[0] > 2.0 && x[0] < 4.0 && x[1] > 0.0 && x[1] < 2.0);
        let mut count = 0;
        for (x, r) in inside {
            count += 1;
            // exact integration up to rounding: the integrands are polynomials of degree 3
            assert!(r[0].hypot(r[1]) < 1e-12 * largest, "{quadrature:?} {x:?}: {r:?} of {largest}");
        }
        assert_eq!(count, 5);
    }
}

#[test]
fn element_stiffness_is_the_derivative_of_the_force() {
    let x = [[1.0, 0.0], [2.0, 0.1], [2.1, 1.0], [0.9, 1.2], [1.5, 0.05], [2.05, 0.55], [1.5, 1.1], [0.95, 0.6]];
    let solid = Solid::new([0; 8], &x, Quadrature::Reduced);
    let u: [f64; DOFS] = std::array::from_fn(|i| 0.1 * (1.7 * i as f64).sin());
    let material = foam();
    let step = material.relaxation(0.0);
    let matter = Matter { material: &material, step: &step };
    let (mut lower, mut whole) = ([[0.0; DOFS]; DOFS], [[0.0; DOFS]; DOFS]);
    solid.stiffness(&matter, &[], &u, &mut [0.0; DOFS], &mut lower, true).unwrap();
    solid.stiffness(&matter, &[], &u, &mut [0.0; DOFS], &mut whole, false).unwrap();
    let force = |u: &[f64; DOFS]| internal(&solid, &material, u);
    for j in 0..DOFS {
        // central differences: truncation (1e-5)^2, rounding 1e-16 / 1e-5
        let shifted = |h: f64| {
            let mut v = u;
            v[j] += h;
            force(&v)
        };
        let (a, b) = (shifted(1e-5), shifted(-1e-5));
        let column: Vec<f64> = (0..DOFS).map(|i| (a[i] - b[i]) / 2e-5).collect();
        let exact: Vec<f64> = (0..DOFS).map(|i| whole[i][j]).collect();
        let mirrored: Vec<f64> = (0..DOFS).map(|i| lower[i.max(j)][i.min(j)]).collect();
        assert!(worst_mismatch(&exact, &mirrored) < 1e-12);
        assert!(worst_mismatch(&column, &exact) < 1e-8, "column {j}");
    }
}

#[test]
fn shape_functions_sum_to_one_and_pick_their_nodes() {
    let at = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0], [0.0, -1.0], [1.0, 0.0], [0.0, 1.0], [-1.0, 0.0]];
    for (i, [x, y]) in at.into_iter().enumerate() {
        let (n, d) = quad8(x, y);
        for (j, v) in n.iter().enumerate() {
            assert!((v - f64::from(u8::from(i == j))).abs() < 1e-14);
        }
        assert!(d.iter().map(|d| d[0]).sum::<f64>().abs() < 1e-14);
    }
}

#[test]
fn gauss_rules_integrate_their_degree() {
    for n in 1..=12 {
        for degree in 0..2 * n {
            let sum: f64 = gauss(n).iter().map(|(x, w)| w * x.powi(degree as i32)).sum();
            let exact = if degree % 2 == 0 { 2.0 / (degree as f64 + 1.0) } else { 0.0 };
            assert!((sum - exact).abs() < 1e-14, "{n} points, degree {degree}");
        }
    }
}

#[test]
fn grading_follows_its_size_function() {
    let size = |x: f64| 0.1 + 0.2 * x;
    let x = graded(5.0, 2.0, size);
    assert_eq!((x[0], x[x.len() - 1]), (0.0, 5.0));
    for w in x.windows(2) {
        // half the size, up to rounding the number of elements up (one in 25) and the finite width
        let ratio = (w[1] - w[0]) / (0.5 * size(0.5 * (w[0] + w[1])));
        assert!((0.93..1.01).contains(&ratio), "{ratio}");
    }
}

/// A small block, touched, at an arbitrary displacement.
fn touched(interface: Interface) -> (System, Vec<f64>) {
    let sizes = Sizes {
        axis: 0.3,
        growth_under: 0.1,
        near: 1.0,
        growth_far: 0.5,
        surface: 0.3,
        growth_down: 0.5,
        refinement: 1.0,
    };
    let ball = Ball { radius_mm: 2.0 };
    let mesh = BlockMesh::new(6.0, 4.0, ball.radius_mm, &sizes);
    let surface =
        Surface::new(ball, interface, &mesh.nodes, &mesh.top, 5.0, 6, Penalty { stiffness: 10.0, growth: 2.0 });
    let system = System::new(&mesh, Base::Sliding, surface, Quadrature::Reduced);
    let u = (0..system.unknowns()).map(|i| 0.02 * (2.3 * i as f64).sin()).collect();
    (system, u)
}

fn step<'a>(material: &'a Material, old: &'a History, dt_s: f64, depth_mm: f64) -> Step<'a> {
    Step { material, relaxation: Relaxation::over(&material.prony, dt_s), old, depth_mm }
}

/// With and without attraction: the residual is the gradient of the potential, the force its
/// derivative by depth (a deeper ball does work on the block).
#[test]
fn residual_is_the_gradient_of_the_potential_and_force_its_depth_derivative() {
    for adhesion in [None, Some(Adhesion { work_n_per_mm: 0.01, range_mm: 0.1 })] {
        let (system, u) = touched(Interface { friction: 0.0, adhesion });
        let (material, depth) = (foam(), 1.0);
        let old = system.untouched(&material, 0.0);
        let mut state = system.state();
        assert!(system.evaluate(&step(&material, &old, 0.0, depth), &u, &mut state));
        assert!(state.sum.active > 10);
        let mut other = system.state();
        let mut at = |u: &[f64], depth: f64| {
            assert!(system.evaluate(&step(&material, &old, 0.0, depth), u, &mut other));
            (other.potential, other.sum.force_n)
        };
        // central differences as above; a surface point that crosses the edge within the
        // step adds an error of the penalty's kink, which is of second order as well
        let h = 1e-5;
        let (a, b) = (at(&u, depth + h), at(&u, depth - h));
        assert!(((a.0 - b.0) / (2.0 * h) / state.sum.force_n - 1.0).abs() < 1e-6, "{adhesion:?}");
        let gradient: Vec<f64> = (0..u.len())
            .map(|i| {
                let mut v = u.clone();
                v[i] += h;
                let plus = at(&v, depth).0;
                v[i] -= 2.0 * h;
                (plus - at(&v, depth).0) / (2.0 * h)
            })
            .collect();
        assert!(worst_mismatch(&gradient, &state.residual) < 1e-6, "{adhesion:?}");
    }
}

/// The tangent with everything in it at once: relaxation of shear and bulk apart, points that
/// stick, slide, enter, and attraction. Column by column against differences of the residual, and
/// drive, pull and direct against differences by depth.
#[test]
fn the_tangent_is_the_derivative_of_the_residual() {
    for friction in [0.0, 0.05, 0.3, 2.0] {
        let interface = Interface { friction, adhesion: Some(Adhesion { work_n_per_mm: 0.02, range_mm: 0.2 }) };
        let (system, u) = touched(interface);
        let material = foam().relaxing(vec![PronyTerm { g: 0.4, k: 0.1, tau_s: 2.0 }]).unwrap();
        let start = system.untouched(&material, 0.0);
        let before: Vec<f64> = u.iter().map(|x| 0.9 * x).collect();
        let mut there = system.state();
        assert!(system.evaluate(&step(&material, &start, 1.0, 0.8), &before, &mut there));
        let old = there.history;
        let (mut state, mut matrix) = (system.state(), system.matrix(false).unwrap());
        assert!(system.assemble(&step(&material, &old, 0.5, 1.0), &u, &mut state, &mut matrix));
        if friction == 0.05 {
            assert!(state.sum.sliding > 5);
        }
        let mut other = system.state();
        let mut at = |u: &[f64], depth: f64| {
            assert!(system.evaluate(&step(&material, &old, 0.5, depth), u, &mut other));
            (other.residual.clone(), other.sum.force_n)
        };
        let h = 1e-6;
        let quotient =
            |a: &[f64], b: &[f64]| -> Vec<f64> { a.iter().zip(b).map(|(x, y)| (x - y) / (2.0 * h)).collect() };
        let mut column = vec![0.0; u.len()];
        for j in 0..u.len() {
            let mut v = u.clone();
            v[j] += h;
            let (plus, force) = at(&v, 1.0);
            v[j] -= 2.0 * h;
            let (minus, less) = at(&v, 1.0);
            matrix.column(j, &mut column);
            // truncation 1e-10, rounding 1e-10
            assert!(worst_mismatch(&quotient(&plus, &minus), &column) < 1e-6, "friction {friction}, column {j}");
            let pull = (force - less) / (2.0 * h);
            assert!(
                (pull - matrix.pull[j]).abs() < 1e-6 * matrix.direct,
                "friction {friction}: {pull} {}",
                matrix.pull[j]
            );
        }
        let (a, b) = (at(&u, 1.0 + h), at(&u, 1.0 - h));
        assert!(worst_mismatch(&quotient(&a.0, &b.0), &matrix.drive) < 1e-6);
        assert!(((a.1 - b.1) / (2.0 * h) / matrix.direct - 1.0).abs() < 1e-6);
        let lone: Vec<usize> = system.equation().iter().copied().filter(|e| *e != HELD).collect();
        assert_eq!(lone.len(), system.unknowns());
    }
}

#[test]
fn ball_continues_smoothly_as_a_shank() {
    let ball = Ball { radius_mm: 4.0 };
    let below = ball.touch([3.9, -1e-9], 0.0);
    let above = ball.touch([3.9, 1e-9], 0.0);
    assert!((below.depth_mm - above.depth_mm).abs() < 1e-8);
    assert!((below.normal[0] - above.normal[0]).abs() < 1e-8 && (below.normal[1] - above.normal[1]).abs() < 1e-8);
    assert!((below.arc_mm - above.arc_mm).abs() < 1e-8);
    assert!(ball.touch([4.1, 10.0], 0.0).depth_mm < 0.0 && ball.touch([0.0, -4.1], 0.0).depth_mm < 0.0);
    assert!((ball.touch([0.0, -3.5], 0.0).depth_mm - 0.5).abs() < 1e-15);
}
