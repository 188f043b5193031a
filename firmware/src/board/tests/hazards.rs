//! One test for every row of `docs/safety.md` that the library proves.

use super::*;
use crate::testbed::LIBRARY;
use protocol::fault::Fault;

/// A bench with outputs on.
fn displaying() -> Bench {
    let mut bench = Bench::new();
    bench.finger_n = 1.0;
    bench.mode(Mode::Display { material: 2 });
    bench.ticks(5);
    assert!(bench.outputs.actuator_v > 0.0 && bench.outputs.coil_target_a > 0.0);
    bench
}

/// Ticks until outputs are off; returns how many it took.
fn ticks_to_off(bench: &mut Bench) -> usize {
    for i in 1..=200 {
        bench.tick();
        if bench.outputs == Outputs::default() {
            return i;
        }
    }
    panic!("outputs stay on");
}

fn trips(bench: &mut Bench, spoil: fn(&mut Inputs), fault: Fault, within: usize) {
    bench.spoil = spoil;
    bench.reports.clear();
    let ticks = ticks_to_off(bench);
    assert!(ticks <= within, "{fault:?} after {ticks} ticks");
    assert!(bench.faults().contains(&fault), "{:?}", bench.faults());
    assert_eq!(bench.board.state(), State::Fault);
    let reported = bench.reports.iter().any(|r| matches!(r, Report::Fault(f) if f.fault == fault as u8));
    assert!(reported, "{fault:?} was not reported");
}

#[test]
fn every_sensor_and_limit_fault_switches_off_within_its_ticks() {
    /// What is spoilt, what must trip, and within how many ticks.
    type Case = (fn(&mut Inputs), Fault, usize);
    let cases: [Case; 10] = [
        (|i| i.raw.load_cell = 0.95, Fault::ForceLimit, 1),
        (|i| i.raw.load_cell = 0.0, Fault::LoadCellOpen, 1),
        (|i| i.raw.fsr = 0.99, Fault::FsrShort, 1),
        (|i| i.raw.potentiometer = 1.0, Fault::PotentiometerOpen, 1),
        (|i| i.raw.probe_position = 0.0, Fault::ProbePositionOpen, 1),
        (|i| i.raw.potentiometer = 0.3, Fault::StrokeLimit, 1),
        (|i| i.raw.coil_current = 0.95, Fault::CurrentLimit, 1),
        (|i| i.raw.coil_current = 0.0, Fault::CurrentLimit, 1),
        (|i| i.coil_trip = Some(Fault::CurrentLimit), Fault::CurrentLimit, 1),
        (|i| i.adc_overrun = true, Fault::AdcOverrun, 3),
    ];
    for (spoil, fault, within) in cases {
        trips(&mut displaying(), spoil, fault, within);
    }
}

#[test]
fn stale_readings_switch_off_in_three_ticks_and_earlier_if_the_worst_case_is_over_the_limit() {
    trips(&mut displaying(), |i| i.fresh = false, Fault::SensorStale, 3);
    // 7.7 N and one tick of the steepest rise (20 N/s) is over 8 N.
    let mut bench = displaying();
    bench.spoil = |i| i.raw.load_cell = 0.87;
    bench.tick();
    assert!(bench.faults().is_empty());
    trips(&mut bench, |i| i.fresh = false, Fault::ForceLimit, 1);
}

#[test]
fn a_reading_that_is_not_a_number_switches_off() {
    let mut bench = displaying();
    bench.spoil = |i| i.raw.load_cell = f32::NAN;
    bench.tick();
    assert_eq!(bench.outputs, Outputs::default());
    assert!(bench.faults().contains(&Fault::NotFinite));
}

#[test]
fn a_silent_host_switches_off_after_a_second_and_a_talking_one_does_not() {
    let mut bench = displaying();
    for _ in 0..10 {
        bench.ticks(40);
        bench.send(&Request::Status(Empty {}));
    }
    assert!(bench.faults().is_empty());
    trips(&mut bench, |_| {}, Fault::LinkLost, 51);
    // In idle silence is no fault.
    let mut bench = Bench::new();
    bench.ticks(500);
    assert!(bench.faults().is_empty());
}

