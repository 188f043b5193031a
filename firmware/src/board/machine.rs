//! The machine behind the links: sensors, safety, modes, identification, display.

use super::halves::Identified;
use super::lease::Lease;
use super::press::setup_at_start;
use super::{Identity, Inputs, Outputs};
use crate::coil::regulator::CoilPi;
use crate::coil::thermal;
use crate::config::BoardConfig;
use crate::contact::Sample;
use crate::display::Display;
use crate::fast::FAST_HZ;
use crate::flash::{ActiveTable, CalibrationStore, TableStore, Upload, find_active};
use crate::link::LinkId;
use crate::mode::{ModeEvent, ModeInput, Modes, Stage};
use crate::palpation::{Motion, Palpation, Progress};
use crate::pid::Pid;
use crate::plausible::Plausible;
use crate::safety::{Safety, SafetyInput};
use crate::sensor::{Measured, RawSamples};
use protocol::TICK_S;
use protocol::lut::Table;
use protocol::message::{
    Calibration, CalibrationState, FaultReport, Fitted, Outcome, Raw, Report, Shown, State, Telemetry,
};

/// The machine; `S` is its flash.
#[derive(Debug, Clone)]
pub struct Machine<S> {
    pub(super) config: BoardConfig,
    pub(super) store: S,
    pub(super) identity: Identity,
    pub(super) active: Option<ActiveTable>,
    pub(super) table_broken: bool,
    pub(super) upload: Upload,
    /// Link and sequence number of the `TableBegin` that is answered when the erase has ended.
    pub(super) begun: Option<(LinkId, u16)>,
    pub(super) calibration: Calibration,
    pub(super) calibration_state: CalibrationState,
    pub(super) fitted: Fitted,
    pub(super) pid: Pid,
    coil_pi: CoilPi,
    pub(super) safety: Safety,
    pub(super) lease: Lease,
    pub(super) mode: Modes,
    pub(super) palpation: Palpation,
    pub(super) plausible: Plausible,
    /// Height of the surface that a link states for its next mode, mm.
    pub(super) expected: Option<(LinkId, f32)>,
    /// Lowest height of the probe without contact in this palpation, mm.
    pub(super) floor_mm: f32,
    pub(super) palpations: u32,
    pub(super) palpation_rate_mm_s: f32,
    /// Sum (us) and number of the ticks in contact, and the longest tick of the palpation.
    pub(super) contact_ticks: (u32, u32, u16),
    pub(super) display: Display,
    /// What the latest palpation said, of the table in use.
    pub(super) identified: Option<Identified>,
    /// It came in the tick before.
    pub(super) follow_due: bool,
    /// Error bound of the displayed current, A.
    pub(super) bound_a: f32,
    pub(super) tick: u32,
    pub(super) age_ticks: u16,
    pub(super) raw: RawSamples,
    pub(super) measured: Measured,
    pub(super) coil_c: f32,
    outputs: Outputs,
    pub(super) shaft_target_mm: f32,
    shown: Shown,
    not_finite: bool,
    pub(super) stop_pressed: bool,
}

impl<S: TableStore + CalibrationStore> Machine<S> {
    /// A machine at start: looks for a table and a calibration in `store`, outputs off.
    pub fn new(config: BoardConfig, mut store: S, identity: Identity) -> Self {
        let (active, table_broken) = find_active(store.bytes());
        let (setup, calibration_state) = setup_at_start(&config, &mut store);
        Machine {
            pid: Pid::build(&config.gains, TICK_S, config.u_max_v),
            coil_pi: CoilPi::build(&config.circuit, 1.0 / FAST_HZ as f32),
            safety: Safety::new(&identity.reset_cause),
            // How hot the coil was before the reset is not known: assume the hottest that needs no caution.
            coil_c: config.thermal.derate_c,
            config,
            store,
            identity,
            active,
            table_broken,
            upload: Upload::new(),
            begun: None,
            calibration: setup.calibration,
            calibration_state,
            fitted: setup.fitted,
            lease: Lease::default(),
            mode: Modes::new(),
            palpation: Palpation::new(),
            plausible: Plausible::default(),
            expected: None,
            floor_mm: 0.0,
            palpations: 0,
            palpation_rate_mm_s: 0.0,
            contact_ticks: (0, 0, 0),
            display: Display::default(),
            identified: None,
            follow_due: false,
            bound_a: 0.0,
            tick: 0,
            age_ticks: 0,
            raw: RawSamples::default(),
            measured: Measured::default(),
            outputs: Outputs::default(),
            shaft_target_mm: 0.0,
            shown: Shown::default(),
            not_finite: false,
            stop_pressed: false,
        }
    }

