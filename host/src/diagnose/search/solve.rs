//! Finite elements of whole paths for the explanations that may be named.

use lut_gen::chain::{Detail, ROUGH, Whole};
use lut_gen::effect::{friction, second_term, softening};
use nalgebra::DVector;
use rayon::prelude::*;

use super::super::coordinate::{Candidate, coordinates};
use super::super::fit::Fit;
use super::before::Before;
use super::begin::{measured, suit};
use super::held::NEARLY;
use super::rounds::{BEHIND, SAME, SETTLES, Solved};
use super::{Explanation, Search, names, score};

/// Names, of one effect or of two, that are solved with finite elements, and how far (sum of squares) behind the best they may lie: what the chain allows
/// for costs an effect that it has nearly right less than that. Which ball it is, or in which form, does not count: two balls in two forms had left no place for what it was.
const SOLVED: usize = 3;
const NEAR: f64 = 60.0;
/// Effects that the chain has only roughly are also solved where they explain this part less than the best does: a second term as a second
/// force is wrong by 16 % of what it adds, a memory of the whole contact by as much.
const FAR: f64 = 0.5;
/// Part of the first term that a second one begins with where it is solved from the start.
const RATIO: f64 = 0.3;
/// Solves of one fit, each at the point where the last one led.
const SOLVES: usize = 3;
/// The change of the sum of squares that ends them of what is named in the end: its parameters lie within a fifth of their errors of where the next solve would lead.
const ENDS: f64 = 0.04;
/// One solve is believed, where one near by was known, unless a fit near it promises more than this: what finite elements add there is not what they add here, and no more is it where the fit leads
/// to. An offset of the contact beside softening, whose exponent of 11.3 was 13.6 without it, lay 160 off its own solve and was lost with the 16 standard deviations that it explains (D36).
const BELIEVED: f64 = 30.0;

/// Ratio of two exponents from which on what finite elements of one miss is not what those of the other do.
const MOVED: f64 = 1.1;

/// Valleys of a second term beside another effect that are followed to their ground.
const FOLLOWED: usize = 2;
/// Modulus and exponent (their logarithms), ratio and second exponent of two laws lie this near each other in one valley: different valleys were found two to twenty times as far apart, the same ones half as far at most.
const ONE_VALLEY: f64 = 0.1;

/// What explanations are wanted for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Aim {
    /// To know how well each does.
    Explain,
    /// To name one: where none could be, whatever it comes to, there is no need to know.
    Name,
}

/// What the first solves of a fit led to.
struct Looked {
    solves: Vec<Solved>,
    /// One solve is not enough.
    far_off: bool,
    /// They are on a coarse mesh, to be compared with each other.
    coarse: bool,
}

impl Looked {
    /// The least score that they promise.
    fn promised(&self) -> f64 {
        self.solves.iter().map(|solved| score(&solved.near)).fold(f64::INFINITY, f64::min)
    }

    /// The least score that is sure: one solve is believed where one is enough, and where the next is needed what was left at the solve itself.
    fn sure(&self) -> f64 {
        if self.coarse {
            return f64::INFINITY;
        }
        let each = self.solves.iter().map(|s| if self.far_off { score(&s.here) } else { score(&s.near) });
        each.fold(f64::INFINITY, f64::min)
    }
}

