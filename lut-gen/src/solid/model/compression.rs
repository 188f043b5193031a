//! A cylinder between two platens.

use super::simulation::{Assembly, cold};
use super::{Record, Resolution, Sensitivity, Tracker};
use crate::scalar::Dual;
use crate::solid::contact::{Interface, Penalty, Platen, Surface};
use crate::solid::element::Quadrature;
use crate::solid::law::{Material, Parameter, Strained};
use crate::solid::mesh::{BlockMesh, graded};
use crate::solid::solve::{Base, Course, Motion, Newton, Observer, Path, SolveError, Stepping, System, Target};

/// How the faces of a cylinder hold to the platens.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Ends {
    /// Coulomb friction of the given coefficient (-), in 0..2; what folds onto a platen from the side rubs alike.
    Friction(f64),
    /// Glued; what folds onto a platen from the side slides freely.
    Bonded,
}

/// A solid cylinder pressed between two flat, parallel, rigid platens wider than it is.
///
/// Solved on its upper half: the middle plane is a plane of symmetry. The side bulges where the faces are held back,
/// and folds onto the platen. Without friction the state is homogeneous ([`crate::solid::homogeneous::Mode::Uniaxial`]).
#[derive(Debug, Clone, PartialEq)]
pub struct Compression {
    /// Material of the cylinder.
    pub material: Material,
    /// Undeformed height of the whole cylinder (mm).
    pub height_mm: f64,
    /// Undeformed radius (mm).
    pub radius_mm: f64,
    /// Its faces on the platens.
    pub ends: Ends,
    /// Approach of the platens: its depths are the shortening of the whole cylinder (mm). Forces cannot be prescribed.
    pub motion: Motion,
    /// Mesh.
    pub resolution: Resolution,
}

/// Half heights over penetration, at a pressure of one shear modulus and at ten, by which the platen is softer than
/// rigid: tried one after the other. Its effect on the force is removed to first order. Where all of the face can slide
/// only a soft platen converges.
const FRICTIONLESS: [(f64, f64); 2] = [(1e5, 1e4), (2e4, 2e3)];
const GLUED: [(f64, f64); 3] = [(2e4, 2e3), (5e3, 500.0), (500.0, 100.0)];
const RUBBING: [(f64, f64); 3] = [(500.0, 200.0), (500.0, 100.0), (500.0, 50.0)];
/// Contact quadrature points per element edge.
const POINTS_PER_EDGE: usize = 4;
/// Element size at the corner between face and side, in half heights (at most radii), and its growth with distance.
const CORNER: f64 = 0.03;
const GROWTH: f64 = 0.35;
/// Elements nearer than this to that corner, in half heights (at most radii), are fully integrated: with 2 x 2 points one
/// there finds a motion that strains no point, and the corner folds up instead of onto the platen. Everywhere else
/// 2 x 2 points keep a nearly incompressible solid from locking.
const FULL: f64 = 0.3;
/// Largest step, in half heights.
const LARGEST_STEP: f64 = 0.02;
/// Equilibrium: the singular corner must not decide when the residual is small.
const TOLERANCE: f64 = 1e-6;

impl Compression {
    /// Force (N) over shortening (mm) and time on the mesh of the resolution (the finest, where there are several).
    ///
    /// # Errors
    /// [`SolveError::Parameter`] and [`SolveError::Law`] for what is out of range; [`SolveError::NoConvergence`] when
    /// the cylinder cannot be followed further, its depths the shortening of half the cylinder.
    pub fn solve(&self) -> Result<Record, SolveError> {
        self.check()?;
        let mesh = self.mesh();
        self.attempt(|stiff| {
            let assembly = self.assembly(&mesh, stiff);
            Ok(self.record(self.follow(&assembly, self.method(&mesh), &mut ())?))
        })
    }

    /// The record with the derivative of its force by each of the parameters: those of the material and, where there
    /// is some, friction. Exact for the discrete equations, as [`super::Simulation::sensitivities`].
    ///
    /// # Errors
    /// As [`Compression::solve`]; [`SolveError::Unknown`] for a parameter the compression does not have and
    /// [`SolveError::Singular`] where the tangent cannot be solved with.
    pub fn sensitivities(&self, parameters: &[Parameter]) -> Result<(Record, Vec<Sensitivity>), SolveError> {
        self.check()?;
        let mesh = self.mesh();
        self.attempt(|stiff| self.tracked(&mesh, stiff, self.method(&mesh), parameters))
    }

    fn tracked(
        &self,
        mesh: &BlockMesh,
        stiff: (f64, f64),
        method: (Newton, Stepping),
        parameters: &[Parameter],
    ) -> Result<(Record, Vec<Sensitivity>), SolveError> {
        let assembly = self.assembly(mesh, stiff);
        let mut tracker = Tracker::new(parameters);
        tracker.start(&assembly.system, 0.5 * self.motion.start_mm, |parameter| self.lifted(mesh, stiff, parameter))?;
        let record = self.record(self.follow(&assembly, method, &mut tracker)?);
        Ok((record, tracker.finish()))
    }

