//! Effects that are there or not: the 95 % interval of a parameter over every set of unseen effects (spike and slab).
//!
//! An amount is nothing with the probability `1 - p`, else normal with its prior deviation. Given a set of effects a parameter is normal; over all sets
//! it is a mixture, each set weighed by its prior odds and its evidence. Ends of the interval are quantiles of that mixture. Its tails are heavier than those of one
//! normal: as a rule nothing large is there, and then something is.
//!
//! The sets of the effects that move a parameter most are enumerated. The others are many and small, and have one normal with the variance of their mixture.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};

use super::covariance::Factor;
use super::lowrank::LowRank;
use super::mixture::{Part, quantile};

/// Charge of an effect with one amount, as a sum of squares: what it must win to be taken for there.
pub const CHARGE: f64 = 3.0;
/// Effects whose sets are enumerated, a parameter: 256 sets.
const ENUMERATED: usize = 8;
/// Share of a mixture below and above its interval.
const TAIL: f64 = 0.025;

/// Probability that an effect is there, before any data: the odds that [`CHARGE`] stands for, as a likelihood ratio.
#[must_use]
pub fn probability() -> f64 {
    let odds = (-0.5 * CHARGE).exp();
    odds / (1.0 + odds)
}

/// Logarithm of the odds, before any data, of one of some forms of an effect, which share them; amounts of one sign have twice the density.
#[must_use]
pub fn log_odds(forms: usize, one_sided: usize) -> f64 {
    let p = probability();
    (p / (1.0 - p) / forms.max(1) as f64).ln() + one_sided as f64 * std::f64::consts::LN_2
}

/// Amounts of unit deviation as the data see them beside fitted parameters.
#[derive(Debug, Clone)]
pub struct Amounts {
    /// For each parameter, what a unit of each amount moves its fit by.
    pub moved: DMatrix<f64>,
    /// Information of the data on the amounts, that on the parameters taken off.
    pub information: DMatrix<f64>,
    /// What the data say of the amounts: the columns times the residual of the fit.
    pub told: DVector<f64>,
    /// Columns of each effect, one after the other.
    pub effects: Vec<usize>,
}

/// A parameter's 95 % interval, from its fit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Span {
    /// Its lower end.
    pub low: f64,
    /// Its upper end.
    pub high: f64,
}

/// What is left of some amounts when others have been integrated out.
struct Given {
    moved: DVector<f64>,
    information: DMatrix<f64>,
    told: DVector<f64>,
    mean: f64,
    variance: f64,
}

impl Amounts {
    /// Every effect in the deviation that it has on the average: `p` of its variance.
    #[must_use]
    pub fn on_average(&self, probability: f64) -> Self {
        self.scaled(&DVector::from_element(self.told.len(), probability.sqrt()))
    }

    fn scaled(&self, by: &DVector<f64>) -> Self {
        let (moved, information) = (&self.moved, &self.information);
        Self {
            moved: DMatrix::from_fn(moved.nrows(), moved.ncols(), |i, k| moved[(i, k)] * by[k]),
            information: DMatrix::from_fn(by.len(), by.len(), |i, k| information[(i, k)] * by[i] * by[k]),
            told: self.told.component_mul(by),
            effects: self.effects.clone(),
        }
    }

