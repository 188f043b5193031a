//! Derivatives of the force by parameters, by direct differentiation.

use super::record::penalty_share;
use super::simulation::Assembly;
use super::{Record, Simulation, Watcher};
use crate::scalar::{Dual, Real};
use crate::solid::law::{Material, Parameter};
use crate::solid::mesh::BlockMesh;
use crate::solid::solve::{Accepted, History, Matrix, Observer, SolveError, State, Station, Step, System, remembers};

/// `dF/dp` along a simulation.
#[derive(Debug, Clone, PartialEq)]
pub struct Sensitivity {
    /// The parameter `p`.
    pub parameter: Parameter,
    /// `dF/dp` of hard contact at every station of the record (N per unit of `p`) at fixed
    /// depth, or at fixed time where the force is prescribed.
    pub force: Vec<f64>,
    /// `dF/dp` of the force with the penalty in it, [`Station::force_n`].
    pub raw: Vec<f64>,
    /// `dd/dp` (mm per unit of `p`); 0 where the depth is prescribed.
    pub depth: Vec<f64>,
}

impl Simulation {
    /// The record with the derivative of its force by each of the parameters.
    ///
    /// At every equilibrium the residual is differentiated at fixed displacement (with the
    /// histories of relaxation, friction and softening that lead there), and one solve with the
    /// tangent gives `du/dp`: exact for the discrete equations. By the ball's radius and the
    /// specimen's height the mesh follows as [`Simulation`] describes its lengths: nodes move with
    /// the height, and stay when the ball changes.
    ///
    /// # Errors
    /// As [`Simulation::solve`]; [`SolveError::Parameter`] for a parameter the simulation does not have.
    pub fn sensitivities(&self, parameters: &[Parameter]) -> Result<(Record, Vec<Sensitivity>), SolveError> {
        let mut tracker = Tracker::new(parameters);
        let record = self.watch(&mut tracker)?;
        Ok((record, tracker.finish()))
    }

    /// True when the force of this simulation can depend on the parameter.
    #[must_use]
    pub fn has(&self, parameter: Parameter) -> bool {
        match parameter {
            Parameter::BallRadius | Parameter::Height => true,
            Parameter::Friction => self.interface.friction > 0.0,
            Parameter::AdhesionWork => self.interface.adhesion.is_some(),
            _ => self.material.parameters().iter().any(|(p, _)| *p == parameter),
        }
    }
}

/// Differentiates along a path.
pub struct Tracker {
    parameters: Vec<Parameter>,
    tracks: Vec<Track>,
    matrix: Option<Matrix>,
    state: Option<State>,
    stations: Vec<Station>,
}

/// One parameter along the path.
struct Track {
    system: System<Dual>,
    material: Material<Dual>,
    history: History<Dual>,
    state: State<Dual>,
    raw: Vec<f64>,
    energy: Vec<Dual>,
    depth: Vec<Dual>,
}

impl Tracker {
    /// Tracks the given parameters.
    #[must_use]
    pub fn new(parameters: &[Parameter]) -> Self {
        Self { parameters: parameters.to_vec(), tracks: Vec::new(), matrix: None, state: None, stations: Vec::new() }
    }

    /// Begins a path of the given equations at a depth (mm); `lift` gives them with the derivative by a parameter.
    pub(super) fn start(
        &mut self,
        system: &System,
        start_mm: f64,
        lift: impl Fn(Parameter) -> Result<Assembly<Dual>, SolveError>,
    ) -> Result<(), SolveError> {
        self.tracks.clear();
        self.stations.clear();
        for &parameter in &self.parameters {
            let Assembly { system, material } = lift(parameter)?;
            let history = system.untouched(&material, Dual::from(start_mm));
            let (raw, energy, depth) = (Vec::new(), Vec::new(), Vec::new());
            self.tracks.push(Track { state: system.state(), system, material, history, raw, energy, depth });
        }
        self.matrix = Some(system.matrix(false)?);
        self.state = Some(system.state());
        Ok(())
    }

