use super::*;
use crate::testbed::{LIBRARY, REACHABLE_N};
use protocol::message::{Shown, Surface};

fn palpate(bench: &mut Bench, foam: Foam, rate_mm_s: f32) -> protocol::message::Verdict {
    bench.foam = Some(foam);
    bench.reports.clear();
    bench.mode(Mode::Palpate { rate_mm_s, depth_mm: 3.5 });
    bench.run_until(4000, |b| b.verdict().is_some());
    bench.verdict().unwrap().clone()
}

#[test]
fn four_foams_are_pressed_identified_and_released() {
    let mut bench = Bench::new();
    for (i, foam) in LIBRARY.iter().take(4).enumerate() {
        bench.probe_mm = foam.height_mm as f32 + 4.0;
        bench.home_mm = bench.probe_mm;
        let verdict = palpate(&mut bench, *foam, 2.0);
        assert_eq!(verdict.outcome, Outcome::Identified);
        assert_eq!(usize::from(verdict.material.index), i, "{verdict:?}");
        assert_eq!(verdict.palpation, i as u32 + 1);
        assert!((f64::from(verdict.height_mm) - foam.height_mm).abs() < 0.03, "{}", verdict.height_mm);
        assert_eq!((verdict.tick_max_us, verdict.tick_mean_us), (400, 400.0));
        assert_eq!(bench.board.state(), State::Idle);
        assert_eq!(bench.outputs, Outputs::default());
        assert!(bench.faults().is_empty());
    }
}

#[test]
fn depth_and_state_are_in_the_telemetry() {
    let mut bench = Bench::new();
    bench.accept(&Request::SetTelemetry(protocol::message::TelemetryRate { divider: 1 }));
    bench.probe_mm = LIBRARY[0].height_mm as f32 + 3.0;
    palpate(&mut bench, LIBRARY[0], 4.0);
    let records: Vec<&Telemetry> =
        bench.reports.iter().filter_map(|r| if let Report::Telemetry(t) = r { Some(t) } else { None }).collect();
    for pair in records.windows(2) {
        assert_eq!(pair[1].tick, pair[0].tick + 1);
    }
    let states: Vec<State> = [State::Approach, State::Contact, State::Retract]
        .into_iter()
        .filter(|s| records.iter().any(|t| t.state == *s))
        .collect();
    assert_eq!(states.len(), 3);
    let deepest = records.iter().map(|t| t.depth_mm).fold(0.0, f32::max);
    // One more step of 0.08 mm than asked, and the contact estimate.
    assert!((3.5..3.7).contains(&deepest), "{deepest}");
    assert!(records.iter().any(|t| t.state == State::Contact && t.search_error_n > 0.0));
}

#[test]
fn nothing_under_the_probe_is_no_contact() {
    let mut bench = Bench::new();
    bench.probe_mm = 6.0;
    bench.mode(PALPATE);
    bench.run_until(4000, |b| b.verdict().is_some());
    assert_eq!(bench.verdict().unwrap().outcome, Outcome::NoContact);
    assert!(bench.probe_mm >= 1.0);
}

/// A table that knows no height has no lowest surface: the travel ends 1 mm above the base.
#[test]
fn without_a_lowest_surface_a_press_ends_at_the_end_of_the_travel() {
    let mut bank = vec![0xff; BANK_LEN];
    let table = crate::testbed::expanded_table(12.7);
    bank[..table.len()].copy_from_slice(&table);
    let mut bench = Bench::with_flash(bank, ResetCause::PowerOn);
    bench.probe_mm = 3.0;
    bench.mode(PALPATE);
    bench.run_until(100, |b| b.board.state() == State::Retract);
    // A tick of 0.08 mm.
    let lowest_mm = bench.board.measured().probe_mm;
    assert!((0.92..=1.0).contains(&lowest_mm), "{lowest_mm} mm");
}

