//! What is to be simulated, as plain data.

use crate::experiment::{Base, Test};

use super::effect::Effect;

/// Law that the specimen truly follows before any effect.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum TrueLaw {
    /// Hyperfoam (thesis Eq. 1), of one or two terms of one Poisson's ratio.
    Hyperfoam,
    /// Ogden (thesis Eq. 2); Poisson's ratio gives the compressibility of the first term.
    Ogden,
    /// A stiff elastic block of this reduced modulus `E*` (MPa): Hertz's contact, no finite elements.
    Rigid {
        /// `E / (1 - nu^2)` of the block, MPa.
        reduced_modulus_mpa: f64,
    },
}

/// A second term of the law that is declared as well (an undeclared one is the effect `second-term`).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SecondTerm {
    /// Shear modulus of the term, MPa.
    pub mu_mpa: f64,
    /// Its exponent.
    pub alpha: f64,
}

/// A specimen: its true material, and what is declared of its shape.
#[derive(Debug, Clone, PartialEq)]
pub struct TrueSpecimen {
    /// Name.
    pub name: String,
    /// Law.
    pub law: TrueLaw,
    /// Shear modulus, MPa; not used by a rigid block.
    pub mu_mpa: f64,
    /// Exponent; not used by a rigid block.
    pub alpha: f64,
    /// Poisson's ratio; the base model assumes 0 for foams.
    pub nu: f64,
    /// Second term, declared with `terms = 2`.
    pub second: Option<SecondTerm>,
    /// Declared height, mm.
    pub height_mm: f64,
    /// Declared radius, mm.
    pub radius_mm: f64,
    /// Declared base.
    pub base: Base,
    /// Linear thermal strain: it is warmer than when its lengths were declared, has grown freely by this, and is then put into
    /// place; only a ring holds its sides where they were. 0 without.
    pub thermal_strain: f64,
}

/// A ball and its declared radius.
#[derive(Debug, Clone, PartialEq)]
pub struct TrueIndenter {
    /// Name.
    pub name: String,
    /// Declared radius, mm.
    pub radius_mm: f64,
}

/// Runs of one kind: `replicates` spots, `cycles` runs on each.
#[derive(Debug, Clone, PartialEq)]
pub struct RunTemplate {
    /// What is done: [`Test::Indentation`], [`Test::Uniaxial`], [`Test::Confined`], [`Test::Air`] or [`Test::Mass`].
    pub test: Test,
    /// Name of the specimen; `None` for air and mass.
    pub specimen: Option<String>,
    /// Name of the ball; `None` for air, mass and coupons.
    pub indenter: Option<String>,
    /// Rate of the recorded depth, mm/s.
    pub rate_mm_s: f64,
    /// Largest recorded depth, mm; of a coupon, what it is shortened by. A rigid block is pressed until `load_n` instead.
    pub depth_mm: f64,
    /// Standing at the largest depth, s; for air and mass the duration of the run.
    pub hold_s: f64,
    /// Back to the start at the same rate.
    pub unload: bool,
    /// Runs on one spot, one after another.
    pub cycles: usize,
    /// Time between these, s.
    pub rest_s: f64,
    /// Spots.
    pub replicates: usize,
    /// Load of a mass test or on a rigid block, N.
    pub load_n: f64,
    /// How far above the declared surface the recording begins (and ends), mm.
    pub air_mm: f64,
    /// Never to be fitted.
    pub hold_out: bool,
}

impl RunTemplate {
    /// One loading ramp to a depth (mm) at a rate (mm/s): no hold, no way back, one spot.
    #[must_use]
    pub fn ramp(specimen: &str, indenter: &str, depth_mm: f64, rate_mm_s: f64) -> Self {
        Self {
            test: Test::Indentation,
            specimen: Some(specimen.to_owned()),
            indenter: Some(indenter.to_owned()),
            rate_mm_s,
            depth_mm,
            hold_s: 0.0,
            unload: false,
            cycles: 1,
            rest_s: 30.0,
            replicates: 1,
            load_n: 1.0,
            air_mm: 0.0,
            hold_out: false,
        }
    }
}

/// The session in which the runs are made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Session {
    /// Spots in random order (cycles of a spot stay together), else as written, replicate by replicate.
    pub random_order: bool,
    /// From the end of a spot's last run to the start of the next, s.
    pub gap_s: f64,
    /// Start of the first run on the session clock, s: more than 0 where a session is continued.
    pub start_s: f64,
}

