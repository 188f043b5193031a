//! Does a law miss by more than repeats of one reading differ? The F test of lack of fit, NIST/SEMATECH e-Handbook 4.4.4.6 and 4.6.1.

use super::distribution::{fisher_critical, fisher_tail};

/// Why the test cannot be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LackOfFitError {
    /// Nothing repeats.
    #[error(
        "no x is repeated: without repeats nobody can say what is noise and what the law misses; read at least one point twice"
    )]
    NoRepeats,
    /// The law has a parameter for every x.
    #[error("{levels} different x and {parameters} parameters: the law has nothing left to miss")]
    Saturated {
        /// Different x.
        levels: usize,
        /// Parameters.
        parameters: usize,
    },
    /// Points and predictions do not match.
    #[error("{points} points and {fitted} fitted values: there must be one for each")]
    Lengths {
        /// Points.
        points: usize,
        /// Fitted values.
        fitted: usize,
    },
    /// A number that is none.
    #[error("point {at} is not finite")]
    NotFinite {
        /// Its place, from 1.
        at: usize,
    },
}

/// Outcome of the test.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LackOfFit {
    /// Mean square of what the law misses over mean square of what repeats differ by; infinite when repeats agree exactly and the law misses,
    /// NaN when neither differs.
    pub f: f64,
    /// Degrees of freedom of both.
    pub freedom: (f64, f64),
    /// Standard deviation of repeats, in the unit of y.
    pub repeats: f64,
    /// Probability of so large a ratio if the law is right and the noise is normal and independent.
    pub probability: f64,
}

impl LackOfFit {
    /// Tests `fitted`, the law's values at `points` with `parameters` fitted to these same points. Points with equal x are repeats.
    ///
    /// # Errors
    /// See [`LackOfFitError`].
    pub fn of(points: &[(f64, f64)], fitted: &[f64], parameters: usize) -> Result<Self, LackOfFitError> {
        if points.len() != fitted.len() {
            return Err(LackOfFitError::Lengths { points: points.len(), fitted: fitted.len() });
        }
        let finite = |i: &usize| points[*i].0.is_finite() && points[*i].1.is_finite() && fitted[*i].is_finite();
        if let Some(at) = (0..points.len()).find(|i| !finite(i)) {
            return Err(LackOfFitError::NotFinite { at: at + 1 });
        }
        let mut order: Vec<usize> = (0..points.len()).collect();
        order.sort_by(|a, b| points[*a].0.total_cmp(&points[*b].0));
        let groups: Vec<&[usize]> = order.chunk_by(|a, b| points[*a].0 == points[*b].0).collect();
        if groups.len() == points.len() {
            return Err(LackOfFitError::NoRepeats);
        }
        if groups.len() <= parameters {
            return Err(LackOfFitError::Saturated { levels: groups.len(), parameters });
        }
        let (mut missed, mut pure) = (0.0, 0.0);
        for group in &groups {
            let mean = group.iter().map(|i| points[*i].1).sum::<f64>() / group.len() as f64;
            missed += group.iter().map(|i| (mean - fitted[*i]).powi(2)).sum::<f64>();
            pure += group.iter().map(|i| (points[*i].1 - mean).powi(2)).sum::<f64>();
        }
        let freedom = ((groups.len() - parameters) as f64, (points.len() - groups.len()) as f64);
        let f = (missed / freedom.0) / (pure / freedom.1);
        Ok(Self { f, freedom, repeats: (pure / freedom.1).sqrt(), probability: fisher_tail(f, freedom) })
    }