    /// The first of the platen's stiffnesses that leads through the motion, or the error of the last.
    fn attempt<R>(&self, mut solve: impl FnMut((f64, f64)) -> Result<R, SolveError>) -> Result<R, SolveError> {
        let list: &[(f64, f64)] = match self.ends {
            Ends::Friction(0.0) => &FRICTIONLESS,
            Ends::Friction(_) => &RUBBING,
            Ends::Bonded => &GLUED,
        };
        let mut outcome = solve(list[0]);
        for &stiff in &list[1..] {
            if !matches!(outcome, Err(SolveError::NoConvergence { .. } | SolveError::TooManyIterations { .. })) {
                break;
            }
            outcome = solve(stiff);
        }
        outcome
    }

    /// True when the force can depend on the parameter.
    #[must_use]
    pub fn has(&self, parameter: Parameter) -> bool {
        match parameter {
            Parameter::Friction => matches!(self.ends, Ends::Friction(f) if f > 0.0),
            _ => self.material.parameters().iter().any(|(p, _)| *p == parameter),
        }
    }

    /// One line that names material, cylinder and ends.
    #[must_use]
    pub fn label(&self) -> String {
        let ends = match self.ends {
            Ends::Friction(f) => format!("friction {f}"),
            Ends::Bonded => "bonded".to_owned(),
        };
        format!(
            "{}; cylinder of height {} mm and radius {} mm between platens, {ends}",
            self.material.label(),
            self.height_mm,
            self.radius_mm
        )
    }

    fn interface(&self) -> Interface {
        let friction = match self.ends {
            Ends::Friction(friction) => friction,
            Ends::Bonded => 0.0,
        };
        Interface { friction, adhesion: None }
    }

    fn check(&self) -> Result<(), SolveError> {
        for (name, value) in [("height_mm", self.height_mm), ("radius_mm of the cylinder", self.radius_mm)] {
            if !(value.is_finite() && value > 0.0) {
                return Err(SolveError::parameter(name, value, "must be positive"));
            }
        }
        self.material.check()?;
        cold(&self.material)?;
        self.motion.check()?;
        self.interface().check()?;
        for s in &self.motion.segments {
            match s.end {
                Target::ForceN(f) => {
                    let expected = "cannot be prescribed between platens, only the shortening";
                    return Err(SolveError::parameter("force_n of a segment", f, expected));
                }
                Target::DepthMm(d) if d >= 0.95 * self.height_mm => {
                    let expected = format!("must stay below 95 % of the height, {} mm", self.height_mm);
                    return Err(SolveError::parameter("shortening of the cylinder", d, &expected));
                }
                Target::DepthMm(_) => {}
            }
        }
        self.resolution.check()
    }

    /// The mesh of the upper half, fine at the edge of the face.
    #[must_use]
    pub fn mesh(&self) -> BlockMesh {
        let half = 0.5 * self.height_mm;
        let corner = CORNER * half.min(self.radius_mm);
        let lines = |length: f64| graded(length, self.resolution.finest(), |x| corner + GROWTH * x);
        let from_end = |length: f64| -> Vec<f64> {
            let mut x: Vec<f64> = lines(length).iter().rev().map(|x| length - x).collect();
            if let Some(last) = x.last_mut() {
                *last = length;
            }
            x
        };
        BlockMesh::from_lines(&from_end(self.radius_mm), &from_end(half))
    }

    fn assembly(&self, mesh: &BlockMesh, stiff: (f64, f64)) -> Assembly {
        self.equations(mesh, &mesh.nodes, self.interface(), self.material.clone(), stiff)
    }

    fn lifted(&self, mesh: &BlockMesh, stiff: (f64, f64), by: Parameter) -> Result<Assembly<Dual>, SolveError> {
        if !self.has(by) {
            let expected = format!("is no parameter of {}", self.label());
            return Err(SolveError::Unknown { parameter: by.to_string(), expected });
        }
        let nodes: Vec<[Dual; 2]> = mesh.nodes.iter().map(|x| x.map(Dual::from)).collect();
        let seed = f64::from(u8::from(by == Parameter::Friction));
        let interface = Interface { friction: Dual::new(self.interface().friction, seed), adhesion: None };
        Ok(self.equations(mesh, &nodes, interface, self.material.lift(by), stiff))
    }

    fn equations<T: Strained>(
        &self,
        mesh: &BlockMesh,
        nodes: &[[T; 2]],
        interface: Interface<T>,
        material: Material<T>,
        stiff: (f64, f64),
    ) -> Assembly<T> {
        let mu = material.shear_modulus_mpa();
        let gap = |part: f64| T::from(mesh.height_mm / part);
        let penalty = Penalty::through((mu, gap(stiff.0)), (mu * 10.0, gap(stiff.1)));
        let edges: Vec<[usize; 3]> = mesh.top.iter().copied().chain(mesh.side()).collect();
        let platen = Platen { bonded: self.ends == Ends::Bonded };
        let surface = Surface::new(platen, interface, nodes, &edges, f64::INFINITY, POINTS_PER_EDGE, penalty);
        let height = T::from(mesh.height_mm);
        let full = FULL * mesh.height_mm.min(mesh.radius_mm);
        let quadrature = |i: usize| {
            let [inner, _, upper, ..] = mesh.elements[i].map(|n| mesh.nodes[n]);
            let away =
                (mesh.radius_mm - 0.5 * (inner[0] + upper[0])).hypot(mesh.height_mm - 0.5 * (inner[1] + upper[1]));
            if away < full { Quadrature::Full } else { Quadrature::Reduced }
        };
        let system = System::over(mesh, nodes, height, Base::Sliding, surface, quadrature);
        Assembly { system, material }
    }

