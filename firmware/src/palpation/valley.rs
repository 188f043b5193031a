//! The whole valley in which mu, alpha and contact point make up for each other, as mean and standard error of each.
//!
//! A press of 1 % noise leaves a valley that is long, bent, and at times has a second bottom at a softer, less bent curve and an earlier
//! contact: a covariance of one place is too small there, and the place may be the wrong one. So alpha takes values along the valley, from
//! where the filter ended outwards to both sides; a filter over the press finds mu, contact point and zero for each, with the probability of
//! the press ([`crate::kalman::bank`]). Mean and deviation are those of the posterior distribution.
//!
//! *Before the press* every column of the table's grid is as likely as another: the density is even in alpha and in ln mu, as the thesis' grid
//! is spaced. The contact point is known to [`ValleyConfig::contact_mm`], the zero as well as the samples before contact tell it.
//!
//! *A sample's variance* holds the force noise seen before contact, the probe's noise times the slope, and the table's error bound
//! ([`ValleyConfig::table_mm`]).

use super::record::Record;
use crate::contact::ContactPoint;
use crate::kalman::bank::{Member, Mixture};
use crate::kalman::indentation::AtExponent;
use crate::kalman::{Estimator, Prediction};
use crate::number::{limit, sqrt};
use crate::search::Slice;
use crate::surface::Surface;
use nalgebra::Vector3;
use protocol::lut::Table;

/// What the errors hold besides the noise of the force, and how the valley is walked.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ValleyConfig {
    /// Gain of the force that differs from press to press, standard deviation: 1 %, what spot and mounting do to repeated presses of one
    /// foam. It cannot be told from mu.
    pub press_gain: f32,
    /// Sensitivity of the load cell against its calibration: 0.5 %, usual for a bridge with amplifier.
    pub cell_gain: f32,
    /// Sensitivity of the probe's transducer: 0.2 %, the linearity of a conductive-plastic transducer.
    pub probe_gain: f32,
    /// Noise of a reading of the probe, mm: 0.76 codes (input noise and rounding) of 4096 over 100 mm, 16 readings averaged.
    pub probe_noise_mm: f32,
    /// Standard deviation of the contact point before the press, mm: as far as the refinement looks to either side.
    pub contact_mm: f32,
    /// Depth over which an error of the table keeps its sign, mm: it counts as that of one sample each such length. Meshes and
    /// interpolation err smoothly, over the size of the ball's contact.
    pub table_mm: f32,
    /// Distance of neighbouring values of ln alpha, in standard errors of the filter: sums over a bell curve are exact to 1e-7 up to 1.
    pub step: f32,
    /// Largest distance, for a filter that knows nothing.
    pub step_max: f32,
    /// A side ends where the logarithm of the weight has fallen by this: what follows counts less than 1e-6.
    pub fall: f32,
    /// Most values on a side.
    pub members: u8,
    /// Samples that a filter takes in one tick.
    pub samples: u8,
}

impl Default for ValleyConfig {
    fn default() -> Self {
        ValleyConfig {
            press_gain: 0.01,
            cell_gain: 0.005,
            probe_gain: 0.002,
            probe_noise_mm: 0.0046,
            contact_mm: 0.8,
            table_mm: 1.0,
            step: 0.75,
            step_max: 0.15,
            fall: 15.0,
            members: 24,
            samples: 96,
        }
    }
}

/// mu (MPa), alpha and how much deeper (mm) than the refined contact point says.
pub type Quantities = Vector3<f32>;

/// What a press says of its foam.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimated {
    /// Mean of each quantity.
    pub mean: Quantities,
    /// Standard error of each: noise, contact point, zero, table; no gain yet.
    pub deviations: Quantities,
    /// Samples used.
    pub samples: u16,
}

/// Which way alpha goes.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Side {
    Up,
    Down,
}

/// The part of a press that is used, the same for every alpha.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Part {
    /// Refined height of the surface, mm.
    height_mm: f32,
    /// Heights of the ball, mm.
    probe_mm: (f32, f32),
    /// Variance of the force noise, N^2.
    noise_n2: f32,
    /// Variance of the table's error, fraction of the force squared.
    table: f32,
}

impl Part {
    fn holds(&self, probe_mm: f32) -> bool {
        probe_mm >= self.probe_mm.0 && probe_mm <= self.probe_mm.1
    }
}

/// The walk along the valley.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Valley {
    part: Part,
    /// mu, alpha, d0 where the walk begins, and the slopes of mu and d0 by alpha there.
    begin: Quantities,
    by_alpha: (f32, f32),
    /// Distance of neighbours in ln alpha.
    step: f32,
    /// Least and largest alpha of the table.
    alphas: (f32, f32),
    side: Side,
    /// Steps from the beginning.
    place: u8,
    /// States (mu, d0, zero) at the beginning, one and two places before on this side.
    states: [Vector3<f32>; 3],
    before: Vector3<f32>,
    alpha: f32,
    /// Share of the cell of `alpha` that the table's range holds.
    share: f32,
    member: Member<3>,
    next: usize,
    mixture: Mixture<3>,
    samples: u16,
}

/// How far above the surface samples still belong to the press, mm: below that the zero's samples begin.
const ABOVE_MM: f32 = 0.1;

