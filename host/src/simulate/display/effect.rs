//! Flaws of a simulated display.

/// One flaw. Those whose code begins with `outside-` are in no catalogue: a diagnosis should answer "unknown".
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum DisplayEffect {
    /// Dead time between command and drive, s.
    Delay {
        /// Time, s.
        seconds: f64,
    },
    /// Largest speed of the shaft.
    RateLimit {
        /// Speed, mm/s.
        mm_per_s: f64,
    },
    /// Dry friction, as the command that it holds.
    Stiction {
        /// Command, mm (1 mm/V).
        mm: f64,
    },
    /// Play between spindle and potentiometer.
    Backlash {
        /// Whole play, mm.
        mm: f64,
    },
    /// The reading grows with the logarithm of time under load.
    Creep {
        /// Fraction a decade.
        per_decade: f64,
    },
    /// A part of the reading follows late.
    Memory {
        /// Fraction.
        amplitude: f64,
        /// Time constant, s.
        tau_s: f64,
    },
    /// The sensor reads more on the way back.
    Hysteresis {
        /// Half width, fraction of the force.
        half_width: f64,
    },
    /// Conductance is a power of the force.
    Nonlinearity {
        /// Exponent.
        power: f64,
    },
    /// The winding warms.
    Heating {
        /// Heat capacity, J/K.
        j_per_k: f64,
    },
    /// The core saturates.
    Saturation {
        /// Flux density, T.
        tesla: f64,
    },
    /// The core remembers.
    Remanence {
        /// Flux density that stays, T.
        tesla: f64,
        /// Change of current that turns it, A.
        ampere: f64,
    },
    /// True less recorded gap, mm.
    Gap {
        /// Offset, mm.
        mm: f64,
    },
    /// The pulp's force lies at other compressions.
    PulpSize {
        /// Compression over that of the round finger.
        ratio: f64,
    },
    /// A part of the pulp's force relaxes.
    PulpRelaxation {
        /// Part of the force at once.
        part: f64,
        /// Time constant, s.
        tau_s: f64,
    },
    /// The yield stress bends towards a largest one.
    YieldLaw {
        /// That stress, kPa.
        most_kpa: f64,
    },
    /// The fluid bears something without a field.
    FluidRest {
        /// Shear yield stress, kPa.
        kpa: f64,
    },
    /// The fluid bears more the faster it is pressed.
    FluidViscosity {
        /// Stress over the finger's speed, kPa s/mm.
        kpa_s_per_mm: f64,
    },
    /// The yield stress follows the flux late.
    FluidResponse {
        /// Time constant, s.
        seconds: f64,
    },
    /// The spindle's pitch shows in the position: an error that repeats along the stroke.
    OutsideRipple {
        /// Amplitude, mm.
        mm: f64,
        /// Pitch, mm.
        pitch_mm: f64,
    },
    /// The shaft overshoots: a second, softer mode between spindle and shaft.
    OutsideWobble {
        /// Share of the motion that is in it.
        share: f64,
        /// Frequency, Hz.
        hz: f64,
    },
    /// The reading has a part in proportion to the force's rate.
    OutsideViscous {
        /// Time, s.
        seconds: f64,
    },
    /// The drive gives no more than a current.
    OutsideClip {
        /// Current, A.
        ampere: f64,
    },
    /// The skin's ridges give way one after the other.
    OutsideRidges {
        /// Part of the force.
        part: f64,
        /// From ridge to ridge, mm of compression.
        pitch_mm: f64,
    },
    /// The cup of the fluid ends: it bears more near its ground.
    OutsideCup {
        /// Part of the stress that is added at 3 mm; it grows with the cube of the travel.
        part: f64,
    },
    /// Eddy currents: the flux follows late.
    OutsideEddy {
        /// Time constant, s.
        seconds: f64,
    },
}

impl DisplayEffect {
    /// Code in specifications; that of the catalogue where there is one.
    #[must_use]
    pub fn code(self) -> &'static str {
        match self {
            Self::Delay { .. } => "delay",
            Self::RateLimit { .. } => "rate-limit",
            Self::Stiction { .. } | Self::Backlash { .. } => "stiction",
            Self::Creep { .. } | Self::Memory { .. } | Self::Hysteresis { .. } => "sensor-creep",
            Self::Nonlinearity { .. } => "sensor-nonlinearity",
            Self::Heating { .. } => "coil-heating",
            Self::Saturation { .. } => "saturation",
            Self::Remanence { .. } => "remanence",
            Self::Gap { .. } => "gap",
            Self::PulpSize { .. } => "pulp-size",
            Self::PulpRelaxation { .. } => "pulp-relaxation",
            Self::YieldLaw { .. } => "yield-law",
            Self::FluidRest { .. } => "fluid-rest",
            Self::FluidViscosity { .. } => "fluid-viscosity",
            Self::FluidResponse { .. } => "fluid-response",
            Self::OutsideRidges { .. } => "outside-ridges",
            Self::OutsideCup { .. } => "outside-cup",
            Self::OutsideRipple { .. } => "outside-ripple",
            Self::OutsideWobble { .. } => "outside-wobble",
            Self::OutsideViscous { .. } => "outside-viscous",
            Self::OutsideClip { .. } => "outside-clip",
            Self::OutsideEddy { .. } => "outside-eddy",
        }
    }
}
