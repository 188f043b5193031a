//! The front of several goals that one cannot reach at once: generalised differential evolution.
//!
//! A population of points in the unit cube; every one is challenged by another moved along the difference of two more, and
//! a challenger takes its place if it is better in one goal and worse in none. Where neither is, both stay until the
//! crowded ones go (Kukkonen and Lampinen 2005, GDE3, doi:10.1109/CEC.2005.1554717; crowding after Deb et al. 2002,
//! doi:10.1109/4235.996017).

use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;
use rayon::prelude::*;

/// How good a point is.
#[derive(Debug, Clone, PartialEq)]
pub struct Score {
    /// The goals; less is better.
    pub goals: [f64; 2],
    /// How far it is from what is allowed; 0 is allowed.
    pub violation: f64,
}

/// A point of the unit cube with its score and what else is known of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Scored<T> {
    /// The point.
    pub at: Vec<f64>,
    /// Its score.
    pub score: Score,
    /// What was found there.
    pub found: T,
}

/// Settings of a search.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Settings {
    /// Points that are looked at, in all.
    pub evaluations: usize,
    /// Seed of its chance.
    pub seed: u64,
}

/// Points of a population.
const POPULATION: usize = 32;
/// Part of a difference that a challenger is moved by, and chance of each coordinate to come from it (Kukkonen and
/// Lampinen's values for problems with few coordinates).
const STRETCH: f64 = 0.5;
const CROSSED: f64 = 0.9;

impl Score {
    /// True when it is better than another in a goal and worse in none; what is allowed is better than what is not.
    #[must_use]
    pub fn dominates(&self, other: &Score) -> bool {
        if self.violation > 0.0 || other.violation > 0.0 {
            return self.violation < other.violation;
        }
        let pairs = || self.goals.iter().zip(&other.goals);
        pairs().all(|(a, b)| a <= b) && pairs().any(|(a, b)| a < b)
    }
}

/// The points that no other dominates, of all that were looked at, by their first goal. `look` scores a point; `told`
/// hears how many were looked at.
pub fn front<T: Clone + Send>(
    dimensions: usize,
    settings: Settings,
    look: impl Fn(&[f64]) -> (Score, T) + Sync,
    mut told: impl FnMut(usize),
) -> Vec<Scored<T>> {
    let mut chance = Pcg64::seed_from_u64(settings.seed);
    let scored = |points: Vec<Vec<f64>>| -> Vec<Scored<T>> {
        let one = |at: Vec<f64>| {
            let (score, found) = look(&at);
            Scored { at, score, found }
        };
        points.into_par_iter().map(one).collect()
    };
    let mut population = scored(spread(dimensions, settings.evaluations.min(POPULATION), &mut chance));
    let mut looked = population.len();
    let mut best = kept(population.clone());
    told(looked);
    while looked < settings.evaluations && population.len() >= 4 {
        let count = population.len().min(settings.evaluations - looked);
        let challengers = (0..count).map(|i| challenger(&population, i, &mut chance)).collect();
        let challengers = scored(challengers);
        looked += count;
        best = kept(best.into_iter().chain(challengers.iter().cloned()).collect());
        population = next(population, challengers);
        told(looked);
    }
    best
}

/// A first population: each coordinate's range is cut into as many parts as there are points, and each part has one
/// (Latin hypercube).
fn spread(dimensions: usize, count: usize, chance: &mut Pcg64) -> Vec<Vec<f64>> {
    use rand::seq::SliceRandom;
    let mut points = vec![Vec::with_capacity(dimensions); count];
    for _ in 0..dimensions {
        let mut parts: Vec<usize> = (0..count).collect();
        parts.shuffle(chance);
        for (point, part) in points.iter_mut().zip(parts) {
            point.push((part as f64 + chance.random::<f64>()) / count as f64);
        }
    }
    points
}

fn challenger<T>(population: &[Scored<T>], own: usize, chance: &mut Pcg64) -> Vec<f64> {
    let mut others: Vec<usize> = Vec::with_capacity(3);
    while others.len() < 3 {
        let other = chance.random_range(0..population.len());
        if other != own && !others.contains(&other) {
            others.push(other);
        }
    }
    let at = |i: usize| &population[others[i]].at;
    let own = &population[own].at;
    let sure = chance.random_range(0..own.len());
    (0..own.len())
        .map(|k| {
            if k != sure && chance.random::<f64>() > CROSSED {
                return own[k];
            }
            let moved = at(0)[k] + STRETCH * (at(1)[k] - at(2)[k]);
            // beyond a bound: half way from where it began to the bound
            if (0.0..=1.0).contains(&moved) { moved } else { 0.5 * (at(0)[k] + moved.clamp(0.0, 1.0)) }
        })
        .collect()
}

