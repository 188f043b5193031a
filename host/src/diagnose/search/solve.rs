//! Finite elements of whole paths for the explanations that may be named.

use lut_gen::effect::{second_term, softening};
use nalgebra::DVector;

use super::super::fit::{Candidate, Fit, Problem, coordinates};
use super::begin::{measured, suit};
use super::{Explanation, Search, allowed, score};

/// Fits of a list that are solved with finite elements, and how far (sum of squares) behind the best they may lie: what the chain allows
/// for costs an effect that it has nearly right less than that.
const SOLVED: usize = 3;
const NEAR: f64 = 60.0;
/// Effects that the chain has only roughly are also solved where they explain this part less than the best does: a second term as a second
/// force is wrong by 16 % of what it adds, a memory of the whole contact by as much.
const FAR: f64 = 0.5;
/// Part of the first term that a second one begins with where it is solved from the start.
const RATIO: f64 = 0.3;
/// Solves of one fit, each at the point where the last one led, and the change of the sum of squares that ends them.
const SOLVES: usize = 3;
const SAME: f64 = 1.0;

impl Search<'_> {
    /// The fit once more with finite elements of the whole paths at its point; none where they fail, or where the chain needs none.
    #[must_use]
    pub fn solved(&self, fit: &Fit) -> Option<Fit> {
        if !lut_gen::chain::is_rough(&fit.model) {
            return None;
        }
        let rough = fit.candidates.iter().any(|c| is_far(c, fit));
        let rounds = if rough { SOLVES } else { 1 };
        let own = self.rounds(&fit.candidates, fit.x.clone(), rounds);
        // two terms have several valleys, and the chain's own may be none
        let term = fit.candidates.first().filter(|c| rough && fit.candidates.len() == 1 && is_term(c));
        let others = term.into_iter().flat_map(|c| c.effect.quantities[1].starts).filter_map(|alpha| {
            let list = coordinates(self.problem.design, &fit.candidates);
            let known = self.base.x.len();
            let values = [RATIO, *alpha];
            let place = |i: usize| if i < known { self.base.x[i] } else { list[i].of(values[i - known]) };
            let mut x = DVector::from_fn(list.len(), |i, _| place(i));
            suit(self.problem, (&list, &fit.candidates), &measured(self.problem), &mut x);
            self.rounds(&fit.candidates, x, SOLVES)
        });
        others.chain(own).min_by(|a, b| a.discounted.total_cmp(&b.discounted))
    }

    /// Solves at a point and fits near it, some times over.
    fn rounds(&self, candidates: &[Candidate], mut x: DVector<f64>, most: usize) -> Option<Fit> {
        let problem = self.problem;
        let groups: Vec<usize> = problem.design.series.iter().map(|s| s.group).collect();
        let windows = problem.design.windows();
        let list = coordinates(problem.design, candidates);
        let mut found: Option<Fit> = None;
        for _ in 0..most {
            let model = problem.model(&list, candidates, &x);
            let whole = problem.chain.whole(&model, &problem.contacts_mm, &windows, &groups).ok()?;
            let near = Problem { whole: Some(whole), ..problem.clone() };
            let next = near.fit(candidates, &x);
            let next = problem.refit(&next, &allowed(problem, &next));
            let settled = found.as_ref().is_some_and(|before| (before.discounted - next.discounted).abs() < SAME);
            x = next.x.clone();
            found = Some(next);
            if settled {
                break;
            }
        }
        found
    }

    /// Finite elements of the whole paths for the best of a list, each of which is compared with what it extends: the chain is not let
    /// alone with a name.
    pub(super) fn solve_best(&self, list: &mut [Explanation], before: Vec<Fit>) {
        let Some(best) = list.iter().map(Explanation::score).min_by(f64::total_cmp) else { return };
        let near = |e: &Explanation| e.score() < best + NEAR;
        // what the chain has only roughly may be the best and seem far behind
        let none = score(&self.base);
        let far = |e: &Explanation| {
            let rough = e.fit.candidates.iter().any(|c| is_far(c, &e.fit));
            // the chain may see nothing in a second term at all
            let term = matches!(&e.fit.candidates[..], [only] if is_term(only));
            rough && (term || e.beats_noise && e.score() < best + FAR * (none - best))
        };
        let mut left = SOLVED;
        for (explanation, before) in list.iter_mut().zip(&before) {
            let wanted = explanation.beats_noise && near(explanation) && left > 0;
            if (wanted || far(explanation))
                && let Some(fit) = self.solved(&explanation.fit)
            {
                *explanation = self.compared(fit, before);
            }
            left -= usize::from(wanted);
        }
    }
}

/// True for effects whose chain is so rough that one solve leads to a point where the next one is needed, unless there was one near by.
fn is_far(candidate: &Candidate, fit: &Fit) -> bool {
    let code = candidate.effect.code;
    let near = fit.model.whole.as_ref().is_some_and(|whole| whole.covers(code));
    [second_term::EFFECT.code, softening::EFFECT.code].contains(&code) && !near
}

fn is_term(candidate: &Candidate) -> bool {
    candidate.effect.code == second_term::EFFECT.code
}
