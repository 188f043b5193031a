//! Outputs off when nothing else works: panic and HardFault.
#![allow(unsafe_code)]

use core::panic::PanicInfo;

use cortex_m_rt::{ExceptionFrame, exception};
use defmt_rtt as _;

pub use super::interlock::outputs_off;

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