    fn method(&self, mesh: &BlockMesh) -> (Newton, Stepping) {
        let newton = Newton { tolerance: TOLERANCE, ..Newton::default() };
        (newton, Stepping { largest: LARGEST_STEP, first: 0.002, ..Stepping::of_ball(mesh.height_mm) })
    }

    /// The path of the upper half: every depth is half the shortening.
    fn follow(
        &self,
        assembly: &Assembly,
        (newton, stepping): (Newton, Stepping),
        observer: &mut impl Observer,
    ) -> Result<Path, SolveError> {
        let mut motion = self.motion.clone();
        motion.start_mm *= 0.5;
        for s in &mut motion.segments {
            if let Target::DepthMm(d) = &mut s.end {
                *d *= 0.5;
            }
        }
        let label = self.label();
        let course = Course {
            system: &assembly.system,
            material: &assembly.material,
            motion: &motion,
            newton,
            stepping,
            // no force is prescribed: Hertz's factor is not asked for
            hertz: 1.0,
            label: &label,
        };
        course.follow(observer)
    }

    /// The record of the whole cylinder.
    fn record(&self, path: Path) -> Record {
        let mut record = Record::new(path);
        for s in &mut record.stations {
            s.depth_mm *= 2.0;
            s.slope *= 0.5;
            s.penalty_energy *= 2.0;
        }
        record.depth_mm.iter_mut().for_each(|d| *d *= 2.0);
        record
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

    use super::*;
    use crate::solid::law::{Ogden, PronyTerm};

    /// Friction remembers the steps: derivatives against differences need fixed ones, and equilibria to rounding.
    #[test]
    fn derivatives_with_friction_are_those_of_differences() {
        let series = vec![PronyTerm { g: 0.3, k: 0.1, tau_s: 2.0 }];
        let material = Material::from(Ogden::one_term(0.1, 3.0, 0.2).unwrap()).relaxing(series).unwrap();
        let case = Compression {
            material,
            height_mm: 20.0,
            radius_mm: 10.0,
            ends: Ends::Friction(0.2),
            motion: Motion::ramp(4.0, 1.0).hold(2.0).to_depth(3.0, 1.0),
            resolution: Resolution::Refined(0.6),
        };
        let mesh = case.mesh();
        let newton = Newton { tolerance: 1e-10, iterations: 30, chord: 0.0, ..Newton::default() };
        let plain = Stepping::of_ball(mesh.height_mm);
        let method =
            (newton, Stepping { growth: 2.0, easy: 30, first: 0.02, largest: 0.02, settling_s: Some(2.0), ..plain });
        let stiff = RUBBING[0];
        let list = [
            (Parameter::Mu(0), 0.1),
            (Parameter::Alpha(0), 3.0),
            (Parameter::Compressibility(0), 0.2),
            (Parameter::PronyG(0), 0.3),
            (Parameter::PronyTau(0), 2.0),
            (Parameter::Friction, 0.2),
        ];
        let (record, exact) = case.tracked(&mesh, stiff, method, &list.map(|l| l.0)).unwrap();
        let force = record.stations.iter().fold(0.0_f64, |m, s| m.max(s.force_n));
        assert!(record.stations.iter().any(|s| s.sliding > 0) && record.cuts == 0);
        for (s, (parameter, value)) in exact.iter().zip(list) {
            let difference = |h: f64| -> Vec<f64> {
                let [a, b] = [h, -h].map(|h| {
                    let mut case = Compression { material: case.material.shifted(parameter, h), ..case.clone() };
                    if parameter == Parameter::Friction {
                        case.ends = Ends::Friction(value + h);
                    }
                    case.follow(&case.assembly(&mesh, stiff), method, &mut ()).unwrap().stations
                });
                assert_eq!((a.len(), b.len()), (record.stations.len(), record.stations.len()));
                a.iter().zip(&b).map(|(a, b)| (a.force_n - b.force_n) / (2.0 * h)).collect()
            };
            // points begin and end to slide between the two: small steps, Richardson's rule
            let h = 2e-5 * value;
            let (one, two) = (difference(h), difference(0.5 * h));
            let scale = s.raw.iter().fold(0.01 * force / value, |m, x| m.max(x.abs()));
            let misses = one.iter().zip(&two).zip(&s.raw).map(|((a, b), x)| ((4.0 * b - a) / 3.0 - x).abs() / scale);
            let worst = misses.fold(0.0, f64::max);
            println!("{parameter}: {:+.5e} at the end, miss {worst:.1e}", s.raw[s.raw.len() - 1]);
            assert!(worst < 1e-5, "{parameter}: {worst:.2e}");
        }
    }
}
