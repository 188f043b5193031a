//! What can go wrong in an explicit run.

/// Why an explicit run gave no curve.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum DynamicsError {
    /// A setting of the run makes no sense.
    #[error("{parameter} = {value} {expected}")]
    Parameter {
        /// Name of the setting.
        parameter: &'static str,
        /// The value given.
        value: f64,
        /// What was expected.
        expected: String,
    },
    /// The indentation itself makes no sense.
    #[error(transparent)]
    Indentation(#[from] crate::solid::solve::SolveError),
    /// An element was turned inside out.
    #[error(
        "element {element} was turned inside out at depth {depth_mm:.4} mm, after {steps} steps of about {step_s:.2e} s"
    )]
    Inverted {
        /// Index of the element.
        element: usize,
        /// Depth of the ball (mm).
        depth_mm: f64,
        /// Steps done.
        steps: usize,
        /// Last step (s).
        step_s: f64,
    },
    /// The run would take too long.
    #[error(
        "pressing takes {needed:.0} steps of {step_s:.2e} s, more than the {allowed} allowed: press faster than {rate_mm_s} mm/s or scale the mass"
    )]
    TooManySteps {
        /// Steps needed at the present critical step.
        needed: f64,
        /// Step (s).
        step_s: f64,
        /// Steps allowed.
        allowed: usize,
        /// Rate (mm/s).
        rate_mm_s: f64,
    },
}
