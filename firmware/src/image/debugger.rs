//! What a debugger may have set at its attach: OpenOCD and STM32CubeIDE stop the watchdog while the
//! core is halted.

use embassy_stm32::pac;

/// While outputs are on a halted core keeps its watchdog, and floats the outputs of TIM1 and TIM8
/// (RM0090 sections 38.16.2 and 38.16.4 to 5). PD14 stays as it is until the watchdog resets.
/// Called in every such tick: a debugger attaches when it likes.
pub fn keep_safe() {
    pac::DBGMCU.apb1fzr().modify(|w| w.set_iwdg(false));
    pac::DBGMCU.apb2fzr().modify(|w| {
        w.set_tim1(true);
        w.set_tim8(true);
    });
}
