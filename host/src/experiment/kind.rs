//! Kinds of runs.

/// What was done in a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Test {
    /// A ball pressed into the specimen.
    Indentation,
    /// Unconfined compression between plates.
    Uniaxial,
    /// Compression in a rigid ring.
    Confined,
    /// Pulling.
    Tension,
    /// Simple shear.
    Shear,
    /// Nothing touched: noise, zero and drift.
    Air,
    /// A known load on the sensor.
    Mass,
    /// Commanded and measured position, force and current of the display over time.
    Display,
    /// An x-y calibration.
    Table,
    /// Prints of a finger: contact area, or radii of its ellipse, over force.
    Print,
}
