//! Outputs off when nothing else works: panic and HardFault.
#![allow(unsafe_code)]

use core::panic::PanicInfo;

use cortex_m_rt::{ExceptionFrame, exception};
use defmt_rtt as _;
use embassy_stm32::pac;

/// Switches every power output off by registers alone, whatever state the drivers are in: master outputs of TIM1 (actuator) and
/// TIM8 (coil) disabled, which floats the pins (pulled down on the board), arm-run pin low.
pub fn outputs_off() {
    pac::TIM1.bdtr().modify(|w| w.set_moe(false));
    pac::TIM8.bdtr().modify(|w| w.set_moe(false));
    pac::GPIOD.bsrr().write(|w| w.set_br(14, true));
}

/// Waits for the watchdog, which resets the board and thereby reports itself; before the watchdog runs, forever.
fn wait_for_reset() -> ! {
    loop {
        cortex_m::asm::nop();
    }
}

#[panic_handler]
fn panic(_info: &PanicInfo<'_>) -> ! {
    cortex_m::interrupt::disable();
    outputs_off();
    // Without the message: printing it would pull in the formatting of every type it could hold.
    defmt::error!("panic: outputs off, waiting for the watchdog");
    wait_for_reset()
}

#[exception]
unsafe fn HardFault(_frame: &ExceptionFrame) -> ! {
    outputs_off();
    wait_for_reset()
}

defmt::timestamp!("{=u64:us}", embassy_time::Instant::now().as_micros());
