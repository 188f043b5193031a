//! The softness display: finger force to shaft position and coil current.

use crate::coil::thermal::{ThermalConfig, allowed_fraction};
use crate::finger::Finger;
use crate::number::{larger, limit};
use crate::pid::{Pid, PidState};
use crate::showing::Wanted;
use protocol::lut::Current;
use protocol::message::{Actuator, Fitted, Shown};

/// Limits of the display.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DisplayConfig {
    /// Farthest shaft target, mm: what the actuator holds with nine tenths of its command (1 mm/V), or the whole stroke.
    pub target_max_mm: f32,
    /// Fastest change of the target, mm/s.
    pub target_rate_mm_s: f32,
    /// Command that holds the shaft against the finger, V/N: feed-forward of the force that is read, 0 for a spindle.
    pub holds_v_per_n: f32,
    /// Fastest change of a target that begins beyond `near_mm`, until it has met what is wanted, mm/s: the way home.
    pub homing_rate_mm_s: f32,
    /// A shaft within this is home from the start, mm.
    pub near_mm: f32,
    /// Within this of the end of the stroke the shaft counts as at its stop, mm: three times the zero error
    /// that the bring-up accepts. Nothing is integrated into the stop (`docs/decisions/0011-end-stop.md`).
    pub end_zone_mm: f32,
    /// Highest coil current, A.
    pub coil_max_a: f32,
    /// Force below which the coil waits with the current of this force, N: the fluid bears the finger from the
    /// first touch (`docs/decisions/0022-waiting-displays.md`).
    pub coil_standby_n: f32,
    /// Rate of the trim of a coil that answers to the finger's place, 1/s: the force that is read corrects the
    /// current in a quarter of a second, which the fluid follows in milliseconds.
    pub trim_per_s: f32,
    /// Least and largest trim, as a part of the current: magnets and fluids may make half or twice of what their
    /// files say.
    pub trim: (f32, f32),
    /// Most that the sensor's threshold counts for, N: a calibration may state any.
    pub least_max_n: f32,
}

impl Default for DisplayConfig {
    fn default() -> Self {
        DisplayConfig {
            target_max_mm: 4.5,
            target_rate_mm_s: 40.0,
            holds_v_per_n: 0.0,
            homing_rate_mm_s: 5.0,
            near_mm: 4.5,
            end_zone_mm: 0.3,
            coil_max_a: protocol::lut::CURRENT_MAX_A,
            coil_standby_n: 0.1,
            least_max_n: 0.5,
            trim_per_s: 4.0,
            trim: (-0.5, 1.0),
        }
    }
}

/// What is taken of an actuator: targets of 0.5 to 19 mm, of a stroke of 20 mm (thesis section 5.1.1).
pub const REACH_MM: (f32, f32) = (0.5, 19.0);
/// Changes of 1 to 200 mm/s: ten times what the thesis' actuator makes.
pub const RATE_MM_S: (f32, f32) = (1.0, 200.0);
/// Feed-forward of at most 0.5 V/N: a tenth of the largest command for each newton.
pub const HOLDS_V_PER_N: (f32, f32) = (0.0, 0.5);
/// Part of the largest command that holds the shaft at the end of its reach: the rest is left to the loop. Hosts state a reach
/// by it.
pub const HELD: f32 = 0.9;
/// Longest lag that is made up for, s: half more than that of the thesis' loop.
const LAG_MAX_S: f32 = 0.15;
/// Force that feed-forward holds at most, N: more is no finger that feels, but a sensor that is wrong.
const HELD_MOST_N: f32 = 6.0;
/// What the loop may add to a feed-forward at the stop, as a part of it: hosts send 0.7 of what holds a force, and the rest
/// is the integral's, which decision 11 forbids there for a shaft that no finger drives.
const UNFED: f32 = 0.5;

impl DisplayConfig {
    /// The same for an actuator; `None` for what lies outside the board's own limits.
    pub fn with(self, actuator: &Actuator) -> Option<Self> {
        let within = |x: f32, (least, most): (f32, f32)| x >= least && x <= most;
        let Actuator { reach_mm, rate_mm_s, holds_v_per_n } = *actuator;
        let sound = within(reach_mm, REACH_MM) && within(rate_mm_s, RATE_MM_S) && within(holds_v_per_n, HOLDS_V_PER_N);
        let with = DisplayConfig { target_max_mm: reach_mm, target_rate_mm_s: rate_mm_s, holds_v_per_n, ..self };
        sound.then_some(with)
    }

