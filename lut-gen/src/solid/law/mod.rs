//! Material laws: an elastic energy in principal stretches, and what time and cycles do to it.
//!
//! An elastic law is an energy per unit reference volume `U(l1, l2, l3)` (MPa = N/mm^2) that is
//! symmetric in the principal stretches: [`Hyperfoam`], [`Ogden`], [`Hencky`]. A [`Material`]
//! is one of them, relaxing by a [`PronyTerm`] series, softening by [`OgdenRoxburgh`] and expanded by heat or not.
//! Everything is written over [`Real`](crate::scalar::Real), so that the same code carries derivatives by parameters.

mod elastic;
mod energy;
mod error;
mod gradient;
mod hencky;
mod hyperfoam;
mod material;
mod ogden;
mod parameter;
mod prony;
mod second;
mod softening;

pub use elastic::Elastic;
pub use energy::{Law, Principal, Tangent};
pub use error::LawError;
pub use gradient::{Gradient, Response, Strained, first_piola, first_piola_dual, respond};
pub use hencky::Hencky;
pub use hyperfoam::{Hyperfoam, Term};
pub use material::Material;
pub use ogden::{Ogden, OgdenTerm};
pub use parameter::Parameter;
pub use prony::{PronyTerm, Relaxation, relaxed};
pub use softening::OgdenRoxburgh;
