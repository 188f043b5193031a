//! A polynomial through points of equal weight, and what its residuals say.

use nalgebra::{DMatrix, DVector};

use super::distribution::{student_critical, student_two_sided};

/// Why there is no fit.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FitError {
    /// Too few points.
    #[error("{points} points for {parameters} parameters: at least {} are needed to see any scatter", parameters + 1)]
    TooFewPoints {
        /// Points.
        points: usize,
        /// Parameters of the law.
        parameters: usize,
    },
    /// Not enough different x.
    #[error("{levels} different x for {parameters} parameters: the law is not determined")]
    TooFewLevels {
        /// Different x.
        levels: usize,
        /// Parameters of the law.
        parameters: usize,
    },
    /// A number that is none.
    #[error("point {at} (x = {x}, y = {y}) is not finite")]
    NotFinite {
        /// Its place, from 1.
        at: usize,
        /// x.
        x: f64,
        /// y.
        y: f64,
    },
}

/// A fitted polynomial.
#[derive(Debug, Clone, PartialEq)]
pub struct Polynomial {
    /// Coefficients of rising powers of x, and their standard errors.
    pub coefficients: Vec<(f64, f64)>,
    /// Value at every point.
    pub fitted: Vec<f64>,
    /// Measured minus fitted at every point.
    pub residuals: Vec<f64>,
    /// How far each point pulls the fit towards itself, within 0..1.
    pub leverages: Vec<f64>,
    /// Points less parameters.
    pub freedom: f64,
    /// Standard deviation of the residuals, in the unit of y.
    pub deviation: f64,
}

impl Polynomial {
    /// Least squares of a degree.
    ///
    /// # Errors
    /// See [`FitError`].
    pub fn fit(points: &[(f64, f64)], degree: usize) -> Result<Self, FitError> {
        let parameters = degree + 1;
        if let Some(at) = points.iter().position(|p| !(p.0.is_finite() && p.1.is_finite())) {
            return Err(FitError::NotFinite { at: at + 1, x: points[at].0, y: points[at].1 });
        }
        if points.len() <= parameters {
            return Err(FitError::TooFewPoints { points: points.len(), parameters });
        }
        let mut levels: Vec<f64> = points.iter().map(|p| p.0).collect();
        levels.sort_by(f64::total_cmp);
        levels.dedup();
        if levels.len() < parameters {
            return Err(FitError::TooFewLevels { levels: levels.len(), parameters });
        }
        // powers of x over its largest magnitude: columns of like size
        let unit = levels.iter().fold(0.0_f64, |most, x| most.max(x.abs())).max(f64::MIN_POSITIVE);
        let design = DMatrix::from_fn(points.len(), parameters, |i, k| (points[i].0 / unit).powi(k as i32));
        let y = DVector::from_iterator(points.len(), points.iter().map(|p| p.1));
        let (q, r) = design.qr().unpack();
        let determined = FitError::TooFewLevels { levels: levels.len(), parameters };
        let inverse = r.try_inverse().ok_or(determined)?;
        let scaled = &inverse * q.tr_mul(&y);
        let fitted = &q * q.tr_mul(&y);
        let residuals = &y - &fitted;
        let freedom = (points.len() - parameters) as f64;
        let deviation = (residuals.norm_squared() / freedom).sqrt();
        let error = |k: usize| deviation * inverse.row(k).norm();
        let coefficients = (0..parameters).map(|k| {
            let unit = unit.powi(k as i32);
            (scaled[k] / unit, error(k) / unit)
        });
        Ok(Self {
            coefficients: coefficients.collect(),
            fitted: fitted.iter().copied().collect(),
            residuals: residuals.iter().copied().collect(),
            leverages: q.row_iter().map(|row| row.norm_squared()).collect(),
            freedom,
            deviation,
        })
    }

    /// Value at `x`.
    #[must_use]
    pub fn at(&self, x: f64) -> f64 {
        self.coefficients.iter().rev().fold(0.0, |sum, (c, _)| sum * x + c)
    }

    /// 95 % interval of a coefficient.
    #[must_use]
    pub fn interval95(&self, power: usize) -> (f64, f64) {
        let (value, error) = self.coefficients[power];
        let half = student_critical(0.05, self.freedom) * error;
        (value - half, value + half)
    }

