//! Display experiments with hidden flaws, and the score of their diagnosis.

mod follow;
mod gain;
mod score;

pub use follow::{Followed, MOST_COMMANDS};
pub use gain::{Gains, RIGHT, Validated, is_right};
pub use score::{Outcome, Scored, Tally};

use palpate::simulate::display::{DisplayEffect, DisplayRun, DisplaySpec, Subject};
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;

/// How much is done with the display.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Plan {
    /// One kind of command a channel, three times.
    Short,
    /// Commands of several heights and speeds, three times each.
    Full,
    /// A finger on the cap and in the fluid, slow and fast, three times each.
    Finger,
}

impl Plan {
    /// Its name in tables.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Plan::Short => "short",
            Plan::Full => "full",
            Plan::Finger => "finger",
        }
    }

    /// Effects of the catalogue that are hidden; codes with several laws come up once a law.
    #[must_use]
    pub fn hidden(self) -> &'static [&'static str] {
        match self {
            Plan::Short | Plan::Full => &[
                "rate-limit",
                "delay",
                "stiction",
                "backlash",
                "creep",
                "memory",
                "hysteresis",
                "sensor-nonlinearity",
                "coil-heating",
                "saturation",
                "remanence",
                "gap",
            ],
            Plan::Finger => {
                &["pulp-size", "pulp-relaxation", "yield-law", "fluid-rest", "fluid-viscosity", "fluid-response"]
            }
        }
    }

    /// Effects that no catalogue names.
    #[must_use]
    pub fn outside(self) -> &'static [&'static str] {
        match self {
            Plan::Short | Plan::Full => {
                &["outside-ripple", "outside-wobble", "outside-viscous", "outside-clip", "outside-eddy"]
            }
            Plan::Finger => &["outside-ridges", "outside-cup"],
        }
    }

    /// Pairs, first the ones in one channel.
    #[must_use]
    pub fn pairs(self) -> &'static [(&'static str, &'static str)] {
        match self {
            Plan::Short | Plan::Full => &[
                ("rate-limit", "delay"),
                ("creep", "sensor-nonlinearity"),
                ("delay", "stiction"),
                ("saturation", "remanence"),
                ("rate-limit", "creep"),
                ("sensor-nonlinearity", "coil-heating"),
            ],
            Plan::Finger => &[
                ("pulp-size", "pulp-relaxation"),
                ("yield-law", "fluid-viscosity"),
                ("pulp-relaxation", "fluid-response"),
            ],
        }
    }
}

/// Levels of strength: from hardly visible to large.
pub const LEVELS: usize = 4;

/// One hidden case.
#[derive(Debug, Clone)]
pub struct Case {
    /// What is done.
    pub plan: Plan,
    /// Seed of everything.
    pub seed: u64,
    /// What is hidden: none, one, or two names.
    pub hidden: Vec<&'static str>,
    /// From 0 to [`LEVELS`] - 1.
    pub level: usize,
    /// Noise that the diagnosis does not assume.
    pub mismatched: bool,
}

impl Case {
    /// A clean case.
    #[must_use]
    pub fn clean(plan: Plan, seed: u64) -> Self {
        Self { plan, seed, hidden: Vec::new(), level: 0, mismatched: false }
    }

