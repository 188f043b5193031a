//! Diagnosis: what a simulated indentation gets wrong, why, and what mending it gains.
//!
//! The order is that of the questions, and none is answered before the one in front of it: is the simulation wrong at all, against the noise of
//! this very data set ([`noise`], [`evidence`]); which effect of the catalogue explains it ([`search`]), alone or with others that this design cannot
//! tell apart; what the extended model is; what it gains on conditions that no fit has seen ([`held_out`]); and what this design cannot see.

pub mod answer;
mod asked;
pub mod check;
pub mod coordinate;
mod correlated;
pub mod design;
pub mod display;
pub mod evidence;
pub mod fault;
mod finding;
pub mod fit;
pub mod gradient;
pub mod held_out;
pub mod jitter;
pub mod margin;
mod models;
pub mod noise;
mod placebo;
pub mod plain;
pub mod plan;
mod prepared;
mod progress;
mod quantile;
mod refusal;
pub mod ripple;
pub mod scatter;
pub mod search;
pub mod second;
mod spike;
#[cfg(test)]
mod tests;
pub mod unseen;
mod variable;
mod verdict;
pub mod whiten;

use std::time::Instant;

use crate::experiment::Experiment;
use crate::identify;
use crate::infer::unseen::Widening;
use lut_gen::chain::{Chain, LibraryError};

use design::Design;
use evidence::Adequacy;
use fault::Fault;
use fit::{Fit, Problem};
use held_out::HeldOut;
use margin::Margin;
use noise::{Curve, Noise, Source};
use plain::{Plain, Plainly};
use plan::Proposal;
use ripple::Ripple;
use search::{Explanation, Found, Search, is_nameless};
use second::Second;

pub use asked::{Asked, Edition};
pub use finding::{Finding, Verdict};
pub use models::{FOLDER_VARIABLE, Models};
pub use prepared::Prepared;
pub use progress::Progress;
pub use refusal::Refusal;

/// Why there is no diagnosis at all.
#[derive(Debug, thiserror::Error)]
pub enum DiagnoseError {
    /// A force model could not be made.
    #[error("no force model: {0}")]
    Model(#[from] LibraryError),
}

/// What was found about one material.
#[derive(Debug)]
pub struct Diagnosis {
    /// Name of the material.
    pub material: String,
    /// The verdict.
    pub verdict: Verdict,
    /// Named effects, or the sets that stand for one.
    pub findings: Vec<Finding>,
    /// Variables in which a discrepancy shows, the worst first.
    pub shows_in: Vec<&'static str>,
    /// Effects that a plausible amount of would not be seen in this design.
    pub blind_to: Vec<&'static str>,
    /// Runs that would decide between the names, or show what cannot be seen, the best first.
    pub proposals: Vec<Proposal>,
    /// Pairs of effects that this design could not see if they were of equal size.
    pub cancelling: Vec<&'static str>,
    /// The data's own faults.
    pub faults: Vec<Fault>,
    /// Why it was refused, if so.
    pub refusal: Option<Refusal>,
    /// The evidence, if anything could be fitted.
    pub evidence: Option<Box<Evidence>>,
    /// What the reader should know.
    pub messages: Vec<String>,
    /// Wall time, s.
    pub seconds: f64,
}

/// What a verdict rests on.
#[derive(Debug)]
pub struct Evidence {
    /// The data.
    pub design: Design,
    /// The noise: that of the likeliest explanation that holds, or of the base where none does.
    pub noise: Noise,
    /// The base, fitted to that noise: what explanations are compared with.
    pub base: Fit,
    /// The base as it stands alone: its plain best fit, with intervals in a noise that was told of nothing else.
    pub before: Stand,
    /// The plain best fit of the likeliest explanation that holds, or of the likeliest single effect where none does; none where nothing was tried.
    pub after: Option<Stand>,
    /// Sum of squares that the base leaves where explanations are compared: in the noise of the likeliest, whether it holds or not.
    pub compared_square: f64,
    /// Contact point of every run, mm, as the base fit sees it.
    pub contacts_mm: Vec<f64>,
    /// What the base leaves.
    pub adequacy: Adequacy,
    /// Margins, as the readings of an [`Adequacy`] refer to them.
    pub margins: Vec<Margin>,
    /// A ripple of the force, if there is one.
    pub ripple: Option<Ripple>,
    /// Every candidate alone, the best first.
    pub singles: Vec<Explanation>,
    /// What was tried with two effects, the best first.
    pub pairs: Vec<Explanation>,
    /// Explanations that hold and none that is a hundred times more likely, the best first.
    pub held: Vec<Explanation>,
    /// By how much (sum of squares, parameters charged) the likeliest of these is likelier than it must be against a departure without a name, elastic or in more times of
    /// relaxation than two; none where neither is a question.
    pub beyond_nameless: Option<f64>,
    /// The second edition's verdict; beside that of the first in shadow.
    pub second: Option<Second>,
    /// Error on conditions that were left out.
    pub held_out: Option<HeldOut>,
    /// Finite-element solves behind the force models.
    pub solves: usize,
}

/// A value with its 95 % interval.
pub type Estimate = (f64, (f64, f64));

/// A model as it stands: its plain best fit.
#[derive(Debug, Clone, PartialEq)]
pub struct Stand {
    /// The fit.
    pub plain: Plain,
    /// `mu` (MPa) and `alpha` there, in intervals that have those of the verdict's fit.
    pub parameters: [Estimate; 2],
    /// The same in intervals of noise alone.
    pub of_noise: [Estimate; 2],
    /// What widened the intervals.
    pub unseen: Option<Widening>,
    /// What it predicts for every run, each at its contact point.
    pub curves: Vec<Curve>,
}

impl Stand {
    /// Of a model whose effects stay as they are; intervals are widened to hold where the plain fit ends.
    fn of(design: &Design, chain: &Chain, fit: &Fit) -> Self {
        let plainly = Plainly { design, chain, with: &fit.model };
        let plain = plainly.best();
        let curves = Problem::curves(design, chain, &plain.model, &plainly.contacts_of_runs(&plain));
        let ends = [plain.model.mu_mpa, plain.model.alpha];
        let about = |known: [Estimate; 2]| {
            std::array::from_fn(|i| {
                let (value, (_, (low, high))) = (ends[i], known[i]);
                (value, (low.min(value), high.max(value)))
            })
        };
        let (parameters, of_noise) = (about(fit.base()), about(fit.base_of_noise()));
        Self { plain, parameters, of_noise, unseen: fit.unseen.clone(), curves }
    }
}

impl Evidence {
    /// `mu` (MPa) and `alpha` of the likeliest explanation that holds at its plain best fit, each in an interval that has those of all that hold: which of these is true is not known.
    #[must_use]
    pub fn extended(&self) -> Option<[Estimate; 2]> {
        let best = self.after.as_ref().filter(|_| !self.held.is_empty())?.parameters;
        let own = self.held.iter().map(|e| e.fit.base().map(|p| p.1));
        Some(own.chain(self.second.as_ref().map(|second| second.intervals)).fold(best, holding))
    }

