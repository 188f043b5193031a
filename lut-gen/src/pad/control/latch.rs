//! The loop of a display: its yield stress follows the force and raises it.
//!
//! At rest under a finger that stands still, the force of a block that flows is `G(sigma)`, and the
//! board sets `sigma = f(F)`. The loop gain is `G' f'`. Below 1 a small change dies out; at 1 the
//! display latches: it holds a force that no finger asks for, or lets go of one at once.

use super::curve::Curve;
use super::felt::Felt;
use super::search::Display;
use crate::pad::error::{PadError, demand};
use crate::pad::press::{Now, Press, Side};

/// A yield stress that follows the force: straight lines from (0, 0) on, then level.
#[derive(Debug, Clone, PartialEq)]
pub struct Followed {
    /// Force (N), rising, and yield stress (MPa).
    points: Vec<(f64, f64)>,
}

/// Fall of the yield stress that the response of the force is read from, as a part of it.
const DIP: f64 = 0.05;
/// Longest step of a cycle (mm): 50 control ticks a second at 5 mm/s.
const TICK_MM: f64 = 0.1;

impl Followed {
    /// Through forces (N) and yield stresses (MPa).
    ///
    /// # Errors
    /// [`PadError::Value`] unless the forces rise from more than 0 and no stress is negative.
    pub fn new(force_n: &[f64], mpa: &[f64]) -> Result<Self, PadError> {
        let mut last = (0.0, 0.0);
        let mut points = vec![last];
        for (&force, &stress) in force_n.iter().zip(mpa) {
            demand(force > last.0 && force.is_finite(), "a force of a control curve (N)", force, "forces that rise")?;
            let good = stress >= 0.0 && stress.is_finite();
            demand(good, "a yield stress of a control curve (MPa)", stress, "0 or more")?;
            last = (force, stress);
            points.push(last);
        }
        demand(points.len() > 1, "the number of points of a control curve", points.len() as f64 - 1.0, "1 or more")?;
        Ok(Self { points })
    }

    /// Yield stress (MPa) at a force (N).
    #[must_use]
    pub fn at(&self, force_n: f64) -> f64 {
        let next = self.points.partition_point(|p| p.0 <= force_n).max(1);
        match self.points.get(next) {
            Some(to) => {
                let from = self.points[next - 1];
                from.1 + (force_n - from.0).max(0.0) / (to.0 - from.0) * (to.1 - from.1)
            }
            None => self.points.last().map_or(0.0, |p| p.1),
        }
    }

    /// The points after (0, 0).
    #[must_use]
    pub fn points(&self) -> &[(f64, f64)] {
        &self.points[1..]
    }

    /// Rise (MPa/N) of the line that ends at every point.
    #[must_use]
    pub fn slopes(&self) -> Vec<f64> {
        self.points.windows(2).map(|w| (w[1].1 - w[0].1) / (w[1].0 - w[0].0)).collect()
    }

    /// Loop gain at every point, from the force (N) that a MPa of yield stress makes there.
    #[must_use]
    pub fn gains(&self, force_per_mpa: &[f64]) -> Vec<f64> {
        self.slopes().iter().zip(force_per_mpa).map(|(slope, per)| slope * per).collect()
    }

    /// The same with no line that rises more steeply than a loop gain of `most` allows, and what lines
    /// were cut.
    #[must_use]
    pub fn limited(&self, force_per_mpa: &[f64], most: f64) -> (Self, Vec<bool>) {
        let mut points = vec![self.points[0]];
        let mut cut = Vec::new();
        for (w, per) in self.points.windows(2).zip(force_per_mpa) {
            let from = points[points.len() - 1].1;
            let allowed = from + most / per.max(f64::MIN_POSITIVE) * (w[1].0 - w[0].0);
            cut.push(w[1].1 > allowed);
            points.push((w[1].0, w[1].1.min(allowed)));
        }
        (Self { points }, cut)
    }
}

