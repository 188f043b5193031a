#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
use super::*;
use crate::session::{Event, Traffic};
use protocol::fault::{Fault, FaultSet};
use protocol::message::{
    Build, CalibrationState, FaultReport, Fitted, Hello, Holder, Mode, Raw, ResetCause, Shown, State, Status, Telemetry,
};

fn record(tick: u32, state: State, faults: &[Fault]) -> Telemetry {
    let mut set = FaultSet::NONE;
    faults.iter().for_each(|fault| set.insert(*fault));
    Telemetry {
        tick,
        state,
        faults: set,
        probe_mm: 30.0,
        depth_mm: 0.0,
        load_cell_n: 0.0,
        fsr_n: 0.0,
        shaft_mm: 0.0,
        shaft_target_mm: 0.0,
        actuator_v: 0.0,
        coil_a: 0.0,
        coil_target_a: 0.0,
        coil_duty: 0.0,
        coil_c: 80.0,
        search_error_n: 0.0,
        tick_us: 400,
        raw: Raw { load_cell: 0, fsr: 0, potentiometer: 0, probe_position: 0, coil_current: 0 },
        shown: Shown::default(),
    }
}

fn hello() -> Hello {
    Hello {
        protocol_version: protocol::PROTOCOL_VERSION,
        schema_hash: protocol::message::SCHEMA_HASH,
        firmware_version: [0, 1, 0],
        build: Build::UNKNOWN,
        unique_id: [0; 12],
        simulated: true,
        slot_len: 0,
        reset_cause: ResetCause::PowerOn,
    }
}

fn status(table_hash: [u8; 16]) -> Status {
    Status {
        uptime_ms: 0,
        mode: Mode::Idle,
        state: State::Idle,
        faults: FaultSet::NONE,
        frames_rejected: 0,
        frames_dropped: 0,
        deadlines_missed: 0,
        tick_max_us: 0,
        ticks_late: 0,
        period_max_us: 0,
        holder: Holder::Nobody,
        table_hash,
        calibration: CalibrationState::Stored,
        fitted: Fitted { palpator: true, actuator: true, coil: true },
    }
}

fn hear(monitor: &mut Monitor, event: Event) {
    monitor.update(Update::Event(event, Traffic::default()));
}

/// A dashboard whose board answers, idle, with the host's table of two materials.
fn open() -> Monitor {
    let library = Library { hash: [7; 16], names: vec!["EVA".into(), "B1".into()] };
    let mut monitor = Monitor::new("sim", Some(library), 4.0);
    monitor.update(Update::Opened("the board".into(), hello()));
    monitor.update(Update::Status(status([7; 16])));
    hear(&mut monitor, Event::Telemetry(record(1, State::Idle, &[])));
    monitor
}

#[test]
fn outputs_go_on_only_after_arming_and_arming_ends_with_every_off() {
    let mut monitor = open();
    assert_eq!(monitor.key(Key::Char('p')), []);
    assert_eq!(monitor.newest(), Some("not armed: press a first, then p, d or b; outputs go on with them"));
    assert_eq!(monitor.key(Key::Char('a')), []);
    assert!(monitor.is_armed());
    assert_eq!(monitor.key(Key::Char('p')), [Command::Mode(Mode::Palpate { rate_mm_s: 2.0, depth_mm: 4.0 })]);
    assert_eq!(monitor.key(Key::Char('d')), [Command::Mode(Mode::Display { material: 0 })]);
    for off in [' ', 'o'] {
        monitor.armed = true;
        assert!(Key::Char(off).is_off() && monitor.key(Key::Char(off)).is_empty());
        assert!(!monitor.is_armed());
    }
    monitor.armed = true;
    monitor.update(Update::SwitchedOff("outputs off: nobody watches".into()));
    assert_eq!((monitor.is_armed(), monitor.newest()), (false, Some("outputs off: nobody watches")));
}

#[test]
fn a_fault_disarms_and_must_be_cleared_before_arming() {
    let mut monitor = open();
    monitor.key(Key::Char('a'));
    let report = FaultReport { tick: 2, fault: Fault::LinkLost as u8, value: 51.0, limit: 50.0 };
    hear(&mut monitor, Event::Fault(report));
    assert!(monitor.newest().unwrap().contains("link to the host lost"));
    hear(&mut monitor, Event::Telemetry(record(2, State::Fault, &[Fault::LinkLost])));
    assert!(!monitor.is_armed() && monitor.faults().contains(Fault::LinkLost));
    monitor.key(Key::Char('a'));
    assert!(!monitor.is_armed());
    assert_eq!(monitor.newest(), Some("not armed: link-lost latched; c clears what has no cause any more"));
    assert_eq!(monitor.key(Key::Char('c')), [Command::ClearFaults]);
    hear(&mut monitor, Event::Telemetry(record(3, State::Idle, &[])));
    monitor.key(Key::Char('a'));
    assert!(monitor.is_armed());
}

