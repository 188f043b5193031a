//! Pictures of the monitor at several sizes, as text: `PALPATE_BLESS=1 cargo test -p tests --test suite monitor_screens::` writes them anew.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use palpate::monitor::{Key, Library, Monitor, Palette, Update, draw};
use palpate::session::{Event, Traffic};
use protocol::fault::{Fault, FaultSet};
use protocol::message::*;
use ratatui::Terminal;
use ratatui::backend::TestBackend;
use ratatui::buffer::Buffer;
use ratatui::style::Color;
use tests::{golden, samples};

const PLAIN: Palette = Palette { colour: false };

fn picture(monitor: &Monitor, palette: Palette, width: u16, height: u16) -> Buffer {
    let mut terminal = Terminal::new(TestBackend::new(width, height)).unwrap();
    terminal.draw(|frame| draw(frame, monitor, palette)).unwrap();
    terminal.backend().buffer().clone()
}

/// The picture's lines, without the blanks at their ends.
fn text(buffer: &Buffer) -> String {
    let width = usize::from(buffer.area.width);
    buffer
        .content
        .chunks(width)
        .map(|row| row.iter().map(|cell| cell.symbol()).collect::<String>().trim_end().to_owned() + "\n")
        .collect()
}

fn hello() -> Hello {
    let Some(Report::Hello(hello)) = samples::reports().into_iter().next() else { panic!("the first report is Hello") };
    hello
}

fn opened() -> Monitor {
    let names = ["EVA", "B1", "ICF", "A2"].map(str::to_owned).to_vec();
    let mut monitor = Monitor::new("tcp:127.0.0.1:4750", Some(Library { hash: [7; 16], names }), 4.0);
    monitor.update(Update::Opened("tcp:127.0.0.1:4750".into(), hello()));
    let Some(Report::Status(status)) = samples::reports().into_iter().nth(1) else { panic!("the second is Status") };
    let status = Status { frames_dropped: 0, deadlines_missed: 0, table_hash: [7; 16], ..status };
    monitor.update(Update::Status(status));
    monitor
}

/// A record of a display that is pressed every four seconds, or of a board at rest.
fn record(tick: u32, state: State, faults: FaultSet) -> Telemetry {
    let t = f64::from(tick) / 50.0;
    let on = if state == State::Display { 1.0 } else { 0.0 };
    let press = (t * std::f64::consts::TAU / 4.0).sin().max(0.0);
    // The shaft follows a fifth of a second later.
    let late = ((t - 0.2) * std::f64::consts::TAU / 4.0).sin().max(0.0);
    Telemetry {
        tick,
        state,
        faults,
        probe_mm: 30.0,
        depth_mm: 0.0,
        load_cell_n: 0.002,
        fsr_n: (2.0 * press) as f32,
        shaft_mm: (on * 3.1 * late) as f32,
        shaft_target_mm: (on * 3.1 * press) as f32,
        actuator_v: (on * 3.0 * press) as f32,
        coil_a: (on * 1.2 * late) as f32,
        coil_target_a: (on * 1.2 * press) as f32,
        coil_duty: (on * 0.4 * press) as f32,
        coil_c: 41.0,
        search_error_n: 0.0,
        tick_us: 180 + (tick % 7) as u16 * 10,
        raw: Raw { load_cell: 6_600, fsr: 900, potentiometer: 41_000, probe_position: 20_000, coil_current: 3_300 },
        shown: Shown::default(),
    }
}

/// `before` ticks at rest, then `after` in `state`.
fn lived(monitor: &mut Monitor, before: u32, after: u32, state: State, faults: FaultSet) {
    for tick in 1..=before + after {
        let record =
            if tick <= before { record(tick, State::Idle, FaultSet::NONE) } else { record(tick, state, faults) };
        let traffic = Traffic { telemetry_received: u64::from(tick), ..Traffic::default() };
        monitor.update(Update::Event(Event::Telemetry(record), traffic));
    }
}

/// EVA has been palpated, and is displayed now; recorded, armed.
fn displaying() -> Monitor {
    let mut monitor = opened();
    let found = samples::reports().into_iter().rev();
    for report in found {
        match report {
            Report::Estimate(e) => monitor.update(Update::Event(Event::Estimate(e), Traffic::default())),
            Report::Verdict(v) => monitor.update(Update::Event(Event::Verdict(v), Traffic::default())),
            _ => {}
        }
    }
    monitor.update(Update::Recording(Some("out/recordings/recording-001.csv".into())));
    lived(&mut monitor, 100, 500, State::Display, FaultSet::NONE);
    monitor.key(Key::Char('a'));
    monitor
}

