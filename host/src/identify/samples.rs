//! The samples of a run that a fit works on: without the zero of the sensor, and averaged where there are very many.

use std::ops::Range;

use crate::experiment::Run;
use crate::experiment::motion::Motion;
use crate::experiment::signal::averaged;

use super::data::Selection;
use super::zero::{Approach, Unsure};

/// More samples of a way are averaged over neighbours: the bend of the force within one in so many is a millionth of its largest.
const MOST_SAMPLES: usize = 4000;
/// Exponent with which force begins over depth under a ball, and under a face.
pub(super) const BALL_EXPONENT: f64 = 1.5;
pub(super) const FACE_EXPONENT: f64 = 1.0;

/// What the sensor of a run reads without a contact.
pub(super) struct Zero {
    /// What was read before contact.
    pub(super) approach: Option<Approach>,
    /// It is not nothing.
    pub(super) is_off: bool,
}

impl Zero {
    /// Forces of samples without it, N.
    pub(super) fn taken_off(&self, run: &Run, samples: std::ops::Range<usize>) -> Vec<f64> {
        let (depth, force) = (&run.recording.depth_mm[samples.clone()], &run.recording.force_n[samples]);
        match self.approach.filter(|_| self.is_off) {
            Some(approach) => force.iter().zip(depth).map(|(force, depth)| force - approach.at(*depth)).collect(),
            None => force.to_vec(),
        }
    }
}

impl Selection {
    /// Takes zeros of the force as they were recorded, or read from the approach, without a prior.
    pub(super) fn trust_zeros(&mut self) {
        for curve in &mut self.curves {
            (curve.unsure, curve.zero_is_free) = (Unsure::default(), false);
        }
    }

    /// The zero that the approach of a run shows; told where it is none.
    pub(super) fn zero_of(&mut self, run: &Run, motion: &Motion, exponent: f64) -> Zero {
        let (depth, force) = (&run.recording.depth_mm, &run.recording.force_n);
        let end = motion.loading.end;
        let approach = Approach::of(&depth[..end], &force[..end], exponent);
        let largest = force[motion.loading.clone()].iter().copied().fold(0.0, f64::max);
        let is_off = approach.is_some_and(|approach| approach.is_off(largest));
        if let Some(approach) = approach.filter(|_| is_off) {
            self.messages.push(format!("{}: {approach}", run.file));
        }
        Zero { approach, is_off }
    }
}

/// Samples of a way of the ball, or of a hold.
pub(super) struct Samples {
    pub depth_mm: Vec<f64>,
    pub force_n: Vec<f64>,
    pub time_s: Vec<f64>,
    /// So many were averaged to one.
    pub together: usize,
}

impl Samples {
    /// Of a part of a run.
    pub(super) fn of(run: &Run, zero: &Zero, part: Range<usize>) -> Self {
        let together = part.len().div_ceil(MOST_SAMPLES).max(1);
        let mean = |values: &[f64]| averaged(values, together);
        Self {
            depth_mm: mean(&run.recording.depth_mm[part.clone()]),
            force_n: mean(&zero.taken_off(run, part.clone())),
            time_s: mean(&run.recording.time_s[part]),
            together,
        }
    }

    pub(super) fn len(&self) -> usize {
        self.depth_mm.len()
    }

    /// Leaves out what lies deeper, mm.
    pub(super) fn cut(&mut self, deepest_mm: f64) {
        let keep: Vec<bool> = self.depth_mm.iter().map(|depth| *depth <= deepest_mm).collect();
        for values in [&mut self.depth_mm, &mut self.force_n, &mut self.time_s] {
            let mut flags = keep.iter();
            values.retain(|_| flags.next().copied().unwrap_or(false));
        }
    }

    /// Adds what comes after.
    pub(super) fn append(&mut self, mut later: Self) {
        self.depth_mm.append(&mut later.depth_mm);
        self.force_n.append(&mut later.force_n);
        self.time_s.append(&mut later.time_s);
    }
}
