//! 95 % intervals of the parameters from the Jacobian of the residuals.

use nalgebra::{DMatrix, DVector};

use super::noise::Noise;
use super::objective::{ALPHA, LN_MU, Objective};
use super::simplex::Bounds;
use crate::infer::covariance::covariance;
use crate::infer::product::inner;

/// Two-sided 95 % of a normal distribution.
const Z95: f64 = 1.959_963_985;
/// Variance of a least-absolute-differences estimate over that of least squares for normal noise.
const ABSOLUTE_OVER_SQUARES: f64 = std::f64::consts::FRAC_PI_2;

/// Standard errors in the space of the fit: alpha, ln mu, heights.
#[derive(Debug, Clone, PartialEq)]
pub struct StandardErrors {
    /// From noise.
    pub noise: Vec<f64>,
    /// From the error bound of the model.
    pub model: Vec<f64>,
}

/// An interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interval {
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

impl StandardErrors {
    /// The 95 % interval of one parameter, cut to the box.
    pub fn interval(&self, point: &[f64], bounds: &Bounds, axis: usize) -> Interval {
        let half = Z95 * self.noise[axis].hypot(self.model[axis]);
        Interval { low: (point[axis] - half).max(bounds.low[axis]), high: (point[axis] + half).min(bounds.high[axis]) }
    }
}

/// Standard errors at a fitted point, contact points free.
///
/// Residuals are linearised in (alpha, ln mu, heights, contact of every run). Noise enters with
/// its correlation length; the model's error bound, a share of the largest force, enters as three smooth shapes of
/// error over depth in every pairing, each uniform within the bound and nothing at contact, where every curve is Hertz's. If the data cannot tell the
/// parameters apart at all the errors are infinite and the intervals the whole box.
pub fn standard_errors(
    objective: &Objective<'_>,
    bounds: &Bounds,
    point: &[f64],
    contacts: &[f64],
    noise: &Noise,
) -> StandardErrors {
    let count = point.len();
    let jacobian = Jacobian::of(objective, bounds, point, contacts);
    let normal = inner(&jacobian.rows, &jacobian.rows);
    let Some(inverse) = covariance(&normal) else {
        return StandardErrors { noise: vec![f64::INFINITY; count], model: vec![0.0; count] };
    };
    let variance = noise.sigma_n.powi(2) * noise.correlated_samples * ABSOLUTE_OVER_SQUARES;
    let mut model = vec![0.0; count];
    let one_sigma = objective.model.relative_error() / 3.0_f64.sqrt();
    for pairing in 0..objective.selection.pairings.len() {
        for shape in 0..3 {
            let error = jacobian.model_error(pairing, f64::from(shape)) * one_sigma;
            let shift = &inverse * jacobian.rows.transpose() * error;
            for (sum, shift) in model.iter_mut().zip(shift.iter()) {
                *sum += shift * shift;
            }
        }
    }
    StandardErrors {
        noise: (0..count).map(|i| (variance * inverse[(i, i)]).max(0.0).sqrt()).collect(),
        model: model.into_iter().map(f64::sqrt).collect(),
    }
}

/// Derivatives of the modelled forces of all fitted samples.
struct Jacobian {
    rows: DMatrix<f64>,
    /// Pairing, depth below contact relative to the deepest, and force of every sample.
    samples: Vec<(usize, f64, f64)>,
}

impl Jacobian {
    fn of(objective: &Objective<'_>, bounds: &Bounds, point: &[f64], contacts: &[f64]) -> Self {
        let fitted: Vec<_> = objective.selection.curves.iter().filter(|curve| !curve.hold_out).collect();
        let forces = |point: &[f64], shift_mm: f64| -> Vec<f64> {
            let curves = objective.unit_curves(point);
            let mu_mpa = point[LN_MU].exp();
            let runs = fitted.iter().zip(contacts);
            runs.flat_map(|(data, contact)| {
                let curve = &curves[data.pairing];
                let modelled = move |depth: &f64| mu_mpa * curve.at(depth - contact - shift_mm);
                data.depth_mm.iter().map(modelled).collect::<Vec<f64>>()
            })
            .collect()
        };
        let base = forces(point, 0.0);
        let mut rows = DMatrix::zeros(base.len(), point.len() + fitted.len());
        for axis in 0..point.len() {
            let step = 1e-4 * bounds.side(axis).max(1e-9);
            let (mut low, mut high) = (point.to_vec(), point.to_vec());
            low[axis] = (point[axis] - step).max(bounds.low[axis]);
            high[axis] = (point[axis] + step).min(bounds.high[axis]);
            let width = high[axis] - low[axis];
            let (below, above) = (forces(&low, 0.0), forces(&high, 0.0));
            for (row, (below, above)) in below.iter().zip(&above).enumerate() {
                rows[(row, axis)] = (above - below) / width;
            }
        }
        let step = 1e-4;
        let (below, above) = (forces(point, -step), forces(point, step));
        let mut samples = Vec::new();
        for (run, data) in fitted.iter().enumerate() {
            let deepest = data.depth_mm.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            let span = (deepest - contacts[run]).max(f64::MIN_POSITIVE);
            for depth in &data.depth_mm {
                let row = samples.len();
                rows[(row, point.len() + run)] = (above[row] - below[row]) / (2.0 * step);
                let share = ((depth - contacts[run]) / span).clamp(0.0, 1.0);
                samples.push((data.pairing, share, base[row]));
            }
        }
        Self { rows, samples }
    }

    /// A force error `F_peak x cos(shape pi x)` in one pairing, `x` the depth over the largest.
    fn model_error(&self, pairing: usize, shape: f64) -> DVector<f64> {
        let of_pairing = self.samples.iter().filter(|(of, ..)| *of == pairing);
        let peak = of_pairing.map(|(.., force)| *force).fold(0.0, f64::max);
        let errors = self.samples.iter().map(|(of, share, _)| {
            let here = *of == pairing;
            if here { peak * share * (shape * std::f64::consts::PI * share).cos() } else { 0.0 }
        });
        DVector::from_iterator(self.samples.len(), errors)
    }
}

/// Whether a fitted parameter lies on a wall of the box (within a thousandth of its side).
pub fn at_bound(point: &[f64], bounds: &Bounds, axis: usize) -> bool {
    let tolerance = 1e-3 * bounds.side(axis);
    point[axis] < bounds.low[axis] + tolerance || point[axis] > bounds.high[axis] - tolerance
}

/// Whether the material lies outside what the model covers: alpha on a wall.
pub fn outside(point: &[f64], bounds: &Bounds) -> bool {
    at_bound(point, bounds, ALPHA)
}