#[test]
fn a_late_tick_is_counted_and_is_a_fault_only_while_outputs_are_on() {
    let mut bench = Bench::new();
    bench.spoil = |i| i.tick_us = 19_000;
    bench.ticks(2);
    assert!(bench.faults().is_empty());
    let Report::Status(status) = bench.ask(&Request::Status(Empty {})) else { panic!() };
    assert_eq!((status.deadlines_missed, status.tick_max_us), (2, 19_000));
    assert!(bench.board.is_punctual(18_000) && !bench.board.is_punctual(18_001));
    trips(&mut displaying(), |i| i.tick_us = 19_000, Fault::DeadlineMissed, 1);
}

#[test]
fn the_stop_button_ends_what_is_under_way_and_refuses_more() {
    let mut bench = displaying();
    bench.spoil = |i| i.stop_pressed = true;
    bench.tick();
    assert_eq!((bench.outputs, bench.board.state(), bench.faults()), (Outputs::default(), State::Idle, vec![]));
    assert_eq!(bench.refusal(&set_mode(PALPATE)), Refusal::Stopped);
    bench.spoil = |_| {};
    bench.tick();
    bench.mode(PALPATE);
    bench.ticks(5);
    assert!(bench.outputs.arm_run);
    bench.spoil = |i| i.stop_pressed = true;
    bench.tick();
    assert_eq!((bench.outputs.arm_run, bench.board.state()), (false, State::Retract));
}

#[test]
fn lateness_is_measured_from_start_to_start() {
    let mut bench = Bench::new();
    bench.spoil = |i| i.period_us = 48_000;
    bench.ticks(3);
    assert!(bench.faults().is_empty());
    let Report::Status(status) = bench.ask(&Request::Status(Empty {})) else { panic!() };
    assert_eq!((status.ticks_late, status.period_max_us, status.deadlines_missed), (3, 48_000, 0));
    trips(&mut displaying(), |i| i.period_us = 30_001, Fault::DeadlineMissed, 1);
    // A tick that comes 10 ms late is still no hazard.
    let mut bench = displaying();
    bench.spoil = |i| i.period_us = 30_000;
    bench.ticks(5);
    assert_eq!(bench.faults(), []);
}

/// The outputs went off without the machine: it must not go on as if they were on.
#[test]
fn a_trip_of_the_interlock_is_a_fault_that_says_which_task_was_silent() {
    trips(&mut displaying(), |i| i.interlock = Some(crate::interlock::Trip::Silent(2)), Fault::Interlock, 1);
    let mut bench = displaying();
    bench.spoil = |i| i.interlock = Some(crate::interlock::Trip::Silent(2));
    bench.tick();
    let value = bench.reports.iter().find_map(|r| match r {
        Report::Fault(fault) => Some(fault.value),
        _ => None,
    });
    assert_eq!(value, Some(3.0));
}

#[test]
fn a_blocked_shaft_is_a_stall_after_two_seconds() {
    let mut bench = Bench::new();
    bench.finger_n = 2.5;
    bench.mode(Mode::Display { material: 2 });
    let ticks = bench.ticks_with_shaft_at(0.0);
    assert_eq!(bench.faults(), [Fault::ActuatorStall]);
    // The limit, and the ticks in which target and integral rise.
    assert!((100..200).contains(&ticks), "{ticks}");
}

#[test]
fn a_hot_coil_is_first_reduced_and_never_reaches_its_trip() {
    let mut bench = Bench::new();
    bench.finger_n = 3.0;
    bench.mode(Mode::Display { material: 0 });
    let mut hottest = 0.0f32;
    // Ten minutes.
    for i in 0..30_000 {
        if i % 25 == 0 {
            bench.send(&Request::Status(Empty {}));
        }
        bench.tick();
        hottest = hottest.max(bench.board.machine.coil_c);
        bench.reports.clear();
    }
    assert!(bench.faults().is_empty(), "{:?}", bench.faults());
    assert!((80.0..105.0).contains(&hottest), "{hottest}");
    // A coil that is hot all the same (a current nobody asked for) trips.
    bench.board.machine.coil_c = 106.0;
    bench.tick();
    assert_eq!(bench.faults(), [Fault::CoilHot]);
    assert_eq!(bench.outputs, Outputs::default());
}

#[test]
fn a_coil_is_taken_for_warm_after_a_reset() {
    // Its temperature before the reset is not known; a board that started cold would allow a hot winding full current.
    assert_eq!(Bench::new().board.machine.coil_c, 80.0);
}

