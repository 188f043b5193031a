//! Frames smoothed by a Gaussian and sampled between their pixels, in one step.
//!
//! A Gaussian of one pixel leaves 0.7 % of the amplitude at the highest frequency of a frame. So values between pixels are
//! exact to a part in a million, and noise has the same variance at any fraction of a pixel: nothing pulls towards whole pixels.

use std::f64::consts::PI;

use super::frame::Frame;

/// Standard deviation of the Gaussian, pixels.
pub const SIGMA_PX: f64 = 1.0;
/// Taps on either side; what is left out is below 4e-6 of the middle.
const RADIUS: i64 = 5;
const TAPS: usize = 2 * RADIUS as usize + 1;
/// Part of a pixel's noise variance that is left: the sum of the squared taps.
pub const NOISE_LEFT: f64 = 1.0 / (4.0 * PI * SIGMA_PX * SIGMA_PX);
/// Closer to the border, the smoothed frame is made of repeated pixels; pixels.
pub const BORDER_PX: f64 = 2.0;

/// What is sampled along an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Order {
    /// The brightness.
    Value,
    /// Its derivative along the axis, per pixel.
    Slope,
    /// Its second derivative along the axis, per pixel squared.
    Bend,
}

/// Taps around the whole pixel next to `at`.
fn taps(at: f64, order: Order) -> (i64, [f32; TAPS]) {
    let near = at.round();
    let mut weights = [0.0; TAPS];
    for (k, weight) in weights.iter_mut().enumerate() {
        let d = k as f64 - RADIUS as f64 - (at - near);
        *weight = (-0.5 * (d / SIGMA_PX).powi(2)).exp();
    }
    let sum: f64 = weights.iter().sum();
    let mut out = [0.0; TAPS];
    for (k, (out, weight)) in out.iter_mut().zip(weights).enumerate() {
        let d = (k as f64 - RADIUS as f64 - (at - near)) / SIGMA_PX;
        let factor = match order {
            Order::Value => 1.0,
            Order::Slope => d / SIGMA_PX,
            Order::Bend => (d * d - 1.0) / (SIGMA_PX * SIGMA_PX),
        };
        *out = (weight / sum * factor) as f32;
    }
    (near as i64, out)
}

/// Samples windows of frames; keeps its memory from one to the next.
#[derive(Debug, Default)]
pub struct Sampler {
    line: Vec<f32>,
    rows: Vec<f32>,
}

impl Sampler {
    /// The smoothed frame at `corner` + whole pixels, `size` columns and rows, into `out`; beyond its border it is continued
    /// by its outermost pixels. A corner far outside is moved to where only border is seen.
    pub fn sample(
        &mut self,
        frame: &Frame,
        corner: [f64; 2],
        (width, height): (usize, usize),
        orders: [Order; 2],
        out: &mut Vec<f32>,
    ) {
        let far = |at: f64, size: usize, all: usize| at.clamp(-(size as f64) - 16.0, all as f64 + 16.0);
        let (x, along) = taps(far(corner[0], width, frame.width), orders[0]);
        let (y, down) = taps(far(corner[1], height, frame.height), orders[1]);
        let needed = height + TAPS - 1;
        self.rows.clear();
        self.rows.resize(needed * width, 0.0);
        let first = x - RADIUS;
        let length = width + TAPS - 1;
        let last_column = frame.width as i64 - 1;
        for (j, row) in self.rows.chunks_exact_mut(width).enumerate() {
            let source = frame.row(y - RADIUS + j as i64);
            let direct = usize::try_from(first).ok().and_then(|from| source.get(from..from + length));
            let line = match direct {
                Some(line) => line,
                None => {
                    self.line.clear();
                    let clamped = (first..first + length as i64).map(|at| source[at.clamp(0, last_column) as usize]);
                    self.line.extend(clamped);
                    &self.line
                }
            };
            accumulate(row, &along, |k| &line[k..k + width]);
        }
        out.clear();
        out.resize(width * height, 0.0);
        for (j, row) in out.chunks_exact_mut(width).enumerate() {
            accumulate(row, &down, |k| &self.rows[(j + k) * width..(j + k + 1) * width]);
        }
    }
}

/// Adds the lines that stand for the taps, weighted.
fn accumulate<'a>(row: &mut [f32], taps: &[f32; TAPS], line: impl Fn(usize) -> &'a [f32]) {
    for (k, tap) in taps.iter().enumerate() {
        for (out, value) in row.iter_mut().zip(line(k)) {
            *out += tap * value;
        }
    }
}

/// Sums of a field over its neighbourhood, weighted by `exp(-d^2 / (2 width^2))` (one at no distance), both ways; zero outside.
pub fn spread(field: &[f32], width: usize, width_px: f64, out: &mut Vec<f32>, rows: &mut Vec<f32>) {
    let radius = (2.5 * width_px).ceil() as usize;
    let weight = |d: usize| (-0.5 * (d as f64 / width_px).powi(2)).exp() as f32;
    let weights: Vec<f32> = (0..=radius).map(weight).collect();
    rows.clear();
    rows.extend_from_slice(field);
    for (row, source) in rows.chunks_exact_mut(width).zip(field.chunks_exact(width)) {
        for (d, weight) in weights.iter().enumerate().skip(1).take(width.saturating_sub(1)) {
            for (out, value) in row[d..].iter_mut().zip(source) {
                *out += weight * value;
            }
            for (out, value) in row.iter_mut().zip(&source[d..]) {
                *out += weight * value;
            }
        }
    }
    out.clear();
    out.extend_from_slice(rows);
    for (d, weight) in weights.iter().enumerate().skip(1) {
        let step = d * width;
        if step >= rows.len() {
            break;
        }
        for (out, value) in out[step..].iter_mut().zip(rows.iter()) {
            *out += weight * value;
        }
        for (out, value) in out.iter_mut().zip(&rows[step..]) {
            *out += weight * value;
        }
    }
}
