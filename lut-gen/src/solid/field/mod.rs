//! What is inside the block at one depth: stretches, stresses, contact pressure; and their way to ParaView.
//!
//! ```
//! use lut_gen::solid::contact::Ball;
//! use lut_gen::solid::field::vtu;
//! use lut_gen::solid::law::Hyperfoam;
//! use lut_gen::solid::model::{Indentation, Resolution, Specimen};
//!
//! let indentation = Indentation {
//!     law: Hyperfoam::one_term(0.22, 10.526)?,
//!     specimen: Specimen::of_height(12.7),
//!     ball: Ball { radius_mm: 4.0 },
//!     depth_mm: 1.0,
//!     resolution: Resolution::Refined(0.4),
//! };
//! let fields = indentation.fields_at(&[1.0])?;
//! assert!(fields[0].largest_mises_mpa() > 0.0);
//! assert!(vtu::block(&fields[0]).contains("UnstructuredGrid"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod point;
mod snapshot;
pub mod vtu;

pub use point::PointState;
pub use snapshot::{Field, FieldError, Step};