#[test]
fn a_coil_whose_amplifier_reads_no_current_still_heats_in_the_model() {
    let mut bench = Bench::new();
    bench.finger_n = 3.0;
    // 5 % of the reference is the amplifier's zero: no rail, and exactly 0 A.
    bench.spoil = |i| i.raw.coil_current = 0.05;
    bench.mode(Mode::Display { material: 0 });
    for i in 0..500 {
        if i % 25 == 0 {
            bench.send(&Request::Status(Empty {}));
        }
        bench.tick();
        bench.reports.clear();
    }
    // Without current the model would cool from its 80 degrees.
    assert!(bench.board.machine.coil_c > 81.0, "{}", bench.board.machine.coil_c);
}

#[test]
fn faults_stay_latched_until_they_are_cleared_with_the_cause_gone() {
    let mut bench = displaying();
    trips(&mut bench, |i| i.raw.load_cell = 0.0, Fault::LoadCellOpen, 1);
    assert_eq!(bench.refusal(&Request::ClearFaults(Empty {})), Refusal::CauseRemains);
    bench.spoil = |_| {};
    bench.ticks(10);
    assert_eq!(bench.faults(), [Fault::LoadCellOpen]);
    assert_eq!(bench.refusal(&set_mode(PALPATE)), Refusal::Faulted);
    bench.accept(&Request::ClearFaults(Empty {}));
    bench.tick();
    assert_eq!(bench.board.state(), State::Idle);
    assert_eq!(bench.outputs, Outputs::default());
    bench.mode(PALPATE);
}

#[test]
fn a_fault_during_a_palpation_lifts_the_arm_and_ends_it_as_aborted() {
    let mut bench = Bench::new();
    bench.foam = Some(LIBRARY[0]);
    bench.probe_mm = 14.0;
    bench.mode(PALPATE);
    bench.run_until(200, |b| b.board.state() == State::Contact);
    trips(&mut bench, |i| i.raw.probe_position = 0.0, Fault::ProbePositionOpen, 1);
    assert!(!bench.outputs.arm_run);
    assert_eq!(bench.verdict().unwrap().outcome, Outcome::Aborted);
}

#[test]
fn too_hard_a_specimen_ends_the_palpation_before_the_force_limit() {
    let mut bench = Bench::new();
    bench.foam = Some(Foam { name: "hard", mu_mpa: 2.0, alpha: 2.0, height_mm: 12.7 });
    bench.probe_mm = 15.0;
    bench.mode(Mode::Palpate { rate_mm_s: 1.0, depth_mm: 3.5 });
    let mut peak = 0.0f32;
    bench.run_until(2000, |b| b.board.state() == State::Retract);
    peak = peak.max(bench.board.measured().load_cell_n);
    assert!(bench.faults().is_empty() && peak < 8.0, "{peak}");
    bench.run_until(2000, |b| b.verdict().is_some());
    assert_eq!(bench.verdict().unwrap().outcome, Outcome::TooShort);
}

#[test]
fn a_broken_table_at_start_is_a_fault_until_a_good_one_is_uploaded() {
    let mut bank = vec![0xff; BANK_LEN];
    let table = factored_table();
    bank[..table.len()].copy_from_slice(&table);
    bank[2000] ^= 1;
    let mut bench = Bench::with_flash(bank, ResetCause::PowerOn);
    bench.tick();
    assert_eq!(bench.faults(), [Fault::TableInvalid]);
    assert_eq!(bench.refusal(&Request::ClearFaults(Empty {})), Refusal::CauseRemains);
    let begin =
        protocol::message::TableBegin { length: table.len() as u32, crc: protocol::frame::CRC32.checksum(&table) };
    bench.send(&Request::TableBegin(begin));
    bench.ticks(20);
    for (i, piece) in table.chunks(192).enumerate() {
        let chunk =
            protocol::message::TableChunk { offset: (i * 192) as u32, data: heapless::Vec::from_slice(piece).unwrap() };
        bench.send(&Request::TableChunk(chunk));
    }
    assert!(matches!(bench.ask(&Request::TableCommit(Empty {})), Report::TableState(_)));
    bench.tick();
    bench.accept(&Request::ClearFaults(Empty {}));
    assert!(bench.faults().is_empty());
}

#[test]
fn a_watchdog_reset_is_told_at_the_next_start() {
    let mut bench = Bench::with_flash(vec![0xff; BANK_LEN], ResetCause::Watchdog);
    assert_eq!(bench.refusal(&set_mode(PALPATE)), Refusal::Faulted);
    bench.tick();
    assert_eq!(bench.faults(), [Fault::WatchdogReset]);
    bench.accept(&Request::ClearFaults(Empty {}));
    bench.tick();
    assert_eq!(bench.board.state(), State::Idle);
}
