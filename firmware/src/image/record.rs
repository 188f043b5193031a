//! The record of this run in RAM, and that of the last one ([`crate::trace`]).
#![allow(unsafe_code)]

use core::cell::UnsafeCell;
use core::sync::atomic::{AtomicU32, Ordering};

use crate::trace::{End, Last, Trace};
use embassy_sync::once_lock::OnceLock;
use embassy_time::Instant;
use protocol::message::{LastRun, State, StateChange};

/// Not cleared by a reset, and not by the start.
struct Kept(UnsafeCell<Trace>);

// SAFETY: reached only through `with`, which lets nobody else run meanwhile.
unsafe impl Sync for Kept {}

#[unsafe(link_section = ".uninit.trace")]
static KEPT: Kept = Kept(UnsafeCell::new(Trace::EMPTY));

static LAST: OnceLock<Last> = OnceLock::new();

fn with<T>(act: impl FnOnce(&mut Trace) -> T) -> T {
    critical_section::with(|_| {
        let kept = KEPT.0.get();
        // SAFETY: interrupts are masked. NMI and HardFault are not, but do not return to what they
        // interrupted. Volatile: the words are not what the program last wrote, but what the last
        // run left.
        let mut trace = unsafe { kept.read_volatile() };
        let result = act(&mut trace);
        unsafe { kept.write_volatile(trace) };
        result
    })
}

/// Takes what the last run left and begins a new record; before anything that could end this run.
pub fn begin() {
    if let Some(last) = with(Trace::begin) {
        let _ = LAST.init(last);
    }
}

/// What the last run left; `None` after power has come.
pub fn last() -> Option<&'static Last> {
    LAST.try_get()
}

/// The same as it travels.
pub fn last_run() -> LastRun {
    last().map_or(LastRun::NONE, LastRun::from)
}

/// Writes what the last run left to the log.
pub fn log() {
    let Some(last) = last() else {
        return;
    };
    match &last.end {
        Some(End::Panic { file, line }) => defmt::error!("last run: panic at {=str}:{=u32}", file.as_str(), line),
        Some(End::HardFault { pc, lr, cfsr }) => {
            defmt::error!("last run: HardFault at {=u32:#x}, LR {=u32:#x}, CFSR {=u32:#x}", pc, lr, cfsr);
        }
        Some(End::ClockLost) => defmt::error!("last run: the 8 MHz clock stopped"),
        Some(End::SupplyLow) => defmt::error!("last run: the 3.3 V supply sagged"),
        Some(End::Interrupt { number }) => defmt::error!("last run: interrupt {=i32} without a handler", number),
        None => defmt::info!("last run: reset without a record of why"),
    }
    for change in &last.changes {
        defmt::info!("last run: {=u32} ms, state {=u8}", change.time_ms, change.state as u8);
    }
}

/// Notes the state after a tick, if it is another one than before.
pub fn state(state: State) {
    // No state's number: the first tick is a change.
    static BEFORE: AtomicU32 = AtomicU32::new(u32::MAX);
    if BEFORE.swap(state as u32, Ordering::Relaxed) != state as u32 {
        let time_ms = Instant::now().as_millis() as u32;
        with(|trace| trace.change(StateChange { time_ms, state }));
    }
}

/// Notes why the run ends.
pub fn end(end: &End) {
    with(|trace| trace.end(end));
}
