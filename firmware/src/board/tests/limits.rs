//! Where a limit begins, and numbers that are none.

use super::*;
use crate::sensor::DEFAULT_CALIBRATION;
use protocol::fault::Fault;

const SHOW: Mode = Mode::Display { material: 2 };

fn at_mm(shaft_mm: f32) -> f32 {
    potentiometer_ratio(shaft_mm, &DEFAULT_CALIBRATION.potentiometer)
}

/// Faults of a board in a mode after a tick with such inputs, and after one more without a reading.
fn faults_in(mode: Mode, spoil: fn(&mut Inputs)) -> [Vec<Fault>; 2] {
    let mut bench = Bench::new();
    bench.tick();
    bench.mode(mode);
    bench.spoil = spoil;
    bench.tick();
    let at_once = bench.faults();
    bench.spoil = |i| i.fresh = false;
    bench.tick();
    [at_once, bench.faults()]
}

/// A shaft that is near its end may have passed it before the next reading comes: 0.3 mm a tick, if it is driven.
#[test]
fn the_stroke_ends_at_its_limits_and_earlier_without_readings() {
    let out = || vec![Fault::StrokeLimit];
    assert_eq!(faults_in(SHOW, |i| i.raw.potentiometer = at_mm(20.6)), [out(), out()]);
    assert_eq!(faults_in(SHOW, |i| i.raw.potentiometer = at_mm(20.4)), [vec![], out()]);
    assert_eq!(faults_in(SHOW, |i| i.raw.potentiometer = at_mm(20.1)), [vec![], vec![]]);
    assert_eq!(faults_in(SHOW, |i| i.raw.potentiometer = at_mm(-1.1)), [out(), out()]);
    assert_eq!(faults_in(SHOW, |i| i.raw.potentiometer = at_mm(-0.9)), [vec![], out()]);
    assert_eq!(faults_in(SHOW, |i| i.raw.potentiometer = at_mm(-0.6)), [vec![], vec![]]);
    assert_eq!(faults_in(Mode::Idle, |i| i.raw.potentiometer = at_mm(20.4)), [vec![], vec![]]);
}

#[test]
fn an_output_that_is_not_a_number_is_not_put_out_and_is_a_fault() {
    let mut bench = Bench::new();
    bench.mode(PALPATE);
    bench.board.machine.mode.palpating = crate::mode::Palpating::pressing_at(f32::NAN);
    bench.tick();
    assert_eq!(bench.outputs, Outputs::default());
    bench.tick();
    assert!(bench.faults().contains(&Fault::NotFinite));
}

#[test]
fn a_temperature_that_is_not_a_number_switches_off() {
    let mut bench = Bench::new();
    bench.mode(SHOW);
    bench.board.machine.coil_c = f32::NAN;
    bench.tick();
    assert_eq!((bench.outputs, bench.faults()), (Outputs::default(), vec![Fault::NotFinite]));
}

/// 40 mm/s are 0.8 mm a tick, and 4.5 mm what the actuator holds.
#[test]
fn the_display_goes_no_farther_and_no_faster_than_its_limits() {
    let mut bench = Bench::new();
    bench.finger_n = 8.0;
    bench.mode(SHOW);
    let (mut last_mm, mut most_mm) = (0.0f32, 0.0f32);
    for _ in 0..40 {
        bench.tick();
        let target_mm = bench.board.machine.shaft_target_mm;
        assert!((target_mm - last_mm).abs() < 0.801, "from {last_mm} to {target_mm} mm");
        (last_mm, most_mm) = (target_mm, most_mm.max(target_mm));
    }
    assert_eq!(most_mm, 4.5);
}

/// Two ticks in three without what they need.
#[test]
fn overruns_and_missing_readings_with_a_sound_tick_in_three_are_no_fault() {
    let cases: [fn(&mut Inputs); 2] = [|i| i.adc_overrun = true, |i| i.fresh = false];
    for spoil in cases {
        let mut bench = Bench::new();
        bench.tick();
        bench.mode(SHOW);
        for tick in 0..15 {
            bench.spoil = if tick % 3 == 2 { |_| {} } else { spoil };
            bench.tick();
        }
        assert_eq!((bench.faults(), bench.board.state()), (vec![], State::Display));
    }
}

#[test]
fn a_fault_of_the_start_is_latched_until_a_person_has_seen_it() {
    let mut bench = Bench::new();
    bench.board.latch(Fault::UsbOff);
    assert!(bench.board.is_faulted());
    bench.tick();
    assert_eq!((bench.faults(), bench.board.state()), (vec![Fault::UsbOff], State::Fault));
    assert_eq!(bench.refusal(&set_mode(SHOW)), Refusal::Faulted);
    bench.accept(&Request::ClearFaults(Empty {}));
    bench.tick();
    bench.mode(SHOW);
}
