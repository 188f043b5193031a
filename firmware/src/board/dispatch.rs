//! Requests: what each one does, and when it is refused.

use super::{Board, FIRMWARE_VERSION};
use crate::display::Display;
use crate::flash::{CalibrationStore, SLOT_LEN, Setup, TableStore};
use crate::link::Priority;
use crate::mode::TableLimits;
use crate::pid::{Pid, gains_are_usable};
use crate::search::Slice;
use crate::sensor::{calibration_is_usable, tared};
use protocol::frame::Frame;
use protocol::message::{
    Accepted, Calibration, CalibrationState, DecodeError, Gains, Hello, HelloRequest, Mode, Refusal, Refused, Report,
    Request, Slot, State, Status, TableBegin, TableState,
};
use protocol::{PROTOCOL_VERSION, TICK_HZ, TICK_S, message, rescue};

/// A zero that has moved by less is the old one: two deviations of the noise of a tick's mean, 0.2 mN.
const TARE_RATIO: f32 = 2e-5;

/// What a request led to. Lives for one call on the stack, where its size does no harm.
#[allow(clippy::large_enum_variant)]
pub(super) enum Answer {
    Accepted,
    Report(Report),
    /// Nothing now; the answer follows.
    Later,
}

/// A frame taken out of the decoder's buffer; likewise.
#[allow(clippy::large_enum_variant)]
enum Incoming {
    Rescue,
    Request(Request),
    Refused { kind: u8, reason: Refusal },
    Nothing,
}

impl<S: TableStore + CalibrationStore> Board<S> {
    pub(super) fn receive_byte(&mut self, byte: u8) {
        let Some(frame) = self.receiver.push(byte) else {
            return;
        };
        let seq = frame.seq;
        match understand(&frame) {
            Incoming::Rescue => {
                let answer = rescue::Answer::of_this_build(FIRMWARE_VERSION);
                self.transmitter.rescue(answer);
            }
            Incoming::Request(request) => self.carry_out(&request, seq),
            Incoming::Refused { kind, reason } => {
                self.receiver.rejected = self.receiver.rejected.saturating_add(1);
                self.refuse(kind, seq, reason);
            }
            Incoming::Nothing => {
                self.receiver.rejected = self.receiver.rejected.saturating_add(1);
            }
        }
    }

    fn carry_out(&mut self, request: &Request, seq: u16) {
        let of = request.kind();
        if self.schema_mismatch && !matches!(request, Request::Hello(_)) {
            return self.refuse(of, seq, Refusal::SchemaMismatch);
        }
        self.safety.link_alive();
        let report = match self.answer(request, seq) {
            Ok(Answer::Accepted) => Report::Accepted(Accepted { of, seq }),
            Ok(Answer::Report(report)) => report,
            Ok(Answer::Later) => return,
            Err(reason) => return self.refuse(of, seq, reason),
        };
        self.transmitter.report(&report, Priority::Answer);
    }

    fn refuse(&mut self, of: u8, seq: u16, reason: Refusal) {
        let report = Report::Refused(Refused { of, seq, reason });
        self.transmitter.report(&report, Priority::Answer);
    }

    fn answer(&mut self, request: &Request, seq: u16) -> Result<Answer, Refusal> {
        match request {
            Request::Hello(hello) => Ok(Answer::Report(self.greet(hello))),
            Request::Status(_) => Ok(Answer::Report(Report::Status(self.status()))),
            Request::SetMode(mode) => self.set_mode(*mode),
            Request::SetGains(gains) => self.set_gains(gains),
            Request::GetCalibration(_) => Ok(Answer::Report(Report::Calibration(self.calibration.clone()))),
            Request::SetCalibration(calibration) => self.set_calibration(calibration.clone()),
            Request::Tare(_) => self.tare(),
            Request::ClearFaults(_) => self.clear_faults(),
            Request::SetTelemetry(rate) => {
                self.telemetry.set(rate.divider);
                Ok(Answer::Accepted)
            }
            Request::ExpectSurface(surface) => self.expect_surface(surface),
            Request::SetFitted(fitted) => self.set_fitted(fitted),
            Request::TableBegin(begin) => {
                self.outputs_must_be_off()?;
                self.upload.begin(&mut self.store, &mut self.active, begin)?;
                self.begin_seq = Some(seq);
                Ok(Answer::Later)
            }
            Request::TableChunk(chunk) => {
                self.outputs_must_be_off()?;
                self.upload.chunk(&mut self.store, chunk)?;
                Ok(Answer::Report(Report::TableState(self.table_state())))
            }
            Request::TableCommit(_) => {
                self.outputs_must_be_off()?;
                self.upload.commit(&mut self.store, &mut self.active)?;
                self.table_broken = false;
                Ok(Answer::Report(Report::TableState(self.table_state())))
            }
            Request::TableQuery(_) => Ok(Answer::Report(Report::TableState(self.table_state()))),
        }
    }

    fn greet(&mut self, hello: &HelloRequest) -> Report {
        self.schema_mismatch = hello.protocol_version != PROTOCOL_VERSION || hello.schema_hash != message::SCHEMA_HASH;
        if !self.schema_mismatch {
            self.telemetry.set(1);
        }
        Report::Hello(Hello {
            protocol_version: PROTOCOL_VERSION,
            schema_hash: message::SCHEMA_HASH,
            firmware_version: FIRMWARE_VERSION,
            unique_id: self.identity.unique_id,
            simulated: self.config.simulated,
            slot_len: SLOT_LEN as u32,
            reset_cause: self.identity.reset_cause,
        })
    }

