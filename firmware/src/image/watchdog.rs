//! The independent watchdog: short while outputs are on, longer while they are off.
//!
//! It runs on the chip's RC oscillator (17 to 47 kHz, typically 32 kHz, data sheet), so the time it waits is 0.68 to 1.88 of what is set.

use embassy_stm32::pac;
use embassy_stm32::pac::iwdg::vals::Key;
use embassy_stm32::peripherals::IWDG;
use embassy_stm32::wdg::IndependentWatchdog;
use embassy_stm32::{Peri, rcc};
use embassy_time::{Duration, Instant};

/// Time it waits while outputs are off, us: 25 ticks, and four times the longest check of a table when an upload is committed.
const OFF_US: u32 = 500_000;

/// Time it waits while outputs are on, us. With the slowest oscillator these are 188 ms: whatever hangs, outputs are off within 200 ms. With the
/// fastest they are 68 ms, and no tick may then take more than 18 ms.
const ON_US: u32 = 100_000;

/// Longest time until the reload register has been taken over: 5 clocks of the slowest oscillator are 0.3 ms (RM0090 section 21.3.3).
const UPDATE: Duration = Duration::from_micros(400);

/// Counts of the reload register for a time, with the prescaler of 4 that the driver chooses for [`OFF_US`].
const fn reload(us: u32) -> u16 {
    (us / 4 * (rcc::LSI_FREQ.0 / 1000) / 1000 - 1) as u16
}

/// The watchdog.
pub struct Watchdog {
    dog: IndependentWatchdog<'static, IWDG>,
    outputs_on: bool,
}

impl Watchdog {
    /// Takes the watchdog; it does not run yet.
    pub fn take(peripheral: Peri<'static, IWDG>) -> Self {
        Watchdog { dog: IndependentWatchdog::new(peripheral, OFF_US), outputs_on: false }
    }

    /// Starts it, for ever.
    pub fn start(&mut self) {
        self.dog.unleash();
    }

    /// Feeds it.
    pub fn feed(&mut self) {
        self.dog.pet();
    }

    /// Sets the time for outputs on or off; a change feeds it, and takes up to 0.4 ms. Called before outputs go on.
    pub fn set_outputs_on(&mut self, on: bool) {
        if on == self.outputs_on {
            return;
        }
        self.outputs_on = on;
        pac::IWDG.kr().write(|w| w.set_key(Key::ENABLE));
        pac::IWDG.rlr().write(|w| w.set_rl(reload(if on { ON_US } else { OFF_US })));
        // Feeding before the value is taken over would count from the old one.
        let begin = Instant::now();
        while pac::IWDG.sr().read().rvu() && begin.elapsed() < UPDATE {}
        self.dog.pet();
    }
}
