//! The path in depth: adaptive steps, each started along the tangent.

use super::newton::{Problem, Workspace};
use super::{Newton, SolveError, State, System};
use crate::law::Law;

/// Control of the depth steps; lengths in units of the ball radius.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stepping {
    /// First step.
    pub first: f64,
    /// Growth of the step after a step that converged within `easy` iterations.
    pub growth: f64,
    /// Iterations of an easy step.
    pub easy: usize,
    /// Largest step.
    pub largest: f64,
    /// Least number of stations over the whole depth, evenly in its square root, that
    /// is in contact radius: each mesh line the contact edge crosses leaves its mark in the force.
    pub stations: usize,
    /// Smallest step before giving up.
    pub smallest: f64,
    /// Newton iterations of the whole path before giving up.
    pub iterations: usize,
}

impl Default for Stepping {
    fn default() -> Self {
        Self { first: 0.02, growth: 1.5, easy: 6, largest: 0.08, stations: 24, smallest: 1e-5, iterations: 3000 }
    }
}

/// One equilibrium on the path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Station {
    /// Depth of the ball (mm).
    pub depth_mm: f64,
    /// Force on the ball from the contact (N).
    pub force_n: f64,
    /// Reaction of the base (N).
    pub base_force_n: f64,
    /// `dF/dd` along the path (N/mm).
    pub slope: f64,
    /// Energy stored in the penalty (N mm).
    pub penalty_energy: f64,
    /// Largest radius in contact (mm).
    pub contact_radius_mm: f64,
}

/// A solved path.
#[derive(Debug, Clone, PartialEq)]
pub struct Path {
    /// Equilibria in order of depth, without the trivial one at 0.
    pub stations: Vec<Station>,
    /// Newton iterations, failed ones included.
    pub iterations: usize,
    /// Steps that were given up and retried shorter.
    pub cuts: usize,
}

impl Stepping {
    /// Follows the equilibrium from 0 to `depth_mm`.
    ///
    /// # Errors
    /// [`SolveError::NoConvergence`] and [`SolveError::TooManyIterations`], named by `label`.
    pub fn follow(
        &self,
        system: &System,
        law: &impl Law,
        newton: &Newton,
        radius_mm: f64,
        depth_mm: f64,
        label: &str,
    ) -> Result<Path, SolveError> {
        let n = system.unknowns();
        let mut w = Workspace::new(system)?;
        let mut here = Point { depth: 0.0, u: vec![0.0; n], rate: vec![0.0; n] };
        let mut step = self.first * radius_mm;
        let mut out = Path { stations: Vec::new(), iterations: 0, cuts: 0 };
        while here.depth < depth_mm * (1.0 - 1e-12) {
            let rest = depth_mm - here.depth;
            step = step.min(self.longest(here.depth, radius_mm, depth_mm));
            // two equal steps rather than a full one and a sliver
            let take = if step >= rest { rest } else { step.min(0.5 * rest) };
            let depth = here.depth + take;
            let mut u = here.ahead(take);
            let problem = Problem { system, law, depth_mm: depth };
            match newton.equilibrate(&problem, &mut u, &mut w) {
                Some(used) => {
                    let mut rate: Vec<f64> = w.state.drive.iter().map(|x| -x).collect();
                    w.factor.solve(&mut rate);
                    out.stations.push(station(depth, &w.state, &rate));
                    here = Point { depth, u, rate };
                    if used <= self.easy {
                        step *= self.growth;
                    } else if used > self.easy + 2 {
                        step *= 0.8;
                    }
                }
                None => {
                    out.cuts += 1;
                    step = 0.4 * take;
                    if step < self.smallest * radius_mm {
                        return Err(SolveError::NoConvergence {
                            depth_mm: here.depth,
                            wanted_mm: depth_mm,
                            smallest_mm: self.smallest * radius_mm,
                            iterations: w.iterations,
                            law: label.to_owned(),
                        });
                    }
                }
            }
            if w.iterations > self.iterations {
                return Err(SolveError::TooManyIterations {
                    depth_mm: here.depth,
                    wanted_mm: depth_mm,
                    iterations: w.iterations,
                    law: label.to_owned(),
                });
            }
        }
        out.iterations = w.iterations;
        Ok(out)
    }

    /// Longest step at a depth (mm).
    fn longest(&self, here_mm: f64, radius_mm: f64, depth_mm: f64) -> f64 {
        let next = (here_mm / depth_mm).sqrt() + 1.0 / self.stations as f64;
        (depth_mm * next * next - here_mm).min(self.largest * radius_mm)
    }
}

/// An equilibrium and its tangent in depth.
struct Point {
    depth: f64,
    u: Vec<f64>,
    rate: Vec<f64>,
}

impl Point {
    /// The tangent, which is at the same time the first Newton correction. A
    /// quadratic start was measured to need a fifth more iterations: surface
    /// points entering contact make the second derivative jump.
    fn ahead(&self, s: f64) -> Vec<f64> {
        self.u.iter().zip(&self.rate).map(|(u, v)| u + s * v).collect()
    }
}

fn station(depth_mm: f64, state: &State, rate: &[f64]) -> Station {
    let along: f64 = state.drive.iter().zip(rate).map(|(b, v)| b * v).sum();
    Station {
        depth_mm,
        force_n: state.sum.force_n,
        base_force_n: state.base_force_n,
        slope: state.sum.stiffness + along,
        penalty_energy: state.sum.energy,
        contact_radius_mm: state.sum.radius_mm,
    }
}
