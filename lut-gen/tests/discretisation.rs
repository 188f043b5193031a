//! Element, contact and system: patch test, consistent derivatives, symmetry.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use lut_gen::contact::{Ball, Surface};
use lut_gen::element::{DOFS, LOWER, Quadrature, Solid, gauss, quad8};
use lut_gen::law::{Hyperfoam, Term};
use lut_gen::mesh::{BlockMesh, Sizes, graded};
use lut_gen::solve::{Base, System};
use lut_gen::verify::worst_mismatch;

fn law() -> Hyperfoam {
    Hyperfoam::new(vec![Term { mu_mpa: 0.1, alpha: 8.0, nu: 0.2 }]).unwrap()
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
                let mut force = [0.0; DOFS];
                let solid = Solid::new([0; 8], &x, quadrature);
                solid.force(&law(), &u, &mut force).unwrap();
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
    let mut lower = [0.0; LOWER];
    solid.stiffness(&law(), &u, &mut [0.0; DOFS], &mut lower).unwrap();
    let force = |u: &[f64; DOFS]| {
        let mut f = [0.0; DOFS];
        solid.force(&law(), u, &mut f).unwrap();
        f
    };
    for j in 0..DOFS {
        // central differences: truncation (1e-5)^2, rounding 1e-16 / 1e-5
        let shifted = |h: f64| {
            let mut v = u;
            v[j] += h;
            force(&v)
        };
        let (a, b) = (shifted(1e-5), shifted(-1e-5));
        let column: Vec<f64> = (0..DOFS).map(|i| (a[i] - b[i]) / 2e-5).collect();
        let exact: Vec<f64> = (0..DOFS).map(|i| lower[i.max(j) * (i.max(j) + 1) / 2 + i.min(j)]).collect();
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
fn touched() -> (System, Vec<f64>) {
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
    let surface = Surface::new(ball, &mesh.nodes, &mesh.top, 5.0, 6, 10.0);
    let system = System::new(&mesh, Base::Sliding, surface, Quadrature::Reduced);
    let u = (0..system.unknowns()).map(|i| 0.02 * (2.3 * i as f64).sin()).collect();
    (system, u)
}

#[test]
fn residual_is_the_gradient_of_the_potential_and_force_its_depth_derivative() {
    let (system, u) = touched();
    let (law, depth) = (law(), 1.0);
    let mut state = system.state();
    assert!(system.evaluate(&law, &u, depth, true, &mut state));
    assert!(state.sum.active > 10);
    let mut other = system.state();
    let mut at = |u: &[f64], depth: f64| {
        assert!(system.evaluate(&law, u, depth, false, &mut other));
        (other.potential, other.sum.force_n, other.residual.clone())
    };
    // central differences as above; a surface point that crosses the edge within the
    // step adds an error of the penalty's kink, which is of second order as well
    let h = 1e-5;
    let (a, b) = (at(&u, depth + h), at(&u, depth - h));
    assert!(((a.0 - b.0) / (2.0 * h) / state.sum.force_n - 1.0).abs() < 1e-7);
    assert!(((a.1 - b.1) / (2.0 * h) / state.sum.stiffness - 1.0).abs() < 1e-5);
    let drive: Vec<f64> = a.2.iter().zip(&b.2).map(|(x, y)| (x - y) / (2.0 * h)).collect();
    assert!(worst_mismatch(&drive, &state.drive) < 1e-5);
    let gradient: Vec<f64> = (0..u.len())
        .map(|i| {
            let mut v = u.clone();
            v[i] += h;
            let plus = at(&v, depth).0;
            v[i] -= 2.0 * h;
            (plus - at(&v, depth).0) / (2.0 * h)
        })
        .collect();
    assert!(worst_mismatch(&gradient, &state.residual) < 1e-7);
}

#[test]
fn ball_continues_smoothly_as_a_shank() {
    let ball = Ball { radius_mm: 4.0 };
    let below = ball.touch([3.9, -1e-9], 0.0).unwrap();
    let above = ball.touch([3.9, 1e-9], 0.0).unwrap();
    assert!((below.depth_mm - above.depth_mm).abs() < 1e-8);
    assert!((below.normal[0] - above.normal[0]).abs() < 1e-8 && (below.normal[1] - above.normal[1]).abs() < 1e-8);
    assert!(ball.touch([4.1, 10.0], 0.0).is_none() && ball.touch([0.0, -4.1], 0.0).is_none());
    assert!((ball.touch([0.0, -3.5], 0.0).unwrap().depth_mm - 0.5).abs() < 1e-15);
}