/// The next population: of a point and its challenger the better one, or both; the most crowded go.
fn next<T: Clone>(population: Vec<Scored<T>>, challengers: Vec<Scored<T>>) -> Vec<Scored<T>> {
    let size = population.len();
    let mut all = Vec::with_capacity(2 * size);
    let mut challengers = challengers.into_iter();
    for own in population {
        match challengers.next() {
            Some(other) if other.score.dominates(&own.score) => all.push(other),
            Some(other) if !own.score.dominates(&other.score) => all.extend([own, other]),
            _ => all.push(own),
        }
    }
    let mut chosen: Vec<Scored<T>> = Vec::with_capacity(size);
    while chosen.len() < size {
        let layer = undominated(&all);
        let mut rest = Vec::with_capacity(all.len());
        let mut front = Vec::new();
        for (i, point) in all.into_iter().enumerate() {
            if layer.contains(&i) { front.push(point) } else { rest.push(point) }
        }
        while chosen.len() + front.len() > size {
            let room = crowding(&front);
            let most = (0..front.len()).min_by(|a, b| room[*a].total_cmp(&room[*b])).unwrap_or(0);
            front.swap_remove(most);
        }
        chosen.extend(front);
        all = rest;
    }
    chosen
}

/// Places of the points that no other dominates.
fn undominated<T>(points: &[Scored<T>]) -> Vec<usize> {
    let free = |i: &usize| !points.iter().any(|other| other.score.dominates(&points[*i].score));
    (0..points.len()).filter(free).collect()
}

/// The allowed points that no other dominates, each score once, by their first goal.
fn kept<T: Clone>(points: Vec<Scored<T>>) -> Vec<Scored<T>> {
    let free = undominated(&points);
    let mut kept: Vec<Scored<T>> = free.into_iter().map(|i| points[i].clone()).collect();
    kept.sort_by(|a, b| a.score.goals[0].total_cmp(&b.score.goals[0]));
    kept.dedup_by(|a, b| a.score == b.score);
    kept
}

/// Room around every point of a front: the sides of the box between its neighbours, over the front's; without end at the ends.
fn crowding<T>(front: &[Scored<T>]) -> Vec<f64> {
    let mut room = vec![0.0; front.len()];
    for goal in 0..2 {
        let value = |i: usize| front[i].score.goals[goal];
        let mut order: Vec<usize> = (0..front.len()).collect();
        order.sort_by(|a, b| value(*a).total_cmp(&value(*b)));
        let (Some(first), Some(last)) = (order.first(), order.last()) else { continue };
        let range = value(*last) - value(*first);
        room[*first] = f64::INFINITY;
        room[*last] = f64::INFINITY;
        for three in order.windows(3).filter(|_| range > 0.0) {
            room[three[1]] += (value(three[2]) - value(three[0])) / range;
        }
    }
    room
}

#[cfg(test)]
mod tests {
    use super::*;

    fn score(goals: [f64; 2], violation: f64) -> Score {
        Score { goals, violation }
    }

    #[test]
    fn what_is_allowed_is_better_than_what_is_not() {
        assert!(score([9.0, 9.0], 0.0).dominates(&score([0.0, 0.0], 0.1)));
        assert!(score([9.0, 9.0], 0.1).dominates(&score([0.0, 0.0], 0.2)));
        assert!(score([1.0, 2.0], 0.0).dominates(&score([1.0, 3.0], 0.0)));
        assert!(!score([1.0, 2.0], 0.0).dominates(&score([2.0, 1.0], 0.0)));
    }

    /// Zitzler, Deb and Thiele's first problem (2000, doi:10.1162/106365600568202): the front is f2 = 1 - sqrt f1.
    #[test]
    fn a_known_front_is_found() {
        let look = |x: &[f64]| {
            let g = 1.0 + 9.0 * x[1..].iter().sum::<f64>() / (x.len() - 1) as f64;
            (score([x[0], g * (1.0 - (x[0] / g).sqrt())], 0.0), ())
        };
        let front = front(5, Settings { evaluations: 4000, seed: 7 }, look, |_| {});
        assert!(front.len() > 40, "{}", front.len());
        let close = front.iter().filter(|p| p.score.goals[1] - (1.0 - p.score.goals[0].sqrt()) < 0.01).count();
        assert!(close as f64 > 0.9 * front.len() as f64, "{close} of {}", front.len());
        let widest = front.windows(2).map(|w| w[1].score.goals[0] - w[0].score.goals[0]).fold(0.0, f64::max);
        assert!(widest < 0.15, "{widest}");
    }

    /// Only a disc is allowed: its lower left arc is the front.
    #[test]
    fn a_front_along_a_bound_is_found() {
        let look = |x: &[f64]| {
            let off = (x[0] - 0.5).hypot(x[1] - 0.5) - 0.3;
            (score([x[0], x[1]], off.max(0.0)), ())
        };
        let found = front(2, Settings { evaluations: 1500, seed: 3 }, look, |_| {});
        assert!(found.len() > 20);
        for point in &found {
            let r = (point.at[0] - 0.5).hypot(point.at[1] - 0.5);
            assert!((0.28..=0.3).contains(&r) && point.score.violation == 0.0, "{r}");
        }
        let again = front(2, Settings { evaluations: 1500, seed: 3 }, look, |_| {});
        assert_eq!(found, again, "the same seed is the same search");
    }
}
