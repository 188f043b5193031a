//! Variance search over the table (thesis Eq. 17): the running sum of absolute differences between measured and
//! tabulated force, over every column of the height slice, one depth step a tick.

use protocol::lut::{Role, Table, axis_name};

/// Most columns of a slice times factors: the thesis' 900 fit.
pub const MAX_SUMS: usize = 1024;

/// Most values of the factor axis.
pub const MAX_FACTORS: usize = 64;

/// Which part of a table is searched, worked out once a palpation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Slice {
    /// First stored column.
    first: usize,
    /// Stored columns.
    width: usize,
    /// Values of the factor axis; a single 1 without such an axis.
    factors: [f32; MAX_FACTORS],
    factor_count: usize,
    /// Length of the axis that runs fastest through the sums.
    inner: usize,
    /// Height of the slice, mm; 0 for a table without height axis.
    pub height_mm: f32,
    /// Rate of the slice, mm/s; 0 for a table without rate axis.
    pub rate_mm_s: f32,
}

/// How far a specimen and a rate may be from the slice that stands for them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tolerance {
    /// Height, mm.
    pub height_mm: f32,
    /// Rate, fraction of the slice's. Prony's force follows the logarithm of the rate: a tenth changes it by less than a tenth of the
    /// relaxing part's share.
    pub rate: f32,
}

impl Default for Tolerance {
    fn default() -> Self {
        Tolerance { height_mm: 1.0, rate: 0.1 }
    }
}

/// Why no slice of a table serves a palpation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NoSlice {
    /// More columns than this build searches.
    TooLarge,
    /// No slice is near the specimen's height.
    Height,
    /// No slice is near the rate.
    Rate,
}

impl Slice {
    /// The slice for a specimen and a rate.
    ///
    /// # Errors
    /// [`NoSlice`] if the nearest slice is farther than `tolerance`, or the table is too large. A height or rate that is not a number is
    /// near no slice.
    pub fn choose(table: &Table<'_>, specimen_mm: f32, rate_mm_s: f32, tolerance: &Tolerance) -> Result<Self, NoSlice> {
        let slice = Slice::nearest(table, specimen_mm, rate_mm_s).ok_or(NoSlice::TooLarge)?;
        if slice.rate_mm_s > 0.0 && !((slice.rate_mm_s - rate_mm_s).abs() <= tolerance.rate * slice.rate_mm_s) {
            return Err(NoSlice::Rate);
        }
        if slice.height_mm > 0.0 && !((slice.height_mm - specimen_mm).abs() <= tolerance.height_mm) {
            return Err(NoSlice::Height);
        }
        Ok(slice)
    }

    /// The slice nearest to a specimen's height and to a rate, however far both are; `None` if the table is larger than this build
    /// searches. A table without rates serves every rate.
    pub fn nearest(table: &Table<'_>, specimen_mm: f32, rate_mm_s: f32) -> Option<Self> {
        let place = |name: &str, x: f32| match table.axis(name) {
            Some(axis) if axis.role == Role::Column => {
                let index = axis.nearest(x);
                (index, axis.value(index))
            }
            _ => (0, 0.0),
        };
        let (height, height_mm) = place(axis_name::HEIGHT, specimen_mm);
        let (rate, rate_of_slice) = place(axis_name::RATE, rate_mm_s);
        let columns = table.slice(rate, height);
        let mut slice = Slice {
            first: columns.start,
            width: columns.len(),
            factors: [1.0; MAX_FACTORS],
            factor_count: 1,
            inner: 1,
            height_mm,
            rate_mm_s: rate_of_slice,
        };
        if let Some(axis) = table.factor() {
            slice.factor_count = axis.len();
            for (slot, value) in slice.factors.get_mut(..axis.len())?.iter_mut().zip(axis.values()) {
                *slot = value;
            }
            slice.inner = axis.len();
        } else if let Some(axis) = table.axes().filter(|a| a.role == Role::Column).last() {
            slice.inner = if axis.name == axis_name::HEIGHT { 1 } else { axis.len() };
        }
        let fits = slice.len() <= MAX_SUMS && !slice.is_empty() && slice.shapes(table, 0).count <= MAX_FACTORS;
        fits.then_some(slice)
    }

