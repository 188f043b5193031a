//! Hidden effects: experiments whose seed alone decides which effect is in them and how strong it is, for those who score a
//! diagnosis. The folder never tells; [`Case::truth`] does.

mod design;
mod draw;
mod layout;
mod strength;

pub use design::Design;
pub use draw::Foam;
pub(crate) use draw::even;
pub use strength::{CATALOGUE, LEVELS, OUTSIDE, PAIRS};

use palpate::simulate::{Effect, SimulateError, SimulatedExperiment, Solver, Spec, Variable, simulate};

/// What is hidden in a case.
#[derive(Debug, Clone, PartialEq)]
pub enum What {
    /// Nothing.
    Clean,
    /// An effect of the catalogue, by code, at a level of 0 (below what can be seen) to 4 (well above).
    Catalogue(&'static str, usize),
    /// An effect outside of it, likewise.
    Outside(&'static str, usize),
    /// An effect of the catalogue at a level, and the diagnosis' catalogue lacks it.
    Deleted(&'static str, usize),
    /// A smooth function without meaning, at 3 % of the peak.
    Placebo(Variable),
    /// Two effects of the catalogue at a level each.
    Pair([&'static str; 2], usize),
}

impl What {
    /// Everything that can be hidden, once: clean, every effect at every level, every pair at the lower of its levels, every placebo.
    #[must_use]
    pub fn all() -> Vec<Self> {
        let levels = |make: fn(&'static str, usize) -> Self, codes: &'static [&'static str]| {
            codes.iter().flat_map(move |code| (0..LEVELS).map(move |level| make(code, level)))
        };
        std::iter::once(Self::Clean)
            .chain(levels(Self::Catalogue, &CATALOGUE))
            .chain(levels(Self::Outside, &OUTSIDE))
            .chain(PAIRS.iter().map(|pair| Self::Pair(*pair, 3)))
            .chain(Variable::ALL.iter().map(|(_, variable)| Self::Placebo(*variable)))
            .collect()
    }
}

/// How the noise compares with what a diagnosis assumes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NoiseKind {
    /// Normal, AR(1), jitter of contact and gain.
    Matched,
    /// Student's t of 3 degrees of freedom, partly proportional to the force, quantised, with a wandering zero.
    Mismatched,
}

/// The answer to a case.
#[derive(Debug, Clone, PartialEq)]
pub struct Truth {
    /// What is hidden.
    pub what: What,
    /// The effects with their parameters.
    pub effects: Vec<Effect>,
    /// Noise.
    pub noise: NoiseKind,
    /// The foam.
    pub foam: Foam,
}

impl Truth {
    /// Codes of the effects, in the order drawn.
    #[must_use]
    pub fn codes(&self) -> Vec<&'static str> {
        self.effects.iter().map(Effect::code).collect()
    }
}

/// A hidden case: everything follows from these.
#[derive(Debug, Clone, PartialEq)]
pub struct Case {
    /// Design of the experiment.
    pub design: Design,
    /// Decides all that is left open.
    pub seed: u64,
    /// Set where a suite wants a stratum rather than a draw.
    pub what: Option<What>,
    /// Likewise.
    pub noise: Option<NoiseKind>,
}

impl Case {
    /// A case about which nothing is said.
    #[must_use]
    pub fn new(design: Design, seed: u64) -> Self {
        Self { design, seed, what: None, noise: None }
    }

    /// The same with what is hidden fixed.
    #[must_use]
    pub fn hiding(mut self, what: What) -> Self {
        self.what = Some(what);
        self
    }

    /// The same with the noise fixed.
    #[must_use]
    pub fn in_noise(mut self, noise: NoiseKind) -> Self {
        self.noise = Some(noise);
        self
    }

    /// The answer.
    #[must_use]
    pub fn truth(&self) -> Truth {
        draw::truth(self)
    }

    /// What is to be simulated; its name tells design and seed only.
    #[must_use]
    pub fn spec(&self) -> Spec {
        draw::spec(self, &self.truth())
    }

    /// The experiment.
    ///
    /// # Errors
    /// When a solve fails, which names the case.
    pub fn make(&self, solver: &Solver) -> Result<SimulatedExperiment, SimulateError> {
        simulate(&self.spec(), solver, &|_, _, _| {})
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;
    use std::collections::BTreeMap;

    #[test]
    fn designs_have_the_runs_in_their_names() {
        for (design, runs) in [(Design::D6, 6), (Design::D18, 18), (Design::D36, 36), (Design::D60, 60)] {
            let spec = Case::new(design, 1).spec();
            let made: usize = spec.runs.iter().map(|run| run.replicates * run.cycles).sum();
            assert_eq!((made, design.runs()), (runs, Some(runs)), "{design:?}");
        }
    }

    /// Of 300 drawn designs every one has repeats, at most 60 runs, and balls that do not sink in; they differ.
    #[test]
    fn own_designs_can_be_diagnosed() {
        let mut counts = std::collections::BTreeSet::new();
        for seed in 0..300 {
            let spec = Case::new(Design::Own, seed).spec();
            let made: usize = spec.runs.iter().map(|run| run.replicates * run.cycles).sum();
            assert!((2..=60).contains(&made), "{seed}: {made}");
            counts.insert((made, spec.indenters.len(), spec.specimens.len()));
            for run in &spec.runs {
                let ball = spec.indenter(run.indenter.as_deref().unwrap()).unwrap();
                let slab = spec.specimen(run.specimen.as_deref().unwrap()).unwrap();
                assert!(run.replicates >= 2 && run.depth_mm > 0.5, "{seed}: {run:?}");
                assert!(run.depth_mm < 0.8 * ball.radius_mm && run.depth_mm < 0.3 * slab.height_mm, "{seed}: {run:?}");
                assert!(slab.radius_mm >= 25.0 && spec.sample_hz >= 20.0);
            }
        }
        assert!(counts.len() > 50, "{counts:?}");
    }

    #[test]
    fn a_seed_says_it_all_and_another_one_something_else() {
        let case = Case::new(Design::D36, 11);
        assert_eq!(case.spec(), case.clone().spec());
        let names: Vec<String> = (0..40).map(|seed| Case::new(Design::D36, seed).spec().name).collect();
        assert!(names.iter().enumerate().all(|(seed, name)| *name == format!("hidden D36-{seed}")));
        let foams: Vec<f64> = (0..40).map(|seed| Case::new(Design::D36, seed).truth().foam.mu_mpa).collect();
        assert!(foams.windows(2).all(|two| two[0] != two[1]));
    }

    /// Of 2,000 draws every code and every pair comes up, and a quarter is clean within four standard deviations (78).
    #[test]
    fn draws_reach_everything() {
        let mut found: BTreeMap<String, usize> = BTreeMap::new();
        for seed in 0..2000 {
            let truth = Case::new(Design::D60, seed).truth();
            let key = match &truth.what {
                What::Clean => "clean".to_owned(),
                What::Pair(codes, _) => codes.join(" + "),
                What::Placebo(variable) => format!("{variable:?}"),
                What::Catalogue(code, level) | What::Outside(code, level) | What::Deleted(code, level) => {
                    assert!(*level < LEVELS);
                    assert!(truth.codes() == [*code], "{truth:?}");
                    (*code).to_owned()
                }
            };
            *found.entry(key).or_default() += 1;
        }
        assert_eq!(found.len(), 1 + CATALOGUE.len() + OUTSIDE.len() + PAIRS.len() + Variable::ALL.len(), "{found:#?}");
        assert!(found["clean"].abs_diff(500) < 78, "{found:#?}");
    }

    /// What is drawn is accepted, at every level and for every design.
    #[test]
    fn every_level_of_every_effect_is_a_specification() {
        for design in Design::ALL {
            for (seed, what) in What::all().into_iter().enumerate() {
                let case = Case::new(design, seed as u64).hiding(what);
                let text: String = case.truth().effects.iter().map(Effect::to_toml).collect();
                let head = "[indenter.r4]\nradius_mm = 4\n[indenter.r6]\nradius_mm = 6\n[indenter.r9]\nradius_mm = 9\n\
                            [[run]]\ntest = \"air\"\nhold_s = 1\n";
                let read = palpate::simulate::parse(std::path::Path::new("x.toml"), &format!("{head}{text}"));
                assert_eq!(read.unwrap_or_else(|e| panic!("{e}\n{text}")).effects, case.truth().effects);
            }
        }
    }

    /// The noise of a clean case lies in the range it was drawn from: 0.3 to 1 % of the largest force, on that of the data.
    #[test]
    fn a_clean_case_has_the_noise_it_says() {
        let solver = Solver::new();
        for seed in 0..3 {
            let case = Case::new(Design::D6, seed).hiding(What::Clean).in_noise(NoiseKind::Matched);
            let made = case.make(&solver).unwrap();
            let peak = made.runs.iter().flat_map(|run| &run.exact_n).copied().fold(0.0, f64::max);
            let share = case.spec().noise.sensor_n / peak;
            // the peak is estimated from mu, alpha and the ball beforehand, within a third
            assert!((0.002..0.015).contains(&share), "{share}");
            assert_eq!(made.runs.len(), 6);
        }
    }
}
