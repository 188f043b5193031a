//! What plausible amounts of an effect change.

use lut_gen::chain::Setting;
use lut_gen::effect::{Quantity, Sizes, Spread};
use nalgebra::{DMatrix, DVector};

use crate::diagnose::coordinate::Candidate;
use crate::diagnose::fit::{Fit, Problem};

/// What a plausible amount of a candidate changes, whitened: a column for every start of its shape.
#[must_use]
pub fn signature(problem: &Problem<'_>, at: &Fit, candidate: &Candidate) -> DMatrix<f64> {
    changes(problem, at, candidate, shapes(&candidate.sizes(problem.design), candidate))
}

/// What a candidate changes at each of some values of its quantities, whitened, a column each.
pub(in crate::diagnose) fn changes(
    problem: &Problem<'_>,
    at: &Fit,
    candidate: &Candidate,
    each: Vec<Vec<f64>>,
) -> DMatrix<f64> {
    let here = problem.residual(&at.model);
    let column = |values| {
        let mut model = at.model.clone();
        model.settings.push(Setting { effect: candidate.effect, owner: candidate.owner, values });
        &here - problem.residual(&model)
    };
    DMatrix::from_columns(&each.into_iter().map(column).collect::<Vec<DVector<f64>>>())
}

/// Plausible amplitudes with every start of the shape parameters.
fn shapes(sizes: &Sizes, candidate: &Candidate) -> Vec<Vec<f64>> {
    starts(candidate, |q| match q.spread {
        Spread::Even => vec![q.scaled(q.plausible, sizes)],
        Spread::Logarithmic => q.starts.to_vec(),
    })
}

/// All combinations of some values of each of a candidate's quantities.
pub(in crate::diagnose) fn starts(candidate: &Candidate, of: impl Fn(&Quantity) -> Vec<f64>) -> Vec<Vec<f64>> {
    let mut list = vec![Vec::new()];
    for q in candidate.effect.quantities {
        let values = of(q);
        list = list
            .into_iter()
            .flat_map(|head: Vec<f64>| {
                values.iter().map(move |v| head.iter().copied().chain([*v]).collect()).collect::<Vec<_>>()
            })
            .collect();
    }
    list
}
