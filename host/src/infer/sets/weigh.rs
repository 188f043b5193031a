//! The evidence of one set, and what is believed of it beforehand.

use nalgebra::DMatrix;
use rayon::prelude::*;

use super::{Fitted, Forward};
use crate::infer::evidence::{Discrepancy, Evidence, Linearised, evidence};

/// A set of effects, fitted, with its evidence.
#[derive(Debug, Clone)]
pub struct Weighed<T> {
    /// The fit, in the noise that all are compared in.
    pub fit: T,
    /// What it may be wrong by as its effects are written down.
    pub known: DMatrix<f64>,
    /// The evidence for it.
    pub evidence: Evidence,
    /// Logarithm of the evidence times the odds before the data.
    pub log: f64,
}

impl<T: Fitted> Weighed<T> {
    /// Of a fit that was made in another noise; none where it has no evidence.
    pub fn again<F: Forward<Fit = T>>(of: &F, fit: &T, discrepancy: &Discrepancy, sizes: &[f64]) -> Option<Self> {
        Self::of(of, of.again(fit), discrepancy, sizes)
    }

    /// Of a fit in the noise of a model; `sizes` are those of the discrepancies of a like fit, if any.
    pub fn of<F: Forward<Fit = T>>(of: &F, fit: T, discrepancy: &Discrepancy, sizes: &[f64]) -> Option<Self> {
        let known = of.form_error(&fit);
        let evidence = evidence(&fit.linearised(&known), discrepancy, sizes)?;
        let odds: f64 = fit.effects().iter().map(|effect| of.log_odds(effect)).sum();
        let log = evidence.log + odds;
        Some(Self { fit, known, evidence, log })
    }

    /// The same with the sizes of the discrepancies searched from those of another set, where that makes it
    /// likelier.
    fn beside(mut self, sizes: &[f64], discrepancy: &Discrepancy) -> Self {
        let found = evidence(&self.linearised(), discrepancy, sizes);
        if let Some(found) = found.filter(|found| found.log > self.evidence.log) {
            self.log += found.log - self.evidence.log;
            self.evidence = found;
        }
        self
    }

    /// True for a set with no discrepancy beside it.
    #[must_use]
    pub fn is_alone(&self, discrepancy: &Discrepancy) -> bool {
        discrepancy.is_none_of(&self.evidence.sizes)
    }

    /// True for the base.
    #[must_use]
    pub fn is_base(&self) -> bool {
        self.fit.effects().is_empty()
    }

    /// The model about its fit.
    #[must_use]
    pub fn linearised(&self) -> Linearised<'_> {
        self.fit.linearised(&self.known)
    }
}

/// How far behind the likeliest a set may lie and still be searched from other sizes, and of how many
/// sets the sizes are taken.
const NEAR: f64 = 40.0;
const GIVEN: usize = 3;

/// Sets with sizes of their discrepancies that are comparable: a search for sizes ends at a peak, and
/// two sets that stand at different peaks do not compare.
#[must_use]
pub fn level<T: Fitted>(all: Vec<Weighed<T>>, discrepancy: &Discrepancy) -> Vec<Weighed<T>> {
    let mut order: Vec<&Weighed<T>> = all.iter().collect();
    order.sort_by(|a, b| b.log.total_cmp(&a.log));
    let Some(best) = order.first().map(|set| set.log) else { return all };
    let mut given: Vec<Vec<f64>> = Vec::new();
    for set in order {
        let sizes = &set.evidence.sizes[..discrepancy.groups().min(set.evidence.sizes.len())];
        if given.len() < GIVEN && !given.iter().any(|known| known == sizes) {
            given.push(sizes.to_vec());
        }
    }
    let again = |set: Weighed<T>| match set.log > best - NEAR {
        true => given.iter().fold(set, |set, sizes| set.beside(sizes, discrepancy)),
        false => set,
    };
    all.into_par_iter().map(again).collect()
}
