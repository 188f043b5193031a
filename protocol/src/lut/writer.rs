//! Writer: from curves in N to a table. Host only.

use super::axis::{Role, Scale};
use super::reader::ErrorBound;
use super::{AXIS_LEN, HEADER_LEN, MAGIC, Table, TableError, VERSION, material_len};
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

impl AxisSpec {
    /// An axis of its name, its unit, what it spans and how it is spaced.
    pub fn new(name: &str, unit: &str, role: Role, scale: Scale, values: impl Into<Vec<f64>>) -> Self {
        Self { name: name.into(), unit: unit.into(), role, scale, values: values.into() }
    }
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
    /// Rate the curve belongs to, mm/s: 0, or a value of the rate axis.
    pub rate_mm_s: f64,
    /// Indentation force at every row, N.
    pub force_n: Vec<f64>,
    /// How it is displayed.
    pub display: DisplaySpec,
}

/// A display curve to write.
#[derive(Debug, Clone, PartialEq)]
pub struct DisplaySpec {
    /// Force of the finger at every node, N: 2 to [`super::MAX_NODES`], rising from 0.
    pub force_n: Vec<f64>,
    /// Shaft position at every node, mm.
    pub shaft_mm: Vec<f64>,
    /// Control curve of the coil; without it the actuator displays alone.
    pub coil: Option<CoilSpec>,
}

impl DisplaySpec {
    /// A curve without coil: shaft positions, mm, at 1, 2, ... steps of force, N; 0 without force.
    pub fn even(step_n: f64, shaft_mm: &[f64]) -> Self {
        let force_n = (0..=shaft_mm.len()).map(|i| step_n * i as f64).collect();
        DisplaySpec { force_n, shaft_mm: [&[0.0], shaft_mm].concat(), coil: None }
    }
}

/// A control curve of the coil to write.
#[derive(Debug, Clone, PartialEq)]
pub struct CoilSpec {
    /// Current at every node, A, 0 to [`super::CURRENT_MAX_A`].
    pub current_a: Vec<f64>,
    /// Forces, N, between which the magnet can make what is wanted.
    pub reachable_n: (f64, f64),
    /// Largest error of the current, A, without that of rounding to counts, which is added.
    pub bound_a: f64,
}

/// A table to write.
#[derive(Debug, Clone, PartialEq)]
pub struct TableSpec {
    /// Axes: depth (rows) first, then column axes, slowest first; a factor axis anywhere after depth.
    pub axes: Vec<AxisSpec>,
    /// Force of each stored column at each row, N: `columns[column][row]`, columns in the order of the axes, last axis fastest.
    pub columns: Vec<Vec<f64>>,
    /// Library.
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
            WriteError::WrongLength { what, found, expected } => {
                write!(f, "{what} has {found} values, expected {expected}")
            }
            WriteError::BadValue { what, value } => {
                write!(f, "{what}: {value} is not a finite number >= 0, or the whole curve is zero")
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
            let (scale, column) = quantise(&format!("column {number}"), column, rows, &mut quantisation)?;
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
        let mut curves_at = library_at + self.library.len() * material_len(VERSION);
        let mut curves = Vec::new();
        for material in &self.library {
            let counts = material.put(&mut out, curves_at, rows, &mut quantisation)?;
            curves_at += 2 * counts.len();
            curves.extend(counts);
        }
        out.extend(curves.into_iter().flat_map(u16::to_le_bytes));

        let provenance_at = out.len();
        out.extend(self.provenance.as_bytes());
        let bound = ErrorBound {
            discretisation: self.discretisation as f32,
            interpolation: self.interpolation as f32,
            quantisation: quantisation as f32,
        };
        let offsets = [axes_at, scales_at, counts_at, library_at, provenance_at, self.provenance.len()];
        self.put_header(&mut out, bound, rows, offsets);
        Table::parse(&out).map_err(WriteError::Layout)?;
        Ok(out)
    }

    fn put_header(&self, out: &mut [u8], bound: ErrorBound, rows: usize, offsets: [usize; 6]) {
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
        put(56, &(rows as u32).to_le_bytes());
        put(60, &(self.columns.len() as u32).to_le_bytes());
        for (i, offset) in offsets.iter().enumerate() {
            put(64 + 4 * i, &(*offset as u32).to_le_bytes());
        }
        let crc = CRC32.checksum(&header[..]);
        header[20..24].copy_from_slice(&crc.to_le_bytes());
    }
}

