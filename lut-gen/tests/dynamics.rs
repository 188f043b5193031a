//! The explicit method: element, mass, critical step, oscillation, energy, and agreement with the implicit method.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use faer::{Mat, Side};
use lut_gen::contact::{Ball, Interface, Surface};
use lut_gen::dynamics::{
    Body, CentralDifference, DynamicsError, Explicit, Forces, LIMIT, Press, UpdatedElement, critical_step_s,
    lumped_mass,
};
use lut_gen::element::{DOFS, Matter, Quadrature, Solid};
use lut_gen::law::{Hyperfoam, Material, Ogden, OgdenTerm, PronyTerm, Term};
use lut_gen::mesh::BlockMesh;
use lut_gen::model::{Resolution, Simulation, Specimen};
use lut_gen::solve::{History, Motion, Step};
use lut_gen::verify::worst_mismatch;

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
    let (material, history) = (law(), Vec::new());
    let relaxation = material.relaxation(0.0);
    let matter = Matter { material: &material, step: &relaxation, history: &history };
    for quadrature in [Quadrature::Reduced, Quadrature::Full] {
        let total = Solid::new([0; 8], &DISTORTED, quadrature);
        let updated = UpdatedElement::new([0; 8], &DISTORTED, quadrature);
        for size in [1e-3, 0.05, 0.15] {
            let u: [f64; DOFS] = std::array::from_fn(|i| size * (1.7 * i as f64).sin());
            let x: [[f64; 2]; 8] =
                std::array::from_fn(|a| [DISTORTED[a][0] + u[2 * a], DISTORTED[a][1] + u[2 * a + 1]]);
            let (mut f, mut g) = ([0.0; DOFS], [0.0; DOFS]);
            let energies =
                (total.force(&matter, &u, &mut f, None).unwrap(), updated.force(&matter, &x, &mut g, None).unwrap());
            // both sum the same work at the same points: rounding only, more of it at small strain
            assert!((energies.0 / energies.1 - 1.0).abs() < 1e-9, "{energies:?}");
            assert!(worst_mismatch(&f, &g) < 1e-11, "{size}: {f:?} {g:?}");
        }
        let turned = DISTORTED.map(|[r, z]| [r, -z]);
        assert!(updated.force(&matter, &turned, &mut [0.0; DOFS], None).is_none());
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
    Surface::new(Ball { radius_mm: 1.0 }, Interface::default(), &mesh.nodes, &mesh.top, 0.0, 2, 1.0)
}

