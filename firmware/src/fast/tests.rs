use super::*;
use crate::sensor::coil_ratio;

fn fast() -> FastLoop {
    FastLoop::new(&CoilCircuit::default(), &CoilShunt::default(), 2.7)
}

fn raw(coil_a: f32) -> RawSamples {
    RawSamples { coil_current: coil_ratio(coil_a, &CoilShunt::default()), fsr: 0.25, ..RawSamples::default() }
}

#[test]
fn readings_are_averaged_between_ticks() {
    let mut fast = fast();
    for fsr in [0.1, 0.2, 0.6] {
        fast.step(&RawSamples { fsr, ..raw(0.0) });
    }
    let averaged = fast.take();
    assert_eq!(averaged.count, 3);
    // f32 rounding of a sum of three.
    assert!((averaged.raw.fsr - 0.3).abs() < 1e-6);
    // Nothing new: the last reading, and a count that says so.
    let stale = fast.take();
    assert_eq!((stale.count, stale.raw.fsr), (0, 0.6));
}

#[test]
fn over_current_switches_off_in_three_milliseconds_and_is_told() {
    let mut fast = fast();
    fast.set_target_a(2.5);
    assert!(fast.step(&raw(1.0)) > 0.0);
    // A spike of two readings passes.
    assert!((0..2).all(|_| fast.step(&raw(3.0)) >= 0.0));
    assert!(fast.step(&raw(1.0)) > 0.0);
    let duties = [0, 1, 2].map(|_| fast.step(&raw(3.0)));
    assert_eq!(duties[2], 0.0);
    assert_eq!(fast.step(&raw(0.5)), 0.0);
    assert_eq!(fast.take().coil_trip, Some(Fault::CurrentLimit));
    assert_eq!(fast.step(&raw(0.5)), 0.0);
    assert_eq!(fast.take().coil_trip, None);
}

#[test]
fn a_dead_amplifier_and_a_reading_that_is_not_a_number_trip() {
    for coil_current in [0.0, 1.0, f32::NAN] {
        let mut fast = fast();
        fast.set_target_a(1.0);
        for _ in 0..3 {
            fast.step(&RawSamples { coil_current, ..raw(0.0) });
        }
        assert_eq!(fast.step(&raw(0.5)), 0.0);
        assert_eq!(fast.take().coil_trip, Some(Fault::CurrentLimit));
    }
}

/// A coil of `ohm` at the supply, under the loop, with the switch or the amplifier as `spoil` has them (current, duty to
/// applied duty and reading); the fault within `ms`, and when.
fn driven(ohm: f32, target_a: f32, ms: u32, spoil: impl Fn(f32, u32) -> (f32, Option<f32>)) -> Option<(Fault, u32)> {
    let (mut fast, mut current_a) = (fast(), 0.0f32);
    let circuit = CoilCircuit::default();
    for i in 0..ms {
        fast.set_target_a(target_a);
        let (applied, reading_a) = spoil(fast.duty, i);
        let rest_a = applied * circuit.supply_v / ohm;
        current_a = rest_a + (current_a - rest_a) * (-ohm / circuit.inductance_mh).exp();
        fast.step(&raw(reading_a.unwrap_or(current_a)));
        if let Some(fault) = fast.tripped {
            return Some((fault, i));
        }
        if i % FAST_STEPS == 19 {
            fast.take();
        }
    }
    None
}

/// Coils of 0 to 105 degrees at a supply that is up to 10 % off, read by an amplifier whose gain and zero are off.
#[test]
fn sound_coils_from_cold_to_hot_never_trip_at_any_target_or_step() {
    for (ohm, supply_v) in [(12.0, 36.0), (12.0, 39.6), (13.0, 36.0), (16.0, 36.0), (17.3, 36.0), (17.3, 32.4)] {
        for (gain, zero_a) in [(1.0, 0.0), (1.05, 0.15), (0.9, -0.1)] {
            for targets in [[2.5, 0.1], [0.1, 2.5], [2.5, 0.0], [1.0, 1.0]] {
                let mut current_a = 0.0f32;
                let mut fast = fast();
                for i in 0..4000 {
                    fast.set_target_a(targets[i / 200 % 2]);
                    // The board's reading is the mean over the step, which has some of the current before.
                    let rest_a = fast.duty * supply_v / ohm;
                    let next_a = rest_a + (current_a - rest_a) * (-ohm / 3.0f32).exp();
                    fast.step(&raw(gain * 0.5 * (current_a + next_a) + zero_a));
                    current_a = next_a;
                    assert_eq!(fast.tripped, None, "{ohm} ohm, {supply_v} V, {zero_a} A, {targets:?}, step {i}");
                    if i % 20 == 19 {
                        fast.take();
                    }
                }
            }
        }
    }
}

