//! Where an adhesive contact loses its equilibrium, it jumps to another one.

use super::newton::{Configuration, Problem, Workspace};
use super::{Newton, Step};

/// Largest motion of a node in one step of the fall, in ranges of the attraction: what the surface
/// is attracted by must not be stepped over.
const STRIDE: f64 = 2.0;
/// Damping in units of the stiffness' diagonal: of the first step, by which it falls and rises,
/// and below which Newton's method takes over.
const FIRST: f64 = 1e-2;
const CHANGE: f64 = 4.0;
const LEAST: f64 = 1e-6;
/// Motion of a node, in motions of the ball, that no path leads to.
const FAR: f64 = 4.0;
/// Factorisations before the fall is given up.
const STEPS: usize = 300;

impl Newton {
    /// Lets the block fall from `at`, which is no equilibrium at the prescribed depth, to a stable one:
    /// the motion of a block damped in proportion to the diagonal of its stiffness, by the implicit rule
    /// of Euler with steps as long as the attraction's range allows (pseudo-transient continuation,
    /// Kelley and Keyes 1998, doi:10.1137/S0036142996304796). Returns the factorisations, or `None`
    /// when it does not come to rest (`at` is then spoilt).
    pub(super) fn fall(
        &self,
        problem: &Problem,
        range_mm: f64,
        at: &mut Configuration,
        w: &mut Workspace,
    ) -> Option<usize> {
        let relaxation = problem.material.relaxation(problem.dt_s);
        let (mut damping, before) = (FIRST, w.factorisations);
        let mut correction = vec![0.0; at.u.len()];
        while w.factorisations < before + STEPS {
            let step = Step {
                material: problem.material,
                relaxation: relaxation.clone(),
                old: problem.old,
                depth_mm: at.depth_mm,
            };
            if !problem.system.assemble(&step, &at.u, &mut w.state, &mut w.matrix) {
                return None;
            }
            w.matrix.damp(damping);
            w.factorisations += 1;
            w.iterations += 1;
            if !w.matrix.factorise() {
                return None;
            }
            let steady = w.matrix.is_definite();
            for (c, r) in correction.iter_mut().zip(&w.state.residual) {
                *c = -r;
            }
            w.matrix.correct(&mut correction);
            let longest = correction.iter().fold(0.0, |m: f64, c| m.max(c.abs()));
            if !steady || longest.is_nan() || longest > STRIDE * range_mm {
                damping *= CHANGE;
                continue;
            }
            at.u.iter_mut().zip(&correction).for_each(|(u, c)| *u += c);
            if longest < 0.5 * STRIDE * range_mm / CHANGE {
                damping /= CHANGE;
            }
            if damping < LEAST {
                w.forget();
                let mut rest = at.clone();
                if self.equilibrate(problem, &mut rest, w).is_some() && self.is_stable(problem, &rest, w) {
                    *at = rest;
                    return Some(w.factorisations - before);
                }
                damping = 1e-4;
            }
        }
        None
    }

    /// True when no path led from one displacement to the next: a node moved by more than the range of
    /// the attraction and by far more than the ball.
    pub(super) fn is_jump(range_mm: f64, from: &Configuration, to: &Configuration) -> bool {
        let moved = from.u.iter().zip(&to.u).fold(0.0, |m: f64, (a, b)| m.max((a - b).abs()));
        moved > range_mm.max(FAR * (to.depth_mm - from.depth_mm).abs())
    }

    /// True when the equilibrium `at` is stable: its stiffness, assembled anew, is positive definite and,
    /// under a prescribed force, the force rises with the depth. The factor is then that of `at`.
    pub(super) fn is_stable(&self, problem: &Problem, at: &Configuration, w: &mut Workspace) -> bool {
        self.refactorise(problem, at, w) && w.matrix.is_definite() && (!problem.by_force() || w.slope() > 0.0)
    }
}
