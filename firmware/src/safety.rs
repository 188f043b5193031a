//! Limits and latched faults.
//!
//! Every tick all causes are looked at; a cause that is present latches its fault. Latched faults keep all outputs off
//! until the host clears them, which succeeds only when no cause is present.

use crate::plausible::Contradiction;
use crate::sensor::{Measured, RawSamples, at_rail, resistance_kohm};
use protocol::fault::{Fault, FaultSet};
use protocol::message::{Calibration, Fitted, ResetCause};

/// The board's own limits. They are no part of any message: the host cannot widen them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SafetyConfig {
    /// Force on the load cell, N.
    pub force_n: f32,
    /// Shaft position, mm.
    pub shaft_mm: (f32, f32),
    /// Coil current, A: the commanded limit of 2.5 A, 5 % of the regulator's overshoot, and 3 % for
    /// ripple and noise. A cold coil at the whole supply of 15 V has 2.9 A; what a warm one then
    /// has is told by its duty ([`crate::fast`]).
    pub coil_a: f32,
    /// Coil temperature, degrees Celsius.
    pub coil_c: f32,
    /// FSR resistance that no force explains, kOhm: 10 N give 1.3 kOhm.
    pub fsr_short_kohm: f32,
    /// Ticks without fresh samples before they count as stale.
    pub stale_ticks: u16,
    /// Fastest rise of the probe's force, N/s: the fastest rate (4 mm/s) into the stiffest foam at depth (5 N/mm).
    pub force_slew_n_per_s: f32,
    /// Fastest motion of the shaft, mm/s: the plant's steepest slope after a step of 5 V is 13 mm/s.
    pub shaft_slew_mm_per_s: f32,
    /// Ticks in a row with a converter overrun.
    pub overrun_ticks: u8,
    /// Longest tick, us.
    pub tick_us: u16,
    /// Longest time between the starts of two ticks, us.
    pub period_us: u32,
    /// Command that counts as driven at its limit, V.
    pub stall_v: f32,
    /// Ticks at the limit without a motion of `stall_mm`: a stalled shaft.
    pub stall_ticks: u16,
    /// See `stall_ticks`, mm. A free shaft makes thirty times as much in these ticks.
    pub stall_mm: f32,
    /// Ticks at the limit whatever the potentiometer says: the whole stroke at 4 mm/s.
    pub drive_ticks: u16,
}

impl Default for SafetyConfig {
    fn default() -> Self {
        SafetyConfig {
            force_n: 8.0,
            shaft_mm: (-1.0, 20.5),
            coil_a: 2.7,
            coil_c: 105.0,
            fsr_short_kohm: 0.2,
            stale_ticks: 3,
            force_slew_n_per_s: 20.0,
            shaft_slew_mm_per_s: 15.0,
            overrun_ticks: 3,
            tick_us: 18_000,
            period_us: 30_000,
            stall_v: 4.99,
            stall_ticks: 100,
            stall_mm: 0.3,
            drive_ticks: 250,
        }
    }
}

/// What the safety step looks at.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SafetyInput<'a> {
    /// Readings.
    pub raw: &'a RawSamples,
    /// The same in physical units.
    pub measured: &'a Measured,
    /// Calibration (for the FSR's divider).
    pub calibration: &'a Calibration,
    /// Ticks since the readings were fresh; 0 if they are.
    pub age_ticks: u16,
    /// The converter's ring overran since the previous tick.
    pub adc_overrun: bool,
    /// Why the fast loop has switched the coil off since the previous tick.
    pub coil_trip: Option<Fault>,
    /// What the readings of a press contradict.
    pub contradiction: Contradiction,
    /// Parts that are wired: the others are not looked at.
    pub fitted: &'a Fitted,
    /// The stored calibration does not read back.
    pub calibration_lost: bool,
    /// Estimated coil temperature, degrees Celsius.
    pub coil_c: f32,
    /// Duration of the previous tick, us.
    pub tick_us: u16,
    /// Time from the start of the previous tick to the start of this one, us.
    pub period_us: u32,
    /// The interlock has ended or refused a permit.
    pub interlock: Option<crate::interlock::Trip>,
    /// Ticks without a request from the link that holds the motion, and how many its lease allows.
    pub silence: (u16, u16),
    /// Actuator command of the previous tick, V.
    pub actuator_v: f32,
    /// True if any output is on.
    pub outputs_on: bool,
    /// Something inside the control loop was not finite in the previous tick.
    pub not_finite: bool,
    /// A slot holds a broken table and none holds a good one.
    pub table_broken: bool,
}