    /// The 95 % interval of a parameter whose variance from noise is given, where every effect is there with a probability; `None` where a matrix is singular.
    #[must_use]
    pub fn interval(&self, parameter: usize, noise: f64, probability: f64) -> Option<Span> {
        let listed = if probability < 1.0 { self.largest(parameter)? } else { Vec::new() };
        let (mut named, mut rest) = (Vec::new(), Vec::new());
        for (effect, columns) in beside(&self.effects).into_iter().enumerate() {
            if listed.contains(&effect) { named.push(columns) } else { rest.extend(columns) }
        }
        let kept: Vec<usize> = named.iter().cloned().flatten().collect();
        let mut by = DVector::from_element(self.told.len(), 1.0);
        rest.iter().for_each(|k| by[*k] = probability.sqrt());
        let given = self.scaled(&by).without(parameter, noise, &rest, &kept)?;
        let starts = beside(&named.iter().map(Range::len).collect::<Vec<_>>());
        let parts = (0_usize..1 << named.len()).map(|set| {
            let own = starts.iter().enumerate().filter(|(at, _)| set & (1 << at) != 0);
            let columns: Vec<usize> = own.flat_map(|(_, columns)| columns.clone()).collect();
            given.part(&columns, f64::from(set.count_ones()) * (probability / (1.0 - probability)).ln())
        });
        let parts: Vec<Part> = parts.collect::<Option<_>>()?;
        Some(Span { low: quantile(&parts, TAIL), high: quantile(&parts, 1.0 - TAIL) })
    }

    /// The effects that move a parameter most, each for itself.
    fn largest(&self, parameter: usize) -> Option<Vec<usize>> {
        let mut all = Vec::new();
        for (effect, columns) in beside(&self.effects).into_iter().enumerate() {
            let columns: Vec<usize> = columns.collect();
            all.push((effect, self.without(parameter, 0.0, &columns, &[])?.variance));
        }
        all.sort_by(|a, b| b.1.total_cmp(&a.1));
        Some(all.into_iter().take(ENUMERATED).map(|(effect, _)| effect).collect())
    }

    /// Integrates some amounts out and keeps others.
    fn without(&self, parameter: usize, noise: f64, out: &[usize], kept: &[usize]) -> Option<Given> {
        let moved = self.moved.row(parameter).transpose();
        let of = |list: &[usize], from: &DVector<f64>| DVector::from_fn(list.len(), |k, _| from[list[k]]);
        let block = |rows: &[usize], columns: &[usize]| {
            DMatrix::from_fn(rows.len(), columns.len(), |i, k| self.information[(rows[i], columns[k])])
        };
        let (told, own) = (of(kept, &self.told), of(kept, &moved));
        let information = block(kept, kept);
        if out.is_empty() {
            return Some(Given { moved: own, information, told, mean: 0.0, variance: noise });
        }
        let factor = Factor::of(&(DMatrix::identity(out.len(), out.len()) + block(out, out)))?;
        let across = block(out, kept);
        let (told_out, moved_out) = (of(out, &self.told), of(out, &moved));
        let by = factor.solve(&moved_out);
        Some(Given {
            moved: own - across.tr_mul(&by),
            information: information - across.tr_mul(&factor.solve_all(&across)),
            told: told - across.tr_mul(&factor.solve(&told_out)),
            mean: -by.dot(&told_out),
            variance: noise + by.dot(&moved_out),
        })
    }
}

impl Given {
    /// The parameter where some amounts are there; its weight is the logarithm of what is proportional to the probability of that set.
    fn part(&self, columns: &[usize], prior: f64) -> Option<Part> {
        if columns.is_empty() {
            return Some(Part { weight: 0.0, mean: self.mean, deviation: self.variance.sqrt() });
        }
        let count = columns.len();
        let unit = |i: usize, k: usize| if i == k { 1.0 } else { 0.0 };
        let posterior = DMatrix::from_fn(count, count, |i, k| self.information[(columns[i], columns[k])] + unit(i, k));
        let factor = Factor::of(&posterior)?;
        let told = DVector::from_fn(count, |k, _| self.told[columns[k]]);
        let moved = DVector::from_fn(count, |k, _| self.moved[columns[k]]);
        let (by, amounts) = (factor.solve(&moved), factor.solve(&told));
        Some(Part {
            weight: prior - 0.5 * factor.log_determinant() + 0.5 * told.dot(&amounts),
            mean: self.mean - moved.dot(&amounts),
            deviation: (self.variance + by.dot(&moved)).sqrt(),
        })
    }
}

