//! The peripherals of an STM32F429ZI that the image uses, in virtual time.
//!
//! Nothing happens between events: the core asks [`Chip::due`] when to look again and calls [`Chip::process`] then. Registers are addressed by
//! absolute address through [`Chip::read`] and [`Chip::write`]; what they change in memory (DMA, flash) is handed to the core as it owns the memory.

mod adc;
mod bus;
mod clock;
mod dbgmcu;
mod dma;
mod exti;
mod flash;
mod gpio;
mod nvic;
mod timer;
mod usart;
mod usb;
mod watchdog;

pub use adc::INPUTS;
pub use clock::Reset;
pub use flash::{Change, FLASH_LEN};
pub use nvic::{HARD_FAULT, NMI};

use crate::time::{MILLISECOND, Time};

use adc::Adc;
use clock::{Pwr, Rcc};
use dbgmcu::Dbgmcu;
use dma::Dma;
use exti::{Exti, PVD_LINE};
use flash::Flash;
use gpio::Port;
use nvic::Nvic;
use timer::Timer;
use usart::Usart;
use usb::Usb;
use watchdog::Watchdog;

/// Where flash begins.
pub const FLASH_BASE: u32 = 0x0800_0000;

/// Interrupt numbers (RM0090 table 63).
const PVD_IRQ: u32 = 1;
const USART3_IRQ: u32 = 39;
const TIM5_IRQ: u32 = 50;
const TIM7_IRQ: u32 = 55;
const DMA2_STREAM0_IRQ: u32 = 56;

/// Channels of a scan and scans of half the ring: what the plant's step of 1 ms covers.
const CHANNELS: u32 = 5;
const SCANS: u32 = 16;

/// State of the pins that drive something.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Pins {
    /// Duty of PE9 (TIM1 channel 1), 0 to 1.
    pub forward: f64,
    /// Duty of PE11 (TIM1 channel 2), 0 to 1.
    pub reverse: f64,
    /// Duty of PC6 (TIM8 channel 1), 0 to 1.
    pub coil: f64,
    /// PD14.
    pub arm_run: bool,
    /// Duty of PD15 (TIM4 channel 4), 0 to 1.
    pub arm_rate: f64,
}

impl Pins {
    /// True if none of them drives anything: bridge, coil switch and arm are off.
    pub fn off(&self) -> bool {
        self.forward == 0.0 && self.reverse == 0.0 && self.coil == 0.0 && !self.arm_run
    }
}

/// What is wired to the chip's pins.
pub trait Wiring {
    /// Lets 1 ms pass under the pins' state. `ticked`: the program has set its outputs of a new control tick since the last call.
    fn step(&mut self, pins: &Pins, ticked: bool);

    /// The same at the first of the 16 readings that the program takes the mean of.
    fn first_scan(&mut self, pins: &Pins, ticked: bool);

    /// True if what is wired to a pin of the port (A is 0) holds it high while nothing drives it.
    fn holds_high(&self, _port: usize, _pin: u32) -> bool {
        false
    }

    /// Voltages at the converter's inputs in codes, not rounded, for reading number `scan` (0 to 15) of the millisecond.
    fn voltages(&mut self, scan: u32) -> [f64; INPUTS];
}

/// The chip without its core and memory.
pub struct Chip {
    /// Virtual time.
    pub now: Time,
    /// When to look again; the core compares it with `now` once a block.
    pub due: Time,
    /// Halfwords that DMA has written since the core took them.
    pub dma_writes: Vec<(u32, u16)>,
    /// Changes of the flash since the core took them.
    pub flash_changes: Vec<Change>,
    /// The chip wants to be reset.
    pub reset: Option<Reset>,
    /// Control ticks that have set the outputs since the reset: writes to TIM4's fourth compare register, the last of a tick.
    pub ticks: u64,
    /// Halves of the ring that have begun since the reset.
    pub halves: u64,
    /// Interrupt controller.
    pub nvic: Nvic,
    rcc: Rcc,
    pwr: Pwr,
    dbgmcu: Dbgmcu,
    exti: Exti,
    flash: Flash,
    ports: [Port; 11],
    tim1: Timer,
    tim3: Timer,
    tim4: Timer,
    tim5: Timer,
    tim7: Timer,
    tim8: Timer,
    adc: Adc,
    dma2: Dma,
    usart: Usart,
    watchdog: Watchdog,
    usb: Usb,
    wiring: Box<dyn Wiring>,
    /// When the wiring steps at the latest.
    step_due: Time,
    stepped_ticks: u64,
}