    /// The same with something hidden.
    #[must_use]
    pub fn hiding(mut self, hidden: &[&'static str], level: usize) -> Self {
        self.hidden = hidden.to_vec();
        self.level = level;
        self
    }

    /// The same in heavy-tailed noise.
    #[must_use]
    pub fn mismatched(mut self) -> Self {
        self.mismatched = true;
        self
    }

    /// What is simulated; without the hidden effects when `effects` is false.
    #[must_use]
    pub fn spec(&self, effects: bool) -> DisplaySpec {
        let mut chance = Pcg64::seed_from_u64(self.seed);
        let mut spec = DisplaySpec::new("display", self.seed);
        spec.runs = match self.plan {
            Plan::Short => short(),
            Plan::Full => full(),
            Plan::Finger => finger(),
        };
        // noise differs from laboratory to laboratory by a factor of two either way
        let mut around = |usual: f64| usual * 2f64.powf(chance.random_range(-1.0..1.0));
        spec.noise.position_mm = around(spec.noise.position_mm);
        spec.noise.force_share = around(spec.noise.force_share);
        spec.noise.current_a = around(spec.noise.current_a);
        spec.noise.flux_t = around(spec.noise.flux_t);
        spec.noise.correlation_s = around(spec.noise.correlation_s);
        // of a stream of its own: cases of before keep their numbers
        let mut of_finger = Pcg64::seed_from_u64(!self.seed);
        spec.noise.finger_n *= 2f64.powf(of_finger.random_range(-1.0..1.0));
        spec.noise.heavy_tails = self.mismatched;
        if effects {
            let strength = [0.25, 0.5, 1.0, 2.0][self.level.min(LEVELS - 1)];
            spec.effects = self.hidden.iter().filter_map(|name| effect(name, strength, &mut chance)).collect();
        }
        spec
    }
}

/// Steps of one height, one load held, one current.
fn short() -> Vec<DisplayRun> {
    vec![
        DisplayRun::new(Subject::Position, vec![4.0, 10.0, 4.0], 1.0).times(3),
        DisplayRun::new(Subject::Force, vec![0.0, 4.0], 3.0).times(3),
        DisplayRun::new(Subject::Coil, vec![0.0, 2.0, 0.0], 1.0).times(3),
    ]
}

fn full() -> Vec<DisplayRun> {
    let mut wide = DisplayRun::new(Subject::Coil, vec![0.0, 2.4, 0.0, 1.2, 0.0], 0.2).ramped(1.0).times(3);
    wide.gap_mm = 1.6;
    vec![
        DisplayRun::new(Subject::Position, vec![4.0, 12.0, 6.0, 15.0, 4.0], 0.8).times(3),
        DisplayRun::new(Subject::Position, vec![6.0, 6.5, 7.5, 6.8, 6.0], 0.8).times(3),
        DisplayRun::new(Subject::Position, vec![4.0, 10.0, 4.0], 0.2).ramped(2.0).times(3),
        DisplayRun::new(Subject::Position, vec![5.0, 8.0, 5.0, 8.0, 5.0, 8.0, 5.0], 0.0).ramped(0.4).times(3),
        DisplayRun::new(Subject::Force, vec![0.0, 2.0, 5.0, 1.0, 3.0], 2.0).times(3),
        DisplayRun::new(Subject::Force, vec![0.0, 7.0, 0.0, 3.0, 0.0], 0.2).ramped(1.0).times(3),
        DisplayRun::new(Subject::Force, vec![0.0, 4.0], 8.0).times(3),
        DisplayRun::new(Subject::Coil, vec![0.0, 1.0, 2.5, 1.5, 0.0], 1.5).times(3),
        DisplayRun::new(Subject::Coil, vec![0.0, 2.5, 0.0, 1.2, 0.0], 0.2).ramped(1.0).times(3),
        wide,
    ]
}

fn finger() -> Vec<DisplayRun> {
    vec![
        DisplayRun::new(Subject::Pulp, vec![0.0, 3.0, 0.0], 0.5).ramped(1.5).times(3),
        DisplayRun::new(Subject::Pulp, vec![0.0, 1.5, 3.0, 1.0, 2.5, 0.0], 1.0).ramped(0.3).times(3),
        DisplayRun::new(Subject::Pulp, vec![0.0, 2.5], 3.0).ramped(0.2).times(3),
        DisplayRun::new(Subject::Fluid, vec![0.0, 3.0, 0.0], 0.3).ramped(2.0).times(3).with_current(vec![2.5; 3]),
        DisplayRun::new(Subject::Fluid, vec![0.0, 3.0, 0.0], 0.3).ramped(2.0).times(3).with_current(vec![0.6; 3]),
        DisplayRun::new(Subject::Fluid, vec![0.0, 3.0], 0.5).ramped(0.3).times(3).with_current(vec![1.5; 2]),
        DisplayRun::new(Subject::Fluid, vec![0.0, 0.8, 1.6, 2.4, 3.2], 0.0)
            .ramped(1.0)
            .times(3)
            .with_current(vec![2.5, 2.5, 1.5, 0.9, 0.4]),
    ]
}

/// An effect at a strength around 1, where a full plan should see it.
fn effect(name: &str, strength: f64, chance: &mut Pcg64) -> Option<DisplayEffect> {
    let s = strength * chance.random_range(0.8..1.25);
    let sign = if chance.random::<bool>() { 1.0 } else { -1.0 };
    Some(match name {
        // the fastest step of the full plan asks for about 33 mm/s
        "rate-limit" => DisplayEffect::RateLimit { mm_per_s: 30.0 / (1.0 + s) },
        "delay" => DisplayEffect::Delay { seconds: 0.02 * s },
        "stiction" => DisplayEffect::Stiction { mm: 0.08 * s },
        "backlash" => DisplayEffect::Backlash { mm: 0.15 * s },
        "creep" => DisplayEffect::Creep { per_decade: 0.03 * s },
        "memory" => DisplayEffect::Memory { amplitude: 0.05 * s, tau_s: chance.random_range(0.5..3.0) },
        "hysteresis" => DisplayEffect::Hysteresis { half_width: 0.03 * s },
        "sensor-nonlinearity" => DisplayEffect::Nonlinearity { power: 1.0 + sign * 0.06 * s },
        // 1.3 K/s at 2.5 A and strength 1: a winding with a core that warms with it
        "coil-heating" => DisplayEffect::Heating { j_per_k: 24.0 / s },
        "saturation" => DisplayEffect::Saturation { tesla: 0.2 / s },
        "remanence" => DisplayEffect::Remanence { tesla: 0.001 * s, ampere: chance.random_range(0.3..0.8) },
        "gap" => DisplayEffect::Gap { mm: if sign > 0.0 { 0.1 * s } else { -0.07 * s } },
        "pulp-size" => DisplayEffect::PulpSize { ratio: (sign * 0.1 * s).exp() },
        "pulp-relaxation" => DisplayEffect::PulpRelaxation { part: 0.08 * s, tau_s: chance.random_range(0.3..2.0) },
        // the magnet's largest flux makes 2.4 kPa
        "yield-law" => DisplayEffect::YieldLaw { most_kpa: 4.0 / s },
        "fluid-rest" => DisplayEffect::FluidRest { kpa: 0.05 * s },
        "fluid-viscosity" => DisplayEffect::FluidViscosity { kpa_s_per_mm: 0.01 * s },
        "fluid-response" => DisplayEffect::FluidResponse { seconds: 0.06 * s },
        "outside-ridges" => DisplayEffect::OutsideRidges { part: 0.05 * s, pitch_mm: chance.random_range(0.4..0.8) },
        "outside-cup" => DisplayEffect::OutsideCup { part: 0.2 * s },
        "outside-ripple" => DisplayEffect::OutsideRipple { mm: 0.1 * s, pitch_mm: chance.random_range(2.0..4.0) },
        "outside-wobble" => DisplayEffect::OutsideWobble { share: 0.1 * s, hz: chance.random_range(2.0..5.0) },
        "outside-viscous" => DisplayEffect::OutsideViscous { seconds: 0.02 * s },
        "outside-clip" => DisplayEffect::OutsideClip { ampere: 2.45 - 0.15 * s },
        "outside-eddy" => DisplayEffect::OutsideEddy { seconds: 0.05 * s },
        _ => return None,
    })
}

/// The code that a diagnosis should give for a hidden name; none outside the catalogue.
#[must_use]
pub fn code(name: &str) -> Option<&'static str> {
    Some(match name {
        "rate-limit" => "rate-limit",
        "delay" => "delay",
        "stiction" | "backlash" => "stiction",
        "creep" | "memory" | "hysteresis" => "sensor-creep",
        "sensor-nonlinearity" => "sensor-nonlinearity",
        // 1.3 K/s at 2.5 A and strength 1: a winding with a core that warms with it
        "coil-heating" => "coil-heating",
        "saturation" => "saturation",
        "remanence" => "remanence",
        "gap" => "gap",
        "pulp-size" => "pulp-size",
        "pulp-relaxation" => "pulp-relaxation",
        "yield-law" => "yield-law",
        "fluid-rest" => "fluid-rest",
        "fluid-viscosity" => "fluid-viscosity",
        "fluid-response" => "fluid-response",
        _ => return None,
    })
}

/// The cases of a score: of ten, three clean (one of them in mismatched noise), five with one effect by turns, one from outside, one pair.
#[must_use]
pub fn suite(plan: Plan, count: usize, first_seed: u64) -> Vec<Case> {
    let (mut single, mut outside, mut pair) = (0, 0, 0);
    (0..count)
        .map(|i| {
            let case = Case::clean(plan, first_seed + i as u64);
            match i % 10 {
                0 | 1 => case,
                2 => case.mismatched(),
                8 => {
                    outside += 1;
                    let all = plan.outside();
                    case.hiding(&[all[(outside - 1) % all.len()]], 1 + (outside - 1) / all.len() % 3)
                }
                9 => {
                    pair += 1;
                    let all = plan.pairs();
                    let (a, b) = all[(pair - 1) % all.len()];
                    case.hiding(&[a, b], 2 + (pair - 1) / all.len() % 2)
                }
                _ => {
                    single += 1;
                    let all = plan.hidden();
                    case.hiding(&[all[(single - 1) % all.len()]], (single - 1) / all.len() % LEVELS)
                }
            }
        })
        .collect()
}
