//! The motion and the condition of a run that could be made.

/// What is pressed, or what loads the sensor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum On {
    /// The specimen.
    Specimen,
    /// A stiff block, to a load in N.
    Block(f64),
    /// A known load on the sensor, N.
    Mass(f64),
    /// Nothing.
    Air,
    /// A coupon of the specimen's foam and height, in a ring that fits it; its diameter in mm.
    Confined(f64),
}

/// Motion and condition of a run that could be made; each is made twice, on the specimen on fresh spots.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plan {
    /// What is pressed.
    pub on: On,
    /// Index of the specimen whose material, base and declared height are meant.
    pub specimen: usize,
    /// Height, as a factor on that of the specimen.
    pub height: f64,
    /// Index of the ball that is used, or scaled.
    pub indenter: usize,
    /// Radius, as a factor on that of the ball.
    pub radius: f64,
    /// Rate of loading and unloading, mm/s.
    pub rate_mm_per_s: f64,
    /// Largest depth, mm; of a coupon, what it is shortened by.
    pub depth_mm: f64,
    /// Hold at the deepest point, s.
    pub hold_s: f64,
    /// Whether the way back is recorded.
    pub unload: bool,
    /// Presses on one spot.
    pub cycles: usize,
}

/// Samples a second that a planned run is recorded with.
pub(super) const SAMPLE_HZ: f64 = 50.0;
/// Two significant digits.
pub(super) fn significant(x: f64) -> f64 {
    let digits = 10_f64.powf(1.0 - x.abs().max(1e-12).log10().floor());
    (x * digits).round() / digits
}