impl Chip {
    /// A chip that has just been powered, with its RC oscillator at `lsi_hz`.
    pub fn new(wiring: Box<dyn Wiring>, lsi_hz: u64) -> Self {
        Chip {
            now: 0,
            due: 0,
            dma_writes: Vec::new(),
            flash_changes: Vec::new(),
            reset: None,
            ticks: 0,
            halves: 0,
            nvic: Nvic::new(),
            rcc: Rcc::new(Reset::Power, None),
            pwr: Pwr::default(),
            dbgmcu: Dbgmcu::new(),
            exti: Exti::default(),
            flash: Flash::new(),
            ports: [Port::default(); 11],
            tim1: Timer::new(2, true),
            tim3: Timer::new(4, false),
            tim4: Timer::new(4, false),
            tim5: Timer::new(4, false),
            tim7: Timer::new(4, false),
            tim8: Timer::new(2, true),
            adc: Adc::default(),
            dma2: Dma::default(),
            usart: Usart::new(),
            watchdog: Watchdog::new(lsi_hz),
            usb: Usb::default(),
            wiring,
            step_due: MILLISECOND,
            stepped_ticks: 0,
        }
    }

    /// Puts every register to its reset value; time, pins' wiring and what is injected stay.
    pub fn reset_to(&mut self, cause: Reset) {
        self.reset = None;
        self.ticks = 0;
        self.halves = 0;
        self.stepped_ticks = 0;
        self.nvic = Nvic::new();
        self.rcc = Rcc::new(cause, Some(&self.rcc));
        self.pwr.reset();
        if matches!(cause, Reset::Power | Reset::BrownOut) {
            self.dbgmcu.power_on();
        }
        self.exti = Exti::default();
        self.flash.reset();
        self.ports = [Port::default(); 11];
        self.tim1 = Timer::new(2, true);
        self.tim3 = Timer::new(4, false);
        self.tim4 = Timer::new(4, false);
        self.tim5 = Timer::new(4, false);
        self.tim7 = Timer::new(4, false);
        self.tim8 = Timer::new(2, true);
        let dead = self.adc.dead;
        self.adc = Adc::default();
        self.adc.dead = dead;
        self.dma2 = Dma::default();
        let sent = std::mem::take(&mut self.usart.sent);
        self.usart = Usart::new();
        self.usart.sent = sent;
        self.watchdog = Watchdog::new(self.watchdog.oscillator_hz());
        self.usb = Usb::default();
        self.update();
    }

    /// State of the driving pins.
    pub fn pins(&self) -> Pins {
        Pins {
            forward: self.tim1.duty(0),
            reverse: self.tim1.duty(1),
            coil: self.tim8.duty(0),
            arm_run: self.ports[3].high(14),
            arm_rate: self.tim4.duty(3),
        }
    }

    /// Core clock, Hz.
    pub fn core_hz(&self) -> u64 {
        self.rcc.core_hz()
    }

    /// Programs and erases of flash so far.
    pub fn flash_operations(&self) -> u64 {
        self.flash.operations
    }

    /// Breaches of the rules for the flash's caches since the chip was made.
    pub fn flash_violations(&self) -> u64 {
        self.flash.violations
    }

    /// True if every instruction waits for the flash.
    pub fn flash_is_slow(&self) -> bool {
        self.flash.is_slow()
    }

    /// Option bytes in place, in the places of OPTCR.
    pub fn options(&self) -> u32 {
        self.flash.options
    }

    /// Sets brown-out level 3, as a setup does.
    pub fn set_brown_out_3(&mut self) {
        self.flash.set_options(self.flash.options & !0b1100);
    }

    /// Injected fault: no program or erase succeeds any more.
    pub fn set_flash_broken(&mut self, broken: bool) {
        self.flash.broken = broken;
    }

    /// Sets the revision code of the chip: 0x1007 is revision 1, 0x2001 revision 3.
    pub fn set_revision(&mut self, revision: u16) {
        self.dbgmcu.revision = revision;
    }

