//! The uncertainty that is stated, from that of alignments.

use super::candidate::Candidate;
use super::covariance::Spread;

/// Frames over which the kind of residuals is averaged.
const REMEMBERED: f64 = 10.0;
/// Share of the position's variance that is not there in the first frame: a frame's own noise and the template's are alike.
const FRESH: f64 = 0.5;
/// Edges between pixels and rounding put a shift off by so much that residuals do not tell, pixels.
const SYSTEMATIC_PX: f64 = 0.005;
/// The border of what hides a tip pulls by so much, times the part that is hidden, pixels; measured with sheets that slide over it.
const PULL_PX: f64 = 0.3;

/// Standard deviations along both axes, pixels.
#[derive(Debug, Clone, Copy)]
pub struct Sigma {
    /// With the noise of the first frame.
    pub total: [f64; 2],
    /// The part that is the frame's own.
    pub own: [f64; 2],
}

/// Uncertainty that the template's own noise leaves.
pub fn of_template(spread: Option<Spread>) -> [f64; 2] {
    let sigma = |axis: usize| spread.map_or(f64::INFINITY, |s| (FRESH * s.noise[axis] + SYSTEMATIC_PX.powi(2)).sqrt());
    [sigma(0), sigma(1)]
}

/// Remembers what residuals have been like.
#[derive(Debug, Default)]
pub struct Stated {
    /// Variance that neighbourhoods of residuals tell, over that of noise.
    kind: [f64; 2],
    /// Of how many frames it is the mean.
    count: f64,
}

impl Stated {
    /// Of the next frame.
    pub fn of(&mut self, found: &Candidate) -> Sigma {
        let Spread { noise, local, uneven } = found.spread;
        self.count = (self.count + 1.0).min(REMEMBERED);
        let floor = SYSTEMATIC_PX.powi(2) + (PULL_PX * (1.0 - found.seen).max(0.0)).powi(2);
        let mut sigma = Sigma { total: [0.0; 2], own: [0.0; 2] };
        for axis in 0..2 {
            let ratio = if noise[axis] > 0.0 { local[axis] / noise[axis] } else { 1.0 };
            self.kind[axis] += (ratio.clamp(0.1, 100.0) - self.kind[axis]) / self.count;
            let variance = noise[axis] * self.kind[axis].max(1.0) + uneven[axis];
            sigma.total[axis] = (variance + floor).sqrt();
            sigma.own[axis] = (FRESH * variance + floor).sqrt();
        }
        sigma
    }
}
