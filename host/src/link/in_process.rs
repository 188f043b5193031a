//! The simulated board in this process.

use std::time::{Duration, Instant};

use super::{Link, LinkError};
use crate::plant::Truth;
use crate::simulated_board::SimulatedBoard;

/// How virtual time goes by.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pace {
    /// As fast as the computer can.
    Free,
    /// As on the wall clock, for people who watch.
    RealTime,
}

/// A link whose waiting advances the board: time is the board's.
#[derive(Debug)]
pub struct InProcess {
    board: SimulatedBoard,
    pace: Pace,
    opened: Instant,
    opened_at_s: f64,
}

impl InProcess {
    /// A link to `board`.
    pub fn new(board: SimulatedBoard, pace: Pace) -> Self {
        InProcess { opened_at_s: board.time_s(), board, pace, opened: Instant::now() }
    }

    /// The board.
    pub fn board(&self) -> &SimulatedBoard {
        &self.board
    }

    /// The board, to change its surroundings.
    pub fn board_mut(&mut self) -> &mut SimulatedBoard {
        &mut self.board
    }
}

impl Link for InProcess {
    fn name(&self) -> &str {
        "the simulated board"
    }

    fn now_s(&self) -> f64 {
        self.board.time_s()
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        self.board.receive(bytes);
        Ok(())
    }

    fn receive(&mut self, into: &mut Vec<u8>, deadline_s: f64) -> Result<(), LinkError> {
        let before = into.len();
        self.board.transmit(into);
        while into.len() == before && self.board.time_s() < deadline_s {
            if self.pace == Pace::RealTime {
                let due = Duration::from_secs_f64((self.board.time_s() - self.opened_at_s).max(0.0));
                std::thread::sleep(due.saturating_sub(self.opened.elapsed()));
            }
            self.board.step();
            self.board.transmit(into);
        }
        Ok(())
    }

    fn take_truth(&mut self) -> Vec<Truth> {
        self.board.take_truth()
    }
}
