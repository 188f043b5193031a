//! The emulated board's UART as a link of the host, in virtual time.

use std::borrow::BorrowMut;

use palpate::link::{Link, LinkError};

use crate::board::EmulatedBoard;

/// A link whose waiting lets the board's time pass; owns the board or borrows it.
pub struct EmulatedUart<B> {
    board: B,
}

impl<B: BorrowMut<EmulatedBoard>> EmulatedUart<B> {
    /// A link to `board`.
    pub fn new(board: B) -> Self {
        EmulatedUart { board }
    }

    /// The board.
    pub fn board(&mut self) -> &mut EmulatedBoard {
        self.board.borrow_mut()
    }
}

const NAME: &str = "the emulated board";

impl<B: BorrowMut<EmulatedBoard>> Link for EmulatedUart<B> {
    fn name(&self) -> &str {
        NAME
    }

    fn now_s(&self) -> f64 {
        self.board.borrow().time_s()
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        self.board().receive(bytes);
        Ok(())
    }

    fn receive(&mut self, into: &mut Vec<u8>, deadline_s: f64) -> Result<(), LinkError> {
        loop {
            let bytes = self.board().take_transmit();
            if !bytes.is_empty() || self.board().time_s() >= deadline_s {
                into.extend(bytes);
                return Ok(());
            }
            self.board().step().map_err(|error| LinkError::Broken {
                link: NAME.into(),
                source: std::io::Error::other(error.to_string()),
            })?;
        }
    }
}
