//! The emulated board: image, chip and bench as one thing, with what can go wrong.

use std::cell::RefCell;
use std::path::Path;
use std::rc::Rc;

use palpate::plant::{Bench, Broken, Foam, Input, Jitter, Touch};

use crate::chip::{FLASH_BASE, Pins, Reset};
use crate::core::{Core, CoreError, Deed, Trap};
use crate::elf::{ElfError, Image};
use crate::jumpers::Jumpers;
use crate::surroundings::{SharedBench, Surroundings};
use crate::time::{MICROSECOND, MILLISECOND, Time, seconds};

/// Offset in the flash of bank 2, which holds the tables.
pub const BANK_2: usize = (palpate::flash::TABLE_ADDRESS - FLASH_BASE as u64) as usize;

/// The chip's RC oscillator, which the watchdog counts: typical, Hz (STM32F429 data sheet, LSI characteristics).
pub const LSI_HZ: u64 = 32_000;

/// The slowest and the fastest that the data sheet allows, Hz.
pub const LSI_RANGE_HZ: (u64, u64) = (17_000, 47_000);

/// The board could not be made or run.
#[derive(Debug, thiserror::Error)]
pub enum EmulatorError {
    /// The image cannot be used.
    #[error(transparent)]
    Image(#[from] ElfError),
    /// The CPU emulator failed.
    #[error(transparent)]
    Core(#[from] CoreError),
}

/// A task of the image in which a fault is injected.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Task {
    /// 50 Hz.
    Control,
    /// 1 kHz.
    Sampling,
    /// Bytes from the UART.
    UartReceive,
    /// Bytes from USB.
    UsbReceive,
}

impl Task {
    /// Name of its future in the image's debug information.
    const fn name(self) -> &'static str {
        match self {
            Task::Control => "image::control::__run_task",
            Task::Sampling => "image::sampling::__run_task",
            Task::UartReceive => "image::serial::__receive_task",
            Task::UsbReceive => "image::usb::__receive_task",
        }
    }
}

/// Image, chip and bench.
pub struct EmulatedBoard {
    image: Image,
    core: Core,
    bench: SharedBench,
}

impl EmulatedBoard {
    /// A board with the image of an ELF file, its power just come, on an empty bench; the same seed is the same bench as that of
    /// [`palpate::simulated_board::SimulatedBoard::new`].
    ///
    /// # Errors
    /// [`EmulatorError`].
    pub fn open(elf: &Path, seed: u64, jitter: Jitter) -> Result<Self, EmulatorError> {
        EmulatedBoard::new(Image::read(elf)?, seed, jitter, LSI_HZ)
    }

    /// The same with a loaded image and another frequency of the chip's RC oscillator, Hz.
    ///
    /// # Errors
    /// [`EmulatorError`].
    pub fn new(image: Image, seed: u64, jitter: Jitter, lsi_hz: u64) -> Result<Self, EmulatorError> {
        let bench = Rc::new(RefCell::new(Bench::new(seed, jitter)));
        let core = Core::new(&image, Box::new(Surroundings::new(Rc::clone(&bench))), lsi_hz)?;
        Ok(EmulatedBoard { image, core, bench })
    }

    /// A bare NUCLEO with wires from pin to pin, and no bench.
    ///
    /// # Errors
    /// [`EmulatorError`].
    pub fn bare(image: Image, jumpers: Jumpers, lsi_hz: u64) -> Result<Self, EmulatorError> {
        let core = Core::new(&image, Box::new(jumpers), lsi_hz)?;
        // Stays unconnected.
        let bench = Rc::new(RefCell::new(Bench::new(0, Jitter::NONE)));
        Ok(EmulatedBoard { image, core, bench })
    }

    /// Virtual time since the power came, s.
    pub fn time_s(&self) -> f64 {
        seconds(self.core.chip().now)
    }

    /// Lets 1 ms pass.
    ///
    /// # Errors
    /// [`EmulatorError::Core`].
    pub fn step(&mut self) -> Result<(), EmulatorError> {
        let until = (self.core.chip().now / MILLISECOND + 1) * MILLISECOND;
        Ok(self.core.run(until)?)
    }

