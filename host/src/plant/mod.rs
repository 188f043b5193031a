//! The simulated surroundings of a board: what its sensors feel and its outputs move.
//!
//! Every file is one thing of the bench. The physics is second order at most and integrated in steps of
//! [`STEP_S`]; the foams' force comes from finite elements as a [`Curve`] of each foam's own height, never from
//! the quantised table the board searches. All randomness is seeded, one independent stream a source, so that
//! switching one noise off leaves the others as they were.
//!
//! Assumptions that the thesis leaves open are stated where their number stands.

mod actuator;
mod arm;
mod bench;
mod coil;
mod constants;
mod converter;
mod curve;
mod dented;
mod fault;
mod finger;
mod fluid;
mod fsr;
mod hand;
mod load_cell;
mod noise;
mod potentiometer;
mod pulp;
mod specimen;
mod transducer;
mod tremor;
mod truth;

pub use actuator::{Actuator, ActuatorFlaws, ActuatorLaw};
pub use arm::Arm;
pub use bench::Bench;
pub use coil::Coil;
pub use constants::Constants;
pub use converter::{Converter, OVERSAMPLED};
pub use curve::Curve;
pub use dented::{Dented, FluidForce};
pub use fault::{Broken, Input, Pin};
pub use finger::{Finger, Touch};
pub use fluid::{Built, Core, Fluid};
pub use fsr::{Fsr, FsrFlaws};
pub use hand::{ABOVE_MM, Hand, HandLaw, Press, Under};
pub use load_cell::LoadCell;
pub use noise::{Noise, Source};
pub use potentiometer::Potentiometer;
pub use pulp::{Pulp, PulpLaw};
pub use specimen::{Foam, Jitter, Placed};
pub use transducer::Transducer;
pub use tremor::Tremor;
pub use truth::Truth;

/// Integration step of the surroundings, s; also the period of the board's fast loop.
pub const STEP_S: f64 = 1e-3;
