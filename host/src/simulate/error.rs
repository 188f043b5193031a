//! Why an experiment cannot be simulated.

use lut_gen::solid::law::LawError;
use lut_gen::solid::solve::SolveError;

/// Why an experiment cannot be simulated.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SimulateError {
    /// A name that nothing has.
    #[error("{place}: there is no {kind} \"{name}\"; known: {known}")]
    Unknown {
        /// Where it is used.
        place: String,
        /// `specimen` or `indenter`.
        kind: &'static str,
        /// The name.
        name: String,
        /// What there is.
        known: String,
    },
    /// A value that makes no sense together with others.
    #[error("{place}: {key} = {value}; expected {expected}")]
    Value {
        /// Where it stands.
        place: String,
        /// The key.
        key: &'static str,
        /// Its value.
        value: f64,
        /// What was expected.
        expected: String,
    },
    /// No run at all.
    #[error("there is no [[run]]; expected at least one")]
    Empty,
    /// A law that the effects make impossible.
    #[error("{place}: {cause}")]
    Law {
        /// The specimen.
        place: String,
        /// Why.
        cause: LawError,
    },
    /// A finite-element solve failed.
    #[error("the finite elements of {place} failed: {cause}")]
    Solve {
        /// The condition.
        place: String,
        /// Why; names the case.
        cause: SolveError,
    },
}
