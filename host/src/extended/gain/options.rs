//! How a gain is measured.

use lut_gen::solid::model::Resolution;

/// How it is measured.
#[derive(Debug, Clone, PartialEq)]
pub struct Options {
    /// True modulus (MPa) and exponent, where they are known, as for a simulated experiment.
    pub truth: Option<(f64, f64)>,
    /// Exponents of the tables.
    pub alpha: Vec<f64>,
    /// Mesh of the tables.
    pub resolution: Resolution,
}

impl Default for Options {
    /// The thesis' 30 exponents of 1 to 24 on the standard mesh.
    fn default() -> Self {
        let alpha = (0..30).map(|i| 1.0 + 23.0 * f64::from(i) / 29.0).collect();
        Self { truth: None, alpha, resolution: Resolution::Standard }
    }
}
