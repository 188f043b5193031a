//! What can be varied in a sweep.

use serde::{Deserialize, Serialize};

/// A number that a simulation needs: an axis of a sweep, or fixed in it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub enum Parameter {
    /// Instantaneous shear modulus of the one term, MPa.
    #[serde(rename = "mu_MPa")]
    Mu,
    /// Exponent of the one term.
    #[serde(rename = "alpha")]
    Alpha,
    /// Poisson's ratio (Hyperfoam).
    #[serde(rename = "nu")]
    Nu,
    /// Compressibility `D` of the Ogden law (thesis Eq. 2), 1/MPa.
    #[serde(rename = "D_per_MPa")]
    D,
    /// `D mu`, in place of `D`: at a given product the force is proportional to `mu`.
    #[serde(rename = "D_mu")]
    DMu,
    /// Relative shear modulus that relaxes (thesis Eq. 10).
    #[serde(rename = "g")]
    G,
    /// Relative bulk modulus that relaxes (thesis Eq. 11).
    #[serde(rename = "k")]
    K,
    /// Relaxation time, s.
    #[serde(rename = "tau_s")]
    Tau,
    /// Coulomb's coefficient between ball and specimen.
    #[serde(rename = "friction")]
    Friction,
    /// Radius of the ball, mm.
    #[serde(rename = "ball_radius_mm")]
    BallRadius,
    /// Height of the specimen, mm.
    #[serde(rename = "height_mm")]
    Height,
    /// Radius of the specimen, mm.
    #[serde(rename = "specimen_radius_mm")]
    SpecimenRadius,
}

impl Parameter {
    /// All of them, in the order in which they are declared.
    pub const ALL: [Self; 12] = [
        Self::Mu,
        Self::Alpha,
        Self::Nu,
        Self::D,
        Self::DMu,
        Self::G,
        Self::K,
        Self::Tau,
        Self::Friction,
        Self::BallRadius,
        Self::Height,
        Self::SpecimenRadius,
    ];

    /// The name in files, with its unit.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Mu => "mu_MPa",
            Self::Alpha => "alpha",
            Self::Nu => "nu",
            Self::D => "D_per_MPa",
            Self::DMu => "D_mu",
            Self::G => "g",
            Self::K => "k",
            Self::Tau => "tau_s",
            Self::Friction => "friction",
            Self::BallRadius => "ball_radius_mm",
            Self::Height => "height_mm",
            Self::SpecimenRadius => "specimen_radius_mm",
        }
    }

    /// The parameter of a name, if there is one.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|p| p.name() == name)
    }

    /// Whether the value makes sense, and what would.
    #[must_use]
    pub fn accepts(self, value: f64) -> (bool, &'static str) {
        match self {
            Self::Mu => (value > 0.0 && value <= 1e4, "a modulus above 0 and at most 10000 MPa"),
            Self::Alpha => (value != 0.0 && value.abs() <= 100.0, "an exponent of -100 to 100, not 0"),
            Self::Nu => (value > -1.0 && value < 0.5, "a ratio above -1 and below 0.5"),
            Self::D | Self::DMu => (value > 0.0 && value <= 1e6, "a number above 0 and at most 1e6"),
            Self::G | Self::K => ((0.0..1.0).contains(&value), "a relative modulus from 0 to below 1"),
            Self::Tau => (value > 0.0 && value <= 1e9, "a time above 0 and at most 1e9 s"),
            Self::Friction => ((0.0..=2.0).contains(&value), "a coefficient of 0 to 2"),
            Self::BallRadius | Self::Height | Self::SpecimenRadius => {
                ((0.05..=1000.0).contains(&value), "a length of 0.05 to 1000 mm")
            }
        }
    }
}
