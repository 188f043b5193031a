//! Closed forms and difference quotients that tests, and users of new laws, check against, and
//! the finite elements beside them ([`closed_forms`], the second table of docs/verification.md).

mod adhesive;
mod check;
mod confined;
mod difference;
mod hertz;
mod indented_layer;
mod no_slip;
mod relaxation;
mod thin_layer;

pub use adhesive::{Adhered, AdhesiveContact};
pub use check::{Check, closed_forms, confined_compression, thin_layer};
pub use confined::{ConfinedBlock, confined_stress_mpa, confining_stress_mpa};
pub use difference::{central_gradient, worst_mismatch};
pub use hertz::hertz_force_n;
pub use indented_layer::IndentedLayer;
pub use no_slip::no_slip_factor;
pub use relaxation::relaxing_column_mpa;
pub use thin_layer::{LayerContact, ThinLayer};
