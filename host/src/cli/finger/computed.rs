//! What a press of a finger leaves.

use lut_gen::pad::ellipse::Print;

use crate::finger::press::{Asked, Pressed};
use crate::finger::reading::Reading;

/// Folder of files where none is asked for.
pub(super) const DEFAULT_FOLDER: &str = "out/finger";

/// All that was computed.
pub(super) struct Study {
    /// What was asked for.
    pub asked: Asked,
    /// Its states.
    pub pressed: Pressed,
    /// What is read of them.
    pub readings: Vec<Reading>,
    /// Parts by which force and area differ on elements twice as long, one a travel, where they are asked for.
    pub apart: Option<Vec<[f64; 2]>>,
    /// Force of Hertz' sphere at the travels, N; none in the plane.
    pub sphere_n: Option<Vec<f64>>,
    /// Contact with two radii.
    pub two: Option<Two>,
}

/// A print with two radii.
pub(super) struct Two {
    /// The ratio of its radii.
    pub ratio: f64,
    /// The prints, one a travel.
    pub prints: Vec<Print>,
    /// Force of the stretched finger over that of the finger, one a travel.
    pub stretched: Vec<f64>,
}
