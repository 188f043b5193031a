//! Palpation and display at once: independence, limits, interlock, lost links, what is followed.

use super::*;
use crate::interlock::{Power, Trip};
use crate::testbed::{Chance, LIBRARY, factored_table_with};
use protocol::fault::Fault;
use protocol::message::{
    Curve, DisplayMode, DisplayRequest, DisplayState, Halves, HelloRequest, PalpationMode, PalpationRequest, Parts,
    Rule, SCHEMA_HASH, Verdict,
};

const PRESS: PalpationMode = PalpationMode::Press { rate_mm_s: 4.0, depth_mm: 3.5, surface_mm: None };
const SHOW: DisplayMode = DisplayMode::Material { parts: Parts::Both, material: 2 };
const FOLLOW: DisplayMode = DisplayMode::Follow { parts: Parts::Both, by: Rule::Between };

fn palpate(palpation: PalpationMode) -> Request {
    Request::SetPalpation(PalpationRequest { palpation, lease_ms: LEASE_MS.1 })
}

fn display(display: DisplayMode) -> Request {
    Request::SetDisplay(DisplayRequest { display, lease_ms: LEASE_MS.1 })
}

fn hello(schema_hash: u64) -> Request {
    Request::Hello(HelloRequest { protocol_version: protocol::PROTOCOL_VERSION, schema_hash })
}

/// A foam under a probe 4 mm above it.
fn lay(bench: &mut Bench, foam: Foam) {
    bench.foam = Some(foam);
    bench.home_mm = foam.height_mm as f32 + 4.0;
    bench.probe_mm = bench.home_mm;
}

/// Both halves on, a finger on the display.
fn both() -> Bench {
    let mut bench = Bench::new();
    lay(&mut bench, LIBRARY[0]);
    bench.finger_n = 1.0;
    bench.accept(&display(SHOW));
    bench.accept(&palpate(PRESS));
    bench.ticks(5);
    assert_eq!(bench.outputs.power, Power { arm: true, actuator: true, coil: true });
    assert!(bench.outputs.arm_run && bench.outputs.actuator_v > 0.0 && bench.outputs.coil_target_a > 0.0);
    bench
}

fn halves(bench: &mut Bench) -> Halves {
    match bench.ask(&Request::GetHalves(Empty {})) {
        Report::Halves(halves) => halves,
        other => panic!("{other:?}"),
    }
}

/// Presses what lies there, and returns the verdict.
fn press(bench: &mut Bench) -> Verdict {
    bench.reports.clear();
    bench.send(&palpate(PRESS));
    bench.run_until(4000, |b| b.verdict().is_some());
    bench.verdict().unwrap().clone()
}

/// What is done to one half, and to its surroundings, at which tick.
#[derive(Clone)]
enum Act {
    Palpate(PalpationMode),
    Display(DisplayMode),
    Finger(f32),
    Foam(usize),
}

/// Acts of half a minute; each half's by a seed of its own.
fn acts(chance: &mut Chance, display: bool) -> Vec<(u32, Act)> {
    let mut tick = 0;
    let mut acts = vec![];
    while tick < 1500 {
        let pick = chance.even();
        let index = (8.0 * chance.even()) as u8;
        let parts = [Parts::Both, Parts::Coil, Parts::Actuator, Parts::CoilAtPlace][(4.0 * chance.even()) as usize];
        let act = match (display, pick) {
            (true, 0.0..0.5) => Act::Finger(4.0 * chance.even() as f32),
            (true, 0.5..0.7) => Act::Display(DisplayMode::Material { parts, material: index }),
            (true, 0.7..0.85) => Act::Display(DisplayMode::Between {
                parts,
                mu_mpa: 0.3 * chance.even() as f32,
                alpha: 1.0 + 23.0 * chance.even() as f32,
                height_mm: 19.0,
                rate_mm_s: 2.0,
            }),
            (true, _) => Act::Display(DisplayMode::Idle),
            (false, 0.0..0.3) => Act::Foam(usize::from(index)),
            (false, 0.3..0.8) => Act::Palpate(PRESS),
            (false, _) => Act::Palpate(PalpationMode::Idle),
        };
        acts.push((tick, act));
        tick += 1 + (60.0 * chance.even()) as u32;
    }
    acts
}

