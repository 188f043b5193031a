//! The softness display: finger force to shaft position and coil current.

use crate::coil::thermal::{ThermalConfig, allowed_fraction};
use crate::number::limit;
use crate::pid::{Pid, PidState};
use crate::showing::Wanted;
use protocol::lut::Current;
use protocol::message::{Fitted, Shown};

/// Limits of the display.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DisplayConfig {
    /// Farthest shaft target, mm: what the actuator holds with 90 % of its command (1 mm/V).
    pub target_max_mm: f32,
    /// Fastest change of the target, mm/s.
    pub target_rate_mm_s: f32,
    /// Fastest change of a target that lies outside what is displayed, mm/s: the way home at the start.
    pub homing_rate_mm_s: f32,
    /// Within this of the end of the stroke the shaft counts as at its stop, mm: three times the zero error
    /// that the bring-up accepts. Nothing is integrated into the stop (`docs/decisions/0011-end-stop.md`).
    pub end_zone_mm: f32,
    /// Highest coil current, A.
    pub coil_max_a: f32,
    /// Force below which the coil waits with the current of this force, N: the fluid bears the finger from the
    /// first touch (`docs/decisions/0022-waiting-displays.md`).
    pub coil_standby_n: f32,
    /// Most that the sensor's threshold counts for, N: a calibration may state any.
    pub least_max_n: f32,
}

impl Default for DisplayConfig {
    fn default() -> Self {
        DisplayConfig {
            target_max_mm: 4.5,
            target_rate_mm_s: 40.0,
            homing_rate_mm_s: 5.0,
            end_zone_mm: 0.3,
            coil_max_a: protocol::lut::CURRENT_MAX_A,
            coil_standby_n: 0.1,
            least_max_n: 0.5,
        }
    }
}

/// State of the display; `Default` is at rest.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Display {
    pid: PidState,
    target_mm: f32,
    /// Where the shaft was at the beginning, mm.
    still_mm: f32,
}

/// What the display wants.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct DisplayOutput {
    /// Desired shaft position, mm.
    pub target_mm: f32,
    /// Actuator command, V.
    pub actuator_v: f32,
    /// Desired coil current, A.
    pub coil_target_a: f32,
    /// What of the material is not displayed.
    pub shown: Shown,
}

/// What the display looks at.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DisplayInput {
    /// Shaft position, mm.
    pub shaft_mm: f32,
    /// Estimated coil temperature, degrees Celsius.
    pub coil_c: f32,
}

impl DisplayOutput {
    /// The same with what is not fitted not driven.
    #[must_use]
    pub fn fitted(self, fitted: &Fitted) -> Self {
        let rest = DisplayOutput { actuator_v: if fitted.actuator { self.actuator_v } else { 0.0 }, ..self };
        if fitted.coil {
            return rest;
        }
        let shown = Shown { unreachable: false, coil_limited: false, actuator_only: true, ..self.shown };
        DisplayOutput { coil_target_a: 0.0, shown, ..rest }
    }
}

impl Display {
    /// At rest with the shaft where it is: the first command is no step home.
    pub fn at(shaft_mm: f32) -> Self {
        Display { target_mm: shaft_mm, still_mm: shaft_mm, ..Display::default() }
    }

    /// Where the shaft was at the beginning, mm.
    pub const fn still_mm(&self) -> f32 {
        self.still_mm
    }

    /// One tick with what is wanted under the finger's force.
    pub fn step(
        &mut self,
        config: &DisplayConfig,
        thermal: &ThermalConfig,
        pid: &Pid,
        wanted: &Wanted,
        input: &DisplayInput,
    ) -> DisplayOutput {
        let asked_mm = wanted.shaft_mm;
        let wanted_mm = limit(asked_mm, 0.0, config.target_max_mm);
        let displayed = self.target_mm <= config.target_max_mm;
        let rate_mm_s = if displayed { config.target_rate_mm_s } else { config.homing_rate_mm_s };
        let step_mm = rate_mm_s * protocol::TICK_S;
        self.target_mm = limit(wanted_mm, self.target_mm - step_mm, self.target_mm + step_mm);
        let error_mm = self.target_mm - input.shaft_mm;
        let actuator_v = if input.shaft_mm <= config.end_zone_mm {
            pid.step_above(&mut self.pid, error_mm, 0.0)
        } else {
            pid.step(&mut self.pid, error_mm)
        };
        let allowed_a = config.coil_max_a * allowed_fraction(thermal, input.coil_c);
        let (coil_target_a, shown) = coil(wanted.current, allowed_a);
        let shown = Shown { shaft_limited: asked_mm > config.target_max_mm, ..shown };
        DisplayOutput { target_mm: self.target_mm, actuator_v, coil_target_a, shown }
    }
}

/// Current of the coil, A, and what of the material is not displayed with it.
fn coil(wanted: Option<Current>, allowed_a: f32) -> (f32, Shown) {
    let Some(Current { a, unreachable }) = wanted else {
        return (0.0, Shown { actuator_only: true, ..Shown::default() });
    };
    let coil_limited = !(a <= allowed_a);
    (limit(a, 0.0, allowed_a), Shown { unreachable, coil_limited, ..Shown::default() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_current_that_is_cut_is_told_and_no_other() {
        let wanted = |a, unreachable| Some(Current { a, unreachable });
        let shown = |unreachable, coil_limited, actuator_only| Shown {
            unreachable,
            coil_limited,
            shaft_limited: false,
            actuator_only,
        };
        assert_eq!(coil(wanted(1.0, false), 2.5), (1.0, shown(false, false, false)));
        assert_eq!(coil(wanted(2.5, false), 2.5), (2.5, shown(false, false, false)));
        assert_eq!(coil(wanted(2.0, true), 2.5), (2.0, shown(true, false, false)));
        assert_eq!(coil(wanted(2.0, false), 1.25), (1.25, shown(false, true, false)));
        assert_eq!(coil(wanted(2.0, true), 0.0), (0.0, shown(true, true, false)));
        assert_eq!(coil(wanted(f32::NAN, false), 2.5), (0.0, shown(false, true, false)));
        assert_eq!(coil(None, 2.5), (0.0, shown(false, false, true)));
    }
}
