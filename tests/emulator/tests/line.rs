//! The 115200 baud of the real image's UART: what fits, and what is left out when more is asked for.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use emulator::board::{BANK_2, EmulatedBoard};
use emulator::link::EmulatedUart;
use palpate::link::{BAUD, Link, LinkError};
use palpate::plant::Touch;
use palpate::session::{Event, Patience, Session};
use protocol::frame::{Decoder, LossCounter, MAX_FRAME, encode_request};
use protocol::message::{Empty, Mode, Report, Request, Status};

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

/// A host that asks 140 times a second fills two thirds of the line: every request is answered, no record is lost, and control goes on as if nothing were.
#[test]
fn a_host_that_fills_two_thirds_of_the_line_loses_nothing_and_control_goes_on() {
    const ASKED: u32 = 1120;
    const EVERY_MS: u32 = 7;
    let mut board = common::board();
    board.run_to_tick(5.0).unwrap();
    let (mut decoder, mut loss) = (Decoder::new(), LossCounter::default());
    let (mut bytes, mut records, mut answers, mut last) = (0, 0, 0, None::<Status>);
    let mut hear = |board: &mut EmulatedBoard| {
        for byte in board.take_transmit() {
            bytes += 1;
            if let Some(frame) = decoder.push(byte) {
                let frame = frame.expect("no frame is damaged on a clean line");
                loss.see(frame.seq);
                match Report::decode(frame.kind, frame.body).unwrap() {
                    Report::Telemetry(_) => records += 1,
                    Report::Status(status) => {
                        answers += 1;
                        last = Some(status);
                    }
                    other => panic!("{other:?}"),
                }
            }
        }
        (bytes, loss, records, answers, last.clone())
    };
    let mut out = [0; MAX_FRAME];
    let telemetry = protocol::message::TelemetryRate { divider: 1 };
    board.receive(encode_request(&Request::SetTelemetry(telemetry), 0, &mut out).unwrap());
    board.run_s(0.1).unwrap();
    // Its answer, and what came with it.
    board.take_transmit();
    let (begun, begun_s) = (board.ticks(), board.time_s());
    for seq in 0..ASKED {
        board.receive(encode_request(&Request::Status(Empty {}), seq as u16, &mut out).unwrap());
        for _ in 0..EVERY_MS {
            board.step().unwrap();
            hear(&mut board);
        }
    }
    let (ticks, seconds) = (board.ticks() - begun, board.time_s() - begun_s);
    let used = hear(&mut board).0 as f64 / seconds / LINE_BYTES_PER_S;
    board.run_s(0.5).unwrap();
    let (_, loss, records, answers, last) = hear(&mut board);
    let last = last.unwrap();
    println!(
        "{ASKED} requests in {seconds:.1} s: {answers} answers, {records} records, {:.0} % of the line",
        100.0 * used
    );
    assert!(used > 0.6, "{used}");
    assert_eq!(
        (answers, loss.lost, last.frames_dropped, last.frames_rejected, last.deadlines_missed),
        (ASKED, 0, 0, 0, 0)
    );
    // 50 a second, one more or less by the phase of the first.
    assert!((seconds * 50.0 - ticks as f64).abs() <= 1.0, "{ticks} ticks in {seconds} s");
}
