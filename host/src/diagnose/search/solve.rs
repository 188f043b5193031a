//! Finite elements of whole paths for the explanations that may be named.

use lut_gen::chain::Detail;
use lut_gen::effect::{friction, second_term, softening};
use nalgebra::DVector;

use super::super::fit::{Candidate, Fit, Problem, coordinates};
use super::before::Before;
use super::begin::{measured, suit};
use super::{Explanation, Search, allowed, score};

/// Names, of one effect or of two, that are solved with finite elements, and how far (sum of squares) behind the best they may lie: what the chain allows
/// for costs an effect that it has nearly right less than that. Which ball it is, or in which form, does not count: two balls in two forms had left no place for what it was.
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
/// The same of what is named in the end: its parameters lie within a fifth of their errors of where the next solve would lead.
const ENDS: f64 = 0.04;
/// Solves of the likeliest explanation, which must end where its solve is.
const SETTLES: usize = 5;
/// A fit near a solve may promise this much less than what was left at the solve; of one that promises more only that is believed.
const KEPT: f64 = 4.0;

/// Valleys of a second term beside another effect that are followed to their ground.
const FOLLOWED: usize = 2;

/// What a solve at a point left, and what a fit near it does.
struct Solved {
    here: Fit,
    near: Fit,
}

impl Solved {
    /// What the fit promises to gain on the solve.
    fn promise(&self) -> f64 {
        self.here.discounted - self.near.discounted
    }
}