/// A fault that was latched in this tick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Trip {
    /// Which.
    pub fault: Fault,
    /// The value that tripped it; 0 where there is none that is a number.
    pub value: f32,
    /// The limit.
    pub limit: f32,
}

/// Latched faults and the counters behind them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Safety {
    latched: FaultSet,
    present: FaultSet,
    overruns: u8,
    /// Ticks at the command's limit, those since the shaft has moved, and where it then was, mm.
    driven: u16,
    stalled: u16,
    stalled_at_mm: f32,
    /// Ticks that took too long.
    pub deadlines_missed: u32,
    /// Longest tick, us.
    pub tick_max_us: u16,
    /// Ticks that began late.
    pub ticks_late: u32,
    /// Longest time between the starts of two ticks, us.
    pub period_max_us: u32,
}

impl Safety {
    /// At start: a watchdog reset is latched, so that a person learns of it.
    pub fn new(cause: &ResetCause) -> Self {
        let mut latched = FaultSet::NONE;
        if *cause == ResetCause::Watchdog {
            latched.insert(Fault::WatchdogReset);
        }
        Safety {
            latched,
            present: FaultSet::NONE,
            overruns: 0,
            driven: 0,
            stalled: 0,
            stalled_at_mm: 0.0,
            deadlines_missed: 0,
            tick_max_us: 0,
            ticks_late: 0,
            period_max_us: 0,
        }
    }

    /// Latched faults.
    pub const fn latched(&self) -> FaultSet {
        self.latched
    }

    /// Latches a fault that was there before the first tick.
    pub fn latch(&mut self, fault: Fault) {
        self.latched.insert(fault);
    }

    /// Forgets the latched faults if no cause is present; false if one is.
    pub fn clear(&mut self) -> bool {
        if self.present.is_empty() {
            self.latched = FaultSet::NONE;
        }
        self.present.is_empty()
    }

