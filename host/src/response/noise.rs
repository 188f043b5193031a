//! What is left of a recording: its correlation from sample to sample, and what that does to errors.

use nalgebra::DVector;

/// Most earlier samples that a residual may depend on.
const MOST_ORDER: usize = 8;
/// Largest sum of absolute coefficients of a filter of order 1, so that whitening keeps the slow part of a record.
const MOST_MEMORY: f64 = 0.995;

/// Autocorrelation at the lags 0 to `lags`; that of nothing is 1 at lag 0 and 0 elsewhere.
#[must_use]
pub fn autocorrelation(residual: &[f64], lags: usize) -> Vec<f64> {
    let n = residual.len().max(1) as f64;
    let mean = residual.iter().sum::<f64>() / n;
    let at = |lag: usize| -> f64 {
        let later = residual.iter().skip(lag);
        residual.iter().zip(later).map(|(a, b)| (a - mean) * (b - mean)).sum()
    };
    let all = at(0);
    (0..=lags).map(|lag| if all > 0.0 { at(lag) / all } else { f64::from(u8::from(lag == 0)) }).collect()
}

/// Statistic of Ljung and Box (1978, doi:10.1093/biomet/65.2.297) as a multiple of its degrees of freedom, and the multiple that white
/// noise exceeds once in a hundred records (Wilson and Hilferty's approximation of chi-squared).
#[must_use]
pub fn ljung_box(residual: &[f64], lags: usize, fitted: usize) -> (f64, f64) {
    let n = residual.len() as f64;
    let rho = autocorrelation(residual, lags);
    let sum: f64 = (1..=lags).map(|k| rho[k] * rho[k] / (n - k as f64)).sum();
    let freedom = lags.saturating_sub(fitted).max(1) as f64;
    let ninth = 2.0 / (9.0 * freedom);
    let z99 = 2.326_347_874_040_841;
    (n * (n + 2.0) * sum / freedom, (1.0 - ninth + z99 * ninth.sqrt()).powi(3))
}

/// Noise in which a sample depends on those before it: `e(t) = sum a_k e(t - k) + white`.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Coloured {
    /// Coefficients, of the sample before first; empty for white noise.
    pub coefficients: Vec<f64>,
}

impl Coloured {
    /// From residuals, by the equations of Yule and Walker; the order has the least BIC.
    #[must_use]
    pub fn of(residual: &[f64]) -> Self {
        let n = residual.len() as f64;
        let rho = autocorrelation(residual, MOST_ORDER);
        let (mut best, mut best_bic) = (Vec::new(), 0.0);
        let (mut a, mut variance): (Vec<f64>, f64) = (Vec::new(), 1.0);
        // Levinson's recursion.
        for order in 1..=MOST_ORDER.min(residual.len() / 10) {
            let carried: f64 = a.iter().enumerate().map(|(i, a)| a * rho[order - 1 - i]).sum();
            let reflection = ((rho[order] - carried) / variance).clamp(-MOST_MEMORY, MOST_MEMORY);
            let turned: Vec<f64> = a.iter().zip(a.iter().rev()).map(|(a, b)| a - reflection * b).collect();
            a = turned;
            a.push(reflection);
            variance *= 1.0 - reflection * reflection;
            let bic = n * variance.max(1e-12).ln() + order as f64 * n.ln();
            if bic < best_bic {
                (best, best_bic) = (a.clone(), bic);
            }
        }
        Self { coefficients: best }
    }

    /// What of a series its past does not tell; the first samples, which have no past, stay as they are.
    #[must_use]
    pub fn whitened(&self, series: &[f64]) -> DVector<f64> {
        let order = self.coefficients.len();
        let each = series.iter().enumerate().map(|(t, e)| {
            if t < order {
                return *e;
            }
            e - self.coefficients.iter().enumerate().map(|(k, a)| a * series[t - 1 - k]).sum::<f64>()
        });
        DVector::from_iterator(series.len(), each)
    }
}
