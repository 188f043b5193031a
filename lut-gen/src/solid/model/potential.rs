//! What a parameter does to the force of a ramp, told from energies alone.

use super::chebyshev::{clenshaw, clenshaw_and_slope, least_squares};
use super::{DepthProfile, Simulation, Watcher};
use crate::scalar::{Dual, Real};
use crate::solid::law::{Material, Parameter};
use crate::solid::mesh::BlockMesh;
use crate::solid::solve::{Accepted, Observer, SolveError, State, Step, System};

/// Follows an elastic ramp and notes what parameters do to its energy.
///
/// The energy of an equilibrium is least, so that its derivative by a parameter is the one at fixed displacement: an evaluation
/// without a tangent, a tenth of the solve. The derivative by the depth of that is what the parameter does to the force.
pub(super) struct Potential {
    parameters: Vec<Parameter>,
    lifted: Vec<Lifted>,
    points: Vec<Point>,
}

/// The equations with the derivative by a parameter.
struct Lifted {
    system: System<Dual>,
    material: Material<Dual>,
    state: State<Dual>,
}

/// Energies at a depth.
#[derive(Debug, Clone)]
struct Point {
    depth_mm: f64,
    /// Derivatives of the potential by the parameters (N mm per unit of each).
    by: Vec<f64>,
    /// Complementary energy of the penalty (N mm).
    penalty: f64,
}

/// A solved ramp.
pub(super) struct Ramp {
    /// Its force.
    pub profile: DepthProfile,
    /// Its energies, none where no parameters were followed.
    points: Vec<Point>,
}

/// Terms in `s` of the energies: with six the exponent's part is missed by three times as much, with ten nothing is gained.
const TERMS: usize = 8;
/// Energy of Hertz's force, over `H d^2.5`.
const ENERGY: f64 = 0.4;
/// What an energy has beyond its limit for small depths, over `d^2.5 s`, counts by this power of `s`: the first contacts have few elements.
const WEIGHT: i32 = 3;

impl Potential {
    /// Notes what these parameters do.
    pub fn of(parameters: Vec<Parameter>) -> Self {
        Self { parameters, lifted: Vec::new(), points: Vec::new() }
    }

    /// The ramp that was followed, with its force.
    pub fn ramp(self, profile: DepthProfile) -> Ramp {
        Ramp { profile, points: self.points }
    }
}

impl Watcher for Potential {
    fn begins(
        &mut self,
        simulation: &Simulation,
        mesh: &BlockMesh,
        stiffer: f64,
        _: &System,
    ) -> Result<(), SolveError> {
        self.points.clear();
        let lifted = self.parameters.iter().map(|parameter| simulation.lifted(mesh, stiffer, *parameter));
        self.lifted = lifted
            .map(|own| Lifted { state: own.system.state(), system: own.system, material: own.material })
            .collect();
        Ok(())
    }

    fn restarted(&mut self) {
        self.points.clear();
    }
}

impl Observer for Potential {
    fn accepted(&mut self, at: &Accepted) -> Result<(), SolveError> {
        let depth_mm = Dual::from(at.station.depth_mm);
        let u: Vec<Dual> = at.u.iter().map(|x| Dual::from(*x)).collect();
        let mut by = Vec::with_capacity(self.lifted.len());
        for Lifted { system, material, state } in &mut self.lifted {
            let old = system.untouched(material, depth_mm);
            let step = Step { material, relaxation: material.relaxation(at.dt_s), old: &old, depth_mm };
            if !system.evaluate(&step, &u, state) {
                return Err(SolveError::Singular { depth_mm: at.station.depth_mm });
            }
            by.push(state.potential.derivative());
        }
        self.points.push(Point { depth_mm: at.station.depth_mm, by, penalty: at.station.penalty_energy });
        Ok(())
    }
}

impl Ramp {
    /// A ramp of which only the force is known.
    pub fn alone(profile: DepthProfile) -> Self {
        Self { profile, points: Vec::new() }
    }

    /// Points in contact with their `s = sqrt(d / d_max)`.
    fn pressed(&self) -> impl Iterator<Item = (f64, &Point)> {
        let placed = self.points.iter().filter(|p| p.penalty > 0.0);
        placed.map(|p| ((p.depth_mm / self.profile.depth_max_mm).sqrt(), p))
    }

    /// `ln(E / d^2)` of the penalty, over `2 s - 1`.
    fn softness(&self) -> Vec<f64> {
        let points: Vec<_> =
            self.pressed().map(|(s, p)| (2.0 * s - 1.0, (p.penalty / p.depth_mm.powi(2)).ln(), s)).collect();
        least_squares(&points, TERMS)
    }
}

/// What a parameter does to the force of hard contact, over Hertz's force, at each `s`, for every ramp of a line over it; it is one of those that were followed. `derivatives`
/// differentiates, at the parameters of the ramps, what has the given values there; `hertz` is the derivative of the logarithm of Hertz's factor there, which what is told begins with at a depth of nothing.
///
/// The potential of hard contact is that of the soft one and the penalty's complementary energy, whose derivative needs no equation: it is small, and
/// smooth over the line.
pub(super) fn slopes(
    line: &[&Ramp],
    parameter: usize,
    (derivatives, hertz): (impl Fn(&[f64]) -> Vec<f64>, &[f64]),
    at: &[f64],
) -> Vec<Vec<f64>> {
    let softness: Vec<Vec<f64>> = line.iter().map(|ramp| ramp.softness()).collect();
    let of = |(k, ramp): (usize, &&Ramp)| -> Vec<f64> {
        let energy = |(s, p): (f64, &Point)| {
            let logarithms: Vec<f64> = softness.iter().map(|c| clenshaw(c, 2.0 * s - 1.0)).collect();
            let by = p.by[parameter] + p.penalty * derivatives(&logarithms)[k];
            let beyond = by / (ramp.profile.hertz * p.depth_mm.powf(2.5)) - ENERGY * hertz[k];
            (2.0 * s - 1.0, beyond / s, s.powi(WEIGHT))
        };
        let points: Vec<_> = ramp.pressed().map(energy).collect();
        let coefficients = least_squares(&points, TERMS);
        // of H d^2.5 (ENERGY hertz + s g(s)), by the depth
        let slope = |s: &f64| {
            let (g, half) = clenshaw_and_slope(&coefficients, 2.0 * s - 1.0);
            hertz[k] + s * (3.0 * g + s * half)
        };
        at.iter().map(slope).collect()
    };
    line.iter().enumerate().map(of).collect()
}
