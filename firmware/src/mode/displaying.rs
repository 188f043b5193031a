//! The display half: at rest, waiting for a palpation to say what to display, or displaying a curve.

use super::TableLimits;
use crate::showing::{Origin, Showing};
use protocol::message::{Curve, DisplayMode, DisplayState, Parts, Refusal, Rule};

/// State of the display half.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Displaying {
    asked: DisplayMode,
    pub(super) showing: Showing,
}

impl Default for Displaying {
    fn default() -> Self {
        Self::new()
    }
}

impl Displaying {
    /// At rest.
    pub const fn new() -> Self {
        Displaying { asked: DisplayMode::Idle, showing: Showing::NOTHING }
    }

    /// What was asked for.
    pub const fn asked(&self) -> DisplayMode {
        self.asked
    }

    /// Parts that are asked for; `None` at rest.
    pub const fn parts(&self) -> Option<Parts> {
        self.asked.parts()
    }

    /// What is shown.
    pub const fn showing(&self) -> &Showing {
        &self.showing
    }

    /// What it is doing without a fault.
    pub const fn state(&self) -> DisplayState {
        match (&self.asked, self.showing.is_nothing()) {
            (DisplayMode::Idle, _) => DisplayState::Idle,
            (_, true) => DisplayState::Waiting,
            (_, false) => DisplayState::On,
        }
    }

    /// The rule by which verdicts are displayed, if they are.
    pub const fn follows(&self) -> Option<Rule> {
        match self.asked {
            DisplayMode::Follow { by, .. } => Some(by),
            DisplayMode::Idle | DisplayMode::Material { .. } | DisplayMode::Between { .. } => None,
        }
    }

    /// Off.
    pub(super) fn stop(&mut self) {
        *self = Displaying::new();
    }

    /// Goes over to what is asked for. `curve` is what that is now: nothing for a display that waits for a
    /// verdict.
    ///
    /// # Errors
    /// [`Refusal::NoTable`]; [`Refusal::OutOfRange`] for an entry that the library does not have;
    /// [`Refusal::Busy`] for other parts than are on: they would begin in the middle of a press.
    pub(super) fn begin(
        &mut self,
        asked: DisplayMode,
        (curve, origin): (Curve, Origin),
        table: Option<TableLimits>,
    ) -> Result<(), Refusal> {
        let limits = table.ok_or(Refusal::NoTable)?;
        let is_there = |entry: u8| usize::from(entry) < limits.materials;
        if curve != Curve::NONE && !(is_there(curve.low) && is_there(curve.high)) {
            return Err(Refusal::OutOfRange);
        }
        if self.parts().is_some_and(|on| asked.parts() != Some(on)) {
            return Err(Refusal::Busy);
        }
        if self.parts().is_none() {
            self.showing = Showing::of(curve, origin);
        } else {
            self.showing.go_over(curve, origin);
        }
        self.asked = asked;
        Ok(())
    }

    /// A verdict says what to display.
    pub(super) fn follow(&mut self, curve: Curve, origin: Origin) {
        if self.follows().is_some() {
            self.showing.go_over(curve, origin);
        }
    }
}