#[test]
fn a_stated_surface_is_of_one_press() {
    let mut bench = Bench::new();
    (bench.probe_mm, bench.home_mm) = (17.0, 17.0);
    bench.accept(&Request::ExpectSurface(Surface { height_mm: 15.9 }));
    assert_eq!(palpate(&mut bench, LIBRARY[0], 4.0).outcome, Outcome::NoContact);
    assert_eq!(palpate(&mut bench, LIBRARY[0], 4.0).outcome, Outcome::Identified);
}

#[test]
fn a_stated_surface_ends_a_press_earlier_than_the_table_and_never_later() {
    let mut bench = Bench::new();
    bench.probe_mm = 20.0;
    bench.accept(&Request::ExpectSurface(Surface { height_mm: 3.0 }));
    bench.mode(PALPATE);
    bench.run_until(1000, |b| b.board.state() == State::Retract);
    // The table's lowest surface is at 12.7 mm.
    let lowest_mm = bench.board.measured().probe_mm;
    assert!((10.5..=10.7).contains(&lowest_mm), "{lowest_mm} mm");
}

#[test]
fn a_surface_is_stated_with_outputs_off_and_within_the_travel() {
    let mut bench = Bench::new();
    let stated = |height_mm: f32| Request::ExpectSurface(Surface { height_mm });
    for height_mm in [-5.0, 0.0, 1.0, 90.0, f32::NAN, f32::INFINITY] {
        assert_eq!(bench.refusal(&stated(height_mm)), Refusal::OutOfRange, "{height_mm} mm");
    }
    bench.accept(&stated(20.0));
    bench.mode(PALPATE);
    assert_eq!(bench.refusal(&stated(20.0)), Refusal::Busy);
}

#[test]
fn idle_stops_a_palpation_and_the_arm_returns_at_once() {
    let mut bench = Bench::new();
    bench.foam = Some(LIBRARY[0]);
    bench.probe_mm = 14.0;
    bench.mode(PALPATE);
    bench.run_until(100, |b| b.board.state() == State::Contact);
    bench.mode(Mode::Idle);
    bench.tick();
    assert!(!bench.outputs.arm_run);
    bench.run_until(500, |b| b.board.state() == State::Idle);
    assert_eq!(bench.verdict().unwrap().outcome, Outcome::Aborted);
}

#[test]
fn requests_that_cannot_be_carried_out_are_refused_with_the_reason() {
    let mut bench = Bench::blank();
    assert_eq!(bench.refusal(&set_mode(PALPATE)), Refusal::NoTable);
    let mut bench = Bench::new();
    for (rate_mm_s, depth_mm) in
        [(0.5, 3.0), (0.99, 3.0), (4.01, 3.0), (8.0, 3.0), (2.0, 4.5), (2.0, 0.1), (f32::NAN, 3.0), (2.0, f32::NAN)]
    {
        let mode = Mode::Palpate { rate_mm_s, depth_mm };
        assert_eq!(bench.refusal(&set_mode(mode)), Refusal::OutOfRange, "{rate_mm_s} {depth_mm}");
    }
    assert_eq!(bench.refusal(&set_mode(Mode::Display { material: 8 })), Refusal::OutOfRange);
    bench.mode(PALPATE);
    bench.tick();
    let other = Mode::Palpate { rate_mm_s: 1.0, depth_mm: 3.5 };
    assert_eq!(bench.refusal(&set_mode(other)), Refusal::Busy);
    // The same again is a repeated request.
    bench.mode(PALPATE);
    assert_eq!(bench.refusal(&Request::Tare(Empty {})), Refusal::Busy);
    let begin = Request::TableBegin(protocol::message::TableBegin { length: 1000, crc: 0 });
    assert_eq!(bench.refusal(&begin), Refusal::Busy);
    let calibration = Request::SetCalibration(crate::sensor::DEFAULT_CALIBRATION);
    assert_eq!(bench.refusal(&calibration), Refusal::Busy);
}