    /// Probability that chance makes a coefficient at least as far from a value, two-sided.
    #[must_use]
    pub fn probability(&self, power: usize, from: f64) -> f64 {
        let (value, error) = self.coefficients[power];
        student_two_sided((value - from) / error, self.freedom)
    }

    /// Every residual over the standard deviation that it has by a fit to the *other* points: distributed as Student's t with one degree of
    /// freedom less than the fit has. NaN where a point alone determines the fit, or where nothing is left over to judge by.
    #[must_use]
    pub fn studentised(&self) -> Vec<f64> {
        let square = self.deviation * self.deviation * self.freedom;
        let one = |(e, h): (&f64, &f64)| {
            let others = (square - e * e / (1.0 - h)) / (self.freedom - 1.0);
            e / (others * (1.0 - h)).sqrt()
        };
        self.residuals.iter().zip(&self.leverages).map(one).collect()
    }

    /// The point that lies farthest off, and the probability that the farthest of so many lies so far by chance (Bonferroni, at most 1).
    #[must_use]
    pub fn outlier(&self) -> Option<(usize, f64)> {
        let each = self.studentised();
        let worst = (0..each.len())
            .filter(|i| each[*i].is_finite())
            .max_by(|a, b| each[*a].abs().total_cmp(&each[*b].abs()))?;
        let alone = student_two_sided(each[worst], self.freedom - 1.0);
        Some((worst, (alone * each.len() as f64).min(1.0)))
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;

    #[test]
    fn a_parabola_is_found_and_an_outlier_is_seen() {
        let exact = |x: f64| 2.0 - 0.5 * x + 0.25 * x * x;
        let mut points: Vec<(f64, f64)> = (0..12).map(|i| (f64::from(i), exact(f64::from(i)))).collect();
        let found = Polynomial::fit(&points, 2).unwrap();
        for ((c, _), expected) in found.coefficients.iter().zip([2.0, -0.5, 0.25]) {
            assert!((c - expected).abs() < 1e-10, "{found:?}");
        }
        assert!((found.leverages.iter().sum::<f64>() - 3.0).abs() < 1e-10);
        for (i, p) in points.iter_mut().enumerate() {
            p.1 += if i % 2 == 0 { 0.01 } else { -0.01 };
        }
        assert!(Polynomial::fit(&points, 2).unwrap().outlier().unwrap().1 > 0.2);
        points[7].1 += 0.2;
        let (at, p) = Polynomial::fit(&points, 2).unwrap().outlier().unwrap();
        assert!(at == 7 && p < 1e-3, "{at} {p}");
        assert!((found.at(2.0) - 2.0).abs() < 1e-10);
    }

    /// Closed form of a line: the slope's error is `s / sqrt(sum (x - mean)^2)`.
    #[test]
    fn errors_of_a_line_are_those_of_the_closed_form() {
        let points = [(1.0, 1.1), (2.0, 1.9), (3.0, 3.2), (4.0, 3.9)];
        let line = Polynomial::fit(&points, 1).unwrap();
        let s = line.deviation;
        assert!((line.coefficients[1].1 - s / 5.0_f64.sqrt()).abs() < 1e-12);
        let (low, high) = line.interval95(1);
        // t(0.05; 2) = 4.303
        assert!((0.5 * (high - low) / line.coefficients[1].1 - 4.3027).abs() < 1e-3);
        assert!((line.probability(1, low) - 0.05).abs() < 1e-6);
    }

    #[test]
    fn what_cannot_be_fitted_says_why() {
        let told = |points: &[(f64, f64)], degree| Polynomial::fit(points, degree).unwrap_err().to_string();
        assert_eq!(
            told(&[(1.0, 2.0), (2.0, 3.0)], 1),
            "2 points for 2 parameters: at least 3 are needed to see any scatter"
        );
        let same = [(1.0, 2.0), (1.0, 3.0), (1.0, 2.5)];
        assert_eq!(told(&same, 1), "1 different x for 2 parameters: the law is not determined");
        assert_eq!(told(&[(0.0, 1.0), (1.0, f64::NAN), (2.0, 1.0)], 1), "point 2 (x = 1, y = NaN) is not finite");
    }
}
