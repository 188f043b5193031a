//! The dashboard: a board live in a terminal, with its controls on keys.
//!
//! Three parts that know nothing of each other's business:
//!
//! | part | is |
//! |---|---|
//! | [`Monitor`] | what is known of the board and what the keys mean: telemetry and keys in, commands out, no clock, no terminal |
//! | [`draw`] | the picture of it, for any terminal from 80 x 24 on |
//! | [`Worker`] | the conversation with the board in a thread of its own: carries out commands, records, opens a lost link again |
//!
//! [`run`] joins them. The keys that switch off, and those that end it, are carried out by the thread that reads them: they wait neither
//! for the picture nor for the terminal. A picture that stands still for a second switches the outputs off. However it ends (key, signal, panic), the outputs are switched off and the
//! terminal is given back; what a killed process leaves on, the board switches off after a second without a word.

mod bench;
mod key;
mod loops;
mod off;
mod palette;
mod recording;
mod screen;
mod state;
mod traces;
mod worker;

pub use bench::Attended;
pub use key::Key;
pub use loops::{MonitorError, check_terminal, run};
pub use off::OffSwitch;
pub use palette::Palette;
pub use recording::Recording;
pub use screen::draw;
pub use state::{Connection, Library, Monitor, SHOWN_TICKS};
pub use worker::{Command, Opener, Settings, Update, Worker};

#[cfg(test)]
mod stalled;
#[cfg(test)]
mod tests;
