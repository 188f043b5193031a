//! A material parameter outside the range in which its law is defined.

/// Names the law, the term, the parameter, its value and what was expected.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{law} term {term}: {parameter} = {value} {expected}")]
pub struct LawError {
    /// Name of the law.
    pub law: &'static str,
    /// Index of the term, counted from 1; 0 for the law as a whole.
    pub term: usize,
    /// Name of the parameter.
    pub parameter: &'static str,
    /// The value that was given.
    pub value: f64,
    /// What was expected of it.
    pub expected: &'static str,
}

/// Refuses `value` unless `good`.
pub(super) fn demand(
    good: bool,
    law: &'static str,
    term: usize,
    parameter: &'static str,
    value: f64,
    expected: &'static str,
) -> Result<(), LawError> {
    if good { Ok(()) } else { Err(LawError { law, term, parameter, value, expected }) }
}
