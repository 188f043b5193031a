//! A session that is the same on every board: what happens after which control tick, whatever the board says.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use emulator::board::EmulatedBoard;
use palpate::plant::{Broken, Foam, Input, Touch};
use palpate::simulated_board::SimulatedBoard;
use protocol::frame::{self, CRC32, Decoder, MAX_FRAME};
use protocol::message::{
    CHUNK_LEN, DisplayMode, DisplayRequest, Empty, FaultReport, Halves, Mode, ModeRequest, PalpationMode,
    PalpationRequest, Report, Request, TableBegin, TableChunk, Telemetry, Verdict,
};

/// A request for a mode with the longest lease.
pub fn set_mode(mode: Mode) -> Request {
    Request::SetMode(ModeRequest { mode, lease_ms: 1000 })
}

/// A request for the palpation half with the longest lease.
pub fn set_palpation(palpation: PalpationMode) -> Request {
    Request::SetPalpation(PalpationRequest { palpation, lease_ms: 1000 })
}

/// A request for the display half with the longest lease.
pub fn set_display(display: DisplayMode) -> Request {
    Request::SetDisplay(DisplayRequest { display, lease_ms: 1000 })
}

/// One thing that is done to the board.
pub enum Act {
    Send(Request),
    Place(Foam),
    Touch(Option<Touch>),
    Break(Input, Option<Broken>),
}

/// A board that a script can be run on.
pub trait Rig {
    fn act(&mut self, act: &Act);
    fn send(&mut self, bytes: &[u8]);
    /// Lets time pass to the end of the next control tick.
    fn tick(&mut self);
    fn take(&mut self) -> Vec<u8>;
}

impl Rig for SimulatedBoard {
    fn act(&mut self, act: &Act) {
        match act {
            Act::Send(_) => {}
            Act::Place(foam) => self.place(foam.clone()),
            Act::Touch(touch) => self.touch(*touch),
            Act::Break(input, broken) => self.set_broken(*input, *broken),
        }
    }

    fn send(&mut self, bytes: &[u8]) {
        self.receive(bytes);
    }

    fn tick(&mut self) {
        self.step();
    }

    fn take(&mut self) -> Vec<u8> {
        let mut bytes = Vec::new();
        self.transmit(&mut bytes);
        bytes
    }
}

impl Rig for EmulatedBoard {
    fn act(&mut self, act: &Act) {
        match act {
            Act::Send(_) => {}
            Act::Place(foam) => self.place(foam.clone()),
            Act::Touch(touch) => self.touch(*touch),
            Act::Break(input, broken) => self.set_broken(*input, *broken),
        }
    }

    fn send(&mut self, bytes: &[u8]) {
        self.receive(bytes);
    }

    fn tick(&mut self) {
        assert!(self.run_to_tick(1.0).unwrap(), "no control tick within a second");
    }

    fn take(&mut self) -> Vec<u8> {
        self.take_transmit()
    }
}

/// Acts by the number of ticks before them.
#[derive(Default)]
pub struct Script {
    acts: Vec<(u32, Act)>,
    /// Ticks so far.
    now: u32,
}

impl Script {
    /// Control ticks that it takes.
    pub fn ticks(&self) -> u32 {
        self.now
    }

    pub fn act(&mut self, act: Act) {
        self.acts.push((self.now, act));
    }

    pub fn send(&mut self, request: Request) {
        self.act(Act::Send(request));
    }

    pub fn wait(&mut self, ticks: u32) {
        self.now += ticks;
    }

    /// Waits and asks for the status every 20 ticks, as a host does that wants the link to be alive.
    pub fn keep_alive(&mut self, ticks: u32) {
        for _ in 0..ticks / 20 {
            self.wait(20);
            self.send(Request::Status(Empty {}));
        }
    }

    /// Sends a table, a piece a tick: a piece takes 18 ms on the UART. `erase`: ticks for the erase.
    pub fn upload(&mut self, table: &[u8], erase: u32) {
        self.send(Request::TableBegin(TableBegin { length: table.len() as u32, crc: CRC32.checksum(table) }));
        self.wait(erase);
        for (i, piece) in table.chunks(CHUNK_LEN).enumerate() {
            let data = heapless::Vec::from_slice(piece).unwrap();
            self.send(Request::TableChunk(TableChunk { offset: (i * CHUNK_LEN) as u32, data }));
            self.wait(1);
        }
        self.send(Request::TableCommit(Empty {}));
        self.wait(50);
    }
}

/// What a board said during a script.
#[derive(Default)]
pub struct Heard {
    pub records: Vec<Telemetry>,
    pub halves: Vec<Halves>,
    pub verdicts: Vec<Verdict>,
    pub faults: Vec<FaultReport>,
    /// Everything that was refused, by kind and reason.
    pub refused: Vec<String>,
}

impl Heard {
    pub fn of(rig: &mut impl Rig, script: &Script) -> Heard {
        let mut heard = Heard::default();
        let mut decoder = Decoder::new();
        let mut acts = script.acts.iter().peekable();
        for tick in 0..script.now {
            // The first tick is the one after which nothing has been done yet.
            while let Some((_, act)) = acts.next_if(|(at, _)| *at <= tick) {
                if let Act::Send(request) = act {
                    let mut buffer = [0; MAX_FRAME];
                    rig.send(frame::encode_request(request, tick as u16, &mut buffer).unwrap());
                }
                rig.act(act);
            }
            rig.tick();
            for byte in rig.take() {
                if let Some(frame) = decoder.push(byte) {
                    let frame = frame.unwrap();
                    heard.keep(Report::decode(frame.kind, frame.body).unwrap());
                }
            }
        }
        heard
    }

    fn keep(&mut self, report: Report) {
        match report {
            Report::Telemetry(record) => self.records.push(record),
            Report::Halves(halves) => self.halves.push(halves),
            Report::Verdict(verdict) => self.verdicts.push(verdict),
            Report::Fault(fault) => self.faults.push(fault),
            Report::Refused(refused) => self.refused.push(format!("{refused:?}")),
            _ => {}
        }
    }
}
