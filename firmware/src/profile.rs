//! Fast search: one row an exponent, the best mu of each row in closed form, alpha between the rows.
//!
//! Force is proportional to mu, so the least squares of a row of shape f against the measured F are reached at `mu = sum f F / sum f^2` and leave
//! `sum F^2 - (sum f F)^2 / sum f^2`. Three running sums take the place of the thirty sums of Eq. 17 that a row of 30 values of mu has; mu is
//! continuous, and the parabola through the least misfit and its neighbours gives alpha between the rows.
//!
//! Eq. 17 sums absolute differences instead. With a continuous mu that is a weighted median of `F/f`, which needs all samples again for
//! every row; under white noise least squares has the smaller variance (by pi/2 for a median), so it is not done.

use crate::contact::LeastOnLine;
use crate::number::limit;
use crate::search::{MAX_FACTORS, Shapes, Slice};
use protocol::lut::{Table, axis_name};

/// Running sums of every row.
#[derive(Debug, Clone)]
pub struct ProfileSearch {
    /// `sum F^2`, N^2.
    total_n2: f32,
    /// `sum f^2` and `sum f F` of every shape.
    shapes: [(f32, f32); MAX_FACTORS],
    rows: Shapes,
    samples: u16,
}

/// Parameters between the columns of the grid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fitted {
    /// Shear modulus, MPa.
    pub mu_mpa: f32,
    /// Exponent.
    pub alpha: f32,
    /// Root of the mean square that is left, N.
    pub rms_n: f32,
    /// True if the least misfit lies at the edge of the grid in alpha, or mu beyond the grid.
    pub at_edge: bool,
}

impl ProfileSearch {
    /// Nothing summed, over the rows of a slice that differ in shape.
    pub fn new(table: &Table<'_>, slice: &Slice) -> Self {
        Self::over(slice.shapes(table, 0))
    }

    /// Nothing summed, over `rows`.
    pub const fn over(rows: Shapes) -> Self {
        ProfileSearch { total_n2: 0.0, shapes: [(0.0, 0.0); MAX_FACTORS], rows, samples: 0 }
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.rows.count.min(MAX_FACTORS)
    }

    /// True if there is no row to search.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Samples summed.
    pub const fn samples(&self) -> u16 {
        self.samples
    }

    /// Adds one sample. At and above the surface every shape is zero; a depth beyond the table or a force that is no number adds nothing.
    pub fn step(&mut self, table: &Table<'_>, depth_mm: f32, force_n: f32) {
        let position = table.locate(depth_mm);
        if !force_n.is_finite() || (position.is_none() && !(depth_mm <= 0.0)) {
            return;
        }
        self.samples = self.samples.saturating_add(1);
        self.total_n2 += force_n * force_n;
        let Some(position) = position else {
            return;
        };
        let forces = table.forces_n(position, self.rows.columns());
        // Without a stride the columns lie side by side, and the loop has nothing to count.
        if self.rows.stride == 1 {
            add(&mut self.shapes, forces, force_n);
        } else {
            add(&mut self.shapes, forces.step_by(self.rows.stride), force_n);
        }
    }

    /// Squares left by shape number `i` at its best amplitude, N^2.
    fn misfit_n2(&self, i: usize) -> Option<f32> {
        let (ff, fm) = self.shapes.get(..self.len())?.get(i)?;
        (*ff > 0.0 && *fm > 0.0).then(|| self.total_n2 - fm * fm / ff)
    }

    /// Best amplitude of shape number `i`.
    fn amplitude(&self, i: usize) -> Option<f32> {
        let (ff, fm) = self.shapes.get(..self.len())?.get(i)?;
        (*ff > 0.0).then(|| fm / ff)
    }

    /// The least misfit along the shapes, which are in the order of alpha: place (a fraction between shapes) and value, N^2. The parabola
    /// makes it smooth in the contact height, where a plain minimum would have a corner for every shape.
    pub fn least(&self) -> (f32, f32) {
        let mut line = LeastOnLine::new(0.0, 1.0);
        for i in 0..self.len() {
            line.put(self.misfit_n2(i).unwrap_or(self.total_n2));
        }
        let (place, misfit_n2) = line.result();
        (limit(place, 0.0, self.len().saturating_sub(1) as f32), misfit_n2)
    }