fn single() -> Single {
    let mesh = BlockMesh::from_lines(&[2.0, 3.0], &[0.0, 1.5]);
    let law = Material::from(Hyperfoam::one_term(0.2, 3.0).unwrap());
    let held = mesh.nodes.iter().map(|x| [true, x[1] == 0.0]).collect();
    let body = Body::held(&mesh, held, far_from(&mesh), DENSITY);
    let free: Vec<usize> = (0..mesh.nodes.len()).filter(|n| mesh.nodes[*n][1] > 0.0).collect();
    let element = mesh.elements[0];
    let (mut k, step) = ([[0.0; DOFS]; DOFS], far_above(&law));
    let matter = Matter { material: &law, step: &step.relaxation, history: &[] };
    let solid = Solid::new(element, &element.map(|n| mesh.nodes[n]), Quadrature::Reduced);
    solid.stiffness(&matter, &[0.0; DOFS], &mut [0.0; DOFS], &mut k, false).unwrap();
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

fn press(rate_mm_s: f64) -> Press {
    let simulation = Simulation {
        material: Hyperfoam::one_term(0.22, 10.526).unwrap().into(),
        specimen: Specimen::of_height(12.7),
        ball: Ball { radius_mm: 4.0 },
        interface: Interface::default(),
        motion: Motion::ramp(1.5, rate_mm_s),
        resolution: Resolution::Refined(0.4),
    };
    Press { simulation, smooth: 0.5, explicit: Explicit::of_density(100.0) }
}

#[test]
fn force_tends_to_the_implicit_one_as_the_rate_falls() {
    let stations = press(1.0).simulation.solve().unwrap().stations;
    let mut before = f64::INFINITY;
    for rate in [4000.0, 1000.0, 250.0] {
        let pressed = press(rate).solve().unwrap();
        let inertia = pressed.inertia();
        let late = stations.iter().filter(|s| s.depth_mm >= inertia.from_mm);
        let misses: Vec<f64> = late.map(|s| pressed.force_at(s.depth_mm) / s.force_n - 1.0).collect();
        let rms = (misses.iter().map(|x| x * x).sum::<f64>() / misses.len() as f64).sqrt();
        println!("{rate} mm/s: difference {:.2} % rms; {inertia}", 100.0 * rms);
        assert!(rms < 0.5 * before, "{rate}: {rms} after {before}");
        assert_eq!(inertia.quasi_static(), rate < 2000.0, "{inertia}");
        // trapezoids of the ball's work and the time integration, second order in the step
        assert!(inertia.balance < 1e-3, "{inertia}");
        assert!((pressed.moments.last().unwrap().depth_mm - 1.5).abs() < 1e-12);
        before = rms;
    }
    // same mesh, same penalty: what is left are waves of the start
    assert!(before < 0.005, "{before}");
}

#[test]
fn damping_takes_energy_and_the_balance_keeps_it() {
    let mut damped = press(2000.0);
    damped.explicit.damping_per_s = 2000.0;
    let pressed = damped.solve().unwrap();
    let end = pressed.moments.last().unwrap();
    assert!(end.damping > 0.01 * end.external, "{end:?}");
    assert!(pressed.balance_error() < 1e-3, "{}", pressed.balance_error());
    for pair in pressed.moments.windows(2) {
        assert!(pair[1].damping >= pair[0].damping && pair[1].depth_mm > pair[0].depth_mm);
    }
    assert!(pressed.moments.len() >= damped.explicit.moments);
}

/// Root mean square difference of an explicit run to the implicit one of the same motion, whose smooth start is
/// taken in 60 straight pieces.
fn implicit_difference(pressed: &Press) -> f64 {
    let ramp = pressed.ramp().unwrap();
    let mut motion = Motion::from_touch();
    let pieces = 60;
    for i in 1..=pieces {
        let [from, to] = [i - 1, i].map(|k| ramp.duration_s() * f64::from(k) / f64::from(pieces));
        motion = motion.to_depth(ramp.at(to), (ramp.at(to) - ramp.at(from)) / (to - from));
    }
    let quiet = Simulation { motion, ..pressed.simulation.clone() }.solve().unwrap();
    let run = pressed.solve().unwrap();
    assert!(run.inertia().quasi_static() && run.balance_error() < 1e-3, "{}", run.inertia());
    let late: Vec<_> = quiet.stations.iter().filter(|s| s.depth_mm > 0.5).collect();
    assert!(late.len() > 20);
    let square: f64 = late.iter().map(|s| (run.force_at(s.depth_mm) / s.force_n - 1.0).powi(2)).sum();
    (square / late.len() as f64).sqrt()
}

#[test]
fn relaxation_friction_and_other_laws_agree_with_the_implicit_solver() {
    // 1.5 mm at 250 mm/s take 9 ms with the start: relaxation within that time
    let series = vec![PronyTerm { g: 0.4, k: 0.2, tau_s: 0.003 }];
    let mut relaxing = press(250.0);
    relaxing.simulation.material = relaxing.simulation.material.relaxing(series).unwrap();
    let mut rubbing = press(250.0);
    rubbing.simulation.interface.friction = 0.4;
    let mut rubber = press(500.0);
    let term = OgdenTerm { mu_mpa: 0.2, alpha: 3.0, d_per_mpa: 1.0 };
    rubber.simulation.material = Ogden::new(vec![term]).unwrap().into();
    for (what, case) in [("relaxing", relaxing), ("rubbing", rubbing), ("rubber", rubber)] {
        let difference = implicit_difference(&case);
        println!("{what}: {:.2} % rms", 100.0 * difference);
        // as the elastic foam at this rate: what is left are waves
        assert!(difference < 0.01, "{what}: {difference}");
    }
}

#[test]
fn mass_scaling_is_another_unit_of_time() {
    let quick = press(4000.0).solve().unwrap();
    let mut slow = press(40.0);
    slow.explicit.mass_scaling = 1e4;
    let slow = slow.solve().unwrap();
    assert_eq!(quick.steps, slow.steps);
    for (a, b) in quick.moments.iter().zip(&slow.moments) {
        assert!((a.force_n - b.force_n).abs() < 1e-9, "{a:?} {b:?}");
        assert!((a.kinetic - b.kinetic).abs() < 1e-9);
    }
}

#[test]
fn the_report_flags_the_fast_run_and_its_advice_is_sound() {
    let fast = press(4000.0).solve().unwrap().inertia();
    assert!(!fast.quasi_static() && fast.kinetic > LIMIT);
    let sentence = fast.to_string();
    assert!(sentence.starts_with("not quasi-static: beyond 0.300 mm kinetic energy reaches"), "{sentence}");
    assert!(sentence.contains("mm/s or slower, or scale the mass by 0.0"), "{sentence}");
    let advised = press(4000.0 * fast.slower()).solve().unwrap().inertia();
    assert!(advised.quasi_static(), "{advised}");
    assert!(advised.to_string().starts_with("quasi-static: ") && !advised.to_string().contains("slower"));
    assert!((advised.slower() - 1.0).abs() < 1e-15);
}

#[test]
fn what_cannot_run_is_refused_by_name() {
    let refused = |change: fn(&mut Press)| {
        let mut asked = press(1000.0);
        change(&mut asked);
        asked.solve().unwrap_err().to_string()
    };
    assert_eq!(
        refused(|p| p.simulation.motion = Motion::ramp(1.0, 0.0)),
        "duration_s of a segment = inf must be positive"
    );
    assert_eq!(
        refused(|p| p.simulation.motion = Motion::ramp(1.0, 9.0).hold(1.0)),
        "segments of the motion = 2 but an explicit run needs one ramp from touch"
    );
    assert_eq!(refused(|p| p.simulation.motion = Motion::from_touch().to_force(1.0, 1.0)), "force_n = 1 is no depth");
    assert_eq!(refused(|p| p.smooth = 1.5), "smooth = 1.5 must lie in (0, 1]");
    assert_eq!(refused(|p| p.explicit.density_kg_m3 = f64::NAN), "density_kg_m3 = NaN must be positive");
    assert_eq!(refused(|p| p.explicit.mass_scaling = -1.0), "mass_scaling = -1 must be positive");
    assert_eq!(refused(|p| p.explicit.damping_per_s = -1.0), "damping_per_s = -1 must not be negative");
    assert_eq!(refused(|p| p.explicit.safety = 1.2), "safety = 1.2 must lie in (0, 1]");
    assert_eq!(refused(|p| p.explicit.renewal = 0), "renewal = 0 must be at least 1");
    assert_eq!(refused(|p| p.explicit.moments = 1), "moments = 1 must be at least 4");
    let deep = refused(|p| p.simulation.motion = Motion::ramp(13.0, 1.0));
    assert!(deep.starts_with("depth_mm = 13 must stay below 95 %"), "{deep}");
    let slow = refused(|p| p.simulation.motion = Motion::ramp(1.5, 0.1));
    assert!(slow.contains("more than the 2000000 allowed: press faster than 0.1 mm/s or scale the mass"), "{slow}");
    let inverted = DynamicsError::Inverted { element: 3, depth_mm: 1.0, steps: 7, step_s: 1e-6 };
    assert!(inverted.to_string().starts_with("element 3 was turned inside out at depth 1.0000 mm, after 7 steps"));
}
