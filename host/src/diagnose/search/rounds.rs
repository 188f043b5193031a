//! Solves with finite elements one after the other, each where a fit near the last one led, until they stay.

use std::sync::Arc;

use lut_gen::chain::{Detail, Whole};
use nalgebra::{DMatrix, DVector};

use super::super::coordinate::{Candidate, Coordinate, coordinates, point};
use super::super::fit::{Fit, Problem, freedom};
use super::{Search, allowed};

/// Change of the sum of squares that ends the solves of one fit: two of them at one place differ by as much.
pub(super) const SAME: f64 = 2.0;
/// Solves of the likeliest explanation, which must end where its solve is.
pub(super) const SETTLES: usize = 5;
/// Change that ends them as a part of what is left beyond noise, of which a tenth more than expected may be there: what leaves far more is not named, and need not be brought to its end.
const LEFT: f64 = 0.05;
const NOISY: f64 = 1.1;
/// A fit near a solve may promise this much less than what was left at the solve; of one that promises more only that is believed.
const KEPT: f64 = 4.0;

/// Part of the first of two rounds that the next begins with: least, which goes beyond the second, and most.
const MIXED: (f64, f64) = (-1.0, 0.7);
/// Rounds one after the other that are no better than the best for no more to be made.
const WORSE: usize = 1;

/// What a solve at a point left, and what a fit near it does.
pub(super) struct Solved {
    pub here: Fit,
    pub near: Fit,
}

impl Solved {
    /// What the fit promises to gain on the solve.
    pub fn promise(&self) -> f64 {
        self.here.discounted - self.near.discounted
    }

    /// Where the next round begins after this one, which was made after another.
    fn after(&self, first: &Self) -> DVector<f64> {
        let x = mixed((&first.here.x, &first.near.x), (&self.here.x, &self.near.x), &self.near.information);
        let bounds = self.near.coordinates.iter().map(Coordinate::bounds);
        DVector::from_iterator(x.len(), x.iter().zip(bounds).map(|(x, (low, high))| x.clamp(low, high)))
    }
}