impl MaterialSpec {
    /// Appends the record, whose counts will stand at `counts_at`; returns these counts.
    fn put(
        &self,
        out: &mut Vec<u8>,
        counts_at: usize,
        rows: usize,
        quantisation: &mut f64,
    ) -> Result<Vec<u16>, WriteError> {
        let DisplaySpec { force_n, shaft_mm, coil } = &self.display;
        let nodes = force_n.len();
        let (n_per_count, force) = quantise(&self.name, &self.force_n, rows, quantisation)?;
        // A display curve is felt, not compared: its rounding stays out of the force bound.
        let mut rounding = 0.0;
        let mut curve = |what: &str, values: &[f64]| {
            let what = format!("{what} of {}", self.name);
            rounding = 0.0;
            // Without an unlike value there is nothing to scale: of a curve of zeros every count is 0.
            let zero = values.len() == nodes && values.iter().all(|v| *v == 0.0);
            let made =
                if zero { (f32::MIN_POSITIVE, vec![0; nodes]) } else { quantise(&what, values, nodes, &mut rounding)? };
            Ok::<_, WriteError>((made.0, made.1, rounding))
        };
        let (n_per_node, nodes_n, _) = curve("forces of the display curve", force_n)?;
        let (mm_per_count, shaft, _) = curve("shaft positions", shaft_mm)?;
        let mut counts = [force, nodes_n, shaft].concat();
        let mut coil_fields = [0.0; 4];
        if let Some(CoilSpec { current_a, reachable_n: (from, to), bound_a }) = coil {
            let (a_per_count, current, rounding) = curve("coil currents", current_a)?;
            let most_a = current_a.iter().copied().fold(0.0, f64::max);
            coil_fields = [a_per_count, (bound_a + rounding * most_a) as f32, *from as f32, *to as f32];
            counts.extend(current);
        }
        put_name(out, &self.name, 16)?;
        for value in [self.mu_mpa, self.alpha, self.height_mm] {
            out.extend((value as f32).to_le_bytes());
        }
        for value in [n_per_count, n_per_node, mm_per_count, self.acceptance as f32] {
            out.extend(value.to_le_bytes());
        }
        out.extend((counts_at as u32).to_le_bytes());
        out.extend(((counts_at + 2 * rows) as u32).to_le_bytes());
        out.extend((self.rate_mm_s as f32).to_le_bytes());
        out.extend(coil_fields.into_iter().flat_map(f32::to_le_bytes));
        out.extend((nodes as u16).to_le_bytes());
        out.extend([0; 6]);
        Ok(counts)
    }
}

/// Scale and counts of a curve; raises `worst` to the largest rounding error relative to the curve's peak.
fn quantise(what: &str, curve: &[f64], expected: usize, worst: &mut f64) -> Result<(f32, Vec<u16>), WriteError> {
    if curve.len() != expected {
        return Err(WriteError::WrongLength { what: what.into(), found: curve.len(), expected });
    }
    let peak = curve.iter().copied().fold(0.0, f64::max);
    if let Some(bad) = curve.iter().copied().find(|v| !v.is_finite() || *v < 0.0 || peak == 0.0) {
        return Err(WriteError::BadValue { what: what.into(), value: bad });
    }
    let scale = (peak / f64::from(u16::MAX)) as f32;
    let counts: Vec<u16> = curve.iter().map(|v| (v / f64::from(scale)).round() as u16).collect();
    for (value, count) in curve.iter().zip(&counts) {
        *worst = worst.max((value - f64::from(*count) * f64::from(scale)).abs() / peak);
    }
    Ok((scale, counts))
}

fn put_name(out: &mut Vec<u8>, text: &str, len: usize) -> Result<(), WriteError> {
    if text.is_empty() {
        return Err(WriteError::BadName { text: text.into(), limit: len });
    }
    put_padded(out, text, len)
}

fn put_unit(out: &mut Vec<u8>, text: &str) -> Result<(), WriteError> {
    put_padded(out, text, 8)
}

