//! The catalogue: what a simulated indentation may get wrong, one departure a file.
//!
//! Each file says which assumption of the base model the effect breaks, where it acts in the [chain](crate::chain),
//! its parameters with unit, null value and bounds, and holds the physics of that stage.

pub mod adhesion;
pub mod compliance;
pub mod contact_offset;
pub mod depth_gain;
pub mod drift;
pub mod friction;
pub mod lag;
pub mod nameless;
pub mod numerics;
pub mod poisson;
pub mod radius;
pub mod relaxation;
pub mod second_term;
pub mod sensor_creep;
pub mod sensor_gain;
pub mod sensor_nonlinearity;
pub mod softening;
pub mod thickness;
pub mod time_gain;

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

/// How a parameter of an effect is searched.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Spread {
    /// Evenly in its value.
    Even,
    /// Evenly in its logarithm; for parameters that have no null value, such as a time.
    Logarithmic,
}

/// Sizes of an experiment that amounts of effects are in proportion to: a ball of 2 mm is not wrong by as much as one of 12 mm may be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sizes {
    /// Largest force, N.
    pub force_n: f64,
    /// Radius of the ball that an effect belongs to, mm; of one that belongs to all, the largest.
    pub radius_mm: f64,
    /// Height of the specimen, likewise, mm.
    pub height_mm: f64,
    /// Fastest rate of loading, mm/s.
    pub rate_mm_per_s: f64,
    /// The longest run, s.
    pub run_s: f64,
}

/// Powers of [`Sizes`] that an amount is in proportion to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Grows {
    force: i32,
    radius: i32,
    height: i32,
    rate: i32,
}

impl Grows {
    /// The same whatever the experiment is.
    pub(crate) const NOT: Self = Self { force: 0, radius: 0, height: 0, rate: 0 };

    fn by(self, sizes: &Sizes) -> f64 {
        let power = |size: f64, power: i32| size.max(1e-9).powi(power);
        power(sizes.force_n, self.force)
            * power(sizes.radius_mm, self.radius)
            * power(sizes.height_mm, self.height)
            * power(sizes.rate_mm_per_s, self.rate)
    }
}

/// One parameter of an effect.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quantity {
    /// Name in files and answers, with its unit.
    pub name: &'static str,
    /// Value at which the effect is absent; any value for a shape parameter, whose amplitude is then null.
    pub null: f64,
    /// Least value that is physically possible.
    pub low: f64,
    /// Largest value.
    pub high: f64,
    /// Standard deviation about the null value of what is there and nobody sees; 0 for a shape parameter. Where it comes from: [`Effect::prior`].
    pub prior: f64,
    /// An amount that laboratories meet; what a design cannot see of it is listed as a blind spot.
    pub plausible: f64,
    /// Values from which a search begins.
    pub starts: &'static [f64],
    /// How it is searched.
    pub spread: Spread,
    /// What it grows with: bounds, `prior`, `plausible` and `starts` are given for sizes of 1, see [`Quantity::scaled`].
    pub grows: Grows,
    /// How many of the longest runs it may be at most: a time that is far longer shows as a trend only.
    pub runs: f64,
    /// By what part of itself the true amount may be larger than the one that fits, because the effect has a property that no force shows; intervals reach that far.
    pub understated: f64,
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

/// All effects of an indentation, in physical order.
pub static CATALOGUE: [&Effect; 23] = [
    &thickness::HEIGHT,
    &thickness::EVERY_HEIGHT,
    &thickness::SLIDING,
    &poisson::EFFECT,
    &second_term::EFFECT,
    &relaxation::ONE,
    &relaxation::TWO,
    &softening::EFFECT,
    &friction::EFFECT,
    &adhesion::EFFECT,
    &contact_offset::EFFECT,
    &depth_gain::EFFECT,
    &compliance::EFFECT,
    &radius::EFFECT,
    &lag::FILTER,
    &lag::RATE_LIMIT,
    &sensor_gain::EFFECT,
    &sensor_nonlinearity::EFFECT,
    &sensor_creep::CREEP,
    &sensor_creep::HYSTERESIS,
    &drift::EFFECT,
    &time_gain::EFFECT,
    &numerics::EFFECT,
];

