//! How much more a search finds in a recording than its slopes say.
//!
//! Friction, play and dead time have kinks. The misfit is rough over the length of a standard error, and a search ends in the lowest of
//! several hollows: it falls by more than one variance a parameter. Ye's generalised degrees of freedom (1998,
//! doi:10.1080/01621459.1998.10474094) count that: the fitted law's motion with fresh noise is fitted again, and the fall of the misfit
//! beyond that of a projection onto the slopes is averaged.

use nalgebra::DVector;
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;

use super::choose::again;
use super::fit::{Fitted, Record};
use super::noise::Coloured;

/// Recordings that are made and fitted again: the mean excess is then known to about half a degree of freedom.
const REPEATS: u64 = 8;
/// Seed of their noise: the same recording always gets the same interval.
const SEED: u64 = 0x7061_6c70;

/// Degrees of freedom that the search used over the number of its parameters, at least 1.
#[must_use]
pub fn roughness(record: &Record, fitted: &Fitted, sd_mm: f64) -> f64 {
    let free = fitted.free.len() as f64;
    if !(sd_mm > 0.0 && free > 0.0) {
        return 1.0;
    }
    let motion: Vec<f64> = record.position_mm.iter().zip(&fitted.residual_mm).map(|(y, r)| y - r).collect();
    let excess = |repeat: u64| {
        let white = drawn(record.position_mm.len(), repeat);
        let noise = coloured(&fitted.noise, &white);
        let position_mm = motion.iter().zip(&noise).map(|(x, e)| x + sd_mm * e).collect();
        let found = again(&Record { position_mm, ..record.clone() }, fitted);
        let fall = white.norm_squared() - found.misfit() / (sd_mm * sd_mm);
        fall - projected(fitted, &white)
    };
    let sum: f64 = (0..REPEATS).into_par_iter().map(excess).sum();
    (1.0 + sum / REPEATS as f64 / free).max(1.0)
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

/// Squared length of what the slopes explain of a noise.
fn projected(fitted: &Fitted, white: &DVector<f64>) -> f64 {
    let told: Vec<usize> = (0..fitted.slopes.ncols()).filter(|i| fitted.slopes.column(*i).norm() > 0.0).collect();
    let mut unit = fitted.slopes.select_columns(&told);
    unit.column_iter_mut().for_each(|mut column| {
        let length = column.norm();
        column /= length;
    });
    let onto = unit.tr_mul(white);
    unit.tr_mul(&unit).pseudo_inverse(1e-13).map_or(0.0, |inverse| onto.dot(&(inverse * &onto)))
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
