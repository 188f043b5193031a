//! Forward models of the indentation experiment: one curve, and the continuous
//! force model over the exponent (and the height) built from many.

mod chebyshev;
mod curve;
mod force;
mod indentation;
mod profile;

pub use chebyshev::{Axis, Scale};
pub use curve::{Curve, Stats};
pub use force::{ErrorBound, ForceGradient, ForceModel, ModelSpec};
pub use indentation::{DEPTHS, Indentation, Resolution, Specimen};
pub use profile::{DepthProfile, MAX_TERMS, Sample};
