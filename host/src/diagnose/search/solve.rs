//! Finite elements of whole paths for the explanations that may be named.

use lut_gen::chain::{Detail, ROUGH, Whole};
use lut_gen::effect::{friction, second_term, softening};
use nalgebra::DVector;
use rayon::prelude::*;

use super::super::coordinate::{Candidate, coordinates};
use super::super::fit::Fit;
use super::Search;
use super::begin::{measured, suit};
use super::rounds::{SAME, SETTLES, Solved};

/// How far (sum of squares) behind the deepest a valley may lie to be followed.
const NEAR: f64 = 60.0;
/// Part of the first term that a second one begins with where it is solved from the start.
const RATIO: f64 = 0.3;
/// Solves of one fit, each at the point where the last one led.
const SOLVES: usize = 3;
/// One solve is believed, where one near by was known, unless a fit near it promises more than this: what finite elements add there is not what they add here, and no more is it where the fit leads
/// to.
const BELIEVED: f64 = 30.0;

/// Ratio of two exponents from which on what finite elements of one miss is not what those of the other do.
const MOVED: f64 = 1.1;

/// Valleys of a second term beside another effect that are followed to their ground.
const FOLLOWED: usize = 2;
/// Modulus and exponent (their logarithms), ratio and second exponent of two laws lie this near each other in one valley: different valleys were found two to twenty times as far apart, the same ones half as far at most.
const ONE_VALLEY: f64 = 0.1;

/// What the first solves of a fit led to.
struct Looked {
    solves: Vec<Solved>,
    /// One solve is not enough.
    far_off: bool,
    /// They are on a coarse mesh, to be compared with each other.
    coarse: bool,
}

impl Search<'_> {
    /// The fit once more with finite elements of the whole paths at its point; none where they fail, or where the chain needs none.
    #[must_use]
    pub fn solved(&self, fit: &Fit) -> Option<Fit> {
        self.look(fit).and_then(|looked| self.follow(&fit.candidates, looked))
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

    /// Where the first solves of a fit lead to.
    fn follow(&self, candidates: &[Candidate], looked: Looked) -> Option<Fit> {
        let deepest = looked.solves.first()?.near.discounted;
        let Looked { mut solves, far_off, coarse } = looked;
        if !far_off {
            return Some(solves.swap_remove(0).near);
        }
        if !coarse {
            return self.rounds(candidates, solves.swap_remove(0), (SETTLES - 1, SAME));
        }
        // without a history a solve is one ramp
        let (most, rounds) = if candidates.len() == 1 { (solves.len(), SETTLES) } else { (FOLLOWED, SOLVES - 1) };
        let mut worth: Vec<Solved> = Vec::new();
        for valley in solves.into_iter().filter(|v| v.near.discounted < deepest + NEAR) {
            if worth.len() < most && !worth.iter().any(|other| is_one_valley(&other.near, &valley.near)) {
                worth.push(valley);
            }
        }
        let ground = |valley: Solved| self.rounds_at(candidates, &larger_first(&valley.near), (rounds, SAME));
        let followed: Vec<Fit> = worth.into_par_iter().filter_map(ground).collect();
        followed.into_iter().min_by(|a, b| a.discounted.total_cmp(&b.discounted))
    }

    /// A fit with solves at its own place until it stays there.
    pub(in crate::diagnose) fn ended(&self, fit: &Fit, rounds: usize) -> Option<Fit> {
        self.rounds_of(fit, (rounds, SAME))
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
