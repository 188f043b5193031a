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
}
