//! The board as one object: link, modes, identification, display, safety, telemetry.
//!
//! The image feeds it from embassy tasks, the host's simulated board from a plant; both run this very code.
//! A control tick is [`Board::tick`] with the readings of [`crate::fast::FastLoop::take`]; bytes of the link go in by [`Board::receive`] and
//! come out by [`Board::take_transmit`] at any time between ticks.
//!
//! # Deadline
//! A tick has 20 ms. One that takes longer delays the next one by as much (ticks do not pile up); it is counted, and latched as a
//! fault if outputs are on, because controller and search assume 20 ms between samples.

mod dispatch;
mod press;

use crate::coil::regulator::CoilPi;
use crate::coil::thermal;
use crate::config::BoardConfig;
use crate::contact::Sample;
use crate::display::{Display, DisplayInput, DisplayOutput};
use crate::fast::{Averaged, FAST_HZ};
use crate::flash::{ActiveTable, CalibrationStore, TableStore, Upload, find_active};
use crate::link::{Priority, Receiver, Transmitter};
use crate::mode::{ModeEvent, ModeInput, ModeState};
use crate::palpation::{Motion, Palpation, Progress};
use crate::pid::Pid;
use crate::plausible::Plausible;
use crate::safety::{Safety, SafetyInput};
use crate::sensor::{Measured, RawSamples};
use crate::telemetry::TelemetryClock;
use press::setup_at_start;
use protocol::TICK_S;
use protocol::fault::Fault;
use protocol::lut::Table;
use protocol::message::{
    Calibration, CalibrationState, FaultReport, Fitted, Mode, Outcome, Report, ResetCause, State, Telemetry,
};

/// What a control tick gets.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Inputs {
    /// Mean readings since the previous tick, fractions of the reference voltage.
    pub raw: RawSamples,
    /// False if there was no new reading since the previous tick; `raw` is then not used.
    pub fresh: bool,
    /// The converter's ring overran since the previous tick.
    pub adc_overrun: bool,
    /// Why the fast loop has switched the coil off since the previous tick.
    pub coil_trip: Option<Fault>,
    /// Duty of the coil that the fast loop applies now, for telemetry.
    pub coil_duty: f32,
    /// Measured duration of the previous tick, us.
    pub tick_us: u16,
}

impl Inputs {
    /// Inputs from the fast loop's mean.
    pub const fn from_fast(averaged: &Averaged, adc_overrun: bool, tick_us: u16) -> Self {
        Inputs {
            raw: averaged.raw,
            fresh: averaged.count > 0,
            adc_overrun,
            coil_trip: averaged.coil_trip,
            coil_duty: averaged.coil_duty,
            tick_us,
        }
    }
}

/// What a control tick wants. `Default` is everything off.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Outputs {
    /// Command of the display's actuator, V, positive pulls the cap in; to the H-bridge as duty over its supply.
    pub actuator_v: f32,
    /// Desired coil current, A, for the fast loop.
    pub coil_target_a: f32,
    /// Duty that holds this current in a cold coil, 0 to 1: for a board without fast loop.
    pub coil_duty: f32,
    /// The palpation arm presses at `arm_rate_mm_s` while true, and returns to its home when false.
    pub arm_run: bool,
    /// Rate of the arm, mm/s; 0 when it does not run.
    pub arm_rate_mm_s: f32,
}

/// Numbers of a board that no configuration holds.
#[derive(Debug, Clone, PartialEq)]
pub struct Identity {
    /// Unique number of the microcontroller.
    pub unique_id: [u8; 12],
    /// Why it last started.
    pub reset_cause: ResetCause,
}

/// Firmware version: major, minor, patch.
pub const FIRMWARE_VERSION: [u8; 3] = [0, 1, 0];

