//! The law of a linear actuator: a linear part of some order, and what real ones add to it.

/// Linear part from command in V to shaft in mm.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Structure {
    /// `K / s`: the speed follows the command.
    Spindle,
    /// `K / (1 + s / p)`.
    Lag,
    /// `K / (s (1 + s / p))`: a spindle with inertia.
    SpindleLag,
    /// `K w^2 / (s^2 + 2 z w s + w^2)`.
    Mass,
    /// The same behind a lag of the drive, `1 / (1 + T s)`.
    MassLag,
}

impl Structure {
    /// All of them, the simplest first.
    pub const ALL: [Structure; 5] = [Self::Spindle, Self::Lag, Self::SpindleLag, Self::Mass, Self::MassLag];

    /// Degree of the denominator.
    #[must_use]
    pub fn order(self) -> usize {
        match self {
            Self::Spindle | Self::Lag => 1,
            Self::SpindleLag | Self::Mass => 2,
            Self::MassLag => 3,
        }
    }

    /// A held command ends in a speed, not in a place.
    #[must_use]
    pub fn integrates(self) -> bool {
        matches!(self, Self::Spindle | Self::SpindleLag)
    }

    /// In words.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Spindle => "speed follows the command (order 1, integrating)",
            Self::Lag => "one lag (order 1)",
            Self::SpindleLag => "speed follows the command with a lag (order 2, integrating)",
            Self::Mass => "mass, spring and damper (order 2)",
            Self::MassLag => "mass, spring and damper behind a lag (order 3)",
        }
    }

    /// One word, for programs.
    #[must_use]
    pub fn code(self) -> &'static str {
        match self {
            Self::Spindle => "spindle",
            Self::Lag => "lag",
            Self::SpindleLag => "spindle-lag",
            Self::Mass => "mass",
            Self::MassLag => "mass-lag",
        }
    }
}

/// An actuator with all that it adds to its linear part.
///
/// Friction is Coulomb's, as the command that it takes away: a resting shaft stays until the drive exceeds it. The rate limit bounds the
/// speed of the shaft. Play stands between the shaft and the sensor of its position. `frequency_rad_s` of [`Structure::Lag`] and
/// [`Structure::SpindleLag`] is their pole; it and `damping` and `lag_s` are not read by structures without them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Law {
    /// Linear part.
    pub structure: Structure,
    /// mm/V at rest; of an integrating one mm/(V s). Above 0.
    pub gain: f64,
    /// Place at no command, mm; of an integrating one the command that holds it, V.
    pub offset: f64,
    /// Natural frequency or pole, rad/s.
    pub frequency_rad_s: f64,
    /// Damping ratio.
    pub damping: f64,
    /// Time constant of the drive, s.
    pub lag_s: f64,
    /// Dead time, s.
    pub delay_s: f64,
    /// Largest speed, mm/s; infinite where there is none.
    pub rate_mm_s: f64,
    /// Dry friction, V.
    pub friction_v: f64,
    /// Whole width of the play, mm.
    pub play_mm: f64,
    /// Reading at the first stamp, mm.
    pub start_mm: f64,
    /// Where the shaft is in its play at the first stamp, -0.5 to 0.5 of the width.
    pub start_share: f64,
}

/// Parameters of a law that a recording can tell.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Parameter {
    /// [`Law::gain`].
    Gain,
    /// [`Law::offset`].
    Offset,
    /// [`Law::frequency_rad_s`].
    Frequency,
    /// [`Law::damping`].
    Damping,
    /// [`Law::lag_s`].
    DriveLag,
    /// [`Law::delay_s`].
    Delay,
    /// [`Law::rate_mm_s`].
    Rate,
    /// [`Law::friction_v`].
    Friction,
    /// [`Law::play_mm`].
    Play,
    /// [`Law::start_mm`].
    Start,
    /// [`Law::start_share`].
    StartShare,
}

impl Parameter {
    /// Searched over its logarithm.
    #[must_use]
    pub fn is_logarithmic(self) -> bool {
        matches!(self, Self::Gain | Self::Frequency | Self::Damping | Self::DriveLag | Self::Rate)
    }

    /// Value in a law.
    #[must_use]
    pub fn of(self, law: &Law) -> f64 {
        match self {
            Self::Gain => law.gain,
            Self::Offset => law.offset,
            Self::Frequency => law.frequency_rad_s,
            Self::Damping => law.damping,
            Self::DriveLag => law.lag_s,
            Self::Delay => law.delay_s,
            Self::Rate => law.rate_mm_s,
            Self::Friction => law.friction_v,
            Self::Play => law.play_mm,
            Self::Start => law.start_mm,
            Self::StartShare => law.start_share,
        }
    }

    /// Sets the value of a law.
    pub fn set(self, law: &mut Law, value: f64) {
        *match self {
            Self::Gain => &mut law.gain,
            Self::Offset => &mut law.offset,
            Self::Frequency => &mut law.frequency_rad_s,
            Self::Damping => &mut law.damping,
            Self::DriveLag => &mut law.lag_s,
            Self::Delay => &mut law.delay_s,
            Self::Rate => &mut law.rate_mm_s,
            Self::Friction => &mut law.friction_v,
            Self::Play => &mut law.play_mm,
            Self::Start => &mut law.start_mm,
            Self::StartShare => &mut law.start_share,
        } = value;
    }

    /// Name with its unit.
    #[must_use]
    pub fn name(self, structure: Structure) -> &'static str {
        let integrates = structure.integrates();
        match self {
            Self::Gain if integrates => "gain_mm_per_V_s",
            Self::Gain => "gain_mm_per_V",
            Self::Offset if integrates => "holding_V",
            Self::Offset => "rest_mm",
            Self::Frequency if matches!(structure, Structure::Lag | Structure::SpindleLag) => "pole_rad_per_s",
            Self::Frequency => "frequency_rad_per_s",
            Self::Damping => "damping",
            Self::DriveLag => "drive_lag_s",
            Self::Delay => "delay_s",
            Self::Rate => "rate_limit_mm_per_s",
            Self::Friction => "friction_V",
            Self::Play => "backlash_mm",
            Self::Start => "start_mm",
            Self::StartShare => "start_in_play",
        }
    }
}