#[test]
fn display_follows_the_finger_and_lets_go_in_idle() {
    let mut bench = Bench::new();
    bench.finger_n = 1.0;
    bench.mode(Mode::Display { material: 2 });
    bench.ticks(45);
    let shown = bench.outputs;
    // The table's displacement at 1 N is 1.709 mm; a second settles the loop to a twentieth of it.
    assert!((bench.shaft_mm - 1.709).abs() < 0.085 && shown.actuator_v > 0.0, "{} mm", bench.shaft_mm);
    // Half an ampere a newton; the FSR reads the force within 2 %.
    assert!((shown.coil_target_a - 0.5).abs() < 0.01 && shown.coil_duty > 0.0, "{}", shown.coil_target_a);
    bench.mode(Mode::Idle);
    bench.tick();
    assert_eq!(bench.outputs, Outputs::default());
}

#[test]
fn beyond_what_the_magnet_reaches_the_current_is_held_and_every_tick_says_so() {
    let mut bench = Bench::new();
    bench.mode(Mode::Display { material: 2 });
    let (mut within, mut beyond) = (0, 0);
    for i in 0..100 {
        bench.finger_n = 0.05 * i as f32;
        if i % 25 == 0 {
            bench.send(&Request::Status(Empty {}));
        }
        bench.tick();
        let record = bench.record();
        let (from, to) = REACHABLE_N;
        // 1e-4 A is far above the rounding of the table's counts. Below its threshold the sensor tells nothing.
        let least_n = crate::sensor::least_n(&bench.board.machine.calibration.fsr);
        let wanted_a = 0.5 * record.fsr_n.max(least_n).clamp(from as f32, to as f32);
        assert!((record.coil_target_a - wanted_a).abs() < 1e-4, "{record:?}");
        if record.fsr_n > 0.0 {
            let outside = !(from as f32..=to as f32).contains(&record.fsr_n);
            // 1.709 mm a newton, and a stroke of 4.5 mm.
            let shaft_limited = 1.709 * record.fsr_n > 4.5;
            let shown = Shown { unreachable: outside, shaft_limited, ..Shown::default() };
            assert_eq!(record.shown, shown, "{record:?}");
            if outside { beyond += 1 } else { within += 1 }
        } else {
            assert_eq!(record.shown, Shown::default());
        }
        assert!(bench.faults().is_empty(), "it is no fault");
    }
    assert!(within > 50 && beyond > 10, "{within} within, {beyond} beyond");
    bench.mode(Mode::Idle);
    bench.tick();
    assert_eq!(bench.record().shown, Shown::default());
}

#[test]
fn a_material_without_control_curve_is_displayed_by_the_actuator_alone_and_the_ticks_say_so() {
    let mut bench = Bench::new();
    bench.finger_n = 1.0;
    bench.mode(Mode::Display { material: 6 });
    bench.ticks(45);
    let record = bench.record();
    assert_eq!(record.shown, Shown { actuator_only: true, ..Shown::default() });
    assert_eq!((record.coil_target_a, bench.outputs.coil_duty), (0.0, 0.0));
    assert!(bench.outputs.actuator_v > 0.0 && record.shaft_target_mm > 0.0);
}

#[test]
fn calibration_and_tare_survive_a_restart() {
    let mut bench = Bench::new();
    let mut calibration = crate::sensor::DEFAULT_CALIBRATION;
    calibration.fsr.slope = 0.08;
    bench.tick();
    bench.accept(&Request::SetCalibration(calibration.clone()));
    bench.foam = Some(Foam { name: "weight", mu_mpa: 0.01, alpha: 5.0, height_mm: 31.0 });
    bench.tick();
    let force_n = bench.board.measured().load_cell_n;
    assert!(force_n > 0.01);
    bench.accept(&Request::Tare(Empty {}));
    bench.tick();
    assert!(bench.board.measured().load_cell_n.abs() < 1e-5);
    calibration.load_cell.zero_ratio = bench.board.machine.calibration.load_cell.zero_ratio;
    let identity = bench.board.machine.identity.clone();
    let again = Board::new(BoardConfig::default(), bench.board.into_store(), identity);
    assert_eq!(again.machine.calibration, calibration);
    let mut bench = Bench::new();
    let mut useless = crate::sensor::DEFAULT_CALIBRATION;
    useless.load_cell.n_per_ratio = f32::NAN;
    assert_eq!(bench.refusal(&Request::SetCalibration(useless)), Refusal::OutOfRange);
}