    /// Number of sums: columns times factors.
    pub const fn len(&self) -> usize {
        self.width * self.factor_count
    }

    /// True if nothing can be searched; never for a slice of [`Slice::nearest`].
    pub const fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Stored columns of the slice.
    pub const fn columns(&self) -> core::ops::Range<usize> {
        self.first..self.first + self.width
    }

    /// Stored columns that differ in shape and not only in amplitude. With mu as factor these are all columns; with mu as a column
    /// axis those of the same mu as sum number `index`.
    pub fn shapes(&self, table: &Table<'_>, index: usize) -> Shapes {
        let all = Shapes { first: self.first, stride: 1, count: self.width };
        if table.factor().is_some() || table.axis(axis_name::MU).is_none() {
            return all;
        }
        let fastest = table.axes().filter(|a| a.role == Role::Column).last();
        if fastest.is_some_and(|a| a.name == axis_name::MU) {
            let first = self.first + index % self.inner;
            Shapes { first, stride: self.inner, count: self.width / self.inner }
        } else {
            let first = self.first + index / self.inner * self.inner;
            Shapes { first, stride: 1, count: self.inner }
        }
    }

    /// mu (MPa) and alpha of sum number `index`; 0 for an axis the table does not have.
    pub fn parameters(&self, table: &Table<'_>, index: usize) -> (f32, f32) {
        let column = self.first + index / self.factor_count;
        let mu_mpa = match table.factor() {
            Some(axis) => axis.value(index % self.factor_count),
            None => table.column_value(column, axis_name::MU).unwrap_or(0.0),
        };
        (mu_mpa, table.column_value(column, axis_name::ALPHA).unwrap_or(0.0))
    }

    /// Place in the grid: slow and fast coordinate.
    const fn place(&self, index: usize) -> (usize, usize) {
        (index / self.inner, index % self.inner)
    }

    /// True if `index` lies on the edge of the grid, along axes that have more than one value.
    fn at_edge(&self, index: usize) -> bool {
        let (slow, fast) = self.place(index);
        let (slows, fasts) = (self.len() / self.inner, self.inner);
        let edge = |at: usize, n: usize| n > 1 && (at == 0 || at + 1 == n);
        edge(slow, slows) || edge(fast, fasts)
    }
}

/// Stored columns that differ in shape: `first`, `first + stride`, ...
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shapes {
    /// First column.
    pub first: usize,
    /// Distance between columns.
    pub stride: usize,
    /// Number of columns.
    pub count: usize,
}

impl Shapes {
    /// From the first to the last column, with those between that are left out by the stride.
    pub const fn columns(&self) -> core::ops::Range<usize> {
        self.first..self.first + self.count.saturating_sub(1) * self.stride + 1
    }
}

/// Running sums.
#[derive(Debug, Clone)]
pub struct Search {
    sums_n: [f32; MAX_SUMS],
    samples: u16,
}

impl Default for Search {
    fn default() -> Self {
        Self::new()
    }
}

/// Where the search stands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Found {
    /// Number of the best sum.
    pub index: usize,
    /// Its mean absolute difference, N.
    pub error_n: f32,
    /// Mean absolute difference of the best sum that is no neighbour of the best one in the grid (the eight around it
    /// differ from it by less than the grid resolves), N; equal to `error_n` if every sum is a neighbour.
    pub runner_up_error_n: f32,
    /// `1 - error_n / runner_up_error_n`.
    pub margin: f32,
    /// True if the best sum lies on the edge of the grid.
    pub at_edge: bool,
}

impl Search {
    /// Nothing summed.
    pub const fn new() -> Self {
        Search { sums_n: [0.0; MAX_SUMS], samples: 0 }
    }

