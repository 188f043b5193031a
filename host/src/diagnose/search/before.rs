//! What every extension of a fit is compared with, found once for all of them.

use std::sync::OnceLock;

use super::super::fit::{Fit, Problem};
use super::super::placebo;
use super::{allowed, left_out};
use crate::infer::lowrank::Fold;
use crate::infer::presence::CHARGE;

/// Numbers of parameters that a candidate may have.
const PARAMETERS: usize = 6;

/// By how much a departure without a cause may be likelier than an effect beside another one, as a difference of sums of squares: with two balls a gain of one is a wrong radius
/// but for its shape, and as likely.
const ALIKE: f64 = 2.2;

/// A fit that others extend.
#[derive(Debug)]
pub struct Before {
    /// The fit.
    pub fit: Fit,
    /// What its effects may be wrong by.
    allowed: Fold,
    /// How badly it predicts conditions that were left out.
    pub left_out: f64,
    /// What must be beaten of a departure without a cause: a gain of its own for every ball, rate, specimen or cycle, or a smooth function of depth, time or clock.
    pub nameless: f64,
    /// What placebos of as many parameters gain.
    placebos: [OnceLock<f64>; PARAMETERS],
}

impl Before {
    /// Of a fit.
    #[must_use]
    pub fn new(problem: &Problem<'_>, fit: Fit) -> Self {
        Self {
            allowed: allowed(problem, &fit),
            left_out: left_out(problem.design, &fit, problem),
            nameless: placebo::causeless(problem, &fit, CHARGE) + if fit.candidates.is_empty() { 0.0 } else { ALIKE },
            placebos: [const { OnceLock::new() }; PARAMETERS],
            fit,
        }
    }

    /// By how much another fit lowers the sum of squares: what the effects of this one may be wrong by is no evidence for one more.
    #[must_use]
    pub fn gain_of(&self, other: &Fit) -> f64 {
        let left = |fit: &Fit| self.allowed.taken_off(&fit.residual).norm_squared();
        left(&self.fit) - left(other)
    }

    /// The same of placebos with a number of parameters.
    #[must_use]
    pub fn placebo(&self, problem: &Problem<'_>, parameters: usize) -> f64 {
        let find = || placebo::gain_of_any(problem, &self.fit, &self.allowed, parameters);
        self.placebos.get(parameters).map_or_else(find, |known| *known.get_or_init(find))
    }
}
