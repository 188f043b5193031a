//! Weights of pixels: what does not look like the template says nothing of its place.

use std::f64::consts::PI;
use std::ops::Range;

use super::align::Fit;
use super::gaussian::{NOISE_LEFT, spread};
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
/// So far around hidden pixels others lose weight, as the width of a Gaussian, pixels.
const AWAY_PX: f64 = 2.0;
/// Sums run side by side, which the compiler makes vectors of.
const LANES: usize = 8;
/// Parts of a region, each way, that must all be seen where a tip is found anew,
const PARTS: usize = 4;
/// if they hold this part of an even share of the edges.
const EDGES_OF_PART: f64 = 0.5;
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

/// Takes weight from pixels near those that have none: the border of what hides the tip is smoothed over them, and pulls.
/// A single pixel without weight, as noise makes them, takes little.
pub fn keep_away(weights: &mut [f32], trust: &[f32], width: usize, memory: &mut [Vec<f32>; 3]) {
    let [lost, near, rows] = memory;
    lost.clear();
    lost.extend(weights.iter().zip(trust).map(|(weight, trust)| trust - weight));
    spread(lost, width, AWAY_PX, near, rows);
    let whole = (2.0 * PI * AWAY_PX * AWAY_PX) as f32;
    for ((weight, trust), near) in weights.iter_mut().zip(trust).zip(near.iter()) {
        // Half of the neighbourhood is lost at a straight border.
        let left = (1.0 - 2.0 * near / whole).max(0.0);
        *weight = weight.min(trust * left);
    }
}

/// Sums of squared slopes along both axes, under weights, of a run of pixels.
fn holds(template: &Template, weights: &[f32], pixels: Range<usize>) -> [f64; 2] {
    let mut sums = [0.0; 2];
    for (sum, slopes) in sums.iter_mut().zip(&template.basis[..2]) {
        let mut lanes = [0.0_f32; LANES];
        let (slopes, weights) = (slopes[pixels.clone()].chunks(LANES), weights[pixels.clone()].chunks(LANES));
        for (slopes, weights) in slopes.zip(weights) {
            for ((lane, slope), weight) in lanes.iter_mut().zip(slopes).zip(weights) {
                *lane += slope * slope * weight;
            }
        }
        *sum = lanes.iter().map(|lane| f64::from(*lane)).sum();
    }
    sums
}

/// Part of what holds the template that weights leave of what is trusted, along the axis of which less is left; 0 to 1.
pub fn held(template: &Template, weights: &[f32], trust: &[f32]) -> f64 {
    let all = |weights: &[f32]| holds(template, weights, 0..weights.len());
    let (left, whole) = (all(weights), all(trust));
    (0..2).map(|axis| left[axis] / whole[axis].max(f64::MIN_POSITIVE)).fold(1.0, f64::min)
}

/// The same of parts of the region, in both axes together: of the part of which least is left. What hides a tip hides some parts
/// of it wholly, whereas noise and light take a little of all. Parts with few edges are passed over.
pub fn least_held(template: &Template, weights: &[f32], trust: &[f32]) -> f64 {
    let (width, height) = template.size;
    let sum = |weights: &[f32], pixels: Range<usize>| holds(template, weights, pixels).iter().sum::<f64>();
    let range = |part: usize, length: usize| part * length / PARTS..(part + 1) * length / PARTS;
    let whole = sum(trust, 0..trust.len());
    let mut least = 1.0_f64;
    for part in 0..PARTS * PARTS {
        let columns = range(part % PARTS, width);
        let rows = || range(part / PARTS, height).map(|y| y * width + columns.start..y * width + columns.end);
        let all: f64 = rows().map(|row| sum(trust, row)).sum();
        if all > EDGES_OF_PART * whole / (PARTS * PARTS) as f64 {
            least = least.min(rows().map(|row| sum(weights, row)).sum::<f64>() / all);
        }
    }
    least
}
