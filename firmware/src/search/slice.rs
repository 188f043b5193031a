//! Which part of a table is searched.

use super::brackets::Levels;
use super::{MAX_FACTORS, MAX_SUMS};
use protocol::lut::{Role, Table, axis_name};

/// Which part of a table is searched, worked out once a palpation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Slice {
    /// First stored column.
    first: usize,
    /// Stored columns.
    width: usize,
    /// The factor axis.
    levels: Option<Levels>,
    /// Values of the factor axis; 1 without one.
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
            levels: None,
            factor_count: 1,
            inner: 1,
            height_mm,
            rate_mm_s: rate_of_slice,
        };
        if let Some(axis) = table.factor() {
            slice.factor_count = axis.len();
            slice.levels = Some(Levels::new(axis.values())?);
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

    /// Length of the axis that runs fastest through the sums.
    pub(super) const fn inner(&self) -> usize {
        self.inner
    }

    /// The factor axis, if there is one.
    pub(super) const fn levels(&self) -> Option<&Levels> {
        self.levels.as_ref()
    }

    /// True if `index` lies on the edge of the grid, along axes that have more than one value.
    pub(super) fn at_edge(&self, index: usize) -> bool {
        let (slow, fast) = (index / self.inner, index % self.inner);
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
