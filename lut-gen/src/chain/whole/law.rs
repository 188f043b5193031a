//! Ratios of two forces of one mesh, without the marks that the mesh leaves in them.
//!
//! A force waves by 0.1 to 0.5 % as elements come into contact one after the other. Two laws touch at one depth with contacts of two sizes, so that
//! these marks do not cancel in a ratio: a second term of sixteen standard deviations was missed by ten, and a Poisson's ratio, which is told from smooth
//! force models, was likelier than the truth. The ratio itself is smooth.

use super::contains::first_term;
use super::job::Job;
use super::path::deepest_mm;
use super::run::{Curve, Detail};
use super::twin::plain;
use crate::chain::{Chain, Model, Passage};
use crate::solid::model::Simulation;
use crate::solid::model::chebyshev::{clenshaw, least_squares};
use crate::solid::solve::{Motion, SolveError};

/// Places along the way down at which it is told, even in the size of the contact; cubics connect them.
const PLACES: u32 = 40;
/// How far the laws are pressed, as a factor on the depth that is asked for.
const BEYOND: f64 = 1.08;
/// Terms of the ratio of two forces over the size of the contact.
const TERMS: usize = 6;

/// A station of a path beside the first term alone at its depth, forces in N.
pub(super) struct Beside {
    /// Where on the path.
    pub place: f64,
    /// Force over that of the first term on the same mesh; none where the latter is next to nothing.
    pub ratio: Option<f64>,
    pub hard_n: f64,
    pub here_n: f64,
    /// The chain's of the first term, and of all.
    pub chain_n: f64,
    pub with_n: f64,
}

impl Beside {
    /// Force without the errors that both forces of a mesh have.
    pub fn true_n(&self) -> f64 {
        self.ratio.map_or(self.hard_n - self.here_n + self.chain_n, |ratio| ratio * self.chain_n)
    }
}

impl Chain {
    /// What the law of a model has beyond what the chain makes of it, N over the place along the way down.
    pub(super) fn added_by_law(&self, (bare, detail): (&Model, Detail), job: &Job) -> Result<Curve, SolveError> {
        let passage = &self.passages[job.run];
        let deepest_mm = deepest_mm(&job.path);
        if deepest_mm <= 0.0 {
            return Ok(Vec::new());
        }
        // a curve through waves is least sure at its end, where the ball may stand for long
        let beyond_mm = BEYOND * deepest_mm;
        let rich = self.simulation((bare, detail), passage, Motion::ramp(beyond_mm, beyond_mm))?;
        let first = Simulation { material: plain(bare, self.nu(bare, passage))?, ..rich.clone() };
        let (rich, first) = (rich.curve(&[])?.profile, first.curve(&[])?.profile);
        let sizes = (1..=PLACES).map(|k| f64::from(k) / f64::from(PLACES));
        let ratios: Vec<(f64, f64, f64)> = sizes
            .clone()
            .map(|s| (s, s * s * beyond_mm))
            .map(|(s, d)| (2.0 * s - 1.0, rich.force_n(d) / first.force_n(d), s))
            .collect();
        let ratio = least_squares(&ratios, TERMS);
        let depth_mm: Vec<f64> = sizes.map(|s| s * s * deepest_mm).collect();
        let time_s: Vec<f64> = depth_mm.iter().map(|d| d / deepest_mm).collect();
        let moved = Passage { depth_mm, time_s, pressed_before_mm: 0.0, ..passage.clone() };
        let (with, without) = (self.on_ball(bare, &moved), self.on_ball(&first_term(bare), &moved));
        let ratio_at = |depth_mm: f64| clenshaw(&ratio, 2.0 * (depth_mm / beyond_mm).sqrt() - 1.0);
        let each = with.iter().zip(without).zip(&moved.depth_mm);
        let added = each.map(|((with, without), depth_mm)| without * ratio_at(*depth_mm) - with);
        Ok(std::iter::once((0.0, 0.0)).chain(moved.time_s.iter().copied().zip(added)).collect())
    }
}

/// Puts smooth functions in the place of the ratios of forces on every piece of a path, between its corners: over the size of the contact on the way down, over the root of the way
/// that has been gone after a turn, next to which friction turns as well. Pieces of few stations stay as they are.
pub(super) fn smooth_ratios(each: &mut [Beside], corners: &[f64]) {
    for piece in corners.windows(2) {
        let [from, to] = piece else { continue };
        let x = |place: f64| 2.0 * ((place - from) / (to - from)).clamp(0.0, 1.0).sqrt() - 1.0;
        let within = |b: &&Beside| b.place >= from - 1e-9 && b.place <= to + 1e-9;
        // what is read near contact is little, whatever part of it is wrong
        let points: Vec<(f64, f64, f64)> =
            each.iter().filter(within).filter_map(|b| Some((x(b.place), b.ratio?, b.here_n.sqrt()))).collect();
        if points.len() < 2 * TERMS {
            continue;
        }
        let ratio = least_squares(&points, TERMS);
        for b in each.iter_mut().filter(|b| b.place > *from && b.place <= to + 1e-9) {
            b.ratio = b.ratio.map(|_| clenshaw(&ratio, x(b.place)));
        }
    }
}
