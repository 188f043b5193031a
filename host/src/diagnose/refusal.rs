//! Why a diagnosis is not made.

/// Why a diagnosis is not made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Refusal {
    /// No run can be used.
    #[error("no run can be used: {0}")]
    NothingToFit(String),
    /// Nothing tells what noise is.
    #[error(
        "no two runs repeat a condition and no noise is stated: without one of them nobody can say what is noise and what is a discrepancy; repeat at least one condition on another spot, or state [sensor] noise_N"
    )]
    NoNoise,
    /// Repeats differ by what is no noise.
    #[error(
        "repeats of one condition differ by what neither noise of the sensor nor another contact, gain or zero on each spot explains: look at them one over the other before anything is concluded"
    )]
    NoSuchNoise,
    /// The data are not what the description says.
    #[error("{0}")]
    Faulty(String),
}
