//! Closed forms and difference quotients that tests, and users of new laws, check against.

mod difference;
mod hertz;

pub use difference::{central_gradient, worst_mismatch};
pub use hertz::hertz_force_n;
