//! What can go wrong in a solve.

/// Why a solve gave no curve.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SolveError {
    /// A geometric or numerical parameter makes no sense.
    #[error("{parameter} = {value} {expected}")]
    Parameter {
        /// Name of the parameter.
        parameter: &'static str,
        /// The value given.
        value: f64,
        /// What was expected.
        expected: String,
    },
    /// A material parameter is out of range.
    #[error(transparent)]
    Law(#[from] crate::law::LawError),
    /// Newton's method failed even with the smallest step.
    #[error(
        "no equilibrium beyond depth {depth_mm:.4} mm of {wanted_mm} mm ({law}): \
         the step fell below {smallest_mm:.2e} mm after {iterations} iterations"
    )]
    NoConvergence {
        /// Last depth with equilibrium (mm).
        depth_mm: f64,
        /// Depth wanted (mm).
        wanted_mm: f64,
        /// Smallest step allowed (mm).
        smallest_mm: f64,
        /// Newton iterations spent.
        iterations: usize,
        /// The law and its parameters.
        law: String,
    },
    /// The iteration cap of the whole curve was reached.
    #[error("gave up at depth {depth_mm:.4} mm of {wanted_mm} mm ({law}): {iterations} Newton iterations spent")]
    TooManyIterations {
        /// Last depth with equilibrium (mm).
        depth_mm: f64,
        /// Depth wanted (mm).
        wanted_mm: f64,
        /// Newton iterations spent.
        iterations: usize,
        /// The law and its parameters.
        law: String,
    },
    /// The factor did not fit into memory.
    #[error("not enough memory to factorise {unknowns} equations")]
    Memory {
        /// Number of equations.
        unknowns: usize,
    },
}
