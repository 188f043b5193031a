//! How much farther the estimates of a recording scatter than its slopes say.
//!
//! Friction, play and dead time have kinks. The misfit is rough over the length of a standard error, and a search ends in the lowest of
//! several hollows. So the recording is made again and again (a parametric bootstrap, Efron and Tibshirani 1993, chapter 6): the fitted
//! law's motion with fresh noise, fitted again. What the estimates then scatter over their standard errors is one number for all of them:
//! so few repeats cannot tell the parameters apart.

use nalgebra::{DMatrix, DVector};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;

use super::choose::again;
use super::fit::{Fitted, Record, coordinate};
use super::noise::Coloured;

/// Recordings that are made and fitted again.
const REPEATS: u64 = 12;
/// Seed of their noise: the same recording always gets the same interval.
const SEED: u64 = 0x7061_6c70;
/// Largest squared distance that counts, in standard errors: a hollow far away is another estimate, not a scatter.
const MOST: f64 = 16.0;

/// Mean square of the estimates' distances from the law that they are made of, over their standard errors; at least 1.
#[must_use]
pub fn roughness(record: &Record, fitted: &Fitted, sd_mm: f64, covariance: &DMatrix<f64>) -> f64 {
    if sd_mm.is_nan() || sd_mm <= 0.0 {
        return 1.0;
    }
    let motion: Vec<f64> = record.position_mm.iter().zip(&fitted.residual_mm).map(|(y, r)| y - r).collect();
    let distances = |repeat: u64| -> Vec<f64> {
        let noise = coloured(&fitted.noise, &drawn(record.position_mm.len(), repeat));
        let position_mm = motion.iter().zip(&noise).map(|(x, e)| x + sd_mm * e).collect();
        let found = again(&Record { position_mm, ..record.clone() }, fitted);
        let told = fitted.free.iter().enumerate().filter(|(i, _)| covariance[(*i, *i)] > 0.0);
        told.map(|(i, parameter)| {
            let at = |law| coordinate(*parameter, parameter.of(law));
            (at(&found.law) - at(&fitted.law)).powi(2) / covariance[(i, i)]
        })
        .map(|squared| squared.min(MOST))
        .collect()
    };
    let all: Vec<f64> = (0..REPEATS).into_par_iter().flat_map_iter(distances).collect();
    (all.iter().sum::<f64>() / all.len().max(1) as f64).max(1.0)
}

fn drawn(count: usize, repeat: u64) -> DVector<f64> {
    let mut random = Pcg64Mcg::seed_from_u64(SEED + repeat);
    DVector::from_fn(count, |_, _| StandardNormal.sample(&mut random))
}

/// Noise whose whitened series is the white one.
fn coloured(noise: &Coloured, white: &DVector<f64>) -> Vec<f64> {
    let mut all: Vec<f64> = Vec::with_capacity(white.len());
    for (t, own) in white.iter().enumerate() {
        let whole = t >= noise.coefficients.len();
        let past: f64 = noise.coefficients.iter().zip(all.iter().rev()).map(|(a, e)| a * e).sum();
        all.push(own + if whole { past } else { 0.0 });
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coloured_noise_is_whitened_to_what_it_was_made_from() {
        let noise = Coloured { coefficients: vec![0.7, -0.2] };
        let white = drawn(50, 0);
        let apart = noise.whitened(&coloured(&noise, &white)) - &white;
        assert!(apart.amax() < 1e-12, "{apart}");
    }
}