/// The board; `S` is its flash.
#[derive(Debug, Clone)]
pub struct Board<S> {
    config: BoardConfig,
    store: S,
    identity: Identity,
    active: Option<ActiveTable>,
    table_broken: bool,
    upload: Upload,
    /// Sequence number of the `TableBegin` that is answered when the erase has ended.
    begin_seq: Option<u16>,
    calibration: Calibration,
    calibration_state: CalibrationState,
    fitted: Fitted,
    pid: Pid,
    coil_pi: CoilPi,
    receiver: Receiver,
    transmitter: Transmitter,
    /// The host was built from another message table.
    schema_mismatch: bool,
    telemetry: TelemetryClock,
    safety: Safety,
    mode: ModeState,
    palpation: Palpation,
    plausible: Plausible,
    /// Height of the surface that the next palpation is to find, mm.
    expected_mm: Option<f32>,
    /// Lowest height of the probe without contact in this palpation, mm.
    floor_mm: f32,
    palpations: u32,
    palpation_rate_mm_s: f32,
    /// Sum (us) and number of the ticks in contact, and the longest tick of the palpation.
    contact_ticks: (u32, u32, u16),
    display: Display,
    tick: u32,
    age_ticks: u16,
    raw: RawSamples,
    measured: Measured,
    coil_c: f32,
    outputs: Outputs,
    shaft_target_mm: f32,
    not_finite: bool,
}

impl<S: TableStore + CalibrationStore> Board<S> {
    /// A board at start: looks for a table and a calibration in `store`, outputs off.
    pub fn new(config: BoardConfig, mut store: S, identity: Identity) -> Self {
        let (active, table_broken) = find_active(store.bytes());
        let (setup, calibration_state) = setup_at_start(&config, &mut store);
        Board {
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
            begin_seq: None,
            calibration: setup.calibration,
            calibration_state,
            fitted: setup.fitted,
            receiver: Receiver::new(),
            transmitter: Transmitter::new(),
            schema_mismatch: false,
            telemetry: TelemetryClock::default(),
            mode: ModeState::new(),
            palpation: Palpation::new(),
            plausible: Plausible::default(),
            expected_mm: None,
            floor_mm: 0.0,
            palpations: 0,
            palpation_rate_mm_s: 0.0,
            contact_ticks: (0, 0, 0),
            display: Display::default(),
            tick: 0,
            age_ticks: 0,
            raw: RawSamples::default(),
            measured: Measured::default(),
            outputs: Outputs::default(),
            shaft_target_mm: 0.0,
            not_finite: false,
        }
    }

