//! Writer: from curves in N to a table. Host only.

use super::axis::{Role, Scale};
use super::reader::ErrorBound;
use super::{AXIS_LEN, HEADER_LEN, MAGIC, MATERIAL_LEN, Table, TableError, VERSION};
use crate::frame::CRC32;
use sha2::{Digest, Sha256};

/// An axis to write.
#[derive(Debug, Clone, PartialEq)]
pub struct AxisSpec {
    /// Name, at most 12 ASCII characters.
    pub name: String,
    /// Unit, at most 8 ASCII characters; empty for a pure number.
    pub unit: String,
    /// What it spans.
    pub role: Role,
    /// How it is spaced.
    pub scale: Scale,
    /// Values, finite and rising.
    pub values: Vec<f64>,
}

/// A library material to write.
#[derive(Debug, Clone, PartialEq)]
pub struct MaterialSpec {
    /// Name, at most 16 ASCII characters.
    pub name: String,
    /// Shear modulus, MPa.
    pub mu_mpa: f64,
    /// Exponent.
    pub alpha: f64,
    /// Height of the specimen, mm.
    pub height_mm: f64,
    /// Mean absolute difference up to which a palpation counts as this material, fraction of the peak force.
    pub acceptance: f64,
    /// Indentation force at every row, N.
    pub force_n: Vec<f64>,
    /// Force between points of the display curve, N.
    pub display_step_n: f64,
    /// Displacement of the display at 1, 2, ... steps of force, mm.
    pub displacement_mm: Vec<f64>,
}

/// A table to write.
#[derive(Debug, Clone, PartialEq)]
pub struct TableSpec {
    /// Axes: depth (rows) first, then column axes, slowest first; a factor axis anywhere after depth.
    pub axes: Vec<AxisSpec>,
    /// Force of each stored column at each row, N: `columns[column][row]`, columns in the order of the axes, last axis fastest.
    pub columns: Vec<Vec<f64>>,
    /// Library; all display curves have the same number of points.
    pub library: Vec<MaterialSpec>,
    /// Largest relative error of the finite elements.
    pub discretisation: f64,
    /// Largest relative error of interpolation between solves.
    pub interpolation: f64,
    /// Where the curves come from: model, mesh, engine version.
    pub provenance: String,
}

/// Why a table cannot be written.
#[derive(Debug, Clone, PartialEq)]
pub enum WriteError {
    /// A name or unit is too long, empty or not ASCII.
    BadName {
        /// The text.
        text: String,
        /// Bytes it may have.
        limit: usize,
    },
    /// A curve has another number of points than its axis.
    WrongLength {
        /// Which curve.
        what: String,
        /// Points found.
        found: usize,
        /// Points expected.
        expected: usize,
    },
    /// A value is negative or not finite, or a curve is zero everywhere.
    BadValue {
        /// Which curve.
        what: String,
        /// The value.
        value: f64,
    },
    /// The finished bytes break a rule of the layout.
    Layout(TableError),
}

impl core::fmt::Display for WriteError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            WriteError::BadName { text, limit } => {
                write!(f, "name `{text}` must be ASCII of 1 to {limit} characters")
            }
            WriteError::WrongLength {
                what,
                found,
                expected,
            } => {
                write!(f, "{what} has {found} values, expected {expected}")
            }
            WriteError::BadValue { what, value } => {
                write!(
                    f,
                    "{what}: {value} is not a finite number >= 0, or the whole curve is zero"
                )
            }
            WriteError::Layout(error) => error.fmt(f),
        }
    }
}

impl core::error::Error for WriteError {}

