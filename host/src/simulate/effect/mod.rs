//! Departures of the truth from the declared model, each by the code that a diagnosis would name.
//!
//! Applied in physical order: specimen, material and contact decide the finite-element case (`simulate::body`); then
//! the machine, the specimen's response outside the catalogue, the sensor and the session clock. The order in which
//! a specification lists them does not matter.

mod definition;
mod description;
pub(super) mod machine;
pub(super) mod outside;
pub(super) mod placebo;
pub(super) mod process;
pub(super) mod range;
mod rest;
pub(super) mod scales;
pub(super) mod sensor;
mod settings;

pub use definition::{Effect, Variable};
pub(crate) use description::effect as parse;
pub use rest::{Along, Kernel, Rest, ShareOf};
pub use settings::Setting;
