//! Derivatives of the force by every parameter, against central differences of whole solves.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use lut_gen::solid::contact::{Adhesion, Ball, Interface};
use lut_gen::solid::law::{Hyperfoam, Material, Ogden, OgdenRoxburgh, Parameter, PronyTerm, Term};
use lut_gen::solid::mesh::BlockMesh;
use lut_gen::solid::model::{Record, Resolution, Simulation, Specimen, Tracker};
use lut_gen::solid::solve::{Base, Motion, Newton, Station, Stepping};

/// Largest miss of the differentiated force, relative to the larger of the derivative's peak
/// along the path and what a one percent change of the parameter does.
const MISS: f64 = 1e-5;

fn simulation(material: Material, interface: Interface, motion: Motion) -> Simulation {
    Simulation {
        material,
        specimen: Specimen { height_mm: 8.0, radius_mm: 15.0, base: Base::Bonded },
        ball: Ball { radius_mm: 3.0 },
        interface,
        motion,
        resolution: Resolution::Refined(0.4),
    }
}

/// The case with `delta` added to a parameter, and its mesh: nodes follow the height.
fn shifted(case: &Simulation, mesh: &BlockMesh, by: Parameter, delta: f64) -> (Simulation, BlockMesh) {
    let (mut case, mut mesh) = (case.clone(), mesh.clone());
    match by {
        Parameter::Friction => case.interface.friction += delta,
        Parameter::AdhesionWork => case.interface.adhesion.as_mut().unwrap().work_n_per_mm += delta,
        Parameter::BallRadius => case.ball.radius_mm += delta,
        Parameter::Height => {
            let scale = (case.specimen.height_mm + delta) / case.specimen.height_mm;
            case.specimen.height_mm += delta;
            mesh.height_mm *= scale;
            mesh.nodes.iter_mut().for_each(|x| x[1] *= scale);
        }
        _ => case.material = case.material.shifted(by, delta),
    }
    (case, mesh)
}

/// Fixed steps, and equilibria to rounding: the last of Newton's corrections takes 1e-8 far below.
fn exactly() -> (Newton, Stepping) {
    let newton = Newton { tolerance: 1e-8, iterations: 30, chord: 0.0, ..Newton::default() };
    (
        newton,
        Stepping {
            growth: 2.0,
            first: 0.06,
            easy: 30,
            stations: 10,
            largest: 0.06,
            settling_s: Some(1.0),
            ..Stepping::of_ball(3.0)
        },
    )
}

fn stations(case: &Simulation, mesh: &BlockMesh) -> Vec<Station> {
    let (newton, stepping) = exactly();
    case.follow(mesh, 1.0, newton, stepping, &mut ()).unwrap().0.stations
}

fn check(case: &Simulation, values: &[(Parameter, f64)]) {
    let mesh = case.mesh(0.4);
    let (newton, stepping) = exactly();
    let mut tracker = Tracker::new(&values.iter().map(|v| v.0).collect::<Vec<_>>());
    let path = case.follow(&mesh, 1.0, newton, stepping, &mut tracker).unwrap().0;
    for (s, &(parameter, value)) in tracker.finish().iter().zip(values) {
        let difference = |h: f64| -> Vec<f64> {
            let ends = [h, -h].map(|h| {
                let (case, mesh) = shifted(case, &mesh, parameter, h);
                stations(&case, &mesh)
            });
            assert_eq!(ends[0].len(), path.stations.len(), "{parameter}: the steps differ");
            ends[0].iter().zip(&ends[1]).map(|(a, b)| (a.force_n - b.force_n) / (2.0 * h)).collect()
        };
        // surface points cross the contact edge between the two: small steps, Richardson's rule
        let h = 2e-5 * value;
        let (one, two) = (difference(h), difference(0.5 * h));
        let peak = s.raw.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        let force = path.stations.iter().fold(0.0_f64, |m, x| m.max(x.force_n.abs()));
        let scale = peak.max(0.01 * force / value);
        let miss = one.iter().zip(&two).zip(&s.raw).map(|((a, b), x)| ((4.0 * b - a) / 3.0 - x).abs() / scale);
        let worst = miss.fold(0.0, f64::max);
        println!("{parameter:<14} dF/dp at the end {:+.6e}, miss {worst:.1e}", s.raw[s.raw.len() - 1]);
        assert!(worst < MISS, "{parameter}: {worst:.2e}");
    }
}

fn foam() -> Hyperfoam {
    Hyperfoam::new(vec![Term { mu_mpa: 0.1, alpha: 8.0, nu: 0.2 }, Term { mu_mpa: 0.02, alpha: 3.0, nu: 0.1 }]).unwrap()
}

#[test]
fn of_an_elastic_foam() {
    use Parameter::{Alpha, BallRadius, Height, Mu, Nu};
    let case = simulation(foam().into(), Interface::default(), Motion::ramp(2.0, 1.0));
    check(
        &case,
        &[
            (Mu(0), 0.1),
            (Alpha(0), 8.0),
            (Nu(0), 0.2),
            (Mu(1), 0.02),
            (Alpha(1), 3.0),
            (BallRadius, 3.0),
            (Height, 8.0),
        ],
    );
}

