//! Permits that end, and runs that end badly: outputs go off in time, and the next run knows why.

use protocol::message::{Empty, ResetCause, RunEnd};
use protocol::selftest::{Identity, Report, Request, Way};

use super::{Check, SelftestError, Step, Talk};
use crate::link::Link;

/// Time from a permit to the actuator's pin, us: 40 ms less the poll it falls into, and a poll and the look at the pin more.
const PERMIT_US: (u32, u32) = (38_000, 41_500);

/// Longest time to the coil's pin, us: its wire's 100 nF discharge over 10 kOhm and the pin's pull-down, 6.5 ms at most.
const COIL_US: u32 = 48_000;

/// Time of the watchdog with interrupts masked, us: 10 ms on an oscillator of 17 to 47 kHz where 32 are typical, fed at
/// most a millisecond before.
const WATCHDOG_US: (u32, u32) = (5_800, 18_900);

/// Life of a run whose control hangs with interrupts on, us: 1 s from the last turn of a link, which may be 50 ms old, and
/// the watchdog.
const HANG_US: (u32, u32) = (900_000, 1_100_000);

/// Every way.
pub(super) const WAYS: [Way; 4] = [Way::Hang, Way::HangMasked, Way::Panic, Way::HardFault];

/// A permit that is not renewed.
pub(super) fn interlock<L: Link>(talk: &mut Talk<L>) -> Result<Vec<Check>, SelftestError> {
    let Report::Released(released) = talk.ask(&Request::Release(Empty {}), 2.0)? else {
        return Err(talk.unexpected());
    };
    let after = |us: u32| if us == 0 { "never".into() } else { format!("{:.1} ms", ms(us)) };
    let (pin, coil) = (released.pin_low_us, released.coil_low_us);
    let new =
        |what: &str, found: String, expected: &str, passed| Check::new(Step::Interlock, what, found, expected, passed);
    Ok(vec![
        new("PE11 low after the last permit", after(pin), "38 to 41.5 ms", within(pin, PERMIT_US)),
        new(
            "PC6 low after the last permit",
            after(coil),
            "at most 48 ms, its capacitor",
            coil >= pin && coil <= COIL_US,
        ),
        new("trip reported", if released.told { "yes" } else { "no" }.into(), "yes", released.told),
    ])
}

fn within(us: u32, (least, most): (u32, u32)) -> bool {
    (least..=most).contains(&us)
}

/// Ends a run with coil and actuator on.
pub(super) fn end<L: Link>(talk: &mut Talk<L>, way: Way) -> Result<Vec<Check>, SelftestError> {
    let what = match way {
        Way::Hang => "control hangs",
        Way::HangMasked => "control hangs, interrupts masked",
        Way::Panic => "panic",
        Way::HardFault => "HardFault",
    };
    let Some(next) = talk.end(way)? else {
        let expected = "a reset within 5 s";
        return Ok(vec![Check::new(Step::Ends, what, "the program does not come back", expected, false)]);
    };
    let reset = next.reset_cause == ResetCause::Watchdog;
    let (found, expected, passed) = match way {
        Way::Hang => hung(&next),
        Way::HangMasked => masked(&next),
        Way::Panic => panicked(&next),
        Way::HardFault => faulted(&next),
    };
    Ok(vec![Check::new(
        Step::Ends,
        what,
        format!("{found}, then {}", if reset { "the watchdog's reset" } else { "a start without the watchdog" }),
        expected,
        passed && reset,
    )])
}

fn ms(us: u32) -> f64 {
    f64::from(us) / 1e3
}

fn hung(next: &Identity) -> (String, &'static str, bool) {
    let (low, alive) = (next.hang.pin_low_us, next.hang.alive_us);
    let passed = within(low, PERMIT_US) && within(alive, HANG_US);
    let found = if low == 0 { "PE11 never low".into() } else { format!("PE11 low after {:.1} ms", ms(low)) };
    (format!("{found}, alive for {:.0} ms", ms(alive)), "38 to 41.5 ms, 900 to 1100 ms, the watchdog", passed)
}

fn masked(next: &Identity) -> (String, &'static str, bool) {
    let alive = next.hang.alive_us;
    let passed = within(alive, WATCHDOG_US);
    (format!("alive for {:.1} ms", ms(alive)), "5.8 to 18.9 ms, the watchdog", passed)
}

fn panicked(next: &Identity) -> (String, &'static str, bool) {
    let file = String::from_utf8_lossy(&next.last_run.file).into_owned();
    match next.last_run.end {
        RunEnd::Panic { line } => (
            format!("on record at {file}:{line}"),
            "its place in selftest.rs, the watchdog",
            file.ends_with("selftest.rs") && line > 0,
        ),
        other => (format!("on record: {other:?}"), "its place on record", false),
    }
}

/// Undefined instruction, in the usage fault's part of CFSR (ARMv7-M ARM, B3.2.15).
const UNDEFINED: u32 = 1 << 16;

fn faulted(next: &Identity) -> (String, &'static str, bool) {
    match next.last_run.end {
        RunEnd::HardFault { pc, cfsr, .. } => (
            format!("on record at {pc:#010x} with CFSR {cfsr:#x}"),
            "in flash, an undefined instruction, the watchdog",
            (0x0800_0000..0x080c_0000).contains(&pc) && cfsr & UNDEFINED != 0,
        ),
        other => (format!("on record: {other:?}"), "its place on record", false),
    }
}
