//! Position loop of the display: PID with filtered derivative and anti-windup.
//!
//! Three forms that never mix: [`Gains`] in physical units (from the link), [`Pid`] built for one sampling period
//! (immutable), and [`PidState`], which is an argument. Discretisation: backward Euler for integral and derivative
//! filter, so a gain that is stable in continuous time cannot make the filter itself unstable.

use crate::number::{larger, limit};
use protocol::message::Gains;

/// Gains for the plant `86 / (s^2 + 23.4 s + 86)` (thesis Eqs. 55-56) sampled at 50 Hz with a hold and one tick of delay.
///
/// What `palpate tune --u-max 4.6` finds, rounded: the least sum of absolute errors of a unit step under limits on command
/// and overshoot (section 5.5), on the sampled loop, with 8 % of the command left over; within 0.2 % of the least error. The
/// test `margins` of this module computes the margins. The thesis' continuous gains (3.6610, 14.1596, 0.1787, 7.4936) keep
/// about 32 degrees here.
pub const DEFAULT_GAINS: Gains = Gains { kp: 2.4, ki: 9.6, kd: 0.08, n: 50.0 };

/// Largest command, V (thesis section 5.5: `u_max = 5 V`).
pub const U_MAX_V: f32 = 5.0;

/// Gains above these are refused: ten times what the plant bears at 50 Hz.
pub const GAIN_CEILING: Gains = Gains { kp: 50.0, ki: 500.0, kd: 5.0, n: 500.0 };

/// True if every gain is a number within `[0, ceiling]` and the filter corner is positive.
pub fn gains_are_usable(gains: &Gains) -> bool {
    let within = |x: f32, ceiling: f32| x >= 0.0 && x <= ceiling;
    within(gains.kp, GAIN_CEILING.kp)
        && within(gains.ki, GAIN_CEILING.ki)
        && within(gains.kd, GAIN_CEILING.kd)
        && within(gains.n, GAIN_CEILING.n)
        && gains.n > 0.0
}

/// Coefficients for one sampling period.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pid {
    kp: f32,
    /// `ki T`, V/mm a step.
    integral: f32,
    /// Pole of the derivative filter, `1 / (1 + n T)`.
    pole: f32,
    /// `kd n / (1 + n T)`, V/mm.
    derivative: f32,
    u_max_v: f32,
    period_s: f32,
}

/// Memory of the loop; `Default` is at rest.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PidState {
    integral_v: f32,
    derivative_v: f32,
    previous_mm: f32,
}

impl PidState {
    /// Integral part, V.
    pub const fn integral_v(&self) -> f32 {
        self.integral_v
    }
}

impl Pid {
    /// Builds the coefficients of `gains` for steps of `period_s` and commands up to `u_max_v`.
    pub fn build(gains: &Gains, period_s: f32, u_max_v: f32) -> Self {
        let pole = 1.0 / (1.0 + gains.n * period_s);
        Pid {
            kp: gains.kp,
            integral: gains.ki * period_s,
            pole,
            derivative: gains.kd * gains.n * pole,
            u_max_v,
            period_s,
        }
    }

    /// Largest command, V.
    pub const fn u_max_v(&self) -> f32 {
        self.u_max_v
    }

    /// How far behind an even motion the loop stays, s, of a plant that `mm_per_v` at rest: `1 / (ki mm_per_v)`; `None`
    /// without an integral, which leaves an error at rest as well.
    pub fn lag_s(&self, mm_per_v: f32) -> Option<f32> {
        let per_tick = self.integral * mm_per_v;
        (per_tick > 0.0).then(|| self.period_s / per_tick)
    }

    /// One step: command, V within `[-u_max, u_max]`, for an error in mm.
    ///
    /// Anti-windup: the integral grows until the command is at its limit and no further (conditional
    /// integration), so the loop leaves saturation in the tick in which the error asks for it, and a blocked
    /// shaft is driven at the limit itself, which is what tells a stall.
    pub fn step(&self, state: &mut PidState, error_mm: f32) -> f32 {
        self.step_above(state, error_mm, -self.u_max_v, 0.0)
    }

    /// The same with an integral of at least `floor_v`, for a plant that stands at an end stop: there the
    /// loop is open, an integral only grows, and what it has grown by delays the next motion. `beside_v` is a command that
    /// is known without the error (feed-forward), V. The integral may make up for it, so that a blocked shaft is driven
    /// at the limit with a feed-forward as well.
    pub fn step_above(&self, state: &mut PidState, error_mm: f32, floor_v: f32, beside_v: f32) -> f32 {
        state.derivative_v = self.pole * state.derivative_v + self.derivative * (error_mm - state.previous_mm);
        state.previous_mm = error_mm;
        let grown_v = state.integral_v + self.integral * error_mm;
        let others_v = self.kp * error_mm + state.derivative_v + beside_v;
        let u_v = others_v + grown_v;
        let integral_v = if u_v > self.u_max_v && error_mm > 0.0 {
            state.integral_v.max(self.u_max_v - others_v)
        } else if u_v < -self.u_max_v && error_mm < 0.0 {
            state.integral_v.min(-self.u_max_v - others_v)
        } else {
            grown_v
        };
        state.integral_v = limit(integral_v, floor_v, self.u_max_v + larger(-beside_v, 0.0));
        limit(others_v + state.integral_v, -self.u_max_v, self.u_max_v)
    }
}

#[cfg(test)]
mod tests;
