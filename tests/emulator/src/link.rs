//! The emulated board's UART as a link of the host, in virtual time.

use palpate::link::{Link, LinkError};

use crate::board::EmulatedBoard;

/// A link whose waiting lets the board's time pass.
pub struct EmulatedUart {
    board: EmulatedBoard,
}

impl EmulatedUart {
    /// A link to `board`.
    pub fn new(board: EmulatedBoard) -> Self {
        EmulatedUart { board }
    }

    /// The board.
    pub fn board(&mut self) -> &mut EmulatedBoard {
        &mut self.board
    }

    /// Gives the board back.
    pub fn into_board(self) -> EmulatedBoard {
        self.board
    }
}

const NAME: &str = "the emulated board";

impl Link for EmulatedUart {
    fn name(&self) -> &str {
        NAME
    }

    fn now_s(&self) -> f64 {
        self.board.time_s()
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        self.board.receive(bytes);
        Ok(())
    }

    fn receive(&mut self, into: &mut Vec<u8>, deadline_s: f64) -> Result<(), LinkError> {
        loop {
            let bytes = self.board.take_transmit();
            if !bytes.is_empty() || self.board.time_s() >= deadline_s {
                into.extend(bytes);
                return Ok(());
            }
            self.board.step().map_err(|error| LinkError::Broken {
                link: NAME.into(),
                source: std::io::Error::other(error.to_string()),
            })?;
        }
    }
}
