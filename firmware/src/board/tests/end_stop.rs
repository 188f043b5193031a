//! The display's shaft at the end of its stroke.

use super::*;
use crate::testbed::Chance;
use protocol::fault::Fault;

/// Noise of the potentiometer's mean in a tick, mm: 0.76 codes of 4096 at 0.033 mm a code, 320 readings.
const NOISE_MM: f64 = 0.0014;

/// A board whose force sensor has no threshold: untouched, its shaft is wanted at the stop.
fn at_the_stop() -> Bench {
    let mut bench = Bench::new();
    bench.board.machine.config.display.least_max_n = 0.0;
    bench
}

/// Displays with nobody touching for `ticks`, the potentiometer off by `offset_mm`; the largest command, V.
fn rest(mut bench: Bench, offset_mm: f32, ticks: u32) -> f32 {
    let mut chance = Chance(1);
    bench.mode(Mode::Display { material: 2 });
    let mut most_v = 0.0f32;
    for i in 0..ticks {
        bench.shaft_off_mm = offset_mm + (NOISE_MM * chance.normal()) as f32;
        bench.tick();
        most_v = most_v.max(bench.outputs.actuator_v.abs());
        if i % 25 == 0 {
            bench.send(&Request::Status(Empty {}));
            bench.reports.clear();
        }
    }
    assert_eq!((bench.faults(), bench.board.state()), (vec![], State::Display), "{offset_mm} mm");
    most_v
}

/// 24 hours. At the stop the command is proportional with the derivative's kick, 4.4 V/mm together: of 0.1 mm and
/// of the difference of two readings of noise, 0.012 mm at the most in four million.
#[test]
fn a_shaft_at_its_stop_is_no_stall_for_a_day_whatever_the_zero_error() {
    let day = 24 * 3600 * protocol::TICK_HZ;
    std::thread::scope(|scope| {
        for offset_mm in [0.1f32, -0.1, 0.05, 0.02] {
            scope.spawn(move || {
                let most_v = rest(at_the_stop(), offset_mm, day);
                assert!(most_v < 4.4 * 0.112, "{offset_mm} mm: {most_v} V");
            });
        }
    });
}

/// Where the threshold's force will have it the shaft is held as anywhere else: no command grows after that of the way
/// there, of at most 4.4 V/mm over 0.37 mm, the zero error and noise.
#[test]
fn a_shaft_that_waits_inside_its_stroke_is_no_stall_for_an_hour() {
    let hour = 3600 * protocol::TICK_HZ;
    for offset_mm in [0.1, -0.1] {
        let most_v = rest(Bench::new(), offset_mm, hour);
        assert!(most_v < 4.4 * 0.5, "{offset_mm} mm: {most_v} V");
    }
}

/// What was pushed into the stop does not have to be unwound before the shaft follows a finger.
#[test]
fn a_finger_after_an_hour_at_the_stop_is_followed_as_at_once() {
    let after = |ticks: usize| {
        let mut bench = at_the_stop();
        bench.shaft_off_mm = 0.1;
        bench.mode(Mode::Display { material: 2 });
        for _ in 0..ticks / 25 {
            bench.ticks(25);
            bench.send(&Request::Status(Empty {}));
        }
        bench.finger_n = 1.0;
        bench.ticks(10);
        bench.shaft_mm
    };
    assert!((after(180_000) - after(25)).abs() < 1e-3);
}

#[test]
fn a_shaft_blocked_away_from_its_stop_is_a_stall_in_time() {
    let mut bench = at_the_stop();
    bench.mode(Mode::Display { material: 2 });
    let ticks = bench.ticks_with_shaft_at(0.5);
    assert_eq!(bench.faults(), [Fault::ActuatorStall]);
    // 9.6 V/(mm s) need 0.8 s for 3.8 V, then two seconds.
    assert!((130..170).contains(&ticks), "{ticks}");
}

/// At the command's limit for longer than two seconds: a stall only without motion, and after five seconds anyway.
#[test]
fn a_slow_shaft_is_no_stall_and_a_potentiometer_that_wanders_hides_none_for_ever() {
    let fault_after = |mm_per_tick: f32| {
        let mut bench = Bench::new();
        (bench.shaft_mm, bench.home_mm) = (12.0, 30.0);
        bench.mode(Mode::Display { material: 2 });
        let mut ticks = 0;
        for i in 0..700 {
            // Down and up again: a target at 0 keeps the command at its limit.
            bench.shaft_mm = 8.0 + 4.0 * (1.0 - (mm_per_tick * i as f32 / 4.0) % 2.0).abs();
            if i % 25 == 0 {
                bench.send(&Request::Status(Empty {}));
            }
            bench.tick();
            ticks += u32::from(bench.board.state() == State::Display);
        }
        (ticks, bench.faults())
    };
    // 2 mm/s: driven at the limit, moving.
    let (ticks, faults) = fault_after(0.04);
    assert!((250..500).contains(&ticks) && faults == [Fault::ActuatorStall], "{ticks} {faults:?}");
    // 0.1 mm/s: still, for a motor.
    let (ticks, faults) = fault_after(0.002);
    assert!(ticks < 250 && faults == [Fault::ActuatorStall], "{ticks} {faults:?}");
}

#[test]
fn the_display_begins_where_the_shaft_is() {
    let mut bench = Bench::new();
    bench.shaft_mm = 15.0;
    bench.tick();
    bench.shaft_mm = 15.0;
    bench.mode(Mode::Display { material: 2 });
    bench.tick();
    // A tick of 5 mm/s is 0.1 mm, times 2.4 V/mm and the derivative's 2 V s/mm.
    assert!(bench.outputs.actuator_v.abs() < 0.5, "{} V", bench.outputs.actuator_v);
    assert!((bench.board.machine.shaft_target_mm - 14.9).abs() < 0.05, "{} mm", bench.board.machine.shaft_target_mm);
}