/// Outputs of every tick, what the display showed, and what palpation said.
fn session(acts: &[&[(u32, Act)]]) -> (Vec<(Outputs, Telemetry)>, Vec<Report>) {
    let mut bench = Bench::new();
    let mut ticks = vec![];
    let mut said = vec![];
    for tick in 0..1500 {
        for (_, act) in acts.iter().copied().flatten().filter(|(at, _)| *at == tick) {
            match act {
                Act::Palpate(palpation) => bench.send(&palpate(*palpation)),
                Act::Display(mode) => bench.send(&display(*mode)),
                Act::Finger(force_n) => bench.finger_n = *force_n,
                // Only under a probe that is above every foam.
                Act::Foam(index) if bench.probe_mm > 29.0 => bench.foam = Some(LIBRARY[*index]),
                Act::Foam(_) => {}
            }
        }
        if tick % 20 == 0 {
            bench.send(&Request::Status(Empty {}));
        }
        bench.tick();
        let record = bench.record();
        ticks.push((bench.outputs, record));
        assert_eq!(bench.faults(), [], "tick {tick}");
        said.extend(bench.reports.drain(..).filter(|r| matches!(r, Report::Verdict(_) | Report::Estimate(_))));
    }
    (ticks, said)
}

/// What there is of the palpation half.
fn arm(tick: &(Outputs, Telemetry)) -> (bool, u32, bool, [u32; 4]) {
    let (outputs, record) = tick;
    let seen = [record.probe_mm, record.depth_mm, record.load_cell_n, record.search_error_n];
    (outputs.arm_run, outputs.arm_rate_mm_s.to_bits(), outputs.power.arm, seen.map(f32::to_bits))
}

/// What there is of the display half.
fn shown(tick: &(Outputs, Telemetry)) -> (Power, [u32; 8], protocol::message::Shown) {
    let (outputs, record) = tick;
    let seen = [
        outputs.actuator_v,
        outputs.coil_target_a,
        outputs.coil_duty,
        record.shaft_target_mm,
        record.fsr_n,
        record.shaft_mm,
        record.coil_a,
        record.coil_c,
    ];
    (Power { arm: false, ..outputs.power }, seen.map(f32::to_bits), record.shown)
}

/// Whatever one half is asked for and does, the other half's outputs, readings and verdicts are the same bit by
/// bit, in every tick.
#[test]
fn the_other_half_changes_nothing_in_the_outputs_of_this_one() {
    let (mut verdicts, mut displayed) = (0, 0);
    for seed in 0..20 {
        let mut chance = Chance(seed);
        let (palpation, display) = (acts(&mut chance, false), acts(&mut chance, true));
        let (alone, said_alone) = session(&[&palpation]);
        let (only, _) = session(&[&display]);
        let (together, said) = session(&[&palpation, &display]);
        for (tick, both) in together.iter().enumerate() {
            assert_eq!(arm(both), arm(&alone[tick]), "seed {seed}, tick {tick}");
            assert_eq!(shown(both), shown(&only[tick]), "seed {seed}, tick {tick}");
        }
        assert_eq!(said, said_alone, "seed {seed}");
        verdicts += said.iter().filter(|r| matches!(r, Report::Verdict(v) if v.outcome == Outcome::Identified)).count();
        displayed += together.iter().filter(|(o, _)| o.arm_run && o.coil_target_a > 0.0).count();
    }
    // The sessions hold what they are to prove: presses to their end, and many ticks with both on.
    assert!(verdicts > 20 && displayed > 1000, "{verdicts} verdicts, {displayed} ticks of both");
}

