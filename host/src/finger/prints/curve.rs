//! Print area over force of a finger on a plate, as far as its prints reach.

use std::path::Path;

use lut_gen::magnet::curve::Rising;
use rayon::prelude::*;

use super::super::opposite::Opposite;
use super::super::parse;
use super::super::press::Asked;
use super::super::reading::Reading;
use super::fit::Unfitted;
use super::scaled::{Scale, scaled};

/// Skin moduli over the file's at which the finger is pressed.
const SKINS: [f64; 5] = [0.25, 0.5, 1.0, 2.0, 4.0];
/// Travels of a press, mm over the finger's half height.
const FIRST: f64 = 0.02;
const LAST: f64 = 0.3;
const TRAVELS: usize = 22;
/// How fast the bone moves, mm/s: tells only where a layer relaxes.
const SPEED_MM_S: f64 = 2.0;
/// Fewest travels that a curve is made of.
const FEWEST: usize = 5;

/// Logarithm of the print's area (mm2) over that of the force (N).
#[derive(Debug, Clone)]
pub(super) struct Curve {
    of: Rising,
    first: (f64, f64),
    last: (f64, f64),
    /// Slopes beyond both ends.
    ends: (f64, f64),
}

/// Curves for several moduli of the skin.
#[derive(Debug, Clone)]
pub(super) struct Family {
    /// Logarithm of the skin's factor, and the curve.
    members: Vec<(f64, Curve)>,
}

impl Curve {
    /// Of force (N) and area (mm2), both rising.
    pub fn new(points: &[(f64, f64)]) -> Option<Self> {
        let logs: Vec<(f64, f64)> = points.iter().map(|(f, a)| (f.ln(), a.ln())).collect();
        let [first, second, .., before, last] = logs.as_slice() else { return None };
        let slope = |a: &(f64, f64), b: &(f64, f64)| (b.1 - a.1) / (b.0 - a.0);
        let (first, last, ends) = (*first, *last, (slope(first, second), slope(before, last)));
        let (x, y) = logs.iter().copied().unzip();
        Some(Curve { of: Rising::new(x, y).ok()?, first, last, ends })
    }

    fn at(&self, ln_n: f64) -> f64 {
        if ln_n < self.first.0 {
            return self.first.1 + self.ends.0 * (ln_n - self.first.0);
        }
        if ln_n > self.last.0 {
            return self.last.1 + self.ends.1 * (ln_n - self.last.0);
        }
        self.of.at(ln_n)
    }
}

impl Family {
    /// Presses the finger of this file with elements `coarser` times as long; with `skins` for several moduli of its skin.
    /// `told` hears of every press done.
    pub fn pressed(
        (file, text): (&Path, &str),
        skins: bool,
        coarser: f64,
        told: &(dyn Fn(usize) + Sync),
    ) -> Result<Self, Unfitted> {
        let factors: &[f64] = if skins { &SKINS } else { &[1.0] };
        let done = std::sync::atomic::AtomicUsize::new(0);
        let one = |skin: &f64| -> Result<(f64, Curve), Unfitted> {
            let text = scaled(file, text, Scale { skin: *skin, ..Scale::NONE })?;
            let curve = pressed(file, &text, coarser)?;
            told(1 + done.fetch_add(1, std::sync::atomic::Ordering::Relaxed));
            Ok((skin.ln(), curve))
        };
        let members = factors.par_iter().map(one).collect::<Vec<_>>().into_iter().collect::<Result<_, _>>()?;
        Ok(Family { members })
    }

    #[cfg(test)]
    pub fn of(members: Vec<(f64, Curve)>) -> Self {
        Family { members }
    }

    /// Logarithm of the area (mm2) at that of a force (N), for a finger scaled like this: Lagrange's polynomial over the
    /// skins. Lengths and moduli scale exactly.
    pub fn at(&self, ln_n: f64, [stiffness, size, skin]: [f64; 3]) -> f64 {
        let base_n = ln_n - stiffness - 2.0 * size;
        let mut area = 0.0;
        for (i, (own, curve)) in self.members.iter().enumerate() {
            let others = self.members.iter().enumerate().filter(|(j, _)| *j != i);
            let weight: f64 = others.map(|(_, (other, _))| (skin - other) / (own - other)).product();
            area += weight * curve.at(base_n);
        }
        area + 2.0 * size
    }

    /// Whether a print lies beyond the press of every skin.
    pub fn is_beyond(&self, ln_n: f64, [stiffness, size, _]: [f64; 3]) -> bool {
        let base_n = ln_n - stiffness - 2.0 * size;
        self.members.iter().all(|(_, curve)| base_n > curve.last.0)
    }

    /// Logarithm of the least and largest factor of the skin.
    pub fn skins(&self) -> (f64, f64) {
        let of = |member: Option<&(f64, Curve)>| member.map_or(0.0, |(skin, _)| *skin);
        (of(self.members.first()), of(self.members.last()))
    }
}

/// The finger's press on a plate, as far as it finds an equilibrium.
fn pressed(file: &Path, text: &str, coarser: f64) -> Result<Curve, Unfitted> {
    let finger = parse(file, text)?;
    let half_mm = finger.finger.height_mm;
    let travels: Vec<f64> =
        (0..TRAVELS).map(|i| half_mm * FIRST * (LAST / FIRST).powf(i as f64 / (TRAVELS - 1) as f64)).collect();
    let mut asked = Asked {
        finger,
        on: Opposite::Plate,
        travels_mm: travels,
        speed_mm_s: SPEED_MM_S,
        friction: 0.0,
        radius_mm: 10.0 * half_mm,
        slides: false,
    };
    loop {
        let mut reached = 0;
        match asked.press(coarser, &mut |done| reached = done) {
            Ok(pressed) => {
                let readings = pressed.states.iter().map(|state| Reading::of(&pressed, state));
                let mut points = Vec::<(f64, f64)>::new();
                // A contact's edge goes from element to element: what does not rise is left out.
                for r in readings.filter(|r| r.force_n > 0.0 && r.print_mm2 > 0.0) {
                    if points.last().is_none_or(|last| r.force_n > last.0 && r.print_mm2 > last.1) {
                        points.push((r.force_n, r.print_mm2));
                    }
                }
                return Curve::new(&points).filter(|_| points.len() >= FEWEST).ok_or(Unfitted::NoCurve);
            }
            Err(_) if reached >= FEWEST => asked.travels_mm.truncate(reached),
            Err(error) => return Err(Unfitted::Press(error)),
        }
    }
}
