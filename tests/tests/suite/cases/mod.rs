//! Small inputs that people had trouble with, made by others: `../shared/cases`, and more of the same kinds beside them.
//!
//! The cases are not part of this repository; without them their tests say SKIPPED. A module for each kind of trouble.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod case;
mod files;
mod parser;
mod sensor;
mod sensor_otherwise;
mod workbooks;
mod written_otherwise;
