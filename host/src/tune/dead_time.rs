//! A step of the continuous loop whose plant has a dead time, on a grid that divides it.
//!
//! Between grid points command and error are lines and everything else is exact; the error falls with the square of the grid.

use std::collections::VecDeque;

use nalgebra::DMatrix;

use super::gains::Gains;
use super::read::{Reader, Sample};
use super::step::{HORIZON_S, Step, unstable};
use crate::actuator::plant::Plant;

/// Part of its time constant by which the fastest mode moves in a step.
const PART: f64 = 0.05;
/// Steps of a dead time at least.
const STEPS: f64 = 20.0;
/// Steps of the whole horizon at most.
const MOST_STEPS: f64 = 400_000.0;
/// A response is over when error and its changes have been smaller than this for the time [`REST`] (mm, V).
const STILL: f64 = 1e-9;
/// Times the sum of the plant's time constants and its dead time.
const REST: f64 = 1.0;
/// An error of this, mm, is that of a loop which is not stable.
const LOST: f64 = 100.0;

/// The loop on its grid.
struct Grid {
    /// `exp(A h)` in rows.
    phi: Vec<f64>,
    /// Effect of a command's value at the start of a step, and at its end.
    effect: [Vec<f64>; 2],
    a_row: Vec<f64>,
    output: Vec<f64>,
    state: Vec<f64>,
    next: Vec<f64>,
    /// Commands that have not reached the plant yet, the next first.
    past: VecDeque<f64>,
    h: f64,
    gains: Gains,
    integral: f64,
    filtered: f64,
    /// Decay of the filter over a step, and shares of the error at its start and its end.
    filter: [f64; 3],
    /// Error and command now.
    now: (f64, f64),
}

impl Grid {
    fn new(plant: &Plant, gains: &Gains) -> Self {
        let n = plant.order();
        let fastest =
            plant.denominator.roots().unwrap_or_default().iter().map(|root| root.norm()).fold(gains.n, f64::max);
        let wanted = (plant.delay_s / STEPS).min(PART / fastest).max(HORIZON_S / MOST_STEPS);
        let late = (plant.delay_s / wanted).ceil().max(1.0);
        let h = plant.delay_s / late;
        let (a, b, c) = plant.state_space();
        let mut whole = DMatrix::zeros(n + 2, n + 2);
        whole.view_mut((0, 0), (n, n)).copy_from(&(&a * h));
        whole.view_mut((0, n), (n, 1)).copy_from(&(b * h));
        whole[(n, n + 1)] = 1.0;
        let whole = whole.exp();
        let end: Vec<f64> = whole.column(n + 1).rows(0, n).iter().copied().collect();
        let start = whole.column(n).rows(0, n).iter().zip(&end).map(|(both, end)| both - end).collect();
        let x = gains.n * h;
        let decay = (-x).exp();
        // By series where the difference would cancel.
        let share = if x < 1e-4 { x / 2.0 - x * x / 6.0 } else { 1.0 - (1.0 - decay) / x };
        let first = 1.0 * (gains.kp + gains.kd * gains.n);
        Self {
            phi: whole.view((0, 0), (n, n)).transpose().as_slice().to_vec(),
            effect: [start, end],
            a_row: a.row(n - 1).iter().copied().collect(),
            output: c.iter().copied().collect(),
            state: vec![0.0; n],
            next: vec![0.0; n],
            past: VecDeque::from(vec![0.0; late as usize]),
            h,
            gains: *gains,
            integral: 0.0,
            filtered: 0.0,
            filter: [decay, 1.0 - decay - share, share],
            now: (1.0, first),
        }
    }

    /// One step. The jump of the command at time 0 reaches the plant between two steps.
    fn step(&mut self) {
        let n = self.state.len();
        self.past.push_back(self.now.1);
        let start = self.past.pop_front().unwrap_or(0.0);
        let end = if self.jumps() { start } else { self.past.front().copied().unwrap_or(start) };
        for i in 0..n {
            let row = &self.phi[i * n..(i + 1) * n];
            let free: f64 = row.iter().zip(&self.state).map(|(a, b)| a * b).sum();
            self.next[i] = free + self.effect[0][i] * start + self.effect[1][i] * end;
        }
        std::mem::swap(&mut self.state, &mut self.next);
        let (error, _) = self.now;
        let shaft: f64 = self.output.iter().zip(&self.state).map(|(c, x)| c * x).sum();
        let after = 1.0 - shaft;
        self.integral += self.gains.ki * self.h * 0.5 * (error + after);
        self.filtered = self.filter[0] * self.filtered + self.filter[1] * error + self.filter[2] * after;
        let lead = self.gains.kd * self.gains.n * (after - self.filtered);
        self.now = (after, self.gains.kp * after + self.integral + lead);
    }

    /// True while the plant has not seen the first command.
    fn jumps(&self) -> bool {
        self.state.iter().all(|x| *x == 0.0) && self.past.front().is_some_and(|v| *v != 0.0)
    }

    /// Slopes of error and command, with the command that acts from now on.
    fn sample(&self) -> Sample {
        let n = self.state.len();
        let acting = self.past.front().copied().unwrap_or(0.0);
        let last: f64 = self.a_row.iter().zip(&self.state).map(|(a, x)| a * x).sum::<f64>() + acting;
        let rates = self.state.iter().skip(1).copied().chain([last]);
        let slope = -self.output.iter().zip(rates).map(|(c, rate)| c * rate).sum::<f64>();
        let Gains { kp, ki, kd, n: corner } = self.gains;
        let (error, command) = self.now;
        let filter_slope = corner * (error - self.filtered);
        let command_slope = kp * slope + ki * error + kd * corner * (slope - filter_slope);
        let _ = n;
        Sample { error, slope, command, command_slope, area: None }
    }
}

/// What a unit step gives; large numbers where the loop is not stable.
pub(super) fn evaluate(plant: &Plant, gains: &Gains) -> Step {
    let mut reader = Reader::default();
    match walk(plant, gains, |time, step, sample| reader.see(time, step, sample)) {
        Ok(()) => reader.finish(),
        Err(lost_at_s) => unstable(10.0 / lost_at_s.max(0.01)),
    }
}

/// Calls `see` with time, step and sample at every point of the grid until the response is over.
///
/// # Errors
/// The time (s) at which the error was beyond all bounds.
pub(super) fn walk(plant: &Plant, gains: &Gains, mut see: impl FnMut(f64, f64, Sample)) -> Result<(), f64> {
    let mut grid = Grid::new(plant, gains);
    let constant = |root: &nalgebra::Complex<f64>| 1.0 / root.norm().max(1e-3);
    let slow: f64 = plant.denominator.roots().unwrap_or_default().iter().map(constant).sum();
    let rest = REST * (slow + plant.delay_s + gains.kp / gains.ki.max(1e-3)).min(HORIZON_S);
    let (mut time, mut still, mut last) = (0.0, 0.0, f64::INFINITY);
    see(0.0, 0.0, grid.sample());
    while time < HORIZON_S {
        grid.step();
        time += grid.h;
        see(time, grid.h, grid.sample());
        let (error, command) = grid.now;
        let here = error.abs() < LOST;
        if !here {
            return Err(time);
        }
        still = if error.abs() < STILL && (command - last).abs() < STILL { still + grid.h } else { 0.0 };
        last = command;
        if still > rest {
            break;
        }
    }
    Ok(())
}
