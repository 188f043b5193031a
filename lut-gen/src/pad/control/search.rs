//! The curve with which a block that yields feels nearest to what is wanted.

use rayon::prelude::*;

use super::curve::{Curve, least_squares};
use super::felt::{Error, Felt};
use crate::pad::body::Body;
use crate::pad::body::section::Section;
use crate::pad::error::PadError;
use crate::pad::press::Now;

/// A block that yields under a finger.
pub struct Display {
    /// Plane or ring.
    pub section: Section,
    /// The finger.
    pub finger: Body,
    /// The block; its material is plastic.
    pub block: Body,
    /// Yield stress that a curve does not fall below (MPa): of nothing there is no equilibrium.
    pub least_mpa: f64,
    /// Longest step of a press (mm).
    pub step_mm: f64,
    /// What the area counts in a search beside the force's 1; 0: the force alone.
    pub area_weight: f64,
}

/// A curve that was searched.
#[derive(Debug, Clone, PartialEq)]
pub struct Found {
    /// The curve.
    pub curve: Curve,
    /// What it feels like.
    pub felt: Felt,
    /// How far that is from what was wanted.
    pub error: Error,
    /// Rounds of the search.
    pub rounds: usize,
    /// The last round changed the error by less than [`SETTLED`].
    pub settled: bool,
}

/// Most rounds of a search.
const ROUNDS: usize = 12;
/// Relative change of the combined error that ends a search.
pub const SETTLED: f64 = 2e-3;
/// Step of a derivative, as a part of the yield stress at the end of the travel: contact edges that pass nodes make what is
/// felt a little uneven.
const NUDGE: f64 = 0.1;
/// Damping over the largest column: what no press feels stays where it is.
const DAMPING: f64 = 1e-3;

impl Display {
    /// What a curve feels like.
    ///
    /// # Errors
    /// [`PadError`].
    pub fn felt(&self, curve: &Curve, travel_mm: &[f64]) -> Result<Felt, PadError> {
        let yields = |now: Now| curve.at(now.travel_mm).max(self.least_mpa);
        let mut press = self.press();
        press.yields = &yields;
        Ok(Felt::of(self.section, &press.solve(travel_mm)?))
    }

    /// The curve of this kind that feels nearest to what is wanted, from one that is near: Gauss and Newton's method with
    /// difference quotients, shortened while the error rises. `told` hears of every round its error.
    ///
    /// # Errors
    /// [`PadError`] of the first press.
    pub fn search(&self, begin: &Curve, wanted: &Felt, told: &mut dyn FnMut(&Error)) -> Result<Found, PadError> {
        let travels = &wanted.travel_mm;
        let most_mm = travels.last().copied().unwrap_or(0.0);
        let sizes = begin.sizes(most_mm);
        let mut curve = begin.clone();
        let mut felt = self.felt(&curve, travels)?;
        let mut found = felt.error(wanted);
        told(&found);
        let (mut rounds, mut settled) = (0, false);
        while rounds < ROUNDS && !settled {
            rounds += 1;
            let own = curve.coefficients();
            let level = curve.at(most_mm).abs().max(self.least_mpa);
            let column = |k: usize| {
                let mut moved = own.clone();
                let step = NUDGE * level / sizes[k];
                moved[k] += step;
                let there = self.felt(&curve.with(&moved), travels)?;
                // in parts of what the coefficient counts, so that all columns are alike
                let pairs = felt.left(wanted, self.area_weight).into_iter().zip(there.left(wanted, self.area_weight));
                Ok::<_, PadError>(pairs.map(|(now, there)| (now - there) / NUDGE).collect())
            };
            let columns: Vec<Vec<f64>> = (0..own.len()).into_par_iter().map(column).collect::<Result<_, _>>()?;
            let change = least_squares(&columns, &felt.left(wanted, self.area_weight), DAMPING);
            let mut part = 1.0;
            let before = found.weighed(self.area_weight);
            loop {
                let moved: Vec<f64> = (0..own.len()).map(|k| own[k] + part * change[k] * level / sizes[k]).collect();
                let there = curve.with(&moved);
                // a curve that cannot be pressed is too far
                if let Ok(next) = self.felt(&there, travels) {
                    let error = next.error(wanted);
                    if error.weighed(self.area_weight) < before {
                        (curve, felt, found) = (there, next, error);
                        break;
                    }
                }
                part *= 0.4;
                if part < 0.02 {
                    break;
                }
            }
            told(&found);
            settled = before - found.weighed(self.area_weight) < SETTLED * before;
        }
        Ok(Found { curve, felt, error: found, rounds, settled })
    }
}