/// 36 V over 17.3 ohm are 2.08 A, which no over-current trip of 2.7 A sees.
#[test]
fn a_switch_that_does_not_open_is_told_in_twenty_milliseconds_hot_or_cold() {
    for ohm in [13.0, 17.3] {
        for target_a in [0.0, 0.5, 1.0, 1.5] {
            let found = driven(ohm, target_a, 200, |duty, ms| (if ms < 50 { duty } else { 1.0 }, None));
            let by =
                if ohm < 14.0 { [Fault::CoilUncommanded, Fault::CurrentLimit] } else { [Fault::CoilUncommanded; 2] };
            assert!(found.is_some_and(|(f, ms)| by.contains(&f) && ms <= 70), "{ohm} ohm, {target_a} A: {found:?}");
        }
    }
}

#[test]
fn an_open_coil_and_a_missing_supply_are_told_in_a_fifth_of_a_second() {
    for target_a in [0.4, 1.0, 2.0] {
        let found = driven(13.0, target_a, 400, |_, _| (0.0, None));
        assert!(found.is_some_and(|(f, ms)| f == Fault::CoilOpen && ms < 200), "{target_a} A: {found:?}");
    }
}

#[test]
fn a_supply_that_fails_for_sixty_milliseconds_again_and_again_is_no_open_coil() {
    let found = driven(13.0, 1.0, 2000, |duty, ms| (if ms % 100 < 60 { 0.0 } else { duty }, None));
    assert_eq!(found, None);
}

#[test]
fn a_current_that_no_duty_explains_is_told_from_three_tenths_of_an_ampere_on() {
    let told = |reading_a: f32| driven(13.0, 0.0, 200, |_, _| (0.0, Some(reading_a)));
    assert_eq!(told(0.29), None);
    assert_eq!(told(0.31), Some((Fault::CoilUncommanded, 9)));
}

/// Half the turns are shorted: the loop holds its current with a duty that is too small for it.
#[test]
fn shorted_turns_are_more_current_than_the_duty_gives() {
    for target_a in [1.0, 2.0] {
        let found = driven(6.0, target_a, 200, |duty, _| (duty, None));
        assert!(found.is_some_and(|(f, ms)| f == Fault::CoilUncommanded && ms < 50), "{target_a} A: {found:?}");
    }
}

/// An amplifier whose wire is off reads what it last read, or less: the duty stays below what the hottest coil needs for the target.
#[test]
fn a_reading_that_stands_does_not_drive_the_coil_beyond_what_a_hot_one_needs() {
    for target_a in [0.3, 0.6, 1.0] {
        let mut fast = fast();
        let mut most = 0.0f32;
        for i in 0..80 {
            fast.set_target_a(target_a);
            most = most.max(fast.step(&raw(0.5 * target_a)));
            if i % 20 == 19 {
                fast.take();
            }
        }
        assert!(most <= 1.65 * 13.0 / 36.0 * target_a + 1e-6, "{target_a} A: {most}");
    }
}

#[test]
fn a_control_loop_that_does_not_come_switches_the_coil_off() {
    let mut fast = fast();
    fast.set_target_a(1.0);
    let off = (0..200).position(|_| fast.step(&raw(0.5)) == 0.0);
    // 60 steps are tolerated.
    assert_eq!(off, Some(60));
    fast.take();
    assert!(fast.step(&raw(0.5)) > 0.0);
}
