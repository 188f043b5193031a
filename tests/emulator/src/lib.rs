//! The board's unmodified image on an emulated STM32F429ZI, closed over the simulated bench.
//!
//! [`board::EmulatedBoard`] is the whole; [`link::EmulatedUart`] talks to it in virtual time, the program of this crate over TCP in real time. [`bare`] runs the identification alone.
//! What is modelled and what is not: `docs/emulator.md`.

pub mod bare;
pub mod board;
pub mod chip;
pub mod core;
pub mod debug;
pub mod elf;
pub mod jumpers;
pub mod link;
pub mod server;
pub mod surroundings;
pub mod time;
