//! An alignment, and whether it shows the tip.

use super::align::Fit;
use super::covariance::Spread;

/// What a place must show.
#[derive(Debug, Clone, Copy)]
pub struct Demand {
    /// Of all pixels, over what noise leaves, with
    correlation: f64,
    /// this part seen; or
    seen: f64,
    /// of the pixels that are seen, with
    correlation_of_seen: f64,
    /// this part seen.
    seen_of_all: f64,
    /// Part that must be seen of every part of the region.
    least_seen: f64,
    /// Most change of contrast, up or down, as a factor.
    gain: f64,
}

/// Near where it is expected: half of the tip may be hidden.
pub const NEAR: Demand =
    Demand { correlation: 0.8, seen: 0.4, correlation_of_seen: 0.92, seen_of_all: 0.5, least_seen: 0.0, gain: 2.5 };
/// Where it may have come to since it was seen: what merely resembles the tip is none.
pub const WITHIN_REACH: Demand =
    Demand { correlation: 0.9, seen: 0.8, correlation_of_seen: 0.95, seen_of_all: 0.8, least_seen: 0.5, gain: 8.0 };
/// Farther than it has ever gone in that time: all of it must be seen. The end of a shaft that is cut off by a hand shows seven
/// tenths of a finger's edges.
pub const ANYWHERE: Demand = Demand { seen: 0.9, seen_of_all: 0.9, least_seen: 0.75, ..WITHIN_REACH };

/// An alignment with its weights taken into account.
#[derive(Debug, Clone)]
pub struct Candidate {
    /// The alignment.
    pub fit: Fit,
    /// Of all pixels.
    pub correlation: f64,
    /// Of the weighted ones.
    pub correlation_of_seen: f64,
    /// Part of the template's edges that is seen.
    pub seen: f64,
    /// The same of that part of the region of which least is seen.
    pub least_seen: f64,
    /// How uncertain the shift is.
    pub spread: Spread,
}

impl Candidate {
    /// It shows what it must: `expected` is the correlation that noise leaves, `gain` the contrast so far.
    pub fn meets(&self, demand: &Demand, expected: f64, gain: f64) -> bool {
        let ratio = self.fit.gain() / gain;
        let whole = self.correlation >= demand.correlation * expected && self.seen >= demand.seen;
        let part = self.correlation_of_seen >= demand.correlation_of_seen * expected && self.seen >= demand.seen_of_all;
        (whole || part) && self.least_seen >= demand.least_seen && ratio < demand.gain && ratio * demand.gain > 1.0
    }
}
