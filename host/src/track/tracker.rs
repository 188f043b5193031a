//! A tip followed through frames.

use super::align::{Aligner, Fit};
use super::candidate::{ANYWHERE, Candidate, Demand, NEAR};
use super::clutter::Clutter;
use super::covariance::{Spread, Sums};
use super::error::TrackError;
use super::frame::{Frame, Roi};
use super::gaussian::{NOISE_LEFT, Sampler};
use super::noise::pixel_noise;
use super::robust::{Tolerance, held};
use super::search::Search;
use super::template::{LEAST_SIDE_PX, Template};

/// The shorter side of the template at the coarsest level is at least this, pixels of the level.
const COARSEST_SIDE_PX: usize = 16;
/// The near search reaches so far at least to either side, pixels.
const NEAR_PX: f64 = 32.0;
/// and so many pixels of the coarsest level.
const NEAR_COARSE: usize = 10;
/// Most columns or rows of places that are searched at the coarsest level: memory is wanted for all of them.
const WIDEST_SEARCH: usize = 2048;
/// Contrast of a region over that of its noise, below which there is nothing to follow.
const LEAST_CONTRAST: f64 = 2.0;
/// Frames over which the kind of residuals is averaged.
const REMEMBERED: f64 = 30.0;
/// Share of the position's variance that is not there in the first frame: a frame's own noise and the template's are alike.
const FRESH: f64 = 0.5;
/// Edges between pixels and rounding put a shift off by so much that residuals do not tell, pixels.
const SYSTEMATIC_PX: f64 = 0.005;

/// Where the tip is in a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tip {
    /// Column and row, pixels; the middle of the upper left pixel is (0, 0).
    pub place_px: [f64; 2],
    /// Standard deviation of either, pixels, with the noise of the first frame.
    pub sigma_px: [f64; 2],
    /// The part of it that is this frame's own, pixels: how far positions of two later frames can be told apart.
    pub own_sigma_px: [f64; 2],
    /// Correlation with the first frame, of what is seen of the tip; 1 at best.
    pub correlation: f64,
    /// Part of the tip's edges that is seen, 0 to 1.
    pub seen: f64,
    /// Contrast over that in the first frame.
    pub gain: f64,
}

/// What has been found so far.
#[derive(Debug, Clone, Copy)]
struct Known {
    shift: [f64; 2],
    velocity: [f64; 2],
    gain: f64,
    lost: bool,
}

/// Part of the tip that is seen when nothing hides it.
const WHOLE: f64 = 0.75;

/// So near to where it is expected a tip may be half hidden, pixels beside its last step.
const EXPECTED_PX: f64 = 5.0;

/// Follows what a region of the first frame shows.
#[derive(Debug)]
pub struct Tracker {
    size: (usize, usize),
    /// Place of the tip in the first frame.
    tip: [f64; 2],
    /// From the frame's own pixels to the coarsest.
    levels: Vec<Template>,
    tolerance: Tolerance,
    clutter: Clutter,
    near: Search,
    anywhere: Option<Search>,
    /// Correlation that noise leaves.
    expected: f64,
    known: Known,
    /// Variance that neighbourhoods of residuals tell, over that of noise; and of how many frames it is the mean.
    kind: ([f64; 2], f64),
    aligner: Aligner,
    sums: Sums,
    residuals: Vec<f32>,
    first: Tip,
}