/// The arm may fail by a fault of the display and the display by one of the arm: no output survives any fault.
#[test]
fn every_fault_switches_every_output_off() {
    for fault in Fault::ALL {
        let mut bench = both();
        bench.reports.clear();
        bench.board.latch(*fault);
        bench.tick();
        assert_eq!(bench.outputs, Outputs::default(), "{fault:?}");
        assert_eq!(bench.verdict().map(|v| v.outcome), Some(Outcome::Aborted), "{fault:?}");
        let told = halves(&mut bench);
        assert_eq!((told.palpation, told.display), (State::Fault, DisplayState::Fault));
        for request in [palpate(PRESS), display(SHOW), display(FOLLOW)] {
            assert_eq!(bench.refusal(&request), Refusal::Faulted);
        }
        // Nothing comes back by itself.
        bench.accept(&Request::ClearFaults(Empty {}));
        bench.ticks(5);
        assert_eq!((bench.outputs, bench.board.state()), (Outputs::default(), State::Idle), "{fault:?}");
    }
}

#[test]
fn limits_of_either_half_and_the_interlock_end_both_in_a_tick() {
    type Case = (fn(&mut Inputs), Fault);
    let cases: [Case; 9] = [
        (|i| i.raw.load_cell = 0.95, Fault::ForceLimit),
        (|i| i.raw.probe_position = 0.0, Fault::ProbePositionOpen),
        (|i| i.raw.potentiometer = 1.0, Fault::PotentiometerOpen),
        (|i| i.raw.fsr = 0.99, Fault::FsrShort),
        (|i| i.coil_trip = Some(Fault::CoilUncommanded), Fault::CoilUncommanded),
        (|i| i.tick_us = 18_001, Fault::DeadlineMissed),
        (|i| i.period_us = 30_001, Fault::DeadlineMissed),
        (|i| i.interlock = Some(Trip::Expired), Fault::Interlock),
        (|i| i.raw.load_cell = f32::NAN, Fault::NotFinite),
    ];
    for (spoil, fault) in cases {
        let mut bench = both();
        bench.spoil = spoil;
        bench.tick();
        assert_eq!(bench.outputs, Outputs::default(), "{fault:?}");
        assert!(bench.faults().contains(&fault), "{fault:?}: {:?}", bench.faults());
    }
}

#[test]
fn a_lost_link_ends_both_when_the_shorter_lease_ends() {
    for (first_ms, second_ms) in [(1000, 200), (200, 1000)] {
        let mut bench = Bench::new();
        lay(&mut bench, LIBRARY[0]);
        bench.finger_n = 1.0;
        bench.accept(&Request::SetDisplay(DisplayRequest { display: SHOW, lease_ms: first_ms }));
        bench.accept(&Request::SetPalpation(PalpationRequest { palpation: PRESS, lease_ms: second_ms }));
        // Ten ticks of silence are allowed.
        bench.ticks(10);
        assert!(bench.outputs.power.arm && bench.outputs.power.coil, "{first_ms} {second_ms}");
        bench.tick();
        assert_eq!((bench.outputs, bench.faults()), (Outputs::default(), vec![Fault::LinkLost]));
    }
    // A display that waits is no output yet, but becomes one without a further word of the host.
    let mut bench = Bench::new();
    bench.accept(&display(FOLLOW));
    bench.ticks(52);
    assert_eq!(bench.faults(), [Fault::LinkLost]);
}

#[test]
fn a_half_that_ends_leaves_the_other_one_on() {
    let mut bench = both();
    bench.accept(&display(DisplayMode::Idle));
    bench.tick();
    assert_eq!(bench.outputs.power, Power::ARM);
    assert_eq!((bench.outputs.actuator_v, bench.outputs.coil_target_a, bench.outputs.coil_duty), (0.0, 0.0, 0.0));
    let mut bench = both();
    bench.accept(&palpate(PalpationMode::Idle));
    bench.tick();
    assert_eq!((bench.outputs.power, bench.outputs.arm_run), (Power::DISPLAY, false));
    assert_eq!(bench.board.state(), State::Retract);
    // The old way to stop stops everything, and so does the button.
    let mut bench = both();
    bench.mode(Mode::Idle);
    bench.tick();
    assert_eq!((bench.outputs, bench.board.state()), (Outputs::default(), State::Retract));
    let mut bench = both();
    bench.spoil = |i| i.stop_pressed = true;
    bench.tick();
    assert_eq!((bench.outputs, bench.board.state()), (Outputs::default(), State::Retract));
    assert_eq!(bench.refusal(&display(SHOW)), Refusal::Stopped);
    assert_eq!(bench.refusal(&palpate(PRESS)), Refusal::Stopped);
}