impl Valley {
    /// The walk from where the filter ended.
    pub fn new(
        config: &ValleyConfig,
        table: &Table<'_>,
        record: &Record,
        height_mm: f32,
        point: &ContactPoint,
        noise_n: f32,
        filtered: &Estimator<3>,
    ) -> Self {
        let (begin, covariance) = (filtered.filter.state, filtered.filter.covariance());
        let surface_mm = height_mm + begin[2];
        let mut part = Part {
            height_mm,
            probe_mm: (surface_mm - table.depth_max_mm(), surface_mm + ABOVE_MM),
            noise_n2: noise_n * noise_n,
            table: 0.0,
        };
        // An even distribution within the bound, once a length.
        let held = record.samples().iter().filter(|s| part.holds(s.probe_mm)).count() as f32;
        let bound = table.error_bound().total();
        part.table = bound * bound / 3.0 * config.table_mm * held / (part.probe_mm.1 - part.probe_mm.0);
        let variance = covariance[(1, 1)];
        let zero = noise_n / sqrt(f32::from(point.zero_samples.max(1)));
        let region = &filtered.region;
        let start = Vector3::new(begin[0], begin[2], 0.0);
        let mut valley = Valley {
            part,
            begin,
            by_alpha: (covariance[(0, 1)] / variance, covariance[(2, 1)] / variance),
            step: limit(config.step * sqrt(variance) / begin[1], 1e-3, config.step_max),
            alphas: (region.low[1], region.high[1]),
            side: Side::Up,
            place: 0,
            states: [start; 3],
            before: Vector3::new(region.high[0] - region.low[0], config.contact_mm, zero),
            alpha: begin[1],
            share: 1.0,
            member: Member::new(start, &start, start),
            next: 0,
            mixture: Mixture::new(begin),
            samples: 0,
        };
        valley.put(0);
        valley
    }

    /// Takes the next samples; the result after the last one of the last alpha. `None` inside if there is none.
    pub fn step(
        &mut self,
        config: &ValleyConfig,
        table: &Table<'_>,
        slice: &Slice,
        record: &Record,
    ) -> Option<Option<Estimated>> {
        let end = self.next + usize::from(config.samples.max(1));
        let curve = Surface::new(table, slice).and_then(|surface| surface.curve(self.alpha));
        let Some(curve) = curve else {
            return Some(None);
        };
        let (model, part) = (AtExponent { curve }, self.part);
        let probe_n2 = config.probe_noise_mm * config.probe_noise_mm;
        let variance = |p: &Prediction<3>| {
            let force_n = p.value;
            part.noise_n2 + probe_n2 * p.gradient[1] * p.gradient[1] + part.table * force_n * force_n
        };
        for sample in record.samples().iter().take(end).skip(self.next).filter(|s| part.holds(s.probe_mm)) {
            self.member.take(&model, part.height_mm - sample.probe_mm, sample.force_n, variance);
        }
        self.next = end;
        if end < record.samples().len() {
            return None;
        }
        let more = self.weigh(config) && self.put(self.place + 1);
        if more || self.turn() { None } else { Some(self.result()) }
    }

    /// Adds the alpha that has been gone through; false if nothing beyond it counts.
    fn weigh(&mut self, config: &ValleyConfig) -> bool {
        let (state, errors) = (self.member.filter.state, self.member.filter.deviations());
        // Density even in alpha and in ln mu; cells are even in ln alpha. `ln` of a negative mu is no number, which adds nothing.
        let log_weight = self.member.log_evidence + libm::logf(self.share * self.alpha / state[0]);
        let mean = Vector3::new(state[0], self.alpha, state[1]);
        self.mixture.add(log_weight, &mean, &Vector3::new(errors[0] * errors[0], 0.0, errors[1] * errors[1]));
        if self.place == 0 {
            (self.states, self.samples) = ([state; 3], self.member.samples);
        } else {
            (self.states[2], self.states[1]) = (self.states[1], state);
        }
        log_weight > self.mixture.largest() - config.fall && self.place < config.members
    }

    /// Begins with the alpha number `place` of this side; false if it lies outside the table.
    fn put(&mut self, place: u8) -> bool {
        let by = f32::from(place) * self.step;
        let (low, high) = (libm::logf(self.alphas.0), libm::logf(self.alphas.1));
        let middle = libm::logf(self.begin[1]) + if self.side == Side::Up { by } else { -by };
        // The part of the cell that lies in the table's range.
        let cell = (limit(middle - 0.5 * self.step, low, high), limit(middle + 0.5 * self.step, low, high));
        self.share = (cell.1 - cell.0) / self.step;
        if !(self.share > 0.0) {
            return false;
        }
        self.alpha = limit(libm::expf(limit(middle, low, high)), self.alphas.0, self.alphas.1);
        let [begin, last, but_last] = self.states;
        let reference = match place {
            0 => begin,
            1 => {
                let off = self.alpha - self.begin[1];
                Vector3::new(begin[0] + self.by_alpha.0 * off, begin[1] + self.by_alpha.1 * off, begin[2])
            }
            _ => Vector3::new(2.0 * last[0] - but_last[0], 2.0 * last[1] - but_last[1], last[2]),
        };
        self.member = Member::new(Vector3::new(self.begin[0], self.begin[2], 0.0), &self.before, reference);
        (self.place, self.next) = (place, 0);
        true
    }

    /// Goes on with the other side; false if there is none.
    fn turn(&mut self) -> bool {
        if self.side == Side::Down {
            return false;
        }
        self.side = Side::Down;
        self.states = [self.states[0]; 3];
        self.put(1)
    }

    fn result(&self) -> Option<Estimated> {
        let (mean, variance) = self.mixture.moments()?;
        (self.samples > 0).then_some(Estimated { mean, deviations: variance.map(sqrt), samples: self.samples })
    }
}
