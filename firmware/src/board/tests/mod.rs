#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod coil;
mod end_stop;
mod halves;
mod hazards;
mod holders;
mod limits;
mod link;
mod palpation;
mod setup;
mod wires;

use super::*;
use crate::flash::{BANK_LEN, RamFlash};
use crate::link::LinkId;
use crate::sensor::{coil_ratio, fsr_ratio, load_cell_ratio, potentiometer_ratio, probe_ratio};
use crate::testbed::{Foam, factored_table};
use protocol::frame::{Decoder, MAX_FRAME, encode_request};
use protocol::message::{Accepted, Build, Empty, Mode, ModeRequest, Outcome, Refusal, Refused, Request, Telemetry};

type RamBoard = Board<RamFlash<Vec<u8>>>;

/// What is at the pin of a wire that is off.
#[derive(Clone, Copy)]
enum Pin {
    /// The resistor of the drawing: ground within a tick.
    Pulled,
    /// A capacitor, which a leakage carries off so far, as fraction of the reference.
    Bare { leak: f32 },
}

/// A board with its surroundings: an arm that presses a foam, a finger, a shaft that follows its command.
struct Bench {
    board: RamBoard,
    seq: u16,
    reports: Vec<Report>,
    decoder: Decoder,
    probe_mm: f32,
    home_mm: f32,
    foam: Option<Foam>,
    finger_n: f32,
    shaft_mm: f32,
    /// What the potentiometer reads too much, mm.
    shaft_off_mm: f32,
    outputs: Outputs,
    /// Channel whose wire is off, what is at its pin, and what the pins hold.
    off: Option<(usize, Pin)>,
    pins: [f32; 5],
    /// Changes the inputs of every tick.
    spoil: fn(&mut Inputs),
}

impl Bench {
    fn with_flash(bytes: Vec<u8>, cause: ResetCause) -> Self {
        let identity = Identity {
            unique_id: *b"unit test 01",
            reset_cause: cause,
            build: Build::UNKNOWN,
            last_run: LastRun::NONE,
        };
        let board = Board::new(BoardConfig::default(), RamFlash::new(bytes), identity);
        Bench {
            board,
            seq: 0,
            reports: vec![],
            decoder: Decoder::new(),
            probe_mm: 30.0,
            home_mm: 30.0,
            foam: None,
            finger_n: 0.0,
            shaft_mm: 0.0,
            shaft_off_mm: 0.0,
            outputs: Outputs::default(),
            off: None,
            pins: [0.0; 5],
            spoil: |_| {},
        }
    }

    fn blank() -> Self {
        Self::with_flash(vec![0xff; BANK_LEN], ResetCause::PowerOn)
    }

    /// With the made-up table in slot A.
    fn new() -> Self {
        let mut bank = vec![0xff; BANK_LEN];
        let table = factored_table();
        bank[..table.len()].copy_from_slice(&table);
        Self::with_flash(bank, ResetCause::PowerOn)
    }

    fn tick(&mut self) {
        let c = &self.board.machine.config;
        let force_n = self.foam.map_or(0.0, |foam| foam.force_n(foam.height_mm - f64::from(self.probe_mm)) as f32);
        let raw = RawSamples {
            load_cell: load_cell_ratio(force_n, &c.calibration.load_cell),
            fsr: fsr_ratio(self.finger_n, &c.calibration.fsr),
            potentiometer: potentiometer_ratio(self.shaft_mm + self.shaft_off_mm, &c.calibration.potentiometer),
            probe_position: probe_ratio(self.probe_mm, &c.calibration.probe),
            coil_current: coil_ratio(self.outputs.coil_target_a, &c.shunt),
        };
        let raw = self.wired(raw);
        let mut inputs = Inputs { raw, fresh: true, tick_us: 400, ..Inputs::default() };
        (self.spoil)(&mut inputs);
        self.outputs = self.board.tick(&inputs);
        let step_mm = if self.outputs.arm_run { -self.outputs.arm_rate_mm_s / 50.0 } else { 10.0 / 50.0 };
        self.probe_mm = (self.probe_mm + step_mm).min(self.home_mm);
        // First-order stand-in for the actuator: gain 1 mm/V, 0.25 s.
        self.shaft_mm = (self.shaft_mm + 0.08 * (self.outputs.actuator_v - self.shaft_mm)).max(0.0);
        self.collect();
    }

