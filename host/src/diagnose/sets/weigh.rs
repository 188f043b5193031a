//! The evidence of one explanation, and what is believed of it beforehand.

use lut_gen::effect::Spread;
use nalgebra::DMatrix;
use rayon::prelude::*;

use crate::diagnose::coordinate::{Candidate, Coordinate};
use crate::diagnose::fit::{Fit, Problem};
use crate::diagnose::search::{Search, form_error};
use crate::infer::evidence::{Discrepancy, Evidence, Linearised, Parameter, Prior, evidence};
use crate::infer::lowrank::Fold;
use crate::infer::presence;

/// A set of effects, fitted, with its evidence.
#[derive(Debug, Clone)]
pub struct Weighed {
    /// The fit, in the noise that all are compared in.
    pub fit: Fit,
    /// What it may be wrong by as its effects are written down.
    pub known: DMatrix<f64>,
    /// The evidence for it.
    pub evidence: Evidence,
    /// Logarithm of the evidence times the odds before the data.
    pub log: f64,
}

impl Weighed {
    /// Of a fit that was made in another noise; none where it has no evidence.
    pub(super) fn again(search: &Search<'_>, fit: &Fit, discrepancy: &Discrepancy, sizes: &[f64]) -> Option<Self> {
        let here = beside_its_solve(search, fit).at(&fit.candidates, &fit.x, &Fold::none());
        Self::of(search, here, discrepancy, sizes)
    }

    /// Of a fit in the noise of a search; `sizes` are those of the discrepancies of a like fit, if any.
    pub(super) fn of(search: &Search<'_>, fit: Fit, discrepancy: &Discrepancy, sizes: &[f64]) -> Option<Self> {
        let known = form_error(&beside_its_solve(search, &fit), &fit);
        let evidence = evidence(&linearised(&fit, &known), discrepancy, sizes)?;
        let odds: f64 = fit.candidates.iter().map(|c| log_odds(c, &search.candidates)).sum();
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
    pub(super) fn is_alone(&self, discrepancy: &Discrepancy) -> bool {
        self.evidence.sizes.iter().take(discrepancy.groups()).all(|size| *size == 0.0)
    }

    /// The model about its fit.
    pub(super) fn linearised(&self) -> Linearised<'_> {
        linearised(&self.fit, &self.known)
    }
}

/// How far behind the likeliest a set may lie and still be searched from other sizes, and of how many
/// sets the sizes are taken.
const NEAR: f64 = 40.0;
const GIVEN: usize = 3;

/// Sets with sizes of their discrepancies that are comparable: a search for sizes ends at a peak, and
/// two sets that stand at different peaks do not compare.
pub(super) fn level(all: Vec<Weighed>, discrepancy: &Discrepancy) -> Vec<Weighed> {
    let mut order: Vec<&Weighed> = all.iter().collect();
    order.sort_by(|a, b| b.log.total_cmp(&a.log));
    let Some(best) = order.first().map(|set| set.log) else { return all };
    let mut given: Vec<Vec<f64>> = Vec::new();
    for set in order {
        let sizes = &set.evidence.sizes[..discrepancy.groups().min(set.evidence.sizes.len())];
        if given.len() < GIVEN && !given.iter().any(|known| known == sizes) {
            given.push(sizes.to_vec());
        }
    }
    let again = |set: Weighed| match set.log > best - NEAR {
        true => given.iter().fold(set, |set, sizes| set.beside(sizes, discrepancy)),
        false => set,
    };
    all.into_par_iter().map(again).collect()
}

/// The problem with the finite elements that a fit is near to.
pub(super) fn beside_its_solve<'a>(search: &Search<'a>, fit: &Fit) -> Problem<'a> {
    Problem { whole: fit.model.whole.clone(), ..search.problem.clone() }
}

fn linearised<'a>(fit: &'a Fit, known: &'a DMatrix<f64>) -> Linearised<'a> {
    let parameters = fit.coordinates.iter().zip(fit.x.iter()).map(|(coordinate, x)| Parameter {
        x: *x,
        bounds: coordinate.bounds(),
        prior: prior(coordinate),
    });
    Linearised { residual: &fit.residual, jacobian: &fit.jacobian, parameters: parameters.collect(), known }
}

/// What is known of a parameter beforehand. Amounts of effects are as a rule about their prior
/// deviation and may be far larger; times and places have a wide prior over their bounds.
fn prior(coordinate: &Coordinate) -> Prior {
    match coordinate {
        Coordinate::LnMu | Coordinate::LnAlpha | Coordinate::Zero => Prior::Flat,
        Coordinate::Of(_, q) if q.spread == Spread::Even && q.prior > 0.0 => {
            Prior::Cauchy { null: q.null, scale: q.prior }
        }
        Coordinate::Of(..) => {
            let (low, high) = coordinate.bounds();
            Prior::Normal { mean: 0.5 * (low + high), deviation: 0.25 * (high - low) }
        }
    }
}

/// Logarithm of the odds of one candidate before the data: its effect's, which its forms and owners
/// share. Amounts of one sign have twice the density.
pub(super) fn log_odds(candidate: &Candidate, all: &[Candidate]) -> f64 {
    let alike = all.iter().filter(|other| other.effect.code == candidate.effect.code).count().max(1) as f64;
    let p = presence::probability();
    let sided = candidate
        .effect
        .quantities
        .iter()
        .filter(|q| q.spread == Spread::Even && q.prior > 0.0 && (q.low >= q.null || q.high <= q.null));
    (p / (1.0 - p) / alike).ln() + sided.count() as f64 * std::f64::consts::LN_2
}
