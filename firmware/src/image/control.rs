//! The 50 Hz task: board, outputs, links, watchdog.

use core::sync::atomic::{AtomicU32, Ordering};

use embassy_futures::select::{Either, select};
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_sync::pipe::Pipe;
use embassy_time::{Duration, Instant, Ticker};
use firmware::board::{Board, Inputs};
use protocol::message::State;

use super::flash::BoardFlash;
use super::outputs::{Actuator, Arm};
use super::watchdog::Watchdog;
use super::{FAST, Link, PACKET_LEN, RECEIVED, TO_UART, TO_USB, debugger, record, sampling, stop};

/// Ticks within which sampling and links must have shown themselves: two turns of a link that is silent.
const CHECK_IN_TICKS: u32 = 5;

/// Turns of the receiving tasks of both links, which also turn when nothing arrives.
pub static USB_TURNS: AtomicU32 = AtomicU32::new(0);
/// See [`USB_TURNS`].
pub static UART_TURNS: AtomicU32 = AtomicU32::new(0);

/// Sees whether a counter moves.
struct CheckIn {
    last: u32,
    silent: u32,
}

impl CheckIn {
    const fn new() -> Self {
        CheckIn { last: 0, silent: 0 }
    }

    /// True while the counter has moved within the last ticks.
    fn alive(&mut self, counter: &AtomicU32) -> bool {
        let now = counter.load(Ordering::Relaxed);
        self.silent = if now == self.last { self.silent.saturating_add(1) } else { 0 };
        self.last = now;
        self.silent <= CHECK_IN_TICKS
    }
}

/// Between ticks bytes of the links are carried out as they come. The watchdog is fed here and nowhere else, and only while
/// sampling and the receiving tasks of both links turn. While outputs are on a missing check-in switches them off at once, and a missing sampling
/// always: by registers, as the task that drives them may be the one that hangs, and nothing turns them on again before the reset that follows. A hang
/// of this task itself leaves them on for as long as the watchdog waits.
#[embassy_executor::task]
pub async fn run(
    board: &'static mut Board<BoardFlash>,
    mut actuator: Actuator,
    mut arm: Arm,
    mut watchdog: Watchdog,
    has_uart: bool,
) -> ! {
    let mut ticker = Ticker::every(Duration::from_hz(u64::from(protocol::TICK_HZ)));
    let (mut sampled, mut usb, mut uart) = (CheckIn::new(), CheckIn::new(), CheckIn::new());
    let mut link = Link::Usb;
    let mut tick_us = 0;
    let period = Duration::from_hz(u64::from(protocol::TICK_HZ));
    let mut previous = Instant::now();
    let mut given_up = false;
    watchdog.start();
    defmt::info!("board started");
    loop {
        match select(ticker.next(), RECEIVED.receive()).await {
            Either::First(()) => {
                let begin = Instant::now();
                // The check of a large table can take several periods. Ticks that were missed are not made up for: a burst of them
                // would find no fresh readings, and control counts on 20 ms between two.
                if begin.duration_since(previous) > period * 2 {
                    ticker.reset();
                }
                previous = begin;
                let averaged = FAST.lock(|cell| cell.borrow_mut().as_mut().map(|fast| fast.take()));
                let overrun = sampling::OVERRUN.swap(false, Ordering::Relaxed);
                let inputs = Inputs::from_fast(&averaged.unwrap_or_default(), overrun, tick_us);
                let outputs = board.tick(&inputs);
                let on = matches!(board.state(), State::Approach | State::Contact | State::Display);
                record::state(board.state());
                if on {
                    debugger::keep_safe();
                }
                watchdog.set_outputs_on(on);
                FAST.lock(|cell| {
                    if let Some(fast) = cell.borrow_mut().as_mut() {
                        fast.set_target_a(outputs.coil_target_a);
                    }
                });
                actuator.set_v(outputs.actuator_v);
                arm.set(outputs.arm_run, outputs.arm_rate_mm_s);
                let us = begin.elapsed().as_micros();
                tick_us = u16::try_from(us).unwrap_or(u16::MAX);
                // All three are looked at in every tick, or a counter would be compared with an old one.
                let alive =
                    [sampled.alive(&sampling::TURNS), usb.alive(&USB_TURNS), uart.alive(&UART_TURNS) || !has_uart];
                // The coil's switch is in the hands of the sampling task, whatever this board wants.
                if !alive[0] || on && alive != [true; 3] {
                    stop::outputs_off();
                    given_up = true;
                } else if alive == [true; 3] && !given_up {
                    watchdog.feed();
                }
            }
            Either::Second(packet) => {
                if packet.link != link {
                    // Ends whatever the other link has left unfinished.
                    board.receive(&[0]);
                    link = packet.link;
                }
                board.receive(&packet.bytes);
            }
        }
        match link {
            Link::Usb => pass_on(board, &TO_USB),
            Link::Uart => pass_on(board, &TO_UART),
        }
    }
}

/// Moves what the pipe has room for; the rest stays in the board's queue.
fn pass_on<const N: usize>(board: &mut Board<BoardFlash>, pipe: &Pipe<CriticalSectionRawMutex, N>) {
    let mut bytes = [0; PACKET_LEN];
    loop {
        let room = pipe.free_capacity().min(bytes.len());
        let Some(chunk) = bytes.get_mut(..room).filter(|c| !c.is_empty()) else {
            return;
        };
        let count = board.take_transmit(chunk);
        let Some(chunk) = chunk.get(..count).filter(|c| !c.is_empty()) else {
            return;
        };
        // There is room for all of it and nobody else writes, but one write ends where the pipe's ring wraps.
        let mut rest = chunk;
        while !rest.is_empty() {
            let Ok(written) = pipe.try_write(rest) else {
                return;
            };
            rest = rest.get(written..).unwrap_or(&[]);
        }
    }
}
