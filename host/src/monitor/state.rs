//! What is known of the board, and what a key means now.

use std::collections::VecDeque;
use std::path::PathBuf;

use protocol::TICK_HZ;
use protocol::fault::{Fault, FaultSet};
use protocol::message::{Estimate, Hello, Mode, State, Status, Telemetry, Verdict};

use super::{Command, Key, Update};
use crate::log::{CurveNews, verdict_text};
use crate::session::{Event, Traffic, fault_text, gap_text};

/// Ticks that the traces show: ten seconds.
pub const SHOWN_TICKS: usize = 10 * TICK_HZ as usize;

/// Lines of the journal that are kept.
const JOURNAL: usize = 100;

/// Rates that a key goes through, mm/s: what the board allows.
const RATES_MM_S: (f32, f32, f32) = (1.0, 4.0, 0.5);

/// The way to the board.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Connection {
    /// Being opened; what is being done meanwhile.
    Opening(String),
    /// The board answers.
    Open,
    /// Lost, and tried again by itself.
    Lost {
        /// Why.
        reason: String,
        /// Attempts since then.
        attempts: u32,
    },
}

/// A table on the host: the board knows its materials by number only.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Library {
    /// Hash of the table.
    pub hash: [u8; 16],
    /// Names of its materials.
    pub names: Vec<String>,
}

/// How much a line of the journal matters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Weight {
    /// A remark.
    Remark,
    /// A verdict.
    Verdict,
    /// A fault, a refusal, a lost link.
    Alarm,
}

/// The dashboard's state.
#[derive(Debug, Clone)]
pub struct Monitor {
    pub(super) board: String,
    pub(super) connection: Connection,
    pub(super) hello: Option<Hello>,
    pub(super) status: Option<Status>,
    pub(super) records: VecDeque<Telemetry>,
    pub(super) traffic: Traffic,
    pub(super) verdict: Option<Verdict>,
    pub(super) estimate: Option<Estimate>,
    curve: CurveNews,
    pub(super) journal: VecDeque<(Weight, String)>,
    pub(super) recording: Option<PathBuf>,
    pub(super) upload: Option<(u32, u32)>,
    pub(super) armed: bool,
    pub(super) material: u8,
    pub(super) rate_mm_s: f32,
    library: Option<Library>,
    depth_mm: f32,
    done: bool,
}

impl Monitor {
    /// A dashboard of the board called `board`, of which nothing is known yet. Palpations go `depth_mm` deep.
    #[must_use]
    pub fn new(board: &str, library: Option<Library>, depth_mm: f32) -> Self {
        Monitor {
            board: board.to_owned(),
            connection: Connection::Opening("opening".into()),
            hello: None,
            status: None,
            records: VecDeque::with_capacity(SHOWN_TICKS),
            traffic: Traffic::default(),
            verdict: None,
            estimate: None,
            curve: CurveNews::default(),
            journal: VecDeque::new(),
            recording: None,
            upload: None,
            armed: false,
            material: 0,
            rate_mm_s: 2.0,
            library,
            depth_mm,
            done: false,
        }
    }

    /// True when the person wants to leave.
    #[must_use]
    pub fn is_done(&self) -> bool {
        self.done
    }

    /// The way to the board.
    #[must_use]
    pub fn connection(&self) -> &Connection {
        &self.connection
    }

    /// True while keys may turn outputs on.
    #[must_use]
    pub fn is_armed(&self) -> bool {
        self.armed
    }

    /// The newest line of the journal.
    #[must_use]
    pub fn newest(&self) -> Option<&str> {
        self.journal.front().map(|(_, text)| text.as_str())
    }

    /// Latched faults, as of the newest record.
    #[must_use]
    pub fn faults(&self) -> FaultSet {
        self.records.back().map_or(FaultSet::NONE, |t| t.faults)
    }

