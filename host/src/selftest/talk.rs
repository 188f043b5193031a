//! Questions and answers of the self test.

use protocol::frame::{self, Decoder, MAX_FRAME};
use protocol::message::Empty;
use protocol::message::{Refusal, Report as BoardReport};
use protocol::selftest::{Drive, Ending, Identity, Measured, Report, Request, SCHEMA_HASH, Way};

use super::SelftestError;
use crate::link::Link;

/// How often a question is asked that may be lost on the line.
const ATTEMPTS: u32 = 3;

/// Longest wait for an answer that takes no time to find, s.
const ANSWER_S: f64 = 1.0;

/// Longest wait for a program that starts anew, s: a hang is reset after 1 s, and the start takes 0.1 s.
const RESTART_S: f64 = 5.0;

/// A conversation with the self-test program.
#[derive(Debug)]
pub struct Talk<L> {
    link: L,
    decoder: Decoder,
    seq: u16,
}

impl<L: Link> Talk<L> {
    /// A conversation over an open link.
    pub fn new(link: L) -> Self {
        Talk { link, decoder: Decoder::new(), seq: 0 }
    }

    /// Time on the link, s.
    pub fn now_s(&self) -> f64 {
        self.link.now_s()
    }

    /// Who is there.
    ///
    /// # Errors
    /// [`SelftestError`]: nobody, another program, or another version of it.
    pub fn identify(&mut self) -> Result<Identity, SelftestError> {
        match self.ask(&Request::Identify(Empty {}), ANSWER_S)? {
            Report::Identity(identity) if identity.schema_hash == SCHEMA_HASH => Ok(identity),
            _ => Err(SelftestError::OtherVersion { board: self.link.name().into() }),
        }
    }

    /// Outputs on, means of what is seen, outputs off.
    ///
    /// # Errors
    /// [`SelftestError`].
    pub fn measure(&mut self, drive: Drive) -> Result<Measured, SelftestError> {
        let wait_s = f64::from(drive.settle_ms) / 1e3 + f64::from(drive.average_ms) / 1e3 + ANSWER_S;
        match self.ask(&Request::Measure(drive), wait_s)? {
            Report::Measured(measured) => Ok(measured),
            _ => Err(self.unexpected()),
        }
    }

    /// Ends the run in a way, and waits for the next; `None` if none begins.
    ///
    /// # Errors
    /// [`SelftestError`].
    pub fn end(&mut self, way: Way) -> Result<Option<Identity>, SelftestError> {
        // Asked once: the next run would end as well.
        self.ask_once(&Request::End(Ending { way }), ANSWER_S)?;
        let until_s = self.link.now_s() + RESTART_S;
        // What is heard before the end is the old run.
        self.wait(0.3)?;
        while self.link.now_s() < until_s {
            match self.ask_once(&Request::Identify(Empty {}), 0.3) {
                Ok(Report::Identity(identity)) => return Ok(Some(identity)),
                Ok(_) | Err(SelftestError::NoAnswer { .. }) => {}
                Err(error) => return Err(error),
            }
        }
        Ok(None)
    }

    /// Asks, and waits for each attempt's answer for so long.
    ///
    /// # Errors
    /// [`SelftestError`].
    pub fn ask(&mut self, request: &Request, wait_s: f64) -> Result<Report, SelftestError> {
        self.ask_times(request, wait_s, ATTEMPTS)
    }

    /// Asks once, where a second time would do it again.
    ///
    /// # Errors
    /// [`SelftestError`].
    pub fn ask_once(&mut self, request: &Request, wait_s: f64) -> Result<Report, SelftestError> {
        self.ask_times(request, wait_s, 1)
    }

    /// The error of an answer to another question.
    pub(super) fn unexpected(&self) -> SelftestError {
        SelftestError::OtherVersion { board: self.link.name().into() }
    }

    fn wait(&mut self, time_s: f64) -> Result<(), SelftestError> {
        let until_s = self.link.now_s() + time_s;
        while self.link.now_s() < until_s {
            self.link.receive(&mut Vec::new(), until_s)?;
        }
        self.decoder = Decoder::new();
        Ok(())
    }

    fn ask_times(&mut self, request: &Request, wait_s: f64, attempts: u32) -> Result<Report, SelftestError> {
        for _ in 0..attempts {
            self.seq = self.seq.wrapping_add(1);
            let mut buffer = [0; MAX_FRAME];
            // A zero ends whatever noise the program has taken for the beginning of a frame. One piece: a pause of the line
            // may cost the byte after it.
            let mut bytes = vec![0];
            // Every request fits a frame: its longest is an echo.
            if let Ok(frame) = frame::encode_selftest_request(request, self.seq, &mut buffer) {
                bytes.extend_from_slice(frame);
            }
            self.link.send(&bytes)?;
            let until_s = self.link.now_s() + wait_s;
            if let Some(report) = self.answer(until_s)? {
                return Ok(report);
            }
        }
        Err(SelftestError::NoAnswer {
            board: self.link.name().into(),
            request: name(request),
            waited_s: wait_s * f64::from(attempts),
        })
    }

    fn answer(&mut self, until_s: f64) -> Result<Option<Report>, SelftestError> {
        let mut bytes = Vec::new();
        loop {
            bytes.clear();
            self.link.receive(&mut bytes, until_s)?;
            for byte in &bytes {
                let Some(Ok(frame)) = self.decoder.push(*byte) else { continue };
                if frame.seq == self.seq
                    && let Ok(report) = Report::decode(frame.kind, frame.body)
                {
                    return Ok(Some(report));
                }
                if let Ok(BoardReport::Refused(refused)) = BoardReport::decode(frame.kind, frame.body)
                    && refused.reason == Refusal::Unknown
                {
                    return Err(SelftestError::DisplayBoard { board: self.link.name().into() });
                }
            }
            if self.link.now_s() >= until_s {
                return Ok(None);
            }
        }
    }
}

fn name(request: &Request) -> &'static str {
    Request::TABLE.iter().find(|(kind, _)| *kind == request.kind()).map_or("request", |(_, name)| name)
}
