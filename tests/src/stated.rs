//! Whether stated standard errors are as large as what palpations scatter.

use palpate::demo::Palpated;

/// One parameter of one palpation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stated {
    /// True value.
    pub truth: f64,
    /// What was found.
    pub found: f64,
    /// Standard error that was stated with it.
    pub error: f64,
}

impl Stated {
    /// mu (MPa) and alpha of a palpation; none if the board stated none.
    #[must_use]
    pub fn of(p: &Palpated) -> Option<[Stated; 2]> {
        p.off()?;
        let e = p.estimate.as_ref()?;
        let stated = |truth, found: f32, error: f32| Stated { truth, found: found.into(), error: error.into() };
        Some([stated(p.true_mu_mpa, e.mu_mpa, e.mu_error_mpa), stated(p.true_alpha, e.alpha, e.alpha_error)])
    }
}

/// Errors stated and errors made, in fractions of the truth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Comparison {
    /// Number of palpations.
    pub count: usize,
    /// Share whose truth lies within two stated errors.
    pub within_two: f64,
    /// Median of the stated error.
    pub error: f64,
    /// Half the width of the middle 68.3 % of what was found: a standard deviation that single far ones do not move.
    pub scatter: f64,
    /// Root mean square of the error made.
    pub rms: f64,
    /// Median of the error made.
    pub bias: f64,
}

/// Share of a normal distribution within one standard deviation.
const WITHIN_ONE: f64 = 0.6827;

impl Comparison {
    /// Of some palpations; none without any.
    #[must_use]
    pub fn of(stated: &[Stated]) -> Option<Self> {
        let sorted = |value: &dyn Fn(&Stated) -> f64| {
            let mut list: Vec<f64> = stated.iter().map(value).collect();
            list.sort_by(f64::total_cmp);
            list
        };
        let (made, said) = (sorted(&|s| (s.found - s.truth) / s.truth), sorted(&|s| s.error / s.truth));
        let held = stated.iter().filter(|s| (s.found - s.truth).abs() <= 2.0 * s.error).count();
        let tail = 0.5 * (1.0 - WITHIN_ONE);
        Some(Comparison {
            count: stated.len(),
            within_two: held as f64 / stated.len() as f64,
            error: quantile(&said, 0.5)?,
            scatter: 0.5 * (quantile(&made, 1.0 - tail)? - quantile(&made, tail)?),
            rms: (made.iter().map(|x| x * x).sum::<f64>() / made.len() as f64).sqrt(),
            bias: quantile(&made, 0.5)?,
        })
    }

    /// Median stated error over scatter.
    #[must_use]
    pub fn ratio(&self) -> f64 {
        self.error / self.scatter
    }

    /// Issue F: 93 to 97 % within two stated errors, the median stated error at most 1.5 times the scatter.
    #[must_use]
    pub fn accepted(&self) -> bool {
        (0.93..=0.97).contains(&self.within_two) && self.ratio() <= 1.5
    }
}

/// Quantile of a sorted list, straight between its values; none of an empty list.
fn quantile(sorted: &[f64], share: f64) -> Option<f64> {
    let at = share * sorted.len().checked_sub(1)? as f64;
    let (low, high) = (sorted.get(at.floor() as usize)?, sorted.get(at.ceil() as usize)?);
    Some(low + (at - at.floor()) * (high - low))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;
    use palpate::plant::{Noise, Source};

    fn normal(error: f64) -> Vec<Stated> {
        let mut noise = Noise::new(3, Source::Force);
        (0..4000).map(|_| Stated { truth: 2.0, found: 2.0 + 0.2 * noise.normal(), error }).collect()
    }

    #[test]
    fn right_errors_are_accepted_and_errors_that_are_too_small_or_too_large_are_not() {
        let right = Comparison::of(&normal(0.2)).unwrap();
        // Four standard errors of a share of 0.954 and of a standard deviation, of 4000 values.
        assert!((right.within_two - 0.9545).abs() < 0.013 && (right.scatter - 0.1).abs() < 0.006, "{right:?}");
        assert!((right.rms - 0.1).abs() < 0.005 && right.bias.abs() < 0.008 && right.accepted());
        assert!(!Comparison::of(&normal(0.15)).unwrap().accepted());
        assert!(!Comparison::of(&normal(0.31)).unwrap().accepted());
        assert_eq!(Comparison::of(&[]), None);
    }

    #[test]
    fn quantiles_lie_between_values() {
        assert_eq!(quantile(&[1.0, 2.0, 4.0], 0.5), Some(2.0));
        assert_eq!(quantile(&[1.0, 2.0, 4.0], 0.75), Some(3.0));
        assert_eq!(quantile(&[], 0.5), None);
    }
}
