//! Wires that break: at the rail by a resistor of the drawing, or afloat.

use super::*;
use crate::testbed::LIBRARY;
use protocol::fault::Fault;

const LOAD_CELL: usize = 0;
const FSR: usize = 1;
const POTENTIOMETER: usize = 2;
const PROBE: usize = 3;
const COIL: usize = 4;

const BARE: Pin = Pin::Bare { leak: 0.0 };

/// What a load cell that is off reads as 0 N for ever: the zero of the coil, which comes before it, and as much leakage as
/// its own zero lies above.
const UNLUCKY: Pin = Pin::Bare { leak: 0.05 };

/// The stiffest foam, 6 N at the table's 4 mm and 5 N/mm there.
const STIFF: Foam = LIBRARY[7];

/// A press of 4 mm/s into a foam; the wire comes off when the probe is at `off_mm` above the surface.
struct Off {
    channel: usize,
    pin: Pin,
    off_mm: f32,
    /// The host says where the surface is.
    expected: bool,
}

/// Presses; largest true force and deepest place, and the faults.
fn press(foam: Foam, off: &Off) -> (f32, f32, Vec<Fault>) {
    let mut bench = Bench::new();
    bench.foam = Some(foam);
    let surface_mm = foam.height_mm as f32;
    bench.probe_mm = surface_mm + 4.0;
    bench.home_mm = bench.probe_mm;
    bench.ticks(2);
    if off.expected {
        bench.accept(&Request::ExpectSurface(protocol::message::Surface { height_mm: surface_mm }));
    }
    bench.mode(Mode::Palpate { rate_mm_s: 4.0, depth_mm: 3.5 });
    let (mut most_n, mut deepest_mm) = (0.0f32, f32::NEG_INFINITY);
    for i in 0..1500 {
        if bench.probe_mm <= surface_mm + off.off_mm && bench.off.is_none() {
            bench.off = Some((off.channel, off.pin));
        }
        if i % 25 == 0 {
            bench.send(&Request::Status(Empty {}));
        }
        bench.tick();
        let depth_mm = surface_mm - bench.probe_mm;
        most_n = most_n.max(foam.force_n(f64::from(depth_mm)) as f32);
        deepest_mm = deepest_mm.max(depth_mm);
    }
    assert!(!bench.outputs.arm_run && bench.probe_mm > surface_mm, "the arm is not back");
    (most_n, deepest_mm, bench.faults())
}

/// Half a newton below zero, steady and in range: a board that has stood with the wire off.
#[test]
fn a_load_cell_that_floats_before_the_press_is_found_in_the_air() {
    let mut bench = Bench::new();
    bench.foam = Some(STIFF);
    bench.tick();
    bench.off = Some((LOAD_CELL, BARE));
    // Ten time constants.
    bench.ticks(600);
    assert!((bench.board.measured().load_cell_n + 0.5).abs() < 0.01 && bench.faults().is_empty());
    let began_mm = bench.probe_mm;
    bench.mode(PALPATE);
    bench.run_until(10, |b| b.board.state() == State::Fault);
    assert_eq!(bench.faults(), [Fault::ForceImplausible]);
    assert!(began_mm - bench.probe_mm < 0.5, "{} mm", began_mm - bench.probe_mm);
}

/// Whenever it comes off, the ball presses with less than 10 N into foams of up to 5 N/mm, which the cell bears; in contact the depth ends the
/// press as ever. With a stated surface a press without contact ends 1.2 mm below it.
#[test]
fn a_load_cell_that_comes_off_never_lets_the_ball_press_with_ten_newtons() {
    for foam in [STIFF, LIBRARY[0], LIBRARY[2]] {
        for tenths in -35..40 {
            for pin in [BARE, UNLUCKY, Pin::Bare { leak: -0.2 }] {
                for expected in [false, true] {
                    let off = Off { channel: LOAD_CELL, pin, off_mm: tenths as f32 / 10.0, expected };
                    let (most_n, deepest_mm, faults) = press(foam, &off);
                    let name = foam.name;
                    let case =
                        format!("{name}, off {} mm, {expected}: {most_n} N, {deepest_mm} mm, {faults:?}", off.off_mm);
                    // A wire that reads zero in the air for ever cannot be told from no specimen: the stated surface is what holds then.
                    let blind = matches!(pin, Pin::Bare { leak } if leak > 0.0) && tenths > -3 && !expected;
                    if !blind {
                        // 1.1 s at 4 mm/s until a reading that sinks to -0.5 N is found.
                        let bound_mm = if tenths < -5 { 4.0 } else { (4.5 - off.off_mm).max(1.2) };
                        assert!(most_n < 10.0 && deepest_mm < bound_mm, "{case}");
                    }
                    if expected && tenths > 0 {
                        assert!(deepest_mm < 1.2, "{case}");
                    }
                }
            }
        }
    }
}

/// A wire that comes off in contact, at a pin that comes to rest at a newton: a force that a press could have, but
/// not one that it falls to.
#[test]
fn a_force_that_falls_in_contact_ends_the_press_before_its_depth() {
    let off = Off { channel: LOAD_CELL, pin: Pin::Bare { leak: 0.15 }, off_mm: -2.0, expected: false };
    let (_, deepest_mm, faults) = press(STIFF, &off);
    assert!(deepest_mm < 3.2 && faults == [Fault::ForceImplausible], "{deepest_mm} mm {faults:?}");
}

