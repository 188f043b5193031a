//! Virtual time in units that every clock of the chip divides.

/// Time since the emulator started, in units of 1/336 MHz: two a core clock at 168 MHz, four a timer clock at 84 MHz.
pub type Time = u64;

/// Units a second.
pub const SECOND: Time = 336_000_000;

/// Units a millisecond.
pub const MILLISECOND: Time = SECOND / 1000;

/// Units a microsecond.
pub const MICROSECOND: Time = SECOND / 1_000_000;

/// Seconds of a time.
pub fn seconds(time: Time) -> f64 {
    time as f64 / SECOND as f64
}
