//! What ends a run: panic, HardFault, NMI (the clock), a sagging supply, an interrupt without a
//! handler. All take the same way: outputs off, a record for the next start, the red lamp, and a
//! reset by the watchdog.
#![allow(unsafe_code)]

use core::panic::PanicInfo;

use crate::trace::End;
use cortex_m::peripheral::SCB;
use cortex_m_rt::{ExceptionFrame, exception};
use embassy_stm32::interrupt;
use embassy_stm32::pac;
use embassy_stm32::pac::iwdg::vals::Key;

use super::{interlock, lamp, record, supply};

/// Ends the run.
fn end(end: &End) -> ! {
    interlock::outputs_off();
    cortex_m::interrupt::disable();
    record::end(end);
    lamp::red();
    // Before the control task has started it: its reset values are 0.5 s.
    pac::IWDG.kr().write(|w| w.set_key(Key::START));
    loop {
        cortex_m::asm::nop();
    }
}

#[panic_handler]
fn panic(info: &PanicInfo<'_>) -> ! {
    // Without the message: printing it would pull in the formatting of every type it could hold.
    let (file, line) = info.location().map_or(("", 0), |place| (place.file(), place.line()));
    end(&End::panic(file, line))
}

#[exception]
unsafe fn HardFault(frame: &ExceptionFrame) -> ! {
    // SAFETY: a read of a register that has no side effects.
    let cfsr = unsafe { (*SCB::PTR).cfsr.read() };
    end(&End::HardFault { pc: frame.pc(), lr: frame.lr(), cfsr })
}

/// The clock security system: the 8 MHz clock has stopped, and the core runs on the internal 16
/// MHz.
#[exception]
unsafe fn NonMaskableInt() -> ! {
    // Or this handler would be entered again for ever (RM0090 section 6.2.7).
    pac::RCC.cir().modify(|w| w.set_cssc(true));
    end(&End::ClockLost)
}

#[exception]
unsafe fn DefaultHandler(number: i16) -> ! {
    end(&End::Interrupt { number: number.into() })
}

#[interrupt]
fn PVD() {
    if supply::is_low() {
        end(&End::SupplyLow)
    }
}