#[test]
fn a_lost_link_disarms_counts_its_attempts_and_takes_no_commands() {
    let mut monitor = open();
    monitor.key(Key::Char('a'));
    monitor.update(Update::Lost("tcp:a:1 closed the connection".into()));
    assert!(!monitor.is_armed());
    assert_eq!(monitor.newest(), Some("link lost: tcp:a:1 closed the connection"));
    for key in "apdctu".chars() {
        assert_eq!(monitor.key(Key::Char(key)), [], "{key}");
        assert!(!monitor.is_armed());
    }
    // Off can do nothing either, but says who does.
    assert_eq!(monitor.key(Key::Char(' ')), []);
    assert!(monitor.newest().unwrap().contains("by itself"));
    monitor.update(Update::Opening("opening".into()));
    monitor.update(Update::Lost("refused".into()));
    assert_eq!(*monitor.connection(), Connection::Lost { reason: "refused".into(), attempts: 1 });
    monitor.update(Update::Opened("the board".into(), hello()));
    assert_eq!(*monitor.connection(), Connection::Open);
}

#[test]
fn materials_are_chosen_within_the_library_and_a_display_follows() {
    let mut monitor = open();
    assert_eq!(monitor.name_of(monitor.material), Some("EVA"));
    assert_eq!(monitor.key(Key::Down), []);
    assert_eq!(monitor.key(Key::Down), []);
    assert_eq!((monitor.material, monitor.name_of(1)), (1, Some("B1")));
    monitor.armed = true;
    hear(&mut monitor, Event::Telemetry(record(2, State::Display, &[])));
    assert_eq!(monitor.key(Key::Char('0')), [Command::Mode(Mode::Display { material: 0 })]);
    // The same again is nothing new.
    assert_eq!(monitor.key(Key::Up), []);
    // Another table on the board: its materials have no names here, and any number may be meant.
    monitor.update(Update::Status(status([9; 16])));
    assert!(monitor.other_table() && monitor.name_of(0).is_none());
    monitor.armed = false;
    monitor.key(Key::Char('9'));
    assert_eq!(monitor.material, 9);
}

#[test]
fn rates_stay_within_what_the_board_allows() {
    let mut monitor = open();
    for _ in 0..10 {
        monitor.key(Key::Char('+'));
    }
    assert_eq!(monitor.rate_mm_s, 4.0);
    for _ in 0..10 {
        monitor.key(Key::Char('-'));
    }
    assert_eq!(monitor.rate_mm_s, 1.0);
}

#[test]
fn recording_is_switched_by_one_key_and_named() {
    let mut monitor = open();
    assert_eq!(monitor.key(Key::Char('r')), [Command::Record(true)]);
    monitor.update(Update::Recording(Some("out/recording-001.csv".into())));
    assert_eq!(monitor.newest(), Some("recording to out/recording-001.csv"));
    assert_eq!(monitor.key(Key::Char('r')), [Command::Record(false)]);
    monitor.update(Update::Recording(None));
    assert_eq!(monitor.newest(), Some("recorded out/recording-001.csv"));
}

#[test]
fn traces_hold_ten_seconds_and_begin_anew_with_a_restarted_board() {
    let mut monitor = open();
    for tick in 2..2000 {
        hear(&mut monitor, Event::Telemetry(record(tick, State::Idle, &[])));
    }
    assert_eq!(monitor.records.len(), SHOWN_TICKS);
    hear(&mut monitor, Event::Telemetry(record(1, State::Idle, &[])));
    assert_eq!(monitor.records.len(), 1);
}

#[test]
fn every_way_out_stops_the_worker() {
    for key in [Key::Char('q'), Key::Escape, Key::Interrupt] {
        let mut monitor = open();
        assert!(key.is_end());
        assert_eq!(monitor.key(key), [Command::Stop]);
        assert!(monitor.is_done());
    }
}

#[test]
fn without_a_table_there_is_nothing_to_upload() {
    let mut monitor = Monitor::new("sim", None, 4.0);
    monitor.update(Update::Opened("the board".into(), hello()));
    assert_eq!(monitor.key(Key::Char('u')), []);
    assert_eq!(monitor.newest(), Some("no table to upload: start with --table FILE"));
    assert_eq!(open().key(Key::Char('u')), [Command::Upload]);
}