    /// What the ratio exceeds with a probability.
    #[must_use]
    pub fn critical(&self, level: f64) -> f64 {
        fisher_critical(level, self.freedom)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::super::polynomial::Polynomial;
    use super::*;

    /// Deflections of a load cell over load, Pontius, NIST: the load-cell data of NIST/SEMATECH e-Handbook 4.6.1 and of the Statistical Reference Datasets
    /// (public domain). Two passes over 150,000 to 3,000,000 in steps of 150,000.
    const DEFLECTION: [f64; 40] = [
        0.11019, 0.21956, 0.32949, 0.43899, 0.54803, 0.65694, 0.76562, 0.87487, 0.98292, 1.09146, 1.20001, 1.30822,
        1.41599, 1.52399, 1.63194, 1.73947, 1.84646, 1.95392, 2.06128, 2.16844, 0.11052, 0.22018, 0.32939, 0.43886,
        0.54798, 0.65739, 0.76596, 0.87474, 0.98300, 1.09150, 1.20004, 1.30818, 1.41613, 1.52408, 1.63159, 1.73965,
        1.84696, 1.95445, 2.06177, 2.16829,
    ];

    fn load_cell() -> Vec<(f64, f64)> {
        DEFLECTION.iter().enumerate().map(|(i, y)| (150_000.0 * (i % 20 + 1) as f64, *y)).collect()
    }

    /// The handbook prints F = 214.7464, a critical value of 2.15 and a residual standard deviation of 0.0021712694 with 38 degrees of freedom.
    /// Rational arithmetic on the forty readings gives F = 214.746923653909 and 0.00217127259605675: the printed digits agree to three parts in a million,
    /// which is what single precision leaves of such differences.
    #[test]
    fn the_line_through_nists_load_cell_misses_as_the_handbook_says() {
        let points = load_cell();
        let line = Polynomial::fit(&points, 1).unwrap();
        assert_eq!(line.freedom, 38.0);
        assert!((line.deviation / 0.002_171_272_596_056_75 - 1.0).abs() < 1e-10, "{}", line.deviation);
        assert!((line.deviation / 0.002_171_269_4 - 1.0).abs() < 3e-6);
        let test = LackOfFit::of(&points, &line.fitted, 2).unwrap();
        assert_eq!(test.freedom, (18.0, 20.0));
        assert!((test.f / 214.746_923_653_909 - 1.0).abs() < 1e-9, "{}", test.f);
        assert!((test.f / 214.7464 - 1.0).abs() < 3e-6);
        assert!((test.critical(0.05) - 2.15).abs() <= 5e-3);
        assert!(test.probability < 1e-12);
    }

    /// The parabola is what the handbook settles on; its coefficients and errors are certified by NIST (StRD, Pontius) to 15 digits.
    #[test]
    fn the_parabola_is_the_certified_one_and_misses_nothing() {
        let points = load_cell();
        let parabola = Polynomial::fit(&points, 2).unwrap();
        let certified = [
            (6.735_657_894_736_84e-4, 1.079_386_120_330_77e-4),
            (7.320_591_604_010_03e-7, 1.578_173_999_816_59e-10),
            (-3.160_818_713_450_29e-15, 4.866_528_499_920_36e-17),
        ];
        for ((value, error), (c, e)) in parabola.coefficients.iter().zip(certified) {
            // ten digits: the condition of the quadratic costs the others
            assert!((value / c - 1.0).abs() < 1e-10 && (error / e - 1.0).abs() < 1e-10, "{value} {error}");
        }
        let test = LackOfFit::of(&points, &parabola.fitted, 3).unwrap();
        assert!(test.f < test.critical(0.05) && test.probability > 0.05, "{test:?}");
    }

    #[test]
    fn tests_that_cannot_be_made_say_what_is_missing() {
        let told = |points: &[(f64, f64)], fitted: &[f64], parameters| {
            LackOfFit::of(points, fitted, parameters).unwrap_err().to_string()
        };
        let once = [(1.0, 1.0), (2.0, 2.1), (3.0, 2.9)];
        assert!(told(&once, &[1.0, 2.0, 3.0], 2).starts_with("no x is repeated"));
        let twice = [(1.0, 1.0), (1.0, 1.1), (2.0, 2.1)];
        assert_eq!(
            told(&twice, &[1.0, 1.0, 2.0], 2),
            "2 different x and 2 parameters: the law has nothing left to miss"
        );
        assert_eq!(told(&twice, &[1.0], 2), "3 points and 1 fitted values: there must be one for each");
        assert_eq!(told(&twice, &[1.0, f64::NAN, 1.0], 1), "point 2 is not finite");
    }
}
