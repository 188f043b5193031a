use super::*;
use crate::coil::winding::Winding;
use crate::sensor::coil_ratio;
use crate::testbed::SwitchedCoil;

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

/// Resistance of the ring at 20 and at 105 degrees, ohm.
const COLD: f32 = 5.115;
const HOT: f32 = 6.824;

/// A coil of `ohm` at the supply, under the loop, with the switch or the amplifier as `spoil` has
/// them (duty and time to applied duty and reading); the fault within `ms`, and when.
fn driven(ohm: f32, target_a: f32, ms: u32, spoil: impl Fn(f32, u32) -> (f32, Option<f32>)) -> Option<(Fault, u32)> {
    let mut fast = fast();
    let mut coil = SwitchedCoil::new(ohm, CoilCircuit::default().supply_v);
    for i in 0..ms {
        fast.set_target_a(target_a);
        let (applied, reading_a) = spoil(fast.duty, i);
        let current_a = coil.step(applied);
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

/// Coils of 0 to 105 degrees with their wiring at a supply that is up to 10 % off, with cores that
/// carry from a third of the flux to a quarter more, with a diode of 0.5 V, read by an amplifier
/// whose gain and zero are off.
#[test]
fn sound_coils_from_cold_to_hot_never_trip_at_any_target_or_step() {
    let ring = Winding::RING;
    let (coldest, hottest) = (0.95 * ring.ohm(0.0), 1.05 * ring.ohm(105.0) + 0.3);
    for (ohm, supply_v) in
        [(coldest, 15.0), (coldest, 16.5), (COLD, 15.0), (HOT, 15.0), (hottest, 15.0), (hottest, 13.5)]
    {
        for (gain, zero_a) in [(1.0, 0.0), (1.05, 0.15), (0.9, -0.1)] {
            for flux in [0.33, 1.0, 1.25] {
                for targets in [[2.5, 0.1], [0.1, 2.5], [2.5, 0.0], [1.0, 1.0], [0.6, 0.3]] {
                    let mut coil = SwitchedCoil { diode_v: 0.5, flux, ..SwitchedCoil::new(ohm, supply_v) };
                    let mut fast = fast();
                    for i in 0..2000 {
                        fast.set_target_a(targets[i / 200 % 2]);
                        fast.step(&raw(gain * coil.step(fast.duty) + zero_a));
                        let what =
                            format!("{ohm} ohm, {supply_v} V, {flux}, {gain}, {zero_a} A, {targets:?}, step {i}");
                        assert_eq!(fast.tripped, None, "{what}");
                        if i % 20 == 19 {
                            fast.take();
                        }
                    }
                }
            }
        }
    }
}

/// 15 V over 6.82 ohm are 2.20 A, which no over-current trip of 2.7 A sees; over 5.12 ohm they are
/// 2.93 A.
#[test]
fn a_switch_that_does_not_open_is_told_in_twenty_milliseconds_hot_or_cold() {
    for ohm in [COLD, HOT] {
        for target_a in [0.0, 0.5, 1.0, 1.5] {
            for from_ms in [10, 30, 50, 55] {
                let found = driven(ohm, target_a, 200, |duty, ms| (if ms < from_ms { duty } else { 1.0 }, None));
                println!("{ohm} ohm, {target_a} A, stuck at {from_ms} ms: {found:?}");
                let is_told = |f| f == Fault::CoilUncommanded || f == Fault::CurrentLimit && ohm == COLD;
                assert!(
                    found.is_some_and(|(f, ms)| is_told(f) && ms <= from_ms + 20),
                    "{ohm} ohm, {target_a} A: {found:?}"
                );
            }
        }
    }
}

/// A circuit of 36 V, where a stuck switch tends to 7 A: three readings above 2.7 A.
#[test]
fn a_stuck_switch_at_a_higher_supply_trips_by_its_current() {
    for ohm in [COLD, HOT] {
        for target_a in [0.0, 1.0, 2.5] {
            let circuit = CoilCircuit { supply_v: 36.0, ..CoilCircuit::default() };
            let mut fast = FastLoop::new(&circuit, &CoilShunt::default(), 2.7);
            let mut coil = SwitchedCoil::new(ohm, 36.0);
            let mut trip_ms = None;
            for i in 0..100 {
                fast.set_target_a(target_a);
                fast.step(&raw(coil.step(if i < 50 { fast.duty } else { 1.0 })));
                if i < 50 {
                    assert_eq!(fast.tripped, None, "{ohm} ohm, {target_a} A, {i} ms");
                } else if fast.tripped.is_some() && trip_ms.is_none() {
                    trip_ms = Some((fast.tripped, i - 50));
                }
                if i % 20 == 19 && trip_ms.is_none() {
                    fast.take();
                }
            }
            println!("{ohm} ohm, {target_a} A at 36 V: {trip_ms:?}");
            // 48 mWb at 36 V less the drop take 2 ms, and three readings are above.
            assert!(trip_ms.is_some_and(|(f, ms)| f == Some(Fault::CurrentLimit) && ms <= 6), "{ohm} ohm: {trip_ms:?}");
        }
    }
}

#[test]
fn an_open_coil_and_a_missing_supply_are_told_in_a_fifth_of_a_second() {
    for target_a in [0.4, 1.0, 2.0] {
        let found = driven(COLD, target_a, 400, |_, _| (0.0, None));
        assert!(found.is_some_and(|(f, ms)| f == Fault::CoilOpen && ms < 200), "{target_a} A: {found:?}");
    }
}

#[test]
fn a_supply_that_fails_for_sixty_milliseconds_again_and_again_is_no_open_coil() {
    let found = driven(COLD, 1.0, 2000, |duty, ms| (if ms % 100 < 60 { 0.0 } else { duty }, None));
    assert_eq!(found, None);
}

#[test]
fn a_current_that_no_duty_explains_is_told_from_three_tenths_of_an_ampere_on() {
    let told = |reading_a: f32| driven(COLD, 0.0, 200, |_, _| (0.0, Some(reading_a)));
    assert_eq!(told(0.29), None);
    assert_eq!(told(0.31), Some((Fault::CoilUncommanded, 9)));
}

/// Half the turns are shorted: the loop holds its current with a duty that is too small for it.
#[test]
fn shorted_turns_are_more_current_than_the_duty_gives() {
    for target_a in [1.0, 2.0] {
        let found = driven(0.46 * COLD, target_a, 200, |duty, _| (duty, None));
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
        assert!(most <= CoilCircuit::default().highest() * COLD / 15.0 * target_a + 1e-6, "{target_a} A: {most}");
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