/// Columns of each of some effects that stand beside each other.
fn beside(counts: &[usize]) -> Vec<Range<usize>> {
    let place = |first: &mut usize, count: &usize| {
        let columns = *first..*first + count;
        *first = columns.end;
        Some(columns)
    };
    counts.iter().scan(0, place).collect()
}

/// All columns beside each other with the number of each effect.
#[must_use]
pub fn together(effects: &[LowRank], rows: usize) -> (LowRank, Vec<usize>) {
    let all = effects.iter().fold(LowRank::none(rows), |all, one| all.and(one));
    (all, effects.iter().map(LowRank::len).collect())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::infer::mixture::normal_below;

    fn amounts(moved: &[f64], information: f64) -> Amounts {
        let count = moved.len();
        let unit = |i: usize, k: usize| if i == k { information } else { 0.3 * information };
        Amounts {
            moved: DMatrix::from_row_slice(1, count, moved),
            information: DMatrix::from_fn(count, count, unit),
            told: DVector::zeros(count),
            effects: vec![1; count],
        }
    }

    /// One effect that the data do not see: the tail of the mixture against both normals by hand.
    #[test]
    fn one_effect_is_a_mixture_of_two_normals() {
        let found = amounts(&[3.0], 0.0).interval(0, 1.0, 0.2).unwrap();
        let below = 0.8 * normal_below(found.low) + 0.2 * normal_below(found.low / 10.0_f64.sqrt());
        assert!((below - 0.025).abs() < 1e-9 && (found.low + found.high).abs() < 1e-9, "{found:?}");
        // between noise alone and an effect that is there
        assert!(found.high > 1.96 && found.high < 1.96 * 10.0_f64.sqrt());
    }

    /// With a probability of one the interval is that of the normal of all amounts, and with none that of noise.
    #[test]
    fn what_is_there_for_certain_is_one_normal() {
        let all = amounts(&[2.0, -1.0, 0.5], 0.7);
        let certain = all.interval(0, 1.0, 1.0).unwrap();
        let dense = (DMatrix::identity(3, 3) + &all.information).try_inverse().unwrap();
        let variance = 1.0 + (&all.moved * dense * all.moved.transpose())[(0, 0)];
        assert!((certain.high - 1.959_963_984_540_054 * variance.sqrt()).abs() < 1e-6, "{certain:?} {variance}");
        let none = all.interval(0, 1.0, 1e-12).unwrap();
        assert!((none.high - 1.959_963_984_540_054).abs() < 1e-6, "{none:?}");
    }

    /// Twelve effects, of which eight are enumerated: within two percent of all 4096 sets.
    #[test]
    fn small_effects_may_share_a_normal() {
        let moved: Vec<f64> = (0..12).map(|k| 2.0 * 0.7_f64.powi(k)).collect();
        let all = amounts(&moved, 0.4);
        let found = all.interval(0, 1.0, probability()).unwrap();
        let given = all.without(0, 1.0, &[], &(0..12).collect::<Vec<_>>()).unwrap();
        let odds = (probability() / (1.0 - probability())).ln();
        let parts = (0_u32..4096).map(|set| {
            let columns: Vec<usize> = (0..12).filter(|k| set & (1 << k) != 0).collect();
            given.part(&columns, f64::from(set.count_ones()) * odds).unwrap()
        });
        let exact = quantile(&parts.collect::<Vec<_>>(), 0.975);
        assert!((found.high / exact - 1.0).abs() < 0.02, "{} {exact}", found.high);
    }

    /// Data that speak for an effect move the interval by what it moves the parameter.
    #[test]
    fn evidence_weighs_the_sets() {
        let mut all = amounts(&[3.0], 25.0);
        all.told[0] = 50.0;
        let found = all.interval(0, 1.0, 0.2).unwrap();
        let there = -3.0 * 50.0 / 26.0;
        assert!((0.5 * (found.low + found.high) - there).abs() < 0.01, "{found:?}");
    }

    #[test]
    fn the_odds_are_those_of_the_charge() {
        assert!((probability() - 0.182_425).abs() < 1e-6);
    }
}
