//! The identification over a fixed series of samples, folded into hashes: equal on two machines only if every intermediate f32 is equal to the bit.
//!
//! Nothing of it is in the board's image. The host's tests hold the hashes; `tests/emulator` has the code for the board compute them.

use crate::kalman::indentation::Indentation;
use crate::kalman::{Bounding, Estimator, Filter, Model, Region};
use crate::profile::ProfileSearch;
use crate::search::{Search, Slice};
use crate::surface::Surface;
use nalgebra::{Vector2, Vector3};
use protocol::lut::{Table, axis_name};

/// Hashes (FNV-1a, 64 bit) of every intermediate result.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Fingerprint {
    /// Best sum, runner-up and margin of the variance search after every sample.
    pub search: u64,
    /// mu, alpha and misfit of the fast search after every sample.
    pub profile: u64,
    /// States and covariances of the filters of two states, one a bounding, after every sample.
    pub filter: u64,
    /// The same with the contact offset as third state, two passes.
    pub offset_filter: u64,
}

/// FNV-1a over the bits of numbers.
struct Hash(u64);

impl Hash {
    const fn new() -> Self {
        Hash(0xcbf2_9ce4_8422_2325)
    }

    fn fold(&mut self, x: f32) {
        for byte in x.to_bits().to_le_bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }

    fn fold_filter<const N: usize>(&mut self, filter: &Filter<N>) {
        filter.state.iter().for_each(|x| self.fold(*x));
        filter.covariance().iter().for_each(|x| self.fold(*x));
        filter.deviations().iter().for_each(|x| self.fold(*x));
    }
}

/// Samples of a press on the slice's own material in the middle of the grid, with noise from a linear congruential generator in whole
/// numbers: (depth mm, force N).
#[derive(Debug, Clone, Copy)]
pub struct Series<'a> {
    surface: Surface<'a>,
    mu_mpa: f32,
    alpha: f32,
    step_mm: f32,
    at: u16,
    seed: u32,
}

/// Samples of the series.
pub const SAMPLES: u16 = 100;

impl Iterator for Series<'_> {
    type Item = (f32, f32);

    fn next(&mut self) -> Option<(f32, f32)> {
        if self.at >= SAMPLES {
            return None;
        }
        self.at += 1;
        // Numerical Recipes' constants; the upper 16 bits as -1 to 1.
        self.seed = self.seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let noise = f32::from((self.seed >> 16) as u16) / 32_768.0 - 1.0;
        let depth_mm = self.step_mm * f32::from(self.at);
        let clean = self.surface.at(self.mu_mpa, self.alpha, depth_mm)?;
        Some((depth_mm, clean.force_n + 0.01 * noise))
    }
}

/// The series on a table's first slice; `None` for a table without surface.
pub fn series<'a>(table: &Table<'a>, slice: &Slice) -> Option<Series<'a>> {
    let surface = Surface::new(table, slice)?;
    let middle = |name| table.axis(name).map(|a| 0.5 * (a.value(0) + a.value(a.len() - 1)));
    Some(Series {
        surface,
        mu_mpa: middle(axis_name::MU)?,
        alpha: middle(axis_name::ALPHA)?,
        step_mm: table.depth_max_mm() / f32::from(SAMPLES),
        at: 0,
        seed: 1,
    })
}

/// Region of the table: mu, alpha.
pub fn region(table: &Table<'_>) -> Option<Region<2>> {
    let (mu, alpha) = (table.axis(axis_name::MU)?, table.axis(axis_name::ALPHA)?);
    Some(Region {
        low: Vector2::new(mu.value(0), alpha.value(0)),
        high: Vector2::new(mu.value(mu.len() - 1), alpha.value(alpha.len() - 1)),
    })
}

/// Fingerprint of the identification on a table's first slice.
pub fn fingerprint(table: &Table<'_>) -> Option<Fingerprint> {
    let slice = Slice::nearest(table, 0.0, 0.0)?;
    let (series, region) = (series(table, &slice)?, region(table)?);
    let (mut search, mut profile) = (Search::new(), ProfileSearch::new(table, &slice));
    let (mut searched, mut profiled) = (Hash::new(), Hash::new());
    for (depth_mm, force_n) in series {
        search.step(table, &slice, depth_mm, force_n);
        let found = search.found(&slice)?;
        for x in [found.index as f32, found.error_n, found.runner_up_error_n, found.margin] {
            searched.fold(x);
        }
        profile.step(table, depth_mm, force_n);
        let fitted = profile.found(table)?;
        for x in [fitted.mu_mpa, fitted.alpha, fitted.rms_n] {
            profiled.fold(x);
        }
    }
    let model = Indentation { surface: Surface::new(table, &slice)? };
    let mut filtered = Hash::new();
    for bounding in [
        Bounding::Projection,
        Bounding::Penalty { coefficient: 0.5 },
        Bounding::PrintedPenalty { coefficient: 0.5 },
        Bounding::NearestNeighbour,
        Bounding::Constrained { linearisations: 2 },
    ] {
        // From a corner, so that every bounding has something to bound.
        run(&mut Estimator::new(region.high, region, bounding), &model, series, &mut filtered);
    }
    let wide = |x: Vector2<f32>, offset_mm| Vector3::new(x[0], x[1], offset_mm);
    let region = Region { low: wide(region.low, -0.1), high: wide(region.high, 0.1) };
    let mut offset = Hash::new();
    let mut estimator = Estimator::new(region.middle(), region, Bounding::Constrained { linearisations: 1 });
    run(&mut estimator, &model, series, &mut offset);
    let reference = estimator.filter.state;
    let mut estimator = Estimator::new(reference, region, Bounding::Constrained { linearisations: 1 });
    for (depth_mm, force_n) in series {
        estimator.step_about(&model, &reference, depth_mm, force_n, 1e-4);
        offset.fold_filter(&estimator.filter);
    }
    Some(Fingerprint { search: searched.0, profile: profiled.0, filter: filtered.0, offset_filter: offset.0 })
}

fn run<M: Model<N, Input = f32>, const N: usize>(
    estimator: &mut Estimator<N>,
    model: &M,
    series: Series<'_>,
    hash: &mut Hash,
) {
    for (depth_mm, force_n) in series {
        estimator.step(model, depth_mm, force_n, 1e-4);
        hash.fold_filter(&estimator.filter);
    }
}
