//! How many ticks a display departed from its material.

use std::fmt;

use protocol::message::{State, Telemetry};
use serde_json::{Value, json};

/// Ticks of a display, counted by what the board says of them ([`protocol::message::Shown`]).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct ShownTicks {
    /// With a material displayed.
    pub all: usize,
    /// Of these, with a finger's force.
    pub touched: usize,
    /// At a force that the table marks unreachable.
    pub unreachable: usize,
    /// With less current than the table asks for: a warm winding.
    pub coil_limited: usize,
    /// With the shaft at the end of its stroke.
    pub shaft_limited: usize,
    /// Without coil.
    pub actuator_only: usize,
}

impl ShownTicks {
    /// Counts a record, if it is of a display.
    pub fn add(&mut self, record: &Telemetry) {
        if record.state != State::Display {
            return;
        }
        let shown = record.shown;
        self.all += 1;
        self.touched += usize::from(record.fsr_n > 0.0);
        self.unreachable += usize::from(shown.unreachable);
        self.coil_limited += usize::from(shown.coil_limited);
        self.shaft_limited += usize::from(shown.shaft_limited);
        self.actuator_only += usize::from(shown.actuator_only);
    }

    /// As one JSON object.
    pub fn json(&self) -> Value {
        json!({
            "all": self.all, "touched": self.touched, "unreachable": self.unreachable, "coil_limited": self.coil_limited,
            "shaft_limited": self.shaft_limited, "actuator_only": self.actuator_only,
        })
    }
}

impl fmt::Display for ShownTicks {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} of {} ticks touched", self.touched, self.all)?;
        for (count, what) in [
            (self.unreachable, "unreachable"),
            (self.coil_limited, "coil held back by its heat"),
            (self.shaft_limited, "shaft at the end of its stroke"),
            (self.actuator_only, "actuator only"),
        ] {
            if count > 0 {
                write!(f, ", {count} {what}")?;
            }
        }
        Ok(())
    }
}
