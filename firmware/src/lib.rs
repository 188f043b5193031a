//! Identification, control and safety of the display board as pure steps.
//!
//! The same library runs in the microcontroller's image (`src/image`) and in the host's simulated
//! board; both talk to [`board::Board`], which composes everything below. Each concept is a step
//! `(configuration, state, input) -> output` in a file of its own:
//!
//! | walk to | for |
//! |---|---|
//! | [`board`] | the composition: one call a control tick, bytes of the link in and out |
//! | [`fast`] | the 1 kHz loop: oversampling, coil current regulation, over-current trip |
//! | [`sensor`] | ratios of the reference voltage to N, mm and A, and back |
//! | [`contact`] | contact detection and the contact point |
//! | [`search`] | the variance search over the table (Eq. 17) |
//! | [`profile`] | the fast search: one row an exponent, mu in closed form |
//! | [`surface`] | the continuous force surface of a slice, with exact derivatives |
//! | [`kalman`] | the Kalman filter on it (Eqs. 18-27) |
//! | [`recognition`] | the nearest library material |
//! | [`palpation`] | one palpation: record, search, refinement of the contact point, verdict |
//! | [`readings`] | whether the samples of a press can be identified, and the name of why not |
//! | [`press`] | a recorded press identified by one method, or a named outcome |
//! | [`pid`] | position loop of the display |
//! | [`coil`] | force to current to duty, and how hot the coil is |
//! | [`mode`] | palpation and display as two halves, and their supervisor |
//! | [`showing`] | which curve is displayed, and the transition to another |
//! | [`finger`] | where a finger is, and where it goes |
//! | [`neighbours`] | between which library materials an identified one lies |
//! | [`safety`] | limits and latched faults |
//! | [`flash`] | table slots, upload, power cuts |
//! | [`link`] | frames in, frames out, bounded queue |
//! | [`trace`] | what the last run left behind in RAM: states, why it ended |
//! | [`selftest`] | means of what the self-test program sees |
//! | [`config`] | every number the board owns, in one place |
//!
//! Nothing allocates, nothing panics, and outputs are off unless a mode turns them on. Units are mm, N, MPa, s,
//! A, V and degrees Celsius; every name carries its unit.
#![cfg_attr(not(test), no_std)]
// `!(x > 0.0)` is how a NaN is sent the safe way.
#![allow(clippy::neg_cmp_op_on_partial_ord)]

pub mod board;
pub mod coil;
pub mod config;
pub mod contact;
pub mod display;
pub mod fast;
pub mod finger;
pub mod fingerprint;
pub mod flash;
#[cfg(all(feature = "board", target_os = "none"))]
pub mod image;
pub mod interlock;
pub mod kalman;
pub mod link;
pub mod mode;
pub mod neighbours;
pub mod number;
pub mod palpation;
pub mod pid;
pub mod plausible;
pub mod press;
pub mod profile;
pub mod readings;
pub mod recognition;
pub mod safety;
pub mod search;
pub mod selftest;
pub mod sensor;
pub mod showing;
pub mod surface;
pub mod telemetry;
#[cfg(test)]
mod testbed;
pub mod trace;
