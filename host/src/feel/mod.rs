//! What a finger feels on the display: presses of a simulated hand on the simulated board, beside the material that they
//! show (thesis Figs. 64, 82-86).
//!
//! Truth, reading and belief stay apart: scores are of true force, shaft and bone; what the board reads and wants is in the
//! samples beside them.

mod board;
pub mod record;
mod score;
mod session;
mod table;

use lut_gen::magnet::curve::FluxCurve;
use lut_gen::magnet::fluid::Fluid as FluidLaw;
use protocol::message::{Actuator, Gains};

use crate::control::ControlCurve;
use crate::plant::{Constants, FluidForce};
use crate::session::SessionError;

pub use board::{FeltSoFar, OnBoard, on_board};
pub use score::{ActuatorScore, FluidScore, LEAST_N, Loading};
pub use session::run;

/// Which display is pressed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Display {
    /// The cap of the linear actuator (chapter 5).
    Actuator,
    /// The fluid in the magnet's gap (chapter 4), its current by the finger's force.
    Fluid,
    /// The same, its current by the finger's place.
    FluidAtPlace,
}

impl Display {
    /// True for the fluid.
    #[must_use]
    pub const fn is_fluid(self) -> bool {
        matches!(self, Display::Fluid | Display::FluidAtPlace)
    }
}

/// How fast a press is: s for the way down, and for the way up.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pace {
    /// 4 s.
    Slow,
    /// 0.4 s.
    Fast,
}

impl Pace {
    /// Both.
    pub const ALL: [Pace; 2] = [Pace::Slow, Pace::Fast];

    /// Time of the way down, and of that up, s.
    #[must_use]
    pub const fn way_s(self) -> f64 {
        match self {
            Pace::Slow => 4.0,
            Pace::Fast => 0.4,
        }
    }

    /// What it is called.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Pace::Slow => "slow",
            Pace::Fast => "fast",
        }
    }
}

/// What is felt.
#[derive(Debug, Clone)]
pub struct Asked {
    /// Materials, all for one magnet and fluid.
    pub curves: Vec<ControlCurve>,
    /// Magnet of these curves.
    pub flux: FluxCurve,
    /// Fluid of these curves.
    pub law: FluidLaw,
    /// The true display, hand and finger.
    pub constants: Constants,
    /// Gains of the position loop; the board's own without.
    pub gains: Option<Gains>,
    /// What the board is told of its actuator; nothing without.
    pub actuator: Option<Actuator>,
    /// Seed of tremor and noise.
    pub seed: u64,
}

/// One tick of a press.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Time since the press began, s.
    pub time_s: f64,
    /// True force of the finger, N.
    pub force_n: f64,
    /// True place of the bone: of the tip, were it not compressed, below the surface, mm.
    pub bone_mm: f64,
    /// True shaft, mm.
    pub shaft_mm: f64,
    /// True yield stress of the fluid, kPa.
    pub yield_kpa: f64,
    /// True flux density in the fluid, T.
    pub flux_t: f64,
    /// Force as read, N.
    pub read_n: f64,
    /// Shaft as read, and where the board wants it, mm.
    pub read_mm: f64,
    /// Where the board wants the shaft, mm.
    pub target_mm: f64,
    /// Current that the board wants, A.
    pub wanted_a: f64,
    /// The table says that the magnet cannot make what is wanted.
    pub unreachable: bool,
}

/// A press of one material.
#[derive(Debug, Clone, PartialEq)]
pub struct Pressed {
    /// How fast.
    pub pace: Pace,
    /// Tick by tick, down and up.
    pub samples: Vec<Sample>,
}

/// One material on one display.
#[derive(Debug, Clone, PartialEq)]
pub struct Felt {
    /// What it should be.
    pub curve: ControlCurve,
    /// Which display.
    pub display: Display,
    /// Slow, then fast.
    pub presses: Vec<Pressed>,
    /// Samples are a board's readings, and not the truth of a simulation.
    pub is_read: bool,
}

/// Why nothing was felt.
#[derive(Debug, thiserror::Error)]
pub enum Unfelt {
    /// The board.
    #[error(transparent)]
    Session(#[from] SessionError),
    /// A curve that makes no table.
    #[error("the control curves make no table: {0}")]
    Table(String),
    /// A board whose display nobody presses.
    #[error("nobody pressed {material} within {waited_s} s: expected more than 0.1 N on the display's force sensor")]
    Untouched {
        /// What was displayed.
        material: String,
        /// How long was waited, s.
        waited_s: f64,
    },
    /// A sensor that is loaded all along.
    #[error(
        "the display's force sensor read more than 0.1 N for {waited_s} s before {material}: lift the finger, or calibrate its zero"
    )]
    Loaded {
        /// What was displayed.
        material: String,
        /// How long was waited, s.
        waited_s: f64,
    },
    /// A fault of the board, or a gap in what it said.
    #[error("{0}")]
    Fault(String),
    /// A signal, or whoever was asked to press.
    #[error("ended before all was pressed; what was felt until then is kept, and the outputs are off")]
    Ended,
    /// The program's own table of the fluid's force.
    #[error("the table of a fluid's force cannot be read")]
    FluidForce,
    /// The calibration of the display's force sensor.
    #[error("the force sensor reads {found} under known forces; expected readings that rise with them")]
    Calibration {
        /// What was found.
        found: String,
    },
}

/// Largest force of a finger on a fluid, by finite elements.
const FLUID_FORCE: &str = include_str!("../../plants/fluid-force.csv");

/// The table of a finger's force on a yielding fluid that comes with the program.
///
/// # Errors
/// [`Unfelt::FluidForce`]: a test reads it.
pub fn fluid_force() -> Result<FluidForce, Unfelt> {
    FluidForce::parse(FLUID_FORCE).ok_or(Unfelt::FluidForce)
}