    /// The same with the intervals that noise alone makes.
    #[must_use]
    pub fn extended_of_noise(&self) -> Option<[Estimate; 2]> {
        let best = self.after.as_ref().filter(|_| !self.held.is_empty())?.of_noise;
        Some(self.held.iter().map(|e| e.fit.base_of_noise().map(|p| p.1)).fold(best, holding))
    }

    /// Sentences that say what widened the intervals of `mu` and `alpha`: of the likeliest explanation where one is named, of the base else.
    pub fn widened(&self, named: bool) -> impl Iterator<Item = String> + '_ {
        let unseen = match self.held.first().filter(|_| named) {
            Some(best) => best.fit.unseen.as_ref(),
            None => self.before.unseen.as_ref(),
        };
        let each = ["mu", "alpha"].into_iter().enumerate();
        unseen.into_iter().flat_map(move |unseen| {
            each.clone().filter_map(|(at, name)| crate::infer::unseen::sentence(name, unseen.times(at), &unseen.by[at]))
        })
    }

    /// Sum of squares that noise alone leaves of the base: rows that count less its parameters.
    #[must_use]
    pub fn expected_square(&self) -> f64 {
        fit::freedom(&prepared::used(&self.design), &self.base)
    }

    /// Share that a sum of squares has lost of what the base leaves beyond noise; none where that is within two standard deviations of noise, a share of
    /// which would say nothing.
    #[must_use]
    pub fn explained(&self, square: f64) -> Option<f64> {
        fit::explained(self.compared_square, self.expected_square(), square)
    }

    /// True where a departure without a name explains the data about as well as what explains them best.
    #[must_use]
    pub fn is_nameless(&self) -> bool {
        is_nameless(self.beyond_nameless)
    }
}

/// Estimates in intervals that hold others as well.
fn holding(best: [Estimate; 2], others: [(f64, f64); 2]) -> [Estimate; 2] {
    std::array::from_fn(|i| {
        let ((value, (low, high)), its) = (best[i], others[i]);
        (value, (low.min(its.0), high.max(its.1)))
    })
}

/// Diagnoses every material of an experiment.
///
/// # Errors
/// See [`DiagnoseError`]; bad or insufficient data are no error but a verdict.
pub fn diagnose(
    experiment: &Experiment,
    models: &Models,
    progress: &Progress<'_>,
) -> Result<Vec<Diagnosis>, DiagnoseError> {
    diagnose_as(Asked::default(), experiment, models, progress)
}

