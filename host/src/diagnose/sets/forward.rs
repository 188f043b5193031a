//! Specimen and rig as sets of effects see them: fits with the chain, and what is known beforehand.

use lut_gen::effect::{Quantity, Spread};
use nalgebra::DMatrix;

use crate::diagnose::coordinate::{Candidate, Coordinate};
use crate::diagnose::fit::{Fit, Problem};
use crate::diagnose::search::{Search, form_error, signature};
use crate::infer::evidence::{Linearised, Parameter, Prior};
use crate::infer::lowrank::Fold;
use crate::infer::presence;
use crate::infer::sets::{Fitted, Forward};

impl Fitted for Fit {
    type Effect = Candidate;

    fn effects(&self) -> &[Candidate] {
        &self.candidates
    }

    fn linearised<'a>(&'a self, known: &'a DMatrix<f64>) -> Linearised<'a> {
        let parameters = self.coordinates.iter().zip(self.x.iter()).map(|(coordinate, x)| Parameter {
            x: *x,
            bounds: coordinate.bounds(),
            prior: prior(coordinate),
        });
        Linearised { residual: &self.residual, jacobian: &self.jacobian, parameters: parameters.collect(), known }
    }
}

impl Forward for Search<'_> {
    type Fit = Fit;
    type Name = &'static str;

    fn base(&self) -> &Fit {
        &self.base
    }

    fn effects(&self) -> &[Candidate] {
        &self.candidates
    }

    fn name(&self, candidate: &Candidate) -> &'static str {
        candidate.effect.code
    }

    fn is_form_of(&self, one: &Candidate, other: &Candidate) -> bool {
        (one.effect.code, one.owner) == (other.effect.code, other.owner)
    }

    /// Of an effect that a set holds another owner may be wrong as well, but not another form.
    fn may_join(&self, set: &[Candidate], candidate: &Candidate) -> bool {
        set.iter().all(|own| match own.effect.code == candidate.effect.code {
            true => own.effect == candidate.effect && own.owner != candidate.owner,
            false => true,
        })
    }

    /// Those of the effect, which its forms and owners share. Amounts of one sign have twice the density.
    fn log_odds(&self, candidate: &Candidate) -> f64 {
        let is_alike = |other: &&Candidate| other.effect.code == candidate.effect.code;
        let alike = self.candidates.iter().filter(is_alike).count();
        let is_sided =
            |q: &&Quantity| q.spread == Spread::Even && q.prior > 0.0 && (q.low >= q.null || q.high <= q.null);
        presence::log_odds(alike, candidate.effect.quantities.iter().filter(is_sided).count())
    }

    fn extended(&self, from: &Fit, candidate: &Candidate) -> Option<Fit> {
        Some(self.extended(from, candidate))
    }

    fn again(&self, fit: &Fit) -> Fit {
        beside_its_solve(self, fit).at(&fit.candidates, &fit.x, &Fold::none())
    }

    fn form_error(&self, fit: &Fit) -> DMatrix<f64> {
        form_error(&beside_its_solve(self, fit), fit)
    }

    fn signature(&self, at: &Fit, candidate: &Candidate) -> (DMatrix<f64>, Parameter) {
        let known = self.candidates.iter().position(|own| own == candidate).filter(|_| at.candidates.is_empty());
        let columns = match known {
            Some(known) => self.signatures[known].clone(),
            None => signature(&beside_its_solve(self, at), at, candidate),
        };
        (columns, amount(self, candidate))
    }
}

/// The problem with the finite elements that a fit is near to.
pub(super) fn beside_its_solve<'a>(search: &Search<'a>, fit: &Fit) -> Problem<'a> {
    Problem { whole: fit.model.whole.clone(), ..search.problem.clone() }
}

/// What is known of a parameter beforehand. Amounts of effects are as a rule about their prior
/// deviation and may be far larger; times and places have a wide prior over their bounds.
fn prior(coordinate: &Coordinate) -> Prior {
    match coordinate {
        Coordinate::LnMu | Coordinate::LnAlpha | Coordinate::LnAlphaAlone | Coordinate::Zero => Prior::Flat,
        Coordinate::Of(_, q) if q.spread == Spread::Even && q.prior > 0.0 => {
            Prior::Cauchy { null: q.null, scale: q.prior }
        }
        Coordinate::Of(..) => Prior::between(coordinate.bounds()),
    }
}

/// The amount of a candidate in plausible ones, the unit of its signature.
fn amount(search: &Search<'_>, candidate: &Candidate) -> Parameter {
    let sizes = candidate.sizes(search.problem.design);
    let amounts = candidate.effect.quantities.iter().map(|q| q.bounded_at(&sizes));
    let mut amounts = amounts.filter(|q| q.spread == Spread::Even && q.prior > 0.0 && q.plausible != q.null);
    let Some(q) = amounts.next() else {
        return Parameter { x: 0.0, bounds: (0.0, f64::MAX), prior: Prior::Cauchy { null: 0.0, scale: 1.0 } };
    };
    Parameter::in_units(q.plausible - q.null, (q.low - q.null, q.high - q.null), q.prior)
}
