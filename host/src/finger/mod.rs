//! Fingers as files, and what they are pressed on.
//!
//! | file | holds |
//! |---|---|
//! | `file`, `layer`, `builtin` | `finger.toml`: measures and layers; fingers that come with the program |
//! | [`opposite`] | a plate, a foam of the thesis, a model file |
//! | [`press`] | the press by finite elements ([`lut_gen::pad`]) |
//! | [`prints`] | prints that were measured, and the finger that makes them |
//! | [`reading`] | what is read of every state: force, area, pressures, Mises stress |
//! | [`round`] | tables of the round finger, which control curves are made for |
//! | [`vtu`] | a state for ParaView |

mod builtin;
mod file;
mod layer;
pub mod opposite;
pub mod press;
pub mod prints;
pub mod reading;
pub mod round;
pub mod vtu;

use lut_gen::pad::body::finger::Finger;
use lut_gen::pad::body::section::Section;

pub use builtin::{BUILT_IN, BuiltIn, located, names, text_of};
pub use file::{parse, read};

/// A finger, and what it is a section of.
#[derive(Debug, Clone, PartialEq)]
pub struct Described {
    /// What it is.
    pub title: String,
    /// Where its measures and materials come from, in a sentence; empty if nothing is told.
    pub source: String,
    /// Body of revolution about the finger's vertical axis, or a long finger in the plane.
    pub section: Section,
    /// Measures, layers and length of the elements.
    pub finger: Finger,
}
