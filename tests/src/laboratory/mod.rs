//! Laboratory worlds: what real rigs and materials add to a law, around a cause that dominates.
//!
//! A hidden case ([`crate::hidden`]) holds one effect in a world that is perfect otherwise. A world
//! has rests (smooth random processes that no catalogue holds) everywhere, small effects beside a
//! dominating one, places and pieces that differ, and a rig whose noise is drawn from ranges wider
//! than anything else assumes. Its seed says it all; [`Truth`] tells what dominates, by a fit and
//! not by what was drawn: the share of the squared misfit of the base that goes when it is taken
//! out.

mod balance;
mod ingredient;
mod rests;
mod rig;
pub mod score;
pub mod table;
#[cfg(test)]
mod tests;

use palpate::simulate::{Effect, Rest, SimulatedExperiment, Spec};
use rand::Rng;

use crate::hidden::{CATALOGUE, Design, Foam, OUTSIDE};
use crate::score::ScoreError;
use crate::score::share::Yardstick;
use crate::score::strength::SEEN;

use balance::Parts;
use ingredient::Scales;

/// Least share of the squared misfit that dominates.
pub const DOMINATES: f64 = 0.7;
/// Of a hundred worlds so many are clean but for rests, have an effect of the catalogue that
/// dominates, one outside of it; the others have two that are comparable.
const SHARES: [u32; 3] = [10, 55, 20];
/// Of a hundred dominating effects outside the catalogue so many are rests.
const RESTS_OUTSIDE: u32 = 15;
/// Designs of worlds.
pub const DESIGNS: [Design; 4] = [Design::D18, Design::D36, Design::D60, Design::Own];
/// Codes of the hidden catalogue that are not drawn: the gain of a sensor is that of a modulus, and
/// no laboratory makes an error of the numerics.
const NOT_DRAWN: [&str; 2] = ["sensor-gain", "numerics"];

/// Codes of the catalogue that are drawn.
fn catalogue() -> Vec<&'static str> {
    CATALOGUE.into_iter().filter(|code| !NOT_DRAWN.contains(code)).collect()
}

/// What kind of departure an effect is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Kind {
    /// The specimen relaxes.
    Memory,
    /// Another elastic law.
    ElasticLaw,
    /// What was done to a spot before, and which way the ball goes.
    History,
    /// What acts between ball and specimen.
    Friction,
    /// Lengths that are not the declared ones.
    Geometry,
    /// The ball is not where it was driven.
    Machine,
    /// The reading is not the force.
    Sensor,
    /// What goes with the session.
    Clock,
}

impl Kind {
    /// Of a code, and of what a rest varies with; `None` for what is of none.
    #[must_use]
    pub fn of_code(code: &str) -> Option<Self> {
        Some(match code {
            "relaxation" | "outside-power-law" => Self::Memory,
            "poisson" | "second-term" | "outside-stiff-skin" | "outside-anisotropic" => Self::ElasticLaw,
            "softening" | "outside-plastic-set" => Self::History,
            "friction" | "adhesion" | "outside-stick-slip" => Self::Friction,
            "thickness" | "contact-offset" | "radius" | "outside-tilt" => Self::Geometry,
            "compliance" | "lag" | "depth-gain" => Self::Machine,
            "sensor-gain" | "sensor-nonlinearity" | "sensor-creep" | "outside-hum" => Self::Sensor,
            "drift" | "time-gain" => Self::Clock,
            _ => return None,
        })
    }

    /// Of an effect.
    #[must_use]
    pub fn of(effect: &Effect) -> Option<Self> {
        match effect {
            Effect::Rest(rest) => rests::kind(rest),
            other => Self::of_code(other.code()),
        }
    }

    /// The words of it.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Memory => "memory of the specimen",
            Self::ElasticLaw => "elastic law",
            Self::History => "history",
            Self::Friction => "friction",
            Self::Geometry => "geometry",
            Self::Machine => "machine",
            Self::Sensor => "sensor",
            Self::Clock => "clock",
        }
    }
}

/// What is in a world besides rests and minor effects.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum What {
    /// Nothing.
    Clean,
    /// One effect of the catalogue that dominates.
    Catalogue,
    /// One outside of it.
    Outside,
    /// Two of the catalogue that are comparable, and dominate together.
    Two,
}

impl What {
    /// The word in tables.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Clean => "clean",
            Self::Catalogue => "catalogue",
            Self::Outside => "outside",
            Self::Two => "two",
        }
    }
}

/// An effect that dominates, alone or with another.
#[derive(Debug, Clone, PartialEq)]
pub struct Dominating {
    /// The effect.
    pub effect: Effect,
    /// Share of the squared misfit of the base that goes when it is taken out.
    pub share: f64,
    /// Standard deviations of the noise, jitter included, by which it moves the data.
    pub strength: f64,
}

/// What is true in a world.
#[derive(Debug, Clone, PartialEq)]
pub struct Truth {
    /// Clean, one, or two.
    pub what: What,
    /// What dominates: none, one or two.
    pub dominating: Vec<Dominating>,
    /// Share of the squared misfit that they have together; 0 in a clean world.
    pub share: f64,
    /// Small effects of other kinds.
    pub minors: Vec<Effect>,
    /// Rests.
    pub rests: Vec<Rest>,
    /// Root mean square of all rests together, as a share of the force.
    pub rests_rms: f64,
    /// The material: mean over the pieces.
    pub foam: Foam,
}