    /// Name of a material, if the board's table is the one on the host.
    pub(super) fn name_of(&self, material: u8) -> Option<&str> {
        let library = self.library.as_ref().filter(|library| self.board_has(library))?;
        library.names.get(usize::from(material)).map(String::as_str)
    }

    /// Names of the materials, if the board's table is the one on the host.
    fn names(&self) -> Vec<String> {
        self.library.as_ref().filter(|l| self.board_has(l)).map(|l| l.names.clone()).unwrap_or_default()
    }

    /// The board's table is not the one on the host.
    pub(super) fn other_table(&self) -> bool {
        self.status.is_some() && self.library.as_ref().is_some_and(|library| !self.board_has(library))
    }

    fn board_has(&self, library: &Library) -> bool {
        self.status.as_ref().is_some_and(|status| status.table_hash == library.hash)
    }

    fn note(&mut self, weight: Weight, text: impl Into<String>) {
        self.journal.push_front((weight, text.into()));
        self.journal.truncate(JOURNAL);
    }

    /// Takes what the worker says.
    pub fn update(&mut self, update: Update) {
        match update {
            Update::Opening(what) => {
                self.connection = match &self.connection {
                    Connection::Lost { reason, attempts } => {
                        Connection::Lost { reason: reason.clone(), attempts: attempts.saturating_add(1) }
                    }
                    _ => Connection::Opening(what),
                };
            }
            Update::Opened(board, hello) => {
                self.note(Weight::Remark, format!("{board} answers, last start: {:?}", hello.reset_cause));
                self.board = board;
                self.hello = Some(hello);
                self.connection = Connection::Open;
            }
            Update::Lost(reason) => {
                if self.connection == Connection::Open {
                    self.note(Weight::Alarm, format!("link lost: {reason}"));
                }
                let attempts = match self.connection {
                    Connection::Lost { attempts, .. } => attempts,
                    _ => 0,
                };
                self.connection = Connection::Lost { reason, attempts };
                self.armed = false;
                self.upload = None;
            }
            Update::Status(status) => self.status = Some(status),
            Update::Event(event, traffic) => {
                self.traffic = traffic;
                self.event(event);
            }
            Update::Done(text) => self.note(Weight::Remark, text),
            Update::Refused(text) => self.note(Weight::Alarm, text),
            Update::SwitchedOff(why) => {
                self.armed = false;
                self.note(Weight::Alarm, why);
            }
            Update::Recording(path) => {
                let text = match (&path, &self.recording) {
                    (Some(path), _) => format!("recording to {}", path.display()),
                    (None, Some(path)) => format!("recorded {}", path.display()),
                    (None, None) => "no recording".into(),
                };
                self.note(Weight::Remark, text);
                self.recording = path;
            }
            Update::Upload(sent, length) => self.upload = (sent < length).then_some((sent, length)),
        }
    }

    fn event(&mut self, event: Event) {
        match event {
            Event::Telemetry(record) => {
                if !record.faults.is_empty() {
                    self.armed = false;
                }
                // A restarted board counts from one again: its traces begin anew.
                if self.records.back().is_some_and(|last| record.tick <= last.tick) {
                    self.records.clear();
                }
                if self.records.len() == SHOWN_TICKS {
                    self.records.pop_front();
                }
                self.records.push_back(record);
            }
            Event::Halves(halves) => {
                let names = self.names();
                if let Some(text) = self.curve.of(&halves, &names) {
                    self.note(Weight::Remark, text);
                }
            }
            Event::Estimate(estimate) => self.estimate = Some(estimate),
            Event::Verdict(verdict) => {
                self.note(Weight::Verdict, verdict_text(&verdict, &self.names()));
                // The estimate of a palpation comes right before its verdict.
                if self.estimate.as_ref().is_some_and(|e| e.palpation != verdict.palpation) {
                    self.estimate = None;
                }
                self.verdict = Some(verdict);
            }
            Event::Fault(fault) => self.note(Weight::Alarm, fault_text(&fault)),
            Event::Gap(gap) => {
                // A board that has restarted stands in idle: nobody has asked it for outputs.
                self.armed = false;
                self.note(Weight::Alarm, gap_text(&gap));
            }
        }
    }

