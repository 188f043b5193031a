//! The nearest library material: the same sum of absolute differences (Eq. 17) over the library's own curves, each at
//! its own best contact offset.
//!
//! A library curve is compared at several contact offsets because the contact point of a single palpation is known to
//! some hundredths of a millimetre only, and a shift of that size changes a steep curve more than two materials differ.

use crate::search::margin;
use protocol::lut::{DepthPosition, Table};
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
};

/// Least mean absolute difference of every material so far.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Comparison {
    errors_n: [f32; MAX_MATERIALS],
    /// Depth of the deepest sample at the middle offset, mm.
    pub deepest_mm: f32,
}

impl Default for Comparison {
    fn default() -> Self {
        Self::new()
    }
}

impl Comparison {
    /// Nothing compared.
    pub const fn new() -> Self {
        Comparison { errors_n: [f32::INFINITY; MAX_MATERIALS], deepest_mm: 0.0 }
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
            let mean_n = sum_n / f32::from(count);
            if count > 0 && mean_n < *error_n {
                *error_n = mean_n;
            }
        }
    }

    /// Nearest material and runner-up. The nearest is named only if its error is within its acceptance, a fraction of its
    /// own force at the deepest sample (its peak, for a palpation of full depth); error, runner-up and margin are given either way.
    pub fn result(&self, table: &Table<'_>) -> Recognition {
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
        let accepted = nearest.1 <= material.acceptance * reached_n;
        let alone = !runner_up.1.is_finite();
        Recognition {
            index: if accepted { nearest.0 } else { Recognition::NONE },
            error_n: nearest.1,
            runner_up: runner_up.0,
            runner_up_error_n: if alone { 0.0 } else { runner_up.1 },
            margin: if alone { 0.0 } else { margin(nearest.1, runner_up.1) },
        }
    }
}