impl Tracker {
    /// Learns what the region shows. `tip` is the point whose place is told, in the first frame; the region's middle if none.
    ///
    /// # Errors
    /// A region outside the frame, one that is too small, one without contrast, a tip far from its region.
    pub fn new(frame: &Frame, roi: Roi, tip: Option<[f64; 2]>) -> Result<Self, TrackError> {
        if frame.pixels.len() != frame.width.saturating_mul(frame.height) {
            let (count, width, height) = (frame.pixels.len(), frame.width, frame.height);
            return Err(TrackError::Pixels { count, width, height });
        }
        if !roi.is_inside(frame.width, frame.height) {
            return Err(TrackError::Outside { roi, width: frame.width, height: frame.height });
        }
        if roi.width.min(roi.height) < LEAST_SIDE_PX {
            return Err(TrackError::Small { roi });
        }
        let tip = tip.unwrap_or(roi.middle());
        if !(tip[0].abs() < 1e6 && tip[1].abs() < 1e6) {
            return Err(TrackError::Tip { tip });
        }
        let mut sampler = Sampler::default();
        let mut levels = vec![Template::new(frame, roi, 0, &mut sampler)];
        let mut smaller = frame.clone();
        let mut level = 0;
        while roi.width.min(roi.height) >> (level + 1) >= COARSEST_SIDE_PX {
            level += 1;
            smaller = smaller.halved();
            levels.push(Template::new(&smaller, roi, level, &mut sampler));
        }
        let noise = pixel_noise(frame, roi);
        let variance = levels[0].contrast_variance();
        let of_noise = noise * noise * NOISE_LEFT;
        if variance < LEAST_CONTRAST * LEAST_CONTRAST * of_noise {
            return Err(TrackError::Flat { roi, contrast: variance.sqrt(), noise: of_noise.sqrt() });
        }
        let scale = 1 << level;
        let reach = NEAR_COARSE.max((NEAR_PX / f64::from(scale)).ceil() as usize);
        let near = Search::new(&levels[level as usize], (2 * reach + 1, 2 * reach + 1));
        let tolerance = Tolerance::new(&levels[0], noise);
        let known = Known { shift: [0.0; 2], velocity: [0.0; 2], gain: 1.0, lost: false };
        let blank =
            Tip { place_px: tip, sigma_px: [0.0; 2], own_sigma_px: [0.0; 2], correlation: 1.0, seen: 1.0, gain: 1.0 };
        let mut tracker = Self {
            size: (frame.width, frame.height),
            tip,
            levels,
            tolerance,
            clutter: Clutter::default(),
            near,
            anywhere: None,
            expected: ((variance - of_noise) / variance).clamp(0.3, 1.0),
            known,
            kind: ([1.0; 2], 0.0),
            aligner: Aligner::default(),
            sums: Sums::default(),
            residuals: Vec::new(),
            first: blank,
        };
        tracker.first.own_sigma_px = tracker.first_sigma(frame, of_noise);
        tracker.first.sigma_px = tracker.first.own_sigma_px;
        Ok(tracker)
    }

    /// The tip in the first frame: its place is exact by definition, its uncertainty that of the template.
    #[must_use]
    pub fn first(&self) -> Tip {
        self.first
    }

    /// Uncertainty that the template's own noise leaves.
    fn first_sigma(&mut self, frame: &Frame, of_noise: f64) -> [f64; 2] {
        let template = &self.levels[0];
        let Some(fit) = self.aligner.align(template, frame, [0.0; 2], 1, None) else { return [f64::INFINITY; 2] };
        let residuals = vec![(2.0 * of_noise).sqrt() as f32; template.inside.len()];
        let spread = self.sums.spread(template, &fit, &template.inside, &residuals);
        let sigma =
            |axis: usize| spread.map_or(f64::INFINITY, |s| (FRESH * s.noise[axis] + SYSTEMATIC_PX.powi(2)).sqrt());
        [sigma(0), sigma(1)]
    }

    /// The tip in the next frame; `None` where it is lost.
    ///
    /// # Errors
    /// A frame of another size.
    pub fn step(&mut self, frame: &Frame) -> Result<Option<Tip>, TrackError> {
        if (frame.width, frame.height) != self.size || frame.pixels.len() != frame.width * frame.height {
            return Err(TrackError::Size { width: frame.width, height: frame.height, expected: self.size });
        }
        let mut smaller: Vec<Frame> = Vec::new();
        for _ in 1..self.levels.len() {
            let next = smaller.last().unwrap_or(frame).halved();
            smaller.push(next);
        }
        let frames: Vec<&Frame> = std::iter::once(frame).chain(&smaller).collect();
        let found = self.nearby(&frames).or_else(|| self.elsewhere(&frames));
        Ok(self.remember(found))
    }