fn put_padded(out: &mut Vec<u8>, text: &str, len: usize) -> Result<(), WriteError> {
    if text.len() > len || !text.bytes().all(|b| (0x20..0x7f).contains(&b)) {
        return Err(WriteError::BadName { text: text.into(), limit: len });
    }
    out.extend(text.bytes().chain(std::iter::repeat(0)).take(len));
    Ok(())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::panic)]
    use super::*;
    use crate::lut::axis_name;

    /// Two heights, three exponents, four depths, mu as factor, one material: `force = alpha * depth / height`.
    pub(crate) fn small() -> TableSpec {
        let axis =
            |name: &str, unit: &str, role, values: &[f64]| AxisSpec::new(name, unit, role, Scale::Linear, values);
        let depths = [0.5, 1.0, 1.5, 2.0];
        let columns =
            [10.0, 20.0].iter().flat_map(|h| [1.0, 2.0, 4.0].map(|a| depths.map(|d| a * d / h).to_vec())).collect();
        TableSpec {
            axes: vec![
                axis(axis_name::DEPTH, "mm", Role::Row, &depths),
                axis(axis_name::HEIGHT, "mm", Role::Column, &[10.0, 20.0]),
                axis(axis_name::ALPHA, "", Role::Column, &[1.0, 2.0, 4.0]),
                axis(axis_name::MU, "MPa", Role::Factor, &[0.1, 0.2]),
            ],
            columns,
            library: vec![MaterialSpec {
                name: "foam".into(),
                mu_mpa: 0.2,
                alpha: 2.0,
                height_mm: 10.0,
                acceptance: 0.05,
                rate_mm_s: 0.0,
                force_n: vec![0.1, 0.2, 0.3, 0.4],
                display: DisplaySpec {
                    force_n: vec![0.0, 1.0, 2.0, 3.0],
                    shaft_mm: vec![0.0, 2.0, 3.0, 3.5],
                    coil: Some(CoilSpec {
                        current_a: vec![0.0, 1.0, 1.5, 1.75],
                        reachable_n: (0.5, 2.5),
                        bound_a: 0.125,
                    }),
                },
            }],
            discretisation: 0.002,
            interpolation: 0.001,
            provenance: "force = alpha depth / height".into(),
        }
    }

    #[test]
    fn what_is_written_is_read() {
        let bytes = small().to_bytes().unwrap();
        let table = Table::parse(&bytes).unwrap();
        assert_eq!((table.rows(), table.columns(), table.material_count()), (4, 6, 1));
        assert_eq!(table.slice(0, 1), 3..6);
        assert_eq!(table.column_value(5, axis_name::ALPHA), Some(4.0));
        assert_eq!(table.column_value(5, axis_name::HEIGHT), Some(20.0));
        assert_eq!(table.factor().unwrap().name, axis_name::MU);
        // The rule is linear in depth, so interpolation adds nothing to the rounding to counts.
        let worst = table.error_bound().quantisation;
        assert!(worst > 0.0 && worst <= 0.5 / 65535.0 * 1.01, "{worst}");
        for depth in [0.1f32, 0.5, 0.75, 1.9, 2.0] {
            let position = table.locate(depth).unwrap();
            for column in 0..6 {
                let expected = table.column_value(column, axis_name::ALPHA).unwrap() * depth
                    / table.column_value(column, axis_name::HEIGHT).unwrap();
                let peak = expected / depth * 2.0;
                assert!((table.force_n(position, column) - expected).abs() <= 2.0 * worst * peak + 1e-6);
            }
            let side_by_side: Vec<f32> = table.forces_n(position, 0..6).collect();
            for (column, force) in side_by_side.iter().enumerate() {
                assert!((force - table.force_n(position, column)).abs() <= 1e-6, "both reads agree");
            }
        }
        assert_eq!(table.locate(0.0), None);
        assert_eq!(table.locate(2.1), None);
        assert_eq!(table.locate(f32::NAN), None);
        let foam = table.material(0).unwrap();
        assert!((foam.force_n(table.locate(1.25).unwrap()) - 0.25).abs() < 1e-5);
        assert!((foam.shaft_mm(0.5) - 1.0).abs() < 1e-4, "below the first point, from zero");
        assert!((foam.shaft_mm(2.5) - 3.25).abs() < 1e-4);
        assert!((foam.shaft_mm(99.0) - 3.5).abs() < 1e-4);
        assert_eq!(foam.shaft_mm(f32::NAN), 0.0);
        assert!((foam.display_force_max_n() - 3.0).abs() < 1e-5);
        assert!(table.material(1).is_none());
    }

    #[test]
    fn a_coil_curve_is_read_between_its_nodes_and_held_where_the_magnet_cannot_follow() {
        let bytes = small().to_bytes().unwrap();
        let foam = Table::parse(&bytes).unwrap().material(0).unwrap();
        let limits = foam.coil().unwrap();
        assert_eq!(limits.reachable_n, (0.5, 2.5));
        // Rounding to counts is half of 1.75 A in 65,535.
        assert!(limits.bound_a > 0.125 && limits.bound_a < 0.125 + 1.4e-5, "{}", limits.bound_a);
        let told = [(0.5, 0.5, false), (1.0, 1.0, false), (1.5, 1.25, false), (2.5, 1.625, false)];
        let held = [(0.25, 0.5, true), (2.6, 1.625, true), (9.0, 1.625, true), (f32::INFINITY, 1.625, true)];
        let none = [(0.0, 0.0, false), (-1.0, 0.0, false), (f32::NAN, 0.0, false)];
        for (force_n, a, unreachable) in told.into_iter().chain(held).chain(none) {
            let current = foam.current(force_n).unwrap();
            assert!((current.a - a).abs() < 2e-5, "{force_n} N: {current:?}");
            assert_eq!(current.unreachable, unreachable, "{force_n} N");
        }
    }

    #[test]
    fn a_material_without_coil_curve_has_no_current_and_may_be_displayed() {
        let mut spec = small();
        spec.library[0].display = DisplaySpec::even(1.0, &[2.0, 3.0, 3.5]);
        let bytes = spec.to_bytes().unwrap();
        let foam = Table::parse(&bytes).unwrap().material(0).unwrap();
        assert_eq!((foam.current(1.0), foam.coil()), (None, None));
        assert!((foam.shaft_mm(2.5) - 3.25).abs() < 1e-4);
        // A magnet, or an actuator, that has nothing to do.
        let coil = CoilSpec { current_a: vec![0.0; 4], reachable_n: (0.0, 3.0), bound_a: 0.0 };
        let idle = DisplaySpec { coil: Some(coil), shaft_mm: vec![0.0; 4], ..DisplaySpec::even(1.0, &[0.0; 3]) };
        spec.library[0].display = idle;
        let bytes = spec.to_bytes().unwrap();
        let foam = Table::parse(&bytes).unwrap().material(0).unwrap();
        assert_eq!((foam.shaft_mm(2.0), foam.current(2.0).map(|c| c.a)), (0.0, Some(0.0)));
    }

    /// The small table with other bytes, both CRCs made right again.
    fn changed(bytes: &[u8], at: usize, to: &[u8]) -> Vec<u8> {
        let mut bytes = bytes.to_vec();
        bytes[at..at + to.len()].copy_from_slice(to);
        let payload = CRC32.checksum(&bytes[HEADER_LEN..]);
        bytes[16..20].copy_from_slice(&payload.to_le_bytes());
        bytes[20..24].fill(0);
        let header = CRC32.checksum(&bytes[..HEADER_LEN]);
        bytes[20..24].copy_from_slice(&header.to_le_bytes());
        bytes
    }

    #[test]
    fn what_breaks_a_rule_of_a_display_curve_is_refused_with_the_rule() {
        let bytes = small().to_bytes().unwrap();
        let offset = |at: usize| crate::lut::bytes::u32_at(&bytes, at) as usize;
        let record = offset(76);
        let nodes = offset(record + 48);
        let number = |field: usize, value: f32| changed(&bytes, record + field, &value.to_le_bytes());
        let count = |field: usize, value: u16| changed(&bytes, field, &value.to_le_bytes());
        let refused = [
            (count(record + 72, 1), "a display curve has 2 to 256 nodes"),
            (count(record + 72, 257), "a display curve has 2 to 256 nodes"),
            (count(record + 72, 256), "a curve lies outside the table"),
            (number(56, 2.6 / 65535.0), "a coil current is beyond 2.5 A"),
            (number(56, f32::NAN), "a coil current is beyond 2.5 A"),
            (number(56, -1e-6), "a coil current is beyond 2.5 A"),
            (number(56, 0.0), "limits of a coil curve that is not there"),
            (number(60, -0.1), "the error bound of the coil current is not 0 to 2.5 A"),
            (number(60, f32::INFINITY), "the error bound of the coil current is not 0 to 2.5 A"),
            (number(64, -0.1), "forces that are reachable are not a stretch of the display curve"),
            (number(64, 2.6), "forces that are reachable are not a stretch of the display curve"),
            (number(68, 3.1), "forces that are reachable are not a stretch of the display curve"),
            (number(68, f32::NAN), "forces that are reachable are not a stretch of the display curve"),
            (count(nodes, 1), "the first node of the display curve is not without force"),
            (count(nodes + 4, 1000), "forces of the display curve do not rise"),
            (number(32, f32::MAX), "a scale is so large that forces or displacements are not finite"),
        ];
        for (bytes, rule) in refused {
            assert_eq!(Table::parse(&bytes).unwrap_err(), TableError::BadMaterial { material: 0, rule });
        }
    }

    #[test]
    fn curves_that_do_not_fit_are_not_written() {
        let text = |change: fn(&mut MaterialSpec)| {
            let mut spec = small();
            change(&mut spec.library[0]);
            spec.to_bytes().unwrap_err().to_string()
        };
        assert_eq!(text(|m| m.display.shaft_mm.truncate(3)), "shaft positions of foam has 3 values, expected 4");
        let coil = |change: fn(&mut CoilSpec)| {
            let mut spec = small();
            spec.library[0].display.coil.as_mut().map(change);
            spec.to_bytes().unwrap_err().to_string()
        };
        assert_eq!(coil(|c| c.current_a[3] = 2.6), "table library material 0: a coil current is beyond 2.5 A");
        assert_eq!(
            coil(|c| c.current_a[3] = -0.1),
            "coil currents of foam: -0.1 is not a finite number >= 0, or the whole curve is zero"
        );
    }

    /// The small table at three rates, twice and thrice the force at the later ones.
    fn rated() -> TableSpec {
        let mut spec = small();
        let rates =
            AxisSpec { name: "rate".into(), unit: "mm/s".into(), values: vec![1.0, 2.0, 4.0], ..spec.axes[2].clone() };
        spec.axes.insert(1, rates);
        let once = spec.columns.clone();
        let times = |by: f64| once.iter().map(move |c| c.iter().map(|f| by * f).collect::<Vec<f64>>());
        spec.columns = [1.0, 2.0, 3.0].into_iter().flat_map(times).collect();
        spec
    }

    #[test]
    fn a_table_of_several_rates_has_a_slice_for_each_rate_and_height() {
        let bytes = rated().to_bytes().unwrap();
        let table = Table::parse(&bytes).unwrap();
        assert_eq!((table.slice(0, 0), table.slice(2, 1), table.slice(9, 9)), (0..3, 15..18, 15..18));
        assert_eq!(table.column_value(16, "rate"), Some(4.0));
        assert_eq!(table.column_value(16, "height"), Some(20.0));
        assert_eq!(table.column_value(16, "alpha"), Some(2.0));
        let force_n = table.row_force_n(1, 16);
        assert!((force_n - 3.0 * 2.0 / 20.0).abs() < 1e-5, "{force_n}");
        assert_eq!((table.row_force_n(4, 16), table.row_force_n(1, 18)), (0.0, 0.0), "past the end");
    }

    #[test]
    fn a_rate_out_of_place_is_refused_so_that_older_readers_refuse_every_table_with_rates() {
        let rule = |spec: &TableSpec| match spec.to_bytes() {
            Err(WriteError::Layout(TableError::BadAxis { rule, .. })) => rule,
            other => panic!("{other:?}"),
        };
        let mut late = rated();
        late.axes.swap(1, 2);
        assert!(rule(&late).contains("after the rate"), "{}", rule(&late));
        let mut alone = rated();
        alone.axes.remove(2);
        alone.columns.truncate(9);
        assert!(rule(&alone).contains("followed by the height"), "{}", rule(&alone));
        let mut standing = rated();
        standing.axes[1].values[0] = 0.0;
        assert!(rule(&standing).contains("above zero"), "{}", rule(&standing));
        // What the version before said of such a table: its height is axis 2.
        assert_ne!(rated().axes[1].name, axis_name::HEIGHT);
    }

    #[test]
    fn every_flipped_bit_and_every_truncation_is_refused() {
        let bytes = small().to_bytes().unwrap();
        for bit in 0..bytes.len() * 8 {
            let mut broken = bytes.clone();
            broken[bit / 8] ^= 1 << (bit % 8);
            assert!(Table::parse(&broken).is_err(), "bit {bit}");
        }
        for len in 0..bytes.len() {
            assert!(Table::parse(&bytes[..len]).is_err(), "length {len}");
        }
    }

    #[test]
    fn errors_say_what_was_found_and_expected() {
        let good = small().to_bytes().unwrap();
        let text = |bytes: &[u8]| Table::parse(bytes).unwrap_err().to_string();
        assert_eq!(text(b"ELF file, really"), "not a Palpate table: the first 8 bytes are not PALPLUT");
        assert_eq!(
            text(&good[..good.len() - 7]),
            format!("table truncated: {} bytes of {}", good.len() - 7, good.len())
        );
        let mut newer = good.clone();
        newer[8] = 9;
        assert_eq!(
            text(&newer),
            "table layout version 9, this build reads versions 1 to 2: make the table again with `palpate lut`"
        );

        let mut spec = small();
        spec.columns[2][1] = f64::NAN;
        assert_eq!(
            spec.to_bytes().unwrap_err().to_string(),
            "column 2: NaN is not a finite number >= 0, or the whole curve is zero"
        );
        let mut spec = small();
        spec.columns.pop();
        assert_eq!(spec.to_bytes().unwrap_err().to_string(), "table axes span 6 columns, the header says 5");
        let mut spec = small();
        spec.axes[0].values = vec![0.5, 1.0, 1.6, 2.0];
        assert_eq!(
            spec.to_bytes().unwrap_err().to_string(),
            "table axis 0: depths are not even steps from the surface"
        );
        let mut spec = small();
        spec.library[0].name = "a name that is far too long".into();
        assert_eq!(
            spec.to_bytes().unwrap_err().to_string(),
            "name `a name that is far too long` must be ASCII of 1 to 16 characters"
        );
    }

    proptest::proptest! {
        /// With both CRCs made right again, a changed table may be refused or read, but nothing panics.
        #[test]
        fn no_table_panics_the_reader(changes in proptest::collection::vec((0usize..2000, proptest::num::u8::ANY), 1..8)) {
            let mut bytes = small().to_bytes().unwrap();
            for (at, value) in changes {
                let at = 8 + at % (bytes.len() - 8);
                bytes[at] = value;
            }
            let payload = CRC32.checksum(&bytes[HEADER_LEN..]);
            let length = bytes.len() as u32;
            bytes[12..16].copy_from_slice(&length.to_le_bytes());
            bytes[16..20].copy_from_slice(&payload.to_le_bytes());
            bytes[20..24].fill(0);
            let header = CRC32.checksum(&bytes[..HEADER_LEN]);
            bytes[20..24].copy_from_slice(&header.to_le_bytes());
            if let Ok(table) = Table::parse(&bytes) {
                for step in 0..20 {
                    if let Some(position) = table.locate(step as f32 * 0.3) {
                        let all: Vec<f32> = table.forces_n(position, table.slice(0, step)).collect();
                        proptest::prop_assert_eq!(all.len(), table.slice(0, step).len());
                        for material in table.materials() {
                            let force_n = step as f32;
                            let _ = (material.force_n(position), material.shaft_mm(force_n));
                            if let Some(current) = material.current(force_n) {
                                proptest::prop_assert!((0.0..=crate::lut::CURRENT_MAX_A).contains(&current.a));
                            }
                        }
                    }
                }
            }
        }
    }
}
