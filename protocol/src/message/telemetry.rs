//! The 50 Hz record.

use super::State;
use crate::fault::FaultSet;
use crate::wire::wire;

wire! {
    /// One control tick: what the sensors read, what the controller believes, what the outputs do.
    pub struct Telemetry {
        /// Number of the control tick since start.
        pub tick: u32,
        /// What the board is doing: palpation while it does anything, else display. Both by themselves are in
        /// [`super::Halves`].
        pub state: State,
        /// Latched faults.
        pub faults: FaultSet,
        /// Height of the ball above the base plate, mm.
        pub probe_mm: f32,
        /// Depth after contact as the board believes it, mm; 0 without contact.
        pub depth_mm: f32,
        /// Load cell, N.
        pub load_cell_n: f32,
        /// FSR of the display, N.
        pub fsr_n: f32,
        /// Shaft position, mm.
        pub shaft_mm: f32,
        /// Desired shaft position, mm.
        pub shaft_target_mm: f32,
        /// Actuator command, V.
        pub actuator_v: f32,
        /// Coil current, A.
        pub coil_a: f32,
        /// Desired coil current, A.
        pub coil_target_a: f32,
        /// Coil duty, 0 to 1.
        pub coil_duty: f32,
        /// Estimated coil temperature, degrees Celsius.
        pub coil_c: f32,
        /// Mean absolute difference of the best column so far, N.
        pub search_error_n: f32,
        /// Duration of the previous control tick, us.
        pub tick_us: u16,
        /// What the converter read, before any calibration.
        pub raw: Raw,
        /// What of the material is not displayed; all false unless a material is.
        pub shown: Shown,
    }
    /// How the display departs from the material that it shows. None of these is a fault.
    #[derive(Copy, Eq, Default)]
    pub struct Shown {
        /// The table says that the magnet cannot make what is wanted at this force: the current is held
        /// at the nearest that is reachable.
        pub unreachable: bool,
        /// The board allows less current than the table asks for: the winding is warm.
        pub coil_limited: bool,
        /// The table asks for a shaft position beyond the actuator's stroke.
        pub shaft_limited: bool,
        /// The table has no control curve for this material, or no coil is fitted: the actuator displays
        /// alone.
        pub actuator_only: bool,
    }
    /// Mean readings of one tick, 65,535ths of the reference voltage.
    pub struct Raw {
        /// Load cell of the probe.
        pub load_cell: u16,
        /// FSR of the display.
        pub fsr: u16,
        /// Potentiometer of the shaft.
        pub potentiometer: u16,
        /// Position of the probe.
        pub probe_position: u16,
        /// Shunt amplifier of the coil.
        pub coil_current: u16,
    }
    /// A fault was latched in this tick.
    pub struct FaultReport {
        /// Number of the control tick.
        pub tick: u32,
        /// Bit of the fault ([`crate::fault::Fault::from_bit`]).
        pub fault: u8,
        /// The value that tripped it, in the unit of its limit.
        pub value: f32,
        /// The limit.
        pub limit: f32,
    }
}

impl Shown {
    /// What is not displayed as it should be, in words; empty for a material that is displayed as it is.
    pub fn words(self) -> impl Iterator<Item = &'static str> {
        [
            (self.unreachable, "unreachable"),
            (self.coil_limited, "coil held back by its heat"),
            (self.shaft_limited, "shaft at the end of its stroke"),
            (self.actuator_only, "actuator only"),
        ]
        .into_iter()
        .filter_map(|(is, word)| is.then_some(word))
    }
}
