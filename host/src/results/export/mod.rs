//! Laws as the input files of other finite-element programs have them, in N, mm, MPa and s.
//!
//! A block is written where the other program has the very law. Where it has another one in its place, nothing
//! is written, and what could not be is said. A relaxation that it would take in another form is written as a
//! comment, so that nobody computes with it unawares.

mod abaqus;
mod febio;

pub use abaqus::abaqus;
pub use febio::febio;

use lut_gen::solid::law::PronyTerm;

/// What a block says of itself, one line each.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Header {
    /// Name of the material.
    pub name: String,
    /// Lines about it: where it comes from, parameters with their intervals.
    pub lines: Vec<String>,
}

/// What another program has no counterpart of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum NoCounterpart {
    /// Hyperfoam of another Poisson's ratio than 0, in FEBio.
    #[error("FEBio has no hyperfoam with a Poisson's ratio other than 0; identify with --nu 0, or use material.inp")]
    PoissonInFebio,
    /// A law that no program has.
    #[error("only hyperfoam and Ogden have a counterpart in other programs")]
    Law,
}

/// Shear and bulk parts of a relaxation that count as the same.
const ALIKE: f64 = 1e-9;

/// Shear and bulk relax alike.
fn alike(prony: &[PronyTerm]) -> bool {
    prony.iter().all(|term| (term.g - term.k).abs() <= ALIKE)
}

/// Twelve digits, in at most the twenty characters that CalculiX reads of a field.
fn field(value: f64) -> String {
    let rounded: f64 = format!("{value:.11e}").parse().unwrap_or(value);
    let plain = format!("{rounded}");
    let written = if plain.len() <= 18 { plain } else { format!("{rounded:e}") };
    if written.contains(['.', 'e']) { written } else { format!("{written}.") }
}

/// A name that both programs take: letters, figures, dashes; a letter first.
fn name(words: &str) -> String {
    let plain: String = words.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '-' }).take(60).collect();
    if plain.starts_with(|c: char| c.is_ascii_alphabetic()) { plain } else { format!("M-{plain}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_short_and_exact_to_twelve_digits() {
        for value in [0.22, 10.526_315_789_473_684, 1.0 / 3.0, 1.234_567_890_123e-9, 5e-5, 12.0, 3e10] {
            let written = field(value);
            assert!(written.len() <= 20, "{written}");
            let read: f64 = written.parse().unwrap_or(f64::NAN);
            assert!((read / value - 1.0).abs() < 1e-11, "{written}");
        }
        assert_eq!(field(12.0), "12.");
        assert_eq!(name("EVA, 2 mm"), "EVA--2-mm");
        assert_eq!(name("3d"), "M-3d");
    }
}