impl Display {
    /// Force (N) that a MPa of yield stress makes at each travel (mm) of a press with a curve: the
    /// stress dips by a twentieth while the finger stands still, and the force follows it down.
    /// Upward it would not: a block that stands still bears no more when it could.
    ///
    /// # Errors
    /// [`PadError`].
    pub fn force_per_mpa(&self, curve: &Curve, travel_mm: &[f64]) -> Result<Vec<f64>, PadError> {
        // a second of standing still at every travel, at 1 mm/s between them
        let start = |k: usize| travel_mm[k] + k as f64;
        let stress = |travel_mm: f64| curve.at(travel_mm).max(self.least_mpa);
        let yields = |now: Now| {
            let stands = travel_mm.iter().rposition(|u| now.travel_mm >= *u).map_or(0.0, |k| now.time_s - start(k));
            let dip = if (0.0..=1.0).contains(&stands) { 2.0 * stands.min(1.0 - stands) } else { 0.0 };
            stress(now.travel_mm) * (1.0 - DIP * dip)
        };
        let motion: Vec<Now> = (0..travel_mm.len())
            .flat_map(|k| {
                [0.0, 0.5, 1.0].map(|wait| Now { time_s: start(k) + wait, travel_mm: travel_mm[k], force_n: 0.0 })
            })
            .collect();
        let mut press = self.press();
        press.yields = &yields;
        let states = press.follow(&motion)?;
        let fall = |k: usize| states[3 * k].force_n - states[3 * k + 1].force_n;
        Ok((0..travel_mm.len()).map(|k| fall(k) / (DIP * stress(travel_mm[k]))).collect())
    }

    /// A finger that goes down to `most_mm` and up again on a block whose yield stress follows the
    /// force of the tick before; down, then up.
    ///
    /// # Errors
    /// [`PadError`].
    pub fn cycle(&self, followed: &Followed, most_mm: f64, points: usize) -> Result<[Felt; 2], PadError> {
        let yields = |now: Now| followed.at(now.force_n).max(self.least_mpa);
        let mut press = self.press();
        press.step_mm = TICK_MM.min(self.step_mm);
        press.yields = &yields;
        let place = |i: usize| most_mm * i as f64 / points as f64;
        let down = (1..=points).map(|i| (place(i), place(i)));
        let up = (0..points).rev().map(|i| (2.0 * most_mm - place(i), place(i)));
        let motion: Vec<Now> =
            down.chain(up).map(|(time_s, travel_mm)| Now { time_s, travel_mm, force_n: 0.0 }).collect();
        let states = press.follow(&motion)?;
        let (down, up) = states.split_at(points);
        Ok([Felt::of(self.section, down), Felt::of(self.section, up)])
    }

    /// The finger on the block.
    pub(super) fn press(&self) -> Press<'_> {
        let mut press = Press::new(self.section, Side::Soft(self.finger.clone()), Side::Soft(self.block.clone()));
        press.step_mm = self.step_mm;
        press
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn a_followed_curve_is_straight_between_its_points_and_level_beyond() {
        let curve = Followed::new(&[0.5, 1.0], &[2e-3, 3e-3]).unwrap();
        for (force, mpa) in [(-1.0, 0.0), (0.0, 0.0), (0.25, 1e-3), (0.75, 2.5e-3), (1.0, 3e-3), (9.0, 3e-3)] {
            assert!((curve.at(force) - mpa).abs() < 1e-15, "{force}");
        }
        let text = Followed::new(&[0.5, 0.5], &[1.0, 2.0]).unwrap_err().to_string();
        assert!(text.contains("force of a control curve") && text.contains("0.5"), "{text}");
        let text = Followed::new(&[0.5, 0.6], &[2.0, -1.0]).unwrap_err().to_string();
        assert!(text.contains("yield stress of a control curve (MPa)") && text.contains("0 or more"), "{text}");
        // what falls takes force away: the loop cannot latch
        assert!(Followed::new(&[0.5, 0.6], &[2e-3, 1e-3]).unwrap().gains(&[300.0; 2])[1] < 0.0);
    }

    #[test]
    fn a_loop_is_limited_where_it_is_too_steep_and_nowhere_else() {
        let curve = Followed::new(&[1.0, 2.0, 3.0], &[1e-3, 4e-3, 5e-3]).unwrap();
        let per = [300.0; 3];
        assert!(curve.gains(&per).iter().zip([0.3, 0.9, 0.3]).all(|(a, b)| (a - b).abs() < 1e-12));
        let (limited, cut) = curve.limited(&per, 0.6);
        assert_eq!(cut, [false, true, false]);
        assert!(limited.gains(&per).iter().zip([0.3, 0.6, 0.6]).all(|(a, b)| *a <= b + 1e-12));
        assert!(limited.points().iter().zip(curve.points()).all(|(a, b)| a.1 <= b.1));
    }
}