    /// Injected fault: the 8 MHz clock stops, or does not come at the next start.
    pub fn set_external_clock_dead(&mut self, dead: bool) {
        self.rcc.set_external_dead(dead);
        self.update();
    }

    /// Injected fault: the supply falls below the level of the voltage detector, or is back.
    pub fn set_supply_low(&mut self, low: bool) {
        self.pwr.supply_low = low;
        self.update();
    }

    /// Conversions that DMA did not fetch, since the reset.
    pub fn converter_overruns(&self) -> u64 {
        self.adc.overruns
    }

    /// True if a pin of port A to K is a general-purpose output that is driven high.
    pub fn pin_is_high(&self, port: char, pin: u32) -> bool {
        self.ports[(port as usize).saturating_sub('A' as usize).min(10)].high(pin)
    }

    /// Puts bytes on the line to the board.
    pub fn feed(&mut self, bytes: &[u8]) {
        self.usart.feed(bytes, self.now);
        self.update();
    }

    /// Bytes that the board has sent since the last call.
    pub fn take_sent(&mut self) -> Vec<u8> {
        std::mem::take(&mut self.usart.sent)
    }

    /// Presses the blue button (PC13), or releases it.
    pub fn press_button(&mut self, pressed: bool) {
        self.ports[2].drive(13, pressed);
    }

    /// Injected fault: the converter no longer converts.
    pub fn set_adc_dead(&mut self, dead: bool) {
        self.adc.dead = dead;
        self.update();
    }

    /// Lets happen what is due now.
    pub fn process(&mut self) {
        let now = self.now;
        if self.watchdog.next_event().is_some_and(|at| at <= now) {
            self.reset = Some(Reset::Watchdog);
        }
        for code in self.adc.finish(now) {
            match self.dma2.request(0) {
                Some(address) => self.dma_writes.push((address, code)),
                None => self.adc.overrun(),
            }
        }
        if self.tim3.sync(now) > 0 && self.tim3.triggers() && self.adc.is_triggered() {
            self.scan();
        }
        self.tim5.sync(now);
        self.tim7.sync(now);
        self.usart.sync(now);
        if self.step_due <= now {
            self.step(false);
            self.step_due = now + MILLISECOND;
        }
        self.update();
    }

    fn step(&mut self, first_scan: bool) {
        let ticked = self.ticks != self.stepped_ticks;
        self.stepped_ticks = self.ticks;
        let pins = self.pins();
        if first_scan {
            self.wiring.first_scan(&pins, ticked);
        } else {
            self.wiring.step(&pins, ticked);
        }
    }

    /// Starts a scan. The first of half a ring begins a new millisecond of the surroundings, so that every mean of the
    /// program is one of their steps; while no scans come they go on by themselves.
    fn scan(&mut self) {
        let number = self.dma2.filled(0).unwrap_or(0) / CHANNELS % SCANS;
        if number == 0 {
            self.halves += 1;
            self.step(true);
            self.step_due = self.now + 3 * MILLISECOND / 2;
        }
        let voltages = self.wiring.voltages(number);
        self.adc.start(self.now, &voltages);
    }

    /// Works out interrupt lines and the next event anew.
    fn update(&mut self) {
        let line = |on: bool, number: u32| u128::from(on) << number;
        self.exti.set_level(PVD_LINE, self.pwr.supply_is_seen_low());
        self.nvic.nmi = self.rcc.nmi();
        self.nvic.set_lines(
            line(self.usart.line(), USART3_IRQ)
                | line(self.exti.line(PVD_LINE), PVD_IRQ)
                | line(self.tim5.line(), TIM5_IRQ)
                | line(self.tim7.line(), TIM7_IRQ)
                | line(self.dma2.line(0), DMA2_STREAM0_IRQ),
        );
        let events = [
            self.watchdog.next_event(),
            self.adc.next_event(),
            self.tim3.next_event(true),
            self.tim5.next_event(false),
            self.tim7.next_event(false),
            self.usart.next_event(),
            Some(self.step_due),
        ];
        self.due = events.into_iter().flatten().min().unwrap_or(Time::MAX);
        if self.nvic.reset_requested {
            self.reset = Some(Reset::Software);
        }
    }
}
