//! Weights of pixels: what does not look like the template says nothing of its place.

use super::align::Fit;
use super::gaussian::NOISE_LEFT;
use super::noise::{SD_OF_MEDIAN, median};
use super::normal::TEMPLATE;
use super::template::Template;

/// Residuals up to so many standard deviations of the noise are its own.
const OF_NOISE: f64 = 3.0;
/// Edges may be off by so many pixels: sampling, focus, a tip that turns a little.
const OF_SLOPE_PX: f64 = 0.15;
/// Part of the template's range of brightness that light and surface may change by.
const OF_RANGE: f64 = 0.06;
/// The mean square of a pixel's noise over some frames is below so many times its variance,
const OF_MEAN_SQUARE: f64 = 3.0;
/// and what else changes stays below this part of the range of brightness.
const OF_CHANGES: f64 = 0.01;
/// Pixels of which the noise is the median; more cost time and tell little.
const LOOKED_AT: usize = 4000;

/// Tolerances of a template's pixels.
#[derive(Debug)]
pub struct Tolerance {
    /// Of every pixel, without that of noise.
    own: Vec<f32>,
    /// Mean square of a pixel's residuals over many frames, up to which it belongs to the tip.
    variance: f64,
    /// Standard deviation of smoothed noise in the difference of two frames, as the first frame has it.
    expected: f64,
}

impl Tolerance {
    /// Of a template whose pixels have noise of this standard deviation.
    pub fn new(template: &Template, pixel_noise: f64) -> Self {
        let mut sorted = template.basis[TEMPLATE].clone();
        sorted.sort_by(f32::total_cmp);
        let at = |part: f64| sorted.get((part * (sorted.len() - 1) as f64) as usize).copied().unwrap_or(0.0);
        let of_range = OF_RANGE as f32 * (at(0.98) - at(0.02));
        let slopes = template.basis[0].iter().zip(&template.basis[1]);
        let own: Vec<f32> = slopes.map(|(x, y)| of_range + OF_SLOPE_PX as f32 * x.hypot(*y)).collect();
        let expected = pixel_noise * (2.0 * NOISE_LEFT).sqrt();
        let changes = OF_CHANGES / OF_RANGE * f64::from(of_range);
        Self { own, expected, variance: OF_MEAN_SQUARE * expected * expected + changes * changes }
    }

    /// Mean square of a pixel's residuals over many frames, up to which it belongs to the tip.
    pub fn variance(&self) -> f64 {
        self.variance
    }

    /// Standard deviation of the residuals' noise, by their median; at most twice that of the first frame.
    pub fn noise(&self, residuals: &[f32]) -> f64 {
        let every = residuals.len().div_ceil(LOOKED_AT).max(1);
        let mut some: Vec<f32> = residuals.iter().step_by(every).map(|r| r.abs()).collect();
        let noise = SD_OF_MEDIAN * f64::from(median(&mut some));
        noise.min(2.0 * self.expected)
    }

    /// Weights that are one for noise and fall by the eighth power beyond the tolerance, where a residual counts for a quarter;
    /// `wider` multiplies the tolerances.
    pub fn weigh(&self, fit: &Fit, residuals: &[f32], wider: f64, trust: &[f32], out: &mut Vec<f32>) {
        let gain = fit.gain().min(2.0) as f32;
        let noise = (OF_NOISE * self.noise(residuals)) as f32;
        out.clear();
        out.extend(self.own.iter().zip(residuals).zip(trust).map(|((own, residual), inside)| {
            let off = residual / (wider as f32 * (noise + gain * own));
            inside / (1.0 + off.powi(4)).powi(2)
        }));
    }
}

/// Part of what holds the template that weights leave of what is trusted, along the axis of which less is left; 0 to 1.
pub fn held(template: &Template, weights: &[f32], trust: &[f32]) -> f64 {
    let part = |axis: usize| {
        let sum = |weights: &[f32]| -> f64 {
            let slopes = template.basis[axis].iter().zip(weights);
            slopes.map(|(slope, weight)| f64::from(slope * slope * weight)).sum()
        };
        sum(weights) / sum(trust).max(f64::MIN_POSITIVE)
    };
    part(0).min(part(1))
}