/// The modes of before exclude each other as they did, and what was asked for by halves is in their way.
#[test]
fn a_mode_of_the_whole_board_is_refused_while_a_half_is_on() {
    let mut bench = both();
    assert_eq!(bench.refusal(&set_mode(Mode::Display { material: 1 })), Refusal::Busy);
    assert_eq!(bench.refusal(&Request::Tare(Empty {})), Refusal::Busy);
    bench.accept(&palpate(PalpationMode::Idle));
    bench.run_until(500, |b| b.board.state() == State::Display);
    assert_eq!(bench.refusal(&set_mode(PALPATE)), Refusal::Busy);
    // Over an older display a press by halves is possible all the same.
    let mut bench = Bench::new();
    lay(&mut bench, LIBRARY[0]);
    bench.mode(Mode::Display { material: 2 });
    assert_eq!(press(&mut bench).outcome, Outcome::Identified);
    assert_eq!(bench.board.state(), State::Display);
}

#[test]
fn the_other_link_may_stop_a_half_but_not_begin_one() {
    let mut bench = both();
    let ask = |bench: &mut Bench, request: &Request| {
        let mut buffer = [0; MAX_FRAME];
        bench.board.receive(LinkId::Uart, encode_request(request, 1, &mut buffer).unwrap());
    };
    for request in [display(FOLLOW), palpate(PRESS), palpate(PalpationMode::Idle)] {
        ask(&mut bench, &request);
    }
    bench.tick();
    assert_eq!(bench.outputs.power, Power::DISPLAY);
    assert_eq!(bench.board.machine.mode.displaying.asked(), SHOW);
    ask(&mut bench, &display(DisplayMode::Idle));
    bench.tick();
    assert_eq!(bench.outputs, Outputs::default());
}

/// Figs. 59 and 62: what is pressed is what is displayed, from its verdict on.
#[test]
fn what_is_identified_is_displayed_from_its_verdict_on() {
    for by in [Rule::Nearest, Rule::Between] {
        let mut bench = Bench::new();
        bench.finger_n = 1.0;
        bench.accept(&display(DisplayMode::Follow { parts: Parts::Both, by }));
        bench.ticks(5);
        assert_eq!((halves(&mut bench).display, bench.outputs), (DisplayState::Waiting, Outputs::default()));
        for (number, index) in [(1, 2), (2, 3)] {
            lay(&mut bench, LIBRARY[index]);
            let verdict = press(&mut bench);
            assert_eq!(usize::from(verdict.material.index), index);
            // Shown from the next tick on.
            bench.tick();
            bench.run_until(100, |b| b.board.machine.mode.displaying.showing().share() >= 1.0);
            let told = halves(&mut bench);
            assert_eq!((told.display, told.of_palpation), (DisplayState::On, number));
            let Curve { low, high, weight } = told.curve;
            let share = if usize::from(low) == index { 1.0 - weight } else { weight };
            assert!([low, high].contains(&(index as u8)) && share > 0.9, "{told:?}");
            if by == Rule::Nearest {
                assert_eq!(told.curve, Curve::of(index as u8));
            }
            // The force at two depths is found to a hundredth, without noise.
            assert!(told.departs < 0.03 && !told.outside, "{told:?}");
            // Half an ampere a newton, whatever foam: what the made-up library asks for.
            assert!((bench.outputs.coil_target_a - 0.5).abs() < 0.01, "{}", bench.outputs.coil_target_a);
        }
        // Nothing under the probe says nothing: what was shown stays.
        let before = halves(&mut bench);
        bench.foam = None;
        assert_eq!(press(&mut bench).outcome, Outcome::NoContact);
        bench.ticks(20);
        assert_eq!(bench.faults(), []);
        let after = halves(&mut bench);
        assert_eq!((after.curve, after.of_palpation), (before.curve, before.of_palpation));
    }
}

