//! Requests: what each one does, and when it is refused.

use super::FIRMWARE_VERSION;
use super::machine::Machine;
use super::talk::Talk;
use crate::flash::{CalibrationStore, SLOT_LEN, Setup, TableStore};
use crate::link::{LinkId, Priority};
use crate::mode::TableLimits;
use crate::pid::{Pid, gains_are_usable};
use crate::search::Slice;
use crate::sensor::{calibration_is_usable, tared};
use protocol::message::{
    Accepted, Actuator, Calibration, CalibrationState, Gains, Hello, Refusal, Refused, Report, Request, SCHEMA_HASH,
    Slot, Status, TableBegin, TableState,
};
use protocol::{PROTOCOL_VERSION, TICK_HZ, TICK_S};

/// Number of the request that begins an upload.
const TABLE_BEGIN: u8 = Request::TableBegin(TableBegin { length: 0, crc: 0 }).kind();

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

impl<S: TableStore + CalibrationStore> Machine<S> {
    /// Carries out a request of a link and answers it there.
    pub(super) fn carry_out(&mut self, link: LinkId, talk: &mut Talk, request: &Request, seq: u16) {
        let of = request.kind();
        self.lease.heard(link);
        let report = match self.answer(link, talk, request, seq) {
            Ok(Answer::Accepted) => Report::Accepted(Accepted { of, seq }),
            Ok(Answer::Report(report)) => report,
            Ok(Answer::Later) => return,
            Err(reason) => return talk.refuse(of, seq, reason),
        };
        talk.report(&report, Priority::Answer);
    }

    fn answer(&mut self, link: LinkId, talk: &mut Talk, request: &Request, seq: u16) -> Result<Answer, Refusal> {
        match request {
            Request::Hello(hello) => {
                talk.greeted(hello);
                Ok(Answer::Report(Report::Hello(self.hello())))
            }
            Request::Status(_) => Ok(Answer::Report(Report::Status(self.status(link, talk)))),
            Request::SetMode(asked) => self.set_mode(link, asked),
            Request::SetPalpation(asked) => self.set_palpation(link, asked),
            Request::SetDisplay(asked) => self.set_display(link, asked),
            Request::GetHalves(_) => Ok(Answer::Report(Report::Halves(self.halves()))),
            Request::SetGains(gains) => self.set_gains(link, gains),
            Request::SetActuator(actuator) => self.set_actuator(link, actuator),
            Request::GetCalibration(_) => Ok(Answer::Report(Report::Calibration(self.calibration.clone()))),
            Request::SetCalibration(calibration) => self.set_calibration(calibration.clone()),
            Request::Tare(_) => self.tare(),
            Request::ClearFaults(_) => self.clear_faults(),
            Request::SetTelemetry(rate) => {
                talk.set_telemetry(rate.divider);
                Ok(Answer::Accepted)
            }
            Request::ExpectSurface(surface) => self.expect_surface(link, surface),
            Request::SetFitted(fitted) => self.set_fitted(fitted),
            Request::TableBegin(begin) => {
                self.outputs_must_be_off()?;
                self.upload.begin(&mut self.store, &mut self.active, begin)?;
                // Its numbers are those of the old library.
                self.identified = None;
                self.begun = Some((link, seq));
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
            Request::GetLastRun(_) => Ok(Answer::Report(Report::LastRun(self.identity.last_run.clone()))),
            Request::TableQuery(_) => Ok(Answer::Report(Report::TableState(self.table_state()))),
        }
    }

    fn hello(&self) -> Hello {
        Hello {
            protocol_version: PROTOCOL_VERSION,
            schema_hash: SCHEMA_HASH,
            firmware_version: FIRMWARE_VERSION,
            build: self.identity.build.clone(),
            unique_id: self.identity.unique_id,
            simulated: self.config.simulated,
            slot_len: SLOT_LEN as u32,
            reset_cause: self.identity.reset_cause,
        }
    }

    fn status(&self, link: LinkId, talk: &Talk) -> Status {
        Status {
            uptime_ms: self.tick.wrapping_mul(1000 / TICK_HZ),
            mode: self.mode.commanded(),
            state: self.mode.state(),
            faults: self.safety.latched(),
            frames_rejected: talk.rejected(),
            frames_dropped: talk.dropped(),
            deadlines_missed: self.safety.deadlines_missed,
            tick_max_us: self.safety.tick_max_us,
            ticks_late: self.safety.ticks_late,
            period_max_us: self.safety.period_max_us,
            holder: self.lease.seen_from(link),
            table_hash: self.active.map_or([0; 16], |a| a.checked.hash()),
            calibration: self.calibration_state,
            fitted: self.fitted.clone(),
        }
    }

    /// The motion belongs to the link that holds it.
    pub(super) fn must_not_be_held_from(&self, link: LinkId) -> Result<(), Refusal> {
        if self.lease.is_held_from(link) { Err(Refusal::Held) } else { Ok(()) }
    }

    /// What a mode needs to know of the table; nothing during an erase, when bank 2 must not be read.
    pub(super) fn table_limits(&self) -> Option<TableLimits> {
        if self.upload.is_erasing() {
            return None;
        }
        self.table().map(|t| TableLimits {
            depth_max_mm: t.depth_max_mm(),
            materials: t.material_count(),
            // All slices of a table are alike in size.
            searchable: Slice::nearest(&t, 0.0, 0.0).is_some(),
        })
    }

    fn set_gains(&mut self, link: LinkId, gains: &Gains) -> Result<Answer, Refusal> {
        self.must_not_be_held_from(link)?;
        if !gains_are_usable(gains) {
            return Err(Refusal::OutOfRange);
        }
        self.config.gains = gains.clone();
        self.pid = Pid::build(gains, TICK_S, self.config.u_max_v);
        Ok(Answer::Accepted)
    }

    fn set_actuator(&mut self, link: LinkId, actuator: &Actuator) -> Result<Answer, Refusal> {
        self.must_not_be_held_from(link)?;
        self.outputs_must_be_off()?;
        self.config.display = self.config.display.with(actuator).ok_or(Refusal::OutOfRange)?;
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
        if self.mode.is_resting() { Ok(()) } else { Err(Refusal::Busy) }
    }

    /// Goes on with an erase; what its end is answered with, and where.
    pub(super) fn poll_upload(&mut self) -> Option<(LinkId, Report)> {
        let result = self.upload.poll(&mut self.store)?;
        let (link, seq) = self.begun.take()?;
        let report = match result {
            Ok(()) => Report::TableState(self.table_state()),
            Err(reason) => Report::Refused(Refused { of: TABLE_BEGIN, seq, reason }),
        };
        Some((link, report))
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
