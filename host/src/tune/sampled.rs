//! The sampled loop as it runs: the board's own controller, a held command, dead time, and the plant exactly between ticks.

use nalgebra::{DMatrix, DVector};

use super::gains::Gains;
use super::shaft::Shaft;
use super::step::{AtTicks, Extremes, HORIZON_S, Step, unstable};
use super::windup::{Controller, Windup};
use crate::actuator::flaws::Flaws;
use crate::actuator::plant::Plant;

/// Parts of a tick at which the shaft is looked at, so that it keeps its limits between ticks as well.
const PARTS: usize = 10;
/// A response is over when error and change of the command have been smaller than this for [`REST`] ticks (mm, V): about what
/// the board's f32 can tell.
const STILL: f64 = 2e-7;
/// As [`STILL`].
const REST: usize = 50;
/// An error of this, mm, is that of a loop which is not stable.
const LOST: f64 = 100.0;

/// How the loop is sampled.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sampling {
    /// Period, s.
    pub tick_s: f64,
    /// Ticks from a reading to the command that follows from it: 1 on the board, 0 in theory.
    pub ticks_late: usize,
    /// Limit that the board puts on its command, V; none where the command is a wish that must keep within limits by itself.
    pub limit_v: Option<f64>,
    /// What the integral does at that limit.
    pub windup: Windup,
}

impl Sampling {
    /// The board's 50 Hz with so many ticks of delay, and no limit on the command.
    pub const fn board(ticks_late: usize) -> Self {
        Self { tick_s: 0.02, ticks_late, limit_v: None, windup: Windup::Board }
    }
}

/// The plant's exact motion over the parts of a tick, for a command that changes once in it.
#[derive(Debug, Clone)]
pub struct Exact {
    sampling: Sampling,
    order: usize,
    /// Whole ticks from a command to its effect.
    late: usize,
    /// State after a tick: matrix in rows, effect of the earlier and of the later command.
    tick: (Vec<f64>, Vec<f64>, Vec<f64>),
    /// Shaft after each part: row on the state, effects of both commands.
    parts: Vec<(Vec<f64>, f64, f64)>,
    flaws: Option<(Flaws, Plant)>,
}

impl Exact {
    /// Prepares a plant.
    pub fn new(plant: &Plant, sampling: Sampling, flaws: Flaws) -> Self {
        Self::prepared(plant, sampling, flaws, PARTS)
    }

    /// Prepares a plant without flaws that is looked at in ticks alone.
    pub fn of_ticks(plant: &Plant, sampling: Sampling) -> Self {
        Self::prepared(plant, sampling, Flaws::NONE, 1)
    }

    fn prepared(plant: &Plant, sampling: Sampling, flaws: Flaws, count: usize) -> Self {
        let tick = sampling.tick_s;
        // A command k acts from (k + late) T + rest on.
        let (whole, rest) = split(plant.delay_s, tick);
        let (_, _, c) = plant.state_space();
        let at = |s: f64| -> (DMatrix<f64>, DVector<f64>, DVector<f64>) {
            let (phi, both) = plant.held(s);
            if s <= rest {
                let none = DVector::zeros(plant.order());
                return (phi, both, none);
            }
            let later = plant.held(s - rest).1;
            let earlier = both - &later;
            (phi, earlier, later)
        };
        let parts = (1..=count).map(|i| {
            let (phi, earlier, later) = at(tick * i as f64 / count as f64);
            let row: Vec<f64> = (c.transpose() * phi).iter().copied().collect();
            (row, c.dot(&earlier), c.dot(&later))
        });
        let parts = parts.collect();
        let (phi, earlier, later) = at(tick);
        let rows = |m: DMatrix<f64>| m.transpose().as_slice().to_vec();
        Self {
            sampling,
            order: plant.order(),
            late: whole + sampling.ticks_late,
            tick: (rows(phi), earlier.as_slice().to_vec(), later.as_slice().to_vec()),
            parts,
            flaws: flaws.any().then(|| (flaws, plant.clone())),
        }
    }

    /// What a unit step gives; large numbers where the loop is not stable.
    pub fn evaluate(&self, gains: &Gains) -> Step {
        self.scaled(gains, 1.0, &mut |_, _, _| {})
    }

    /// The shoots of a step of `size_mm` at the ticks alone.
    pub fn at_ticks(&self, gains: &Gains, size_mm: f64) -> AtTicks {
        self.both(gains, size_mm).1
    }

    /// What a unit step gives, shoots read at the ticks alone.
    pub fn read_at_ticks(&self, gains: &Gains) -> Step {
        let (step, AtTicks { overshoot, undershoot }) = self.both(gains, 1.0);
        Step { overshoot, undershoot, ..step }
    }

