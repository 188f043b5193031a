//! The thesis' problem: a continuous loop without limits on its command (section 5.5, Eq. 53).
//!
//! Without dead time the response is a sum of known modes; it is evaluated at steps as long as the living modes allow, with
//! exact integrals between them.

use super::dead_time;
use super::gains::Gains;
use super::modal::{Modal, Signal};
use super::read::{Reader, Sample};
use super::step::{HORIZON_S, Step, unstable};
use crate::actuator::plant::Plant;
use crate::actuator::polynomial::Polynomial;

/// Polynomials of plant `b/a` and controller `d/e`, in `s` or in `z`.
#[derive(Debug, Clone)]
pub(super) struct Loop {
    /// Plant, numerator.
    pub b: Polynomial,
    /// Plant, denominator.
    pub a: Polynomial,
    /// Controller, numerator.
    pub d: Polynomial,
    /// Controller, denominator.
    pub e: Polynomial,
    /// Characteristic polynomial.
    pub chi: Polynomial,
}

impl Loop {
    /// The continuous loop, without the plant's dead time.
    pub fn continuous(plant: &Plant, gains: &Gains) -> Self {
        let (d, e) = gains.continuous();
        Self::of(plant.numerator.clone(), plant.denominator.clone(), d, e)
    }

    /// Of polynomials of plant and controller.
    pub fn of(b: Polynomial, a: Polynomial, d: Polynomial, e: Polynomial) -> Self {
        let chi = &(&a * &e) + &(&b * &d);
        Self { b, a, d, e, chi }
    }
}

/// Signals that a step is read from.
struct Signals {
    error: Signal,
    slope: Signal,
    integral: Signal,
    command: Signal,
    command_slope: Signal,
}

impl Signals {
    fn of(own: &Loop, modal: &Modal) -> Self {
        let lead = own.chi.leading();
        let error = modal.step_of(&(&own.e * &own.a), lead);
        let command = modal.step_of(&(&own.d * &own.a), lead);
        Self {
            slope: modal.slope(&error),
            integral: modal.integral(&error),
            command_slope: modal.slope(&command),
            error,
            command,
        }
    }
}

/// What a unit step gives; large numbers where the loop is not stable.
pub fn evaluate(plant: &Plant, gains: &Gains) -> Step {
    if plant.delay_s > 0.0 {
        return dead_time::evaluate(plant, gains);
    }
    let mut reader = Reader::default();
    match modes(plant, gains, |time, step, sample| reader.see(time, step, sample)) {
        Ok(()) => reader.finish(),
        Err(growth) => unstable(growth),
    }
}

/// A unit step over its first `length_s`: time (s), shaft (mm), command (V), at uneven times.
pub fn trace(plant: &Plant, gains: &Gains, length_s: f64) -> Vec<[f64; 3]> {
    let mut points = Vec::new();
    let see = |time: f64, _: f64, sample: Sample| {
        if time <= length_s {
            points.push([time, 1.0 - sample.error, sample.command]);
        }
    };
    // A loop that is not stable has the trace up to where it is lost.
    let _ = if plant.delay_s > 0.0 { dead_time::walk(plant, gains, see) } else { modes(plant, gains, see) };
    points
}

/// Calls `see` with time, step and sample until the response is over.
fn modes(plant: &Plant, gains: &Gains, mut see: impl FnMut(f64, f64, Sample)) -> Result<(), f64> {
    let own = Loop::continuous(plant, gains);
    let modal = Modal::new(&own.chi).ok_or(f64::INFINITY)?;
    if !modal.is_stable() {
        return Err(modal.growth());
    }
    let signals = Signals::of(&own, &modal);
    let mut integral = 0.0;
    modal.walk(HORIZON_S, 1.0, |time, step, state| {
        let so_far = signals.integral.at(state);
        let area = Some(so_far - integral + signals.error.rest * step);
        integral = so_far;
        let sample = Sample {
            error: signals.error.at(state),
            slope: signals.slope.at(state),
            command: signals.command.at(state),
            command_slope: signals.command_slope.at(state),
            area,
        };
        see(time, step, sample);
    });
    Ok(())
}
