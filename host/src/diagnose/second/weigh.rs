//! The evidence of one explanation, and what is believed of it beforehand.

use lut_gen::effect::Spread;
use nalgebra::DMatrix;

use crate::diagnose::coordinate::{Candidate, Coordinate};
use crate::diagnose::evidence::Adequacy;
use crate::diagnose::fit::{Fit, Problem};
use crate::diagnose::search::{Explanation, Search, form_error};
use crate::infer::evidence::{Discrepancy, Evidence, Linearised, Parameter, Prior, evidence};
use crate::infer::lowrank::Fold;
use crate::infer::presence;

/// A fit with its evidence.
#[derive(Debug, Clone)]
pub(super) struct Weighed {
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
    pub fn again(search: &Search<'_>, fit: &Fit, discrepancy: &Discrepancy, sizes: &[f64]) -> Option<Self> {
        let here = beside_its_solve(search, fit).at(&fit.candidates, &fit.x, &Fold::none());
        Self::of(search, here, discrepancy, sizes)
    }

    /// Of a fit in the noise of a search; `sizes` are those of the discrepancies of a like fit, if any.
    pub fn of(search: &Search<'_>, fit: Fit, discrepancy: &Discrepancy, sizes: &[f64]) -> Option<Self> {
        let known = form_error(&beside_its_solve(search, &fit), &fit);
        let evidence = evidence(&linearised(&fit, &known), discrepancy, sizes)?;
        let odds: f64 = fit.candidates.iter().map(|c| log_odds(c, &search.candidates)).sum();
        let log = evidence.log + odds;
        Some(Self { fit, known, evidence, log })
    }

    /// The model about its fit.
    pub fn linearised(&self) -> Linearised<'_> {
        linearised(&self.fit, &self.known)
    }
}

/// A set as reports tell it.
pub(super) fn explanation(search: &Search<'_>, set: &Weighed) -> Explanation {
    let fit = set.fit.clone();
    let wrong = form_error(&search.problem, &fit);
    Explanation {
        adequacy: Adequacy::of(&fit, &search.margins, &search.panel, &wrong, &search.twins),
        beats_noise: true,
        predicts: true,
        beats_placebo: true,
        beyond_causeless: f64::INFINITY,
        gain: search.base.square - fit.square,
        fit,
    }
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