/// The effect of a code and form; without a form its first.
#[must_use]
pub fn find(code: &str, form: Option<&str>) -> Option<&'static Effect> {
    CATALOGUE.into_iter().find(|effect| effect.code == code && form.is_none_or(|form| form == effect.form))
}

/// What a first-order memory keeps over a time of `x` of its own, `exp(-x)`, and what it has at the end of something that comes in evenly meanwhile, `(1 - exp(-x)) / x`.
fn fading(x: f64) -> (f64, f64) {
    let faded = -(-x).exp_m1();
    // the limit is 1 for x -> 0
    (1.0 - faded, if x < 1e-9 { 1.0 } else { faded / x })
}

impl Quantity {
    /// An amplitude searched evenly from one start.
    pub(crate) const fn amplitude(
        name: &'static str,
        null: f64,
        bounds: (f64, f64),
        plausible: f64,
        starts: &'static [f64],
    ) -> Self {
        Self {
            name,
            null,
            low: bounds.0,
            high: bounds.1,
            prior: 0.0,
            plausible,
            starts,
            spread: Spread::Even,
            grows: Grows::NOT,
            runs: f64::INFINITY,
            understated: 0.0,
        }
    }

    /// The same with the standard deviation of an amount that nobody sees.
    pub(crate) const fn about(mut self, prior: f64) -> Self {
        self.prior = prior;
        self
    }

    /// The same with a unit that holds a power of a force.
    pub(crate) const fn per_force(mut self, power: i32) -> Self {
        self.grows.force = power;
        self
    }

    /// The same as a part of the ball's radius.
    pub(crate) const fn of_radius(mut self) -> Self {
        self.grows.radius = 1;
        self
    }

    /// The same as a part of the specimen's height.
    pub(crate) const fn of_height(mut self) -> Self {
        self.grows.height = 1;
        self
    }

    /// The same as a multiple of the time that the fastest rate takes for a millimetre.
    pub(crate) const fn per_rate(mut self) -> Self {
        self.grows.rate = -1;
        self
    }

    /// The same as a time of no more than some of the longest runs.
    pub(crate) const fn at_most(mut self, runs: f64) -> Self {
        self.runs = runs;
        self
    }

    /// The same where the true amount may be larger by a part of itself.
    pub(crate) const fn understated_by(mut self, part: f64) -> Self {
        self.understated = part;
        self
    }

    /// A plausible or start value in an experiment of some sizes.
    #[must_use]
    pub fn scaled(&self, value: f64, sizes: &Sizes) -> f64 {
        self.null + (value - self.null) * self.grows.by(sizes)
    }

    /// The same quantity with its bounds and its plausible amount in an experiment of some sizes.
    #[must_use]
    pub fn bounded_at(self, sizes: &Sizes) -> Self {
        let own = |value: f64| self.scaled(value, sizes);
        let low = own(self.low);
        // what is not as long as nothing is there to be searched
        let longest = (self.runs * sizes.run_s).max(2.0 * low);
        Self {
            low,
            high: own(self.high).min(longest),
            prior: own(self.null + self.prior) - self.null,
            plausible: own(self.plausible),
            ..self
        }
    }

    /// A shape parameter searched in its logarithm.
    pub(crate) const fn shape(name: &'static str, bounds: (f64, f64), plausible: f64, starts: &'static [f64]) -> Self {
        Self {
            name,
            null: plausible,
            low: bounds.0,
            high: bounds.1,
            prior: 0.0,
            plausible,
            starts,
            spread: Spread::Logarithmic,
            grows: Grows::NOT,
            runs: f64::INFINITY,
            understated: 0.0,
        }
    }
}

#[cfg(test)]
mod tests;
