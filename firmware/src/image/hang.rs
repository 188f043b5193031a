//! A note in RAM of how long a run went on that hangs: no reset clears it, and the next start takes it.
#![allow(unsafe_code)]

use core::cell::UnsafeCell;

use embassy_stm32::pac;
use protocol::selftest::Hang;

/// "HANG", as a word, and the sum of the others at the end: what RAM holds after power has come is no note, and neither
/// is one that the reset has torn.
const MAGIC: u32 = 0x4841_4e47;
const NONE: Hang = Hang { pin_low_us: 0, alive_us: 0 };

/// Two notes, written in turn: one of them is whole.
struct Kept(UnsafeCell<[[u32; 4]; 2]>);

// SAFETY: reached only through `write` and `take`: before the tasks run, and from the one that ends them.
unsafe impl Sync for Kept {}

#[unsafe(link_section = ".uninit.hang")]
static KEPT: Kept = Kept(UnsafeCell::new([[0; 4]; 2]));

fn write(which: usize, hang: &Hang) {
    let words = [MAGIC, hang.pin_low_us, hang.alive_us, hang.pin_low_us.wrapping_add(hang.alive_us)];
    // SAFETY: see `Kept`, and there are two; volatile, because nothing of this run reads it.
    unsafe { KEPT.0.get().cast::<[u32; 4]>().add(which & 1).write_volatile(words) };
}

/// The last run's later note that is whole; both are gone then.
pub fn take() -> Hang {
    // SAFETY: see `Kept`.
    let notes = unsafe { KEPT.0.get().read_volatile() };
    (0..2).for_each(|which| write(which, &NONE));
    let whole = notes.into_iter().filter_map(|[magic, pin_low_us, alive_us, sum]| {
        (magic == MAGIC && pin_low_us.wrapping_add(alive_us) == sum).then_some(Hang { pin_low_us, alive_us })
    });
    whole.max_by_key(|hang| hang.alive_us).unwrap_or(NONE)
}

/// Notes time and the pin until the chip is reset. The clock is the time driver's counter (TIM5, 1 MHz, 16 bit): it
/// runs on with interrupts masked.
pub fn until_reset(pin_is_low: impl Fn() -> bool) -> ! {
    let counter = || pac::TIM5.cnt().read() as u16;
    let (mut last, mut hang, mut turn) = (counter(), NONE, 0);
    loop {
        let now = counter();
        hang.alive_us = hang.alive_us.saturating_add(now.wrapping_sub(last).into());
        last = now;
        if hang.pin_low_us == 0 && pin_is_low() {
            hang.pin_low_us = hang.alive_us.max(1);
        }
        write(turn, &hang);
        turn ^= 1;
    }
}
