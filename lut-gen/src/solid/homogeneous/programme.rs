//! Stretch over time.

use super::Mode;
use crate::solid::law::Material;
use crate::solid::solve::SolveError;

/// Stretches at times, straight in between: loading, unloading, cycles and holds.
///
/// Before the first time the specimen is undeformed and at rest; a first stretch other than 1 is reached at once.
#[derive(Debug, Clone, PartialEq)]
pub struct Programme {
    /// Times (s), each above the one before.
    pub time_s: Vec<f64>,
    /// Stretch at each time (-), positive; in [`Mode::SimpleShear`] one plus the amount of shear, any sign.
    pub stretch: Vec<f64>,
}

/// Longest step in stretch. Between samples the elastic stress is taken as straight in time; the curvature of one
/// percent of stretch costs a relaxing foam of exponent 10 less than 1e-4 of its stress (`tests/homogeneous.rs`).
const LONGEST: f64 = 0.01;
/// The same of a material without memory, where a step is no more than a first guess of the next lateral stretch.
const LONGEST_ELASTIC: f64 = 0.1;
/// First step of a hold in the shortest relaxation time, and growth of the next ones: as the finite elements'. The
/// first is rounded down to a power of two seconds, so that steps stay where they are when the time moves a little.
const HOLD_FIRST: f64 = 0.1;
const HOLD_GROWTH: f64 = 1.4;

/// One step: its duration (s), the stretch at its end and whether a sample of the programme lies there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Step {
    pub dt_s: f64,
    pub stretch: f64,
    pub sample: bool,
}

impl Programme {
    /// # Errors
    /// [`SolveError::Parameter`] when times and stretches differ in number, there are none, a time does not follow
    /// the one before, or a stretch is not finite or (but in shear) not positive.
    pub(super) fn check(&self, mode: Mode) -> Result<(), SolveError> {
        let (times, stretches) = (self.time_s.len(), self.stretch.len());
        if times != stretches || times == 0 {
            let expected = format!("must equal the number of times, {times}, and not be 0");
            return Err(SolveError::parameter("number of stretches", stretches as f64, &expected));
        }
        for (i, &t) in self.time_s.iter().enumerate() {
            if !t.is_finite() || (i > 0 && t <= self.time_s[i - 1]) {
                let expected = format!("(sample {i}) must be finite and above the time before it");
                return Err(SolveError::parameter("time_s", t, &expected));
            }
        }
        for (i, &l) in self.stretch.iter().enumerate() {
            if !l.is_finite() || (l <= 0.0 && mode != Mode::SimpleShear) {
                return Err(SolveError::parameter("stretch", l, &format!("(sample {i}) must be finite and positive")));
            }
        }
        Ok(())
    }

    /// The steps through all samples.
    pub(super) fn steps(&self, mode: Mode, material: &Material) -> Vec<Step> {
        let mut out = Vec::with_capacity(self.time_s.len());
        let shortest = material.prony.iter().map(|p| p.tau_s).fold(f64::INFINITY, f64::min);
        let first = (HOLD_FIRST * shortest).log2().floor().exp2();
        let longest = if material.is_elastic() { LONGEST_ELASTIC } else { LONGEST };
        let (mut from, mut before) = (1.0, None);
        for (&t, &l) in self.time_s.iter().zip(&self.stretch) {
            let duration = before.map_or(0.0, |b| t - b);
            let count =
                ((l - from).abs() / (longest * f64::min(1.0, from.abs().max(longest)))).ceil().max(1.0) as usize;
            if count == 1 && mode.has_free_side() && duration > first {
                hold(&mut out, duration, first, from, l);
            } else {
                let part = |i: usize| i as f64 / count as f64;
                let step = |i: usize| Step {
                    dt_s: duration / count as f64,
                    stretch: if i == count { l } else { from + (l - from) * part(i) },
                    sample: i == count,
                };
                out.extend((1..=count).map(step));
            }
            (from, before) = (l, Some(t));
        }
        out
    }
}

/// Steps that grow through a duration in which the stretch hardly moves, but the sides creep.
fn hold(out: &mut Vec<Step>, duration: f64, first: f64, from: f64, to: f64) {
    let (mut done, mut dt) = (0.0, first);
    while duration - done > 1.5 * dt {
        done += dt;
        out.push(Step { dt_s: dt, stretch: from + (to - from) * done / duration, sample: false });
        dt *= HOLD_GROWTH;
    }
    out.push(Step { dt_s: duration - done, stretch: to, sample: true });
}
