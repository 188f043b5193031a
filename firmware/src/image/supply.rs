//! The voltage detector: outputs off when the 3.3 V sag, before flash and clocks are out of their
//! range.

use embassy_stm32::interrupt;
use embassy_stm32::interrupt::{InterruptExt, Priority};
use embassy_stm32::pac;

/// PLS 0b110: 2.85 to 2.99 V falling, 2.96 to 3.10 V rising (data sheet, power control block).
/// Below 2.7 V neither flash at 5 wait states nor programming by words is allowed.
const LEVEL: u8 = 0b110;

/// EXTI line of the detector (RM0090 section 12.2.5).
const LINE: usize = 16;

/// From now on a supply below the level is an interrupt, also one that is low already.
pub fn guard() {
    // The detector's output rises when the supply falls, and when it is switched on with the supply
    // low.
    pac::EXTI.rtsr(0).modify(|w| w.set_line(LINE, true));
    pac::PWR.cr1().modify(|w| {
        w.set_pls(LEVEL);
        w.set_pvde(true);
    });
    pac::EXTI.imr(0).modify(|w| w.set_line(LINE, true));
    interrupt::PVD.set_priority(Priority::P0);
    // SAFETY: its handler is in place, and shares nothing with what it interrupts.
    #[allow(unsafe_code)]
    unsafe {
        interrupt::PVD.enable();
    }
}

/// Takes the interrupt; true if the supply is low, and it was no glitch of the detector.
pub fn is_low() -> bool {
    pac::EXTI.pr(0).write(|w| w.set_line(LINE, true));
    pac::PWR.csr1().read().pvdo()
}
