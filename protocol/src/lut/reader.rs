//! Zero-copy reader: checks once, then cannot fail.

use core::ops::Range;

use super::axis::{Axis, Role};
use super::bytes::{array, f32_at, u16_at, u32_at};
use super::library::{Material, Place};
use super::{AXIS_LEN, HEADER_LEN, MAGIC, MAX_AXES, TableError, VERSION, axis_name, material_len};
use crate::frame::CRC32;

/// Error bound of a table, each relative to a curve's peak force.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ErrorBound {
    /// Finite elements against their own limit of fine meshes.
    pub discretisation: f32,
    /// Interpolation between solves.
    pub interpolation: f32,
    /// Rounding to counts.
    pub quantisation: f32,
}

impl ErrorBound {
    /// The three together, as a worst case.
    pub fn total(&self) -> f32 {
        self.discretisation + self.interpolation + self.quantisation
    }
}

/// A depth as a place between rows: the one interpolation of all curves over depth.
///
/// Rows are at `step, 2 step, ...`; depth zero has force zero and no row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DepthPosition {
    /// Number of the upper row.
    row: usize,
    /// Weight of the upper row, 0 to 1.
    weight: f32,
}

impl DepthPosition {
    /// Linear interpolation of a quantity that is `value(row)` at a row and zero at depth zero.
    pub fn interpolate(self, value: impl Fn(usize) -> f32) -> f32 {
        let lower = if self.row == 0 { 0.0 } else { value(self.row - 1) };
        lower + self.weight * (value(self.row) - lower)
    }
}

/// A checked table, borrowed from its bytes.
#[derive(Debug, Clone, Copy)]
pub struct Table<'a> {
    data: &'a [u8],
    axes_at: usize,
    axis_count: u8,
    rows: usize,
    columns: usize,
    scales: &'a [u8],
    counts: &'a [u8],
    library: Place,
    material_count: u8,
    provenance: &'a str,
    depth_step_mm: f32,
}

/// What [`Table::parse`] found, without the bytes: lets an owner of the bytes open the table again
/// at every tick without paying for its CRCs again.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Checked {
    len: usize,
    /// Both CRCs, as in the header.
    identity: [u8; 8],
    hash: [u8; 16],
    depth_step_mm: f32,
}

impl Checked {
    /// Hash of the table that was checked.
    pub const fn hash(&self) -> [u8; 16] {
        self.hash
    }

    /// Length of the table that was checked, bytes.
    pub const fn byte_len(&self) -> usize {
        self.len
    }

    /// Opens the table in `bytes`, which must begin with the table that was checked and must not have been
    /// written since. `None` if there are too few bytes or the CRCs in the header are not those of that table.
    pub fn open<'a>(&self, bytes: &'a [u8]) -> Option<Table<'a>> {
        let data = bytes.get(..self.len)?;
        if array::<8>(data, 16) != self.identity {
            return None;
        }
        let mut table = Table::sections(data).ok()?;
        table.depth_step_mm = self.depth_step_mm;
        Some(table)
    }
}

impl<'a> Table<'a> {
    /// Checks `bytes` and reads them in place. Bytes after the table's stated length are ignored (a flash slot
    /// is longer than its table).
    ///
    /// # Errors
    /// Every departure from the layout of [`super`], see [`TableError`].
    pub fn parse(bytes: &'a [u8]) -> Result<Self, TableError> {
        Table::sections(check_envelope(bytes)?)?.check_contents()
    }

    /// What [`Checked::open`] needs to open this table again.
    pub fn checked(&self) -> Checked {
        Checked {
            len: self.data.len(),
            identity: array(self.data, 16),
            hash: self.hash(),
            depth_step_mm: self.depth_step_mm,
        }
    }

