//! What MultiStart looked at.

use crate::identify::simplex::Descent;

/// A point of the map.
#[derive(Debug, Clone, PartialEq)]
pub struct Sampled {
    /// Coordinates.
    pub point: Vec<f64>,
    /// Eq. 14 there, N.
    pub objective_n: f64,
}

/// A simplex search from one candidate, restarts included.
#[derive(Debug, Clone)]
pub struct Start {
    /// Its path; values in N.
    pub descent: Descent,
    /// A simplex restarted at its end, which is solved, came back to it.
    pub at_rest: bool,
}