/// A foam between A2 and a softer one that is not in the library.
#[test]
fn a_stranger_is_displayed_between_its_neighbours_and_not_by_a_name() {
    let stranger = Foam { name: "stranger", mu_mpa: 0.035, alpha: 8.0, height_mm: 19.05 };
    let softer = Foam { name: "softer", mu_mpa: 0.025, alpha: 9.0, height_mm: 19.05 };
    let [eva, b1, icf, a2] = [0, 1, 2, 3].map(|i| LIBRARY[i]);
    let mut bank = vec![0xff; BANK_LEN];
    let table = factored_table_with(&[eva, b1, icf, a2, softer]);
    bank[..table.len()].copy_from_slice(&table);
    let mut bench = Bench::with_flash(bank, ResetCause::PowerOn);
    lay(&mut bench, stranger);
    assert_eq!(press(&mut bench).material.index, protocol::message::Recognition::NONE);
    bench.run_until(500, |b| b.board.state() == State::Idle);
    bench.accept(&display(DisplayMode::Follow { parts: Parts::Both, by: Rule::Nearest }));
    bench.tick();
    assert_eq!(halves(&mut bench).display, DisplayState::Waiting);
    bench.accept(&display(FOLLOW));
    bench.finger_n = 1.0;
    bench.run_until(200, |b| b.board.machine.mode.displaying.showing().share() >= 1.0);
    let told = halves(&mut bench);
    let pair = [told.curve.low, told.curve.high];
    assert!(pair == [3, 4] && told.curve.weight > 0.2 && told.curve.weight < 0.8, "{told:?}");
    // The made-up travel of 0.2 mm/sqrt(mu) at 1 N.
    let travel_mm = bench.record().shaft_target_mm;
    let own_mm = 0.2 / stranger.mu_mpa.sqrt() as f32;
    assert!((travel_mm / own_mm - 1.0).abs() < 0.05, "{travel_mm} mm, its own {own_mm} mm");
}

/// Numbers of a library are nothing to another one.
#[test]
fn what_was_identified_with_another_table_is_forgotten() {
    let mut bench = Bench::new();
    lay(&mut bench, LIBRARY[2]);
    press(&mut bench);
    bench.run_until(500, |b| b.board.state() == State::Idle);
    let table = factored_table_with(&LIBRARY[..1]);
    let begin = protocol::message::TableBegin { length: table.len() as u32, crc: 0 };
    bench.send(&Request::TableBegin(begin));
    bench.ticks(400);
    bench.accept(&display(FOLLOW));
    bench.tick();
    assert_eq!(halves(&mut bench).display, DisplayState::Waiting);
}

/// With the new requests and with the old one.
#[test]
fn an_exchange_of_the_curve_in_the_middle_of_a_press_does_not_jump() {
    let other =
        [set_mode(Mode::Display { material: 0 }), display(DisplayMode::Material { parts: Parts::Both, material: 0 })];
    for request in other {
        let mut bench = Bench::with_flash(with_currents([1.0, 1.0, 2.0]), ResetCause::PowerOn);
        bench.finger_n = 1.0;
        bench.mode(Mode::Display { material: 2 });
        bench.run_until(300, |b| b.board.machine.tick > 200);
        let (before_a, before_mm) = (bench.outputs.coil_target_a, bench.record().shaft_target_mm);
        bench.accept(&request);
        let (mut last_a, mut last_mm) = (before_a, before_mm);
        let mut moved = vec![];
        for i in 0..60 {
            if i % 25 == 0 {
                bench.send(&Request::Status(Empty {}));
            }
            bench.tick();
            let (now_a, now_mm) = (bench.outputs.coil_target_a, bench.record().shaft_target_mm);
            moved.push(((now_a - last_a).abs(), (now_mm - last_mm).abs()));
            (last_a, last_mm) = (now_a, now_mm);
        }
        let (all_a, all_mm) = ((last_a - before_a).abs(), (last_mm - before_mm).abs());
        assert!(all_a > 0.2 && all_mm > 0.5, "{all_a} A, {all_mm} mm");
        // A finger that presses with one force goes with the shaft. The board follows it: by half of the surface's share of
        // what it goes in the loop's tenth of a second, which is spread over that time.
        let most_mm = 1.3 * all_mm / 50.0;
        for (a, mm) in moved {
            assert!(a <= all_a / 50.0 + 1e-5 && mm <= most_mm, "{a} A of {all_a}, {mm} mm of {all_mm}");
        }
    }
}

