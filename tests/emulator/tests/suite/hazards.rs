//! Hangs, silence and overflows of the real image: outputs off in time, and the cause is told after the reset.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use emulator::board::{BANK_2, EmulatedBoard, LSI_HZ, LSI_RANGE_HZ, Task};
use emulator::chip::Reset;
use emulator::core::Deed;
use emulator::link::EmulatedUart;
use palpate::plant::{Jitter, Touch};
use palpate::session::{Event, Patience, Session};
use protocol::fault::Fault;
use protocol::frame::{self, MAX_FRAME};
use protocol::message::{Empty, Mode, Refusal, Request, ResetCause};

use crate::common;

/// A task is taken for dead after 0.1 s, and its last permit lasts 0.04 s.
const OFF_WITHIN_S: f64 = 0.15;

/// A board that displays the stiffest foam to a pressing finger: coil and actuator are on.
fn displaying(lsi_hz: u64) -> EmulatedBoard {
    let mut board = EmulatedBoard::new(common::image(), 1, Jitter::NONE, lsi_hz).unwrap();
    board.core().set_flash(BANK_2, common::table()).unwrap();
    let (mut session, _) = Session::open(EmulatedUart::new(&mut board), Patience::default()).unwrap();
    session.set_mode(Mode::Display { material: 0 }).unwrap();
    session.link_mut().board().touch(Some(Touch { peak_n: 3.0, period_s: 3.0 }));
    let until_s = session.link_mut().board().time_s() + 1.5;
    let mut faults = vec![];
    while let Some(event) = session.poll(until_s).unwrap() {
        if let Event::Fault(fault) = event {
            faults.push(fault);
        }
    }
    drop(session);
    let pins = board.pins();
    assert!(pins.coil > 0.1 && pins.forward + pins.reverse > 0.01, "{pins:?}, {faults:?}");
    board
}

/// Seconds until every output is off and stays off for 100 ms, while a host goes on talking.
fn off_after_s(board: &mut EmulatedBoard) -> f64 {
    let mut buffer = [0; MAX_FRAME];
    let status = frame::encode_request(&Request::Status(Empty {}), 0, &mut buffer).unwrap();
    let began_s = board.time_s();
    let mut on_until_s = began_s;
    for ms in 0..1500 {
        if ms % 100 == 0 {
            board.receive(status);
        }
        board.step().unwrap();
        if !board.pins().off() {
            on_until_s = board.time_s();
        }
    }
    on_until_s - began_s
}

/// What the board says about its last reset.
fn told(board: EmulatedBoard) -> (ResetCause, bool) {
    let (mut session, hello) =
        Session::open(EmulatedUart::new(board), Patience { attempts: 20, ..Patience::default() }).unwrap();
    (hello.reset_cause, session.status().unwrap().faults.contains(Fault::WatchdogReset))
}

/// Injects, and checks off, reset and report; at the chip's slowest, typical and fastest watchdog clock.
fn check(name: &str, inject: impl Fn(&mut EmulatedBoard)) {
    for lsi_hz in [LSI_RANGE_HZ.0, LSI_HZ, LSI_RANGE_HZ.1] {
        let mut board = displaying(lsi_hz);
        inject(&mut board);
        let injected_s = board.time_s();
        let off_s = off_after_s(&mut board);
        let resets: Vec<_> = board.resets().into_iter().filter(|(at, _)| *at > injected_s).collect();
        let reset_s = resets.first().map(|(at, _)| at - injected_s);
        println!("{name}, watchdog clock {lsi_hz} Hz: off after {:.0} ms, reset after {reset_s:?} s", off_s * 1e3);
        assert!(off_s <= OFF_WITHIN_S, "{name}, {lsi_hz} Hz: outputs were on for {off_s} s");
        assert_eq!(resets.first().map(|r| r.1), Some(Reset::Watchdog), "{name}, {lsi_hz} Hz");
        // What hung once works after the reset.
        board.core().set_trap(None).unwrap();
        assert_eq!(told(board), (ResetCause::Watchdog, true), "{name}, {lsi_hz} Hz");
    }
}

