//! Outputs off when nothing else works.

use defmt_rtt as _;
use embassy_stm32::pac;

/// Switches every power output off by registers alone, whatever state the drivers are in: master outputs of TIM1 (actuator) and
/// TIM8 (coil) disabled, which floats the pins (pulled down on the board), arm-run pin low.
pub fn outputs_off() {
    pac::TIM1.bdtr().modify(|w| w.set_moe(false));
    pac::TIM8.bdtr().modify(|w| w.set_moe(false));
    pac::GPIOD.bsrr().write(|w| w.set_br(14, true));
}

defmt::timestamp!("{=u64:us}", embassy_time::Instant::now().as_micros());
