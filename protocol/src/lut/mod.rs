//! The look-up table (LUT): force over depth for a grid of parameters, as bytes.
//!
//! One file serves the board's flash, the host's disk and the link. It is read in place: [`Table::parse`]
//! checks everything once (magic, version, lengths, both CRCs, axes, offsets, finiteness) and after
//! that no access can fail, and every force is a finite number.
//!
//! # Form
//! *Rows* are depths, *columns* parameter combinations; row r holds the force of every column at depth r
//! side by side, which is the order a search reads them in, one depth a tick (thesis Fig. 15).
//! Forces are `u16` counts times a scale of their column, so a soft column is as finely resolved as a stiff one.
//!
//! A parameter that force is proportional to need not be sampled: an axis of role [`Role::Factor`] lists
//! values that multiply the stored columns. With mu as factor the thesis' 900 columns are 30
//! stored ones ("30-row form"); with mu as an ordinary column axis all 900 are stored ("900-column form").
//! Both read alike.
//!
//! # Layout, version 2, little-endian
//! | at | type | what |
//! |---|---|---|
//! | 0 | 8 bytes | magic `PALPLUT\0` |
//! | 8 | u16 | version |
//! | 10 | u16 | length of this header: 96 |
//! | 12 | u32 | length of the whole table |
//! | 16 | u32 | CRC-32 of everything after the header |
//! | 20 | u32 | CRC-32 of the header with this field zero |
//! | 24 | 16 bytes | hash: SHA-256 of everything after the header, first 16 bytes |
//! | 40 | 3 x f32 | error bound: discretisation, interpolation, quantisation, relative to a curve's peak force |
//! | 52 | u8, u8 | number of axes, of library materials |
//! | 54 | u16 | zero (version 1: points of a display curve) |
//! | 56 | u32, u32 | rows, stored columns |
//! | 64 | u32 | offset of the axes: 32 bytes each |
//! | 68 | u32 | offset of the column scales: f32 each, N per count |
//! | 72 | u32 | offset of the counts: u16, row by row |
//! | 76 | u32 | offset of the library: 80 bytes a material |
//! | 80 | u32, u32 | offset and length of the provenance, UTF-8 |
//! | 88 | 8 bytes | zero |
//!
//! An axis is: name (12 bytes), unit (8), role (u8), scale (u8), count (u16), offset of its f32 values (u32), zero (u32).
//!
//! A material is:
//! | at | type | what |
//! |---|---|---|
//! | 0 | 16 bytes | name |
//! | 16 | 3 x f32 | mu MPa, alpha, height mm |
//! | 28 | f32 | N per count of the force curve |
//! | 32 | 2 x f32 | N and mm per count of the display curve |
//! | 40 | f32 | acceptance |
//! | 44 | u32 | offset of its force counts, u16 a row |
//! | 48 | u32 | offset of its display curve: u16 counts of the force of every node, then of the shaft position, then, if there is a coil curve, of the current |
//! | 52 | f32 | rate mm/s; 0: any rate |
//! | 56 | f32 | A per count of the coil current; 0: no coil curve |
//! | 60 | f32 | error bound of the current, A |
//! | 64 | 2 x f32 | reachable: forces, N, between which the magnet can make what is wanted |
//! | 72 | u16 | nodes of the display curve, 2 to 256 |
//! | 74 | 6 bytes | zero |
//!
//! Shaft and current stand on the same nodes. Their forces rise from 0, no current is beyond
//! [`CURRENT_MAX_A`], and what is reachable is a stretch of the curve.
//!
//! # Version 1
//! is still read. Its materials have 64 bytes: the same to the rate, then zero. Its display curves have the shaft position only, at 1,
//! 2, ... steps of force: the steps stand in the place of N per count, their number in the header. The board then displays with the
//! actuator only.

mod axis;
mod between;
mod bytes;
mod display;
mod error;
mod library;
mod reader;
#[cfg(any(test, feature = "std"))]
mod writer;

pub use axis::{Axis, Role, Scale};
pub use between::{Between, mixed};
pub use display::{CoilLimits, Current};
pub use error::TableError;
pub use library::Material;
pub use reader::{Checked, DepthPosition, ErrorBound, Table};
#[cfg(any(test, feature = "std"))]
pub use writer::{AxisSpec, CoilSpec, DisplaySpec, MaterialSpec, TableSpec, WriteError};

/// First bytes of every table.
pub const MAGIC: [u8; 8] = *b"PALPLUT\0";

/// Version of the layout that is written; all from 1 on are read.
pub const VERSION: u16 = 2;

/// Length of the header, bytes. It is written to flash last: without it there is no table.
pub const HEADER_LEN: usize = 96;

/// Length of an axis record, bytes.
pub const AXIS_LEN: usize = 32;

/// Length of a library record of a version of the layout, bytes.
const fn material_len(version: u16) -> usize {
    if version == 1 { 64 } else { 80 }
}

/// Most axes of a table.
pub const MAX_AXES: usize = 8;

/// Most force nodes of a display curve.
pub const MAX_NODES: usize = 256;

/// Largest coil current of a curve, A: the thesis' measurements end there (Table 6), and the board asks
/// for no more.
pub const CURRENT_MAX_A: f32 = 2.5;

/// True for a factor of counts that no count makes infinite: above zero, and finite times the largest count.
fn is_scale(scale: f32) -> bool {
    scale > 0.0 && (scale * f32::from(u16::MAX)).is_finite()
}

/// Names of the axes that the board's search looks for.
pub mod axis_name {
    /// Depth after contact, mm: the rows.
    pub const DEPTH: &str = "depth";
    /// Rate of the indentation, mm/s: the slowest column axis of a table of relaxing materials, followed by the height. A table
    /// without it serves every rate. Readers that do not know it refuse such a table, because height is not its slowest axis.
    pub const RATE: &str = "rate";
    /// Height of the specimen, mm: the slowest column axis but for the rate, if there is one.
    pub const HEIGHT: &str = "height";
    /// Exponent of the one-term Hyperfoam.
    pub const ALPHA: &str = "alpha";
    /// Shear modulus of the one-term Hyperfoam, MPa.
    pub const MU: &str = "mu";
}
