//! What holds and deforms a specimen in a run.

use lut_gen::solid::homogeneous::Mode;

use crate::experiment::Test;

/// What holds and deforms a specimen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Grip {
    /// A ball pressed into a block that rests on a table.
    Ball {
        /// Index into the experiment's indenters.
        indenter: usize,
        /// Its radius, mm.
        radius_mm: f64,
    },
    /// Two flat platens wider than the specimen.
    Platens,
    /// Two platens in a rigid ring that the specimen fills.
    Ring,
    /// Two jaws that pull.
    Jaws,
}

impl Grip {
    /// The grip of a test without a ball; `None` for tests that are not fitted.
    #[must_use]
    pub fn without_ball(test: Test) -> Option<Self> {
        match test {
            Test::Uniaxial => Some(Self::Platens),
            Test::Confined => Some(Self::Ring),
            Test::Tension => Some(Self::Jaws),
            _ => None,
        }
    }

    /// Index of the ball into the experiment's indenters.
    #[must_use]
    pub fn indenter(self) -> Option<usize> {
        match self {
            Self::Ball { indenter, .. } => Some(indenter),
            _ => None,
        }
    }

    /// Radius of the ball, mm; 0 without one.
    #[must_use]
    pub fn ball_mm(self) -> f64 {
        match self {
            Self::Ball { radius_mm, .. } => radius_mm,
            _ => 0.0,
        }
    }

    /// How every point of the specimen deforms where all deform alike; `None` under a ball.
    #[must_use]
    pub fn mode(self) -> Option<Mode> {
        match self {
            Self::Ball { .. } => None,
            Self::Platens | Self::Jaws => Some(Mode::Uniaxial),
            Self::Ring => Some(Mode::Confined),
        }
    }

    /// Change of stretch per depth over height: a depth shortens the specimen, between jaws it lengthens it.
    #[must_use]
    pub fn sense(self) -> f64 {
        if self == Self::Jaws { 1.0 } else { -1.0 }
    }

    /// Exponent of the force over depth at first touch: Hertz's 3/2 under a ball, 1 where the whole face is met at once.
    #[must_use]
    pub fn exponent(self) -> f64 {
        if matches!(self, Self::Ball { .. }) { 1.5 } else { 1.0 }
    }

    /// The word for it in messages.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Ball { .. } => "indentation",
            Self::Platens => "uniaxial compression",
            Self::Ring => "confined compression",
            Self::Jaws => "tension",
        }
    }
}