/// Of a sensor that reads one force whatever the shaft does the finger seems to go with the shaft. It ends where that force
/// wants it, and stands.
#[test]
fn a_shaft_under_a_force_that_never_changes_comes_to_rest_where_that_wants_it() {
    for (material, finger_n) in [(2, 0.25), (2, 0.4), (0, 1.0), (0, 4.0)] {
        let mut bench = Bench::new();
        bench.mode(Mode::Display { material });
        let ticks = |bench: &mut Bench, n: u32| {
            (0..n).for_each(|_| {
                bench.send(&Request::Status(Empty {}));
                bench.tick();
                bench.reports.retain(|report| matches!(report, Report::Telemetry(_)));
            });
            bench.record()
        };
        ticks(&mut bench, 100);
        bench.finger_n = finger_n;
        let after = ticks(&mut bench, 150);
        let Some(table) = bench.board.machine.table() else { panic!("no table") };
        let between = protocol::lut::Between::new(&table, material, material, 0.0).unwrap();
        let wanted_mm = between.shaft_mm(after.fsr_n);
        for _ in 0..20 {
            let now = ticks(&mut bench, 5);
            let off_mm = [now.shaft_mm - wanted_mm, now.shaft_target_mm - wanted_mm].map(f32::abs);
            assert!(off_mm.iter().all(|mm| *mm < 0.01), "{material} {finger_n} N: {off_mm:?} of {wanted_mm} mm");
        }
    }
}

/// A bank with the library's first foams, whose currents are scaled so.
fn with_currents(scales: [f64; 3]) -> Vec<u8> {
    let mut bank = vec![0xff; BANK_LEN];
    let table = crate::testbed::factored_table_scaled(&scales);
    bank[..table.len()].copy_from_slice(&table);
    bank
}

#[test]
fn parts_that_are_asked_for_alone_are_driven_alone() {
    for (parts, power) in
        [(Parts::Coil, Power { coil: true, ..Power::OFF }), (Parts::Actuator, Power { actuator: true, ..Power::OFF })]
    {
        let mut bench = Bench::new();
        bench.finger_n = 1.0;
        bench.accept(&display(DisplayMode::Material { parts, material: 2 }));
        bench.ticks(5);
        let outputs = bench.outputs;
        assert_eq!(outputs.power, power);
        assert_eq!((outputs.coil_target_a > 0.0, outputs.coil_duty > 0.0), (power.coil, power.coil));
        assert_eq!(outputs.actuator_v > 0.0, power.actuator);
        assert_eq!(bench.refusal(&display(SHOW)), Refusal::Busy);
    }
}

/// The finger's place decides the current, and the shaft's driver stays off.
#[test]
fn a_coil_at_the_fingers_place_has_no_actuator() {
    let current_at = |shaft_mm: f32, finger_n: f32| {
        let mut bench = Bench::new();
        (bench.shaft_mm, bench.finger_n) = (shaft_mm, finger_n);
        bench.accept(&display(DisplayMode::Material { parts: Parts::CoilAtPlace, material: 2 }));
        bench.ticks(2);
        assert_eq!(bench.outputs.power, Power { coil: true, ..Power::OFF });
        assert_eq!(bench.outputs.actuator_v, 0.0);
        bench.outputs.coil_target_a
    };
    let (rest, near, far) = (current_at(0.0, 0.0), current_at(1.0, 0.1), current_at(2.0, 0.1));
    assert!(rest > 0.0 && rest < near && near < far, "{rest} {near} {far}");
    // force alone decides nothing at the surface
    assert_eq!(current_at(0.0, 3.0), rest);
    let mut bench = Bench::new();
    bench.accept(&Request::SetFitted(protocol::message::Fitted { palpator: true, actuator: false, coil: true }));
    let at_place = DisplayMode::Material { parts: Parts::CoilAtPlace, material: 2 };
    assert_eq!(bench.refusal(&display(at_place)), Refusal::NoDisplay, "nothing reads the place");
}

