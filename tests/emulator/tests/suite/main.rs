//! The real image on the emulated board. One program: linking it takes longer than most of its tests.

mod common;
mod conversation;
mod flashing;
mod hazards;
mod interlock;
mod line;
mod panel;
mod power_cuts;
mod same_bits;
mod same_session;
mod script;
mod selftest;
mod silicon;
mod timing;
mod versions;