    /// Lets time pass.
    ///
    /// # Errors
    /// [`EmulatorError::Core`].
    pub fn run_s(&mut self, duration_s: f64) -> Result<(), EmulatorError> {
        let until = self.core.chip().now + (duration_s * crate::time::SECOND as f64) as Time;
        Ok(self.core.run(until)?)
    }

    /// Puts bytes on the UART's line to the board; they arrive at 115200 baud.
    pub fn receive(&mut self, bytes: &[u8]) {
        self.core.chip_mut().feed(bytes);
    }

    /// Bytes that the UART has sent since the last call.
    pub fn take_transmit(&mut self) -> Vec<u8> {
        self.core.chip_mut().take_sent()
    }

    /// State of the pins that drive something.
    pub fn pins(&self) -> Pins {
        self.core.chip().pins()
    }

    /// Resets since the start with their times, s; the first is the power coming.
    pub fn resets(&self) -> Vec<(f64, Reset)> {
        self.core.resets().iter().map(|(at, cause)| (seconds(*at), *cause)).collect()
    }

    /// Control ticks since the last reset.
    pub fn ticks(&self) -> u64 {
        // The first write of the register switches the arm's set point off at start.
        self.core.chip().ticks.saturating_sub(1)
    }

    /// Millisecond means of the readings that have begun since the last reset.
    pub fn halves(&self) -> u64 {
        self.core.chip().halves
    }

    /// Runs until the next control tick has set its outputs, to 20 us; false if none does within `limit_s`.
    ///
    /// # Errors
    /// [`EmulatorError::Core`].
    pub fn run_to_tick(&mut self, limit_s: f64) -> Result<bool, EmulatorError> {
        let (before, end_s) = (self.core.chip().ticks.max(1), self.time_s() + limit_s);
        while self.core.chip().ticks == before || self.core.chip().ticks < 2 {
            if self.time_s() > end_s {
                return Ok(false);
            }
            let until = self.core.chip().now + 20 * MICROSECOND;
            self.core.run(until)?;
        }
        Ok(true)
    }

    /// The core, for what has no name here.
    pub fn core(&mut self) -> &mut Core {
        &mut self.core
    }

    /// Lays a foam under the probe; see [`Bench::place`].
    pub fn place(&mut self, foam: Foam) {
        self.bench.borrow_mut().place(foam);
    }

    /// Starts pressing the display, or lifts the finger.
    pub fn touch(&mut self, touch: Option<Touch>) {
        self.bench.borrow_mut().touch(touch);
    }

    /// Breaks a sensor, or mends it.
    pub fn set_broken(&mut self, input: Input, broken: Option<Broken>) {
        self.bench.borrow_mut().set_broken(input, broken);
    }

    /// Stops the converter, or lets it go on.
    pub fn set_adc_dead(&mut self, dead: bool) {
        self.core.chip_mut().set_adc_dead(dead);
    }

    /// Injects a fault when the program next polls a task; true if the image's debug information names the task.
    ///
    /// # Errors
    /// [`EmulatorError::Core`].
    pub fn inject(&mut self, task: Task, deed: Deed) -> Result<bool, EmulatorError> {
        let Some(address) = self.image.poll_of(task.name()) else {
            return Ok(false);
        };
        self.core.set_trap(Some(Trap { address, deed }))?;
        Ok(true)
    }

    /// Takes the power away and gives it back: RAM is lost, flash stays.
    ///
    /// # Errors
    /// [`EmulatorError::Core`].
    pub fn power_cycle(&mut self, cause: Reset) -> Result<(), EmulatorError> {
        Ok(self.core.restart(cause)?)
    }

    /// Content of the flash.
    ///
    /// # Errors
    /// [`EmulatorError::Core`].
    pub fn flash(&self) -> Result<Vec<u8>, EmulatorError> {
        Ok(self.core.flash()?)
    }
}