    /// Finds the sections of a table whose envelope is sound; their contents are not looked at.
    fn sections(data: &'a [u8]) -> Result<Self, TableError> {
        let rows = u32_at(data, 56) as usize;
        let columns = u32_at(data, 60) as usize;
        let axis_count = data[52];
        let material_count = data[53];
        let version = u16_at(data, 8);
        let section = |name: &'static str, offset_at: usize, len: Option<usize>| {
            let from = u32_at(data, offset_at) as usize;
            len.and_then(|n| from.checked_add(n))
                .filter(|_| from >= HEADER_LEN)
                .and_then(|end| data.get(from..end))
                .ok_or(TableError::BadSection { section: name })
        };
        section("axes", 64, Some(usize::from(axis_count) * AXIS_LEN))?;
        section("library", 76, Some(usize::from(material_count) * material_len(version)))?;
        let provenance = section("provenance", 80, Some(u32_at(data, 84) as usize))?;
        Ok(Table {
            data,
            axes_at: u32_at(data, 64) as usize,
            axis_count,
            rows,
            columns,
            scales: section("scales", 68, columns.checked_mul(4))?,
            counts: section("counts", 72, columns.checked_mul(rows).and_then(|n| n.checked_mul(2)))?,
            library: Place {
                version,
                library_at: u32_at(data, 76) as usize,
                rows,
                points: usize::from(u16_at(data, 54)),
            },
            material_count,
            provenance: core::str::from_utf8(provenance)
                .map_err(|_| TableError::BadSection { section: "provenance" })?,
            depth_step_mm: 0.0,
        })
    }

    fn check_contents(mut self) -> Result<Self, TableError> {
        let bound = self.error_bound();
        if ![bound.discretisation, bound.interpolation, bound.quantisation].iter().all(|e| e.is_finite() && *e >= 0.0) {
            return Err(TableError::BadErrorBound);
        }
        self.depth_step_mm = self.check_axes()?;
        for (column, scale) in self.scales.chunks_exact(4).enumerate() {
            if !super::is_scale(f32_at(scale, 0)) {
                return Err(TableError::BadScale { column: column as u32 });
            }
        }
        for material in 0..self.material_count {
            Material::parse(self.data, &self.library, material)?.check(material)?;
        }
        Ok(self)
    }

    /// Rules of the axes; returns the step of the depth axis.
    fn check_axes(&self) -> Result<f32, TableError> {
        let bad = |axis, rule| TableError::BadAxis { axis, rule };
        if self.axis_count == 0 || usize::from(self.axis_count) > MAX_AXES {
            return Err(bad(self.axis_count, "a table has 1 to 8 axes"));
        }
        let mut product = 1u32;
        let mut factors = 0;
        let mut step = 0.0;
        let rated = self.axis(axis_name::RATE).is_some();
        for number in 0..self.axis_count {
            let axis = Axis::parse(self.data, self.axes_at, number)?;
            match (number, axis.role) {
                (0, Role::Row) => step = check_depth(&axis, self.rows)?,
                (0, _) => return Err(bad(0, "the first axis must be the rows")),
                (_, Role::Row) => return Err(bad(number, "only the first axis may be the rows")),
                (_, Role::Column) => {
                    check_place(number, &axis, rated)?;
                    product = product.saturating_mul(axis.len() as u32);
                }
                (_, Role::Factor) if factors == 0 && axis.value(0) > 0.0 => factors += 1,
                (_, Role::Factor) => {
                    return Err(bad(number, "at most one factor axis, with values above zero"));
                }
            }
        }
        if rated && self.axis(axis_name::HEIGHT).is_none() {
            return Err(bad(1, "a rate axis must be followed by the height"));
        }
        if product as usize != self.columns {
            return Err(TableError::ColumnsMismatch { axes: product, header: self.columns as u32 });
        }
        Ok(step)
    }

    /// The bytes of the table, without what follows it.
    pub fn bytes(&self) -> &'a [u8] {
        self.data
    }

    /// Identity: SHA-256 of everything after the header, first 16 bytes.
    pub fn hash(&self) -> [u8; 16] {
        array(self.data, 24)
    }

    /// Version of its layout.
    pub fn version(&self) -> u16 {
        self.library.version
    }

    /// The error bound that travels with the table.
    pub fn error_bound(&self) -> ErrorBound {
        ErrorBound {
            discretisation: f32_at(self.data, 40),
            interpolation: f32_at(self.data, 44),
            quantisation: f32_at(self.data, 48),
        }
    }

    /// Where the table comes from: model, mesh, engine version, for people.
    pub fn provenance(&self) -> &'a str {
        self.provenance
    }

    /// The axes: depth first, then column axes (slowest first) and the factor axis in any order.
    pub fn axes(&self) -> impl Iterator<Item = Axis<'a>> + use<'a> {
        let (data, at) = (self.data, self.axes_at);
        // Checked in `parse`, so none is left out here.
        (0..self.axis_count).filter_map(move |i| Axis::parse(data, at, i).ok())
    }

    /// The axis called `name`.
    pub fn axis(&self, name: &str) -> Option<Axis<'a>> {
        self.axes().find(|a| a.name == name)
    }

    /// The factor axis, if force is stored per unit of it.
    pub fn factor(&self) -> Option<Axis<'a>> {
        self.axes().find(|a| a.role == Role::Factor)
    }

    /// Number of depths.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Number of stored columns.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Stored columns that belong to value `rate` of the rate axis and value `height` of the height axis; an axis the table does not
    /// have, or a value past its end, counts as its last one.
    pub fn slice(&self, rate: usize, height: usize) -> Range<usize> {
        let mut columns = 0..self.columns;
        for (name, value) in [(axis_name::RATE, rate), (axis_name::HEIGHT, height)] {
            if let Some(axis) = self.axis(name).filter(|a| a.role == Role::Column) {
                let width = columns.len() / axis.len();
                let from = columns.start + value.min(axis.len() - 1) * width;
                columns = from..from + width;
            }
        }
        columns
    }

    /// Value of column axis `name` at stored column `column`.
    pub fn column_value(&self, column: usize, name: &str) -> Option<f32> {
        let mut stride = self.columns;
        for axis in self.axes().filter(|a| a.role == Role::Column) {
            stride /= axis.len();
            if axis.name == name {
                return Some(axis.value(column / stride % axis.len()));
            }
        }
        None
    }

    /// Distance between rows, mm.
    pub fn depth_step_mm(&self) -> f32 {
        self.depth_step_mm
    }

    /// Depth of the last row, mm.
    pub fn depth_max_mm(&self) -> f32 {
        self.depth_step_mm * self.rows as f32
    }

    /// Place of a depth between the rows; `None` for a depth that is not in `(0, depth_max_mm]`.
    pub fn locate(&self, depth_mm: f32) -> Option<DepthPosition> {
        // One thousandth of a step beyond the last row is rounding, not depth.
        let at = depth_mm / self.depth_step_mm;
        if !(at > 0.0 && at <= self.rows as f32 + 1e-3) {
            return None;
        }
        let row = (at as usize).min(self.rows - 1);
        Some(DepthPosition { row, weight: (at - row as f32).min(1.0) })
    }

    /// Force of one stored column at row number `row` (depth `(row + 1) * depth_step_mm`), N, or N per unit of the factor axis; 0 past
    /// the end.
    #[inline]
    pub fn row_force_n(&self, row: usize, column: usize) -> f32 {
        if column >= self.columns {
            return 0.0;
        }
        f32::from(u16_at(self.counts, (row * self.columns + column) * 2)) * f32_at(self.scales, column * 4)
    }

    /// Force of one stored column, N (N per unit of the factor axis where there is one).
    pub fn force_n(&self, position: DepthPosition, column: usize) -> f32 {
        position.interpolate(|row| f32::from(u16_at(self.counts, (row * self.columns + column) * 2)))
            * f32_at(self.scales, column * 4)
    }

    /// Forces of stored columns side by side, as [`Table::force_n`]: what a search reads in one tick.
    pub fn forces_n(&self, position: DepthPosition, columns: Range<usize>) -> impl Iterator<Item = f32> + use<'a> {
        let row = |row: usize| {
            let from = (row * self.columns + columns.start) * 2;
            self.counts.get(from..from + columns.len() * 2).unwrap_or(&[])
        };
        let upper = row(position.row);
        // At depth zero every force is zero: weight the first row alone.
        let (lower, zero) = if position.row == 0 { (upper, 0.0) } else { (row(position.row - 1), 1.0) };
        let scales = self.scales.get(columns.start * 4..columns.end * 4).unwrap_or(&[]);
        let (w_upper, w_lower) = (position.weight, zero * (1.0 - position.weight));
        // Pairs and quadruples of bytes of known length: no bounds are checked inside the search's loop.
        let pairs = |bytes: &'a [u8]| bytes.as_chunks::<2>().0.iter().map(|c| f32::from(u16::from_le_bytes(*c)));
        pairs(upper)
            .zip(pairs(lower))
            .zip(scales.as_chunks::<4>().0)
            .map(move |((u, l), s)| (w_upper * u + w_lower * l) * f32::from_le_bytes(*s))
    }

    /// Number of library materials.
    pub fn material_count(&self) -> usize {
        usize::from(self.material_count)
    }

    /// Library material number `index`.
    pub fn material(&self, index: usize) -> Option<Material<'a>> {
        let index = u8::try_from(index).ok().filter(|i| *i < self.material_count)?;
        Material::parse(self.data, &self.library, index).ok()
    }

    /// All library materials.
    pub fn materials(&self) -> impl Iterator<Item = Material<'a>> + use<'a> {
        let table = *self;
        (0..self.material_count()).filter_map(move |i| table.material(i))
    }
}

