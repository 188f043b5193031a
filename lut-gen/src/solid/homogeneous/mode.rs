//! How a homogeneous specimen is deformed.

use crate::scalar::Real;

/// A homogeneous state of deformation. Axes: 3 is the axis of the test, 1 and 2 are lateral.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Mode {
    /// Compression or tension along the axis between frictionless faces, the sides free of stress.
    Uniaxial,
    /// Compression or tension along the axis, the sides held at a stretch of 1.
    Confined,
    /// Equal stretches of both lateral axes, the axis free of stress (inflated sheet).
    Equibiaxial,
    /// Compression or tension along the axis, one side held at a stretch of 1, the other free of stress ("pure shear").
    Planar,
    /// Simple shear `x1 = X1 + gamma X3` at constant volume; the stretch of a programme is then `1 + gamma`.
    SimpleShear,
}

impl Mode {
    /// True when a lateral stretch follows from a stress that is zero.
    #[must_use]
    pub fn has_free_side(self) -> bool {
        matches!(self, Self::Uniaxial | Self::Equibiaxial | Self::Planar)
    }

    /// Deformation gradient `[11, 13, 31, 33, 22]` at a stretch and a free lateral stretch.
    pub(super) fn gradient<T: Real>(self, stretch: f64, side: T) -> [T; 5] {
        let (zero, one, l) = (T::from(0.0), T::from(1.0), T::from(stretch));
        match self {
            Self::Uniaxial => [side, zero, zero, l, side],
            Self::Confined => [one, zero, zero, l, one],
            Self::Equibiaxial => [l, zero, zero, side, l],
            Self::Planar => [side, zero, zero, l, one],
            Self::SimpleShear => [one, l - 1.0, zero, one, one],
        }
    }

    /// Derivative of the gradient by the free lateral stretch.
    pub(super) fn direction(self) -> [f64; 5] {
        match self {
            Self::Uniaxial => [1.0, 0.0, 0.0, 0.0, 1.0],
            Self::Equibiaxial => [0.0, 0.0, 0.0, 1.0, 0.0],
            Self::Planar => [1.0, 0.0, 0.0, 0.0, 0.0],
            Self::Confined | Self::SimpleShear => [0.0; 5],
        }
    }

    /// The nominal stress that is measured.
    pub(super) fn measured<T: Real>(self, stress: &[T; 5]) -> T {
        match self {
            Self::Uniaxial | Self::Confined | Self::Planar => stress[3],
            Self::Equibiaxial => stress[0],
            Self::SimpleShear => stress[1],
        }
    }
}

impl std::fmt::Display for Mode {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Uniaxial => "uniaxial",
            Self::Confined => "confined",
            Self::Equibiaxial => "equibiaxial",
            Self::Planar => "planar",
            Self::SimpleShear => "simple shear",
        })
    }
}
