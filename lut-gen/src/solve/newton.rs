//! Newton's method for one depth.

use super::{Factor, SolveError, State, System};
use crate::law::Law;

/// Settings of Newton's method.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Newton {
    /// Converged when the residual's norm is below this part of the contact force's norm.
    pub tolerance: f64,
    /// Iterations before the step is given up.
    pub iterations: usize,
    /// Halvings of one correction before the step is given up.
    pub halvings: usize,
}

impl Default for Newton {
    fn default() -> Self {
        Self { tolerance: 1e-4, iterations: 14, halvings: 6 }
    }
}

/// Scratch of the iteration, kept between steps.
pub struct Workspace {
    /// State at the last evaluated displacement.
    pub state: State,
    /// Factor of the last stiffness.
    pub factor: Factor,
    correction: Vec<f64>,
    trial: Vec<f64>,
    /// Iterations so far.
    pub iterations: usize,
}

impl Workspace {
    /// Scratch for a system.
    ///
    /// # Errors
    /// [`SolveError::Memory`].
    pub fn new(system: &System) -> Result<Self, SolveError> {
        Ok(Self {
            state: system.state(),
            factor: system.factor()?,
            correction: vec![0.0; system.unknowns()],
            trial: vec![0.0; system.unknowns()],
            iterations: 0,
        })
    }
}

/// Fall of the energy still to be gained, relative to the first correction's, at which
/// rounding decides: reached before the tolerance where the contact force is tiny.
const ROUNDING: f64 = 1e-12;

fn norm(x: &[f64]) -> f64 {
    x.iter().map(|x| x * x).sum::<f64>().sqrt()
}

fn dot(x: &[f64], y: &[f64]) -> f64 {
    x.iter().zip(y).map(|(x, y)| x * y).sum()
}

/// A system with its law at one depth.
#[derive(Debug)]
pub struct Problem<'a, L: Law> {
    /// The equations.
    pub system: &'a System,
    /// The material.
    pub law: &'a L,
    /// Depth of the ball (mm).
    pub depth_mm: f64,
}

impl<L: Law> Problem<'_, L> {
    fn evaluate(&self, u: &[f64], state: &mut State) -> bool {
        self.system.evaluate(self.law, u, self.depth_mm, true, state)
    }
}

impl Newton {
    /// Corrects `u` until it is in equilibrium. Returns the number of iterations,
    /// or `None` when it did not converge (`u` is then spoilt).
    pub fn equilibrate(&self, problem: &Problem<impl Law>, u: &mut [f64], w: &mut Workspace) -> Option<usize> {
        if !problem.evaluate(u, &mut w.state) {
            return None;
        }
        let mut first = None;
        for k in 1..=self.iterations {
            w.iterations += 1;
            factorise(problem.system, w)?;
            for (c, r) in w.correction.iter_mut().zip(&w.state.residual) {
                *c = -r;
            }
            w.factor.solve(&mut w.correction);
            let slope = dot(&w.correction, &w.state.residual).abs();
            let start = *first.get_or_insert(slope);
            self.advance(problem, u, w)?;
            let now = norm(&w.state.residual);
            if !now.is_finite() {
                return None;
            }
            let balanced = now <= self.tolerance * norm(&w.state.contact);
            if balanced || slope <= ROUNDING * start {
                return Some(k);
            }
        }
        None
    }

    /// Takes the correction, halved until the residual falls or the potential's
    /// slope along the correction falls.
    fn advance(&self, problem: &Problem<impl Law>, u: &mut [f64], w: &mut Workspace) -> Option<()> {
        let slope = dot(&w.correction, &w.state.residual);
        let before = norm(&w.state.residual);
        let mut part = 1.0;
        for _ in 0..=self.halvings {
            for ((t, u), c) in w.trial.iter_mut().zip(&*u).zip(&w.correction) {
                *t = u + part * c;
            }
            if problem.evaluate(&w.trial, &mut w.state) {
                let after = dot(&w.correction, &w.state.residual);
                if after.abs() <= 0.9 * slope.abs() || norm(&w.state.residual) < 0.9 * before {
                    u.copy_from_slice(&w.trial);
                    return Some(());
                }
            }
            part *= 0.5;
        }
        None
    }
}

/// Factorises the stiffness; when it is not positive definite, with a growing
/// multiple of its diagonal added (the correction is then a descent direction).
fn factorise(system: &System, w: &mut Workspace) -> Option<()> {
    let mut shift = 0.0;
    for _ in 0..8 {
        if w.factor.factorise(system.pattern(), &w.state.values) {
            return Some(());
        }
        let next = if shift == 0.0 { 1e-3 } else { 4.0 * shift };
        let grow = (1.0 + next) / (1.0 + shift);
        for &d in system.pattern().diagonal() {
            let v = &mut w.state.values[d];
            *v = if *v > 0.0 { *v * grow } else { v.abs().max(1e-12) };
        }
        shift = next;
    }
    None
}
