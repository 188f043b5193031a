//! The 50 Hz task: board, outputs, links.

use core::sync::atomic::Ordering;

use crate::board::{Board, Inputs};
use crate::interlock::Task;
use crate::link::LinkId;
use embassy_futures::select::{Either, select};
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_sync::pipe::Pipe;
use embassy_time::{Duration, Instant, Ticker};

use super::flash::BoardFlash;
use super::outputs::{Actuator, Arm};
use super::panel::Panel;
use super::{FAST, PACKET_LEN, RECEIVED, TO_UART, TO_USB, debugger, interlock, record, sampling};

/// Between ticks bytes of the links are carried out as they come. The end of a tick is where the interlock gets
/// its permit; without one outputs go off within 40 ms, whatever hangs.
#[embassy_executor::task]
pub async fn run(board: &'static mut Board<BoardFlash>, mut actuator: Actuator, mut arm: Arm, mut panel: Panel) -> ! {
    let period = Duration::from_hz(u64::from(protocol::TICK_HZ));
    let mut ticker = Ticker::every(period);
    let mut tick_us = 0;
    let mut previous = Instant::now();
    defmt::info!("board started");
    loop {
        match select(ticker.next(), RECEIVED.receive()).await {
            Either::First(()) => {
                let begin = Instant::now();
                let since = begin.duration_since(previous);
                // The check of a large table can take several periods. Ticks that were missed are not made up for: a burst of them
                // would find no fresh readings, and control counts on 20 ms between two.
                if since > period * 2 {
                    ticker.reset();
                }
                previous = begin;
                let averaged = FAST.lock(|cell| cell.borrow_mut().as_mut().map(|fast| fast.take()));
                let overrun = sampling::OVERRUN.swap(false, Ordering::Relaxed);
                let outputs = board.tick(&Inputs {
                    period_us: u32::try_from(since.as_micros()).unwrap_or(u32::MAX),
                    stop_pressed: panel.stop_pressed(),
                    interlock: interlock::trip(),
                    ..Inputs::from_fast(&averaged.unwrap_or_default(), overrun, tick_us)
                });
                record::state(board.state());
                if outputs.power.is_on() {
                    debugger::keep_safe();
                }
                FAST.lock(|cell| {
                    if let Some(fast) = cell.borrow_mut().as_mut() {
                        fast.set_target_a(outputs.coil_target_a);
                    }
                });
                actuator.set_v(outputs.actuator_v);
                arm.set_rate(outputs.arm_rate_mm_s);
                panel.show(outputs.power, board.is_faulted());
                let us = begin.elapsed().as_micros();
                tick_us = u16::try_from(us).unwrap_or(u16::MAX);
                interlock::turn(Task::Control);
                interlock::end_of_tick(outputs.power, board.is_punctual(tick_us));
            }
            Either::Second(packet) => board.receive(packet.link, &packet.bytes),
        }
        pass_on(board, LinkId::Usb, &TO_USB);
        pass_on(board, LinkId::Uart, &TO_UART);
    }
}

/// Moves what the pipe has room for; the rest stays in the board's queue.
fn pass_on<const N: usize>(board: &mut Board<BoardFlash>, link: LinkId, pipe: &Pipe<CriticalSectionRawMutex, N>) {
    let mut bytes = [0; PACKET_LEN];
    loop {
        let room = pipe.free_capacity().min(bytes.len());
        let Some(chunk) = bytes.get_mut(..room).filter(|c| !c.is_empty()) else {
            return;
        };
        let count = board.take_transmit(link, chunk);
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
