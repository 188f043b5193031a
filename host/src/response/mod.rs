//! Response of a linear actuator: what its recordings tell of order, gain, delay, rate limit, friction and backlash.
//!
//! ```text
//! law         the linear part and what real actuators add to it
//! motion      the motion under a held command, exact between events
//! recording   CSV files, of any program and of `palpate log`
//! begin       where a fit begins
//! fit         output-error fit by Gauss-Newton
//! noise       correlation of what is left
//! choose      order, and rate limit or none
//! interval    95 % intervals
//! identified  all of it, with what the recording does not tell
//! push        an actuator that is pushed without a command
//! repeat      what of its residual comes again in every stroke
//! file        `actuator.toml`, for `palpate tune`
//! ```

pub mod begin;
pub mod choose;
pub mod file;
pub mod fit;
pub mod identified;
pub mod interval;
pub mod law;
pub mod motion;
pub mod noise;
pub mod push;
pub mod recording;
pub mod repeat;
mod rough;

#[cfg(test)]
mod tests;
