//! Which explanations hold, alone or with rivals that these data do not exclude.

use nalgebra::DVector;
use rayon::prelude::*;

use super::super::coordinate::{Candidate, Coordinate};
use super::super::fit::{Fit, Problem};
use super::super::progress::Progress;
use super::before::Before;
use super::nameless::is_nameless;
use super::rounds::{SAME, SETTLES};
use super::{Aim, Explanation, RATIO_100, Search, allowed, form_error, score, sorted};
use crate::infer::presence::CHARGE;

/// By how much two effects must be better than one, as a difference of sums of squares: a likelihood ratio of a thousand. There are twenty times as many pairs as effects. In
/// three tables none of 540 experiments with one effect that was named had a second one between this and ten thousand that met all else; five with two had a true one there.
const SECOND: f64 = 1.5 * RATIO_100;

/// Thresholds that one effect may leave for two to have to be likelier than it.
const HARDLY: f64 = 1.25;

/// Thresholds that every pair may leave and one of them still come to hold, once settled and with the noise told about it: of forty that came to be named none left more than 0.8. More than two effects
/// are then at work, or what no pair of the catalogue does, and neither is found by looking closer.
const HOPELESS: f64 = 1.5;

/// What the likeliest pair may leave in all, as a part of what noise does, and how many standard deviations of that more: of a hundred that came to be named none left more than 1.09 in D18 to D60, and 1.25, three
/// standard deviations, in D6.
const HOPELESS_IN_ALL: (f64, f64) = (1.15, 3.0);

/// How far what holds may be behind what is likelier and does not, as a difference of sums of squares: what is solved at another place is not the same to the last few.
pub(super) const NEARLY: f64 = 6.0 * RATIO_100;

/// How far behind the best what is fitted beside finite elements of another exponent may be and still come near it with its own.
const FAR_BEHIND: f64 = 2.0 * NEARLY;

/// What a search came to.
#[derive(Debug)]
pub struct Found<'a> {
    /// Data and noise as what was found sees them.
    pub search: Search<'a>,
    /// Every candidate alone, the best first.
    pub singles: Vec<Explanation>,
    /// What was tried with two effects, the best first.
    pub pairs: Vec<Explanation>,
    /// Explanations that hold and that none is a hundred times likelier than, with as few effects as will do, the best first.
    pub held: Vec<Explanation>,
    /// By how much the best of these is likelier than it must be against an elastic departure without a name ([`Search::beyond_nameless`]).
    pub beyond_nameless: Option<f64>,
}

impl<'a> Found<'a> {
    /// Where nothing was looked for.
    #[must_use]
    pub fn nothing(search: Search<'a>) -> Self {
        Self { search, singles: Vec::new(), pairs: Vec::new(), held: Vec::new(), beyond_nameless: None }
    }

    /// Searches for one effect and then for two. After each the noise is told about the likeliest explanation: jitter that is told about a base which is wrong
    /// by a tenth of the force passes for many times what it is, and hides whatever else is there.
    #[must_use]
    pub fn of(search: Search<'a>, stated_n: Option<f64>, progress: &Progress<'_>) -> Self {
        progress("effects", 0, 2);
        let singles = search.singles();
        let mut found = Self { singles, ..Self::nothing(search) };
        found.settle_singles(stated_n);
        found.held = found.alike(&found.singles);
        // where an explanation that may itself be wrong holds nothing is added to it: a second name for what it leaves would be a wrong one
        if found.held.first().is_none_or(Explanation::is_exact) {
            progress("effects together", 1, 2);
            found.look_for_pairs(stated_n);
            if found.nest_singles() {
                found.settle_singles(stated_n);
            }
            let together = found.alike(&found.pairs);
            let needed = together.first().is_some_and(|two| found.needs(two));
            found.held = if needed { together } else { found.alike(&found.singles) };
        }
        let mut found = found.against_nameless();
        if let Some(best) = found.held.first_mut().filter(|_| !is_nameless(found.beyond_nameless)) {
            found.search.polish(best);
        }
        found.held.iter_mut().for_each(|e| e.fit.reach_in(&found.search.twins));
        found
    }

