//! The same scripted session on the in-process board and on the emulated real image.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use firmware::coil::winding::CoilCircuit;
use palpate::plant::{Broken, Input, Jitter, Touch};
use palpate::simulated_board::{SimulatedBoard, Timing};
use protocol::PROTOCOL_VERSION;
use protocol::fault::Fault;
use protocol::lut::Table;
use protocol::message::{
    DisplayMode, DisplayState, Empty, Halves, HelloRequest, Mode, PalpationMode, Parts, Request, Rule, SCHEMA_HASH,
    State, Telemetry, Verdict,
};

use crate::common;
use crate::script::{self, Act, Heard, Script};

/// What the hand does at the display.
const TOUCH: Touch = Touch { peak_n: 3.0, period_s: 3.0 };

/// The display follows a shaft of so many mm at most.
const STROKE_MM: f32 = 4.5;

/// Five sensors that break while the display is on, and the faults that each must give: the mean of the tick in which the potentiometer breaks lies
/// beyond the stroke, before a whole tick lies at the rail.
const BROKEN: [(Input, Broken, &[Fault]); 5] = [
    (Input::LoadCell, Broken::Low, &[Fault::LoadCellOpen]),
    (Input::Potentiometer, Broken::High, &[Fault::StrokeLimit, Fault::PotentiometerOpen]),
    (Input::Fsr, Broken::High, &[Fault::FsrShort]),
    (Input::ProbePosition, Broken::Low, &[Fault::ProbePositionOpen]),
    (Input::CoilCurrent, Broken::High, &[Fault::CurrentLimit]),
];

/// A session's beginning: greeting and upload.
fn begun(table: &[u8]) -> Script {
    let mut script = Script::default();
    script.wait(10);
    script.send(Request::Hello(HelloRequest { protocol_version: PROTOCOL_VERSION, schema_hash: SCHEMA_HASH }));
    script.wait(10);
    // Four sectors of 16 KiB, one of 64 and one of 128 take at most 2.6 s.
    script.upload(table, 200);
    script
}

fn session(table: &[u8], shown: u8) -> Script {
    let mut script = begun(table);
    for foam in common::foams() {
        script.act(Act::Place(foam.clone()));
        script.wait(5);
        script.send(script::set_mode(Mode::Palpate { rate_mm_s: 4.0, depth_mm: 4.0 }));
        script.keep_alive(300);
    }
    let display = script::set_mode(Mode::Display { material: shown });
    script.send(display.clone());
    script.keep_alive(40);
    script.act(Act::Touch(Some(TOUCH)));
    script.keep_alive(300);
    for (input, broken, _) in BROKEN {
        script.act(Act::Break(input, Some(broken)));
        script.keep_alive(20);
        script.act(Act::Break(input, None));
        script.wait(5);
        script.send(Request::ClearFaults(Empty {}));
        script.wait(5);
        script.send(display.clone());
        script.keep_alive(40);
    }
    // The host falls silent for more than a second.
    script.wait(80);
    script
}

/// Palpation and display at once: what is identified is displayed under a finger, the foams one after another; then another
/// curve in the middle of a press, and every broken sensor and a silent host with both on.
fn both_halves(table: &[u8], other: u8) -> Script {
    let press = || script::set_palpation(PalpationMode::Press { rate_mm_s: 4.0, depth_mm: 4.0, surface_mm: None });
    let follow = || script::set_display(DisplayMode::Follow { parts: Parts::Both, by: Rule::Between });
    let mut script = begun(table);
    script.act(Act::Touch(Some(TOUCH)));
    script.send(follow());
    for foam in common::foams() {
        script.act(Act::Place(foam.clone()));
        script.keep_alive(20);
        script.send(press());
        script.keep_alive(300);
    }
    script.send(press());
    script.keep_alive(40);
    script.send(script::set_display(DisplayMode::Material { parts: Parts::Both, material: other }));
    script.keep_alive(260);
    // the coil alone, at the place that the potentiometer reads
    script.send(script::set_display(DisplayMode::Idle));
    script.send(script::set_display(DisplayMode::Material { parts: Parts::CoilAtPlace, material: other }));
    script.keep_alive(100);
    script.send(script::set_display(DisplayMode::Idle));
    script.send(follow());
    script.keep_alive(20);
    for (input, broken, _) in BROKEN {
        script.send(press());
        script.keep_alive(40);
        script.act(Act::Break(input, Some(broken)));
        script.keep_alive(20);
        script.act(Act::Break(input, None));
        // The arm is home again.
        script.wait(100);
        script.send(Request::ClearFaults(Empty {}));
        script.wait(5);
        script.send(follow());
        script.keep_alive(20);
    }
    script.send(press());
    script.keep_alive(20);
    script.wait(80);
    script
}

