//! What effects that nobody saw add to the error of parameters.
//!
//! A fit finds parameters `x` from whitened rows `r = J (x - x0) + F a + e`, `e ~ N(0, I)`, with the amounts `a` at their null. Each amount has a
//! normal prior of unit deviation (the columns are scaled) where its effect is there at all. Then, given the data and that all are there,
//!
//! ```text
//! N = (J'J)^-1                              covariance from noise alone
//! G = N J'F                                 what one prior deviation of each amount moves the fit by
//! V = (I + F'F - F'J N J'F)^-1              what the data leave of the amounts
//! C = N + G V G'                            covariance of the parameters, the inverse of the Schur complement
//! m = -G V F'(r - J N J'r)                  where the parameters lie, from the fit
//! ```
//!
//! An effect that the data would show has a small `V` and adds nothing; one that lies within the span of `J` keeps `V = 1`. Which are there is not known:
//! the interval is that of the mixture over their sets ([`super::presence`]).

use nalgebra::{DMatrix, DVector};

use super::covariance::{Factor, Z95};
use super::lowrank::LowRank;
use super::presence::{Amounts, together};
use super::product::inner;

/// What unseen effects do to the error of parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct Widening {
    /// Variance beside that of noise with which a normal distribution has the parameter's 95 % interval.
    pub added: Vec<f64>,
    /// Variance of each parameter from noise alone.
    pub noise: Vec<f64>,
    /// Middle of that interval, from the fit: where the data put the parameter with unseen effects free.
    pub shift: Vec<f64>,
    /// For each parameter: meanings with the share of its variance that each adds, the largest first. The rest is noise.
    pub by: Vec<Vec<(&'static str, f64)>>,
}

impl Widening {
    /// Of a whitened Jacobian and residual, with whitened columns of the effects that may be there, each with a probability; `None` where the rows do not determine the
    /// parameters, or hold what is no number.
    #[must_use]
    pub fn of(jacobian: &DMatrix<f64>, residual: &DVector<f64>, effects: &[LowRank], probability: f64) -> Option<Self> {
        let (unseen, counts) = together(effects, jacobian.nrows());
        let noise = Factor::of(&inner(jacobian, jacobian))?.inverse();
        let columns = unseen.scaled();
        let coupling = inner(jacobian, &columns);
        let moved = &noise * &coupling;
        let amounts = Amounts {
            information: inner(&columns, &columns) - coupling.tr_mul(&moved),
            told: columns.tr_mul(residual) - moved.tr_mul(&jacobian.tr_mul(residual)),
            moved,
            effects: counts,
        };
        let noise: Vec<f64> = noise.diagonal().iter().copied().collect();
        let mut found = Self { added: Vec::new(), shift: Vec::new(), by: Vec::new(), noise };
        let average = amounts.on_average(probability);
        let left = left(&average)?;
        for (i, noise) in found.noise.iter().enumerate() {
            let span = amounts.interval(i, *noise, probability)?;
            let deviation = 0.5 * (span.high - span.low) / Z95;
            found.added.push((deviation * deviation - noise).max(0.0));
            found.shift.push(0.5 * (span.low + span.high));
            // one amount's part of the variance, correlations with the others shared evenly
            let spread = average.moved.row(i) * &left;
            let part = |k: usize| spread[k] * average.moved[(i, k)];
            found.by.push(shares(&unseen, part, found.added[i] / (found.added[i] + noise)));
        }
        found.added.iter().chain(&found.shift).all(|v| v.is_finite()).then_some(found)
    }

    /// How many times as wide as noise alone makes it a parameter's error is.
    #[must_use]
    pub fn times(&self, parameter: usize) -> f64 {
        (1.0 + self.added[parameter] / self.noise[parameter]).sqrt()
    }
}

/// What the data leave of amounts.
fn left(amounts: &Amounts) -> Option<DMatrix<f64>> {
    let count = amounts.told.len();
    let posterior = DMatrix::identity(count, count) + &amounts.information;
    if count == 0 { Some(posterior) } else { Some(Factor::of(&posterior)?.inverse()) }
}

/// Shares below this are not told.
const LEAST_TOLD: f64 = 0.01;