impl Default for Session {
    fn default() -> Self {
        Self { random_order: true, gap_s: 20.0, start_s: 0.0 }
    }
}

/// What chance adds. All zero by default: no noise.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Noise {
    /// Standard deviation of the force noise, N.
    pub sensor_n: f64,
    /// Its correlation time (AR(1)), s; 0 is white.
    pub correlation_s: f64,
    /// Standard deviation of the contact point, one draw a spot, mm.
    pub contact_jitter_mm: f64,
    /// Relative standard deviation of the force's gain, one draw a spot.
    pub gain_jitter: f64,
    /// Standard deviation of the logarithm of what relaxation, softening, friction and adhesion do to the force, one draw a spot: places
    /// that differ. Coupons do not.
    pub memory_jitter: f64,
    /// Step of the reading, N; 0 for none.
    pub quantum_n: f64,
    /// Wandering of the zero over the session: standard deviation of a random walk after an hour, N.
    pub drift_n_per_h: f64,
    /// Student's t of 3 degrees of freedom (scaled to the same standard deviation) instead of normal noise.
    pub heavy_tails: bool,
    /// Further noise, its standard deviation as a part of the force.
    pub proportional: f64,
}

/// An experiment to be simulated.
#[derive(Debug, Clone, PartialEq)]
pub struct Spec {
    /// Title, written into the folder.
    pub name: String,
    /// Seed of everything that is chance.
    pub seed: u64,
    /// Samples a second.
    pub sample_hz: f64,
    /// Divisor of the standard mesh's element sizes.
    pub refinement: f64,
    /// Specimens.
    pub specimens: Vec<TrueSpecimen>,
    /// Balls.
    pub indenters: Vec<TrueIndenter>,
    /// Kinds of runs.
    pub runs: Vec<RunTemplate>,
    /// Session.
    pub session: Session,
    /// Noise.
    pub noise: Noise,
    /// Write `noise.sensor_n` into the folder as the sensor's stated noise.
    pub state_noise: bool,
    /// What makes the truth differ from what is declared.
    pub effects: Vec<Effect>,
}

/// Elements of simulated data are smaller than the standard ones by this.
pub const FINER: f64 = 1.5;

/// Samples a second unless stated.
pub const SAMPLE_HZ: f64 = 50.0;

impl Spec {
    /// Nothing in it yet: 50 Hz, the finer mesh, random order, no noise.
    #[must_use]
    pub fn new(name: &str, seed: u64) -> Self {
        Self {
            name: name.to_owned(),
            seed,
            sample_hz: SAMPLE_HZ,
            refinement: FINER,
            specimens: Vec::new(),
            indenters: Vec::new(),
            runs: Vec::new(),
            session: Session::default(),
            noise: Noise::default(),
            state_noise: false,
            effects: Vec::new(),
        }
    }

    /// Adds a one-term foam of `nu = 0` on a bonded base, radius 25 mm.
    #[must_use]
    pub fn foam(mut self, name: &str, mu_mpa: f64, alpha: f64, height_mm: f64) -> Self {
        self.specimens.push(TrueSpecimen {
            name: name.to_owned(),
            law: TrueLaw::Hyperfoam,
            mu_mpa,
            alpha,
            nu: 0.0,
            second: None,
            height_mm,
            radius_mm: 25.0,
            base: Base::Bonded,
            thermal_strain: 0.0,
        });
        self
    }

    /// Adds a ball.
    #[must_use]
    pub fn ball(mut self, name: &str, radius_mm: f64) -> Self {
        self.indenters.push(TrueIndenter { name: name.to_owned(), radius_mm });
        self
    }

    /// Adds an effect.
    #[must_use]
    pub fn with(mut self, effect: Effect) -> Self {
        self.effects.push(effect);
        self
    }

    /// The specimen of a name.
    #[must_use]
    pub fn specimen(&self, name: &str) -> Option<&TrueSpecimen> {
        self.specimens.iter().find(|one| one.name == name)
    }

    /// The ball of a name.
    #[must_use]
    pub fn indenter(&self, name: &str) -> Option<&TrueIndenter> {
        self.indenters.iter().find(|one| one.name == name)
    }
}
