//! Parameters of effects: unit, null value, bounds, prior, and where a search begins.

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
    /// Standard deviation about where it begins of what is there and nobody sees; 0 for a shape parameter. Where it comes from: `Effect::prior` of the catalogue.
    pub prior: f64,
    /// An amount that laboratories meet; what a design cannot see of it is listed as a blind spot.
    pub plausible: f64,
    /// Values from which a search begins.
    pub starts: &'static [f64],
    /// How it is searched.
    pub spread: Spread,
    /// What it grows with: bounds, `begins`, `prior`, `plausible` and `starts` are given for sizes of 1, see [`Quantity::scaled`].
    pub grows: Grows,
    /// What it must be for anything to happen at all; the null value where any amount shows. A drive that is limited to more than it is asked for is not limited.
    pub begins: f64,
    /// How many of the longest runs it may be at most: a time that is far longer shows as a trend only.
    pub runs: f64,
    /// By what part of itself the true amount may be larger than the one that fits, because the effect has a property that no force shows; intervals reach that far.
    pub understated: f64,
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
            begins: null,
            runs: f64::INFINITY,
            understated: 0.0,
        }
    }

    /// The same where nothing happens below an amount; the prior's deviation is counted from there.
    pub(crate) const fn beyond(mut self, begins: f64) -> Self {
        self.begins = begins;
        self.low = begins;
        self
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

    /// The same quantity with its bounds, its plausible amount and where it begins, which is its null value then, in an experiment of some sizes.
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
            null: own(self.begins),
            begins: own(self.begins),
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
            begins: plausible,
            runs: f64::INFINITY,
            understated: 0.0,
        }
    }
}