    /// One tick; `report` hears of every fault that is latched in it.
    pub fn step(&mut self, config: &SafetyConfig, input: &SafetyInput<'_>, mut report: impl FnMut(Trip)) {
        self.count(config, input);
        self.present = FaultSet::NONE;
        let mut see = |present: bool, fault: Fault, value: f32, limit: f32| {
            if !present {
                return;
            }
            self.present.insert(fault);
            if !self.latched.contains(fault) {
                self.latched.insert(fault);
                let value = if value.is_finite() { value } else { 0.0 };
                report(Trip { fault, value, limit });
            }
        };
        let (raw, m, fitted) = (input.raw, input.measured, input.fitted);
        // A stale reading may hide the worst that can have happened since.
        let age_s = f32::from(input.age_ticks) * protocol::TICK_S;
        let worst_n = m.load_cell_n + age_s * config.force_slew_n_per_s;
        see(worst_n > config.force_n, Fault::ForceLimit, worst_n, config.force_n);
        let (shaft_low, shaft_high) = config.shaft_mm;
        let reach_mm = if input.outputs_on { age_s * config.shaft_slew_mm_per_s } else { 0.0 };
        see(m.shaft_mm + reach_mm > shaft_high, Fault::StrokeLimit, m.shaft_mm, shaft_high);
        see(m.shaft_mm - reach_mm < shaft_low, Fault::StrokeLimit, m.shaft_mm, shaft_low);
        see(m.coil_a > config.coil_a, Fault::CurrentLimit, m.coil_a, config.coil_a);
        if let Some(fault) = input.coil_trip.filter(|_| fitted.coil) {
            see(true, fault, m.coil_a, config.coil_a);
        }
        // An amplifier that reads nothing would let the regulator drive the coil as hard as the supply can.
        see(fitted.coil && at_rail(raw.coil_current), Fault::CurrentLimit, m.coil_a, config.coil_a);
        see(input.coil_c >= config.coil_c, Fault::CoilHot, input.coil_c, config.coil_c);
        see(fitted.palpator && at_rail(raw.load_cell), Fault::LoadCellOpen, raw.load_cell, 0.0);
        let fsr_kohm = resistance_kohm(raw.fsr, input.calibration.fsr.divider_kohm);
        let fsr_short = (fitted.actuator || fitted.coil) && fsr_kohm < config.fsr_short_kohm;
        see(fsr_short, Fault::FsrShort, fsr_kohm, config.fsr_short_kohm);
        see(fitted.actuator && at_rail(raw.potentiometer), Fault::PotentiometerOpen, raw.potentiometer, 0.0);
        see(fitted.palpator && at_rail(raw.probe_position), Fault::ProbePositionOpen, raw.probe_position, 0.0);
        if let Some((force_n, bound_n)) = input.contradiction.force_n {
            see(true, Fault::ForceImplausible, force_n, bound_n);
        }
        if let Some((slip_mm, bound_mm)) = input.contradiction.slip_mm {
            see(true, Fault::ArmDeviates, slip_mm, bound_mm);
        }
        let (age, stale) = (input.age_ticks, config.stale_ticks);
        see(age >= stale, Fault::SensorStale, f32::from(age), f32::from(stale));
        see(
            self.overruns >= config.overrun_ticks,
            Fault::AdcOverrun,
            f32::from(self.overruns),
            f32::from(config.overrun_ticks),
        );
        see(
            input.outputs_on && input.tick_us > config.tick_us,
            Fault::DeadlineMissed,
            f32::from(input.tick_us),
            f32::from(config.tick_us),
        );
        see(
            input.outputs_on && input.period_us > config.period_us,
            Fault::DeadlineMissed,
            input.period_us as f32,
            config.period_us as f32,
        );
        let interlock = input.interlock.map_or(0, |trip| trip.number());
        see(input.interlock.is_some(), Fault::Interlock, f32::from(interlock), 0.0);
        let (silent, lease) = input.silence;
        see(silent > lease, Fault::LinkLost, f32::from(silent), f32::from(lease));
        let stalled = self.stalled > config.stall_ticks || self.driven > config.drive_ticks;
        see(stalled, Fault::ActuatorStall, input.actuator_v, config.stall_v);
        see(input.not_finite || !m.is_finite() || !input.coil_c.is_finite(), Fault::NotFinite, 0.0, 0.0);
        see(input.table_broken, Fault::TableInvalid, 0.0, 0.0);
        see(input.calibration_lost, Fault::CalibrationLost, 0.0, 0.0);
    }

    fn count(&mut self, config: &SafetyConfig, input: &SafetyInput<'_>) {
        self.overruns = if input.adc_overrun { self.overruns.saturating_add(1) } else { 0 };
        let driven = input.outputs_on && input.actuator_v.abs() >= config.stall_v;
        self.driven = if driven { self.driven.saturating_add(1) } else { 0 };
        let still = (input.measured.shaft_mm - self.stalled_at_mm).abs() < config.stall_mm;
        if driven && still {
            self.stalled = self.stalled.saturating_add(1);
        } else {
            (self.stalled, self.stalled_at_mm) = (0, input.measured.shaft_mm);
        }
        self.tick_max_us = self.tick_max_us.max(input.tick_us);
        if input.tick_us > config.tick_us {
            self.deadlines_missed = self.deadlines_missed.saturating_add(1);
        }
        self.period_max_us = self.period_max_us.max(input.period_us);
        if input.period_us > config.period_us {
            self.ticks_late = self.ticks_late.saturating_add(1);
        }
    }
}
