//! Forward models of the indentation experiment: one curve, and the continuous
//! force model over the exponent (and the height) built from many.

pub(crate) mod chebyshev;
mod compression;
mod curve;
mod expansion;
mod fields;
mod force;
mod indentation;
mod nodes;
mod plan;
mod potential;
mod press;
mod profile;
mod record;
mod relaxed;
mod sensitivity;
mod simulation;
mod slice;
mod specimen;

pub use chebyshev::{Axis, Scale, clenshaw_and_slope, clenshaw_and_slope_each};
pub use compression::{Compression, Ends};
pub use curve::{Curve, Stats};
pub use force::{ErrorBound, ForceGradient, ForceModel};
pub use indentation::{DEPTHS, Indentation};
pub use plan::ModelSpec;
pub use press::{HOLD_NODES, Press, RAMP_NODES};
pub use profile::{DepthProfile, MAX_TERMS, Sample};
pub use record::Record;
pub use relaxed::RampRelaxation;
pub use sensitivity::{Sensitivity, Tracker};
pub(crate) use simulation::CLOSER;
pub use simulation::{Simulation, Watcher};
pub use slice::ForceSlice;
pub use specimen::{Resolution, Specimen};
