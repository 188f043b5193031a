//! What an experiment varies.

/// The variable that a margin belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Variable {
    /// Depth on the way down.
    Depth,
    /// Depth on the way back.
    Unloading,
    /// Time in the hold.
    HoldTime,
    /// Number of the press on its spot.
    Cycle,
    /// Rate of loading.
    Rate,
    /// Radius of the ball.
    Radius,
    /// Height of the specimen.
    Height,
    /// Session clock.
    Clock,
    /// A coupon compressed in a ring.
    Confined,
    /// A coupon compressed between platens.
    Compression,
    /// A stiff block instead of the specimen.
    Block,
    /// A known mass on the sensor.
    Mass,
    /// Nothing on the sensor.
    Air,
}

impl Variable {
    /// The words in answers.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Variable::Depth => "depth",
            Variable::Unloading => "unloading",
            Variable::HoldTime => "hold time",
            Variable::Cycle => "cycle",
            Variable::Rate => "rate",
            Variable::Radius => "radius",
            Variable::Height => "height",
            Variable::Clock => "session clock",
            Variable::Confined => "confined",
            Variable::Compression => "compression",
            Variable::Block => "stiff block",
            Variable::Mass => "mass",
            Variable::Air => "air",
        }
    }
}