impl Search<'_> {
    /// The fit once more with finite elements of the whole paths at its point; none where they fail, or where the chain needs none.
    #[must_use]
    pub fn solved(&self, fit: &Fit) -> Option<Fit> {
        if !lut_gen::chain::is_rough(&fit.model) {
            return None;
        }
        if !is_far_off(fit) {
            return self.solve_at(&fit.candidates, &fit.x, Detail::Names).map(|solved| solved.near);
        }
        let Some(term) = fit.candidates.last().filter(|c| is_term(c)) else {
            return self.rounds(&fit.candidates, &fit.x, (SOLVES, SAME));
        };
        // two terms have several valleys, and the chain's own may be none: each is looked into, and the deepest followed
        let others = term.effect.quantities[1].starts.iter().map(|alpha| {
            let list = coordinates(self.problem.design, &fit.candidates);
            let (base, known) = (self.base.x.len(), list.len() - 2);
            let values = [RATIO, *alpha];
            let place = |i: usize| match i {
                i if i < base => self.base.x[i],
                i if i < known => fit.x[i],
                i => list[i].of(values[i - known]),
            };
            let mut x = DVector::from_fn(list.len(), |i, _| place(i));
            suit(&self.problem, (&list, &fit.candidates), &measured(&self.problem), &mut x);
            x
        });
        let starts: Vec<DVector<f64>> = others.chain([fit.x.clone()]).collect();
        let mut valleys: Vec<Solved> =
            starts.iter().filter_map(|x| self.solve_at(&fit.candidates, x, Detail::Valleys)).collect();
        valleys.sort_by(|a, b| a.near.discounted.total_cmp(&b.near.discounted));
        let deepest = valleys.first()?.near.discounted;
        // without a history a solve is one ramp
        let (most, rounds) = if fit.candidates.len() == 1 { (valleys.len(), SETTLES) } else { (FOLLOWED, SOLVES - 1) };
        let worth = valleys.iter().take(most).filter(|v| v.near.discounted < deepest + NEAR);
        let followed = worth.filter_map(|v| self.rounds(&fit.candidates, &v.near.x, (rounds, SAME)));
        followed.min_by(|a, b| a.discounted.total_cmp(&b.discounted))
    }

    /// A fit with one more candidate, and what was found out about it, solved where the chain has it roughly only and it may be better than the best score so far.
    #[must_use]
    pub fn with(&self, before: &Before, candidate: &Candidate, best: f64) -> Explanation {
        let seen = self.compared(self.extended(&before.fit, candidate), before);
        let worth = seen.score() < best + NEAR || may_be_best(&seen, &before.fit, best) || seen.adequacy.passes();
        match worth.then(|| self.solved(&seen.fit)).flatten() {
            Some(fit) => self.compared(fit, before),
            None => seen,
        }
    }

    /// Puts in the place of an explanation's fit one with solves at its own place until it stays there: what one that is merely near its best leaves,
    /// others would explain. Nothing changes where finite elements fail or are not needed.
    pub fn settle(&self, explanation: &mut Explanation) {
        let fit = &explanation.fit;
        if lut_gen::chain::is_rough(&fit.model)
            && let Some(settled) = self.rounds(&fit.candidates, &fit.x, (SETTLES, SAME))
        {
            explanation.fit = settled;
        }
    }

    /// The same of an explanation that is to be named, until its parameters stay: what they are is told with errors that know nothing of a solve elsewhere.
    pub(super) fn polish(&self, explanation: &mut Explanation) {
        let fit = &explanation.fit;
        if lut_gen::chain::is_rough(&fit.model)
            && let Some(ended) = self.rounds(&fit.candidates, &fit.x, (SETTLES, ENDS))
            && ended.discounted < fit.discounted + SAME
        {
            explanation.fit = ended;
        }
    }

    /// Solves at a point, and fits near it.
    fn solve_at(&self, candidates: &[Candidate], x: &DVector<f64>, detail: Detail) -> Option<Solved> {
        let problem = &self.problem;
        let groups: Vec<usize> = problem.design.series.iter().map(|s| s.group).collect();
        let windows = problem.design.windows();
        let model = problem.model(&coordinates(problem.design, candidates), candidates, x);
        let whole = problem.chain.whole(&model, &problem.contacts_mm, &windows, &groups, detail).ok()?;
        let own = Problem { whole: Some(whole), ..problem.clone() };
        let near = own.fit(candidates, x);
        let allowed = allowed(problem, &near);
        Some(Solved { near: problem.refit(&near, &allowed), here: own.at(candidates, x, &allowed) })
    }

    /// Solves at a point and fits near it, some times over, and comes back with what is near the best point that was solved: what a fit
    /// far from its solve promises need not be kept.
    fn rounds(&self, candidates: &[Candidate], x: &DVector<f64>, (most, same): (usize, f64)) -> Option<Fit> {
        let mut x = x.clone();
        let mut best: Option<Solved> = None;
        for _ in 0..most {
            let solved = self.solve_at(candidates, &x, Detail::Names)?;
            if let Some(best) = best.as_ref().filter(|best| solved.here.discounted >= best.here.discounted) {
                // too far: half of the way
                x = 0.5 * (&best.here.x + &x);
                continue;
            }
            x = solved.near.x.clone();
            let settled = solved.promise() < same;
            best = Some(solved);
            if settled {
                break;
            }
        }
        best.map(|solved| if solved.promise() < KEPT { solved.near } else { solved.here })
    }

    /// Finite elements of the whole paths for the best of a list, each of which is compared with what it extends: the chain is not let
    /// alone with a name.
    pub(super) fn solve_best(&self, list: &mut [Explanation], before: &[&Before]) {
        let Some(best) = list.iter().map(Explanation::score).min_by(f64::total_cmp) else { return };
        // of forms of one effect the chain may prefer the wrong one by as much as it is itself wrong by
        let codes = |e: &Explanation| e.fit.candidates.iter().map(|c| (c.effect.code, c.owner)).collect::<Vec<_>>();
        let names = |e: &Explanation| e.fit.candidates.iter().map(|c| c.effect.code).collect::<Vec<_>>();
        let near: Vec<&Explanation> = list.iter().filter(|e| e.beats_noise && e.score() < best + NEAR).collect();
        let mut worth: Vec<Vec<&str>> = Vec::new();
        for name in near.iter().map(|e| names(e)) {
            if !worth.contains(&name) && worth.len() < SOLVED {
                worth.push(name);
            }
        }
        let solved: Vec<_> = near.iter().filter(|e| worth.contains(&names(e))).map(|e| codes(e)).collect();
        let own: Vec<bool> = list
            .iter()
            .zip(before)
            .map(|(e, before)| solved.contains(&codes(e)) || may_be_best(e, &before.fit, best))
            .collect();
        for ((explanation, before), _) in list.iter_mut().zip(before).zip(own).filter(|(_, own)| *own) {
            if let Some(fit) = self.solved(&explanation.fit) {
                *explanation = self.compared(fit, before);
            }
        }
    }
}

/// True where an effect that the chain has only roughly seems behind the best score, but explains so much of what is left without it that it may be the best.
fn may_be_best(explanation: &Explanation, before: &Fit, best: f64) -> bool {
    let rough = is_far_off(&explanation.fit);
    // the chain may see nothing in a second term at all
    let term = matches!(&explanation.fit.candidates[..], [only] if is_term(only));
    rough && (term || explanation.beats_noise && explanation.score() < best + FAR * (score(before) - best))
}

/// True where one solve leads to a point where the next one is needed: with an effect that the chain has only roughly, or an exponent far from that of the solve near by.
fn is_far_off(fit: &Fit) -> bool {
    let moved = fit.model.whole.as_ref().is_some_and(|whole| whole.is_far_from(&fit.model));
    moved || fit.candidates.iter().any(|c| is_far(c, fit))
}

/// True for effects whose chain is so rough that one solve leads to a point where the next one is needed, unless there was one near by.
fn is_far(candidate: &Candidate, fit: &Fit) -> bool {
    let code = candidate.effect.code;
    let near = fit.model.whole.as_ref().is_some_and(|whole| whole.covers(code));
    [second_term::EFFECT.code, softening::EFFECT.code, friction::EFFECT.code].contains(&code) && !near
}

fn is_term(candidate: &Candidate) -> bool {
    candidate.effect.code == second_term::EFFECT.code
}
