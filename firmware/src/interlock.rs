//! The interlock: power outputs are on only while a permit lasts, and the watchdog is fed only while every task lives.
//!
//! The control tick grants a permit of [`PERMIT_MS`] at its end if it was punctual and faultless. The highest
//! interrupt polls once a millisecond and counts the permit down by itself: it trusts no other clock. So outputs
//! on implies a punctual, faultless tick within [`PERMIT_MS`]. What cannot be polled (masked interrupts) is
//! bounded by the watchdog, which only the poll feeds.

/// Polls a second.
pub const POLL_HZ: u32 = 1000;

/// How long outputs stay on after a grant, ms: two ticks of control.
pub const PERMIT_MS: u16 = 40;

/// Longest silence of a task while outputs are on, ms: five ticks, and two turns of an idle link.
const SILENCE_ON_MS: u16 = 100;

/// The same while outputs are off, ms: the check of the largest table holds the thread's tasks up for 0.42 s at
/// four clocks an instruction.
const SILENCE_OFF_MS: u16 = 1000;

/// Number of watched tasks.
pub const TASKS: usize = 6;

/// The watched tasks. Each counts its turns, also when it has nothing to do.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(usize)]
pub enum Task {
    /// The 50 Hz tick.
    Control,
    /// The 1 kHz loop.
    Sampling,
    /// Bytes from USB.
    UsbReceive,
    /// Bytes to USB.
    UsbSend,
    /// Bytes from the UART.
    UartReceive,
    /// Bytes to the UART.
    UartSend,
}

/// Which power outputs are on. `Default` is off.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Power {
    /// The palpation arm presses.
    pub arm: bool,
    /// Actuator of the display.
    pub actuator: bool,
    /// Coil of the display.
    pub coil: bool,
}

impl Power {
    /// All off.
    pub const OFF: Power = Power { arm: false, actuator: false, coil: false };
    /// The arm alone.
    pub const ARM: Power = Power { arm: true, actuator: false, coil: false };
    /// Both parts of the display, and the arm off.
    pub const DISPLAY: Power = Power { arm: false, actuator: true, coil: true };

    /// True if any output is on.
    pub const fn is_on(self) -> bool {
        self.arm || self.actuator || self.coil
    }
}

/// Why the interlock keeps outputs off that control wants on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Trip {
    /// The permit ended: no punctual tick came.
    Expired,
    /// A task has not turned; its number is its place in [`Task`].
    Silent(usize),
}

impl Trip {
    /// For the fault's report: 0 for an ended permit, else one more than the task's number.
    pub const fn number(self) -> u8 {
        match self {
            Trip::Expired => 0,
            Trip::Silent(task) => task as u8 + 1,
        }
    }
}

/// What one poll demands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Poll {
    /// Switch all outputs off.
    pub off: bool,
    /// Feed the watchdog.
    pub feed: bool,
}

/// Permit and heartbeats.
#[derive(Debug, Clone)]
pub struct Interlock {
    /// Time left of the permit, ms; 0 without one.
    left_ms: u16,
    /// Why outputs are off although control wanted them on.
    trip: Option<Trip>,
    /// Turns of the tasks at the last poll, and for how long they have not changed, ms.
    turns: [u32; TASKS],
    silent_ms: [u16; TASKS],
    watched: [bool; TASKS],
}

impl Default for Interlock {
    fn default() -> Self {
        Self::new()
    }
}

impl Interlock {
    /// No permit; all tasks are watched.
    pub const fn new() -> Self {
        Interlock { left_ms: 0, trip: None, turns: [0; TASKS], silent_ms: [0; TASKS], watched: [true; TASKS] }
    }

    /// A task that this board does not run.
    pub fn unwatch(&mut self, task: Task) {
        if let Some(watched) = self.watched.get_mut(task as usize) {
            *watched = false;
        }
    }

    /// The first watched task that has not turned for longer than `limit_ms`.
    fn silent(&self, limit_ms: u16) -> Option<usize> {
        self.watched.iter().zip(self.silent_ms).position(|(watched, silent_ms)| *watched && silent_ms > limit_ms)
    }

    /// The end of a punctual, faultless control tick that wants outputs on; true if they may be.
    ///
    /// A refusal counts as a trip: control wants what it does not get.
    pub fn grant(&mut self) -> bool {
        if let Some(task) = self.silent(SILENCE_ON_MS) {
            self.trip.get_or_insert(Trip::Silent(task));
        }
        self.left_ms = if self.trip.is_none() { PERMIT_MS } else { 0 };
        self.trip.is_none()
    }

    /// The end of a control tick that wants outputs off: ends the permit, and forgets a trip.
    pub fn rest(&mut self) {
        self.left_ms = 0;
        self.trip = None;
    }

    /// Why a permit ended by itself or was refused, until the next [`Self::rest`].
    pub const fn trip(&self) -> Option<Trip> {
        self.trip
    }

    /// One poll, every millisecond, with the turns of all tasks so far.
    pub fn poll(&mut self, turns: &[u32; TASKS]) -> Poll {
        for ((last, silent_ms), now) in self.turns.iter_mut().zip(&mut self.silent_ms).zip(turns) {
            *silent_ms = if last == now { silent_ms.saturating_add(1) } else { 0 };
            *last = *now;
        }
        let limit_ms = if self.left_ms > 0 { SILENCE_ON_MS } else { SILENCE_OFF_MS };
        let feed = self.silent(limit_ms).is_none();
        if self.left_ms > 0 {
            self.left_ms -= 1;
            if self.left_ms == 0 {
                self.trip = Some(Trip::Expired);
            }
        }
        Poll { off: self.left_ms == 0, feed }
    }
}

#[cfg(test)]
mod tests;
