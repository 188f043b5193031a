//! Rigid counterparts.

/// A rigid shape, symmetric about x = 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shape {
    /// A flat plate.
    Plate,
    /// A ball, in the plane a cylinder.
    Ball {
        /// Its radius (mm).
        radius_mm: f64,
    },
}

/// A rigid body with its tip towards the other side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rigid {
    /// Its shape.
    pub shape: Shape,
    /// Where its tip is before it moves (mm).
    pub tip_mm: f64,
}

/// A profile at a place: height (mm), slope, and second derivative (1/mm).
pub type Profile = [f64; 3];

impl Shape {
    /// The profile at `x` with its tip at 0; `up` is -1 for a shape that lies above and bends
    /// upward from its tip, 1 for one below. `None` beside it.
    #[must_use]
    pub fn profile(self, x: f64, up: f64) -> Option<Profile> {
        match self {
            Self::Plate => Some([0.0; 3]),
            Self::Ball { radius_mm: r } => {
                let square = r * r - x * x;
                (square > 0.0).then(|| {
                    let root = square.sqrt();
                    // sinking from the tip, without cancellation
                    [-up * x * x / (r + root), -up * x / root, -up * r * r / (square * root)]
                })
            }
        }
    }
}
