//! The effects and their parameters.

use lut_gen::solid::law::PronyTerm;

use super::rest::Rest;

/// What a placebo varies with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Variable {
    /// Recorded depth.
    Depth,
    /// Time within the run.
    Time,
    /// Session clock.
    Clock,
    /// Rate of the run.
    Rate,
    /// Declared radius of the ball.
    Radius,
    /// Number of the run on its spot.
    Cycle,
}

impl Variable {
    /// All, with their words.
    pub const ALL: [(&'static str, Self); 6] = [
        ("depth", Self::Depth),
        ("time", Self::Time),
        ("clock", Self::Clock),
        ("rate", Self::Rate),
        ("radius", Self::Radius),
        ("cycle", Self::Cycle),
    ];
}

/// One effect with its parameters (mm, N, MPa, s).
#[derive(Debug, Clone, PartialEq)]
pub enum Effect {
    /// `relaxation`: Prony terms (thesis Eqs. 10 to 13); the declared moduli are the instantaneous ones. Holds decay by about
    /// `g (1 - exp(-t / tau))` where shear and bulk relax alike, slow presses are softer.
    Relaxation(Vec<PronyTerm>),
    /// `poisson`: ratio of the foam instead of 0; positive makes the force larger on a bonded base.
    Poisson {
        /// Poisson's ratio.
        nu: f64,
    },
    /// `second-term`: a further term of the law, positive ratios add force.
    SecondTerm {
        /// `mu_2 / mu_1`.
        mu2_ratio: f64,
        /// Exponent of the second term.
        alpha2: f64,
    },
    /// `softening` (Ogden and Roxburgh): ways back and later cycles of a spot are softer.
    Softening {
        /// `1 / r` is the largest part lost.
        r: f64,
        /// Energy scale, MPa.
        m_mpa: f64,
        /// Part of the largest energy added to it.
        beta: f64,
    },
    /// `thickness` with `height_error_mm`: true height is the declared one plus this; positive is softer.
    Thickness {
        /// True less declared height, mm.
        height_error_mm: f64,
    },
    /// `thickness` with `base = "sliding"`: the base slides though declared bonded; softer.
    SlidingBase,
    /// `friction` between ball and specimen: stiffer on the way down, less force on the way back.
    Friction {
        /// Coulomb's coefficient.
        coefficient: f64,
    },
    /// `adhesion`: less force, most near contact; the ball is pulled on the way back.
    Adhesion {
        /// Work of adhesion, N/mm.
        work_n_per_mm: f64,
        /// Range of the attraction, mm.
        range_mm: f64,
    },
    /// `contact-offset`: true depth is the recorded one plus this in every run (contact found late when positive: more force).
    ContactOffset {
        /// True less recorded depth, mm.
        offset_mm: f64,
    },
    /// `depth-gain`: recorded depths are the true ones times this; a gauge that tells too much makes the foam seem softer.
    DepthGain {
        /// Gain.
        gain: f64,
    },
    /// `compliance`: recorded depth is the ball's plus this times the force; less force.
    Compliance {
        /// Compliance, mm/N.
        mm_per_n: f64,
    },
    /// `radius`: a ball's true radius is the declared one plus an error; larger is more force, only with that ball.
    Radius {
        /// Name of the ball.
        indenter: String,
        /// True less declared radius, mm.
        error_mm: f64,
    },
    /// `lag` with `lag_s`: the ball follows the recorded depth by a first order; less force on the way down.
    Lag {
        /// Time constant, s.
        lag_s: f64,
    },
    /// `lag` with `rate_limit_mm_s`: the ball moves no faster than this; less force on faster ways down.
    RateLimit {
        /// Largest rate, mm/s.
        rate_mm_s: f64,
    },
    /// `sensor-gain`: readings are the force times this.
    SensorGain {
        /// Gain.
        gain: f64,
    },
    /// `sensor-nonlinearity`: readings are `F + c F^2`.
    SensorNonlinearity {
        /// `c`, 1/N.
        quadratic_per_n: f64,
    },
    /// `sensor-creep`: readings are the force plus `amplitude` times its low-pass; holds rise when positive.
    SensorCreep {
        /// Part added in the long run.
        amplitude: f64,
        /// Time constant, s.
        tau_s: f64,
    },
    /// `sensor-creep` with `width`: readings lag behind the largest of the run, as a play of that relative width does: more
    /// on the way back than on the way down.
    SensorHysteresis {
        /// Width of the play as a part of the run's largest force.
        width: f64,
    },
    /// `drift`: the zero moves with the session clock.
    Drift {
        /// Linear part, N/h.
        n_per_h: f64,
        /// What a warming adds in the end, N.
        thermal_n: f64,
        /// Its time constant, s.
        thermal_s: f64,
    },
    /// `time-gain`: recorded times, those of the session clock included, are the true ones times this.
    TimeGain {
        /// Gain.
        gain: f64,
    },
    /// `numerics`: data of a coarse mesh (element sizes divided by `mesh`), or interpolated linearly in the exponent
    /// between multiples of `alpha_step`.
    Numerics {
        /// Divisor of the element sizes, below 1 is coarser than the standard mesh.
        mesh: Option<f64>,
        /// Step of the table in alpha.
        alpha_step: Option<f64>,
    },
    /// `outside-power-law`: fractional relaxation of the force, `1 - A + A (1 + t/t0)^-beta`.
    PowerLaw {
        /// `A`.
        amplitude: f64,
        /// `t0`, s.
        t0_s: f64,
        /// Exponent.
        beta: f64,
    },
    /// `outside-plastic-set`: after every cycle the surface of the spot stays lower by this part of the way left to the largest depth.
    PlasticSet {
        /// Part.
        share: f64,
    },
    /// `outside-stiff-skin`: a stretched skin adds `k d^3 / R`.
    StiffSkin {
        /// `k`, N/mm^2.
        stiffness_n_per_mm2: f64,
    },
    /// `outside-anisotropic`: the force is multiplied by `(d / 1 mm)^p (R / 5 mm)^q`.
    Anisotropic {
        /// `p`.
        depth_power: f64,
        /// `q`.
        radius_power: f64,
    },
    /// `outside-tilt`: the specimen lies on a slope; spots left and right of its middle are of other heights.
    Tilt {
        /// Slope, degrees.
        angle_deg: f64,
        /// Distance of the spots from the middle, mm.
        distance_mm: f64,
    },
    /// `outside-hum`: a sine on the reading, of its own phase in every run.
    Hum {
        /// Amplitude, N.
        amplitude_n: f64,
        /// Frequency before sampling, Hz.
        frequency_hz: f64,
    },
    /// `outside-stick-slip`: while the ball moves the reading builds up and falls, as a sawtooth over depth.
    StickSlip {
        /// Height of a tooth, N.
        amplitude_n: f64,
        /// Way from tooth to tooth, mm.
        period_mm: f64,
    },
    /// `outside-rest`: a smooth random process as a share of the force; what real rigs and materials add to a law.
    Rest(Rest),
    /// `placebo`: a smooth random function of one variable; no physics.
    Placebo {
        /// What it varies with.
        variable: Variable,
        /// Root mean square over the variable, as a part of the run's largest force.
        amplitude: f64,
    },
}

impl Effect {
    /// The code a diagnosis would give; what lies outside its catalogue begins with `outside-`.
    #[must_use]
    pub fn code(&self) -> &'static str {
        match self {
            Self::Relaxation(_) => "relaxation",
            Self::Poisson { .. } => "poisson",
            Self::SecondTerm { .. } => "second-term",
            Self::Softening { .. } => "softening",
            Self::Thickness { .. } | Self::SlidingBase => "thickness",
            Self::Friction { .. } => "friction",
            Self::Adhesion { .. } => "adhesion",
            Self::ContactOffset { .. } => "contact-offset",
            Self::DepthGain { .. } => "depth-gain",
            Self::Compliance { .. } => "compliance",
            Self::Radius { .. } => "radius",
            Self::Lag { .. } | Self::RateLimit { .. } => "lag",
            Self::SensorGain { .. } => "sensor-gain",
            Self::SensorNonlinearity { .. } => "sensor-nonlinearity",
            Self::SensorCreep { .. } | Self::SensorHysteresis { .. } => "sensor-creep",
            Self::Drift { .. } => "drift",
            Self::TimeGain { .. } => "time-gain",
            Self::Numerics { .. } => "numerics",
            Self::PowerLaw { .. } => "outside-power-law",
            Self::PlasticSet { .. } => "outside-plastic-set",
            Self::StiffSkin { .. } => "outside-stiff-skin",
            Self::Anisotropic { .. } => "outside-anisotropic",
            Self::Tilt { .. } => "outside-tilt",
            Self::Hum { .. } => "outside-hum",
            Self::StickSlip { .. } => "outside-stick-slip",
            Self::Rest(_) => "outside-rest",
            Self::Placebo { .. } => "placebo",
        }
    }
}
