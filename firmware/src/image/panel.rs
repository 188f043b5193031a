//! The NUCLEO's lamps and its blue button (UM1974 sections 6.5 and 6.6): LD1 (PB0, green) blinks while control
//! ticks, LD2 (PB7, blue) is lit while outputs are on, LD3 (PB14, red) while a fault is latched. B1 (PC13) stops
//! what is under way, as `palpate board mode idle` does.

use crate::interlock::Power;
use embassy_stm32::Peri;
use embassy_stm32::gpio::{Input, Level, Output, Pull, Speed};
use embassy_stm32::peripherals::{PB0, PB7, PB14, PC13};

/// Ticks between two changes of the green lamp: it blinks once a second.
const BLINK_TICKS: u32 = 25;

/// Lamps and button.
pub struct Panel {
    alive: Output<'static>,
    on: Output<'static>,
    fault: Output<'static>,
    button: Input<'static>,
    ticks: u32,
}

impl Panel {
    /// All dark.
    pub fn new(
        alive: Peri<'static, PB0>,
        on: Peri<'static, PB7>,
        fault: Peri<'static, PB14>,
        button: Peri<'static, PC13>,
    ) -> Self {
        Panel {
            alive: Output::new(alive, Level::Low, Speed::Low),
            on: Output::new(on, Level::Low, Speed::Low),
            fault: Output::new(fault, Level::Low, Speed::Low),
            // Pressed is high. A button that is missing stops nothing: it is no emergency stop.
            button: Input::new(button, Pull::Down),
            ticks: 0,
        }
    }

    /// True while the button is pressed.
    pub fn stop_pressed(&self) -> bool {
        self.button.is_high()
    }

    /// One tick.
    pub fn show(&mut self, power: Power, faulted: bool) {
        self.ticks = self.ticks.wrapping_add(1);
        if self.ticks.is_multiple_of(BLINK_TICKS) {
            self.alive.toggle();
        }
        self.on.set_level(power.is_on().into());
        self.fault.set_level(faulted.into());
    }
}
