//! Parts of the explicit method: element, mass, critical step, oscillation.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use faer::{Mat, Side};
use lut_gen::solid::contact::{Ball, Interface, Penalty, Surface};
use lut_gen::solid::dynamics::{Body, CentralDifference, Forces, UpdatedElement, critical_step_s, lumped_mass};
use lut_gen::solid::element::{DOFS, Matter, Quadrature, Solid};
use lut_gen::solid::law::{Hyperfoam, Material, Term};
use lut_gen::solid::mesh::BlockMesh;
use lut_gen::solid::solve::{History, Step};
use lut_gen::solid::verify::worst_mismatch;

/// 100 kg/m^3 in t/mm^3.
const DENSITY: f64 = 1e-10;

const DISTORTED: [[f64; 2]; 8] =
    [[1.0, 0.0], [2.0, 0.1], [2.1, 1.0], [0.9, 1.2], [1.5, 0.05], [2.05, 0.55], [1.5, 1.1], [0.95, 0.6]];

fn law() -> Material {
    Hyperfoam::new(vec![Term { mu_mpa: 0.1, alpha: 8.0, nu: 0.2 }]).unwrap().into()
}

/// No history: elastic, no friction, and the ball far above.
static NO_HISTORY: History = History { matter: Vec::new(), grips: Vec::new() };

fn far_above(material: &Material) -> Step<'_> {
    Step { material, relaxation: material.relaxation(0.0), old: &NO_HISTORY, depth_mm: -1.0 }
}

/// Forces of an elastic body with the ball far above; `None` when an element is turned inside out.
fn evaluate(body: &Body, material: &Material, x: &[[f64; 2]], forces: &mut Forces) -> Option<()> {
    body.evaluate(&far_above(material), x, &mut NO_HISTORY.clone(), forces).ok()
}

#[test]
fn force_in_the_current_configuration_is_that_in_the_reference() {
    let material = law();
    let relaxation = material.relaxation(0.0);
    let matter = Matter { material: &material, step: &relaxation };
    for quadrature in [Quadrature::Reduced, Quadrature::Full] {
        let total = Solid::new([0; 8], &DISTORTED, quadrature);
        let updated = UpdatedElement::new([0; 8], &DISTORTED, quadrature);
        for size in [1e-3, 0.05, 0.15] {
            let u: [f64; DOFS] = std::array::from_fn(|i| size * (1.7 * i as f64).sin());
            let x: [[f64; 2]; 8] =
                std::array::from_fn(|a| [DISTORTED[a][0] + u[2 * a], DISTORTED[a][1] + u[2 * a + 1]]);
            let (mut f, mut g) = ([0.0; DOFS], [0.0; DOFS]);
            let energies = (
                total.force(&matter, &[], &u, &mut f, None).unwrap(),
                updated.force(&matter, &[], &x, &mut g, None).unwrap(),
            );
            // both sum the same work at the same points: rounding only, more of it at small strain
            assert!((energies.0 / energies.1 - 1.0).abs() < 1e-9, "{energies:?}");
            assert!(worst_mismatch(&f, &g) < 1e-11, "{size}: {f:?} {g:?}");
        }
        let turned = DISTORTED.map(|[r, z]| [r, -z]);
        assert!(updated.force(&matter, &[], &turned, &mut [0.0; DOFS], None).is_none());
    }
}

#[test]
fn lumped_mass_is_positive_and_that_of_the_ring() {
    let ring = |inner: f64, outer: f64| {
        let (m, z) = (0.5 * (inner + outer), 2.0);
        [[inner, 0.0], [outer, 0.0], [outer, z], [inner, z], [m, 0.0], [outer, 1.0], [m, z], [inner, 1.0]]
    };
    for (inner, outer) in [(0.0, 0.5), (3.0, 7.0)] {
        let mass = lumped_mass(&ring(inner, outer), DENSITY);
        let volume = std::f64::consts::PI * (outer * outer - inner * inner) * 2.0;
        assert!((mass.iter().sum::<f64>() / (DENSITY * volume) - 1.0).abs() < 1e-13);
        assert!(mass.iter().all(|m| *m > 0.0), "{mass:?}");
    }
    // far from the axis: the known shares of a square, 3/76 and 16/76 (Hinton, Rock, Zienkiewicz 1976)
    let far = lumped_mass(&ring(1e7, 1e7 + 2.0), DENSITY);
    let whole: f64 = far.iter().sum();
    for (i, m) in far.iter().enumerate() {
        let share = if i < 4 { 3.0 / 76.0 } else { 16.0 / 76.0 };
        assert!((m / whole - share).abs() < 1e-6, "node {i}: {}", m / whole);
    }
}