/// Shear and bulk relax apart, the ball sticks and slides, goes in, waits, and comes out.
/// A foam whose penalty stiffens with the pressure, which depends on every parameter; and the force
/// that is freed from the penalty.
#[test]
fn of_a_foam_that_densifies() {
    use Parameter::{Alpha, BallRadius, Height, Nu};
    let foam = Hyperfoam::new(vec![Term { mu_mpa: 0.1, alpha: 6.0, nu: 0.42 }]).unwrap();
    let case = simulation(foam.into(), Interface::default(), Motion::ramp(3.0, 1.0));
    let list = [(Alpha(0), 6.0), (Nu(0), 0.42), (BallRadius, 3.0), (Height, 8.0)];
    check(&case, &list);
    let record = |by, h| {
        let (case, mesh) = shifted(&case, &case.mesh(0.4), by, h);
        let (newton, stepping) = exactly();
        Record::new(case.follow(&mesh, 1.0, newton, stepping, &mut ()).unwrap().0).force_n
    };
    let (newton, stepping) = exactly();
    let mut tracker = Tracker::new(&list.map(|l| l.0));
    case.follow(&case.mesh(0.4), 1.0, newton, stepping, &mut tracker).unwrap();
    for (s, (parameter, value)) in tracker.finish().iter().zip(list) {
        let h = 2e-5 * value;
        let (plus, minus) = (record(parameter, h), record(parameter, -h));
        let peak = s.force.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        for ((a, b), x) in plus.iter().zip(&minus).zip(&s.force) {
            assert!(((a - b) / (2.0 * h) - x).abs() < 1e-4 * peak, "{parameter}: {} {x}", (a - b) / (2.0 * h));
        }
    }
}

#[test]
fn of_a_relaxing_foam_with_friction_through_a_cycle() {
    use Parameter::{Alpha, BallRadius, Friction, Height, Mu, PronyG, PronyK, PronyTau};
    let series = vec![PronyTerm { g: 0.4, k: 0.2, tau_s: 1.0 }];
    let material = Material::from(foam()).relaxing(series).unwrap();
    let motion = Motion::ramp(1.5, 1.0).hold(2.0).to_depth(1.0, 0.3);
    let case = simulation(material, Interface { friction: 0.15, adhesion: None }, motion);
    let list = [
        (Mu(0), 0.1),
        (Alpha(0), 8.0),
        (PronyG(0), 0.4),
        (PronyK(0), 0.2),
        (PronyTau(0), 1.0),
        (Friction, 0.15),
        (BallRadius, 3.0),
        (Height, 8.0),
    ];
    check(&case, &list);
}

#[test]
fn of_a_softening_ogden_solid_with_adhesion() {
    use Parameter::{AdhesionWork, Alpha, Compressibility, Mu, SofteningBeta, SofteningM, SofteningR};
    let material = Material::from(Ogden::one_term(0.05, 4.0, 1.0).unwrap())
        .softening(OgdenRoxburgh::new(1.5, 0.001, 0.1).unwrap());
    let adhesion = Some(Adhesion { work_n_per_mm: 2e-3, range_mm: 0.2 });
    let case = simulation(material, Interface { friction: 0.0, adhesion }, Motion::ramp(1.2, 1.0).to_depth(0.6, 1.0));
    let list = [
        (Mu(0), 0.05),
        (Alpha(0), 4.0),
        (Compressibility(0), 1.0),
        (AdhesionWork, 2e-3),
        (SofteningR, 1.5),
        (SofteningM, 0.001),
        (SofteningBeta, 0.1),
    ];
    check(&case, &list);
}

/// Under a prescribed force it is the depth that moves: `dd/dp = -(dF/dp) / (dF/dd)` for an elastic material.
#[test]
fn of_the_depth_under_a_prescribed_force() {
    let motion = Motion::from_touch().to_force(0.6, 1.0);
    let case = simulation(foam().into(), Interface::default(), motion);
    let mesh = case.mesh(0.4);
    let (newton, stepping) = exactly();
    let mut tracker = Tracker::new(&[Parameter::Alpha(0)]);
    case.follow(&mesh, 1.0, newton, stepping, &mut tracker).unwrap();
    let exact = &tracker.finish()[0];
    let depth = |h: f64| -> Vec<f64> {
        let (case, mesh) = shifted(&case, &mesh, Parameter::Alpha(0), h);
        stations(&case, &mesh).iter().map(|s| s.depth_mm).collect()
    };
    let h = 1e-4;
    let (plus, minus) = (depth(h), depth(-h));
    let peak = exact.depth.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    for ((a, b), x) in plus.iter().zip(&minus).zip(&exact.depth) {
        assert!(((a - b) / (2.0 * h) - x).abs() < 1e-5 * peak, "{a} {b} {x}");
    }
    assert!(exact.raw.iter().all(|f| f.abs() < 1e-9));
}

#[test]
fn of_a_parameter_the_case_does_not_have() {
    let case = simulation(foam().into(), Interface::default(), Motion::ramp(1.0, 1.0));
    let say = |p| case.sensitivities(&[p]).unwrap_err().to_string();
    assert!(say(Parameter::Friction).starts_with("friction is no parameter of hyperfoam mu_1 0.1"));
    assert!(say(Parameter::Alpha(2)).starts_with("alpha_3 is no parameter of hyperfoam"));
}