/// The host was silent while the display was on, and the load cell's wire is out.
fn faulted() -> Monitor {
    let mut monitor = displaying();
    let mut faults = FaultSet::NONE;
    faults.insert(Fault::LinkLost);
    faults.insert(Fault::LoadCellOpen);
    lived(&mut monitor, 650, 50, State::Fault, faults);
    for (fault, value, limit) in [(Fault::LinkLost, 51.0, 50.0), (Fault::LoadCellOpen, 0.0012, 0.0)] {
        let report = FaultReport { tick: 651, fault: fault as u8, value, limit };
        monitor.update(Update::Event(Event::Fault(report), Traffic::default()));
    }
    monitor
}

fn lost() -> Monitor {
    let mut monitor = displaying();
    monitor.update(Update::Lost("tcp:127.0.0.1:4750 closed the connection".into()));
    monitor.update(Update::Opening("opening".into()));
    monitor.update(Update::Lost("cannot open tcp:127.0.0.1:4750: Connection refused (os error 111)".into()));
    monitor
}

#[test]
fn pictures_are_as_blessed() {
    let scenes = [
        ("displaying", displaying()),
        ("faulted", faulted()),
        ("lost", lost()),
        ("opening", Monitor::new("sim", None, 4.0)),
    ];
    for (width, height) in [(80, 24), (120, 40)] {
        let mut all = String::new();
        for (name, monitor) in &scenes {
            all += &format!("== {name}\n{}", text(&picture(monitor, PLAIN, width, height)));
        }
        golden::compare(&format!("monitor-{width}x{height}.txt"), &all).unwrap();
    }
}

/// What a person must see is there at every size, whatever else is cut.
#[test]
fn state_verdict_faults_and_keys_are_there_at_every_size() {
    for (width, height) in [(80, 24), (100, 30), (120, 40), (200, 60), (80, 60), (300, 24)] {
        let shown = text(&picture(&displaying(), PLAIN, width, height));
        for words in [
            "ARMED",
            "displaying",
            "» EVA",
            "mu 0.2500 ±0.0156 MPa",
            "recording-001.csv",
            "load cell",
            "desired",
            "quit",
        ] {
            assert!(shown.contains(words), "{width} x {height}: no `{words}` in\n{shown}");
        }
        let shown = text(&picture(&faulted(), PLAIN, width, height));
        for words in [
            "FAULT, outputs off",
            "2 faults latched",
            Fault::LinkLost.describe(),
            Fault::LoadCellOpen.describe(),
            " safe",
        ] {
            assert!(shown.contains(words), "{width} x {height}: no `{words}` in\n{shown}");
        }
        let shown = text(&picture(&lost(), PLAIN, width, height));
        assert!(shown.contains("NO LINK, attempt 2") && shown.contains("Connection refused"), "{shown}");
    }
}

#[test]
fn a_terminal_that_is_too_small_says_what_is_needed() {
    let shown = text(&picture(&displaying(), PLAIN, 60, 10));
    assert!(shown.contains("60 x 10 characters; the monitor needs 80 x 24"), "{shown}");
    // And none is too small to draw at all.
    for (width, height) in [(1, 1), (79, 24), (80, 23), (3, 50)] {
        picture(&displaying(), PLAIN, width, height);
    }
}

#[test]
fn without_colour_nothing_is_coloured_and_the_text_is_the_same() {
    for monitor in [displaying(), faulted(), lost()] {
        let (plain, coloured) =
            (picture(&monitor, PLAIN, 120, 40), picture(&monitor, Palette { colour: true }, 120, 40));
        assert!(plain.content.iter().all(|cell| cell.fg == Color::Reset && cell.bg == Color::Reset));
        assert!(coloured.content.iter().any(|cell| cell.fg != Color::Reset));
        assert_eq!(text(&plain), text(&coloured));
    }
}

/// Numbers that are none, and numbers that are huge, do not break the picture.
#[test]
fn any_telemetry_can_be_drawn() {
    let mut monitor = opened();
    for (tick, x) in [f32::NAN, f32::INFINITY, -f32::INFINITY, 3e38, -3e38, 1e-40].into_iter().enumerate() {
        let record = Telemetry {
            load_cell_n: x,
            shaft_mm: x,
            coil_a: x,
            coil_c: x,
            depth_mm: x,
            ..record(tick as u32 + 1, State::Idle, FaultSet(u32::MAX))
        };
        monitor.update(Update::Event(Event::Telemetry(record), Traffic::default()));
        picture(&monitor, PLAIN, 80, 24);
    }
}
