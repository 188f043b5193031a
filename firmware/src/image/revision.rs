//! Chips before revision 3: a signal at PA12 (USB) disturbs reads of flash bank 2, where the tables
//! are (ES0206 section 2.2.11). There USB stays off; why, and why not the tables:
//! `docs/decisions/0010-old-silicon.md`.

use embassy_stm32::Peri;
use embassy_stm32::gpio::{Level, Output, Speed};
use embassy_stm32::pac;
use embassy_stm32::pac::gpio::vals::Pupdr;
use embassy_stm32::peripherals::PA12;

/// REV_ID of revision 3 (RM0090 section 38.6.1).
const REVISION_3: u16 = 0x2001;

/// Revision code of the chip.
pub fn code() -> u16 {
    pac::DBGMCU.idcode().read().rev_id()
}

/// True if USB and the tables in bank 2 exclude each other.
pub fn is_old() -> bool {
    code() < REVISION_3
}

/// Keeps PA12 still, whatever a cable does: driven low with the pull-down on, as embassy's check
/// asks.
pub fn quieten(pin: Peri<'static, PA12>) {
    core::mem::forget(Output::new(pin, Level::Low, Speed::Low));
    pac::GPIOA.pupdr().modify(|w| w.set_pupdr(12, Pupdr::PULL_DOWN));
}