impl Search<'_> {
    /// The fit once more with finite elements of the whole paths at its point; none where they fail, or where the chain needs none.
    #[must_use]
    pub fn solved(&self, fit: &Fit) -> Option<Fit> {
        self.solved_against(fit, f64::INFINITY)
    }

    /// The same, not to the end where that would not come near a score.
    fn solved_against(&self, fit: &Fit, best: f64) -> Option<Fit> {
        self.look(fit).and_then(|looked| self.follow(&fit.candidates, looked, best))
    }

    /// True where the chain has a fit only roughly, and no finite elements of its rough effects were
    /// solved near by.
    pub(in crate::diagnose) fn needs_solve(&self, fit: &Fit) -> bool {
        let near = |whole: &Whole| {
            let is_near = whole.detail() == Detail::Names && whole.moved(&fit.model) < MOVED;
            is_near && fit.codes().all(|code| !ROUGH.contains(&code) || whole.covers(code))
        };
        lut_gen::chain::is_rough(&fit.model) && !fit.model.whole.as_deref().is_some_and(near)
    }

    /// True where a fit has finite elements of other effects than its own, and of another exponent.
    pub(super) fn is_beside_its_solve(&self, fit: &Fit) -> bool {
        let whole = fit.model.whole.as_ref();
        whole.is_some_and(|whole| self.place_of(fit, whole).is_none() && whole.moved(&fit.model) > MOVED)
    }

    /// The first solves of a fit: one, or of a second term one in each of its valleys.
    fn look(&self, fit: &Fit) -> Option<Looked> {
        if !lut_gen::chain::is_rough(&fit.model) {
            return None;
        }
        let far_off = is_far_off(fit);
        let Some(term) = fit.candidates.last().filter(|c| far_off && is_term(c)) else {
            // on the mesh that friction is named with a solve takes three times as long
            let coarse = far_off && fit.candidates.iter().any(rubs);
            let detail = if coarse { Detail::Valleys } else { Detail::Names };
            let solved = self.solve_at(&fit.candidates, &fit.x, detail)?;
            let far_off = far_off || solved.promise() > BELIEVED;
            return Some(Looked { solves: vec![solved], far_off, coarse });
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
        let starts: Vec<DVector<f64>> = others.chain([larger_first(fit)]).collect();
        let valleys = starts.par_iter().filter_map(|x| self.solve_at(&fit.candidates, x, Detail::Valleys));
        let mut solves: Vec<Solved> = valleys.collect();
        solves.sort_by(|a, b| a.near.discounted.total_cmp(&b.near.discounted));
        Some(Looked { solves, far_off, coarse: true })
    }

    /// One solve at a fit, that tells what is left there.
    fn glance(&self, fit: &Fit) -> Option<Looked> {
        let solved = self.solve_at(&fit.candidates, &larger_first(fit), Detail::Valleys)?;
        Some(Looked { solves: vec![solved], far_off: true, coarse: true })
    }

    /// Where the first solves of a fit lead to, not followed to the end where they would not come near the best score.
    fn follow(&self, candidates: &[Candidate], looked: Looked, best: f64) -> Option<Fit> {
        let deepest = looked.solves.first()?.near.discounted;
        let ends = !looked.solves.iter().any(|solved| solved.may_reach(best));
        let Looked { mut solves, far_off, coarse } = looked;
        if !far_off || ends {
            let Solved { here, near } = solves.swap_remove(0);
            return Some(if far_off { here } else { near });
        }
        if !coarse {
            return self.rounds(candidates, solves.swap_remove(0), (SETTLES - 1, SAME), best);
        }
        // without a history a solve is one ramp
        let (most, rounds) = if candidates.len() == 1 { (solves.len(), SETTLES) } else { (FOLLOWED, SOLVES - 1) };
        let mut worth: Vec<Solved> = Vec::new();
        for valley in solves.into_iter().filter(|v| v.near.discounted < deepest + NEAR) {
            if worth.len() < most && !worth.iter().any(|other| is_one_valley(&other.near, &valley.near)) {
                worth.push(valley);
            }
        }
        let followed = worth.into_par_iter().filter_map(|valley| self.ground(candidates, valley, rounds, best));
        let followed: Vec<Fit> = followed.collect();
        followed.into_iter().min_by(|a, b| a.discounted.total_cmp(&b.discounted))
    }

    /// The ground of a valley: told on the coarse mesh while that lies clearly behind the best score, and on the fine one where it comes near.
    fn ground(&self, candidates: &[Candidate], mut valley: Solved, rounds: usize, best: f64) -> Option<Fit> {
        for _ in 0..SOLVES {
            if score(&valley.near) < best + NEAR {
                return self.rounds_at(candidates, &larger_first(&valley.near), (rounds, SAME), best);
            }
            if !valley.may_reach(best) {
                break;
            }
            let next = self.solve_at(candidates, &larger_first(&valley.near), Detail::Valleys)?;
            if next.here.discounted >= valley.here.discounted {
                break;
            }
            valley = next;
        }
        Some(valley.here)
    }

    /// A fit with one more candidate, and what was found out about it, solved where the chain has it roughly only and it may be better than the best score so far.
    #[must_use]
    pub fn with(&self, before: &Before, candidate: &Candidate, best: f64) -> Explanation {
        let seen = self.compared(self.extended(&before.fit, candidate), before);
        let worth = seen.score() < best + NEAR || may_be_best(&seen, &before.fit, best) || seen.adequacy.passes();
        match worth.then(|| self.solved_against(&seen.fit, best)).flatten() {
            Some(fit) => self.compared(fit, before),
            None => seen,
        }
    }

    /// Puts in the place of an explanation's fit one with solves at its own place until it stays there: what one that is merely near its best leaves,
    /// others would explain. Nothing changes where finite elements fail or are not needed.
    pub fn settle(&self, explanation: &mut Explanation) {
        let fit = &explanation.fit;
        if lut_gen::chain::is_rough(&fit.model)
            && !fit.settled
            && let Some(settled) = self.rounds_of(fit, (SETTLES, SAME))
        {
            explanation.fit = settled;
        }
    }

    /// A fit with solves at its own place until it stays there.
    pub(in crate::diagnose) fn ended(&self, fit: &Fit, rounds: usize) -> Option<Fit> {
        self.rounds_of(fit, (rounds, SAME))
    }

    /// The same of an explanation that is to be named, until its parameters stay: what they are is told with errors that know nothing of a solve elsewhere.
    pub(super) fn polish(&self, explanation: &mut Explanation) {
        let fit = &explanation.fit;
        if lut_gen::chain::is_rough(&fit.model)
            && let Some(ended) = self.rounds_of(fit, (SETTLES, ENDS))
            && ended.discounted < fit.discounted + SAME
        {
            explanation.fit = ended;
        }
    }

    /// Finite elements of the whole paths for the best of a list, each of which is compared with what it extends: the chain is not let
    /// alone with a name. False where that was given up, since none could be named whatever it leads to.
    pub(super) fn solve_best(&self, list: &mut [Explanation], before: &[&Before], aim: Aim) -> bool {
        let Some(best) = list.iter().map(Explanation::score).min_by(f64::total_cmp) else { return true };
        // of forms of one effect the chain may prefer the wrong one by as much as it is itself wrong by
        let codes = |e: &Explanation| names(&e.fit);
        let words = |e: &Explanation| e.fit.codes().collect::<Vec<_>>();
        let near: Vec<&Explanation> = list.iter().filter(|e| e.beats_noise && e.score() < best + NEAR).collect();
        let mut worth: Vec<Vec<&str>> = Vec::new();
        for name in near.iter().map(|e| words(e)) {
            if !worth.contains(&name) && worth.len() < SOLVED {
                worth.push(name);
            }
        }
        let solved: Vec<_> = near.iter().filter(|e| worth.contains(&words(e))).map(|e| codes(e)).collect();
        let own: Vec<bool> = list
            .iter()
            .zip(before)
            .map(|(e, before)| solved.contains(&codes(e)) || may_be_best(e, &before.fit, best))
            .collect();
        // into valleys of a second term beside another effect only one of its forms looks first: where what it promises does not come true, the others' is not believed either
        let term = |e: &Explanation| e.fit.candidates.len() > 1 && e.fit.candidates.last().is_some_and(is_term);
        let own: Vec<usize> = (0..list.len()).filter(|at| own[*at]).collect();
        let again = |at: usize| {
            let mut before = own.iter().take_while(|other| **other < at);
            term(&list[at]) && before.any(|other| codes(&list[*other]) == codes(&list[at]))
        };
        let (later, first): (Vec<usize>, Vec<usize>) = own.iter().partition(|at| again(**at));
        let mut known = Known { sure: f64::INFINITY, vain: Vec::new() };
        let looked = self.looked(list, &first, &known);
        if aim == Aim::Name && self.all_are_nameless(list, &looked) {
            for (at, Looked { mut solves, .. }) in looked {
                list[at] = self.compared(solves.swap_remove(0).near, before[at]);
            }
            return false;
        }
        self.follow_all(list, before, looked, &mut known);
        let looked = self.looked(list, &later, &known);
        self.follow_all(list, before, looked, &mut known);
        true
    }

    /// The first solves of some of a list, with what is known from others.
    fn looked(&self, list: &[Explanation], some: &[usize], known: &Known) -> Vec<(usize, Looked)> {
        let look = |at: &usize| {
            let fit = &list[*at].fit;
            let looked = if known.is_in_vain(fit) { self.glance(fit) } else { self.look(fit) };
            looked.filter(|looked| !looked.solves.is_empty()).map(|looked| (*at, looked))
        };
        some.par_iter().filter_map(look).collect()
    }

    /// True where all that may come to hold are effects together that are not told from an elastic departure without a name if all that their first solves promise comes true.
    fn all_are_nameless(&self, list: &[Explanation], looked: &[(usize, Looked)]) -> bool {
        let promised = |at: usize| -> Vec<&Fit> {
            match looked.iter().find(|(other, _)| *other == at) {
                Some((_, looked)) => looked.solves.iter().map(|solved| &solved.near).collect(),
                None => vec![&list[at].fit],
            }
        };
        let clear: Vec<Vec<&Fit>> = (0..list.len()).filter(|at| list[*at].beats_noise).map(promised).collect();
        let best = clear.iter().flatten().map(|fit| score(fit)).fold(f64::INFINITY, f64::min);
        let mut near = clear.iter().flatten().filter(|fit| score(fit) < best + NEARLY);
        near.all(|fit| self.is_lost_in_nameless(fit))
    }

    /// Where the first solves of some of a list lead to.
    fn follow_all(
        &self,
        list: &mut [Explanation],
        before: &[&Before],
        mut looked: Vec<(usize, Looked)>,
        known: &mut Known,
    ) {
        let surely = looked.iter().map(|(_, looked)| looked.sure());
        // one that is not solved, and should be, may be wrong
        let exact = list.iter().filter(|e| !lut_gen::chain::is_rough(&e.fit.model)).map(Explanation::score);
        known.sure = surely.chain(exact).fold(known.sure, f64::min);
        // the most promising first: what it comes to spares the others the way to their ends
        looked.sort_by(|a, b| a.1.promised().total_cmp(&b.1.promised()));
        for (at, looked) in looked {
            let explanation = &mut list[at];
            let promised = looked.promised();
            let against = if known.is_in_vain(&explanation.fit) { f64::NEG_INFINITY } else { known.sure };
            if let Some(fit) = self.follow(&explanation.fit.candidates, looked, against) {
                if fit.vain.is_some() && score(&fit) > promised + BEHIND {
                    known.vain.push(names(&fit));
                }
                *explanation = self.compared(fit, before[at]);
                known.sure = known.sure.min(explanation.score());
            }
        }
    }
}