impl Search<'_> {
    /// Solves at a point, and fits near it.
    pub(super) fn solve_at(&self, candidates: &[Candidate], x: &DVector<f64>, detail: Detail) -> Option<Solved> {
        let problem = &self.problem;
        let groups: Vec<usize> = problem.design.series.iter().map(|s| s.group).collect();
        let windows = problem.design.windows();
        let model = problem.model(&coordinates(problem.design, candidates), candidates, x);
        let whole = problem.chain.whole(&model, &problem.contacts_mm, &windows, &groups, detail).ok()?;
        Some(self.around(candidates, (x, x), whole))
    }

    /// The solve that a fit is near to, if it is one of its own effects and not a coarse one.
    fn at_hand(&self, fit: &Fit) -> Option<Solved> {
        let whole = fit.model.whole.as_ref().filter(|whole| whole.detail() == Detail::Names)?;
        let x = self.place_of(fit, whole)?;
        Some(self.around(&fit.candidates, (&x, &fit.x), whole.clone()))
    }

    /// Where finite elements were solved, in the coordinates of a fit; none if they were of other effects.
    pub(super) fn place_of(&self, fit: &Fit, whole: &Whole) -> Option<DVector<f64>> {
        point(&coordinates(self.problem.design, &fit.candidates), &fit.candidates, whole.place())
    }

    /// What a solve at a point left, and a fit near it that begins from another one.
    fn around(
        &self,
        candidates: &[Candidate],
        (x, start): (&DVector<f64>, &DVector<f64>),
        whole: Arc<Whole>,
    ) -> Solved {
        let problem = &self.problem;
        let own = Problem { whole: Some(whole), ..problem.clone() };
        let near = own.fit(candidates, start);
        let allowed = allowed(problem, &near);
        Solved { near: problem.refit(&near, &allowed), here: own.at(candidates, x, &allowed) }
    }

    /// Rounds from a fit, the first of them the solve that it is near to, if there is one.
    pub(super) fn rounds_of(&self, fit: &Fit, (most, same): (usize, f64)) -> Option<Fit> {
        match self.at_hand(fit) {
            Some(first) => self.rounds(&fit.candidates, first, (most, same)),
            None => self.rounds_at(&fit.candidates, &fit.x, (most, same)),
        }
    }

    /// Solves at a point and fits near it, some times over, and comes back with what is near the best point that was solved: what a fit
    /// far from its solve promises need not be kept.
    pub(super) fn rounds_at(
        &self,
        candidates: &[Candidate],
        x: &DVector<f64>,
        (most, same): (usize, f64),
    ) -> Option<Fit> {
        let first = self.solve_at(candidates, x, Detail::Names)?;
        self.rounds(candidates, first, (most - 1, same))
    }

    /// The same after a first solve, some times more at most.
    pub(super) fn rounds(&self, candidates: &[Candidate], first: Solved, (more, same): (usize, f64)) -> Option<Fit> {
        let settled = |solved: &Solved| solved.promise() < same.max(LEFT * self.left(&solved.near));
        let mut x = first.near.x.clone();
        let (mut best, mut worse) = (first, 0);
        let mut ended = settled(&best);
        for _ in 0..more {
            if ended {
                break;
            }
            let solved = self.solve_at(candidates, &x, Detail::Names)?;
            if solved.here.discounted < best.here.discounted {
                x = solved.after(&best);
                ended = settled(&solved);
                (best, worse) = (solved, 0);
            } else {
                worse += 1;
                // two solves of one place differ by more than the same
                ended = worse > WORSE || best.promise() < SAME;
                if ended {
                    break;
                }
                // too far: half of the way
                x = 0.5 * (&best.here.x + &x);
            }
        }
        let promise = best.promise();
        let mut end = if promise < KEPT { best.near } else { best.here };
        end.settled = ended;
        Some(end)
    }

    /// What a fit leaves beyond what noise does, as a sum of squares.
    fn left(&self, fit: &Fit) -> f64 {
        (fit.discounted - NOISY * freedom(&self.problem.used, fit)).max(0.0)
    }
}

/// Where a third round should begin, from where two did and where they led, the second of them after the first: of steps that go to and fro, or slowly one way, the end
/// lies where a line through both comes to nothing (Anderson's mixing of two). Lengths are those of the data, which have this information on the parameters.
fn mixed(
    first: (&DVector<f64>, &DVector<f64>),
    second: (&DVector<f64>, &DVector<f64>),
    information: &DMatrix<f64>,
) -> DVector<f64> {
    let last = second.1 - second.0;
    let change = &last - (first.1 - first.0);
    let along = information * &change;
    let share = along.dot(&last) / along.dot(&change);
    let share = if share.is_finite() { share.clamp(MIXED.0, MIXED.1) } else { 0.0 };
    second.1 - share * (second.1 - first.1)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rounds that go to and fro, and such that creep, end at once where each leads as much too far, or too little, as the one before it did.
    #[test]
    fn mixed_rounds_end_where_a_line_through_them_does() {
        let end = DVector::from_vec(vec![0.3, -1.2, 4.0]);
        let off = DVector::from_vec(vec![1.0, 0.2, -0.5]);
        for factor in [-0.7, -0.3, 0.4] {
            let leads = |x: &DVector<f64>| &end + factor * (x - &end);
            let one = &end + &off;
            let two = leads(&one);
            let found = mixed((&one, &two), (&two, &leads(&two)), &DMatrix::identity(3, 3));
            assert!((found - &end).amax() < 1e-12, "{factor}");
        }
        // where nothing changes the second is right
        let same = mixed((&end, &end), (&end, &end), &DMatrix::identity(3, 3));
        assert!((same - &end).amax() < 1e-12);
    }
}
