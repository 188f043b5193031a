//! Commands to a display.

/// Period of the board's control and of the samples, s.
pub const TICK_S: f64 = 0.02;

/// What a run moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Subject {
    /// The linear actuator: commands in mm.
    Position,
    /// The force sensor on the cap: known loads in N.
    Force,
    /// Coil and magnet: commands in A.
    Coil,
    /// A finger that is pressed on a rigid cap: places of its bone in mm.
    Pulp,
    /// A finger that is pressed into the fluid: places of its bone in mm, at a current.
    Fluid,
}

impl Subject {
    /// The word in specifications and names of files.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Position => "position",
            Self::Force => "force",
            Self::Coil => "coil",
            Self::Pulp => "pulp",
            Self::Fluid => "fluid",
        }
    }
}

/// A command: values that are held, with ramps between them, and how often it is given.
#[derive(Debug, Clone, PartialEq)]
pub struct DisplayRun {
    /// What is moved.
    pub subject: Subject,
    /// Values (mm, N or A), one after the other.
    pub values: Vec<f64>,
    /// Time at each value, s.
    pub hold_s: f64,
    /// Time from one value to the next, s; 0: a step.
    pub ramp_s: f64,
    /// How often the command is given.
    pub replicates: usize,
    /// Current at and towards each value, A; a fluid's run only.
    pub current_a: Vec<f64>,
    /// Gap of the magnet as recorded, mm; a coil's run only.
    pub gap_mm: f64,
    /// Never to be fitted.
    pub hold_out: bool,
}

impl DisplayRun {
    /// Steps, given once.
    #[must_use]
    pub fn new(subject: Subject, values: Vec<f64>, hold_s: f64) -> Self {
        Self {
            subject,
            values,
            hold_s,
            ramp_s: 0.0,
            replicates: 1,
            current_a: Vec::new(),
            gap_mm: 1.0,
            hold_out: false,
        }
    }

    /// The same with a current (A) at and towards each value.
    #[must_use]
    pub fn with_current(mut self, current_a: Vec<f64>) -> Self {
        self.current_a = current_a;
        self
    }

    /// The same with ramps between the values.
    #[must_use]
    pub fn ramped(mut self, ramp_s: f64) -> Self {
        self.ramp_s = ramp_s;
        self
    }

    /// The same given several times.
    #[must_use]
    pub fn times(mut self, replicates: usize) -> Self {
        self.replicates = replicates;
        self
    }

    /// Length, s.
    #[must_use]
    pub fn length_s(&self) -> f64 {
        self.values.len() as f64 * self.hold_s + self.values.len().saturating_sub(1) as f64 * self.ramp_s
    }

    /// The current at a time (s), A.
    #[must_use]
    pub fn current_at(&self, time_s: f64) -> f64 {
        let period_s = self.hold_s + self.ramp_s;
        // a value's current begins with the way to it
        let index = ((time_s + self.ramp_s + 1e-9) / period_s.max(1e-9)).max(0.0) as usize;
        self.current_a.get(index.min(self.current_a.len().saturating_sub(1))).copied().unwrap_or(0.0)
    }

    /// The command at a time, s.
    #[must_use]
    pub fn at(&self, time_s: f64) -> f64 {
        let period_s = self.hold_s + self.ramp_s;
        let last = self.values.len().saturating_sub(1);
        // a nanosecond puts a step that falls on a tick into it whatever the rounding
        let place = ((time_s + 1e-9) / period_s.max(1e-9)).max(0.0);
        let index = (place as usize).min(last);
        let (Some(own), next_s) = (self.values.get(index), (time_s + 1e-9) - index as f64 * period_s - self.hold_s)
        else {
            return 0.0;
        };
        match self.values.get(index + 1) {
            Some(next) if next_s > 0.0 && self.ramp_s > 0.0 => own + (next - own) * (next_s / self.ramp_s).min(1.0),
            _ => *own,
        }
    }
}
