//! The nearest library material: the same sum of absolute differences (Eq. 17) over the library's own curves, each at
//! its own best contact offset.
//!
//! A library curve is compared at several contact offsets because the contact point of a single palpation is known to
//! some hundredths of a millimetre only, and a shift of that size changes a steep curve more than two materials differ.
//!
//! # Acceptance
//! A material's acceptance a, a fraction of its own force F at the deepest sample, bounds the mean absolute difference that it may have from a press without
//! noise. White noise of standard deviation s adds to the difference: for normal numbers of variances m^2 (misfit) and s^2 the mean absolute sum is
//! `sqrt(2/pi (m^2 + s^2))`, so that what is left without the noise is `sqrt(e^2 - 2/pi s^2)` of a measured mean e. It is held against `a F`, that is, e is held against
//! the limit `sqrt((a F)^2 + 2/pi s^2)`; three standard deviations of such a mean over n samples, `3 s sqrt((1 - 2/pi) / n)`, are left to chance. s is what the board
//! has measured before contact. Without it soft materials would be refused for the load cell's noise; materials that differ by less than the noise are told
//! apart by the margin, which both share.
//!
//! What the acceptance means in parameters is [`Intervals`].

use crate::number::sqrt;
use crate::search::{Slice, margin};
use crate::surface::Surface;
use protocol::lut::{DepthPosition, Material, Table, axis_name};
use protocol::message::Recognition;

/// Most library materials that are compared.
pub const MAX_MATERIALS: usize = 32;

/// No material: nothing compared, or none near enough.
pub const NOT_RECOGNISED: Recognition = Recognition {
    index: Recognition::NONE,
    error_n: 0.0,
    runner_up: Recognition::NONE,
    runner_up_error_n: 0.0,
    margin: 0.0,
    limit_n: 0.0,
};

/// Least mean absolute difference of every material so far.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Comparison {
    errors_n: [f32; MAX_MATERIALS],
    /// Depth of the deepest sample at the middle offset, mm.
    pub deepest_mm: f32,
    /// Samples compared at one offset, at most.
    samples: u16,
}

impl Default for Comparison {
    fn default() -> Self {
        Self::new()
    }
}

impl Comparison {
    /// Nothing compared.
    pub const fn new() -> Self {
        Comparison { errors_n: [f32::INFINITY; MAX_MATERIALS], deepest_mm: 0.0, samples: 0 }
    }

    /// Compares a recorded palpation, as pairs (depth mm, force N) at one contact offset, with every material. Depths at or above the
    /// surface have no force; depths beyond the table are left out.
    /// Curves of another rate than `rate_mm_s`, that of the slice, are left out.
    pub fn step(&mut self, table: &Table<'_>, rate_mm_s: f32, samples: impl Iterator<Item = (f32, f32)> + Clone) {
        for (error_n, material) in self.errors_n.iter_mut().zip(table.materials()) {
            if !material.serves(rate_mm_s) {
                continue;
            }
            let (mut sum_n, mut count) = (0.0, 0u16);
            for (depth_mm, force_n) in samples.clone() {
                let modelled_n = if depth_mm > 0.0 {
                    let position: DepthPosition = match table.locate(depth_mm) {
                        Some(position) => position,
                        None => continue,
                    };
                    material.force_n(position)
                } else {
                    0.0
                };
                sum_n += (force_n - modelled_n).abs();
                count = count.saturating_add(1);
            }
            self.samples = self.samples.max(count);
            let mean_n = sum_n / f32::from(count);
            if count > 0 && mean_n < *error_n {
                *error_n = mean_n;
            }
        }
    }

