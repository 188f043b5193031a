//! The 115200 baud of the real image's UART: what fits, and what is left out when more is asked for.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use emulator::board::{BANK_2, EmulatedBoard};
use emulator::link::EmulatedUart;
use palpate::link::{BAUD, Link, LinkError};
use palpate::plant::Touch;
use palpate::session::{Event, Patience, Session};
use protocol::frame::{Decoder, LossCounter, MAX_FRAME, encode_request};
use protocol::message::{Empty, Mode, Report, Request, Status};

use crate::common;

/// Bytes a second that the line can carry: 8N1 is ten bits a byte.
const LINE_BYTES_PER_S: f64 = BAUD as f64 / 10.0;

/// A link that counts what comes.
struct Counted {
    inner: EmulatedUart<EmulatedBoard>,
    bytes: usize,
}

impl Link for Counted {
    fn name(&self) -> &str {
        self.inner.name()
    }
    fn now_s(&self) -> f64 {
        self.inner.now_s()
    }
    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        self.inner.send(bytes)
    }
    fn receive(&mut self, into: &mut Vec<u8>, deadline_s: f64) -> Result<(), LinkError> {
        let before = into.len();
        self.inner.receive(into, deadline_s)?;
        self.bytes += into.len() - before;
        Ok(())
    }
}

/// A display under a pressing finger, where no number of a record is zero: ten seconds of it, with a status five times a second.
#[test]
fn telemetry_at_50_hz_is_a_third_of_the_line_and_loses_nothing() {
    let mut board = common::board();
    board.core().set_flash(BANK_2, common::table()).unwrap();
    let (mut session, _) =
        Session::open(Counted { inner: EmulatedUart::new(board), bytes: 0 }, Patience::default()).unwrap();
    session.set_mode(Mode::Display { material: 0 }).unwrap();
    session.link_mut().inner.board().touch(Some(Touch { peak_n: 3.0, period_s: 3.0 }));
    session.link_mut().bytes = 0;
    let until_s = session.link().now_s() + 10.0;
    let mut records = 0;
    while let Some(event) = session.poll(until_s).unwrap() {
        records += u32::from(matches!(event, Event::Telemetry(_)));
    }
    let used = session.link().bytes as f64 / 10.0 / LINE_BYTES_PER_S;
    println!("{records} records in 10 s, {:.0} % of the line", 100.0 * used);
    assert!((499..=501).contains(&records), "{records}");
    let (traffic, status) = (session.traffic(), session.status().unwrap());
    assert_eq!(
        (traffic.telemetry_lost, traffic.frames_lost, traffic.frames_damaged, status.frames_dropped),
        (0, 0, 0, 0)
    );
    assert!(used < 0.5, "{used}");
}

/// A board and what is heard of it on a clean line.
struct Line {
    board: EmulatedBoard,
    decoder: Decoder,
    loss: LossCounter,
    bytes: usize,
    records: u32,
    answers: u32,
    last: Option<Status>,
}

impl Line {
    /// A board that sends a record each tick.
    fn open() -> Self {
        let mut board = common::board();
        board.run_to_tick(5.0).unwrap();
        let telemetry = protocol::message::TelemetryRate { divider: 1 };
        let mut out = [0; MAX_FRAME];
        board.receive(encode_request(&Request::SetTelemetry(telemetry), 0, &mut out).unwrap());
        board.run_s(0.1).unwrap();
        // Its answer, and what came with it.
        board.take_transmit();
        let (decoder, loss) = (Decoder::new(), LossCounter::default());
        Line { board, decoder, loss, bytes: 0, records: 0, answers: 0, last: None }
    }

    /// Asks for the status so many times, a request every so many ms, and hears what comes.
    fn ask(&mut self, requests: u32, every_ms: u32) {
        let mut out = [0; MAX_FRAME];
        for seq in 0..requests {
            self.board.receive(encode_request(&Request::Status(Empty {}), seq as u16, &mut out).unwrap());
            self.wait(every_ms);
        }
    }

    fn wait(&mut self, ms: u32) {
        for _ in 0..ms {
            self.board.step().unwrap();
            self.hear();
        }
    }

    fn hear(&mut self) {
        for byte in self.board.take_transmit() {
            self.bytes += 1;
            if let Some(frame) = self.decoder.push(byte) {
                let frame = frame.expect("no frame is damaged on a clean line");
                self.loss.see(frame.seq);
                match Report::decode(frame.kind, frame.body).unwrap() {
                    Report::Telemetry(_) => self.records += 1,
                    Report::Status(status) => {
                        self.answers += 1;
                        self.last = Some(status);
                    }
                    other => panic!("{other:?}"),
                }
            }
        }
    }
}

/// A host that asks 140 times a second fills two thirds of the line: every request is answered, no record is lost, and control goes on as if nothing were.
#[test]
fn a_host_that_fills_two_thirds_of_the_line_loses_nothing_and_control_goes_on() {
    const ASKED: u32 = 1120;
    let mut line = Line::open();
    let (begun, begun_s) = (line.board.ticks(), line.board.time_s());
    line.ask(ASKED, 7);
    let (ticks, seconds) = (line.board.ticks() - begun, line.board.time_s() - begun_s);
    let used = line.bytes as f64 / seconds / LINE_BYTES_PER_S;
    line.wait(500);
    let last = line.last.clone().unwrap();
    println!(
        "{ASKED} requests in {seconds:.1} s: {} answers, {} records, {:.0} % of the line",
        line.answers,
        line.records,
        100.0 * used
    );
    assert!(used > 0.6, "{used}");
    assert_eq!(
        (line.answers, line.loss.lost, last.frames_dropped, last.frames_rejected, last.deadlines_missed),
        (ASKED, 0, 0, 0, 0)
    );
    // 50 a second, one more or less by the phase of the first.
    assert!((seconds * 50.0 - ticks as f64).abs() <= 1.0, "{ticks} ticks in {seconds} s");
}

/// A host that asks for more than the line can carry: the line is full, what is left out is counted on both sides, control goes on, and when it asks no more nothing
/// is lost any more.
#[test]
fn a_line_that_is_asked_for_too_much_is_full_and_says_what_it_leaves_out() {
    let mut line = Line::open();
    let (begun, begun_s) = (line.board.ticks(), line.board.time_s());
    line.ask(2000, 3);
    let (ticks, seconds) = (line.board.ticks() - begun, line.board.time_s() - begun_s);
    let used = line.bytes as f64 / seconds / LINE_BYTES_PER_S;
    println!("{} answers, {} records in {seconds:.1} s, {:.0} % of the line", line.answers, line.records, 100.0 * used);
    assert!(used > 0.9, "{used}");
    assert!((seconds * 50.0 - ticks as f64).abs() <= 1.0, "{ticks} ticks in {seconds} s");
    line.wait(1000);
    line.ask(1, 100);
    let last = line.last.clone().unwrap();
    assert!(line.loss.lost > 0);
    assert_eq!((u64::from(last.frames_dropped), last.deadlines_missed), (line.loss.lost, 0));
    let (records, lost) = (line.records, line.loss.lost);
    line.wait(2000);
    assert_eq!((line.records - records, line.loss.lost), (100, lost));
}
