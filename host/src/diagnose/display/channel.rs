//! What a display measures: six channels, each with what it was told, what was measured, and the base law between them.

use super::design::Series;
use crate::finger::round;

/// One measured quantity of the display.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Channel {
    /// Shaft of the linear actuator.
    Position,
    /// Force sensing resistor on the cap.
    Force,
    /// Current of the coil.
    Current,
    /// Flux density in the magnet's gap.
    Flux,
    /// Pulp of the finger on the cap.
    Pulp,
    /// Fluid under the finger.
    Fluid,
}

/// A parameter of a base law: always fitted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BaseParameter {
    /// Name in answers, with its unit.
    pub name: &'static str,
    /// Nominal value, from which a fit begins.
    pub nominal: f64,
    /// Least and largest value.
    pub bounds: (f64, f64),
    /// Searched in its logarithm.
    pub logarithmic: bool,
}

/// Places of a sensor's gain, if it has one of its own, and of its zero among the parameters of a base law.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Reading {
    /// Of the gain.
    pub gain: Option<usize>,
    /// Of the zero.
    pub zero: usize,
}

const fn even(name: &'static str, nominal: f64, bounds: (f64, f64)) -> BaseParameter {
    BaseParameter { name, nominal, bounds, logarithmic: false }
}

const fn logarithmic(name: &'static str, nominal: f64, bounds: (f64, f64)) -> BaseParameter {
    BaseParameter { name, nominal, bounds, logarithmic: true }
}

/// The thesis' plant 86/(s^2 + 23.4 s + 86) (section 5.5), seen by a potentiometer of free gain and zero.
const POSITION: [BaseParameter; 4] = [
    even("gain", 1.0, (0.2, 5.0)),
    even("zero_mm", 0.0, (-50.0, 50.0)),
    logarithmic("spring_per_s2", 86.0, (2.0, 1e4)),
    logarithmic("damper_per_s", 23.4, (0.5, 1e3)),
];
/// The line of Eq. 43 as Eq. 45 reads it.
const FORCE: [BaseParameter; 2] = [even("gain", 1.0, (0.1, 10.0)), even("zero_N", 0.0, (-20.0, 20.0))];
/// Ohm's law at constant resistance.
const CURRENT: [BaseParameter; 2] = [even("gain", 1.0, (0.1, 10.0)), even("zero_A", 0.0, (-5.0, 5.0))];
/// Current below which the magnet's line bends to zero, A (assumed; Table 6 begins at 1.5 A).
pub const KNEE_A: f64 = 0.4;
/// Slope of the measured line of Table 6, T/A.
pub(super) const FLUX_SLOPE: f64 = 0.0256;
/// The measured line of Table 6, bent to zero below [`KNEE_A`].
const FLUX: [BaseParameter; 3] = [
    even("slope_T_per_A", FLUX_SLOPE, (-1.0, 1.0)),
    even("step_T", 0.0206, (-1.0, 1.0)),
    even("zero_T", 0.0, (-0.5, 0.5)),
];

/// The round finger of the control curves, its stiffness free: nobody's finger is that one.
const PULP: [BaseParameter; 3] = [
    logarithmic("stiffness_ratio", 1.0, (0.1, 10.0)),
    even("touch_mm", 0.0, (-3.0, 3.0)),
    even("zero_N", 0.0, (-5.0, 5.0)),
];
/// A finger of any size on a fluid whose yield stress is that of Carlson's law (MRF-122), times a number.
const FLUID: [BaseParameter; 5] = [
    logarithmic("yield_ratio", 1.0, (0.1, 10.0)),
    logarithmic("stiffness_ratio", 1.0, (0.1, 10.0)),
    logarithmic("size_ratio", 1.0, (0.4, 2.5)),
    even("touch_mm", 0.0, (-3.0, 3.0)),
    even("zero_N", 0.0, (-5.0, 5.0)),
];

impl Channel {
    /// All of them, in physical order.
    pub const ALL: [Self; 6] = [Self::Position, Self::Force, Self::Current, Self::Flux, Self::Pulp, Self::Fluid];

