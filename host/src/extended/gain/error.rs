//! What can go wrong when a gain is measured.

use lut_gen::chain::LibraryError;
use lut_gen::table::LutError;

use crate::extended::ExtendedError;

/// Why no gain is measured.
#[derive(Debug, thiserror::Error)]
pub enum GainError {
    /// The model does not belong to the experiment.
    #[error(transparent)]
    Model(#[from] ExtendedError),
    /// A force model could not be made.
    #[error("no force model: {0}")]
    Force(#[from] LibraryError),
    /// A table could not be made.
    #[error("no table: {0}")]
    Table(#[from] LutError),
    /// A table is refused by its own reader.
    #[error("no table: {0}")]
    Unreadable(String),
    /// No run can be used.
    #[error("no palpation to judge: {0}")]
    Nothing(String),
    /// The noise has no covariance.
    #[error("the noise of {0} has no positive definite covariance")]
    Covariance(String),
}
