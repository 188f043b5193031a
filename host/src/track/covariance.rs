//! How uncertain an alignment is, from its residuals.
//!
//! The shift is linear in the residuals, `d = sum psi(x) r(x)`. Smoothed noise has a known correlation over pixels, so that its
//! variance follows from that of the residuals. What is no noise (edges between pixels, a change of focus) is larger where
//! `psi` is: sums of `psi r` over neighbourhoods measure it (White 1980, doi:10.2307/1912934; Conley 1999,
//! doi:10.1016/S0304-4076(98)00084-0).

use std::f64::consts::{PI, SQRT_2};

use super::align::Fit;
use super::gaussian::{NOISE_LEFT, SIGMA_PX, spread};
use super::normal::{LIGHT, Matrix, PICTURES, TEMPLATE, Vector, dot};
use super::template::Template;

/// Width of the neighbourhoods over which residuals count together, pixels.
const NEIGHBOURHOOD_PX: f64 = 5.0;
/// Part of smoothed noise's variance that such neighbourhoods hold: two Gaussians, integrated over the plane.
const HELD: f64 =
    NEIGHBOURHOOD_PX * NEIGHBOURHOOD_PX / (NEIGHBOURHOOD_PX * NEIGHBOURHOOD_PX + 2.0 * SIGMA_PX * SIGMA_PX);
/// What a fit takes out of the residuals of neighbourhoods, as a number of them: two shifts.
const FITTED: f64 = 2.0;
/// A slope that is noise for the most part carries no place: the part of its square that is taken for signal at least.
const LEAST_SIGNAL: f64 = 0.05;

/// Variances of a shift along x and y, pixels squared.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spread {
    /// If all residuals are noise, of the same size everywhere.
    pub noise: [f64; 2],
    /// As neighbourhoods of residuals tell.
    pub local: [f64; 2],
    /// Square of what contrast that changes across the tip, which no picture follows, may move the place by.
    pub uneven: [f64; 2],
}

/// Memory of the sums.
#[derive(Debug, Default)]
pub struct Sums {
    influence: Vec<f32>,
    spread: Vec<f32>,
    rows: Vec<f32>,
}

impl Sums {
    /// Of a fit with these weights and residuals; `None` where nothing holds the template.
    pub fn spread(&mut self, template: &Template, fit: &Fit, weights: &[f32], residuals: &[f32]) -> Option<Spread> {
        let inverse = fit.normal.inverse()?;
        let squares: f64 = weights.iter().zip(residuals).map(|(w, r)| f64::from(w * r * r)).sum();
        let independent = fit.normal.weight * NOISE_LEFT / (SIGMA_PX * SIGMA_PX);
        let free = (independent / (independent - PICTURES as f64)).clamp(1.0, 4.0);
        let free = if independent > PICTURES as f64 { free } else { 4.0 };
        // What was fitted is missing in the residuals of neighbourhoods as well.
        let neighbourhoods = fit.normal.weight / (4.0 * PI * NEIGHBOURHOOD_PX * NEIGHBOURHOOD_PX);
        let fitted = 1.0 / (1.0 - FITTED / neighbourhoods.max(2.0 * FITTED));
        let residual = squares / fit.normal.weight.max(1.0) * free;
        let (mut noise, mut local) = ([0.0; 2], [0.0; 2]);
        for axis in 0..2 {
            self.influence.clear();
            self.influence.resize(weights.len(), 0.0);
            for (k, picture) in template.basis.iter().enumerate() {
                let factor = (inverse[(axis, k)] / fit.gain()) as f32;
                for (out, value) in self.influence.iter_mut().zip(picture) {
                    *out += factor * value;
                }
            }
            self.influence.iter_mut().zip(weights).for_each(|(value, weight)| *value *= weight);
            spread(&self.influence, template.size.0, SQRT_2 * SIGMA_PX, &mut self.spread, &mut self.rows);
            noise[axis] = residual * dot(&self.influence, &self.spread).max(0.0);
            self.influence.iter_mut().zip(residuals).for_each(|(value, residual)| *value *= residual);
            spread(&self.influence, template.size.0, NEIGHBOURHOOD_PX, &mut self.spread, &mut self.rows);
            local[axis] = dot(&self.influence, &self.spread).max(0.0) / HELD * fitted;
            // The template's own noise makes its slopes larger than they are.
            let slope = fit.normal.products[(axis, axis)];
            let of_noise = 0.5 * residual / (2.0 * SIGMA_PX * SIGMA_PX) * fit.normal.weight;
            let larger = slope / (slope - of_noise).max(LEAST_SIGNAL * slope);
            noise[axis] *= larger * larger;
            local[axis] *= larger * larger;
        }
        let uneven = uneven(template, fit, &inverse, weights, residuals, residual);
        Some(Spread { noise, local, uneven })
    }
}

/// Contrast that changes across the tip is the template times a slope. Its part that the pictures do not hold is looked for in the
/// residuals; the part that they hold has moved the place (the bias of an omitted variable). What noise shows of it by chance
/// is taken out.
fn uneven(
    template: &Template,
    fit: &Fit,
    inverse: &Matrix,
    weights: &[f32],
    residuals: &[f32],
    residual: f64,
) -> [f64; 2] {
    let mut moved = [0.0; 2];
    for slope in [LIGHT + 1, LIGHT + 2] {
        let product = template.basis[TEMPLATE].iter().zip(&template.basis[slope]);
        let weighted: Vec<f32> = product.zip(weights).map(|((value, slope), weight)| value * slope * weight).collect();
        let product = template.basis[TEMPLATE].iter().zip(&template.basis[slope]);
        let square: f64 = product.zip(&weighted).map(|((value, slope), w)| f64::from(value * slope * w)).sum();
        let with = Vector::from_fn(|k, _| dot(&template.basis[k], &weighted));
        let held = inverse * with;
        let own = square - held.dot(&with);
        if own < LEAST_SIGNAL * square || own <= 0.0 {
            continue;
        }
        // The residuals are orthogonal to the pictures already.
        let factor = dot(&weighted, residuals) / own;
        let by_chance = residual * 4.0 * PI * SIGMA_PX * SIGMA_PX / own;
        let excess = (factor * factor - by_chance).max(0.0);
        for (axis, moved) in moved.iter_mut().enumerate() {
            *moved += (held[axis] / fit.gain()).powi(2) * excess;
        }
    }
    moved
}
