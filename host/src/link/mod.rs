//! Ways to a board: bytes in, bytes out, with deadlines in the time of the link.
//!
//! | board | link | its time |
//! |---|---|---|
//! | simulated, in this process | [`InProcess`] | virtual: waiting advances the board tick by tick |
//! | over the network, real or `palpate board serve` | [`Tcp`] | the wall clock |
//! | on a serial port (USB CDC-ACM or the ST-LINK's UART) | [`Serial`] | the wall clock |
//!
//! [`Disturbed`] puts seeded line noise between any link and its user.

mod address;
mod disturbed;
mod error;
mod find;
mod in_process;
mod serial;
mod tcp;

pub use address::{Address, BadAddress};
pub use disturbed::{Disturbance, Disturbed};
pub use error::LinkError;
pub use find::{FindError, Port, find, find_own, find_uart, ports};
pub use in_process::{InProcess, Pace};
pub use serial::{BAUD, Serial};
pub use tcp::Tcp;

use std::io::{ErrorKind, Read};

use crate::plant::{Jitter, Touch, Truth};
use crate::simulated_board::SimulatedBoard;

/// A two-way stream of bytes with a clock of its own.
pub trait Link {
    /// Where it leads, for messages: `simulated board`, `tcp:127.0.0.1:4750`.
    fn name(&self) -> &str;

    /// Time on this link since it was opened, s; never goes back.
    fn now_s(&self) -> f64;

    /// Sends all of `bytes`.
    ///
    /// # Errors
    /// [`LinkError`] when the other side is gone.
    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError>;

    /// Waits until something arrives or [`Link::now_s`] has reached `deadline_s`, and appends what arrived to
    /// `into`; what is already there is taken even after the deadline. It may return early with nothing, so
    /// callers loop until their deadline.
    ///
    /// # Errors
    /// [`LinkError`] when the other side is gone.
    fn receive(&mut self, into: &mut Vec<u8>, deadline_s: f64) -> Result<(), LinkError>;

    /// True physics of the ticks since the last call: only a board simulated in this process knows it.
    fn take_truth(&mut self) -> Vec<Truth> {
        Vec::new()
    }
}

/// One read of a port whose own timeout is set: appends what arrived; a timeout is no error, an end is.
fn read_once(port: &mut impl Read, link: &str, into: &mut Vec<u8>) -> Result<(), LinkError> {
    let mut buffer = [0u8; 4096];
    match port.read(&mut buffer) {
        Ok(0) => Err(LinkError::Closed { link: link.to_owned() }),
        Ok(n) => {
            into.extend_from_slice(&buffer[..n]);
            Ok(())
        }
        Err(e) if matches!(e.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted) => Ok(()),
        Err(e) => Err(LinkError::of(link, e)),
    }
}

/// What the hand at the display of a simulated board does while nobody tells it: a press of 2 N every 4 s.
pub const IDLE_TOUCH: Touch = Touch { peak_n: 2.0, period_s: 4.0 };

/// Opens the link to a board; the simulated one runs in real time, with a finger on the display and nothing under the probe.
///
/// # Errors
/// [`LinkError::Open`].
pub fn open(address: &Address) -> Result<Box<dyn Link>, LinkError> {
    Ok(match address {
        Address::Simulated => {
            let mut board = SimulatedBoard::new(1, Jitter::default());
            board.touch(Some(IDLE_TOUCH));
            Box::new(InProcess::new(board, Pace::RealTime))
        }
        Address::Tcp(place) => Box::new(Tcp::open(place)?),
        Address::Auto => Box::new(Serial::open(&find(&ports()?)?.path)?),
        Address::Serial(path) => Box::new(Serial::open(path)?),
    })
}

impl<L: Link + ?Sized> Link for Box<L> {
    fn name(&self) -> &str {
        (**self).name()
    }
    fn now_s(&self) -> f64 {
        (**self).now_s()
    }
    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        (**self).send(bytes)
    }
    fn receive(&mut self, into: &mut Vec<u8>, deadline_s: f64) -> Result<(), LinkError> {
        (**self).receive(into, deadline_s)
    }
    fn take_truth(&mut self) -> Vec<Truth> {
        (**self).take_truth()
    }
}