    /// Brings the likeliest single effects to where their solves are, and tells the noise about the likeliest.
    fn settle_singles(&mut self, stated_n: Option<f64>) {
        // one with a parameter at its bound is not named: the next must be as near to its own best, and so must the other forms of the likeliest effect
        let sound = self.singles.iter().position(|e| e.beats_noise && !e.fit.at_bound);
        let mut best: Vec<usize> = likeliest(&self.singles).into_iter().chain(sound).collect();
        let forms = best.first().map(|at| self.forms(&self.singles[*at])).unwrap_or_default();
        best.extend(forms);
        best.sort_unstable();
        best.dedup();
        for at in best {
            self.search.settle(&mut self.singles[at]);
        }
        if let Some(best) = likeliest(&self.singles) {
            let fit = self.singles[best].fit.clone();
            self.tell_about(&fit, stated_n);
        }
    }

    /// Extends single effects by a second one.
    fn look_for_pairs(&mut self, stated_n: Option<f64>) {
        let mut base: Vec<Explanation> = self.singles.iter().filter(|e| e.beats_noise).cloned().collect();
        if base.is_empty() {
            // two that hide each other may each be no more than noise alone
            base = self.singles.clone();
        }
        if let Some(best) = self.held.first() {
            // a second effect may be what the richer form of the first was taken for
            base.retain(|e| key(e) == key(best));
        }
        // where no effect holds alone, two are named or nothing is
        let aim = if self.held.is_empty() { Aim::Name } else { Aim::Explain };
        let (pairs, solved) = self.search.one_more(&base, aim);
        self.pairs = pairs;
        if !solved {
            return;
        }
        let Some(best) = self.best_pair().filter(|best| self.needs(&self.pairs[*best])) else { return };
        self.search.settle(&mut self.pairs[best]);
        let fit = self.pairs[best].fit.clone();
        self.tell_about(&fit, stated_n);
        // of what holds, or may come to hold; a twin that is likelier then has twins of its own
        for _ in 0..2 {
            let held = self.alike(&self.pairs);
            if held.first().is_some_and(|best| self.search.is_rather_spectral(best)) {
                break;
            }
            self.try_twins(held.first().map_or(&fit, |best| &best.fit));
        }
        self.solve_rivals();
    }

    /// Solves pairs that would be excluded by finite elements of another exponent than their own: those of the first effect alone know nothing of what the second one does to it. A sensor that is
    /// not linear beside a softening of 71 standard deviations was 89 behind a Poisson's ratio so (24 standard deviations, D36), and beside a relaxation of 104 it was 57 behind friction.
    fn solve_rivals(&mut self) {
        let held = self.alike(&self.pairs);
        let Some(best) = held.first() else { return };
        let mut least = best.score();
        let is_rival = |e: &Explanation| {
            e.beats_noise
                && e.adequacy.worst() < HARDLY
                && e.score() < least + FAR_BEHIND
                && self.search.is_beside_its_solve(&e.fit)
        };
        let rivals: Vec<usize> = (0..self.pairs.len()).filter(|at| is_rival(&self.pairs[*at])).collect();
        for at in rivals {
            let fit = &self.pairs[at].fit;
            let [first, _] = fit.candidates[..] else { continue };
            let rounds = (SETTLES, SAME);
            let Some(solved) = self.search.rounds_at(&fit.candidates, &fit.x, rounds, least) else { continue };
            let Some(before) = self.before(first) else { continue };
            self.pairs[at] = self.search.compared(solved, &before);
            if self.pairs[at].holds() {
                least = least.min(self.pairs[at].score());
            }
        }
        self.pairs = sorted(std::mem::take(&mut self.pairs));
    }

    /// The same with what a departure without a name does in the place of the best that holds. Where an elastic law is not excluded beside that, no other one is either.
    fn against_nameless(mut self) -> Self {
        let law = self.held.iter().skip(1).find(|rival| self.search.claims_a_law(rival));
        let of = |e: &Explanation| self.search.beyond_nameless(e, &self.held, (&self.singles, &self.pairs));
        self.beyond_nameless = self.held.first().and_then(of).or_else(|| law.and_then(of));
        self
    }

    /// The place of the likeliest pair, if any pair may come to hold.
    fn best_pair(&self) -> Option<usize> {
        let may_hold = self.pairs.iter().any(|e| e.beats_noise && e.adequacy.worst() < HOPELESS);
        let hopeless = |fit: &Fit| {
            let freedom = self.search.freedom(fit);
            let (least, deviations) = HOPELESS_IN_ALL;
            fit.discounted.min(fit.square) > freedom * (least + deviations * (2.0 / freedom).sqrt())
        };
        likeliest(&self.pairs).filter(|at| may_hold && !hopeless(&self.pairs[*at].fit))
    }

