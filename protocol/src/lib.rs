//! What board and host must agree on, and nothing else: messages, frames, fault codes, and the
//! look-up table (LUT) format with its one interpolation.
//!
//! | walk to | for |
//! |---|---|
//! | [`message`] | the one table of messages, and their bodies |
//! | [`frame`] | COBS framing, CRC-32, sequence numbers, resynchronisation |
//! | [`rescue`] | the frozen "who are you" that any two versions can exchange |
//! | [`selftest`] | the conversation with the self-test program |
//! | [`fault`] | fault codes both sides know |
//! | [`lut`] | the table format: zero-copy reader, interpolation, writer (feature `std`) |
//!
//! Units are mm, N, MPa, s, A, V and degrees Celsius throughout; every field name carries its unit.
//! The crate knows no physics and no hardware, allocates nothing (the table writer apart) and
//! does not panic on any input.
#![cfg_attr(not(any(test, feature = "std")), no_std)]

pub mod fault;
pub mod frame;
pub mod lut;
pub mod message;
pub mod rescue;
pub mod selftest;
mod wire;

/// Version of the message set. Messages are append-only within a version.
pub const PROTOCOL_VERSION: u16 = 2;

/// Control and telemetry rate of the board, 1/s.
pub const TICK_HZ: u32 = 50;

/// Length of one control tick, s.
pub const TICK_S: f32 = 1.0 / TICK_HZ as f32;