#[test]
fn what_cannot_be_is_refused_by_its_name() {
    let between =
        |mu_mpa, alpha| DisplayMode::Between { parts: Parts::Both, mu_mpa, alpha, height_mm: 20.0, rate_mm_s: 2.0 };
    let mut bench = Bench::blank();
    assert_eq!(bench.refusal(&display(SHOW)), Refusal::NoTable);
    assert_eq!(bench.refusal(&palpate(PRESS)), Refusal::NoTable);
    let mut bank = vec![0xff; BANK_LEN];
    let table = factored_table_with(&[]);
    bank[..table.len()].copy_from_slice(&table);
    let mut bench = Bench::with_flash(bank, ResetCause::PowerOn);
    for request in [FOLLOW, between(0.1, 8.0)] {
        assert_eq!(bench.refusal(&display(request)), Refusal::NotBetween);
    }
    let mut bench = Bench::new();
    bench.tick();
    for request in [
        display(DisplayMode::Material { parts: Parts::Both, material: 8 }),
        display(between(0.1, 30.0)),
        display(between(f32::NAN, 8.0)),
        palpate(PalpationMode::Press { rate_mm_s: 9.0, depth_mm: 3.5, surface_mm: None }),
        palpate(PalpationMode::Press { rate_mm_s: 2.0, depth_mm: 3.5, surface_mm: Some(0.5) }),
        palpate(PalpationMode::Press { rate_mm_s: 2.0, depth_mm: 3.5, surface_mm: Some(f32::NAN) }),
        Request::SetDisplay(DisplayRequest { display: SHOW, lease_ms: 99 }),
        Request::SetPalpation(PalpationRequest { palpation: PRESS, lease_ms: 1001 }),
    ] {
        assert_eq!(bench.refusal(&request), Refusal::OutOfRange, "{request:?}");
    }
    bench.accept(&Request::SetFitted(protocol::message::Fitted { palpator: false, actuator: false, coil: true }));
    let actuator = DisplayMode::Material { parts: Parts::Actuator, material: 0 };
    assert_eq!(bench.refusal(&display(actuator)), Refusal::NoDisplay);
    assert_eq!(bench.refusal(&palpate(PRESS)), Refusal::NoPalpator);
    bench.accept(&display(SHOW));
}

/// A stated surface belongs to its press, also while the display is on.
#[test]
fn a_press_beside_a_display_may_state_its_surface() {
    let mut bench = Bench::new();
    bench.finger_n = 1.0;
    bench.accept(&display(SHOW));
    bench.probe_mm = 25.0;
    let surface_mm = Some(24.0);
    bench.accept(&palpate(PalpationMode::Press { rate_mm_s: 4.0, depth_mm: 3.5, surface_mm }));
    bench.run_until(200, |b| b.board.state() == State::Retract);
    assert!((bench.board.measured().probe_mm - 23.0).abs() < 0.1, "{}", bench.board.measured().probe_mm);
}

/// A tool of before can do all that it could, and hears nothing that it does not know.
#[test]
fn a_host_of_the_table_before_is_understood_and_told_nothing_new() {
    for (schema_hash, hears) in [(protocol::message::EARLIER[0], false), (SCHEMA_HASH, true)] {
        let mut bench = Bench::new();
        lay(&mut bench, LIBRARY[0]);
        assert!(matches!(bench.ask(&hello(schema_hash)), Report::Hello(_)));
        bench.mode(PALPATE);
        bench.reports.clear();
        bench.run_until(1000, |b| b.board.state() == State::Idle);
        assert_eq!(bench.verdict().map(|v| v.outcome), Some(Outcome::Identified));
        let heard = |bench: &Bench| bench.reports.iter().filter(|r| matches!(r, Report::Halves(_))).count();
        assert_eq!(heard(&bench), 0, "a mode of the whole board needs no more than telemetry");
        // By halves, as the other link may have asked for it.
        bench.send(&display(SHOW));
        bench.reports.clear();
        bench.ticks(20);
        assert_eq!(heard(&bench), if hears { 20 } else { 0 });
    }
    let mut bench = Bench::new();
    bench.send(&hello(protocol::message::EARLIER[0] ^ 1));
    assert_eq!(bench.refusal(&display(SHOW)), Refusal::SchemaMismatch);
}