    /// One effect explains at least as much as it does beside one that is next to nothing: singles once more from where the best pair has them. True where one is better there, and nearly as good
    /// as the pair, which a fit that began from a base far off had missed.
    fn nest_singles(&mut self) -> bool {
        let Some(best) = self.best_pair() else { return false };
        let (pair, score) = (self.pairs[best].fit.clone(), self.pairs[best].score());
        let base = Before::new(&self.search.problem, self.search.base.clone());
        let known = self.search.base.x.len();
        let mut better = false;
        for (at, candidate) in pair.candidates.iter().enumerate() {
            let own = |i: &usize| matches!(pair.coordinates[*i], Coordinate::Of(of, _) if of == at);
            let kept: Vec<usize> = (0..pair.x.len()).filter(|i| *i < known || own(i)).collect();
            let start = DVector::from_fn(kept.len(), |k, _| pair.x[kept[k]]);
            let Some(single) = self.singles.iter_mut().find(|e| e.fit.candidates == [*candidate]) else { continue };
            let whole = single.fit.model.whole.clone();
            let problem = Problem { whole, ..self.search.problem.clone() };
            let fit = problem.fit(&[*candidate], &start);
            if fit.square + RATIO_100 < single.fit.square {
                let fit = self.search.problem.refit(&fit, &allowed(&self.search.problem, &fit));
                let found = self.search.compared(fit, &base);
                if found.score() + RATIO_100 < single.score() {
                    // what is still far behind the pair is no question
                    better |= found.score() < score + NEARLY;
                    *single = found;
                }
            }
        }
        self.singles = sorted(std::mem::take(&mut self.singles));
        better
    }

    /// True where two effects are clearly likelier than any one that leaves no more than noise, or hardly more, be that one not to be named because of that or because it ends at a
    /// bound.
    fn needs(&self, two: &Explanation) -> bool {
        let alone = self.singles.iter().filter(|e| e.adequacy.worst() < HARDLY);
        let least = alone.map(|e| e.score() - form_error::coherent(&e.fit) * e.gain).fold(f64::INFINITY, f64::min);
        two.score() + SECOND < least
    }

    /// The best explanation that meets every demand, and all that leave no more than noise and are no hundred times less likely: a
    /// rival that predicts worse, loses to a placebo or ends at a bound is not named alone, but it is not excluded either.
    fn alike(&self, list: &[Explanation]) -> Vec<Explanation> {
        let best = list.iter().filter(|e| e.holds()).min_by(|a, b| a.score().total_cmp(&b.score()));
        // one that leaves what is no noise and is still far likelier says that more is at work than either
        let sound = list.iter().filter(|e| e.beats_noise && !e.fit.at_bound);
        let likeliest = sound.map(Explanation::score).fold(f64::INFINITY, f64::min);
        let Some(best) = best.filter(|best| best.score() < likeliest + NEARLY) else { return Vec::new() };
        let same = |e: &Explanation| e.fit.candidates == best.fit.candidates;
        let rival = |e: &&Explanation| !same(e) && e.adequacy.passes() && !self.is_excluded(e, best);
        let mut rivals: Vec<Explanation> = list.iter().filter(rival).cloned().collect();
        rivals.sort_by(|a, b| a.score().total_cmp(&b.score()));
        rivals.insert(0, best.clone());
        rivals
    }

    /// True where a rival is a hundred times less likely than the best, whatever it is charged for: parameters, and freedom that it does not need, are reasons not to
    /// name it, none to exclude it. Of stated twins the gap must also exceed what the forms of both may be wrong by.
    fn is_excluded(&self, rival: &Explanation, best: &Explanation) -> bool {
        let more = rival.fit.coordinates.len().saturating_sub(best.fit.coordinates.len()) as f64;
        let charged = rival.score() - best.score() - CHARGE * more;
        let free = (rival.fit.discounted - rival.fit.price) - (best.fit.discounted - best.fit.price);
        charged.min(free) > RATIO_100 + self.doubt(rival, best)
    }

