//! Shared ground of the cross-crate tests: where golden files lie, and one sample of every message.

pub mod golden;
pub mod samples;