/// Magic, version, lengths, CRCs; returns exactly the table's bytes.
fn check_envelope(bytes: &[u8]) -> Result<&[u8], TableError> {
    if bytes.len() >= 8 && bytes[..8] != MAGIC {
        return Err(TableError::NotATable);
    }
    let found = bytes.len() as u32;
    if bytes.len() < HEADER_LEN {
        return Err(TableError::Truncated { expected: HEADER_LEN as u32, found });
    }
    let version = u16_at(bytes, 8);
    if !(1..=VERSION).contains(&version) {
        return Err(TableError::WrongVersion { found: version });
    }
    let mut header: [u8; HEADER_LEN] = array(bytes, 0);
    header[20..24].fill(0);
    if CRC32.checksum(&header) != u32_at(bytes, 20) || usize::from(u16_at(bytes, 10)) != HEADER_LEN {
        return Err(TableError::HeaderCorrupt);
    }
    let expected = u32_at(bytes, 12);
    let data = bytes.get(..expected as usize).ok_or(TableError::Truncated { expected, found })?;
    let payload =
        data.get(HEADER_LEN..).ok_or(TableError::Truncated { expected: HEADER_LEN as u32, found: expected })?;
    if CRC32.checksum(payload) != u32_at(bytes, 16) {
        return Err(TableError::PayloadCorrupt);
    }
    Ok(data)
}

