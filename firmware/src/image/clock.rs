//! Clocks: 168 MHz from the ST-LINK's 8 MHz, or from the internal 16 MHz when that does not come;
//! then without USB.

use embassy_stm32::time::Hertz;
use embassy_stm32::{Config, pac, rcc};

/// How long the 8 MHz may take to come, ms: both the ST-LINK and this chip start with the same
/// supply.
const START_MS: u32 = 500;

/// Core clocks of a millisecond before the PLL runs: the internal 16 MHz.
const CLOCKS_A_MS: u32 = 16_000;

/// Asks for the 8 MHz clock and waits for it, but not for ever as embassy does; false if it did not
/// come.
pub fn start_external() -> bool {
    pac::RCC.cr().modify(|w| w.set_hsebyp(true));
    pac::RCC.cr().modify(|w| w.set_hseon(true));
    for _ in 0..START_MS {
        if pac::RCC.cr().read().hserdy() {
            return true;
        }
        cortex_m::asm::delay(CLOCKS_A_MS);
    }
    false
}

/// 168 MHz for the core, 48 MHz for USB, 84 MHz for the converters and the PWM timers' bus. The
/// internal clock is good to 1 % at 25 degrees Celsius (data sheet, HSI characteristics): enough
/// for everything but USB, which asks for 0.25 %.
pub fn config(external: bool) -> Config {
    let mut config = Config::default();
    let prediv = if external {
        config.rcc.hse = Some(rcc::Hse { freq: Hertz(8_000_000), mode: rcc::HseMode::Bypass });
        config.rcc.pll_src = rcc::PllSource::HSE;
        rcc::PllPreDiv::DIV4
    } else {
        config.rcc.hsi = true;
        config.rcc.pll_src = rcc::PllSource::HSI;
        rcc::PllPreDiv::DIV8
    };
    config.rcc.pll = Some(rcc::Pll {
        prediv,
        mul: rcc::PllMul::MUL168,
        divp: Some(rcc::PllPDiv::DIV2),
        divq: Some(rcc::PllQDiv::DIV7),
        divr: None,
    });
    config.rcc.ahb_pre = rcc::AHBPrescaler::DIV1;
    config.rcc.apb1_pre = rcc::APBPrescaler::DIV4;
    config.rcc.apb2_pre = rcc::APBPrescaler::DIV2;
    config.rcc.sys = rcc::Sysclk::PLL1_P;
    config.rcc.mux.clk48sel = rcc::mux::Clk48sel::PLL1_Q;
    config
}

/// From now on a loss of the 8 MHz clock is an NMI (RM0090 section 6.2.7).
pub fn guard() {
    pac::RCC.cr().modify(|w| w.set_csson(true));
}
