//! A note in RAM of how long a run went on that hangs: no reset clears it, and the next start takes it.
#![allow(unsafe_code)]

use core::cell::UnsafeCell;

use embassy_stm32::pac;
use protocol::selftest::Hang;

/// "HANG", as a word, and the sum of the others at the end: what RAM holds after power has come is no note.
const MAGIC: u32 = 0x4841_4e47;
const NONE: Hang = Hang { pin_low_us: 0, alive_us: 0 };

struct Kept(UnsafeCell<[u32; 4]>);

// SAFETY: reached only through `write` and `take`: before the tasks run, and from the one that ends them.
unsafe impl Sync for Kept {}

#[unsafe(link_section = ".uninit.hang")]
static KEPT: Kept = Kept(UnsafeCell::new([0; 4]));

fn write(hang: &Hang) {
    let words = [MAGIC, hang.pin_low_us, hang.alive_us, hang.pin_low_us.wrapping_add(hang.alive_us)];
    // SAFETY: see `Kept`; volatile, because nothing of this run reads it.
    unsafe { KEPT.0.get().write_volatile(words) };
}

/// The last run's note; it is gone then.
pub fn take() -> Hang {
    // SAFETY: see `Kept`.
    let [magic, pin_low_us, alive_us, sum] = unsafe { KEPT.0.get().read_volatile() };
    write(&NONE);
    if magic == MAGIC && pin_low_us.wrapping_add(alive_us) == sum { Hang { pin_low_us, alive_us } } else { NONE }
}

/// Notes time and the pin until the chip is reset. The clock is the time driver's counter (TIM5, 1 MHz, 16 bit): it
/// runs on with interrupts masked.
pub fn until_reset(pin_is_low: impl Fn() -> bool) -> ! {
    let counter = || pac::TIM5.cnt().read() as u16;
    let (mut last, mut hang) = (counter(), NONE);
    loop {
        let now = counter();
        hang.alive_us = hang.alive_us.saturating_add(now.wrapping_sub(last).into());
        last = now;
        if hang.pin_low_us == 0 && pin_is_low() {
            hang.pin_low_us = hang.alive_us.max(1);
        }
        write(&hang);
    }
}