fn hang(task: Task, deed: Deed) -> impl Fn(&mut EmulatedBoard) {
    move |board| assert!(board.inject(task, deed).unwrap(), "the image has no {task:?}")
}

#[test]
fn a_hang_of_the_control_task() {
    check("control hangs", hang(Task::Control, Deed::Hang));
    check("control hangs, interrupts masked", hang(Task::Control, Deed::HangMasked));
}

#[test]
fn a_hang_of_the_sampling_task() {
    check("sampling hangs", hang(Task::Sampling, Deed::Hang));
    check("sampling never comes", hang(Task::Sampling, Deed::Skip));
}

#[test]
fn a_hang_of_a_link_task() {
    check("UART task hangs", hang(Task::UartReceive, Deed::Hang));
    check("UART task never comes", hang(Task::UartReceive, Deed::Skip));
    check("USB task never comes", hang(Task::UsbReceive, Deed::Skip));
}

/// A converter that stops is a latched fault and no reset: a reset would not mend it, and nobody would be told.
#[test]
fn a_silent_converter() {
    for lsi_hz in [LSI_RANGE_HZ.0, LSI_HZ, LSI_RANGE_HZ.1] {
        let mut board = displaying(lsi_hz);
        let resets = board.resets().len();
        board.set_adc_dead(true);
        let off_s = off_after_s(&mut board);
        println!("converter is silent, watchdog clock {lsi_hz} Hz: off after {:.0} ms", off_s * 1e3);
        assert!(off_s <= OFF_WITHIN_S, "{lsi_hz} Hz: outputs were on for {off_s} s");
        let (mut session, _) = Session::open(EmulatedUart::new(&mut board), Patience::default()).unwrap();
        let status = session.status().unwrap();
        assert!(
            status.faults.contains(Fault::SensorStale) && !status.faults.contains(Fault::WatchdogReset),
            "{status:?}"
        );
        let refusal = session.clear_faults().unwrap_err().to_string();
        assert!(refusal.contains(Refusal::CauseRemains.describe()), "{refusal}");
        assert!(session.set_mode(Mode::Display { material: 0 }).is_err());
        // The converter comes back, is found running, and everything works again.
        session.link_mut().board().set_adc_dead(false);
        let until_s = session.link_mut().board().time_s() + 0.5;
        while session.poll(until_s).unwrap().is_some() {}
        session.clear_faults().unwrap();
        // The next tick leaves the state of faults.
        let until_s = session.link_mut().board().time_s() + 0.1;
        while session.poll(until_s).unwrap().is_some() {}
        session.set_mode(Mode::Display { material: 0 }).unwrap();
        drop(session);
        assert_eq!(board.resets().len(), resets, "{lsi_hz} Hz");
    }
}

/// The same from the start: the board comes up, stays up, and says what is wrong.
#[test]
fn a_converter_that_is_dead_at_the_start() {
    let mut board = common::board();
    board.set_adc_dead(true);
    board.power_cycle(Reset::Power).unwrap();
    let resets = board.resets().len();
    let (mut session, hello) = Session::open(EmulatedUart::new(&mut board), Patience::default()).unwrap();
    assert_eq!(hello.reset_cause, ResetCause::PowerOn);
    let until_s = session.link_mut().board().time_s() + 5.0;
    while session.poll(until_s).unwrap().is_some() {}
    let status = session.status().unwrap();
    assert!(status.faults.contains(Fault::SensorStale) && status.uptime_ms > 4000, "{status:?}");
    drop(session);
    assert!(board.pins().off());
    assert_eq!(board.resets().len(), resets);
}

#[test]
fn a_stack_that_overflows() {
    check("stack overflows in control", hang(Task::Control, Deed::StackLeft(64)));
    check("stack overflows in sampling", hang(Task::Sampling, Deed::StackLeft(64)));
}
