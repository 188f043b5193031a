//! A recorded press with known contact, identified by one method: a result, or the name of what is in its way. No method returns a number it
//! could not have found.
//!
//! The board's own [`crate::palpation`] goes by the same rules; this is for a host, for tests and for comparing the methods.

use crate::kalman::indentation::Indentation;
use crate::kalman::{Bounding, Estimator, Region, identify::identify};
use crate::profile::{Fitted, ProfileSearch};
use crate::readings::{Readings, ReadingsConfig};
use crate::search::{Found, NoSlice, Search, Slice, Tolerance};
use crate::surface::Surface;
use nalgebra::Vector2;
use protocol::lut::{Table, axis_name};
use protocol::message::Outcome;

/// A press.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Press<'a> {
    /// Height of the specimen, mm.
    pub height_mm: f32,
    /// Rate, mm/s.
    pub rate_mm_s: f32,
    /// Depth after contact (mm; zero and below is above the surface) and force (N, zero taken off) of every sample.
    pub samples: &'a [(f32, f32)],
    /// Standard deviation of the force without contact, N.
    pub noise_n: f32,
}

impl Press<'_> {
    /// The slice of the table for this press.
    ///
    /// # Errors
    /// [`Outcome::NoSuchRate`], [`Outcome::NoSuchHeight`] (also for a table that is too large), and what [`Readings::refused`] names;
    /// [`Outcome::NoContact`] if no force rises above 2.5 times the noise, as contact detection has it.
    pub fn admit(&self, table: &Table<'_>) -> Result<Slice, Outcome> {
        let readings = Readings::of(self.samples.iter().copied(), table.depth_max_mm());
        if let Some(outcome) = readings.refused(&ReadingsConfig::default()) {
            return Err(outcome);
        }
        let config = crate::contact::ContactConfig::default();
        let threshold_n = (config.sigmas * self.noise_n).max(config.floor_n);
        let above = self.samples.iter().filter(|(depth_mm, force_n)| *depth_mm > 0.0 && *force_n > threshold_n);
        if above.count() < usize::from(config.consecutive) {
            return Err(Outcome::NoContact);
        }
        Slice::choose(table, self.height_mm, self.rate_mm_s, &Tolerance::default()).map_err(|why| match why {
            NoSlice::Rate => Outcome::NoSuchRate,
            NoSlice::Height | NoSlice::TooLarge => Outcome::NoSuchHeight,
        })
    }

    /// By the variance search (Eq. 17).
    ///
    /// # Errors
    /// As [`Press::admit`]; [`Outcome::GridEdge`] if the best column lies on the edge of the grid, [`Outcome::BadReadings`] if forces are
    /// too large to be summed.
    pub fn by_variance(&self, table: &Table<'_>, search: &mut Search) -> Result<Found, Outcome> {
        let slice = self.admit(table)?;
        search.reset();
        for (depth_mm, force_n) in self.samples {
            search.step(table, &slice, *depth_mm, *force_n);
        }
        let found = search.found(&slice).ok_or(Outcome::BadReadings)?;
        if found.at_edge { Err(Outcome::GridEdge) } else { Ok(found) }
    }

    /// By the fast search of one row an exponent.
    ///
    /// # Errors
    /// As [`Press::by_variance`].
    pub fn by_rows(&self, table: &Table<'_>) -> Result<Fitted, Outcome> {
        let slice = self.admit(table)?;
        let mut profile = ProfileSearch::new(table, &slice);
        for (depth_mm, force_n) in self.samples {
            profile.step(table, *depth_mm, *force_n);
        }
        let fitted = profile.found(table).ok_or(Outcome::BadReadings)?;
        let finite = [fitted.mu_mpa, fitted.alpha, fitted.rms_n].iter().all(|x| x.is_finite());
        match (finite, fitted.at_edge) {
            (false, _) => Err(Outcome::BadReadings),
            (true, true) => Err(Outcome::GridEdge),
            (true, false) => Ok(fitted),
        }
    }

    /// By the Kalman filter of mu and alpha, `passes` times over the samples, from the middle of the grid.
    ///
    /// # Errors
    /// As [`Press::by_variance`], for an estimate on the edge of the grid; [`Outcome::NoSuchHeight`] also for a table without a continuous surface.
    pub fn by_filter(&self, table: &Table<'_>, passes: u8) -> Result<Estimator<2>, Outcome> {
        let slice = self.admit(table)?;
        let surface = Surface::new(table, &slice).ok_or(Outcome::NoSuchHeight)?;
        let range = |name| table.axis(name).map(|a| (a.value(0), a.value(a.len().saturating_sub(1))));
        let (mu, alpha) = range(axis_name::MU).zip(range(axis_name::ALPHA)).ok_or(Outcome::NoSuchHeight)?;
        let region = Region { low: Vector2::new(mu.0, alpha.0), high: Vector2::new(mu.1, alpha.1) };
        let mut estimator = Estimator::new(region.middle(), region, Bounding::Constrained { linearisations: 1 });
        // The load cell's quantisation at least.
        let noise_n = self.noise_n.max(0.0005);
        let samples = self.samples.iter().copied().filter(|(d, f)| d.is_finite() && f.is_finite());
        let used = identify(&mut estimator, &Indentation { surface }, samples, noise_n * noise_n, passes);
        let state = estimator.filter.state;
        if used == 0 || !state.iter().all(|x| x.is_finite()) {
            return Err(Outcome::BadReadings);
        }
        let on_edge = (0..2).any(|i| state[i] <= region.low[i] || state[i] >= region.high[i]);
        if on_edge { Err(Outcome::GridEdge) } else { Ok(estimator) }
    }
}

#[cfg(test)]
mod tests;