    /// How far the shaft stays behind an even motion, s; `None` where nobody knows: a plant that integrates, which has the
    /// whole stroke, and one that a finger drives back. Those answer to the force alone.
    fn lag_s(&self, pid: &Pid) -> Option<f32> {
        if self.target_max_mm >= REACH_MM.1 || self.holds_v_per_n > 0.0 {
            return None;
        }
        let mm_per_v = self.target_max_mm / (HELD * pid.u_max_v());
        pid.lag_s(mm_per_v).map(|lag_s| limit(lag_s, 0.0, LAG_MAX_S))
    }
}

/// State of the display; `Default` is at rest.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Display {
    pid: PidState,
    finger: Finger,
    target_mm: f32,
    /// Where the shaft was at the beginning, mm.
    still_mm: f32,
    /// The target has met what was wanted once.
    is_home: bool,
    /// What the current at the finger's place is changed by, as a part of it; kept from touch to touch.
    trim: f32,
    /// Most that the material would have borne in this touch, N.
    most_n: f32,
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
    /// Force of the finger, N.
    pub force_n: f32,
    /// Least force that its sensor tells, N.
    pub least_n: f32,
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

    /// Follows the finger for a tick: where it will be when the shaft has followed, mm below the surface.
    pub fn ahead_mm(&mut self, config: &DisplayConfig, pid: &Pid, input: &DisplayInput) -> Option<f32> {
        let lag_s = config.lag_s(pid)?;
        self.finger.step(input.shaft_mm, input.force_n, input.least_n, lag_s)
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
        let wanted_mm = limit(asked_mm + wanted.leads_mm, 0.0, config.target_max_mm);
        let displayed = self.is_home || self.target_mm <= config.near_mm;
        let rate_mm_s = if displayed { config.target_rate_mm_s } else { config.homing_rate_mm_s };
        let step_mm = rate_mm_s * protocol::TICK_S;
        self.target_mm = limit(wanted_mm, self.target_mm - step_mm, self.target_mm + step_mm);
        self.is_home |= self.target_mm == wanted_mm;
        let error_mm = self.target_mm - input.shaft_mm;
        let held_v = config.holds_v_per_n * limit(input.force_n, 0.0, HELD_MOST_N);
        let floor_v = if input.shaft_mm <= config.end_zone_mm { -UNFED * held_v } else { -pid.u_max_v() };
        let actuator_v = pid.step_above(&mut self.pid, error_mm, floor_v, -held_v);
        let allowed_a = config.coil_max_a * allowed_fraction(thermal, input.coil_c);
        let (coil_target_a, shown) = coil(self.trimmed(config, wanted, input, allowed_a), allowed_a);
        let shown = Shown { shaft_limited: asked_mm > config.target_max_mm, ..shown };
        DisplayOutput { target_mm: self.target_mm, actuator_v, coil_target_a, shown }
    }

    /// The current at the finger's place, corrected by the force that is read there: what fluid and magnet are beside
    /// what the curve was made for is the same all over a press. It is learned while the finger goes down only, for on
    /// the way up a fluid lets go; and from one curve, from a force that the sensor tells, and not against a limit.
    fn trimmed(
        &mut self,
        config: &DisplayConfig,
        wanted: &Wanted,
        input: &DisplayInput,
        allowed_a: f32,
    ) -> Option<Current> {
        /// A finger within this part of its deepest force goes down or holds.
        const DOWN: f32 = 0.98;
        let (Some(bears_n), Some(current)) = (wanted.bears_n, wanted.current) else {
            return wanted.current;
        };
        if bears_n > config.coil_standby_n {
            self.most_n = larger(bears_n, self.most_n);
            let is_down = bears_n >= DOWN * self.most_n;
            let is_told = input.force_n > input.least_n && bears_n > input.least_n;
            let missing = limit((bears_n - input.force_n) / bears_n, -1.0, 1.0);
            let is_free = missing <= 0.0 || current.a * (1.0 + self.trim) < allowed_a;
            if is_down && is_told && is_free && wanted.is_settled && !current.unreachable {
                let trim = self.trim + config.trim_per_s * protocol::TICK_S * missing;
                self.trim = limit(trim, config.trim.0, config.trim.1);
            }
        } else {
            self.most_n = 0.0;
        }
        Some(Current { a: current.a * (1.0 + self.trim), ..current })
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
mod tests;
