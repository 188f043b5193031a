//! The surface at one exponent: force per modulus over depth.

use super::{Surface, Weights};

/// Force over depth of a one-term Hyperfoam of fixed exponent and unit modulus.
#[derive(Debug, Clone, Copy)]
pub struct Curve<'a> {
    surface: Surface<'a>,
    /// First of the four columns, and their shares.
    column: usize,
    shares: [f32; 4],
}

impl<'a> Surface<'a> {
    /// The curve of an exponent; `None` outside the grid.
    pub fn curve(&self, alpha: f32) -> Option<Curve<'a>> {
        let (column, across) = self.across(alpha)?;
        Some(Curve { surface: *self, column, shares: across.value })
    }
}

impl Curve<'_> {
    /// Force (N/MPa) and its slope by the depth (N/MPa/mm): those of [`Surface::at`] for a modulus of 1 MPa, and beyond the last row straight
    /// on, so that a trial of the contact point changes no sample's being used. Zero at and above the surface, and for what is no number.
    pub fn at(&self, depth_mm: f32) -> (f32, f32) {
        let surface = &self.surface;
        let deepest_mm = surface.depth_max_mm();
        let beyond_mm = if depth_mm > deepest_mm { depth_mm - deepest_mm } else { 0.0 };
        // Also for NaN.
        if !(depth_mm > 0.0) {
            return (0.0, 0.0);
        }
        let Some((rows, down)) = surface.down(depth_mm - beyond_mm) else {
            return (0.0, 0.0);
        };
        let (mut force, mut slope) = (0.0, 0.0);
        let Weights { value, slope: by_step } = down;
        for (row, (v, dv)) in rows.iter().zip(value.iter().zip(by_step)) {
            let Some(row) = row else {
                continue;
            };
            let mut stored = 0.0;
            for (i, share) in self.shares.iter().enumerate() {
                stored += share * surface.table.row_force_n(*row, surface.first + (self.column + i) * surface.stride);
            }
            force += v * stored;
            slope += dv * stored;
        }
        slope *= surface.per_mpa * surface.per_step;
        (surface.per_mpa * force + slope * beyond_mm, slope)
    }
}
