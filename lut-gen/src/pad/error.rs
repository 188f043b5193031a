//! What can be wrong with a press, in words that name the value.

/// A press that cannot be made or did not come to an end.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PadError {
    /// A value outside the range in which it has a meaning.
    #[error("{parameter} is {value}: expected {expected}")]
    Value {
        /// Its name, with its unit.
        parameter: &'static str,
        /// The value.
        value: f64,
        /// What was expected.
        expected: &'static str,
    },
    /// Memory does not suffice for the factor.
    #[error("the equations ({unknowns}) do not fit the memory: ask for larger elements")]
    Memory {
        /// Number of equations.
        unknowns: usize,
    },
    /// No equilibrium was found, however short the step.
    #[error("no equilibrium after {reached_mm:.4} mm of travel: the residual stays at {left:.2e} N for {wanted:.2e} N")]
    Stuck {
        /// Travel of the last equilibrium, mm.
        reached_mm: f64,
        /// Residual of the last try, N (in the plane N/mm).
        left: f64,
        /// Residual that would have done.
        wanted: f64,
    },
}

/// Refuses a value unless `good`.
pub(super) fn demand(good: bool, parameter: &'static str, value: f64, expected: &'static str) -> Result<(), PadError> {
    if good { Ok(()) } else { Err(PadError::Value { parameter, value, expected }) }
}
