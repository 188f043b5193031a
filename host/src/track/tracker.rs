//! A tip followed through frames.

use super::align::{Aligner, Fit};
use super::candidate::Candidate;
use super::clutter::Clutter;
use super::covariance::Sums;
use super::error::TrackError;
use super::frame::{Frame, Roi};
use super::gaussian::{NOISE_LEFT, Sampler};
use super::known::Known;
use super::noise::pixel_noise;
use super::robust::{Tolerance, held, keep_away, least_held};
use super::search::Search;
use super::stated::{self, Stated};
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

/// Part of the tip that is seen when nothing hides it.
const WHOLE: f64 = 0.75;

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
    stated: Stated,
    aligner: Aligner,
    sums: Sums,
    residuals: Vec<f32>,
    memory: [Vec<f32>; 3],
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
        let noise = pixel_noise(frame, roi);
        let mut sampler = Sampler::default();
        let mut levels = vec![Template::new(frame, roi, 0, noise, &mut sampler)];
        let mut smaller = frame.clone();
        let mut level = 0;
        while roi.width.min(roi.height) >> (level + 1) >= COARSEST_SIDE_PX {
            level += 1;
            smaller = smaller.halved();
            levels.push(Template::new(&smaller, roi, level, noise / f64::from(1_u32 << level), &mut sampler));
        }
        let variance = levels[0].contrast_variance();
        let of_noise = noise * noise * NOISE_LEFT;
        if variance < LEAST_CONTRAST * LEAST_CONTRAST * of_noise {
            return Err(TrackError::Flat { roi, contrast: variance.sqrt(), noise: of_noise.sqrt() });
        }
        let scale = 1 << level;
        let reach = NEAR_COARSE.max((NEAR_PX / f64::from(scale)).ceil() as usize);
        let near = Search::new(&levels[level as usize], (2 * reach + 1, 2 * reach + 1));
        let tolerance = Tolerance::new(&levels[0], noise);
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
            known: Known::default(),
            stated: Stated::default(),
            aligner: Aligner::default(),
            sums: Sums::default(),
            residuals: Vec::new(),
            memory: Default::default(),
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
        stated::of_template(spread)
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
        if self.known.is_lost() {
            return None;
        }
        let ahead = self.known.ahead();
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
            let demand = self.known.demand(fit.shift);
            let candidate = self.weighed(frames[0], fit);
            if let Some(candidate) = candidate.filter(|c| c.meets(demand, self.expected, self.known.gain)) {
                return Some(candidate);
            }
        }
        None
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
                keep_away(&mut weights, trust, template.size.0, &mut self.memory);
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
        let least_seen = least_held(template, &weights, trust);
        Some(Candidate { seen, least_seen, fit, correlation, correlation_of_seen, spread })
    }

    fn remember(&mut self, found: Option<Candidate>) -> Option<Tip> {
        let Some(found) = found else {
            self.known.miss();
            return None;
        };
        if found.seen > WHOLE {
            // The residuals are those of the place that was taken: it was tried last.
            self.clutter.learn(&self.levels[0], &self.tolerance, &found.fit, &self.residuals);
        }
        let (shift, gain) = (found.fit.shift, found.fit.gain());
        self.known.find(shift, gain);
        let sigma = self.stated.of(&found);
        Some(Tip {
            place_px: [self.tip[0] + shift[0], self.tip[1] + shift[1]],
            sigma_px: sigma.total,
            own_sigma_px: sigma.own,
            correlation: found.correlation_of_seen,
            seen: found.seen.min(1.0),
            gain,
        })
    }
}
