//! Sub-pixel alignment of a template with a frame: Gauss-Newton with gain, focus and a plane of light (Baker and Matthews 2004,
//! the inverse compositional form, doi:10.1023/B:VISI.0000011205.11775.fd).

use super::frame::Frame;
use super::gaussian::{Order, Sampler};
use super::normal::{Normal, TEMPLATE};
use super::template::{Template, hide_outside};

/// Largest step of one iteration, pixels of the level.
const STEP_PX: f64 = 1.5;
/// Farther from its start an alignment has found something else, pixels of the level.
const REACH_PX: f64 = 5.0;
/// A step that ends the iterations, pixels of the level.
const SETTLED_PX: f64 = 1e-3;

/// A template on a frame.
#[derive(Debug, Clone)]
pub struct Fit {
    /// How far from its place in the first frame, pixels of the level.
    pub shift: [f64; 2],
    /// Normal equations at the end.
    pub normal: Normal,
    /// Factors of the pictures at the end.
    pub factors: [f64; super::normal::PICTURES],
}

impl Fit {
    /// Contrast in the frame over that of the first.
    pub fn gain(&self) -> f64 {
        self.factors[TEMPLATE]
    }
}

/// Aligns; keeps its memory.
#[derive(Debug, Default)]
pub struct Aligner {
    sampler: Sampler,
    /// The frame at the end of the last alignment, one value a pixel of the template.
    pub window: Vec<f32>,
    /// Weights of the last alignment.
    pub weights: Vec<f32>,
}

impl Aligner {
    /// From `start` with at most so many steps; `trust` are weights of the template's pixels, one where none are given.
    /// `None` where nothing of the template is seen, or its contrast.
    pub fn align(
        &mut self,
        template: &Template,
        frame: &Frame,
        start: [f64; 2],
        steps: usize,
        trust: Option<&[f32]>,
    ) -> Option<Fit> {
        let mut shift = start;
        let mut normal = template.full.clone();
        let mut weighed_at: Option<[f64; 2]> = None;
        for step in 1..=steps {
            let corner = [template.corner[0] + shift[0], template.corner[1] + shift[1]];
            self.sampler.sample(frame, corner, template.size, [Order::Value; 2], &mut self.window);
            let is_near = |at: [f64; 2]| (at[0] - shift[0]).abs().max((at[1] - shift[1]).abs()) < 0.1;
            if !weighed_at.is_some_and(is_near) {
                self.weights.clear();
                self.weights.extend_from_slice(trust.unwrap_or(&template.inside));
                let all = hide_outside(frame, corner, template.size, &mut self.weights);
                normal = match all && trust.is_none() {
                    true => template.full.clone(),
                    false => Normal::of_basis(&template.basis, &self.weights, template.bend_noise),
                };
                weighed_at = Some(shift);
            }
            normal.set_window(&template.basis, &self.weights, &self.window);
            let factors = normal.factors()?;
            let gain = factors[TEMPLATE];
            if !(gain > 1e-3 && gain.is_finite()) {
                return None;
            }
            let mut by = [-factors[0] / gain, -factors[1] / gain];
            let length = by[0].hypot(by[1]);
            if length > STEP_PX {
                by = by.map(|b| b * STEP_PX / length);
            }
            shift = [shift[0] + by[0], shift[1] + by[1]];
            if !((shift[0] - start[0]).abs() < REACH_PX && (shift[1] - start[1]).abs() < REACH_PX) {
                return None;
            }
            if length < SETTLED_PX || step == steps {
                let mut all = [0.0; super::normal::PICTURES];
                all.copy_from_slice(factors.as_slice());
                return Some(Fit { shift, normal, factors: all });
            }
        }
        None
    }

    /// What the pictures leave of the last window, one value a pixel.
    pub fn residuals(&self, template: &Template, fit: &Fit, out: &mut Vec<f32>) {
        out.clear();
        out.extend_from_slice(&self.window);
        for (picture, factor) in template.basis.iter().zip(fit.factors) {
            let factor = factor as f32;
            for (out, value) in out.iter_mut().zip(picture) {
                *out -= factor * value;
            }
        }
    }
}