#[test]
fn a_glitch_that_no_reading_follows_is_one_reading_and_no_contradiction() {
    let mut bench = Bench::new();
    bench.foam = Some(STIFF);
    bench.probe_mm = 14.0;
    bench.mode(PALPATE);
    bench.run_until(200, |b| b.board.state() == State::Contact && b.board.measured().load_cell_n > 1.0);
    let glitch: fn(&mut Inputs) = |i| i.raw.load_cell = 0.12;
    for spoil in [glitch, |i| i.fresh = false, |i| i.fresh = false] {
        bench.spoil = spoil;
        bench.tick();
    }
    bench.spoil = |_| {};
    bench.ticks(5);
    assert_eq!((bench.faults(), bench.board.state()), (vec![], State::Contact));
}

/// The same beneath the lowest surface that the table serves: 12.7 mm less 2 mm, without a word of the host.
#[test]
fn a_press_without_contact_ends_below_the_lowest_surface_of_the_table() {
    let off = Off { channel: LOAD_CELL, pin: UNLUCKY, off_mm: 2.0, expected: false };
    let (_, deepest_mm, faults) = press(STIFF, &off);
    // A tick of 0.08 mm.
    assert!(deepest_mm < 2.09 && faults.is_empty(), "{deepest_mm} mm {faults:?}");
}

/// The transducer follows the potentiometer, at 28 mm: it stands, rises, or falls at another rate than the arm's.
#[test]
fn a_probe_position_that_floats_is_found_within_a_second_and_force_still_bounds_the_press() {
    for foam in [STIFF, LIBRARY[2]] {
        for tenths in [35, 20, 10, 5, 0, -5, -10, -20] {
            let off = Off { channel: PROBE, pin: BARE, off_mm: tenths as f32 / 10.0, expected: false };
            let (most_n, _, faults) = press(foam, &off);
            // Force ends the press at 7.5 N; one tick of 4 mm/s into 5 N/mm.
            assert!(most_n < 7.5 + 0.4, "{} at {tenths}: {most_n} N", foam.name);
            let told = faults.contains(&Fault::ArmDeviates);
            // Where contact is found at a height that no slice has, the press has ended by then.
            assert!(told || most_n < 0.5, "{} at {tenths}: {faults:?}", foam.name);
        }
    }
}

/// With the resistors of the drawing every open wire is a fault in one tick, in a press and in the display. An open FSR reads as an untouched
/// one, and the display goes to rest.
#[test]
fn an_open_wire_with_the_resistors_of_the_drawing_is_a_fault_in_a_tick() {
    let faults = [
        (LOAD_CELL, Some(Fault::LoadCellOpen)),
        (POTENTIOMETER, Some(Fault::PotentiometerOpen)),
        (PROBE, Some(Fault::ProbePositionOpen)),
        (COIL, Some(Fault::CurrentLimit)),
        (FSR, None),
    ];
    for (channel, fault) in faults {
        for mode in [PALPATE, Mode::Display { material: 2 }] {
            let mut bench = Bench::new();
            bench.finger_n = 1.0;
            bench.mode(mode);
            bench.ticks(20);
            bench.off = Some((channel, Pin::Pulled));
            bench.tick();
            match fault {
                Some(fault) => {
                    assert!(bench.faults().contains(&fault), "{channel}: {:?}", bench.faults());
                    assert_eq!(bench.outputs, Outputs::default());
                }
                None => {
                    // As untouched: the current and the place of the sensor's threshold, 0.21 N. 0.5 A/N, 1.71 mm/N.
                    let waits_a = if mode == PALPATE { 0.0 } else { 0.11 };
                    assert!((bench.outputs.coil_target_a - waits_a).abs() < 0.01);
                    bench.run_until(60, |b| b.shaft_mm < 0.4);
                    assert_eq!(bench.board.measured().fsr_n, 0.0);
                }
            }
        }
    }
}

/// Without its resistor the FSR's pin follows the load cell's, which is a light touch: the display shows it and stays within its limits.
#[test]
fn a_floating_force_sensor_is_a_light_touch() {
    let mut bench = Bench::new();
    bench.finger_n = 2.0;
    bench.mode(Mode::Display { material: 2 });
    bench.ticks(50);
    bench.off = Some((FSR, BARE));
    bench.run_until(700, |b| b.board.measured().fsr_n < 0.5);
    assert!(bench.shaft_mm < 1.5 && bench.faults().is_empty(), "{} mm", bench.shaft_mm);
}

/// The potentiometer's pin follows the FSR's: to the rail without a finger. With one it stands somewhere in the stroke, and the loop
/// drives against a reading that does not move: a stall.
#[test]
fn a_floating_potentiometer_is_a_rail_or_a_stall() {
    for finger_n in [0.0, 1.0, 3.0] {
        let mut bench = Bench::new();
        bench.finger_n = finger_n;
        bench.mode(Mode::Display { material: 2 });
        bench.ticks(50);
        bench.off = Some((POTENTIOMETER, BARE));
        bench.run_until(600, |b| b.board.state() == State::Fault);
        let faults = bench.faults();
        let told =
            [Fault::PotentiometerOpen, Fault::ActuatorStall, Fault::StrokeLimit].iter().any(|f| faults.contains(f));
        assert!(told, "{finger_n} N: {faults:?}");
    }
}