    fn both(&self, gains: &Gains, size_mm: f64) -> (Step, AtTicks) {
        let mut extremes = Extremes::default();
        let step = self.scaled(gains, size_mm, &mut |_, shaft, command| {
            if command.is_finite() {
                extremes.see(1.0 - shaft / size_mm);
            }
        });
        let (overshoot, undershoot) = (extremes.overshoot.max(0.0), extremes.undershoot);
        // A loop that is lost has the shoots of one.
        let lost = step.overshoot >= 10.0;
        let at_ticks = if lost {
            AtTicks { overshoot: step.overshoot, undershoot: step.undershoot }
        } else {
            AtTicks { overshoot, undershoot }
        };
        (step, at_ticks)
    }

    /// The same for a step of `size_mm`, read as for one of 1 mm (with limits on command and speed they differ); calls `see` with
    /// time (s), shaft (mm) and command (V).
    pub fn scaled(&self, gains: &Gains, size_mm: f64, see: &mut impl FnMut(f64, f64, f64)) -> Step {
        let Sampling { tick_s, limit_v, windup, .. } = self.sampling;
        let mut controller = Controller::new(gains, tick_s, limit_v, windup);
        let mut plant = Moving::new(self);
        let (mut cost, mut command, mut extremes) = (0.0, 0.0f64, Extremes::default());
        let (mut still, mut last) = (0, f64::INFINITY);
        let ticks = (HORIZON_S / tick_s).round() as usize;
        let mut past = vec![0.0; self.late + 1];
        for k in 0..=ticks {
            let error = size_mm - plant.shaft;
            let here = error.abs() < LOST * size_mm;
            if !here {
                return unstable(10.0 / (k as f64 * tick_s));
            }
            let u = controller.step(error);
            see(k as f64 * tick_s, plant.shaft, u);
            cost += error.abs();
            command = command.max(u.abs());
            still = if error.abs() < STILL * size_mm && (u - last).abs() < STILL * size_mm { still + 1 } else { 0 };
            last = u;
            if still > REST {
                break;
            }
            let slots = past.len();
            past[k % slots] = u;
            // The command of `late` ticks ago begins to act in this tick, the one before acts until then.
            let of = |ago: usize| if k >= ago { past[(k - ago) % slots] } else { 0.0 };
            let later = of(self.late);
            let earlier = plant.acting;
            plant.tick(self, (earlier, later), |part, shaft| {
                extremes.see((size_mm - shaft) / size_mm);
                if part < PARTS && self.parts.len() == PARTS {
                    see((k as f64 + part as f64 / PARTS as f64) * tick_s, shaft, f64::NAN);
                }
            });
            plant.acting = later;
        }
        Step { cost: cost * tick_s / size_mm, overshoot: extremes.overshoot, undershoot: extremes.undershoot, command }
    }
}

/// Whole ticks of a dead time, and the rest.
fn split(delay_s: f64, tick_s: f64) -> (usize, f64) {
    // A dead time of a whole number of ticks must not end up a rounding error before it.
    let ticks = (delay_s / tick_s + 1e-9).floor();
    (ticks as usize, (delay_s - ticks * tick_s).max(0.0))
}

/// The plant on its way.
struct Moving {
    state: Vec<f64>,
    next: Vec<f64>,
    shaft: f64,
    acting: f64,
    flawed: Option<Shaft>,
}

impl Moving {
    fn new(exact: &Exact) -> Self {
        let flawed = exact.flaws.as_ref().map(|(flaws, plant)| Shaft::new(plant, *flaws, exact.sampling.tick_s));
        Self { state: vec![0.0; exact.order], next: vec![0.0; exact.order], shaft: 0.0, acting: 0.0, flawed }
    }

    /// One tick with the commands before and after the change; calls `see` with every part of it.
    fn tick(&mut self, exact: &Exact, (earlier, later): (f64, f64), mut see: impl FnMut(usize, f64)) {
        if let Some(shaft) = &mut self.flawed {
            self.shaft = shaft.tick((earlier, later), &mut see);
            return;
        }
        let dot = |row: &[f64], state: &[f64]| row.iter().zip(state).map(|(a, b)| a * b).sum::<f64>();
        for (i, (row, before, after)) in exact.parts.iter().enumerate() {
            self.shaft = dot(row, &self.state) + before * earlier + after * later;
            see(i + 1, self.shaft);
        }
        let (phi, before, after) = &exact.tick;
        for (i, row) in phi.chunks_exact(exact.order).enumerate() {
            self.next[i] = dot(row, &self.state) + before[i] * earlier + after[i] * later;
        }
        std::mem::swap(&mut self.state, &mut self.next);
    }
}
