//! Closed forms and difference quotients that tests, and users of new laws, check against.

mod adhesive;
mod difference;
mod hertz;
mod relaxation;

pub use adhesive::{Adhered, AdhesiveContact};
pub use difference::{central_gradient, worst_mismatch};
pub use hertz::hertz_force_n;
pub use relaxation::relaxing_column_mpa;
