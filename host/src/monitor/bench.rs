//! The bench of the simulated board while somebody watches: an operator lays the next foam under the probe when the arm is back home.

use protocol::message::State;

use crate::link::{IDLE_TOUCH, InProcess, Link, LinkError, Pace};
use crate::plant::{Foam, Jitter, Truth};
use crate::simulated_board::SimulatedBoard;

/// The simulated board in this process, attended.
#[derive(Debug)]
pub struct Attended {
    inner: InProcess,
    foams: Vec<Foam>,
    next: usize,
    before: State,
}

impl Attended {
    /// A board just powered on, with a finger on its display and the first of `foams` under the probe.
    pub fn new(foams: Vec<Foam>, pace: Pace) -> Self {
        let mut board = SimulatedBoard::new(1, Jitter::default());
        board.touch(Some(IDLE_TOUCH));
        let mut attended = Attended { inner: InProcess::new(board, pace), foams, next: 0, before: State::Idle };
        attended.lay();
        attended
    }

    fn lay(&mut self) {
        if let Some(foam) = self.foams.get(self.next) {
            self.inner.board_mut().place(foam.clone());
            self.next = (self.next + 1) % self.foams.len();
        }
    }
}

impl Link for Attended {
    fn name(&self) -> &str {
        self.inner.name()
    }

    fn now_s(&self) -> f64 {
        self.inner.now_s()
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        self.inner.send(bytes)
    }

    fn receive(&mut self, into: &mut Vec<u8>, deadline_s: f64) -> Result<(), LinkError> {
        self.inner.receive(into, deadline_s)?;
        let now = self.inner.board().state();
        if self.before == State::Retract && now == State::Idle {
            self.lay();
        }
        self.before = now;
        Ok(())
    }

    fn take_truth(&mut self) -> Vec<Truth> {
        self.inner.take_truth()
    }
}