/// The same as it is asked for.
///
/// # Errors
/// As [`diagnose`].
pub fn diagnose_as(
    asked: Asked<'_>,
    experiment: &Experiment,
    models: &Models,
    progress: &Progress<'_>,
) -> Result<Vec<Diagnosis>, DiagnoseError> {
    let each = identify::materials(experiment);
    each.iter().map(|material| one(experiment, (material, asked), models, progress)).collect()
}

fn one(
    experiment: &Experiment,
    (material, asked): (&str, Asked<'_>),
    models: &Models,
    progress: &Progress<'_>,
) -> Result<Diagnosis, DiagnoseError> {
    let start = Instant::now();
    let faults = fault::of(experiment, material);
    let mut diagnosis = Diagnosis::empty(material, faults);
    if let Some(fault) = diagnosis.faults.iter().find(|fault| fault.stops()) {
        diagnosis.refusal = Some(Refusal::Faulty(fault.to_string()));
    } else {
        match Design::of(experiment, material) {
            Err(refusal) => {
                diagnosis.verdict = Verdict::TooFewData;
                diagnosis.refusal = Some(refusal);
            }
            Ok(design) => diagnosis.examine(experiment, (design, asked), models, progress)?,
        }
    }
    diagnosis.seconds = start.elapsed().as_secs_f64();
    Ok(diagnosis)
}

impl Diagnosis {
    /// True where something has a name, or one of a few.
    #[must_use]
    pub fn is_named(&self) -> bool {
        matches!(self.verdict, Verdict::Named | Verdict::Ambiguous)
    }

    /// `mu` (MPa) and `alpha` of the extended model; none where nothing is named.
    #[must_use]
    pub fn extended(&self) -> Option<[Estimate; 2]> {
        self.evidence.as_deref().filter(|_| self.is_named()).and_then(Evidence::extended)
    }

    /// Error on conditions that were left out; none where nothing is named.
    #[must_use]
    pub fn held_out(&self) -> Option<&HeldOut> {
        self.evidence.as_deref().filter(|_| self.is_named()).and_then(|evidence| evidence.held_out.as_ref())
    }

    fn empty(material: &str, faults: Vec<Fault>) -> Self {
        Self {
            material: material.to_owned(),
            verdict: Verdict::Refused,
            findings: Vec::new(),
            shows_in: Vec::new(),
            blind_to: Vec::new(),
            proposals: Vec::new(),
            cancelling: Vec::new(),
            messages: faults.iter().map(ToString::to_string).collect(),
            faults,
            refusal: None,
            evidence: None,
            seconds: 0.0,
        }
    }

    /// What the reader should know besides faults and the reason of a refusal.
    pub fn notes(&self) -> impl Iterator<Item = &str> {
        let mut told: Vec<String> = self.faults.iter().map(ToString::to_string).collect();
        told.extend(self.refusal.iter().map(ToString::to_string));
        self.messages.iter().filter(move |message| !told.contains(message)).map(String::as_str)
    }

    fn examine(
        &mut self,
        experiment: &Experiment,
        (design, asked): (Design, Asked<'_>),
        models: &Models,
        progress: &Progress<'_>,
    ) -> Result<(), DiagnoseError> {
        // faults were told before
        let new = design.messages.iter().filter(|message| !self.messages.contains(message));
        self.messages.extend(new.cloned().collect::<Vec<_>>());
        let stated_n = experiment.sensor.noise_n;
        if !has_replicates(&design) && stated_n.is_none() {
            self.refusal = Some(Refusal::NoNoise);
            return Ok(());
        }
        let library = models.of(&design.geometries, &|done, total| progress("force models", done, total))?;
        let solves = library.solves();
        let missing: Vec<&'static str> = library.missing().map(|missing| missing.code).collect();
        self.messages.extend(library.missing().map(ToString::to_string));
        let chain = Chain { library, passages: design.passages() };
        progress("base", 0, 1);
        let Some(prepared) = Prepared::new(&design, &chain, stated_n) else {
            self.refusal = Some(Refusal::NoSuchNoise);
            return Ok(());
        };
        if prepared.noise.source == Source::Stated {
            self.messages.push(
                "nothing repeats: the noise is the stated one, and the scatter between spots is assumed (0.05 mm of contact, 1 % of gain)".to_owned(),
            );
        }
        let mut candidates = search::candidates(&design);
        candidates.retain(|c| !asked.without.contains(&c.effect.code));
        let first = Search::new(prepared, candidates);
        self.blind_to = verdict::blind_spots(&first);
        self.shows_in = first.adequacy.shows_in.iter().map(|v| v.word()).collect();
        let Searched { visible, found, mut second } = Searched::by(asked.edition, &first, stated_n, progress);
        let Found { search, singles, pairs, mut held, beyond_nameless } = found;
        for explanation in &mut held {
            explanation.fit.unseen = unseen::widening(&search.problem, &explanation.fit);
        }
        let together = pairs.iter().filter(|_| asked.edition == Edition::Second);
        let likeliest = singles.iter().chain(together).min_by(|a, b| a.score().total_cmp(&b.score()));
        let best = held.first().or(likeliest);
        let curves_of =
            |problem: &Problem<'_>| best.map(|e| Problem::curves(&design, &chain, &e.fit.model, &problem.contacts_mm));
        let explained = curves_of(&search.problem);
        let adequate = best.map_or(!visible, |e| e.adequacy.passes());
        let predicted = explained.as_ref().unwrap_or(&search.curves);
        let ripple = ripple::of(experiment, &design, predicted, &search.noise.sensor, adequate);
        self.messages.extend(ripple.map(|r| r.to_string()));
        let held_out = (!held.is_empty()).then(|| held_out::of(experiment, &search, &held)).flatten();
        self.cancelling = verdict::cancelling(&design, &self.blind_to);
        self.proposals = plan::proposals(experiment, &search, &held, &self.blind_to);
        let seen = verdict::Seen {
            visible,
            ripple: ripple.as_ref(),
            gradient: verdict::gradient(&search.noise).copied(),
            uneven: verdict::unevenness(&search.noise),
            slipping: fault::slipping(&self.faults, design.series.len()),
            nameless: held.first().filter(|_| is_nameless(beyond_nameless)).map(|best| search::rival(best, &design)),
        };
        let (is_regular, spoils) = (seen.is_regular(), seen.spoils());
        verdict::conclude(self, experiment, seen, &held, held_out.as_ref());
        if let Some(second) = second.as_mut().filter(|_| !is_regular) {
            second.beside_irregular(spoils);
        }
        // what finite elements did not find cannot be seen
        let unseen = missing.into_iter().filter(|code| !self.findings.iter().any(|f| f.code == *code));
        for code in unseen.collect::<Vec<_>>() {
            if !self.blind_to.contains(&code) {
                self.blind_to.push(code);
            }
        }
        let compared_square = search.base.square;
        let mut first = first;
        first.base.unseen = unseen::widening(&first.problem, &first.base);
        let mut before = Stand::of(&design, &chain, &first.base);
        // where nothing is visible, unseen effects are what intervals have to hold
        if let Some(second) = second.as_ref().filter(|_| self.verdict == Verdict::Unknown) {
            before.parameters = holding(before.parameters, second.intervals);
        }
        let after = best.map(|e| Stand::of(&design, &chain, &e.fit));
        // a noise that was told about what does not hold may leave the base anywhere
        let shown = if held.is_empty() { first } else { search };
        let Search { problem, noise, base, adequacy, margins, .. } = shown;
        self.evidence = Some(Box::new(Evidence {
            design: design.clone(),
            noise,
            base,
            before,
            after,
            compared_square,
            contacts_mm: problem.contacts_mm,
            adequacy,
            margins,
            ripple,
            singles,
            pairs,
            held,
            beyond_nameless,
            second,
            held_out,
            solves,
        }));
        Ok(())
    }
}

/// What a search came to, whichever edition made it.
struct Searched<'a> {
    /// The simulation is wrong.
    visible: bool,
    found: Found<'a>,
    second: Option<Second>,
}

impl<'a> Searched<'a> {
    fn by(edition: Edition, first: &Search<'a>, stated_n: Option<f64>, progress: &Progress<'_>) -> Self {
        match edition {
            Edition::Second => match second::found(first.clone(), stated_n, progress) {
                Some((found, second)) => {
                    Self { visible: second.verdict != Verdict::Clean, found, second: Some(second) }
                }
                None => Self { visible: false, found: Found::nothing(first.clone()), second: None },
            },
            Edition::First => {
                let visible = !first.adequacy.passes() || first.catalogue() > first.spaces.threshold;
                let found = match visible {
                    true => Found::of(first.clone(), stated_n, progress),
                    false => Found::nothing(first.clone()),
                };
                let tried: Vec<&Explanation> = found.singles.iter().chain(&found.pairs).collect();
                let second = second::judged(&found.search, &tried);
                Self { visible, found, second }
            }
        }
    }
}

/// True when two runs on different spots share a condition.
fn has_replicates(design: &Design) -> bool {
    let series = &design.series;
    series.iter().enumerate().any(|(i, a)| series[..i].iter().any(|b| a.condition == b.condition && a.spot != b.spot))
}