    /// Nearest material and runner-up under force noise of standard deviation `noise_n` (N; less than zero or no number counts as none). The nearest is named
    /// only if its error is within its acceptance, a fraction of its own force at the deepest sample (its peak, for a palpation of full depth), and
    /// the noise; error, limit, runner-up and margin are given either way.
    pub fn result(&self, table: &Table<'_>, noise_n: f32) -> Recognition {
        let mut nearest = (Recognition::NONE, f32::INFINITY);
        let mut runner_up = nearest;
        for (i, error_n) in self.errors_n.iter().enumerate().take(table.material_count()) {
            if *error_n < nearest.1 {
                runner_up = nearest;
                nearest = (i as u8, *error_n);
            } else if *error_n < runner_up.1 {
                runner_up = (i as u8, *error_n);
            }
        }
        let Some(material) = table.material(usize::from(nearest.0)) else {
            return NOT_RECOGNISED;
        };
        let reached_n = match table.locate(self.deepest_mm) {
            Some(position) => material.force_n(position),
            None => material.peak_force_n(),
        };
        let limit_n = limit_n(material.acceptance * reached_n, noise_n, self.samples);
        let accepted = nearest.1 <= limit_n;
        let alone = !runner_up.1.is_finite();
        Recognition {
            index: if accepted { nearest.0 } else { Recognition::NONE },
            error_n: nearest.1,
            runner_up: runner_up.0,
            runner_up_error_n: if alone { 0.0 } else { runner_up.1 },
            margin: if alone { 0.0 } else { margin(nearest.1, runner_up.1) },
            limit_n,
        }
    }
}

/// Largest mean absolute difference over some samples, N, of a material that would be accepted up to `accepted_n` without noise.
fn limit_n(accepted_n: f32, noise_n: f32, samples: u16) -> f32 {
    let noise_n = if noise_n > 0.0 && noise_n.is_finite() { noise_n } else { 0.0 };
    let mean2 = core::f32::consts::FRAC_2_PI;
    let chance = sqrt((1.0 - mean2) / f32::from(samples.max(1)));
    sqrt(accepted_n * accepted_n + mean2 * noise_n * noise_n) + 3.0 * noise_n * chance
}

/// Parameters of the presses that a library material stands for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Intervals {
    /// Shear modulus, MPa: from, to.
    pub mu_mpa: (f32, f32),
    /// Exponent: from, to; ends at the table's grid.
    pub alpha: (f32, f32),
}