/// Rate, then height are the slowest column axes. With a rate there must be a height: that is what makes readers from before the
/// rate axis refuse the table instead of searching all rates at once.
fn check_place(number: u8, axis: &Axis<'_>, rated: bool) -> Result<(), TableError> {
    let bad = |rule| TableError::BadAxis { axis: number, rule };
    match (number, axis.name == axis_name::RATE, axis.name == axis_name::HEIGHT) {
        (1, true, _) if axis.value(0) > 0.0 => Ok(()),
        (_, true, _) => Err(bad("rate must be the slowest column axis, with values above zero")),
        (1, _, true) if !rated => Ok(()),
        (2, _, true) if rated => Ok(()),
        (_, _, true) => Err(bad("height must be the slowest column axis, after the rate if there is one")),
        _ => Ok(()),
    }
}

/// The depth axis is even, starts one step below the surface, and has as many values as there are rows.
fn check_depth(axis: &Axis<'_>, rows: usize) -> Result<f32, TableError> {
    let bad = |rule| TableError::BadAxis { axis: 0, rule };
    if axis.len() != rows {
        return Err(bad("number of values is not the number of rows"));
    }
    let step = axis.value(rows - 1) / rows as f32;
    // f32 values written from f64 are off by rounding only; a thousandth of a step is far above it.
    let even = axis.values().enumerate().all(|(i, v)| (v - step * (i + 1) as f32).abs() <= 1e-3 * step);
    if !(step > 0.0 && even) {
        return Err(bad("depths are not even steps from the surface"));
    }
    Ok(step)
}
