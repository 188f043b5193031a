//! Rests: what real rigs and materials add to a law without a cause that anybody would name.

use rand::Rng;
use rand_distr::StandardNormal;
use rand_pcg::Pcg64;

/// What a rest varies with. Lengths and rates count by their logarithm; each variable is a part of
/// its range within the experiment.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Along {
    /// Recorded depth, of the deepest.
    Depth,
    /// Size of the contact: square root of depth and radius, of the largest.
    Contact,
    /// Logarithm of the time in the run.
    Time,
    /// The way back, as a part of the depth; nothing before.
    Back,
    /// Rate of the run.
    Rate,
    /// Declared radius of the ball.
    Ball,
    /// Declared height of the specimen.
    Height,
    /// Number of the run on its spot.
    Cycle,
    /// Spot: every one has a function of its own.
    Spot,
    /// Place of the run in the session.
    Order,
}

impl Along {
    /// All, with their words.
    pub const ALL: [(&'static str, Self); 10] = [
        ("depth", Self::Depth),
        ("contact", Self::Contact),
        ("time", Self::Time),
        ("back", Self::Back),
        ("rate", Self::Rate),
        ("ball", Self::Ball),
        ("height", Self::Height),
        ("cycle", Self::Cycle),
        ("spot", Self::Spot),
        ("order", Self::Order),
    ];
}

/// Covariance of a rest.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kernel {
    /// `exp(-d^2 / (2 l^2))`: as smooth as can be.
    SquaredExponential,
    /// Matern's of 3/2: one derivative.
    Matern32,
    /// Matern's of 5/2: two derivatives.
    Matern52,
}

impl Kernel {
    /// All, with their words.
    pub const ALL: [(&'static str, Self); 3] = [
        ("squared-exponential", Self::SquaredExponential),
        ("matern-3/2", Self::Matern32),
        ("matern-5/2", Self::Matern52),
    ];

    /// A frequency (radians per length scale) of the spectrum: normal, or Student's t of twice as
    /// many degrees of freedom as the order (Rasmussen and Williams 2006, section 4.2).
    pub(super) fn frequency(self, chance: &mut Pcg64) -> f64 {
        let normal = |chance: &mut Pcg64| chance.sample::<f64, _>(StandardNormal);
        let freedom = match self {
            Self::SquaredExponential => return normal(chance),
            Self::Matern32 => 3,
            Self::Matern52 => 5,
        };
        let square: f64 = (0..freedom).map(|_| normal(chance).powi(2)).sum();
        normal(chance) / (square / f64::from(freedom)).sqrt()
    }
}

/// What a rest is a share of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ShareOf {
    /// The force at the same moment: without contact there is none.
    Force,
    /// The run's largest force, grown in over the first part of the depth.
    Peak,
}

impl ShareOf {
    /// Both, with their words.
    pub const ALL: [(&'static str, Self); 2] = [("force", Self::Force), ("peak", Self::Peak)];
}

/// A smooth random process beside the law.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rest {
    /// What it varies with.
    pub along: Along,
    /// What else it varies with.
    pub by: Option<Along>,
    /// Its covariance; over two variables the product of two.
    pub kernel: Kernel,
    /// Length scale as a part of the range of each variable.
    pub length: f64,
    /// Standard deviation, as a share of the force.
    pub amplitude: f64,
    /// Of which force.
    pub of: ShareOf,
    /// Which of the functions that are drawn alike.
    pub draw: u32,
}