/// The same script on both boards: real, then model.
fn on_both_boards(script: &Script) -> (Heard, Heard) {
    let mut emulated = common::board();
    assert!(emulated.run_to_tick(1.0).unwrap());
    // The in-process board is given the real one's phase between converter and control, and nothing else.
    let begun = emulated.halves() as u32;
    let real = Heard::of(&mut emulated, script);
    let mut simulated = SimulatedBoard::new(1, Jitter::NONE);
    simulated.set_timing(Timing { early_steps: begun - 1 - 20, within_step: true });
    simulated.step();
    let model = Heard::of(&mut simulated, script);
    assert_eq!((&real.refused, &model.refused), (&vec![], &vec![]));
    (real, model)
}

fn codes(heard: &Heard) -> Vec<(u32, u8)> {
    heard.faults.iter().map(|f| (f.tick, f.fault)).collect()
}

/// Every number of a verdict has the same bits, but for how long the ticks took.
fn timeless(heard: &Heard) -> Vec<Verdict> {
    let without = |v: &Verdict| Verdict { tick_max_us: 0, tick_mean_us: 0.0, ..v.clone() };
    heard.verdicts.iter().map(without).collect()
}

/// Pairs of what both boards said of the same tick.
fn pairs<'a, T>(real: &'a [T], model: &'a [T], tick: impl Fn(&T) -> u32) -> Vec<(&'a T, &'a T)> {
    let mut others = model.iter().peekable();
    let mut pairs = Vec::new();
    for one in real {
        while others.next_if(|m| tick(m) < tick(one)).is_some() {}
        pairs.extend(others.next_if(|m| tick(m) == tick(one)).map(|other| (one, other)));
    }
    pairs
}

/// States and faults are the same in every tick, and outputs within a count.
fn assert_outputs_within_a_count(script: &Script, real: &[Telemetry], model: &[Telemetry]) {
    let mut largest = [0.0f32; 4];
    let compared = pairs(real, model, |record| record.tick);
    for (record, other) in &compared {
        assert_eq!((record.state, record.faults), (other.state, other.faults), "tick {}", record.tick);
        let differences = [
            record.actuator_v - other.actuator_v,
            record.shaft_target_mm - other.shaft_target_mm,
            record.coil_target_a - other.coil_target_a,
            record.coil_duty - other.coil_duty,
        ];
        for (most, difference) in largest.iter_mut().zip(differences) {
            *most = most.max(difference.abs());
        }
    }
    let [actuator_v, target_mm, coil_a, duty] = largest;
    let compared = compared.len() as u32;
    println!("{compared} ticks; at most {actuator_v} V, {target_mm} mm, {coil_a} A, duty {duty}");
    // The records of a few ticks fall behind the queue to the UART.
    assert!(compared * 100 > script.ticks() * 95, "{compared} of {} ticks compared", script.ticks());
    // One count of the potentiometer's converter about rest, mm, and what the board's proportional gain of 2.4 V/mm makes of it; one
    // count of the coil's current, A, and what its regulator makes of it at rest.
    let count_mm = 1.0 / 4096.0 / (1.6 / (2.5829f32 + 1.6).powi(2) * 0.080_279);
    assert!(target_mm <= count_mm && actuator_v <= 2.4 * count_mm, "{target_mm} mm, {actuator_v} V");
    let circuit = CoilCircuit::default();
    let closes = 1.0 - (-circuit.bandwidth_rad_s * 1e-3).exp();
    let duty_per_a = closes * circuit.winding.inductance_h(1) / (circuit.supply_v * 1e-3);
    let count_a = 3.3 / 4096.0;
    assert!(coil_a <= count_a && duty <= duty_per_a * count_a, "{coil_a} A, duty {duty}");
}

