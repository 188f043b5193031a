//! The block, and how finely it is resolved.

use serde::{Deserialize, Serialize};

use crate::solid::mesh::Sizes;
use crate::solid::solve::{Base, SolveError};

/// A cylindrical block with free sides.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Specimen {
    /// Height `h` (mm).
    pub height_mm: f64,
    /// Radius `W` (mm).
    pub radius_mm: f64,
    /// How its bottom is held.
    pub base: Base,
}

impl Specimen {
    /// A bonded block of the default radius, 25 mm.
    #[must_use]
    pub fn of_height(height_mm: f64) -> Self {
        Self { height_mm, radius_mm: 25.0, base: Base::Bonded }
    }
}

/// How finely an indentation is resolved.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum Resolution {
    /// One mesh: within 0.25 % of a mesh refined 2.5 times from 0.25 mm on for a 4 mm depth (docs/physics.md).
    Standard,
    /// Two meshes, the finer with all sizes divided by 1.5: their difference states the error.
    Fine,
    /// One mesh with all element sizes divided by the given factor.
    Refined(f64),
}

impl Resolution {
    /// A mesh with elements smaller by 1.5 than the finest of this one, to measure its error with.
    #[must_use]
    pub fn finer(self) -> Self {
        Self::Refined(1.5 * self.finest())
    }

    pub(super) fn refinements(self) -> Vec<f64> {
        match self {
            Self::Standard => vec![1.0],
            Self::Fine => vec![1.0, 1.5],
            Self::Refined(factor) => vec![factor],
        }
    }

    /// Divisor of the element sizes of the finest mesh.
    pub(crate) fn finest(self) -> f64 {
        self.refinements().into_iter().fold(0.0, f64::max)
    }

    /// # Errors
    /// A factor outside 0.3..6.
    pub(super) fn check(self) -> Result<(), SolveError> {
        match self {
            Self::Refined(factor) if !(0.3..=6.0).contains(&factor) => {
                Err(SolveError::parameter("refinement", factor, "must lie in 0.3..6"))
            }
            _ => Ok(()),
        }
    }
}

/// Element sizes in ball radii: of some fifty combinations, the one whose force error over exponents
/// 1 to 24, heights 5 to 25 mm and balls 4 to 8 mm was smallest for its time (docs/performance.md).
/// Flat elements at the surface help little: what counts is their width under the contact's edge.
pub(super) const SIZES: Sizes = Sizes {
    axis: 0.05,
    growth_under: 0.06,
    near: 1.1,
    growth_far: 0.6,
    surface: 0.1,
    growth_down: 0.35,
    refinement: 1.0,
};
