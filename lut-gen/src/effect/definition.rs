//! What the catalogue says of each effect.

use super::quantity::Quantity;

/// Where an effect acts, in physical order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Stage {
    /// Shape of the block and how it is held.
    Specimen,
    /// The material's law.
    Material,
    /// Between ball and specimen.
    Contact,
    /// The machine that moves the ball and measures its place.
    Machine,
    /// The force sensor.
    Sensor,
    /// The session clock.
    Clock,
    /// The simulation itself.
    Numerics,
}

impl Stage {
    /// The word in reports.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Stage::Specimen => "specimen",
            Stage::Material => "material",
            Stage::Contact => "contact",
            Stage::Machine => "machine",
            Stage::Sensor => "sensor",
            Stage::Clock => "clock",
            Stage::Numerics => "numerics",
        }
    }
}

/// What kind of thing is wrong: told where no form of it can be.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Sizes of specimen and ball, and where the surface lies.
    Geometry,
    /// How the specimen resists at once.
    ElasticLaw,
    /// It creeps and relaxes.
    Memory,
    /// It is another one after it was pressed.
    History,
    /// Between ball and specimen.
    Contact,
    /// What moves the ball and says where it is.
    Machine,
    /// What says how large the force is.
    Sensor,
    /// What goes on over the session, and what says when.
    Clock,
    /// The simulation itself.
    Simulation,
}

impl Kind {
    /// The words in reports.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Kind::Geometry => "geometry",
            Kind::ElasticLaw => "elastic law",
            Kind::Memory => "memory of the specimen",
            Kind::History => "history of the specimen",
            Kind::Contact => "contact",
            Kind::Machine => "machine",
            Kind::Sensor => "sensor",
            Kind::Clock => "clock",
            Kind::Simulation => "simulation",
        }
    }
}

/// What an effect belongs to, so that each of several has its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Owner {
    /// The whole experiment.
    All,
    /// One ball.
    Indenter,
    /// One specimen.
    Specimen,
}

/// How far an effect may be wrong as it is written down, relative, on the way down and in holds, and on the way back,
/// where the edge of the contact lifts and histories matter most.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Share {
    /// The chain against finite elements of the whole path (tests/chain.rs); nature is not closer to either.
    Rough,
    /// Outside the specimen, where the chain has it as its equation says.
    Outside,
    /// Finite elements pull with 0.64 to 0.72 of what the catalogue writes down, by ball, which is 5 % about their mean.
    Adhesive,
    /// Another elastic law, of what it has beyond the base with another modulus and exponent: of the force itself it
    /// misses 0.1 to 0.2 % (tests/whole_paths.rs, tests/chain.rs).
    Elastic,
    /// What finite elements of the whole path contain.
    Solved,
    /// The same of softening: 1.0 and 1.0 % (tests/whole_paths.rs).
    Softened,
    /// The same of friction: where points stick and where they slip depends on the mesh (tests/whole_paths.rs).
    Rubbed,
}

impl Share {
    /// All of them.
    pub const ALL: [Self; 7] =
        [Self::Rough, Self::Outside, Self::Adhesive, Self::Elastic, Self::Solved, Self::Softened, Self::Rubbed];

    /// The shares, on the way down and on the way back.
    #[must_use]
    pub fn of(self) -> (f64, f64) {
        match self {
            Self::Rough => (0.02, 0.06),
            Self::Outside => (0.01, 0.02),
            Self::Adhesive => (0.05, 0.06),
            Self::Elastic => (0.0201, 0.0201),
            Self::Solved => (0.005, 0.0075),
            Self::Softened => (0.01, 0.015),
            Self::Rubbed => (0.05, 0.07),
        }
    }
}

/// What an effect may be wrong by: in the chain, and where finite elements of the whole path have it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FormError {
    /// In the chain.
    pub chain: Share,
    /// Where finite elements have it.
    pub solved: Share,
}

impl FormError {
    pub(crate) const fn of(chain: Share, solved: Share) -> Self {
        Self { chain, solved }
    }
}

/// One departure from the base model. Two entries with one code are two forms of one effect.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Effect {
    /// Stable code in answers.
    pub code: &'static str,
    /// Which of the forms it is.
    pub form: &'static str,
    /// Where it acts.
    pub stage: Stage,
    /// What kind of thing it is.
    pub kind: Kind,
    /// What the base model assumes.
    pub assumption: &'static str,
    /// What remains of it in the residual after mu and alpha are fitted again.
    pub signature: &'static str,
    /// Effects that look alike.
    pub twins: &'static [&'static str],
    /// What tells them apart.
    pub separated_by: &'static str,
    /// How large it is where nobody looked for it, with the source of that: what the standard deviations in [`Quantity::prior`] rest on.
    pub prior: &'static str,
    /// Its parameters.
    pub quantities: &'static [Quantity],
    /// What it belongs to.
    pub owner: Owner,
    /// What it may be wrong by as it is written down, which is no evidence for another one.
    pub form_error: FormError,
}