    /// One control tick. `tell` hears what every host is told: faults, estimates, verdicts.
    pub fn tick(&mut self, inputs: &Inputs, mut tell: impl FnMut(&Report)) -> Outputs {
        self.tick = self.tick.wrapping_add(1);
        self.sense(inputs);
        self.guard(inputs, &mut tell);
        self.stop_pressed = inputs.stop_pressed;
        if self.stop_pressed {
            // Always allowed: what is under way ends as if a host had asked for it.
            self.mode.stop();
        }
        let event = if self.upload.is_erasing() { ModeEvent::None } else { self.palpate(inputs) };
        self.follow();
        if let ModeEvent::Ended(outcome) = event {
            self.tell_verdict(outcome, &mut tell);
        }
        if self.mode.is_resting() {
            self.lease.release();
        }
        self.outputs = self.drive();
        self.not_finite = !outputs_are_finite(&self.outputs);
        if self.not_finite {
            self.outputs = Outputs::default();
        }
        self.outputs
    }

    /// What the board is doing.
    pub const fn state(&self) -> State {
        self.mode.state()
    }

    /// The table in use, if there is one.
    pub fn table(&self) -> Option<Table<'_>> {
        open(&self.active, &self.store)
    }

    fn sense(&mut self, inputs: &Inputs) {
        if inputs.fresh {
            self.age_ticks = 0;
            self.raw = inputs.raw;
            self.measured = Measured::from_raw(&self.raw, &self.calibration, &self.config.shunt).fitted(&self.fitted);
        } else {
            self.age_ticks = self.age_ticks.saturating_add(1);
        }
        // Heated by the larger of measured and wanted current: an amplifier that reads no current must not hide the heat.
        // (`max` also keeps a reading that is no number out of the temperature.)
        // Or by what the duty gives: neither must an amplifier that reads too little.
        let driven_a = thermal::driven_a(&self.config.circuit, inputs.coil_duty, self.coil_c);
        let heating_a = self.measured.coil_a.max(self.outputs.coil_target_a).max(driven_a);
        let winding = &self.config.circuit.winding;
        self.coil_c = thermal::step_c(&self.config.thermal, winding, self.coil_c, heating_a, TICK_S);
        if self.mode.palpating.stage() != Stage::Rest {
            let (sum, count, max) = &mut self.contact_ticks;
            *max = (*max).max(inputs.tick_us);
            if self.mode.palpating.stage() == Stage::Contact {
                *sum = sum.saturating_add(u32::from(inputs.tick_us));
                *count = count.saturating_add(1);
            }
        }
    }

    fn guard(&mut self, inputs: &Inputs, tell: &mut impl FnMut(&Report)) {
        self.lease.count(self.mode.needs_host());
        let contradiction = self.contradiction(inputs);
        let input = SafetyInput {
            raw: &self.raw,
            measured: &self.measured,
            calibration: &self.calibration,
            age_ticks: self.age_ticks,
            adc_overrun: inputs.adc_overrun,
            coil_trip: inputs.coil_trip,
            contradiction,
            fitted: &self.fitted,
            calibration_lost: self.calibration_state == CalibrationState::Unreadable,
            coil_c: self.coil_c,
            tick_us: inputs.tick_us,
            period_us: inputs.period_us,
            interlock: inputs.interlock,
            silence: self.lease.silence(),
            actuator_v: self.outputs.actuator_v,
            outputs_on: self.mode.power().is_on(),
            not_finite: self.not_finite,
            table_broken: self.table_broken,
        };
        let tick = self.tick;
        self.safety.step(&self.config.safety, &input, |trip| {
            tell(&Report::Fault(FaultReport { tick, fault: trip.fault as u8, value: trip.value, limit: trip.limit }));
        });
    }

    /// Palpation and mode machine.
    fn palpate(&mut self, inputs: &Inputs) -> ModeEvent {
        // Not `self.table()`: the palpation beside it is changed while the table is open.
        let table = open(&self.active, &self.store);
        let mut progress = Progress::Approaching;
        let mut analysed = true;
        if let Some(table) = &table {
            match self.mode.palpating.stage() {
                Stage::Approach | Stage::Contact if inputs.fresh => {
                    let sample = Sample { probe_mm: self.measured.probe_mm, force_n: self.measured.load_cell_n };
                    progress = self.palpation.step(&self.config.palpation, table, sample);
                }
                Stage::Retract if self.mode.palpating.ended() == Outcome::Identified => {
                    analysed = self.palpation.analyse(&self.config.palpation, table);
                }
                _ => {}
            }
        }
        let input = ModeInput {
            probe_mm: self.measured.probe_mm,
            depth_mm: self.palpation.depth_mm(self.measured.probe_mm),
            force_n: self.measured.load_cell_n,
            contact: self.palpation.has_contact(),
            no_slice: progress.refused(),
            floor_mm: self.floor_mm,
            record_full: progress == Progress::Full,
            analysed,
            faulted: !self.safety.latched().is_empty(),
        };
        self.mode.step(&self.config.mode, &input)
    }

    fn tell_verdict(&mut self, outcome: Outcome, tell: &mut impl FnMut(&Report)) {
        let (sum, count, tick_max_us) = self.contact_ticks;
        let motion = Motion {
            number: self.palpations,
            rate_mm_s: self.palpation_rate_mm_s,
            tick_max_us,
            tick_mean_us: if count > 0 { sum as f32 / count as f32 } else { 0.0 },
        };
        let (estimate, verdict) = self.palpation.report(&self.config.palpation, self.table().as_ref(), outcome, motion);
        if let Some(estimate) = estimate {
            tell(&Report::Estimate(estimate));
        }
        self.remember(&verdict);
        tell(&Report::Verdict(verdict));
    }

    /// Outputs of both halves: off unless a half turns them on.
    fn drive(&mut self) -> Outputs {
        let mut outputs = Outputs { power: self.mode.power(), ..Outputs::default() };
        if let Some(press) = self.mode.palpating.pressing() {
            outputs.arm_run = true;
            outputs.arm_rate_mm_s = press.rate_mm_s;
        }
        let shown = self.show().unwrap_or_default();
        self.shaft_target_mm = shown.target_mm;
        self.shown = shown.shown;
        outputs.actuator_v = shown.actuator_v;
        outputs.coil_target_a = shown.coil_target_a;
        if outputs.power.coil {
            outputs.coil_duty = self.coil_pi.steady_duty(shown.coil_target_a);
        }
        outputs
    }

    /// The record of the last tick.
    pub fn record(&mut self, inputs: &Inputs) -> Telemetry {
        let stage = self.mode.palpating.stage();
        let contact = matches!(stage, Stage::Contact | Stage::Retract);
        let depth_mm = self.palpation.depth_mm(self.measured.probe_mm);
        Telemetry {
            tick: self.tick,
            state: self.mode.state(),
            faults: self.safety.latched(),
            probe_mm: self.measured.probe_mm,
            depth_mm: if contact && depth_mm > 0.0 { depth_mm } else { 0.0 },
            load_cell_n: self.measured.load_cell_n,
            fsr_n: self.measured.fsr_n,
            shaft_mm: self.measured.shaft_mm,
            shaft_target_mm: self.shaft_target_mm,
            actuator_v: self.outputs.actuator_v,
            coil_a: self.measured.coil_a,
            coil_target_a: self.outputs.coil_target_a,
            coil_duty: inputs.coil_duty,
            coil_c: self.coil_c,
            search_error_n: if stage == Stage::Contact { self.palpation.error_n() } else { 0.0 },
            tick_us: inputs.tick_us,
            raw: Raw::from(&self.raw),
            shown: self.shown,
        }
    }
}

/// The table in a store, if one is active.
fn open<'a>(active: &Option<ActiveTable>, store: &'a impl TableStore) -> Option<Table<'a>> {
    let active = active.as_ref()?;
    active.checked.open(store.bytes().get(crate::flash::slot_range(active.slot))?)
}

pub(super) fn outputs_are_finite(outputs: &Outputs) -> bool {
    [outputs.actuator_v, outputs.coil_target_a, outputs.coil_duty, outputs.arm_rate_mm_s].iter().all(|x| x.is_finite())
}