/// One element, its top free to move along the axis, all else held.
struct Single {
    body: Body,
    law: Material,
    /// Nodes that move.
    free: Vec<usize>,
    /// Square of the lowest frequency (1/s^2) and its mode, of lumped mass and tangent stiffness at rest.
    square: f64,
    mode: Vec<f64>,
}

fn far_from(mesh: &BlockMesh) -> Surface {
    Surface::new(Ball { radius_mm: 1.0 }, Interface::default(), &mesh.nodes, &mesh.top, 0.0, 2, Penalty::linear(1.0))
}

fn single() -> Single {
    let mesh = BlockMesh::from_lines(&[2.0, 3.0], &[0.0, 1.5]);
    let law = Material::from(Hyperfoam::one_term(0.2, 3.0).unwrap());
    let held = mesh.nodes.iter().map(|x| [true, x[1] == 0.0]).collect();
    let body = Body::held(&mesh, held, far_from(&mesh), DENSITY);
    let free: Vec<usize> = (0..mesh.nodes.len()).filter(|n| mesh.nodes[*n][1] > 0.0).collect();
    let element = mesh.elements[0];
    let (mut k, step) = ([[0.0; DOFS]; DOFS], far_above(&law));
    let matter = Matter { material: &law, step: &step.relaxation };
    let solid = Solid::new(element, &element.map(|n| mesh.nodes[n]), Quadrature::Reduced);
    solid.stiffness(&matter, &[], &[0.0; DOFS], &mut [0.0; DOFS], &mut k, false).unwrap();
    let dof = |node: usize| 2 * element.iter().position(|n| *n == node).unwrap() + 1;
    let scaled = Mat::from_fn(free.len(), free.len(), |i, j| {
        k[dof(free[i])][dof(free[j])] / (body.mass()[free[i]] * body.mass()[free[j]]).sqrt()
    });
    let eigen = scaled.self_adjoint_eigen(Side::Lower).unwrap();
    let mode = (0..free.len()).map(|i| eigen.U()[(i, 0)] / body.mass()[free[i]].sqrt()).collect::<Vec<f64>>();
    let largest = mode.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let square = eigen.S()[0];
    Single { body, law, free, square, mode: mode.iter().map(|x| x / largest).collect() }
}

#[test]
fn one_element_oscillates_at_its_frequency() {
    let one = single();
    // so small that the law is linear to 1e-6
    let amplitude = 1e-6;
    let step = 0.3 * critical_step_s(&one.body, &far_above(&one.law), one.body.reference_mm()).unwrap();
    let mut motion = CentralDifference::at_rest(&one.body, 0.0);
    for (node, m) in one.free.iter().zip(&one.mode) {
        motion.position_mm[*node][1] += amplitude * m;
    }
    let start = motion.position_mm.clone();
    // Central differences swing at w with sin(w h / 2) = omega h / 2, exactly (Hughes 2000, sec. 9.1)
    let w = 2.0 / step * (0.5 * one.square.sqrt() * step).asin();
    let mut forces = Forces::default();
    let periods = 5.0 * std::f64::consts::TAU / (w * step);
    for n in 0..periods as usize {
        for (node, m) in one.free.iter().zip(&one.mode) {
            let moved = motion.position_mm[*node][1] - one.body.reference_mm()[*node][1];
            let exact = amplitude * m * (w * step * n as f64).cos();
            assert!((moved - exact).abs() < 1e-4 * amplitude, "step {n}: {moved} {exact}");
        }
        evaluate(&one.body, &one.law, &motion.position_mm, &mut forces).unwrap();
        let kinetic = motion.advance(&one.body, &forces, step);
        assert!(kinetic >= 0.0);
    }
    assert!(periods > 20.0 && start != motion.position_mm);
}

