//! Between which entries of the library an identified material lies.
//!
//! Two materials are compared by the force that the ball feels at half the table's depth and at all of it: the
//! two numbers that mu and alpha move independently (mu moves both alike, alpha their ratio). Errors of mu and
//! alpha that make up for each other along their valley hardly move them. In the logarithms of these forces
//! every entry is a point, and so is the identified material, by the table's surface at its mu and alpha.
//!
//! Of all pairs of entries that one is taken whose line passes nearest, both as errors of the shaft's travel
//! under a finger. By Hertz travel goes with the force that a material gives to the power of -2/3. So a
//! distance of r beside the line changes travel by 2/3 r of itself; and along it, between entries that are L
//! apart, a straight line departs by 1/2 (2/3)^2 w (1 - w) L^2, w the share of the second entry.

use crate::number::sqrt;
use crate::recognition::MAX_MATERIALS;
use crate::search::Slice;
use crate::surface::Surface;
use protocol::lut::Table;
use protocol::message::Curve;

/// Power of the force by which travel falls (Hertz).
const POWER: f32 = 2.0 / 3.0;

/// An identified material.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameters {
    /// Shear modulus, MPa.
    pub mu_mpa: f32,
    /// Exponent.
    pub alpha: f32,
    /// Height of the specimen, mm.
    pub height_mm: f32,
    /// Rate of the press, mm/s.
    pub rate_mm_s: f32,
}

/// A place in the library.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placed {
    /// The curve there.
    pub curve: Curve,
    /// How far its travel may be off, as fraction of it.
    pub departs: f32,
    /// The material lies farther from the place than the acceptance of the entries is.
    pub outside: bool,
}

/// Logarithms of the forces (N) at half the depth and at all of it.
type Point = [f32; 2];

/// An entry: its point, and whether it has a control curve of the coil. With and without do not mix: the coil would be off between them.
#[derive(Clone, Copy)]
struct Entry {
    point: Point,
    coil: bool,
}

/// True for a table in which places between its materials can be found.
pub fn has_neighbours(table: &Table<'_>) -> bool {
    let surface = || Surface::new(table, &Slice::nearest(table, 0.0, 0.0)?);
    table.material_count() > 0 && surface().is_some()
}

/// The place between entries nearest to a material. `None` outside the table's grid of exponents, for what is not positive and
/// finite, and for a table without surface or library.
pub fn between(table: &Table<'_>, at: &Parameters) -> Option<Placed> {
    let slice = Slice::nearest(table, at.height_mm, at.rate_mm_s)?;
    let (entries, material) = (Entries::of(table, &slice), point_of(table, &slice, at)?);
    let mut best: Option<(f32, Placed)> = None;
    for (i, low) in entries.iter() {
        for (k, high) in entries.iter().filter(|(k, high)| *k >= i && high.coil == low.coil) {
            let (weight, beside, apart) = along(low.point, high.point, material);
            let departs = POWER * beside + 0.5 * POWER * POWER * weight * (1.0 - weight) * apart * apart;
            if best.is_none_or(|(least, _)| departs < least) {
                let curve = match weight {
                    0.0 => Curve::of(i),
                    1.0 => Curve::of(k),
                    _ => Curve { low: i, high: k, weight },
                };
                best = Some((departs, Placed { curve, departs, outside: is_outside(table, curve, beside) }));
            }
        }
    }
    best.map(|(_, placed)| placed)
}

/// One entry as the place of a material; `None` as for [`between`], and where there is no such entry.
pub fn entry(table: &Table<'_>, index: u8, at: &Parameters) -> Option<Placed> {
    let slice = Slice::nearest(table, at.height_mm, at.rate_mm_s)?;
    let (entries, material) = (Entries::of(table, &slice), point_of(table, &slice, at)?);
    let (_, own) = entries.iter().find(|(i, _)| *i == index)?;
    let (_, beside, _) = along(own.point, own.point, material);
    let curve = Curve::of(index);
    Some(Placed { curve, departs: POWER * beside, outside: is_outside(table, curve, beside) })
}

/// The entries that stand for a press.
struct Entries {
    entries: [Option<Entry>; MAX_MATERIALS],
}

impl Entries {
    fn of(table: &Table<'_>, slice: &Slice) -> Self {
        let mut entries = [None; MAX_MATERIALS];
        for (entry, material) in entries.iter_mut().zip(table.materials()) {
            if material.serves(slice.rate_mm_s) {
                let point = logarithms(|depth_mm| table.locate(depth_mm).map(|p| material.force_n(p)), table);
                *entry = point.map(|point| Entry { point, coil: material.coil().is_some() });
            }
        }
        Entries { entries }
    }

    fn iter(&self) -> impl Iterator<Item = (u8, Entry)> {
        (0u8..).zip(&self.entries).filter_map(|(i, entry)| entry.map(|entry| (i, entry)))
    }
}

fn point_of(table: &Table<'_>, slice: &Slice, at: &Parameters) -> Option<Point> {
    let surface = Surface::new(table, slice)?;
    logarithms(|depth_mm| surface.at(at.mu_mpa, at.alpha, depth_mm).map(|f| f.force_n), table)
}

/// `None` where a force is not positive and finite.
fn logarithms(force_n: impl Fn(f32) -> Option<f32>, table: &Table<'_>) -> Option<Point> {
    let deepest_mm = table.depth_max_mm();
    let log = |depth_mm| force_n(depth_mm).filter(|n| *n > 0.0 && n.is_finite()).map(libm::logf);
    Some([log(0.5 * deepest_mm)?, log(deepest_mm)?])
}

/// Share of the second point at the place of the line nearest to a third one, the third one's distance from
/// that place, and the length of the line.
fn along(low: Point, high: Point, at: Point) -> (f32, f32, f32) {
    let line = [high[0] - low[0], high[1] - low[1]];
    let to = [at[0] - low[0], at[1] - low[1]];
    let length2 = line[0] * line[0] + line[1] * line[1];
    let share = if length2 > 0.0 { (line[0] * to[0] + line[1] * to[1]) / length2 } else { 0.0 };
    let weight = crate::number::limit(share, 0.0, 1.0);
    let off = [to[0] - weight * line[0], to[1] - weight * line[1]];
    (weight, sqrt(off[0] * off[0] + off[1] * off[1]), sqrt(length2))
}

/// A force that is farther off than the wider acceptance of both entries, as fraction of it.
fn is_outside(table: &Table<'_>, curve: Curve, beside: f32) -> bool {
    let acceptance = |i: u8| table.material(usize::from(i)).map_or(0.0, |m| m.acceptance);
    beside > acceptance(curve.low).max(acceptance(curve.high))
}

#[cfg(test)]
mod tests;
