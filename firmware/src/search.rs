//! Variance search over the table (thesis Eq. 17): the running sum of absolute differences between measured and
//! tabulated force, over every column of the height slice, one depth step a tick.
//!
//! With a factor axis the columns of a row are multiples of one shape, and the sums of all of them follow from two additions a row and sample
//! (`brackets`); columns that are stored one by one are summed one by one.

mod brackets;
mod slice;

pub use slice::{NoSlice, Shapes, Slice, Tolerance};

use brackets::Bracket;
use core::ops::Range;
use protocol::lut::Table;

/// Most columns of a slice times factors: the thesis' 900 fit.
pub const MAX_SUMS: usize = 1024;

/// Most values of the factor axis, and most columns of a slice that differ in shape.
pub const MAX_FACTORS: usize = 64;

/// Most brackets: a row of n factors has n + 1.
const MAX_BRACKETS: usize = MAX_SUMS + MAX_FACTORS;

/// Running sums.
#[derive(Debug, Clone)]
pub struct Search {
    /// Row by row with a factor axis; else the sums themselves, N, two in each.
    brackets: [Bracket; MAX_BRACKETS],
    /// Bracket of every row's last sample.
    at: [u8; MAX_FACTORS],
    /// What the least sum of every row is at least: sums only grow.
    bounds_n: [f32; MAX_FACTORS],
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
        Search { brackets: [[0.0; 2]; MAX_BRACKETS], at: [0; MAX_FACTORS], bounds_n: [0.0; MAX_FACTORS], samples: 0 }
    }

    /// Forgets everything.
    pub fn reset(&mut self) {
        *self = Search::new();
    }

    /// Samples summed.
    pub const fn samples(&self) -> u16 {
        self.samples
    }

    /// Adds one sample; does nothing for a depth the table does not reach or a force that is not a number. All samples between two resets
    /// must be of the same slice.
    pub fn step(&mut self, table: &Table<'_>, slice: &Slice, depth_mm: f32, force_n: f32) {
        let Some(position) = table.locate(depth_mm) else {
            return;
        };
        if !force_n.is_finite() {
            return;
        }
        let forces = table.forces_n(position, slice.columns());
        match slice.levels() {
            Some(levels) => levels.add(&mut self.brackets, &mut self.at, forces, force_n),
            None => {
                for (sum, f) in self.brackets.as_flattened_mut().iter_mut().zip(forces) {
                    *sum += (f - force_n).abs();
                }
            }
        }
        self.samples = self.samples.saturating_add(1);
    }

    /// The sums of every line of the grid along its fastest axis: `see(number of the line, its sums)`.
    fn each_line(&self, slice: &Slice, lines: Range<usize>, mut see: impl FnMut(usize, &[f32])) {
        let Some(levels) = slice.levels() else {
            let sums = self.brackets.as_flattened().get(..slice.len()).unwrap_or(&[]);
            let lines = sums.chunks_exact(slice.inner()).enumerate().take(lines.end).skip(lines.start);
            return lines.for_each(|(number, line)| see(number, line));
        };
        let mut sums = [0.0; MAX_FACTORS];
        let rows = self.brackets.chunks_exact(levels.brackets()).take(slice.columns().len());
        for (number, row) in rows.enumerate().take(lines.end).skip(lines.start) {
            see(number, levels.sums(row, &mut sums));
        }
    }

    /// Mean absolute difference of the best sum so far, N; 0 before the first sample.
    ///
    /// With a factor axis only those rows are worked out whose least sum may be the least of all. A sum only grows, so what a row had before is a bound
    /// of what it has now: for the telemetry of every tick that is two or three rows of thirty.
    pub fn error_n(&mut self, slice: &Slice) -> f32 {
        if self.samples == 0 {
            return 0.0;
        }
        let mut best = f32::INFINITY;
        if let Some(rows) = slice.levels().map(|_| slice.columns().len().min(MAX_FACTORS)) {
            while let Some((row, bound)) = self.bounds_n.get(..rows).map(least).filter(|(_, bound)| *bound < best) {
                let mut sum = bound;
                self.each_line(slice, row..row + 1, |_, line| sum = least(line).1);
                best = lower(best, sum);
                if let Some(slot) = self.bounds_n.get_mut(row) {
                    // Not asked again: it is not below the best.
                    *slot = sum;
                }
            }
        } else {
            self.each_line(slice, 0..usize::MAX, |_, line| best = lower(best, least(line).1));
        }
        best / f32::from(self.samples)
    }

    /// Best, runner-up and margin; `None` before the first sample, or if the samples were so large that no sum is a number.
    pub fn found(&self, slice: &Slice) -> Option<Found> {
        if self.samples == 0 {
            return None;
        }
        let mut best = (0, 0, f32::INFINITY);
        let mut leasts = [f32::INFINITY; MAX_FACTORS];
        self.each_line(slice, 0..usize::MAX, |number, line| {
            let (place, sum) = least(line);
            if sum < best.2 {
                best = (number, place, sum);
            }
            if let Some(slot) = leasts.get_mut(number) {
                *slot = sum;
            }
        });
        let (slow, fast, sum) = best;
        if !sum.is_finite() {
            return None;
        }
        let far = |number: usize| number.abs_diff(slow) > 1;
        let mut runner_up = f32::INFINITY;
        for (number, sum) in leasts.iter().enumerate() {
            if far(number) {
                runner_up = lower(runner_up, *sum);
            }
        }
        // The lines around the best one without its neighbours; and lines that there was no room for.
        self.each_line(slice, slow.saturating_sub(1)..slow + 2, |_, line| {
            let parts = [line.get(..fast.saturating_sub(1)), line.get(fast + 2..)];
            for part in parts.into_iter().flatten() {
                runner_up = lower(runner_up, least(part).1);
            }
        });
        self.each_line(slice, MAX_FACTORS..usize::MAX, |number, line| {
            if far(number) {
                runner_up = lower(runner_up, least(line).1);
            }
        });
        if !runner_up.is_finite() {
            runner_up = sum;
        }
        let (index, samples) = (slow * slice.inner() + fast, f32::from(self.samples));
        Some(Found {
            index,
            error_n: sum / samples,
            runner_up_error_n: runner_up / samples,
            margin: margin(sum, runner_up),
            at_edge: slice.at_edge(index),
        })
    }
}

/// Place and value of the least of some sums, the first of equal ones; infinite for none.
fn least(sums: &[f32]) -> (usize, f32) {
    let mut best = (0, f32::INFINITY);
    for (i, sum) in sums.iter().enumerate() {
        if *sum < best.1 {
            best = (i, *sum);
        }
    }
    best
}

/// The lower of two sums; `f32::min` is a call on the board.
fn lower(a: f32, b: f32) -> f32 {
    if b < a { b } else { a }
}

/// `1 - best / runner_up`, 0 if both are zero.
pub fn margin(best: f32, runner_up: f32) -> f32 {
    if runner_up > 0.0 { 1.0 - best / runner_up } else { 0.0 }
}

#[cfg(test)]
mod tests;