/// A column of elements held at its side swings like a bar, fixed below and free above, at `c / 4 h`.
#[test]
fn a_column_swings_like_a_bar() {
    let height = 6.0;
    let z: Vec<f64> = (0..=6).map(|i| height * f64::from(i) / 6.0).collect();
    let mesh = BlockMesh::from_lines(&[0.0, 1.0], &z);
    let law = Material::from(Hyperfoam::one_term(0.2, 3.0).unwrap());
    let held = mesh.nodes.iter().map(|x| [true, x[1] == 0.0]).collect();
    let body = Body::held(&mesh, held, far_from(&mesh), DENSITY);
    let mut motion = CentralDifference::at_rest(&body, 0.0);
    for (x, at) in motion.position_mm.iter_mut().zip(body.reference_mm()) {
        x[1] += 1e-5 * (std::f64::consts::FRAC_PI_2 * at[1] / height).sin();
    }
    let tip = mesh.top[0][0];
    let step = 0.5 * critical_step_s(&body, &far_above(&law), body.reference_mm()).unwrap();
    let mut forces = Forces::default();
    let (mut time, mut crossings, mut before) = (0.0, Vec::new(), 1.0);
    while crossings.len() < 6 {
        evaluate(&body, &law, &motion.position_mm, &mut forces).unwrap();
        motion.advance(&body, &forces, step);
        time += step;
        let now = motion.position_mm[tip][1] - height;
        if now * before < 0.0 {
            crossings.push(time);
        }
        before = now;
    }
    let period = 2.0 * (crossings[5] - crossings[1]) / 4.0;
    // nu = 0: the modulus of the bar is E = 2 mu
    let exact = 4.0 * height / (2.0 * 0.2 / DENSITY).sqrt();
    // quadratic elements, six of them in a quarter wave; the crossings are read to a step
    assert!((period / exact - 1.0).abs() < 0.01, "{period} {exact}");
}

#[test]
fn velocity_form_is_the_thesis_form() {
    let one = single();
    let alpha = 3e4;
    let h = 0.5 * critical_step_s(&one.body, &far_above(&one.law), one.body.reference_mm()).unwrap();
    let mut motion = CentralDifference::at_rest(&one.body, alpha);
    for (node, m) in one.free.iter().zip(&one.mode) {
        motion.position_mm[*node][1] += 0.05 * m;
    }
    // Eqs. 63-64 with a_0 = 1/h^2, a_1 = 1/(2h), a_2 = 2 a_0, C = alpha M; R = 0, -F the force on the nodes
    let (a0, a1) = (1.0 / (h * h), 0.5 / h);
    let mut forces = Forces::default();
    let mut old = motion.position_mm.clone();
    for n in 0..200 {
        let now = motion.position_mm.clone();
        evaluate(&one.body, &one.law, &now, &mut forces).unwrap();
        motion.advance(&one.body, &forces, h);
        if n > 0 {
            for &node in &one.free {
                let m = one.body.mass()[node];
                let rest = one.body.reference_mm()[node][1];
                let (u, u_old) = (now[node][1] - rest, old[node][1] - rest);
                let load = -forces.internal[node][1] + 2.0 * a0 * m * u - (a0 - a1 * alpha) * m * u_old;
                let next = load / ((a0 + a1 * alpha) * m);
                // rounding of positions near 1 mm, differenced
                assert!((motion.position_mm[node][1] - rest - next).abs() < 1e-13, "step {n}");
            }
        }
        old = now;
    }
    let left = one.free.iter().map(|n| (old[*n][1] - one.body.reference_mm()[*n][1]).abs()).fold(0.0, f64::max);
    assert!(left < 0.05, "damped: {left}");
}

/// Largest motion of an element, free all around, after many steps of a share of the critical one.
fn growth(share: f64, damping_per_s: f64) -> f64 {
    let mesh = BlockMesh::from_lines(&[2.0, 3.0], &[0.0, 1.5]);
    let law = law();
    let body = Body::held(&mesh, Vec::new(), far_from(&mesh), DENSITY);
    let step = share * critical_step_s(&body, &far_above(&law), body.reference_mm()).unwrap();
    let mut motion = CentralDifference::at_rest(&body, damping_per_s / step);
    for (i, x) in motion.position_mm.iter_mut().enumerate() {
        x[0] += 1e-9 * (2.1 * i as f64).sin();
        x[1] += 1e-9 * (1.3 * i as f64).cos();
    }
    let mut forces = Forces::default();
    for _ in 0..400 {
        if evaluate(&body, &law, &motion.position_mm, &mut forces).is_none() {
            return f64::INFINITY;
        }
        motion.advance(&body, &forces, step);
    }
    let moved = motion.position_mm.iter().zip(body.reference_mm()).map(|(x, y)| (x[0] - y[0]).hypot(x[1] - y[1]));
    moved.fold(0.0, f64::max) / 1e-9
}

#[test]
fn critical_step_is_where_stability_ends() {
    for damping in [0.0, 0.3] {
        // a free body may drift: no forces hold it, but nothing grows
        assert!(growth(0.9, damping) < 20.0, "{}", growth(0.9, damping));
        assert!(growth(0.99, damping) < 20.0);
        // highest mode grows by a factor above 1.1 a step even with damping: e^38 in 400
        assert!(growth(1.1, damping) > 1e6, "{}", growth(1.1, damping));
    }
}
