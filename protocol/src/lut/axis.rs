//! Axes of a table.

use super::bytes::{f32_at, name_at, u16_at, u32_at};
use super::{AXIS_LEN, TableError};

/// What an axis spans.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum Role {
    /// The rows: depth.
    Row = 0,
    /// Stored columns.
    Column = 1,
    /// Values that multiply the stored columns.
    Factor = 2,
}

/// How the values of an axis are spaced, for interpolation and drawing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum Scale {
    /// Evenly.
    Linear = 0,
    /// Evenly in the logarithm.
    Logarithmic = 1,
    /// As listed.
    Listed = 2,
}

/// One axis, borrowed from the table.
#[derive(Debug, Clone, Copy)]
pub struct Axis<'a> {
    /// Name, e.g. `depth`.
    pub name: &'a str,
    /// Unit, e.g. `mm`; empty for a pure number.
    pub unit: &'a str,
    /// What it spans.
    pub role: Role,
    /// How it is spaced.
    pub scale: Scale,
    values: &'a [u8],
}

impl<'a> Axis<'a> {
    /// Reads and checks axis number `axis`; values must be finite and strictly rising.
    pub(super) fn parse(data: &'a [u8], axes_at: usize, axis: u8) -> Result<Self, TableError> {
        let bad = |rule| TableError::BadAxis { axis, rule };
        let at = axes_at + usize::from(axis) * AXIS_LEN;
        let name = name_at(data, at, 12).filter(|n| !n.is_empty()).ok_or(bad("name is not printable ASCII"))?;
        let unit = name_at(data, at + 12, 8).ok_or(bad("unit is not printable ASCII"))?;
        let role = match data.get(at + 20) {
            Some(0) => Role::Row,
            Some(1) => Role::Column,
            Some(2) => Role::Factor,
            _ => return Err(bad("unknown role")),
        };
        let scale = match data.get(at + 21) {
            Some(0) => Scale::Linear,
            Some(1) => Scale::Logarithmic,
            Some(2) => Scale::Listed,
            _ => return Err(bad("unknown scale")),
        };
        let count = usize::from(u16_at(data, at + 22));
        let from = u32_at(data, at + 24) as usize;
        let values = from
            .checked_add(count * 4)
            .filter(|_| from >= super::HEADER_LEN)
            .and_then(|end| data.get(from..end))
            .ok_or(bad("values lie outside the table"))?;
        let parsed = Axis { name, unit, role, scale, values };
        if count == 0 {
            return Err(bad("no values"));
        }
        let mut previous = f32::NEG_INFINITY;
        for value in parsed.values() {
            if !value.is_finite() || value <= previous {
                return Err(bad("values are not finite and strictly rising"));
            }
            previous = value;
        }
        Ok(parsed)
    }

    /// Number of values, at least one.
    pub fn len(&self) -> usize {
        self.values.len() / 4
    }

    /// Never true; here because `len` is.
    pub fn is_empty(&self) -> bool {
        self.values.is_empty()
    }

    /// Value number `i`; past the end the last one.
    pub fn value(&self, i: usize) -> f32 {
        f32_at(self.values, i.min(self.len() - 1) * 4)
    }

    /// All values, rising.
    pub fn values(&self) -> impl ExactSizeIterator<Item = f32> + use<'a> {
        self.values.chunks_exact(4).map(|b| f32_at(b, 0))
    }

    /// Number of the value nearest to `x`; the lower one of two equally near. NaN gives 0.
    pub fn nearest(&self, x: f32) -> usize {
        let mut best = (0, f32::INFINITY);
        for (i, value) in self.values().enumerate() {
            let distance = (value - x).abs();
            if distance < best.1 {
                best = (i, distance);
            }
        }
        best.0
    }
}