impl Truth {
    /// Codes of what dominates.
    #[must_use]
    pub fn codes(&self) -> Vec<&'static str> {
        self.dominating.iter().map(|one| one.effect.code()).collect()
    }

    /// True for a code that is truly there, dominating or not.
    #[must_use]
    pub fn has(&self, code: &str) -> bool {
        self.codes().contains(&code) || self.minors.iter().any(|effect| effect.code() == code)
    }

    /// Kind of what dominates first.
    #[must_use]
    pub fn kind(&self) -> Option<Kind> {
        self.dominating.first().and_then(|one| Kind::of(&one.effect))
    }

    /// True when all that dominates shows.
    #[must_use]
    pub fn visible(&self) -> bool {
        !self.dominating.is_empty() && self.dominating.iter().all(|one| one.strength > SEEN)
    }
}

/// A world: everything follows from these.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct World {
    /// Decides all that is left open.
    pub seed: u64,
    /// Design of the experiment.
    pub design: Design,
}

/// A world as it was made.
#[derive(Debug)]
pub struct Made {
    /// What was simulated; its name tells design and seed only.
    pub spec: Spec,
    /// What is true.
    pub truth: Truth,
    /// The experiment.
    pub experiment: SimulatedExperiment,
}

impl World {
    /// The world of a seed, which also draws the design.
    #[must_use]
    pub fn drawn(seed: u64) -> Self {
        let at = rig::chance(seed, rig::Question::Design).random_range(0..DESIGNS.len());
        Self { seed, design: DESIGNS[at] }
    }

    /// What is in it.
    #[must_use]
    pub fn what(&self) -> What {
        let mut at = rig::chance(self.seed, rig::Question::What).random_range(0..100_u32);
        for (what, share) in [What::Clean, What::Catalogue, What::Outside].into_iter().zip(SHARES) {
            if at < share {
                return what;
            }
            at -= share;
        }
        What::Two
    }

    /// Makes it; `None` where no amounts are found with which what should dominate does.
    ///
    /// # Errors
    /// A solve that fails.
    pub fn make(&self, yardstick: &Yardstick<'_>) -> Result<Option<Made>, ScoreError> {
        let what = self.what();
        let base = rig::bare(self);
        let bare = yardstick.made(&base)?;
        let Some(misfits) = yardstick.misfits(&bare)? else { return Ok(None) };
        let scales = Scales::of(&base, &bare);
        let parts = self.parts(what, &base, &scales);
        let balance = balance::Balance { yardstick, base: &base, bare: &bare, misfits: &misfits, scales: &scales };
        let mut chance = rig::chance(self.seed, rig::Question::Balance);
        let Some(balanced) = balance.of(parts, &mut chance)? else { return Ok(None) };
        let Parts { dominating, minors, rests } = balanced.parts;
        let mut spec = base.clone();
        spec.noise = rig::noise(self.seed, scales.peak_n);
        spec.effects = balance::effects(&dominating, &minors, &rests);
        let experiment = yardstick.made(&spec)?;
        let places: Vec<usize> = (0..dominating.len()).collect();
        let strengths = yardstick.strengths(&experiment, &places)?;
        let each = dominating.into_iter().zip(balanced.shares).zip(strengths);
        let dominating = each.map(|((effect, share), strength)| Dominating { effect, share, strength }).collect();
        let (share, rests_rms, foam) = (balanced.share, balanced.rests_rms, rig::foam(&base));
        Ok(Some(Made { spec, truth: Truth { what, dominating, share, minors, rests, rests_rms, foam }, experiment }))
    }

    /// What is drawn to be in it, before amounts are weighed.
    fn parts(&self, what: What, base: &Spec, scales: &Scales) -> Parts {
        let rests = rests::drawn(base, &mut rig::chance(self.seed, rig::Question::Rests));
        let mut chance = rig::chance(self.seed, rig::Question::Effects);
        let (mut kinds, codes) = (Vec::new(), catalogue());
        let mut of_catalogue = |minor: bool, chance: &mut rand_pcg::Pcg64| loop {
            let effect = ingredient::drawn(codes[chance.random_range(0..codes.len())], minor, scales, chance);
            let kind = effect.as_ref().and_then(Kind::of);
            if let Some(effect) = effect.filter(|_| !kinds.contains(&kind)) {
                kinds.push(kind);
                break effect;
            }
        };
        let dominating = match what {
            What::Clean => return Parts { dominating: Vec::new(), minors: Vec::new(), rests },
            What::Catalogue => vec![of_catalogue(false, &mut chance)],
            What::Two => vec![of_catalogue(false, &mut chance), of_catalogue(false, &mut chance)],
            What::Outside if chance.random_range(0..100_u32) < RESTS_OUTSIDE => {
                vec![Effect::Rest(rests::dominating(base, &mut chance))]
            }
            What::Outside => loop {
                let code = OUTSIDE[chance.random_range(0..OUTSIDE.len())];
                if let Some(effect) = ingredient::drawn(code, false, scales, &mut chance) {
                    break vec![effect];
                }
            },
        };
        let count = chance.random_range(0..=2);
        let own: Vec<Option<Kind>> = dominating.iter().map(Kind::of).collect();
        let minors = (0..count).map(|_| of_catalogue(true, &mut chance)).filter(|one| !own.contains(&Kind::of(one)));
        let minors = minors.collect();
        Parts { dominating, minors, rests }
    }
}