/// What solves of some explanations say about others.
struct Known {
    /// The least score that is sure.
    sure: f64,
    /// Effects of which one form promised what did not come true.
    vain: Vec<Vec<(&'static str, usize)>>,
}

impl Known {
    /// True where another form of the same effects promised in vain, and a second term is among them: what is missed of that is the same beside every form.
    fn is_in_vain(&self, fit: &Fit) -> bool {
        fit.candidates.last().is_some_and(is_term) && self.vain.contains(&names(fit))
    }
}

/// True where two fits of a second term have about the same law: their solves lead to one place.
fn is_one_valley(one: &Fit, other: &Fit) -> bool {
    let apart = larger_first(one) - larger_first(other);
    let law = [0, 1, apart.len().saturating_sub(2), apart.len().saturating_sub(1)];
    law.iter().all(|at| apart[*at].abs() < ONE_VALLEY)
}

/// Where a fit lies, of two terms the larger as the first: the same law told the other way round ends at a bound of their ratio.
fn larger_first(fit: &Fit) -> DVector<f64> {
    let mut x = fit.x.clone();
    let term = fit.candidates.last().filter(|c| is_term(c));
    if let (Some(_), Some(at)) = (term, x.len().checked_sub(2)) {
        let list = &fit.coordinates;
        let (ratio, second) = (list[at].value(x[at]), list[at + 1].value(x[at + 1]));
        if ratio > 1.0 {
            let law = other_way_round([x[0].exp(), x[1].exp(), ratio, second]);
            (x[0], x[1]) = (law[0].ln(), law[1].ln());
            (x[at], x[at + 1]) = (list[at].of(law[2]), list[at + 1].of(law[3]));
        }
    }
    x
}

/// A law of two terms, modulus and exponent of the first, and ratio and exponent of the second, told the other way round.
fn other_way_round([mu_mpa, alpha, ratio, second]: [f64; 4]) -> [f64; 4] {
    [mu_mpa * ratio, second, ratio.recip(), alpha]
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

fn rubs(candidate: &Candidate) -> bool {
    candidate.effect.code == friction::EFFECT.code
}

fn is_term(candidate: &Candidate) -> bool {
    candidate.effect.code == second_term::EFFECT.code
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Both terms keep modulus and exponent, and twice round is where it began.
    #[test]
    fn two_terms_are_one_law_either_way() {
        let law = [0.02, 4.0, 2.5, 16.0];
        let other = other_way_round(law);
        assert_eq!(other, [0.05, 16.0, 0.4, 4.0]);
        let back = other_way_round(other);
        assert!(law.iter().zip(back).all(|(a, b)| (a - b).abs() < 1e-15));
    }
}