    fn coarsest(&self) -> &Template {
        &self.levels[self.levels.len() - 1]
    }

    /// Around where it is expected.
    fn nearby(&mut self, frames: &[&Frame]) -> Option<Candidate> {
        if self.known.lost {
            return None;
        }
        let Known { shift, velocity, .. } = self.known;
        let ahead = [shift[0] + velocity[0], shift[1] + velocity[1]];
        let scale = self.coarsest().scale;
        let reach = self.near.reach();
        let from = [0, 1].map(|axis| (ahead[axis] / scale).round() as i64 - reach[axis]);
        let coarse = self.levels.len() - 1;
        let places = self.near.places(&self.levels[coarse], frames[coarse], from);
        let starts = std::iter::once(ahead).chain(places.iter().map(|place| place.shift.map(|s| s * scale)));
        self.best(frames, starts.collect())
    }

    /// Anywhere in the frame, of a very large one around the last place.
    fn elsewhere(&mut self, frames: &[&Frame]) -> Option<Candidate> {
        let coarse = self.levels.len() - 1;
        let template = &self.levels[coarse];
        let size = [frames[coarse].width, frames[coarse].height];
        let places = size.map(|length| length.min(WIDEST_SEARCH));
        let search = self.anywhere.get_or_insert_with(|| Search::new(template, (places[0], places[1])));
        let half = [template.size.0 / 2, template.size.1 / 2];
        let from = [0, 1].map(|axis| {
            let first = -(template.corner[axis].round() as i64) - half[axis] as i64;
            let around = (self.known.shift[axis] / template.scale).round() as i64 - places[axis] as i64 / 2;
            around.clamp(first, first + (size[axis] - places[axis]) as i64)
        });
        let places = search.places(template, frames[coarse], from);
        let scale = template.scale;
        let starts = places.iter().map(|place| place.shift.map(|s| s * scale)).collect();
        self.best(frames, starts)
    }

    /// The best place that a start leads to, if it shows what it must.
    fn best(&mut self, frames: &[&Frame], starts: Vec<[f64; 2]>) -> Option<Candidate> {
        let mut found: Vec<Fit> = Vec::new();
        for start in starts {
            let Some(fit) = self.descend(frames, start) else { continue };
            let is_same = |other: &Fit| (0..2).all(|axis| (other.shift[axis] - fit.shift[axis]).abs() < 0.5);
            if found.iter().any(is_same) {
                continue;
            }
            let good = fit.normal.correlation() > 0.95 * self.expected;
            found.push(fit);
            if good {
                break;
            }
        }
        found.sort_by(|a, b| b.normal.correlation().total_cmp(&a.normal.correlation()));
        for fit in found.into_iter().take(2) {
            let demand = self.demand(fit.shift);
            let candidate = self.weighed(frames[0], fit);
            if let Some(candidate) = candidate.filter(|c| c.meets(demand, self.expected, self.known.gain)) {
                return Some(candidate);
            }
        }
        None
    }