    /// Forgets everything.
    pub fn reset(&mut self) {
        self.sums_n.fill(0.0);
        self.samples = 0;
    }

    /// Samples summed.
    pub const fn samples(&self) -> u16 {
        self.samples
    }

    /// Adds one sample; does nothing for a depth the table does not reach or a force that is not a number.
    pub fn step(&mut self, table: &Table<'_>, slice: &Slice, depth_mm: f32, force_n: f32) {
        let Some(position) = table.locate(depth_mm) else {
            return;
        };
        if !force_n.is_finite() {
            return;
        }
        let factors = slice.factors.get(..slice.factor_count).unwrap_or(&[]);
        let forces = table.forces_n(position, slice.columns());
        if factors.len() <= 1 {
            for (sum, f) in self.sums_n.iter_mut().zip(forces) {
                *sum += (f - force_n).abs();
            }
        } else {
            for (sums, f) in self.sums_n.chunks_exact_mut(factors.len()).zip(forces) {
                add_differences(sums, factors, f, force_n);
            }
        }
        self.samples = self.samples.saturating_add(1);
    }

    /// Mean absolute difference of the best sum so far, N; 0 before the first sample.
    pub fn error_n(&self, slice: &Slice) -> f32 {
        let least =
            self.sums_n.iter().take(slice.len()).fold(f32::INFINITY, |least, s| if *s < least { *s } else { least });
        if self.samples == 0 { 0.0 } else { least / f32::from(self.samples) }
    }

    /// Best, runner-up and margin; `None` before the first sample.
    pub fn found(&self, slice: &Slice) -> Option<Found> {
        if self.samples == 0 {
            return None;
        }
        let sums = self.sums_n.get(..slice.len())?;
        let mut best = (0, f32::INFINITY);
        for (i, sum) in sums.iter().enumerate() {
            if *sum < best.1 {
                best = (i, *sum);
            }
        }
        let (slow, fast) = slice.place(best.0);
        let mut runner_up = f32::INFINITY;
        for (i, sum) in sums.iter().enumerate() {
            let (s, f) = slice.place(i);
            let neighbour = s.abs_diff(slow) <= 1 && f.abs_diff(fast) <= 1;
            if !neighbour && *sum < runner_up {
                runner_up = *sum;
            }
        }
        if !runner_up.is_finite() {
            runner_up = best.1;
        }
        let samples = f32::from(self.samples);
        Some(Found {
            index: best.0,
            error_n: best.1 / samples,
            runner_up_error_n: runner_up / samples,
            margin: margin(best.1, runner_up),
            at_edge: slice.at_edge(best.0),
        })
    }
}

/// Adds the differences of one stored force times every factor. Each sum has its own operations, so both forms give the same bits.
#[inline]
fn add_differences(sums: &mut [f32], factors: &[f32], f: f32, force_n: f32) {
    if !cfg!(target_os = "none") {
        // A compiler that builds for speed makes vectors of this.
        for (sum, factor) in sums.iter_mut().zip(factors) {
            *sum += (factor * f - force_n).abs();
        }
        return;
    }
    // Five at a time, written out: the compiler does not unroll when it builds for size, and counting costs as much as adding.
    let (fives, rest) = sums.as_chunks_mut::<5>();
    let (factor_fives, factor_rest) = factors.as_chunks::<5>();
    for ([a, b, c, d, e], [fa, fb, fc, fd, fe]) in fives.iter_mut().zip(factor_fives) {
        *a += (fa * f - force_n).abs();
        *b += (fb * f - force_n).abs();
        *c += (fc * f - force_n).abs();
        *d += (fd * f - force_n).abs();
        *e += (fe * f - force_n).abs();
    }
    for (sum, factor) in rest.iter_mut().zip(factor_rest) {
        *sum += (factor * f - force_n).abs();
    }
}