    /// What the key asks the board to do. Off itself is asked for by the thread that reads the key ([`Key::is_off`]).
    pub fn key(&mut self, key: Key) -> Vec<Command> {
        match key {
            key if key.is_end() => {
                self.done = true;
                vec![Command::Stop]
            }
            key if key.is_off() => {
                self.armed = false;
                if self.connection != Connection::Open {
                    self.note(Weight::Alarm, "no link: the board switches off by itself after a second of silence");
                }
                vec![]
            }
            Key::Char('r') => vec![Command::Record(self.recording.is_none())],
            Key::Char('x') => {
                self.journal.clear();
                self.verdict = None;
                self.estimate = None;
                vec![]
            }
            Key::Char('+' | '=') => self.change_rate(RATES_MM_S.2),
            Key::Char('-') => self.change_rate(-RATES_MM_S.2),
            Key::Up => self.choose(self.material.saturating_sub(1)),
            Key::Down => self.choose(self.material.saturating_add(1)),
            Key::Char(digit @ '0'..='9') => self.choose(digit as u8 - b'0'),
            Key::Char('a' | 'p' | 'd' | 'b' | 'c' | 't' | 'u') if self.connection != Connection::Open => {
                self.note(Weight::Alarm, "no link to the board");
                vec![]
            }
            Key::Char('a') => self.arm(),
            Key::Char('p') => self.if_armed(Mode::Palpate { rate_mm_s: self.rate_mm_s, depth_mm: self.depth_mm }),
            Key::Char('d') => self.if_armed(Mode::Display { material: self.material }),
            // Again for the next press: the display stays on.
            Key::Char('b') => {
                self.command_if_armed(Command::Both { rate_mm_s: self.rate_mm_s, depth_mm: self.depth_mm })
            }
            Key::Char('c') => vec![Command::ClearFaults],
            Key::Char('t') => vec![Command::Tare],
            Key::Char('u') if self.library.is_none() => {
                self.note(Weight::Alarm, "no table to upload: start with --table FILE");
                vec![]
            }
            Key::Char('u') => vec![Command::Upload],
            Key::Char(_) | Key::Escape | Key::Interrupt => vec![],
        }
    }

    fn change_rate(&mut self, by_mm_s: f32) -> Vec<Command> {
        self.rate_mm_s = (self.rate_mm_s + by_mm_s).clamp(RATES_MM_S.0, RATES_MM_S.1);
        vec![]
    }

    /// A display that is on goes over to the new material.
    fn choose(&mut self, material: u8) -> Vec<Command> {
        let last = match &self.library {
            Some(library) if self.board_has(library) => library.names.len().saturating_sub(1) as u8,
            _ => u8::MAX,
        };
        let chosen = material.min(last);
        if chosen == self.material {
            return vec![];
        }
        self.material = chosen;
        let displaying = self.records.back().is_some_and(|t| t.state == State::Display);
        if self.armed && displaying { vec![Command::Mode(Mode::Display { material: chosen })] } else { vec![] }
    }

    fn arm(&mut self) -> Vec<Command> {
        let faults: Vec<&str> = self.faults().iter().map(Fault::code).collect();
        if faults.is_empty() {
            self.armed = !self.armed;
        } else {
            self.note(
                Weight::Alarm,
                format!("not armed: {} latched; c clears what has no cause any more", faults.join(", ")),
            );
        }
        vec![]
    }

    fn if_armed(&mut self, mode: Mode) -> Vec<Command> {
        self.command_if_armed(Command::Mode(mode))
    }

    fn command_if_armed(&mut self, command: Command) -> Vec<Command> {
        if self.armed {
            return vec![command];
        }
        self.note(Weight::Alarm, "not armed: press a first, then p, d or b; outputs go on with them");
        vec![]
    }
}