    /// What a place must show.
    fn demand(&self, shift: [f64; 2]) -> &'static Demand {
        let Known { shift: last, velocity, lost, .. } = self.known;
        let off = (shift[0] - last[0] - velocity[0]).hypot(shift[1] - last[1] - velocity[1]);
        let is_expected = !lost && off < EXPECTED_PX + velocity[0].hypot(velocity[1]);
        if is_expected { &NEAR } else { &ANYWHERE }
    }

    /// From the coarsest level to the pixels.
    fn descend(&mut self, frames: &[&Frame], start: [f64; 2]) -> Option<Fit> {
        let mut shift = start;
        let mut last = None;
        for (level, (template, frame)) in self.levels.iter().zip(frames).enumerate().rev() {
            let steps = if level == 0 { 10 } else { 4 };
            let fit = self.aligner.align(template, frame, shift.map(|s| s / template.scale), steps, None)?;
            shift = fit.shift.map(|s| s * template.scale);
            last = Some(fit);
        }
        last
    }

    /// The fit with what is hidden, and what is ground, left out.
    fn weighed(&mut self, frame: &Frame, fit: Fit) -> Option<Candidate> {
        let template = &self.levels[0];
        let known = self.clutter.trust();
        let trust = known.unwrap_or(&template.inside);
        let mut fit = self.aligner.align(template, frame, fit.shift, 6, known)?;
        let correlation = fit.normal.correlation();
        let mut weights = Vec::new();
        self.aligner.residuals(template, &fit, &mut self.residuals);
        self.tolerance.weigh(&fit, &self.residuals, 1.0, trust, &mut weights);
        let is_whole = held(template, &weights, trust) > 0.9 && correlation > 0.95 * self.expected;
        if !is_whole {
            for wider in [4.0, 2.0, 1.0, 1.0] {
                self.tolerance.weigh(&fit, &self.residuals, wider, trust, &mut weights);
                fit = self.aligner.align(template, frame, fit.shift, 3, Some(&weights))?;
                self.aligner.residuals(template, &fit, &mut self.residuals);
            }
        }
        let spread = self.sums.spread(template, &fit, &self.aligner.weights, &self.residuals)?;
        let correlation_of_seen = fit.normal.correlation();
        self.tolerance.weigh(&fit, &self.residuals, 1.0, trust, &mut weights);
        for (weight, inside) in weights.iter_mut().zip(&self.aligner.weights) {
            *weight = if *inside > 0.0 { *weight } else { 0.0 };
        }
        let seen = held(template, &weights, trust);
        Some(Candidate { seen, fit, correlation, correlation_of_seen, spread })
    }

    fn remember(&mut self, found: Option<Candidate>) -> Option<Tip> {
        let Some(found) = found else {
            self.known = Known { velocity: [0.0; 2], lost: true, ..self.known };
            return None;
        };
        if found.seen > WHOLE {
            // The residuals are those of the place that was taken: it was tried last.
            self.clutter.learn(&self.levels[0], &self.tolerance, &found.fit, &self.residuals);
        }
        let (shift, before) = (found.fit.shift, self.known);
        let velocity = if before.lost { [0.0; 2] } else { [shift[0] - before.shift[0], shift[1] - before.shift[1]] };
        let gain = before.gain + 0.2 * (found.fit.gain() - before.gain);
        self.known = Known { shift, velocity, gain, lost: false };
        let (kind, count) = &mut self.kind;
        *count = (*count + 1.0).min(REMEMBERED);
        let Spread { noise, local, .. } = found.spread;
        let mut sigma_px = [0.0; 2];
        let mut own_sigma_px = [0.0; 2];
        for axis in 0..2 {
            let ratio = if noise[axis] > 0.0 { local[axis] / noise[axis] } else { 1.0 };
            kind[axis] += (ratio.clamp(0.1, 100.0) - kind[axis]) / *count;
            let variance = noise[axis] * kind[axis].max(1.0);
            sigma_px[axis] = (variance + SYSTEMATIC_PX.powi(2)).sqrt();
            own_sigma_px[axis] = (FRESH * variance + SYSTEMATIC_PX.powi(2)).sqrt();
        }
        let place_px = [self.tip[0] + shift[0], self.tip[1] + shift[1]];
        let correlation = found.correlation_of_seen;
        Some(Tip { place_px, sigma_px, own_sigma_px, correlation, seen: found.seen.min(1.0), gain: found.fit.gain() })
    }
}
