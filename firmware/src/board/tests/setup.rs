//! What a board is set up for: calibration and fitted parts.

use super::*;
use crate::flash::Setup;
use crate::sensor::{ALL_FITTED, DEFAULT_CALIBRATION};
use protocol::fault::Fault;
use protocol::message::{CalibrationState, Fitted, Status};

const DISPLAY_ALONE: Fitted = Fitted { palpator: false, actuator: true, coil: false };

fn status(bench: &mut Bench) -> Status {
    match bench.ask(&Request::Status(Empty {})) {
        Report::Status(status) => status,
        other => panic!("{other:?}"),
    }
}

/// The same flash in a board that starts anew.
fn restarted(bench: Bench) -> Bench {
    let identity = bench.board.machine.identity.clone();
    let mut again = Bench::new();
    again.board = Board::new(BoardConfig::default(), bench.board.into_store(), identity);
    again
}

#[test]
fn where_the_calibration_comes_from_is_told() {
    let mut bench = Bench::new();
    bench.tick();
    assert_eq!(status(&mut bench).calibration, CalibrationState::Default);
    bench.accept(&Request::SetCalibration(DEFAULT_CALIBRATION));
    assert_eq!(status(&mut bench).calibration, CalibrationState::Stored);
    let mut bench = restarted(bench);
    bench.tick();
    assert_eq!((status(&mut bench).calibration, bench.faults()), (CalibrationState::Stored, vec![]));
}

#[test]
fn a_calibration_that_does_not_read_back_is_a_fault_until_one_is_loaded() {
    let mut bench = Bench::new();
    bench.board.store_mut().tear_setup();
    let mut bench = restarted(bench);
    bench.tick();
    assert_eq!(bench.faults(), [Fault::CalibrationLost]);
    assert_eq!(status(&mut bench).calibration, CalibrationState::Unreadable);
    assert_eq!(bench.refusal(&set_mode(PALPATE)), Refusal::Faulted);
    assert_eq!(bench.refusal(&Request::ClearFaults(Empty {})), Refusal::CauseRemains);
    // A new zero, or a mask, on top of the firmware's own sensitivity would end the fault and not the error.
    assert_eq!(bench.refusal(&Request::Tare(Empty {})), Refusal::CalibrationLost);
    assert_eq!(bench.refusal(&Request::SetFitted(DISPLAY_ALONE)), Refusal::CalibrationLost);
    bench.accept(&Request::SetCalibration(DEFAULT_CALIBRATION));
    bench.tick();
    bench.accept(&Request::ClearFaults(Empty {}));
    bench.tick();
    bench.mode(PALPATE);
}

#[test]
fn a_stored_calibration_out_of_the_limits_is_as_good_as_lost() {
    let mut bench = Bench::new();
    let mut calibration = DEFAULT_CALIBRATION;
    calibration.load_cell.n_per_ratio = 100.0;
    bench.board.store_mut().save_setup(&Setup { calibration, fitted: ALL_FITTED }).unwrap();
    let mut bench = restarted(bench);
    bench.tick();
    assert_eq!(bench.faults(), [Fault::CalibrationLost]);
}

#[test]
fn what_is_stored_already_is_not_written_again() {
    let mut bench = Bench::new();
    bench.tick();
    let mut written = vec![];
    for request in [
        Request::SetCalibration(DEFAULT_CALIBRATION),
        Request::SetCalibration(DEFAULT_CALIBRATION),
        Request::Tare(Empty {}),
        Request::SetFitted(ALL_FITTED),
        Request::SetFitted(DISPLAY_ALONE),
    ] {
        let before = bench.board.store().operations();
        bench.accept(&request);
        written.push(bench.board.store().operations() - before);
    }
    assert_eq!(written, [1, 0, 0, 0, 1]);
}

/// A host that tares again and again finds a little noise each time.
#[test]
fn a_zero_that_has_moved_by_noise_alone_is_not_written() {
    let mut bench = Bench::new();
    bench.tick();
    bench.accept(&Request::SetCalibration(DEFAULT_CALIBRATION));
    let before = bench.board.store().operations();
    for spoil in [|i: &mut Inputs| i.raw.load_cell += 1e-5, |i: &mut Inputs| i.raw.load_cell -= 1e-5] {
        bench.spoil = spoil;
        bench.tick();
        bench.accept(&Request::Tare(Empty {}));
    }
    assert_eq!(bench.board.store().operations(), before);
}

#[test]
fn a_setup_that_cannot_be_stored_changes_nothing() {
    let mut bench = Bench::new();
    bench.tick();
    bench.board.store_mut().set_power(crate::flash::PowerCut::After(0));
    let mut calibration = DEFAULT_CALIBRATION;
    calibration.load_cell.n_per_ratio = 12.0;
    for request in [Request::SetCalibration(calibration), Request::SetFitted(DISPLAY_ALONE)] {
        assert_eq!(bench.refusal(&request), Refusal::FlashFailed);
    }
    let told = status(&mut bench);
    assert_eq!((told.calibration, told.fitted), (CalibrationState::Default, ALL_FITTED));
    assert_eq!(bench.ask(&Request::GetCalibration(Empty {})), Report::Calibration(DEFAULT_CALIBRATION));
}