    /// A pin whose wire is off follows the channel converted before it with 1.25 s (100 nF and 5 pF at 16 kHz).
    fn wired(&mut self, raw: RawSamples) -> RawSamples {
        let (held, mut channels) = (self.pins, raw.channels());
        if let Some((channel, pin)) = self.off {
            let rest = match pin {
                Pin::Pulled => 0.0,
                Pin::Bare { leak } => {
                    held[channel] + (1.0 - (-0.02f32 / 1.25).exp()) * (held[(channel + 4) % 5] + leak - held[channel])
                }
            };
            channels[channel] = rest;
        }
        self.pins = channels;
        RawSamples::from_channels(channels)
    }

    fn ticks(&mut self, count: usize) {
        (0..count).for_each(|_| self.tick());
    }

    /// Ticks until a display ends, its shaft held where it is and its host alive.
    fn ticks_with_shaft_at(&mut self, shaft_mm: f32) -> u32 {
        let mut ticks = 0;
        while self.board.state() == State::Display {
            self.shaft_mm = shaft_mm;
            if ticks % 25 == 0 {
                self.send(&Request::Status(Empty {}));
            }
            self.tick();
            ticks += 1;
            assert!(ticks < 400);
        }
        ticks
    }

    fn collect(&mut self) {
        let mut buffer = [0; 512];
        loop {
            let count = self.board.take_transmit(LinkId::Usb, &mut buffer);
            if count == 0 {
                return;
            }
            for byte in &buffer[..count] {
                if let Some(Ok(frame)) = self.decoder.push(*byte)
                    && frame.kind != 0
                {
                    self.reports.push(Report::decode(frame.kind, frame.body).unwrap());
                }
            }
        }
    }

    fn send(&mut self, request: &Request) {
        let mut buffer = [0; MAX_FRAME];
        let bytes = encode_request(request, self.seq, &mut buffer).unwrap();
        self.board.receive(LinkId::Usb, bytes);
        self.seq = self.seq.wrapping_add(1);
        self.collect();
    }

    /// Sends and returns the answer, which must come at once.
    fn ask(&mut self, request: &Request) -> Report {
        self.reports.clear();
        self.send(request);
        self.reports.pop().expect("an answer")
    }

    fn refusal(&mut self, request: &Request) -> Refusal {
        match self.ask(request) {
            Report::Refused(Refused { reason, .. }) => reason,
            other => panic!("{other:?}"),
        }
    }

    fn accept(&mut self, request: &Request) {
        match self.ask(request) {
            Report::Accepted(Accepted { of, seq }) => assert_eq!((of, seq), (request.kind(), self.seq.wrapping_sub(1))),
            other => panic!("{other:?}"),
        }
    }

    fn mode(&mut self, mode: Mode) {
        self.accept(&set_mode(mode));
    }

    /// Ticks with a status request every half second, as a host does, until `done`.
    fn run_until(&mut self, limit: usize, done: impl Fn(&Bench) -> bool) {
        for i in 0..limit {
            if done(self) {
                return;
            }
            if i % 25 == 0 {
                self.send(&Request::Status(Empty {}));
            }
            self.tick();
        }
        panic!("not done after {limit} ticks, state {:?}", self.board.state());
    }

    /// The record of the last tick.
    fn record(&mut self) -> Telemetry {
        self.board.machine.record(&Inputs::default())
    }

    fn faults(&self) -> Vec<protocol::fault::Fault> {
        self.board.machine.safety.latched().iter().collect()
    }

    fn verdict(&self) -> Option<&protocol::message::Verdict> {
        self.reports.iter().find_map(|r| match r {
            Report::Verdict(verdict) => Some(verdict),
            _ => None,
        })
    }
}

/// A request for a mode with the longest lease.
fn set_mode(mode: Mode) -> Request {
    Request::SetMode(ModeRequest { mode, lease_ms: LEASE_MS.1 })
}

const PALPATE: Mode = Mode::Palpate { rate_mm_s: 4.0, depth_mm: 3.5 };