impl TableSpec {
    /// The table's bytes. They have passed [`Table::parse`]; the same spec gives the same bytes.
    ///
    /// # Errors
    /// [`WriteError`] names what does not fit the layout.
    pub fn to_bytes(&self) -> Result<Vec<u8>, WriteError> {
        let rows = self.axes.first().map_or(0, |a| a.values.len());
        let points = self.library.first().map_or(0, |m| m.displacement_mm.len());
        let mut out = vec![0u8; HEADER_LEN];
        let mut quantisation = 0f64;

        let axes_at = out.len();
        let mut values_at = axes_at + self.axes.len() * AXIS_LEN;
        for axis in &self.axes {
            put_name(&mut out, &axis.name, 12)?;
            put_unit(&mut out, &axis.unit)?;
            out.extend([axis.role as u8, axis.scale as u8]);
            out.extend((axis.values.len() as u16).to_le_bytes());
            out.extend((values_at as u32).to_le_bytes());
            out.extend([0; 4]);
            values_at += axis.values.len() * 4;
        }
        for value in self.axes.iter().flat_map(|a| &a.values) {
            out.extend((*value as f32).to_le_bytes());
        }

        let scales_at = out.len();
        let mut counts = Vec::with_capacity(self.columns.len());
        for (number, column) in self.columns.iter().enumerate() {
            let (scale, column) =
                quantise(&format!("column {number}"), column, rows, &mut quantisation)?;
            out.extend(scale.to_le_bytes());
            counts.push(column);
        }
        let counts_at = out.len();
        for row in 0..rows {
            for column in &counts {
                out.extend(column[row].to_le_bytes());
            }
        }

        let library_at = out.len();
        let mut curves_at = library_at + self.library.len() * MATERIAL_LEN;
        let mut curves = Vec::new();
        for material in &self.library {
            let (n_per_count, force) =
                quantise(&material.name, &material.force_n, rows, &mut quantisation)?;
            // A display curve is felt, not compared: its rounding stays out of the force bound.
            let what = format!("display curve of {}", material.name);
            let (mm_per_count, display) =
                quantise(&what, &material.displacement_mm, points, &mut 0.0)?;
            put_name(&mut out, &material.name, 16)?;
            for value in [material.mu_mpa, material.alpha, material.height_mm] {
                out.extend((value as f32).to_le_bytes());
            }
            for value in [
                n_per_count,
                material.display_step_n as f32,
                mm_per_count,
                material.acceptance as f32,
            ] {
                out.extend(value.to_le_bytes());
            }
            out.extend((curves_at as u32).to_le_bytes());
            out.extend(((curves_at + rows * 2) as u32).to_le_bytes());
            out.extend([0; 12]);
            curves_at += (rows + points) * 2;
            curves.extend(force.into_iter().chain(display));
        }
        out.extend(curves.into_iter().flat_map(u16::to_le_bytes));

        let provenance_at = out.len();
        out.extend(self.provenance.as_bytes());
        let bound = ErrorBound {
            discretisation: self.discretisation as f32,
            interpolation: self.interpolation as f32,
            quantisation: quantisation as f32,
        };
        let offsets = [
            axes_at,
            scales_at,
            counts_at,
            library_at,
            provenance_at,
            self.provenance.len(),
        ];
        self.put_header(&mut out, bound, rows, points, offsets);
        Table::parse(&out).map_err(WriteError::Layout)?;
        Ok(out)
    }

    fn put_header(
        &self,
        out: &mut [u8],
        bound: ErrorBound,
        rows: usize,
        points: usize,
        offsets: [usize; 6],
    ) {
        let total = out.len() as u32;
        let (header, payload) = out.split_at_mut(HEADER_LEN);
        let mut put = |at: usize, bytes: &[u8]| header[at..at + bytes.len()].copy_from_slice(bytes);
        put(0, &MAGIC);
        put(8, &VERSION.to_le_bytes());
        put(10, &(HEADER_LEN as u16).to_le_bytes());
        put(12, &total.to_le_bytes());
        put(16, &CRC32.checksum(payload).to_le_bytes());
        put(24, &Sha256::digest(&*payload)[..16]);
        put(40, &bound.discretisation.to_le_bytes());
        put(44, &bound.interpolation.to_le_bytes());
        put(48, &bound.quantisation.to_le_bytes());
        put(52, &[self.axes.len() as u8, self.library.len() as u8]);
        put(54, &(points as u16).to_le_bytes());
        put(56, &(rows as u32).to_le_bytes());
        put(60, &(self.columns.len() as u32).to_le_bytes());
        for (i, offset) in offsets.iter().enumerate() {
            put(64 + 4 * i, &(*offset as u32).to_le_bytes());
        }
        let crc = CRC32.checksum(&header[..]);
        header[20..24].copy_from_slice(&crc.to_le_bytes());
    }
}

/// Scale and counts of a curve; raises `worst` to the largest rounding error relative to the curve's peak.
fn quantise(
    what: &str,
    curve: &[f64],
    expected: usize,
    worst: &mut f64,
) -> Result<(f32, Vec<u16>), WriteError> {
    if curve.len() != expected {
        return Err(WriteError::WrongLength {
            what: what.into(),
            found: curve.len(),
            expected,
        });
    }
    let peak = curve.iter().copied().fold(0.0, f64::max);
    if let Some(bad) = curve
        .iter()
        .copied()
        .find(|v| !v.is_finite() || *v < 0.0 || peak == 0.0)
    {
        return Err(WriteError::BadValue {
            what: what.into(),
            value: bad,
        });
    }
    let scale = (peak / f64::from(u16::MAX)) as f32;
    let counts: Vec<u16> = curve
        .iter()
        .map(|v| (v / f64::from(scale)).round() as u16)
        .collect();
    for (value, count) in curve.iter().zip(&counts) {
        *worst = worst.max((value - f64::from(*count) * f64::from(scale)).abs() / peak);
    }
    Ok((scale, counts))
}

fn put_name(out: &mut Vec<u8>, text: &str, len: usize) -> Result<(), WriteError> {
    if text.is_empty() {
        return Err(WriteError::BadName {
            text: text.into(),
            limit: len,
        });
    }
    put_padded(out, text, len)
}

fn put_unit(out: &mut Vec<u8>, text: &str) -> Result<(), WriteError> {
    put_padded(out, text, 8)
}

fn put_padded(out: &mut Vec<u8>, text: &str, len: usize) -> Result<(), WriteError> {
    if text.len() > len || !text.bytes().all(|b| (0x20..0x7f).contains(&b)) {
        return Err(WriteError::BadName {
            text: text.into(),
            limit: len,
        });
    }
    out.extend(text.bytes().chain(std::iter::repeat(0)).take(len));
    Ok(())
}