    /// The word in answers.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Position => "position",
            Self::Force => "force",
            Self::Current => "current",
            Self::Flux => "flux",
            Self::Pulp => "pulp",
            Self::Fluid => "fluid",
        }
    }

    /// Unit of what is measured.
    #[must_use]
    pub fn unit(self) -> &'static str {
        match self {
            Self::Position => "mm",
            Self::Force | Self::Pulp | Self::Fluid => "N",
            Self::Current => "A",
            Self::Flux => "T",
        }
    }

    /// Columns of a recording: what was told, what was measured.
    #[must_use]
    pub fn columns(self) -> (&'static str, &'static str) {
        let [position, force, current, flux, finger] = crate::experiment::DISPLAY_PAIRS;
        match self {
            Self::Position => position,
            Self::Force => force,
            Self::Current => current,
            Self::Flux => flux,
            Self::Pulp | Self::Fluid => finger,
        }
    }

    /// Parameters of the base law.
    #[must_use]
    pub fn base(self) -> &'static [BaseParameter] {
        match self {
            Self::Position => &POSITION,
            Self::Force => &FORCE,
            Self::Current => &CURRENT,
            Self::Flux => &FLUX,
            Self::Pulp => &PULP,
            Self::Fluid => &FLUID,
        }
    }

    /// Places of the parameters of the base that say how what happens is read.
    #[must_use]
    pub fn reading(self) -> Reading {
        match self {
            Self::Position | Self::Force | Self::Current => Reading { gain: Some(0), zero: 1 },
            // the magnet's slope and the finger's stiffness are gains already
            Self::Flux | Self::Pulp => Reading { gain: None, zero: 2 },
            Self::Fluid => Reading { gain: None, zero: 4 },
        }
    }

    /// True where the input is itself a reading, with noise.
    #[must_use]
    pub fn input_is_measured(self) -> bool {
        matches!(self, Self::Force | Self::Flux) || self.is_finger()
    }

    /// True where a finger presses.
    #[must_use]
    pub fn is_finger(self) -> bool {
        matches!(self, Self::Pulp | Self::Fluid)
    }

    /// Range of the output (by the nominal law) from which a sensor that says nothing is dead, for a range of all runs' inputs.
    pub(super) fn least_output(self, input_range: f64) -> f64 {
        match self {
            // a fluid without a field bears hardly anything
            Self::Pulp | Self::Fluid => 0.1,
            Self::Flux => 0.1 * FLUX_SLOPE * input_range,
            Self::Position | Self::Force | Self::Current => 0.1 * input_range,
        }
    }

    /// Where samples are compared, to be told where they are few.
    pub(super) fn where_compared(self) -> &'static str {
        match self {
            Self::Force => " above 0.3 N",
            Self::Fluid => " where a finger goes down by 0.15 mm/s or more, deeper than before",
            _ => "",
        }
    }

    /// Unit of what is told.
    #[must_use]
    pub fn input_unit(self) -> &'static str {
        match self {
            Self::Position | Self::Pulp | Self::Fluid => "mm",
            Self::Force => "N",
            Self::Current | Self::Flux => "A",
        }
    }

    /// Least input at which the sensor is compared: an FSR says nothing below 0.2 to 0.3 N (data sheet; Eq. 45 reads 0.2 N unloaded).
    #[must_use]
    pub fn least_input(self) -> f64 {
        if self == Self::Force { 0.3 } else { f64::NEG_INFINITY }
    }

    /// Scatter of the gain from run to run that is expected before anything is measured.
    #[must_use]
    pub fn expected_gain(self) -> f64 {
        match self {
            // data sheet: 2 % from touch to touch, and fingers press no two times alike
            Self::Force | Self::Pulp | Self::Fluid => 0.01,
            Self::Position | Self::Current | Self::Flux => 0.002,
        }
    }

    /// What the output changes by for a unit of what slides from run to run: a second of time for the position, an ampere of the current
    /// reading for the flux (at the nominal line), a millimetre of the place where a finger touches; nothing elsewhere.
    #[must_use]
    pub fn slide(self, series: &Series, output: &[f64], k: usize) -> f64 {
        match self {
            Self::Position => slope(&series.time_s, output, k),
            Self::Flux => flux_slope(series.input[k]),
            Self::Pulp => round::pulp_slope(series.input[k]),
            Self::Fluid => round::fluid_slope(series.input[k], series.yield_kpa[k]),
            Self::Force | Self::Current => 0.0,
        }
    }

    /// What the noise of a sample may grow with: the output, or, where the current that was measured is noisy itself, the slope over it.
    #[must_use]
    pub fn weight(self, series: &Series, output: &[f64], k: usize) -> f64 {
        if self == Self::Flux { flux_slope(series.input[k]) } else { output[k] }
    }

    /// What the time between input and output may be wrong by, s: a tenth of a control tick for the shaft and the fluid's response (1 to 6 ms, of
    /// which the base takes 3), half of that between two sensors of one converter.
    #[must_use]
    pub fn timing_s(self) -> f64 {
        match self {
            Self::Position | Self::Flux => 2e-3,
            Self::Force | Self::Pulp | Self::Fluid => 1e-3,
            Self::Current => 0.0,
        }
    }
}

/// Derivative of an output over time at a sample.
#[must_use]
pub fn slope(time_s: &[f64], output: &[f64], k: usize) -> f64 {
    let (a, b) = (k.saturating_sub(1), (k + 1).min(output.len() - 1));
    let span_s = time_s[b] - time_s[a];
    if span_s > 0.0 { (output[b] - output[a]) / span_s } else { 0.0 }
}

/// Flux density at a current by the nominal line, T.
pub(super) fn nominal_flux_t(current_a: f64) -> f64 {
    FLUX[0].nominal * current_a + FLUX[1].nominal * (current_a / KNEE_A).tanh()
}

/// Current (A) for a flux density by the nominal line, from 0 on.
pub(super) fn nominal_current_a(flux_t: f64) -> f64 {
    // the line is concave: Newton's method rises without overshoot from below
    let mut current_a = 0.0;
    for _ in 0..30 {
        let more_a = (flux_t - nominal_flux_t(current_a)) / flux_slope(current_a);
        current_a += more_a;
        if more_a.abs() < 1e-9 {
            break;
        }
    }
    current_a
}

/// Derivative of the nominal flux over current, T/A.
fn flux_slope(current_a: f64) -> f64 {
    let bent = (current_a / KNEE_A).tanh();
    FLUX[0].nominal + FLUX[1].nominal / KNEE_A * (1.0 - bent * bent)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gain_and_zero_are_where_they_are_said_to_be() {
        for channel in Channel::ALL {
            let Reading { gain, zero } = channel.reading();
            let name = |at: usize| channel.base()[at].name;
            assert!(name(zero).starts_with("zero_"), "{channel:?}: {}", name(zero));
            assert!(gain.is_none_or(|at| name(at) == "gain"), "{channel:?}: {gain:?}");
        }
    }
}