    /// What the forms of twins may be wrong by, as a part of what telling them apart rests on: the square of a signature is wrong by twice what it is wrong by. What coupons tell
    /// rests on no form.
    fn doubt(&self, rival: &Explanation, best: &Explanation) -> f64 {
        let only = |of: &Fit, other: &Fit| -> Vec<Candidate> {
            of.candidates.iter().filter(|c| !other.candidates.contains(c)).copied().collect()
        };
        match (&only(&rival.fit, &best.fit)[..], &only(&best.fit, &rival.fit)[..]) {
            ([a], [b]) if are_twins(a, b) => {
                // what they share is not what they are told apart by
                let shared: Vec<Candidate> = best.fit.candidates.iter().filter(|c| *c != b).copied().collect();
                let without = self.singles.iter().find(|e| e.fit.candidates == shared);
                let gain = without.map_or(best.gain, |e| e.fit.discounted - best.fit.discounted);
                let told = gain * self.outside_coupons(without.map_or(&self.search.base, |e| &e.fit), &best.fit);
                2.0 * told * (form_error::mean_share(a, &rival.fit) + form_error::mean_share(b, &best.fit))
            }
            _ => 0.0,
        }
    }

    /// Part of what one fit explains beyond another that does not lie in the rows of coupons.
    fn outside_coupons(&self, before: &Fit, after: &Fit) -> f64 {
        let problem = &self.search.problem;
        let coupons = problem.design.checks.iter().enumerate().filter(|(_, check)| check.coupon().is_some());
        let fall = |rows: std::ops::Range<usize>| -> f64 {
            rows.map(|row| before.residual[row].powi(2) - after.residual[row].powi(2)).sum()
        };
        let within: f64 = coupons.map(|(at, _)| fall(problem.rows_of_check(at))).sum();
        let all = before.square - after.square;
        if all > 0.0 { (1.0 - within / all).clamp(0.0, 1.0) } else { 1.0 }
    }

    /// Places of the other forms of a single effect that are clearly not noise.
    fn forms(&self, of: &Explanation) -> Vec<usize> {
        let same = |e: &Explanation| e.beats_noise && key(e) == key(of) && e.fit.candidates != of.fit.candidates;
        self.singles.iter().enumerate().filter(|(_, e)| same(e)).map(|(at, _)| at).collect()
    }

    /// Noise and all fits once more, about an explanation.
    fn tell_about(&mut self, best: &Fit, stated_n: Option<f64>) {
        if let Some(search) = self.search.about(best, stated_n) {
            self.singles = search.again(&self.singles, None);
            self.pairs = search.again(&self.pairs, Some(&self.singles));
            self.search = search;
        }
    }

    /// What pairs that begin with an effect extend.
    fn before(&self, first: Candidate) -> Option<Before> {
        let single = self.singles.iter().find(|e| e.fit.candidates == [first])?;
        Some(Before::new(&self.search.problem, single.fit.clone()))
    }

    /// Tries pairs that have a stated twin in the place of the second effect: what was not tried is not excluded.
    fn try_twins(&mut self, best: &Fit) {
        let [first, second] = best.candidates[..] else { return };
        let Some(before) = self.before(first) else { return };
        let tried = |c: &Candidate| {
            self.pairs.iter().any(|e| e.fit.candidates.contains(c) && e.fit.candidates.contains(&first))
        };
        let missing = self
            .search
            .candidates
            .par_iter()
            .filter(|c| are_twins(c, &second) && c.effect.code != first.effect.code && !tried(c));
        let score = score(best);
        let more: Vec<Explanation> = missing.map(|c| self.search.with(&before, c, score)).collect();
        self.pairs.extend(more);
        self.pairs = sorted(std::mem::take(&mut self.pairs));
    }
}

/// What a single effect is, whatever its form.
fn key(e: &Explanation) -> Option<(&'static str, usize)> {
    e.fit.candidates.first().map(|c| (c.effect.code, c.owner))
}

/// The place of the likeliest that is clearly not noise.
fn likeliest(list: &[Explanation]) -> Option<usize> {
    let clear = list.iter().enumerate().filter(|(_, e)| e.beats_noise);
    clear.min_by(|a, b| a.1.score().total_cmp(&b.1.score())).map(|(at, _)| at)
}

/// True where one effect is stated to look like the other.
fn are_twins(a: &Candidate, b: &Candidate) -> bool {
    a.effect.code != b.effect.code
        && (a.effect.twins.contains(&b.effect.code) || b.effect.twins.contains(&a.effect.code))
}
