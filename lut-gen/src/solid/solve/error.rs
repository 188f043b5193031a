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
    Law(#[from] crate::solid::law::LawError),
    /// Newton's method failed even with the smallest step.
    #[error(
        "no equilibrium beyond depth {depth_mm:.4} mm of {wanted_mm} mm (time {time_s:.4} s; {case}): \
         the smallest step failed after {iterations} corrections"
    )]
    NoConvergence {
        /// Last depth with equilibrium (mm).
        depth_mm: f64,
        /// Depth wanted (mm).
        wanted_mm: f64,
        /// Time of the last equilibrium (s).
        time_s: f64,
        /// Corrections spent.
        iterations: usize,
        /// Material, specimen, ball, friction.
        case: String,
    },
    /// The cap on factorisations of the whole path was reached.
    #[error("gave up at depth {depth_mm:.4} mm of {wanted_mm} mm ({case}): {iterations} corrections spent")]
    TooManyIterations {
        /// Last depth with equilibrium (mm).
        depth_mm: f64,
        /// Depth wanted (mm).
        wanted_mm: f64,
        /// Corrections spent.
        iterations: usize,
        /// Material, specimen, ball, friction.
        case: String,
    },
    /// A path was found, but it contradicts itself.
    #[error("the curve is not to be trusted ({case}): {measure} is {value:.3}, above {limit}")]
    Unreliable {
        /// What was measured.
        measure: &'static str,
        /// Its value.
        value: f64,
        /// The most that is accepted.
        limit: f64,
        /// Material, specimen, ball, friction.
        case: String,
    },
    /// A parameter that the simulation does not have.
    #[error("{parameter} {expected}")]
    Unknown {
        /// Name of the parameter.
        parameter: String,
        /// What it is not.
        expected: String,
    },
    /// No lateral stretch leaves the free side of a homogeneous specimen without stress.
    #[error("no {mode} state without lateral stress at stretch {stretch} (time {time_s:.4} s; {case})")]
    NoFreeSide {
        /// The mode.
        mode: String,
        /// The stretch.
        stretch: f64,
        /// Time since the programme's start (s).
        time_s: f64,
        /// The material.
        case: String,
    },
    /// The tangent at an equilibrium could not be solved with.
    #[error("the tangent at depth {depth_mm:.4} mm is singular: no sensitivity there")]
    Singular {
        /// Depth (mm).
        depth_mm: f64,
    },
    /// The factor did not fit into memory.
    #[error("not enough memory to factorise {unknowns} equations")]
    Memory {
        /// Number of equations.
        unknowns: usize,
    },
}

impl SolveError {
    /// A parameter that makes no sense.
    pub(crate) fn parameter(parameter: &'static str, value: f64, expected: &str) -> Self {
        Self::Parameter { parameter, value, expected: expected.to_owned() }
    }
}
