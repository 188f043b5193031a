//! The red lamp of the NUCLEO (LD3, PB14; UM1974 section 6.5): lit when something is wrong that the
//! link may not tell.

use embassy_stm32::pac;
use embassy_stm32::pac::gpio::vals::Moder;

/// Lights it, by registers: it must work when no driver does.
pub fn red() {
    pac::RCC.ahb1enr().modify(|w| w.set_gpioben(true));
    // The clock needs two cycles (ES0206 section 2.2.7); reading back waits for them.
    let _ = pac::RCC.ahb1enr().read();
    pac::GPIOB.bsrr().write(|w| w.set_bs(14, true));
    pac::GPIOB.moder().modify(|w| w.set_moder(14, Moder::OUTPUT));
}
