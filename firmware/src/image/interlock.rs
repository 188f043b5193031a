//! The interlock's hands: the only owner of TIM1's and TIM8's main outputs and of the arm's pin, and the only
//! place that feeds the watchdog. What it decides is in [`crate::interlock`].
#![allow(unsafe_code)]

use core::cell::RefCell;
use core::sync::atomic::{AtomicU32, Ordering};

use crate::interlock::{Interlock, POLL_HZ, Power, TASKS, Task, Trip};
use embassy_stm32::interrupt::{InterruptExt, Priority};
use embassy_stm32::pac::iwdg::vals::Key;
use embassy_stm32::peripherals::{IWDG, TIM7};
use embassy_stm32::time::Hertz;
use embassy_stm32::timer::low_level::{RoundTo, Timer};
use embassy_stm32::wdg::IndependentWatchdog;
use embassy_stm32::{Peri, interrupt, pac};
use embassy_sync::blocking_mutex::Mutex;
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;

/// Time the watchdog waits, us. It runs on the chip's RC oscillator, 17 to 47 kHz where 32 kHz are typical (data
/// sheet of the STM32F429, LSI characteristics): 6.8 to 18.8 ms. It bounds what the poll cannot see, masked
/// interrupts; the poll feeds it every millisecond.
const WATCHDOG_US: u32 = 10_000;

static INTERLOCK: Mutex<CriticalSectionRawMutex, RefCell<Interlock>> = Mutex::new(RefCell::new(Interlock::new()));

/// Turns of the watched tasks.
static TURNS: [AtomicU32; TASKS] = [const { AtomicU32::new(0) }; TASKS];

/// A task shows that it lives.
pub fn turn(task: Task) {
    if let Some(turns) = TURNS.get(task as usize) {
        turns.fetch_add(1, Ordering::Relaxed);
    }
}

/// Switches every power output off by registers alone, whatever state the drivers are in: main outputs of TIM1
/// (actuator) and TIM8 (coil) disabled, which floats the pins (pulled down on the board), arm-run pin low.
pub fn outputs_off() {
    pac::TIM1.bdtr().modify(|w| w.set_moe(false));
    pac::TIM8.bdtr().modify(|w| w.set_moe(false));
    pac::GPIOD.bsrr().write(|w| w.set_br(ARM_PIN, true));
}

/// The arm's run input is PD14.
const ARM_PIN: usize = 14;

/// Switches off what is not among the outputs of `power`.
fn others_off(power: Power) {
    if !power.actuator {
        pac::TIM1.bdtr().modify(|w| w.set_moe(false));
    }
    if !power.coil {
        pac::TIM8.bdtr().modify(|w| w.set_moe(false));
    }
    if !power.arm {
        pac::GPIOD.bsrr().write(|w| w.set_br(ARM_PIN, true));
    }
}

/// Switches on the outputs of `power`.
fn outputs_on(power: Power) {
    if power.actuator {
        pac::TIM1.bdtr().modify(|w| w.set_moe(true));
    }
    if power.coil {
        pac::TIM8.bdtr().modify(|w| w.set_moe(true));
    }
    if power.arm {
        pac::GPIOD.bsrr().write(|w| w.set_bs(ARM_PIN, true));
    }
}

/// Starts the poll and the watchdog, for ever. Tasks that this board does not run are not watched.
///
/// The poll comes before every other interrupt, and no driver sets a priority of its own: so all others are set
/// one step lower first.
pub fn start(timer: Peri<'static, TIM7>, watchdog: Peri<'static, IWDG>, absent: &[Task]) {
    outputs_off();
    INTERLOCK.lock(|cell| absent.iter().for_each(|task| cell.borrow_mut().unwatch(*task)));
    interrupt::TIM5.set_priority(Priority::P1);
    interrupt::DMA2_STREAM0.set_priority(Priority::P1);
    interrupt::OTG_FS.set_priority(Priority::P2);
    interrupt::USART3.set_priority(Priority::P2);
    let poll = Timer::new(timer);
    poll.set_frequency(Hertz(POLL_HZ), RoundTo::Slower);
    // The prescaler counts from an update on; the driver makes none.
    poll.generate_update_event();
    poll.clear_update_interrupt();
    poll.enable_update_interrupt(true);
    poll.start();
    interrupt::TIM7.set_priority(Priority::P0);
    // SAFETY: the handler below shares its state through a critical section only.
    unsafe { interrupt::TIM7.enable() };
    // A timer that is dropped stops.
    core::mem::forget(poll);
    IndependentWatchdog::new(watchdog, WATCHDOG_US).unleash();
}

#[interrupt]
fn TIM7() {
    pac::TIM7.sr().modify(|w| w.set_uif(false));
    let turns = TURNS.each_ref().map(|turns| turns.load(Ordering::Relaxed));
    let poll = INTERLOCK.lock(|cell| {
        let poll = cell.borrow_mut().poll(&turns);
        if poll.off {
            outputs_off();
        }
        poll
    });
    if poll.feed {
        pac::IWDG.kr().write(|w| w.set_key(Key::RESET));
    }
}

/// The end of a control tick: what it does not want goes off; for what it wants on there is a permit, if it was
/// punctual. A tick that wants outputs but was not punctual switches nothing on: the last permit ends by itself.
pub fn end_of_tick(power: Power, punctual: bool) {
    INTERLOCK.lock(|cell| {
        let mut interlock = cell.borrow_mut();
        others_off(power);
        if !power.is_on() {
            interlock.rest();
        } else if punctual && interlock.grant() {
            outputs_on(power);
        }
    });
}

/// Why a permit has ended by itself, or was refused, since the board rested.
pub fn trip() -> Option<Trip> {
    INTERLOCK.lock(|cell| cell.borrow().trip())
}
