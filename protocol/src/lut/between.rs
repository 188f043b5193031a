//! A display curve between two library materials.

use super::{CURRENT_MAX_A, Current, Material, Table};

/// A place between two materials: their shaft positions and currents, mixed force by force.
///
/// Between two curves that rise with force the mixed one rises, at every force it lies between both, and from
/// the first to the second it goes one way. At the ends it is the material's own curve, bit by bit.
#[derive(Debug, Clone, Copy)]
pub struct Between<'a> {
    low: Material<'a>,
    high: Material<'a>,
    /// Share of `high`, 0 to 1.
    weight: f32,
}

/// `low` and `high` mixed with the share `weight` of `high`, 0 to 1; never outside both.
pub fn mixed(low: f32, high: f32, weight: f32) -> f32 {
    let mixed = low + weight * (high - low);
    let (least, most) = if low < high { (low, high) } else { (high, low) };
    // Rounding alone leads outside.
    if mixed < least {
        least
    } else if mixed > most {
        most
    } else {
        mixed
    }
}

impl<'a> Between<'a> {
    /// Between materials number `low` and `high` of a table's library with the share `weight` of `high`; a share
    /// outside 0 to 1, or one that is no number, is the nearest of both ends, `low` for the latter. `None` if
    /// there is no such material.
    pub fn new(table: &Table<'a>, low: u8, high: u8, weight: f32) -> Option<Self> {
        let weight = if weight >= 1.0 {
            1.0
        } else if weight > 0.0 {
            weight
        } else {
            0.0
        };
        Some(Between { low: table.material(usize::from(low))?, high: table.material(usize::from(high))?, weight })
    }

    /// The end, where it is one: nothing is mixed there.
    fn end(&self) -> Option<&Material<'a>> {
        if self.weight <= 0.0 {
            Some(&self.low)
        } else if self.weight >= 1.0 {
            Some(&self.high)
        } else {
            None
        }
    }

    /// Where the shaft must be under a finger's force, mm; see [`Material::shaft_mm`].
    pub fn shaft_mm(&self, force_n: f32) -> f32 {
        match self.end() {
            Some(end) => end.shaft_mm(force_n),
            None => mixed(self.low.shaft_mm(force_n), self.high.shaft_mm(force_n), self.weight),
        }
    }

    /// Coil current under a finger's force; see [`Material::current`]. Each material's is held within its own
    /// reach: what either cannot show the mixed curve cannot. `None` if either has no control curve.
    pub fn current(&self, force_n: f32) -> Option<Current> {
        if let Some(end) = self.end() {
            return end.current(force_n);
        }
        let (low, high) = (self.low.current(force_n)?, self.high.current(force_n)?);
        Some(Current { a: mixed(low.a, high.a, self.weight), unreachable: low.unreachable || high.unreachable })
    }

    /// Error bound of the current under a force, A: those of both curves by their shares, and what mixing adds,
    /// which is taken as the distance to the nearer of them. `None` without control curve.
    pub fn bound_a(&self, force_n: f32) -> Option<f32> {
        if let Some(end) = self.end() {
            return end.coil().map(|coil| coil.bound_a);
        }
        let (low, high) = (self.low.coil()?, self.high.coil()?);
        let apart_a = (self.low.current(force_n)?.a - self.high.current(force_n)?.a).abs();
        let nearer = if self.weight < 0.5 { self.weight } else { 1.0 - self.weight };
        let bound_a = mixed(low.bound_a, high.bound_a, self.weight) + nearer * apart_a;
        Some(if bound_a < CURRENT_MAX_A { bound_a } else { CURRENT_MAX_A })
    }

    /// Force, N, that the material bears where a finger has travelled `travel_mm`: of that travel its surface gives way,
    /// and the rest is compression of the pulp, `pulp_mm` of a force. 0 for no travel and for NaN; the last force of the
    /// curve beyond it.
    pub fn force_at(&self, travel_mm: f32, pulp_mm: impl Fn(f32) -> f32) -> f32 {
        /// Halvings of the curve's forces: some are 5 N, so that 0.1 mN are told.
        const HALVINGS: usize = 16;
        let (low, high) = (self.low.display_force_max_n(), self.high.display_force_max_n());
        let (mut below_n, mut above_n) = (0.0, self.end().map_or(low.min(high), Material::display_force_max_n));
        let travels = |force_n: f32| self.shaft_mm(force_n) + pulp_mm(force_n);
        if travels(above_n) <= travel_mm {
            return above_n;
        }
        for _ in 0..HALVINGS {
            let middle_n = 0.5 * (below_n + above_n);
            if travels(middle_n) < travel_mm {
                below_n = middle_n;
            } else {
                above_n = middle_n;
            }
        }
        0.5 * (below_n + above_n)
    }

    /// Forces, N, that both can show: from, to; empty (the end below the beginning) where no force is within the
    /// reach of both. `None` without control curve.
    pub fn reachable_n(&self) -> Option<(f32, f32)> {
        if let Some(end) = self.end() {
            return end.coil().map(|coil| coil.reachable_n);
        }
        let (low, high) = (self.low.coil()?.reachable_n, self.high.coil()?.reachable_n);
        Some((low.0.max(high.0), low.1.min(high.1)))
    }
}

#[cfg(test)]
mod tests;
