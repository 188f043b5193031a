//! The image starts, answers over its UART, in virtual time and over TCP, and does the same every time.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;

use emulator::link::EmulatedUart;
use emulator::server::Server;
use palpate::link::{Disturbance, Disturbed, Link, Tcp};
use palpate::session::{Event, Patience, Session};
use protocol::lut::Table;
use protocol::message::{ResetCause, State};

use crate::common;

#[test]
fn the_image_answers_hello_and_sends_a_record_every_tick() {
    let (mut session, hello) = Session::open(EmulatedUart::new(common::board()), Patience::default()).unwrap();
    assert!(!hello.simulated);
    assert_eq!((hello.reset_cause, &hello.unique_id), (ResetCause::PowerOn, b"palpate-emu\0"));
    let until_s = session.link().now_s() + 10.0;
    let mut ticks = Vec::new();
    while let Some(event) = session.poll(until_s).unwrap() {
        if let Event::Telemetry(t) = event {
            ticks.push(t.tick);
            assert_eq!(t.state, State::Idle);
        }
    }
    // 10 s at 50 Hz; one more or less by the phase of the first.
    assert!((499..=501).contains(&ticks.len()), "{}", ticks.len());
    assert!(ticks.windows(2).all(|w| w[1] == w[0] + 1));
    let traffic = session.traffic();
    assert_eq!((traffic.frames_lost, traffic.telemetry_lost, traffic.frames_damaged), (0, 0, 0));
}

#[test]
fn two_runs_are_the_same_to_the_bit_and_to_the_instruction() {
    let run = || {
        let mut board = common::board();
        board.run_s(0.5).unwrap();
        let bytes = board.take_transmit();
        (bytes, board.core().instructions(), board.flash().unwrap())
    };
    assert!(run() == run());
}

#[test]
fn a_table_gets_through_a_noisy_line_and_survives_a_power_cycle() {
    let table = common::small_table(&"a sentence that makes the table longer than a few pieces; ".repeat(40));
    let line = Disturbed::new(EmulatedUart::new(common::board()), Disturbance::default(), 7);
    let (mut session, _) = Session::open(line, Patience::default()).unwrap();
    // One byte in a thousand is damaged or lost: of a piece with 210 bytes and its answer a fifth fail.
    session.link_mut().set_disturbance(Disturbance { flip: 5e-4, lose: 5e-4, ..Disturbance::default() });
    session.upload(&table, |_| {}).unwrap();
    session.link_mut().set_disturbance(Disturbance::default());
    let hash = Table::parse(&table).unwrap().hash();
    assert_eq!(session.status().unwrap().table_hash, hash);
    let traffic = session.traffic();
    assert!(traffic.frames_damaged + traffic.requests_repeated > 0, "{traffic:?}");
    session.link_mut().inner_mut().board().power_cycle(emulator::chip::Reset::BrownOut).unwrap();
    let status = loop {
        if let Ok(status) = session.status() {
            break status;
        }
    };
    assert_eq!(status.table_hash, hash);
    assert!(status.uptime_ms < 2000, "{status:?}");
}

#[test]
fn over_tcp_the_same_image_answers_in_real_time() {
    let (told, hears) = std::sync::mpsc::channel();
    let stop = Arc::new(AtomicBool::new(false));
    let stopped = Arc::clone(&stop);
    // The CPU emulator stays in the thread it was made in.
    let running = thread::spawn(move || {
        let server = Server::listen("127.0.0.1:0", common::board()).unwrap();
        told.send(server.address()).unwrap();
        server.run(|| !stopped.load(Ordering::Relaxed)).unwrap();
    });
    let address = hears.recv().unwrap();
    let patience = Patience { answer_s: 2.0, ..Patience::default() };
    let (mut session, hello) = Session::open(Tcp::open(&address.to_string()).unwrap(), patience).unwrap();
    assert!(!hello.simulated);
    let until_s = session.link().now_s() + 2.0;
    let mut records = 0;
    while let Some(event) = session.poll(until_s).unwrap() {
        records += u32::from(matches!(event, Event::Telemetry(_)));
    }
    // Two seconds at 50 Hz; half of it if the machine is busy with other things.
    assert!(records >= 50, "{records} records in two seconds");
    stop.store(true, Ordering::Relaxed);
    running.join().unwrap();
}
