//! The rigid body that presses: a ball or a flat platen.

use super::{Ball, Touch};
use crate::scalar::Real;

/// A rigid body above the specimen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Indenter<T = f64> {
    /// A ball on a shank.
    Ball(Ball<T>),
    /// A plane across the axis, wider than the specimen.
    Platen(Platen),
}

/// A flat platen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Platen {
    /// True when the specimen's top is glued to it and so does not move radially; its friction is then for
    /// what folds onto it from the side.
    pub bonded: bool,
}

impl<T> From<Ball<T>> for Indenter<T> {
    fn from(ball: Ball<T>) -> Self {
        Self::Ball(ball)
    }
}

impl<T> From<Platen> for Indenter<T> {
    fn from(platen: Platen) -> Self {
        Self::Platen(platen)
    }
}

impl<T: Real> Indenter<T> {
    /// The point `x = [r, z]` and the indenter whose datum is at height `datum_mm`: a ball's centre, a platen's face.
    pub(super) fn touch(&self, x: [T; 2], datum_mm: T) -> Touch<T> {
        match self {
            Self::Ball(ball) => ball.touch(x, datum_mm),
            Self::Platen(_) => Touch {
                depth_mm: x[1] - datum_mm,
                normal: [T::from(0.0), T::from(-1.0)],
                curvature: T::from(0.0),
                arc_mm: x[0],
                arc_slope: T::from(1.0),
            },
        }
    }

    /// Height of the datum (mm) when the indenter is `depth_mm` below the untouched top at `height_mm`.
    pub(super) fn datum_mm(&self, height_mm: T, depth_mm: T) -> T {
        match self {
            Self::Ball(ball) => height_mm + ball.radius_mm - depth_mm,
            Self::Platen(_) => height_mm - depth_mm,
        }
    }
}
