//! The library: named materials with their own force curve and display curve.

use super::bytes::{f32_at, name_at, u16_at, u32_at};
use super::display::{CoilLimits, Current, DisplayCurve};
use super::reader::DepthPosition;
use super::{TableError, material_len};

/// One named material, borrowed from the table.
#[derive(Debug, Clone, Copy)]
pub struct Material<'a> {
    /// Name, at most 16 ASCII characters.
    pub name: &'a str,
    /// Shear modulus, MPa.
    pub mu_mpa: f32,
    /// Exponent.
    pub alpha: f32,
    /// Height of the specimen the curve belongs to, mm.
    pub height_mm: f32,
    /// Mean absolute difference up to which a palpation counts as this material, fraction of
    /// the curve's peak force.
    pub acceptance: f32,
    /// Rate the curve belongs to, mm/s; 0 for a material whose force does not depend on it. A relaxing material has an entry of its own,
    /// of the same name, for every rate of the table.
    pub rate_mm_s: f32,
    n_per_count: f32,
    curve: &'a [u8],
    display: DisplayCurve<'a>,
}

/// Where a table's materials are, and how they are laid out.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    pub version: u16,
    pub library_at: usize,
    pub rows: usize,
    /// Points of a display curve, in version 1.
    pub points: usize,
}

impl<'a> Material<'a> {
    /// Reads a record; what is in its curves is looked at by [`Material::check`].
    pub(super) fn parse(data: &'a [u8], place: &Place, material: u8) -> Result<Self, TableError> {
        let bad = |rule| TableError::BadMaterial { material, rule };
        let at = place.library_at + usize::from(material) * material_len(place.version);
        let counts = |offset_at: usize, n: usize| {
            let from = u32_at(data, offset_at) as usize;
            from.checked_add(n * 2)
                .filter(|_| from >= super::HEADER_LEN)
                .and_then(|end| data.get(from..end))
                .ok_or(bad("a curve lies outside the table"))
        };
        let name = name_at(data, at, 16).filter(|n| !n.is_empty()).ok_or(bad("name is not printable ASCII"))?;
        let mut fields = [0f32; 7];
        for (i, field) in fields.iter_mut().enumerate() {
            *field = f32_at(data, at + 16 + 4 * i);
            if !(field.is_finite() && *field > 0.0) {
                return Err(bad("a number is not positive and finite"));
            }
        }
        let [mu_mpa, alpha, height_mm, n_per_count, n_per_display_count, mm_per_count, acceptance] = fields;
        if ![n_per_count, n_per_display_count, mm_per_count].into_iter().all(super::is_scale) {
            return Err(bad("a scale is so large that forces or displacements are not finite"));
        }
        let rate_mm_s = f32_at(data, at + 52);
        if !(rate_mm_s.is_finite() && rate_mm_s >= 0.0) {
            return Err(bad("its rate is negative or not finite"));
        }
        let display = match place.version {
            1 => DisplayCurve::even(n_per_display_count, mm_per_count, counts(at + 48, place.points)?),
            _ => DisplayCurve::listed(data, at, n_per_display_count, mm_per_count).map_err(bad)?,
        };
        let curve = counts(at + 44, place.rows)?;
        Ok(Material { name, mu_mpa, alpha, height_mm, acceptance, rate_mm_s, n_per_count, curve, display })
    }

    /// Looks at every node of the display curve.
    pub(super) fn check(&self, material: u8) -> Result<(), TableError> {
        self.display.check().map_err(|rule| TableError::BadMaterial { material, rule })
    }

    /// True for a press at a table's slice of rate `slice_mm_s` (0 for a table without rates).
    pub fn serves(&self, slice_mm_s: f32) -> bool {
        self.rate_mm_s == 0.0 || slice_mm_s == 0.0 || self.rate_mm_s == slice_mm_s
    }

    /// Indentation force at a depth, N.
    pub fn force_n(&self, position: DepthPosition) -> f32 {
        position.interpolate(|row| f32::from(u16_at(self.curve, row * 2))) * self.n_per_count
    }

    /// Force at the last row, N.
    pub fn peak_force_n(&self) -> f32 {
        f32::from(u16_at(self.curve, self.curve.len().saturating_sub(2))) * self.n_per_count
    }

    /// Where the display's shaft must be under a finger's force, mm: linear between nodes; the first
    /// node without force and for NaN, the last beyond the curve.
    pub fn shaft_mm(&self, force_n: f32) -> f32 {
        self.display.shaft_mm(force_n)
    }

    /// Coil current under a finger's force, linear between nodes: 0 without force and for NaN, held at
    /// its limit where the force is not reachable. `None` for a material without control curve, which
    /// is displayed with the actuator only.
    pub fn current(&self, force_n: f32) -> Option<Current> {
        self.display.current(force_n)
    }

    /// Limits of the coil's control curve, where there is one.
    pub fn coil(&self) -> Option<CoilLimits> {
        self.display.coil()
    }

    /// Force at which the display curve ends, N.
    pub fn display_force_max_n(&self) -> f32 {
        self.display.force_max_n()
    }
}
