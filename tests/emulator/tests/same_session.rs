//! The same scripted session on the in-process board and on the emulated real image.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;
#[path = "common/script.rs"]
mod script;

use firmware::coil::winding::CoilCircuit;
use palpate::plant::{Broken, Input, Jitter, Touch};
use palpate::simulated_board::{SimulatedBoard, Timing};
use protocol::PROTOCOL_VERSION;
use protocol::fault::Fault;
use protocol::lut::Table;
use protocol::message::{Empty, HelloRequest, Mode, Request, SCHEMA_HASH, Verdict};
use script::{Act, Heard, Script};

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

fn session(table: &[u8], shown: u8) -> Script {
    let mut script = Script::default();
    script.wait(10);
    script.send(Request::Hello(HelloRequest { protocol_version: PROTOCOL_VERSION, schema_hash: SCHEMA_HASH }));
    script.wait(10);
    // Four sectors of 16 KiB, one of 64 and one of 128 take at most 2.6 s.
    script.upload(table, 200);
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

#[test]
fn identified_materials_faults_and_outputs_are_the_same() {
    let table = common::table();
    let parsed = Table::parse(table).unwrap();
    let shown = parsed.materials().position(|m| m.shaft_mm(TOUCH.peak_n as f32) <= STROKE_MM).unwrap() as u8;
    let script = session(table, shown);

    let mut emulated = common::board();
    assert!(emulated.run_to_tick(1.0).unwrap());
    // The in-process board is given the real one's phase between converter and control, and nothing else.
    let begun = emulated.halves() as u32;
    let real = Heard::of(&mut emulated, &script);
    let mut simulated = SimulatedBoard::new(1, Jitter::NONE);
    simulated.set_timing(Timing { early_steps: begun - 1 - 20, within_step: true });
    simulated.step();
    let model = Heard::of(&mut simulated, &script);
    assert_eq!((&real.refused, &model.refused), (&vec![], &vec![]));

    let named = |heard: &Heard| {
        let name = |index: u8| parsed.material(usize::from(index)).unwrap().name.to_owned();
        heard.verdicts.iter().map(|v| name(v.material.index)).collect::<Vec<_>>()
    };
    let placed: Vec<_> = common::foams().iter().map(|f| f.name.clone()).collect();
    assert_eq!((named(&real), named(&model)), (placed.clone(), placed));
    let codes = |heard: &Heard| heard.faults.iter().map(|f| (f.tick, f.fault)).collect::<Vec<_>>();
    let wanted: Vec<_> = BROKEN.iter().flat_map(|b| b.2).chain(&[Fault::LinkLost]).map(|f| *f as u8).collect();
    assert_eq!(codes(&real).iter().map(|f| f.1).collect::<Vec<_>>(), wanted);
    assert_eq!(codes(&real), codes(&model));

    let timeless = |heard: &Heard| {
        let without = |v: &Verdict| Verdict { tick_max_us: 0, tick_mean_us: 0.0, ..v.clone() };
        heard.verdicts.iter().map(without).collect::<Vec<_>>()
    };
    // Not only the material: every number of a verdict has the same bits, but for how long the ticks took.
    assert_eq!(timeless(&real), timeless(&model));

    let mut largest = [0.0f32; 4];
    let mut compared = 0;
    let mut model_records = model.records.iter().peekable();
    for record in &real.records {
        while model_records.next_if(|m| m.tick < record.tick).is_some() {}
        let Some(other) = model_records.next_if(|m| m.tick == record.tick) else {
            continue;
        };
        compared += 1;
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