    /// mu and alpha by least squares so far: mu from the amplitude, alpha from the parabola through the least misfit and its neighbours.
    /// `None` before the first sample in contact, or for a table without these axes.
    pub fn found(&self, table: &Table<'_>) -> Option<Fitted> {
        let (place, misfit_n2) = self.least();
        let below = place as usize;
        let above = (below + 1).min(self.len().saturating_sub(1));
        let weight = place - below as f32;
        let between = |value: &dyn Fn(usize) -> Option<f32>| {
            let (low, high) = (value(below)?, value(above)?);
            Some(low + weight * (high - low))
        };
        let column = |i: usize| self.rows.first + i * self.rows.stride;
        let unit_mpa = |i: usize| match table.factor() {
            Some(_) => Some(1.0),
            None => table.column_value(column(i), axis_name::MU),
        };
        let alpha = between(&|i| table.column_value(column(i), axis_name::ALPHA))?;
        let mu_mpa = between(&|i| Some(unit_mpa(i)? * self.amplitude(i)?))?;
        let mus = table.axis(axis_name::MU)?;
        let mu_inside = mu_mpa >= mus.value(0) && mu_mpa <= mus.value(mus.len().saturating_sub(1));
        let best = (place + 0.5) as usize;
        let alpha_inside = self.len() == 1 || (best > 0 && best + 1 < self.len());
        // A misfit below zero is rounding.
        let rms_n = crate::number::sqrt(limit(misfit_n2, 0.0, f32::MAX) / f32::from(self.samples.max(1)));
        Some(Fitted { mu_mpa, alpha, rms_n, at_edge: !(mu_inside && alpha_inside) })
    }
}

fn add(sums: &mut [(f32, f32); MAX_FACTORS], forces: impl Iterator<Item = f32>, force_n: f32) {
    for ((ff, fm), f) in sums.iter_mut().zip(forces) {
        *ff += f * f;
        *fm += f * force_n;
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;
    use crate::search::Search;
    use crate::testbed::{expanded_table, factored_table, shape_mm2};

    /// A foam between the columns, in both forms of the table.
    #[test]
    fn it_finds_mu_and_alpha_between_the_columns_where_the_search_finds_the_nearest() {
        let (mu, alpha) = (0.0731, 9.3);
        let mut found = vec![];
        for bytes in [factored_table(), expanded_table(19.05)] {
            let table = Table::parse(&bytes).unwrap();
            let slice = Slice::nearest(&table, 19.05, 2.0).unwrap();
            let (mut fast, mut search) = (ProfileSearch::new(&table, &slice), Search::new());
            assert_eq!(fast.found(&table), None);
            for i in 1..=100 {
                let depth = 0.04 * f64::from(i);
                let force = mu * shape_mm2(alpha, 19.05, depth);
                fast.step(&table, depth as f32, force as f32);
                search.step(&table, &slice, depth as f32, force as f32);
            }
            let fitted = fast.found(&table).unwrap();
            assert!((f64::from(fitted.mu_mpa) / mu - 1.0).abs() < 5e-3, "{fitted:?}");
            assert!((f64::from(fitted.alpha) - alpha).abs() < 0.1 && !fitted.at_edge, "{fitted:?}");
            assert!(f64::from(fitted.rms_n) < 1e-3 * mu * shape_mm2(alpha, 19.05, 4.0), "{fitted:?}");
            let (mu_grid, _) = slice.parameters(&table, search.found(&slice).unwrap().index);
            // The grid's steps in mu are a factor 1.25.
            assert!((f64::from(mu_grid) / mu).ln().abs() < 0.25, "{mu_grid}");
            found.push(fitted);
        }
        // Misfits are differences of f32 sums, 1e-7 of the sum of squares; half a per cent of mu, made up for by alpha, changes them as little.
        assert!((found[0].mu_mpa / found[1].mu_mpa - 1.0).abs() < 1e-2, "{found:?}");
    }

    #[test]
    fn samples_outside_the_table_and_strange_forces_add_nothing() {
        let bytes = factored_table();
        let table = Table::parse(&bytes).unwrap();
        let slice = Slice::nearest(&table, 12.7, 2.0).unwrap();
        let mut fast = ProfileSearch::new(&table, &slice);
        for (depth, force) in [(4.5, 1.0), (f32::NAN, 1.0), (1.0, f32::NAN), (1.0, f32::INFINITY)] {
            fast.step(&table, depth, force);
        }
        assert_eq!((fast.samples(), fast.found(&table)), (0, None));
    }
}