#[test]
fn a_tare_needs_a_reading_of_this_tick() {
    let mut bench = Bench::new();
    assert_eq!(bench.refusal(&Request::Tare(Empty {})), Refusal::Busy);
    bench.tick();
    bench.spoil = |i| i.fresh = false;
    bench.tick();
    assert_eq!(bench.refusal(&Request::Tare(Empty {})), Refusal::Busy);
}

#[test]
fn a_calibration_and_a_tare_leave_the_mask() {
    let mut bench = Bench::new();
    bench.tick();
    bench.accept(&Request::SetFitted(DISPLAY_ALONE));
    bench.accept(&Request::SetCalibration(DEFAULT_CALIBRATION));
    bench.spoil = |i| i.raw.load_cell += 1e-3;
    bench.tick();
    bench.accept(&Request::Tare(Empty {}));
    assert_eq!(status(&mut bench).fitted, DISPLAY_ALONE);
    assert_eq!(status(&mut restarted(bench)).fitted, DISPLAY_ALONE);
}

/// The display of the thesis' chapter 5: FSR, potentiometer and actuator, nothing at the other pins.
#[test]
fn a_display_alone_works_without_dummy_dividers() {
    let mut bench = Bench::new();
    // Open pins with the resistors of the drawing, and a fast loop that has tripped on its own.
    bench.spoil = |i| {
        (i.raw.load_cell, i.raw.probe_position, i.raw.coil_current) = (0.0, 0.0, 0.0);
        i.coil_trip = Some(Fault::CurrentLimit);
    };
    bench.tick();
    assert_eq!(bench.faults(), [Fault::CurrentLimit, Fault::LoadCellOpen, Fault::ProbePositionOpen]);
    bench.accept(&Request::SetFitted(DISPLAY_ALONE));
    let mut bench = restarted(bench);
    bench.spoil = |i| {
        (i.raw.load_cell, i.raw.probe_position, i.raw.coil_current) = (0.0, 1.0, 0.9);
        i.coil_trip = Some(Fault::CurrentLimit);
    };
    bench.tick();
    assert_eq!((bench.faults(), status(&mut bench).fitted), (vec![], DISPLAY_ALONE));
    assert_eq!(bench.refusal(&set_mode(PALPATE)), Refusal::NoPalpator);
    bench.finger_n = 1.0;
    bench.mode(Mode::Display { material: 2 });
    for _ in 0..20 {
        bench.ticks(25);
        assert_eq!((bench.outputs.coil_target_a, bench.outputs.coil_duty), (0.0, 0.0));
        bench.send(&Request::Status(Empty {}));
    }
    assert!((bench.shaft_mm - 1.709).abs() < 0.085 && bench.faults().is_empty(), "{} mm", bench.shaft_mm);
    assert_eq!(bench.refusal(&Request::SetFitted(ALL_FITTED)), Refusal::Busy);
    // What is fitted is still looked at.
    bench.spoil = |i| i.raw.potentiometer = 1.0;
    bench.tick();
    assert!(bench.faults().contains(&Fault::PotentiometerOpen) && bench.outputs == Outputs::default());
}

#[test]
fn a_palpator_alone_presses_and_refuses_the_display() {
    let mut bench = Bench::new();
    bench.spoil = |i| (i.raw.fsr, i.raw.potentiometer, i.raw.coil_current) = (1.0, 0.0, 0.0);
    bench.tick();
    bench.accept(&Request::SetFitted(Fitted { palpator: true, actuator: false, coil: false }));
    bench.tick();
    bench.accept(&Request::ClearFaults(Empty {}));
    bench.tick();
    assert_eq!(bench.refusal(&set_mode(Mode::Display { material: 2 })), Refusal::NoDisplay);
    bench.mode(PALPATE);
    bench.ticks(5);
    assert!(bench.outputs.arm_run && bench.faults().is_empty(), "{:?}", bench.faults());
    let m = bench.board.measured();
    assert_eq!((m.fsr_n, m.shaft_mm, m.coil_a), (0.0, 0.0, 0.0));
}

/// What floats at a pin that nothing is wired to would be 8.5 N, and a shaft beyond its stroke.
#[test]
fn a_coil_alone_is_driven_and_nothing_else() {
    let mut bench = Bench::new();
    bench.spoil = |i| (i.raw.load_cell, i.raw.potentiometer, i.raw.probe_position) = (0.95, 0.0, 1.0);
    bench.tick();
    bench.accept(&Request::SetFitted(Fitted { palpator: false, actuator: false, coil: true }));
    bench.tick();
    bench.accept(&Request::ClearFaults(Empty {}));
    bench.tick();
    bench.finger_n = 1.0;
    bench.mode(Mode::Display { material: 2 });
    bench.ticks(20);
    assert!(bench.outputs.coil_target_a > 0.0 && bench.faults().is_empty(), "{:?}", bench.faults());
    assert_eq!(bench.outputs.actuator_v, 0.0);
    let m = bench.board.measured();
    assert_eq!((m.load_cell_n, m.shaft_mm, m.probe_mm), (0.0, 0.0, 0.0));
}