impl Intervals {
    /// Between these ends a foam of the material's height, pressed over the whole depth of the table without noise and with its contact known, differs from the
    /// material's curve by no more than its acceptance: mu with the exponent as in the library, alpha with the modulus as in the library. Together they may go
    /// farther, along the valley in which one makes up for the other. `None` for a table without the two parameters, or a material outside its grid.
    pub fn of(table: &Table<'_>, material: &Material<'_>) -> Option<Self> {
        let slice = Slice::nearest(table, material.height_mm, material.rate_mm_s)?;
        let surface = Surface::new(table, &slice)?;
        let rows = table.rows();
        let depth_mm = |row: usize| table.depth_step_mm() * (row + 1) as f32;
        let own_n = |row: usize| table.locate(depth_mm(row)).map(|position| material.force_n(position));
        let accepted_n = material.acceptance * material.peak_force_n();
        let mut mean_n = 0.0;
        for row in 0..rows {
            mean_n += own_n(row)? / rows as f32;
        }
        let by = accepted_n / mean_n;
        // The library's own curve, bent as the surface bends from its exponent to another.
        let off_n = |alpha: f32| {
            let mut sum_n = 0.0;
            for row in 0..rows {
                let here = surface.at(1.0, material.alpha, depth_mm(row))?.force_n;
                let there = surface.at(1.0, alpha, depth_mm(row))?.force_n;
                sum_n += (own_n(row)? * (there / here - 1.0)).abs();
            }
            Some(sum_n / rows as f32)
        };
        let end = |edge: f32| {
            let (mut inside, mut outside) = (material.alpha, edge);
            if off_n(edge)? <= accepted_n {
                return Some(edge);
            }
            // Halved until f32 cannot tell them apart.
            for _ in 0..24 {
                let middle = 0.5 * (inside + outside);
                *(if off_n(middle)? <= accepted_n { &mut inside } else { &mut outside }) = middle;
            }
            Some(inside)
        };
        table.axis(axis_name::MU)?;
        let (low, high) = surface.alpha_range();
        Some(Intervals {
            mu_mpa: (material.mu_mpa * (1.0 - by), material.mu_mpa * (1.0 + by)),
            alpha: (end(low)?, end(high)?),
        })
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;
    use crate::testbed::{Chance, Foam, LIBRARY, factored_table};

    /// Mean difference, limit and name of a press with known contact.
    fn compared(table: &Table<'_>, foam: Foam, noise: (f64, u64)) -> Recognition {
        let mut chance = Chance(noise.1);
        let samples: Vec<(f32, f32)> = (1..=200)
            .map(|i| 0.02 * f64::from(i))
            .map(|d| (d as f32, (foam.force_n(d) + noise.0 * chance.normal()) as f32))
            .collect();
        let mut comparison = Comparison::new();
        comparison.deepest_mm = 4.0;
        comparison.step(table, 0.0, samples.into_iter());
        comparison.result(table, noise.0 as f32)
    }

    #[test]
    fn a_foam_within_the_intervals_is_named_and_one_beyond_is_not() {
        let bytes = factored_table();
        let table = Table::parse(&bytes).unwrap();
        // Those that have no near neighbour in the library.
        for i in [2, 3, 5, 6] {
            let foam = LIBRARY[i];
            let intervals = Intervals::of(&table, &table.material(i).unwrap()).unwrap();
            let (mu, alpha) = (intervals.mu_mpa, intervals.alpha);
            println!("{}: mu {mu:?}, alpha {alpha:?}", foam.name);
            // A twentieth of the way inwards and outwards from each end.
            let around = |end: f32, middle: f64, by: f64| middle + by * (f64::from(end) - middle);
            for (by, named) in [(0.95, i as u8), (1.05, Recognition::NONE)] {
                for end in [mu.0, mu.1] {
                    let other = Foam { mu_mpa: around(end, foam.mu_mpa, by), ..foam };
                    assert_eq!(compared(&table, other, (0.0, 1)).index, named, "{} {other:?}", foam.name);
                }
                for end in [alpha.0, alpha.1].into_iter().filter(|a| *a > 1.0 && *a < 24.0) {
                    let other = Foam { alpha: around(end, foam.alpha, by), ..foam };
                    assert_eq!(compared(&table, other, (0.0, 1)).index, named, "{} {other:?}", foam.name);
                }
            }
            assert!(f64::from(mu.0) < foam.mu_mpa && f64::from(mu.1) > foam.mu_mpa);
            assert!(f64::from(alpha.0) < foam.alpha && f64::from(alpha.1) > foam.alpha);
        }
    }

    /// ICF's acceptance is 3 % of its force at 4 mm; noise of 7 % alone differs by more.
    #[test]
    fn noise_that_was_measured_before_contact_does_not_make_a_soft_foam_a_stranger() {
        let bytes = factored_table();
        let table = Table::parse(&bytes).unwrap();
        let icf = LIBRARY[2];
        let noise_n = 0.07 * icf.force_n(4.0);
        let stranger = Foam { mu_mpa: 1.2 * icf.mu_mpa, ..icf };
        for seed in 0..50 {
            let named = compared(&table, icf, (noise_n, seed));
            assert!(f64::from(named.error_n) > 0.03 * icf.force_n(4.0), "{named:?}");
            assert_eq!(named.index, 2, "{named:?}");
            // A fifth more modulus is 8 % of the peak on average: refused under the same noise.
            assert_eq!(compared(&table, stranger, (noise_n, seed)).index, Recognition::NONE);
        }
        // Without noise the limit is the acceptance; noise that is no number, or negative, is none.
        let clean = compared(&table, icf, (0.0, 1));
        assert!((f64::from(clean.limit_n) / (0.03 * icf.force_n(4.0)) - 1.0).abs() < 1e-3, "{clean:?}");
        assert_eq!([f32::NAN, -1.0, f32::INFINITY].map(|noise_n| limit_n(0.1, noise_n, 200)), [0.1; 3]);
    }
}