    /// The derivatives, in the order of the parameters.
    #[must_use]
    pub fn finish(self) -> Vec<Sensitivity> {
        let stations = self.stations;
        self.parameters
            .into_iter()
            .zip(self.tracks)
            .map(|(parameter, t)| {
                let share = penalty_share(&stations, &t.depth, &t.energy, remembers(&t.system, &t.material));
                let force = t.raw.iter().zip(&share).zip(&stations);
                Sensitivity {
                    parameter,
                    force: force.map(|((f, e), s)| if s.by_force { *f } else { f + e.derivative }).collect(),
                    raw: t.raw,
                    depth: t.depth.iter().map(|d| d.derivative).collect(),
                }
            })
            .collect()
    }
}

impl Watcher for Tracker {
    fn begins(
        &mut self,
        simulation: &Simulation,
        mesh: &BlockMesh,
        stiffer: f64,
        system: &System,
    ) -> Result<(), SolveError> {
        self.start(system, simulation.motion.start_mm, |parameter| {
            if !simulation.has(parameter) {
                let expected = format!("is no parameter of {}", simulation.label());
                return Err(SolveError::Unknown { parameter: parameter.to_string(), expected });
            }
            Ok(simulation.lifted(mesh, stiffer, parameter))
        })
    }

    fn restarted(&mut self) {
        self.tracks.clear();
        self.stations.clear();
    }
}

impl Observer for Tracker {
    fn accepted(&mut self, at: &Accepted) -> Result<(), SolveError> {
        let (Some(matrix), Some(state)) = (&mut self.matrix, &mut self.state) else { return Ok(()) };
        let lost = || SolveError::Singular { depth_mm: at.station.depth_mm };
        if !at.system.assemble(at.step, at.u, state, matrix) || !matrix.factorise() {
            return Err(lost());
        }
        let mut rate: Vec<f64> = matrix.drive.iter().map(|b| -b).collect();
        if at.station.by_force && !matrix.solve(&mut rate) {
            return Err(lost());
        }
        for track in &mut self.tracks {
            track.advance(at, matrix, &rate).ok_or_else(lost)?;
        }
        if !at.between {
            self.stations.push(at.station);
        }
        Ok(())
    }
}

impl Track {
    fn advance(&mut self, at: &Accepted, matrix: &mut Matrix, rate: &[f64]) -> Option<()> {
        let mut u: Vec<Dual> = at.u.iter().map(|&x| Dual::from(x)).collect();
        let old = std::mem::replace(&mut self.history, History { matter: Vec::new(), grips: Vec::new() });
        let mut step = Step {
            material: &self.material,
            relaxation: self.material.relaxation(at.dt_s),
            old: &old,
            depth_mm: Dual::from(at.step.depth_mm),
        };
        if !self.system.evaluate(&step, &u, &mut self.state) {
            return None;
        }
        let mut moved: Vec<f64> = self.state.residual.iter().map(|r| -r.derivative).collect();
        if !matrix.solve(&mut moved) {
            return None;
        }
        let mut climb = 0.0;
        if at.station.by_force {
            let along = |v: &[f64]| matrix.pull.iter().zip(v).map(|(p, v)| p * v).sum::<f64>();
            climb = -(self.state.sum.force_n.derivative + along(&moved)) / (matrix.direct + along(rate));
            for (m, v) in moved.iter_mut().zip(rate) {
                *m += climb * v;
            }
        }
        for (u, m) in u.iter_mut().zip(&moved) {
            u.derivative = *m;
        }
        step.depth_mm = Dual::new(at.step.depth_mm, climb);
        if !self.system.evaluate(&step, &u, &mut self.state) {
            return None;
        }
        self.history.clone_from(&self.state.history);
        if !at.between {
            self.raw.push(self.state.sum.force_n.derivative());
            self.energy.push(self.state.sum.penalty_energy);
            self.depth.push(step.depth_mm);
        }
        Some(())
    }
}