    fn status(&self) -> Status {
        Status {
            uptime_ms: self.tick.wrapping_mul(1000 / TICK_HZ),
            mode: self.mode.commanded,
            state: self.mode.state,
            faults: self.safety.latched(),
            frames_rejected: self.receiver.rejected,
            frames_dropped: self.transmitter.dropped,
            deadlines_missed: self.safety.deadlines_missed,
            tick_max_us: self.safety.tick_max_us,
            table_hash: self.active.map_or([0; 16], |a| a.checked.hash()),
            calibration: self.calibration_state,
            fitted: self.fitted.clone(),
        }
    }

    fn set_mode(&mut self, mode: Mode) -> Result<Answer, Refusal> {
        // Asked again for what is under way: the answer to the first request was lost.
        if mode == self.mode.commanded && matches!(self.mode.state, State::Approach | State::Contact) {
            return Ok(Answer::Accepted);
        }
        if mode != Mode::Idle && self.upload.is_erasing() {
            return Err(Refusal::Busy);
        }
        // Bank 2 must not be read during an erase.
        let limits = if self.upload.is_erasing() {
            None
        } else {
            self.table().map(|t| TableLimits {
                depth_max_mm: t.depth_max_mm(),
                materials: t.material_count(),
                // All slices of a table are alike in size.
                searchable: Slice::nearest(&t, 0.0, 0.0).is_some(),
            })
        };
        if mode != Mode::Idle && !self.safety.latched().is_empty() {
            return Err(Refusal::Faulted);
        }
        self.is_fitted_for(mode)?;
        let displayed = self.mode.state == State::Display;
        self.mode.request(&self.config.mode, mode, limits)?;
        match mode {
            Mode::Palpate { rate_mm_s, .. } => {
                self.palpation.start(rate_mm_s);
                self.watch_press();
                self.palpations = self.palpations.wrapping_add(1);
                self.palpation_rate_mm_s = rate_mm_s;
                self.contact_ticks = (0, 0, 0);
            }
            Mode::Display { .. } if !displayed => self.display = Display::at(self.measured.shaft_mm),
            _ => {}
        }
        Ok(Answer::Accepted)
    }

    fn set_gains(&mut self, gains: &Gains) -> Result<Answer, Refusal> {
        if !gains_are_usable(gains) {
            return Err(Refusal::OutOfRange);
        }
        self.config.gains = gains.clone();
        self.pid = Pid::build(gains, TICK_S, self.config.u_max_v);
        Ok(Answer::Accepted)
    }

    fn set_calibration(&mut self, calibration: Calibration) -> Result<Answer, Refusal> {
        if !calibration_is_usable(&calibration) {
            return Err(Refusal::OutOfRange);
        }
        self.store_setup(Setup { calibration, fitted: self.fitted.clone() })
    }

    /// Takes the load cell's last mean reading as zero.
    fn tare(&mut self) -> Result<Answer, Refusal> {
        if self.age_ticks > 0 || self.tick == 0 {
            return Err(Refusal::Busy);
        }
        if self.calibration_state == CalibrationState::Unreadable {
            return Err(Refusal::CalibrationLost);
        }
        let mut calibration = self.calibration.clone();
        if (self.raw.load_cell - calibration.load_cell.zero_ratio).abs() < TARE_RATIO {
            self.outputs_must_be_off()?;
            return Ok(Answer::Accepted);
        }
        calibration.load_cell = tared(&calibration.load_cell, self.raw.load_cell);
        self.set_calibration(calibration)
    }

    fn clear_faults(&mut self) -> Result<Answer, Refusal> {
        if !self.safety.clear() {
            return Err(Refusal::CauseRemains);
        }
        Ok(Answer::Accepted)
    }

    /// Idle, or held off by a fault.
    pub(super) fn outputs_must_be_off(&self) -> Result<(), Refusal> {
        match self.mode.state {
            State::Idle | State::Fault => Ok(()),
            _ => Err(Refusal::Busy),
        }
    }

    pub(super) fn poll_upload(&mut self) {
        let Some(result) = self.upload.poll(&mut self.store) else {
            return;
        };
        let seq = self.begin_seq.take().unwrap_or(0);
        match result {
            Ok(()) => {
                let report = Report::TableState(self.table_state());
                self.transmitter.report(&report, Priority::Answer);
            }
            Err(reason) => {
                let of = Request::TableBegin(TableBegin { length: 0, crc: 0 }).kind();
                self.refuse(of, seq, reason);
            }
        }
    }

    fn table_state(&self) -> TableState {
        TableState {
            active: self.active.map_or(Slot::None, |a| a.slot),
            hash: self.active.map_or([0; 16], |a| a.checked.hash()),
            next_offset: self.upload.next_offset(),
            length: self.upload.length(),
        }
    }
}

fn understand(frame: &Frame<'_>) -> Incoming {
    if frame.kind == rescue::KIND {
        return if frame.body.starts_with(&rescue::QUESTION) { Incoming::Rescue } else { Incoming::Nothing };
    }
    match Request::decode(frame.kind, frame.body) {
        Ok(request) => Incoming::Request(request),
        Err(DecodeError::Unknown { kind }) => Incoming::Refused { kind, reason: Refusal::Unknown },
        Err(DecodeError::Malformed { kind }) => Incoming::Refused { kind, reason: Refusal::Malformed },
    }
}