/// Materials that verdicts name.
fn named(table: &Table<'_>, heard: &Heard) -> Vec<String> {
    let name = |index: u8| table.material(usize::from(index)).map_or("none".to_owned(), |m| m.name.to_owned());
    heard.verdicts.iter().map(|v| name(v.material.index)).collect()
}

#[test]
fn identified_materials_faults_and_outputs_are_the_same() {
    let table = common::table();
    let parsed = Table::parse(table).unwrap();
    let shown = parsed.materials().position(|m| m.shaft_mm(TOUCH.peak_n as f32) <= STROKE_MM).unwrap() as u8;
    let script = session(table, shown);
    let (real, model) = on_both_boards(&script);

    let placed: Vec<_> = common::foams().iter().map(|f| f.name.clone()).collect();
    assert_eq!((named(&parsed, &real), named(&parsed, &model)), (placed.clone(), placed));
    let wanted: Vec<_> = BROKEN.iter().flat_map(|b| b.2).chain(&[Fault::LinkLost]).map(|f| *f as u8).collect();
    assert_eq!(codes(&real).iter().map(|f| f.1).collect::<Vec<_>>(), wanted);
    assert_eq!(codes(&real), codes(&model));
    assert_eq!(timeless(&real), timeless(&model));
    assert_outputs_within_a_count(&script, &real.records, &model.records);
    // Modes of the whole board are told of as ever.
    assert_eq!((real.halves.len(), model.halves.len()), (0, 0));
}

#[test]
fn palpating_and_displaying_at_once_is_the_same() {
    let table = common::table();
    let parsed = Table::parse(table).unwrap();
    let other = parsed.materials().position(|m| m.shaft_mm(TOUCH.peak_n as f32) <= STROKE_MM).unwrap() as u8;
    let script = both_halves(table, other);
    let (real, model) = on_both_boards(&script);

    // The last foam is pressed once more; what a fault ends names nothing.
    let mut placed: Vec<_> = common::foams().iter().map(|f| f.name.clone()).collect();
    placed.extend(placed.last().cloned());
    let (names, of_model) = (named(&parsed, &real), named(&parsed, &model));
    assert_eq!((&names[..placed.len()], &names), (&placed[..], &of_model));
    assert_eq!(names.len(), placed.len() + BROKEN.len() + 1);
    let wanted: Vec<_> = BROKEN.iter().flat_map(|b| b.2).chain(&[Fault::LinkLost]).map(|f| *f as u8).collect();
    assert_eq!(codes(&real).iter().map(|f| f.1).collect::<Vec<_>>(), wanted);
    assert_eq!(codes(&real), codes(&model));
    assert_eq!(timeless(&real), timeless(&model));
    assert_outputs_within_a_count(&script, &real.records, &model.records);

    let compared = pairs(&real.halves, &model.halves, |halves| halves.tick);
    for (one, other) in &compared {
        // The bound follows the force within its own last bits.
        let bound_a = other.bound_a;
        assert!((one.bound_a - bound_a).abs() <= 3.3 / 4096.0, "tick {}", one.tick);
        assert_eq!(&Halves { bound_a, ..(*one).clone() }, *other);
    }
    let both = |h: &&Halves| h.display == DisplayState::On && matches!(h.palpation, State::Approach | State::Contact);
    let at_once = compared.iter().filter(|(one, _)| both(one)).count();
    let shown: std::collections::BTreeSet<u32> = real.halves.iter().map(|h| h.of_palpation).collect();
    println!("{} ticks of halves, both on in {at_once}; curves of palpations {shown:?}", compared.len());
    assert!(at_once > 400 && shown.len() > common::foams().len(), "{at_once} {shown:?}");
    // Coil and shaft are driven while the arm presses.
    let driven = |r: &&Telemetry| r.state == State::Contact && r.coil_target_a > 0.05 && r.actuator_v != 0.0;
    let driven = real.records.iter().filter(driven).count();
    assert!(driven > 100, "{driven} ticks");
}
