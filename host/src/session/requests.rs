//! The requests of the table of messages, one function each.

use protocol::message::{
    Actuator, Calibration, DisplayMode, DisplayRequest, Empty, Fitted, Gains, Halves, LastRun, Mode, ModeRequest,
    PalpationMode, PalpationRequest, Refusal, Report, Request, Status, Surface, TelemetryRate,
};

use super::{Session, SessionError};
use crate::link::Link;

/// Lease of a mode, ms: five of the session's keep-alives, so that four of them may be lost.
const LEASE_MS: u16 = 1000;

impl<L: Link> Session<L> {
    /// What the board is doing.
    ///
    /// # Errors
    /// As [`Session::request`]; so for all requests below.
    pub fn status(&mut self) -> Result<Status, SessionError> {
        match self.request(&Request::Status(Empty {}))? {
            Report::Status(status) => Ok(status),
            _ => Err(self.no_sense("Status")),
        }
    }

    /// True where the board works with the table of this hash.
    ///
    /// # Errors
    /// As [`Session::request`].
    pub fn has_table(&mut self, hash: &[u8; 16]) -> Result<bool, SessionError> {
        Ok(self.status()?.table_hash == *hash)
    }

    /// Sets the mode, held by this link for as long as [`Session::poll`] is called. A repeated request that finds the board busy with just this mode has succeeded: only the
    /// answer to the first one was lost.
    ///
    /// # Errors
    /// As [`Session::request`].
    pub fn set_mode(&mut self, mode: Mode) -> Result<(), SessionError> {
        let repeated = self.traffic.requests_repeated;
        match self.request(&Request::SetMode(ModeRequest { mode, lease_ms: LEASE_MS })) {
            Err(SessionError::Refused { reason: Refusal::Busy, .. })
                if self.traffic.requests_repeated > repeated && self.status()?.mode == mode =>
            {
                Ok(())
            }
            other => other.map(|_| ()),
        }
    }

    /// Sets what the palpation half does, whatever the display does; otherwise as [`Session::set_mode`].
    ///
    /// # Errors
    /// As [`Session::request`].
    pub fn set_palpation(&mut self, palpation: PalpationMode) -> Result<(), SessionError> {
        self.request(&Request::SetPalpation(PalpationRequest { palpation, lease_ms: LEASE_MS })).map(|_| ())
    }

    /// Sets what the display half does, whatever palpation does; otherwise as [`Session::set_mode`].
    ///
    /// # Errors
    /// As [`Session::request`].
    pub fn set_display(&mut self, display: DisplayMode) -> Result<(), SessionError> {
        self.request(&Request::SetDisplay(DisplayRequest { display, lease_ms: LEASE_MS })).map(|_| ())
    }

    /// What both halves are doing.
    ///
    /// # Errors
    /// As [`Session::request`].
    pub fn halves(&mut self) -> Result<Halves, SessionError> {
        match self.request(&Request::GetHalves(Empty {}))? {
            Report::Halves(halves) => Ok(halves),
            _ => Err(self.no_sense("GetHalves")),
        }
    }

    /// Sets the gains of the position loop.
    ///
    /// # Errors
    /// As [`Session::request`].
    pub fn set_gains(&mut self, gains: Gains) -> Result<(), SessionError> {
        self.request(&Request::SetGains(gains)).map(|_| ())
    }

    /// Says what the display's actuator can do.
    ///
    /// # Errors
    /// As [`Session::request`].
    pub fn set_actuator(&mut self, actuator: Actuator) -> Result<(), SessionError> {
        self.request(&Request::SetActuator(actuator)).map(|_| ())
    }

    /// The calibration in use.
    ///
    /// # Errors
    /// As [`Session::request`].
    pub fn calibration(&mut self) -> Result<Calibration, SessionError> {
        match self.request(&Request::GetCalibration(Empty {}))? {
            Report::Calibration(calibration) => Ok(calibration),
            _ => Err(self.no_sense("GetCalibration")),
        }
    }

    /// Replaces the calibration.
    ///
    /// # Errors
    /// As [`Session::request`].
    pub fn set_calibration(&mut self, calibration: Calibration) -> Result<(), SessionError> {
        self.request(&Request::SetCalibration(calibration)).map(|_| ())
    }

    /// Says which parts are wired to the board.
    ///
    /// # Errors
    /// As [`Session::request`].
    pub fn set_fitted(&mut self, fitted: Fitted) -> Result<(), SessionError> {
        self.request(&Request::SetFitted(fitted)).map(|_| ())
    }

    /// Says where the next palpation is to find its specimen's surface, mm above the base plate.
    ///
    /// # Errors
    /// As [`Session::request`].
    pub fn expect_surface(&mut self, height_mm: f32) -> Result<(), SessionError> {
        self.request(&Request::ExpectSurface(Surface { height_mm })).map(|_| ())
    }

    /// Lets the load cell's mean fill and takes its zero: a board that was just opened has neither.
    ///
    /// # Errors
    /// As [`Session::tare`].
    pub fn tare_at_rest(&mut self) -> Result<(), SessionError> {
        const MEAN_S: f64 = 0.1;
        self.poll(0.0)?;
        let settled_s = self.link().now_s() + MEAN_S;
        while self.poll(settled_s)?.is_some() {}
        self.tare()
    }

    /// Takes the load cell's present reading as zero.
    ///
    /// # Errors
    /// As [`Session::request`].
    pub fn tare(&mut self) -> Result<(), SessionError> {
        self.request(&Request::Tare(Empty {})).map(|_| ())
    }

    /// Why the run before this one ended.
    ///
    /// # Errors
    /// As [`Session::request`].
    pub fn last_run(&mut self) -> Result<LastRun, SessionError> {
        match self.request(&Request::GetLastRun(Empty {}))? {
            Report::LastRun(last) => Ok(last),
            _ => Err(self.no_sense("GetLastRun")),
        }
    }

    /// Clears latched faults.
    ///
    /// # Errors
    /// As [`Session::request`]; refused while a cause remains.
    pub fn clear_faults(&mut self) -> Result<(), SessionError> {
        self.request(&Request::ClearFaults(Empty {})).map(|_| ())
    }

    /// Telemetry every `divider`-th control tick, 0 for none.
    ///
    /// # Errors
    /// As [`Session::request`].
    pub fn set_telemetry(&mut self, divider: u8) -> Result<(), SessionError> {
        self.request(&Request::SetTelemetry(TelemetryRate { divider }))?;
        self.divider = u32::from(divider).max(1);
        (self.wanted, self.record_s) = (divider, self.record_s.max(self.link.now_s()));
        self.last_tick = None;
        Ok(())
    }
}
