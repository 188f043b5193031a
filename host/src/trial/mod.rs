//! Subject tests: somebody feels what is displayed and names it, without knowing what it is.
//!
//! ```text
//! order        which stimulus comes when, from a seed
//! journal      the answers as they come, in a file that only grows
//! confusion    what was shown against what was answered, with exact intervals
//! exact        Clopper and Pearson, and how many trials a certainty takes
//! detect       d' of pairs and of a choice among several
//! information  bits that go through
//! stiffness    how stiff the materials are
//! weber        a subject as noise on the logarithm of stiffness: what it answers, and its Weber fraction from its answers
//! ```
//!
//! No name, date or address is stored: a subject is a code from the seed and a number that only the experimenter knows.

pub mod confusion;
pub mod detect;
pub mod exact;
pub mod information;
pub mod journal;
pub mod order;
pub mod stiffness;
pub mod weber;