    /// Takes bytes from the link and carries out what they ask for.
    pub fn receive(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.receive_byte(*byte);
        }
    }

    /// Moves bytes for the link into `out`; returns how many.
    pub fn take_transmit(&mut self, out: &mut [u8]) -> usize {
        self.transmitter.take(out)
    }

    /// One control tick.
    pub fn tick(&mut self, inputs: &Inputs) -> Outputs {
        self.tick = self.tick.wrapping_add(1);
        self.sense(inputs);
        self.guard(inputs);
        self.poll_upload();
        let event = if self.upload.is_erasing() { ModeEvent::None } else { self.palpate(inputs) };
        if let ModeEvent::Ended(outcome) = event {
            self.send_verdict(outcome);
        }
        self.outputs = self.drive();
        self.not_finite = !outputs_are_finite(&self.outputs);
        if self.not_finite {
            self.outputs = Outputs::default();
        }
        if self.telemetry.step() {
            let record = Report::Telemetry(self.record(inputs));
            self.transmitter.report(&record, Priority::Telemetry);
        }
        self.outputs
    }

    /// What the board is doing.
    pub const fn state(&self) -> State {
        self.mode.state
    }

    /// Quantities of the last tick.
    pub const fn measured(&self) -> &Measured {
        &self.measured
    }

    /// The flash.
    pub const fn store(&self) -> &S {
        &self.store
    }

    /// The flash, e.g. to cut its power in a test.
    pub fn store_mut(&mut self) -> &mut S {
        &mut self.store
    }

    /// Gives the flash back, as a restart would find it.
    pub fn into_store(self) -> S {
        self.store
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
        let driven_a = thermal::driven_a(&self.config.thermal, &self.config.circuit, inputs.coil_duty, self.coil_c);
        let heating_a = self.measured.coil_a.max(self.outputs.coil_target_a).max(driven_a);
        self.coil_c = thermal::step_c(&self.config.thermal, self.coil_c, heating_a, TICK_S);
        if self.mode.state != State::Idle {
            let (sum, count, max) = &mut self.contact_ticks;
            *max = (*max).max(inputs.tick_us);
            if self.mode.state == State::Contact {
                *sum = sum.saturating_add(u32::from(inputs.tick_us));
                *count = count.saturating_add(1);
            }
        }
    }

    fn guard(&mut self, inputs: &Inputs) {
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
            actuator_v: self.outputs.actuator_v,
            outputs_on: self.mode.outputs_on(),
            not_finite: self.not_finite,
            table_broken: self.table_broken,
        };
        let (tick, transmitter) = (self.tick, &mut self.transmitter);
        self.safety.step(&self.config.safety, &input, |trip| {
            let report =
                Report::Fault(FaultReport { tick, fault: trip.fault as u8, value: trip.value, limit: trip.limit });
            transmitter.report(&report, Priority::Answer);
        });
    }

    /// Palpation and mode machine.
    fn palpate(&mut self, inputs: &Inputs) -> ModeEvent {
        // Not `self.table()`: the palpation beside it is changed while the table is open.
        let table = open(&self.active, &self.store);
        let mut progress = Progress::Approaching;
        let mut analysed = true;
        if let Some(table) = &table {
            match self.mode.state {
                State::Approach | State::Contact if inputs.fresh => {
                    let sample = Sample { probe_mm: self.measured.probe_mm, force_n: self.measured.load_cell_n };
                    progress = self.palpation.step(&self.config.palpation, table, sample);
                }
                State::Retract if self.mode.ended() == Outcome::Identified => {
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

    fn send_verdict(&mut self, outcome: Outcome) {
        let (sum, count, tick_max_us) = self.contact_ticks;
        let motion = Motion {
            number: self.palpations,
            rate_mm_s: self.palpation_rate_mm_s,
            tick_max_us,
            tick_mean_us: if count > 0 { sum as f32 / count as f32 } else { 0.0 },
        };
        let (estimate, verdict) = self.palpation.report(&self.config.palpation, self.table().as_ref(), outcome, motion);
        if let Some(estimate) = estimate {
            self.transmitter.report(&Report::Estimate(estimate), Priority::Answer);
        }
        self.transmitter.report(&Report::Verdict(verdict), Priority::Answer);
    }

    /// Outputs of the state: off unless the state turns them on.
    fn drive(&mut self) -> Outputs {
        let mut outputs = Outputs::default();
        self.shaft_target_mm = 0.0;
        match (self.mode.state, self.mode.commanded) {
            (State::Approach | State::Contact, Mode::Palpate { rate_mm_s, .. }) => {
                outputs.arm_run = true;
                outputs.arm_rate_mm_s = rate_mm_s;
            }
            (State::Display, Mode::Display { material }) => {
                let wanted = self.show(material);
                self.shaft_target_mm = wanted.target_mm;
                outputs.actuator_v = wanted.actuator_v;
                outputs.coil_target_a = wanted.coil_target_a;
                outputs.coil_duty = self.coil_pi.steady_duty(wanted.coil_target_a);
            }
            _ => {}
        }
        outputs
    }

    fn show(&mut self, material: u8) -> DisplayOutput {
        let mut display = self.display;
        let output = self.table().and_then(|table| table.material(usize::from(material))).map(|material| {
            let input =
                DisplayInput { force_n: self.measured.fsr_n, shaft_mm: self.measured.shaft_mm, coil_c: self.coil_c };
            display.step(&self.config.display, &self.config.thermal, &self.pid, &material, &input).fitted(&self.fitted)
        });
        self.display = display;
        output.unwrap_or_default()
    }

    fn record(&mut self, inputs: &Inputs) -> Telemetry {
        let contact = matches!(self.mode.state, State::Contact | State::Retract);
        let depth_mm = self.palpation.depth_mm(self.measured.probe_mm);
        Telemetry {
            tick: self.tick,
            state: self.mode.state,
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
            search_error_n: if self.mode.state == State::Contact { self.palpation.error_n() } else { 0.0 },
            tick_us: inputs.tick_us,
        }
    }
}

/// The table in a store, if one is active.
fn open<'a>(active: &Option<ActiveTable>, store: &'a impl TableStore) -> Option<Table<'a>> {
    let active = active.as_ref()?;
    active.checked.open(store.bytes().get(crate::flash::slot_range(active.slot))?)
}

fn outputs_are_finite(outputs: &Outputs) -> bool {
    [outputs.actuator_v, outputs.coil_target_a, outputs.coil_duty, outputs.arm_rate_mm_s].iter().all(|x| x.is_finite())
}

#[cfg(test)]
mod tests;
