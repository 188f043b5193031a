//! Where fits begin: no start that is too far off, and none that what is missing has bent.

use lut_gen::chain::Model;
use lut_gen::effect::{Quantity, Sizes, Spread, Stage};
use nalgebra::DVector;

use super::super::coordinate::{Candidate, Coordinate, coordinates};
use super::super::fit::{Fit, Problem};
use super::signature::starts;
use super::{Search, allowed};

/// Exponent from which a fit begins anew where the one before it may have been bent by what is missing.
const MIDDLE: f64 = 7.0;
/// Largest factor on the modulus with which a start is judged.
const STIFFER: f64 = 5.0;
/// Starts of a candidate's parameters that are followed, the most promising first.
const DESCENTS: usize = 2;

/// Where the search for a quantity begins: of an amplitude also close to nothing, since a start that is too large drives the base away; one that begins at nothing is there.
fn beginnings(q: &Quantity, sizes: &Sizes) -> Vec<f64> {
    const LITTLE: f64 = 0.05;
    let own = q.starts.iter().map(|v| q.scaled(*v, sizes));
    let null = q.scaled(q.begins, sizes);
    let far = own.clone().filter(|v| q.spread == Spread::Even && *v != null);
    let close = far.map(|v| null + LITTLE * (v - null));
    own.clone().chain(close).collect()
}

impl Search<'_> {
    /// The best fit of another fit's effects with one more candidate, from all starts.
    #[must_use]
    pub fn extended(&self, from: &Fit, candidate: &Candidate) -> Fit {
        let candidates: Vec<Candidate> = from.candidates.iter().copied().chain([*candidate]).collect();
        let list = coordinates(self.problem.design, &candidates);
        let sizes = candidate.sizes(self.problem.design);
        let known = from.x.len();
        let problem = Problem { whole: from.model.whole.clone(), ..self.problem.clone() };
        let measured = measured(&problem);
        // an exponent that what is missing has bent would keep what comes from being found
        let bent = from.at_bound
            || !from.candidates.is_empty()
            || matches!(candidate.effect.stage, Stage::Specimen | Stage::Material | Stage::Contact | Stage::Machine);
        let alphas: Vec<f64> = std::iter::once(from.x[1]).chain(bent.then_some(MIDDLE.ln())).collect();
        let points = alphas.into_iter().flat_map(|alpha| {
            let place = |i: usize, values: &[f64]| match i {
                1 => alpha,
                i if i < known => from.x[i],
                i => list[i].of(values[i - known]),
            };
            let mut points: Vec<(f64, DVector<f64>)> = starts(candidate, |q| beginnings(q, &sizes))
                .into_iter()
                .map(|values| {
                    let mut x = DVector::from_fn(list.len(), |i, _| place(i, &values));
                    (suit(&problem, (&list, &candidates), &measured, &mut x), x)
                })
                .collect();
            points.sort_by(|a, b| a.0.total_cmp(&b.0));
            points.into_iter().take(DESCENTS)
        });
        // the most promising first: what it comes to spares the others the way to their ends
        let mut points: Vec<(f64, DVector<f64>)> = points.collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        let points: Vec<DVector<f64>> = points.into_iter().map(|(_, x)| x).collect();
        let best = problem.best_of(&candidates, &points);
        // what the effect may itself be wrong by must not pull the parameters
        best.map_or_else(|| from.clone(), |fit| self.problem.refit(&fit, &allowed(&self.problem, &fit)))
    }
}

/// What was measured, whitened.
pub(super) fn measured(problem: &Problem<'_>) -> DVector<f64> {
    problem.residual(&Model::base(1e-9, MIDDLE))
}

/// Moves a point to the modulus that suits it, all forces being in proportion to that; the sum of squares that is left.
pub(super) fn suit(
    problem: &Problem<'_>,
    (list, candidates): (&[Coordinate], &[Candidate]),
    measured: &DVector<f64>,
    x: &mut DVector<f64>,
) -> f64 {
    let force = measured - problem.residual(&problem.model(list, candidates, x));
    let share = (measured.dot(&force) / force.norm_squared()).clamp(1.0 / STIFFER, STIFFER);
    x[0] += share.ln();
    (measured - force * share).norm_squared()
}
