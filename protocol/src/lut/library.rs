//! The library: named materials with their own force curve and display curve.

use super::bytes::{f32_at, name_at, u16_at, u32_at};
use super::reader::DepthPosition;
use super::{MATERIAL_LEN, TableError};

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
    n_per_display_point: f32,
    mm_per_count: f32,
    curve: &'a [u8],
    display: &'a [u8],
}

impl<'a> Material<'a> {
    pub(super) fn parse(
        data: &'a [u8],
        library_at: usize,
        material: u8,
        rows: usize,
        points: usize,
    ) -> Result<Self, TableError> {
        let bad = |rule| TableError::BadMaterial { material, rule };
        let at = library_at + usize::from(material) * MATERIAL_LEN;
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
        let [mu_mpa, alpha, height_mm, n_per_count, n_per_display_point, mm_per_count, acceptance] = fields;
        if ![n_per_count, n_per_display_point, mm_per_count].into_iter().all(super::is_scale) {
            return Err(bad("a scale is so large that forces or displacements are not finite"));
        }
        let rate_mm_s = f32_at(data, at + 52);
        if !(rate_mm_s.is_finite() && rate_mm_s >= 0.0) {
            return Err(bad("its rate is negative or not finite"));
        }
        Ok(Material {
            name,
            mu_mpa,
            alpha,
            height_mm,
            acceptance,
            rate_mm_s,
            n_per_count,
            n_per_display_point,
            mm_per_count,
            curve: counts(at + 44, rows)?,
            display: counts(at + 48, points)?,
        })
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

    /// Displacement of the display's cap under a finger's force, mm: linear between points; 0 for no force
    /// or NaN, and the last point beyond the curve.
    pub fn displacement_mm(&self, force_n: f32) -> f32 {
        let points = self.display.len() / 2;
        let at = force_n / self.n_per_display_point;
        if points == 0 || at.is_nan() || at <= 0.0 {
            return 0.0;
        }
        // Point i is the displacement at (i + 1) steps of force; below the first point, from zero.
        let value = |i: usize| f32::from(u16_at(self.display, i * 2));
        if at >= points as f32 {
            return value(points - 1) * self.mm_per_count;
        }
        let below = at as usize;
        let w = at - below as f32;
        let lower = if below == 0 { 0.0 } else { value(below - 1) };
        (lower + w * (value(below) - lower)) * self.mm_per_count
    }

    /// Force at which the display curve ends, N.
    pub fn display_force_max_n(&self) -> f32 {
        (self.display.len() / 2) as f32 * self.n_per_display_point
    }
}
