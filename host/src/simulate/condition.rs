//! Conditions: everything computed once that the runs of one template share.

use std::sync::Arc;

use super::coupon::TrueCoupon;
use super::effect::machine::Machine;
use super::motion::Programme;
use super::plan::Weighted;
use super::response::{Elastic, History, Moment, Phase};
use super::session::share;
use super::solver::Curve;

/// Steps of the time grid of machine and sensor between two samples.
pub(super) const FINE: usize = 4;

/// What a template's runs share.
#[derive(Debug, Clone)]
pub(super) struct Condition {
    /// Index among the specimens in the order of the specification, if one is touched.
    pub specimen: Option<usize>,
    /// Index among the balls, if one touches it.
    pub indenter: Option<usize>,
    /// The specimen as one that is shortened as a whole.
    pub coupon: Option<TrueCoupon>,
    pub programme: Programme,
    /// Duration of a run, s.
    pub duration_s: f64,
    pub machine: Machine,
    /// Curve of each height: of the specimen, or, where it is tilted, of its lowest and highest spot.
    pub heights: Vec<(f64, Weighted<Arc<Curve>>)>,
    pub elastic: Elastic,
    pub history: History,
    /// True depth (mm) of the nominal spot on the fine grid, where time counts.
    pub nominal_mm: Vec<f64>,
    pub slope: Option<(f64, f64)>,
}

impl Condition {
    /// Elastic response of the spot of a number (from 0).
    pub fn spot(&self, replicate: usize) -> Elastic {
        let mut elastic = self.elastic.clone();
        if let (Some((angle, distance_mm)), [_, low, high]) = (self.slope, self.heights.as_slice()) {
            let higher = distance_mm * share(replicate) * angle.tan();
            let part = (0.5 * (low.0 + high.0) + higher - low.0) / (high.0 - low.0);
            elastic.parts = low.1.iter().map(|(w, c)| (w * (1.0 - part), c.clone())).collect();
            elastic.parts.extend(high.1.iter().map(|(w, c)| (w * part, c.clone())));
        }
        elastic
    }

    /// Recorded depth (mm) every `step_s`.
    pub fn recorded(&self, step_s: f64) -> Vec<f64> {
        let count = (self.duration_s / step_s + 1e-9) as usize + 1;
        (0..count).map(|k| self.programme.depth_at(step_s * k as f64)).collect()
    }

    /// True depth (mm) every `step_s` of a nominal spot, with the force in the machine's compliance that history is known to make.
    pub fn trajectory(&self, step_s: f64) -> Vec<f64> {
        let driven = self.machine.driven(&self.recorded(step_s), step_s);
        if self.machine.compliance_mm_per_n == 0.0 {
            return driven;
        }
        let one = |(k, z): (usize, &f64)| {
            let mut moment = self.moment(step_s * k as f64, *z, *z, 1);
            moment.nominal_mm = self.nominal_mm.get(k).copied().unwrap_or(*z);
            self.pressed(&self.history, &self.elastic, moment).0
        };
        driven.iter().enumerate().map(one).collect()
    }

    /// A moment of a run at a time (s), where the machine drives the ball to `depth_mm` from a largest depth of `peak_mm`.
    pub fn moment(&self, time_s: f64, depth_mm: f64, peak_mm: f64, cycle: usize) -> Moment {
        let end_s = self.programme.down_s();
        let start_s = end_s + self.programme.hold_s;
        let phase = if time_s <= end_s {
            Phase::Down { end_s }
        } else if time_s <= start_s || !self.programme.unload {
            Phase::Hold
        } else {
            Phase::Back { start_s }
        };
        let rate_mm_s = self.programme.rate_mm_s;
        Moment {
            time_s,
            depth_mm,
            nominal_mm: depth_mm,
            rate_mm_s,
            phase,
            peak_mm,
            before_mm: 0.0,
            back: false,
            cycle,
            memory: 1.0,
        }
    }

    /// True depth (mm) and force (N) where the machine drives the ball to `at.depth_mm`: `y + c F(y) = z` by Newton's method.
    pub fn pressed(&self, history: &History, elastic: &Elastic, at: Moment) -> (f64, f64) {
        let compliance = self.machine.compliance_mm_per_n;
        let wanted = at.depth_mm;
        let mut moment = at;
        let (mut force, mut slope) = history.force_n(elastic, &moment);
        if compliance == 0.0 || wanted <= 0.0 {
            return (wanted, force);
        }
        let (mut low, mut high) = (0.0, wanted);
        for _ in 0..ITERATIONS {
            let miss = moment.depth_mm + compliance * force - wanted;
            if miss.abs() < 1e-10 {
                break;
            }
            if miss > 0.0 {
                high = moment.depth_mm;
            } else {
                low = moment.depth_mm;
            }
            let next = moment.depth_mm - miss / (1.0 + compliance * slope.max(0.0));
            moment.depth_mm = if next > low && next < high { next } else { 0.5 * (low + high) };
            (force, slope) = history.force_n(elastic, &moment);
        }
        (moment.depth_mm, force)
    }
}

const ITERATIONS: usize = 50;
