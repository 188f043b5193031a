//! Which pixels of the region belong to the tip: those that move with it.
//!
//! A region holds ground as well. Where the ground shows something, its pixels pull the tip back to where it was. They are
//! known by their residuals, which stay large while the tip moves over the ground.

use super::align::Fit;
use super::robust::Tolerance;
use super::template::Template;

/// Residuals tell ground from tip once the tip is so far from where it was first, pixels.
const APART_PX: f64 = 2.0;
/// So many frames are wanted before a pixel is judged,
const LEAST_FRAMES: f64 = 5.0;
/// and over so many it is remembered.
const REMEMBERED: f64 = 60.0;

/// Mean squares of residuals, a value a pixel of the template.
#[derive(Debug, Default)]
pub struct Clutter {
    squares: Vec<f32>,
    frames: f64,
    trust: Vec<f32>,
}

impl Clutter {
    /// Takes the residuals of a frame in which the tip was found.
    pub fn learn(&mut self, template: &Template, tolerance: &Tolerance, fit: &Fit, residuals: &[f32]) {
        if fit.shift[0].hypot(fit.shift[1]) < APART_PX {
            return;
        }
        self.squares.resize(residuals.len(), 0.0);
        self.frames = (self.frames + 1.0).min(REMEMBERED);
        let part = (1.0 / self.frames) as f32;
        let scale = (1.0 / (fit.gain() * fit.gain())) as f32;
        for (mean, residual) in self.squares.iter_mut().zip(residuals) {
            *mean += part * (residual * residual * scale - *mean);
        }
        if self.frames >= LEAST_FRAMES {
            self.trust.clear();
            let allowed = tolerance.variance() as f32;
            let pixels = self.squares.iter().zip(&template.inside);
            // Independent readings are weighted by one over their variance; ground is not independent from pixel to pixel.
            self.trust.extend(pixels.map(|(mean, inside)| inside * (allowed / mean.max(allowed)).powi(2)));
        }
    }

    /// Weights of the template's pixels, once they are known.
    pub fn trust(&self) -> Option<&[f32]> {
        (!self.trust.is_empty()).then_some(&self.trust[..])
    }
}