/// `1 - best / runner_up`, 0 if both are zero.
pub fn margin(best: f32, runner_up: f32) -> f32 {
    if runner_up > 0.0 { 1.0 - best / runner_up } else { 0.0 }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;
    use crate::testbed::{LIBRARY, alphas, expanded_table, factored_table, mus, shape_mm2};

    fn searched(table: &Table<'_>, slice: &Slice, force: impl Fn(f64) -> f64) -> Search {
        let mut search = Search::new();
        for i in 1..=50 {
            let depth = 0.08 * f64::from(i);
            search.step(table, slice, depth as f32, force(depth) as f32);
        }
        search
    }

    #[test]
    fn a_column_of_the_grid_finds_itself_in_both_forms() {
        let (i, j, height) = (12, 20, 12.7);
        let force = |d: f64| mus()[j] * shape_mm2(alphas()[i], height, d);
        for bytes in [factored_table(), expanded_table(height)] {
            let table = Table::parse(&bytes).unwrap();
            let slice = Slice::nearest(&table, height as f32, 2.0).unwrap();
            assert_eq!(slice.len(), 900);
            let search = searched(&table, &slice, force);
            let found = search.found(&slice).unwrap();
            assert_eq!(found.index, i * 30 + j);
            let (mu, alpha) = slice.parameters(&table, found.index);
            assert!((f64::from(mu) - mus()[j]).abs() < 1e-6 && (f64::from(alpha) - alphas()[i]).abs() < 1e-5);
            // Interpolation between rows of 0.02 mm and rounding to 1/65535 of the peak.
            assert!(found.error_n < 1e-4 * force(4.0) as f32, "{}", found.error_n);
            assert_eq!(found.error_n, search.error_n(&slice));
            assert!(found.margin > 0.5 && !found.at_edge);
        }
    }

    #[test]
    fn sums_are_equation_17_over_all_columns() {
        let bytes = factored_table();
        let table = Table::parse(&bytes).unwrap();
        let slice = Slice::nearest(&table, 19.05, 2.0).unwrap();
        let search = searched(&table, &slice, |d| LIBRARY[1].force_n(d));
        for (index, sum) in search.sums_n.iter().enumerate().take(900).step_by(37) {
            let direct: f64 = (1..=50)
                .map(|k| 0.08 * f64::from(k))
                .map(|d| (mus()[index % 30] * shape_mm2(alphas()[index / 30], 19.05, d) - LIBRARY[1].force_n(d)).abs())
                .sum();
            // Quantisation of the table, 8e-6 of a column's peak a row, and f32 sums over 50 samples.
            let peak = mus()[index % 30] * shape_mm2(alphas()[index / 30], 19.05, 4.0);
            assert!((f64::from(*sum) - direct).abs() < 50.0 * 5e-5 * (peak + 5.0), "{index}: {sum} {direct}");
        }
    }

    #[test]
    fn runner_up_is_no_neighbour_and_the_edge_is_seen() {
        let bytes = factored_table();
        let table = Table::parse(&bytes).unwrap();
        let slice = Slice::nearest(&table, 25.0, 2.0).unwrap();
        assert!((slice.height_mm - 25.4).abs() < 1e-5);
        let search = searched(&table, &slice, |d| mus()[29] * shape_mm2(alphas()[0], 25.4, d));
        let found = search.found(&slice).unwrap();
        assert_eq!(found.index, 29);
        assert!(found.at_edge && found.runner_up_error_n > found.error_n);
    }

    #[test]
    fn depths_outside_the_table_and_strange_forces_add_nothing() {
        let bytes = factored_table();
        let table = Table::parse(&bytes).unwrap();
        let slice = Slice::nearest(&table, 12.7, 2.0).unwrap();
        let mut search = Search::new();
        for (depth, force) in
            [(0.0, 1.0), (-1.0, 1.0), (4.5, 1.0), (f32::NAN, 1.0), (1.0, f32::NAN), (1.0, f32::INFINITY)]
        {
            search.step(&table, &slice, depth, force);
        }
        assert_eq!(search.samples(), 0);
        assert_eq!(search.found(&slice), None);
    }
}