/// Meanings with their shares as JSON, the largest first.
#[must_use]
pub fn json(by: &[(&'static str, f64)]) -> serde_json::Value {
    let told = by.iter().filter(|(_, share)| *share >= LEAST_TOLD);
    told.map(|(code, share)| serde_json::json!({ "code": code, "share": share })).collect()
}

/// Width below which an interval is that of noise, over that of noise.
const WIDER: f64 = 1.05;

/// What widened an interval in words, codes as they are; none where it is that of noise.
#[must_use]
pub fn sentence(parameter: &str, times: f64, by: &[(&'static str, f64)]) -> Option<String> {
    const TOLD: usize = 3;
    const LEAST: f64 = 0.1;
    if times.is_nan() || times < WIDER {
        return None;
    }
    let named = by.iter().enumerate().take_while(|(at, (_, share))| *at == 0 || (*at < TOLD && *share > LEAST));
    let words: Vec<String> = named.map(|(_, (code, share))| format!("{code} ({:.0} %)", 100.0 * share)).collect();
    let list = match words.as_slice() {
        [] => return None,
        [one] => one.clone(),
        [head @ .., last] => format!("{} and {last}", head.join(", ")),
    };
    Some(format!(
        "the interval of {parameter} is {times:.1} times that of the noise, mostly because of {list}, which these runs cannot see"
    ))
}

/// Parts of a variance by meaning, those that add to it, the largest first. Two amounts that pull against each other have parts beyond the whole: all are scaled to
/// `share`, what unseen amounts have of it.
fn shares(unseen: &LowRank, part: impl Fn(usize) -> f64, share: f64) -> Vec<(&'static str, f64)> {
    let mut sums: Vec<(&'static str, f64)> = Vec::new();
    for (k, meaning) in unseen.meanings().iter().enumerate() {
        match sums.iter_mut().find(|(known, _)| known == meaning) {
            Some((_, sum)) => *sum += part(k),
            None => sums.push((meaning, part(k))),
        }
    }
    sums.retain(|(_, part)| *part > 0.0);
    let whole: f64 = sums.iter().map(|(_, part)| part).sum();
    sums.iter_mut().for_each(|(_, part)| *part *= share / whole);
    sums.sort_by(|a, b| b.1.total_cmp(&a.1));
    sums
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::infer::covariance::{covariance, marginal_information};

    fn jacobian() -> DMatrix<f64> {
        DMatrix::from_fn(12, 2, |i, j| ((i + 3 * j) as f64).sin() + 0.2)
    }

    fn unseen() -> [LowRank; 2] {
        let column = |of: usize| DMatrix::from_fn(12, 1, |i, _| 2.0 * ((of * i + of) as f64).cos());
        [LowRank::new(column(2), vec![0.7], "one"), LowRank::new(column(5), vec![1.3], "other")]
    }

    /// Effects that are there for certain: against the inverse of the dense covariance of the rows, and against the one Schur complement.
    #[test]
    fn the_widened_error_is_that_of_the_dense_covariance() {
        let (j, f) = (jacobian(), together(&unseen(), 12).0.scaled());
        let r = DVector::from_fn(12, |i, _| (0.3 * i as f64).cos());
        let found = Widening::of(&j, &r, &unseen(), 1.0).unwrap();
        let dense = (DMatrix::identity(12, 12) + &f * f.transpose()).try_inverse().unwrap();
        let exact = (j.tr_mul(&(&dense * &j))).try_inverse().unwrap();
        let schur = covariance(&marginal_information(&j, &f)).unwrap();
        let plain = inner(&j, &j).try_inverse().unwrap();
        // the widened estimate less the plain one
        let shift = &exact * j.tr_mul(&(&dense * &r)) - &plain * j.tr_mul(&r);
        for i in 0..2 {
            // a quantile is found by halving, to the rounding of the error function
            assert!((found.added[i] + found.noise[i] - exact[(i, i)]).abs() < 1e-9 * exact[(i, i)]);
            assert!((schur[(i, i)] - exact[(i, i)]).abs() < 1e-12);
            assert!((found.shift[i] - shift[i]).abs() < 1e-9, "{} {}", found.shift[i], shift[i]);
            let told: f64 = found.by[i].iter().map(|(_, share)| share).sum();
            let share = found.added[i] / (found.added[i] + found.noise[i]);
            assert!((told - share).abs() < 1e-12 && found.times(i) >= 1.0);
        }
    }

    /// One that is a parameter keeps its prior whole, one that is nothing adds nothing.
    #[test]
    fn what_looks_like_a_parameter_adds_its_prior_and_what_shows_adds_little() {
        let j = jacobian();
        let twin = LowRank::new(j.columns(0, 1).into_owned(), vec![0.5], "twin");
        let loud = LowRank::new(DMatrix::from_fn(12, 1, |i, _| f64::from(u8::from(i == 3))), vec![1e6], "loud");
        let found = Widening::of(&j, &DVector::zeros(12), &[twin, loud.clone()], 1.0).unwrap();
        let without = Widening::of(&j, &DVector::zeros(12), &[loud], 1.0).unwrap();
        assert!((found.added[0] - without.added[0] - 0.25).abs() < 1e-9, "{found:?}");
        // an amount that is not known at all takes its row away, and no more
        let rest = inner(&j.clone().remove_row(3), &j.remove_row(3)).try_inverse().unwrap();
        assert!((without.added[1] + without.noise[1] - rest[(1, 1)]).abs() < 1e-6 * rest[(1, 1)]);
        assert_eq!(found.by[0][0].0, "twin");
    }

    #[test]
    fn what_widened_is_told_with_its_shares() {
        let by = [("compliance", 0.5), ("contact-offset", 0.25), ("lag", 0.005)];
        let told = sentence("mu", 2.3, &by).unwrap();
        assert!(told.contains("2.3 times") && told.contains("compliance (50 %) and contact-offset (25 %)"), "{told}");
        assert_eq!(sentence("mu", 1.01, &by), None);
        assert_eq!(json(&by).as_array().unwrap().len(), 2);
    }

    #[test]
    fn without_amounts_nothing_is_widened_and_what_is_no_number_says_nothing() {
        let r = DVector::from_element(12, 1.0);
        let found = Widening::of(&jacobian(), &r, &[], 1.0).unwrap();
        assert!(found.added.iter().zip(&found.noise).all(|(added, noise)| *added < 1e-9 * noise), "{found:?}");
        let bad = LowRank::unit(DMatrix::from_element(12, 1, f64::NAN), "bad");
        assert!(Widening::of(&jacobian(), &r, &[bad], 0.5).is_none());
        assert!(Widening::of(&DMatrix::zeros(12, 2), &r, &unseen(), 0.5).is_none());
    }
}
