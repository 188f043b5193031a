//! Diagnosis: what a simulated indentation gets wrong, why, and what mending it gains.
//!
//! The order is that of the questions, and none is answered before the one in front of it: is the simulation wrong at all, against the noise of
//! this very data set ([`noise`], [`sets`]); which effects of the catalogue explain it ([`sets`], [`search`]), alone or with others that this design cannot
//! tell apart; what the extended model is; what it gains on conditions that no fit has seen ([`held_out`]); and what this design cannot see.

pub mod answer;
pub mod check;
pub mod compression;
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
pub mod plain;
pub mod plan;
mod prepared;
mod progress;
mod quantile;
mod refusal;
pub mod ripple;
pub mod scatter;
pub mod search;
pub mod sets;
mod spike;
pub mod table;
#[cfg(test)]
mod tests;
mod twins;
pub mod unseen;
mod variable;
mod verdict;
pub mod whiten;

use std::time::Instant;

use crate::experiment::Experiment;
use crate::identify;
use crate::infer::unseen::Widening;
use lut_gen::chain::{Chain, LibraryError};
use nalgebra::DMatrix;

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
use search::Search;
use sets::{Found, Judged, Weighed};
use twins::Twins;

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
    /// The noise: that of the likeliest set that is named, or of the base where none is.
    pub noise: Noise,
    /// The base, fitted in that noise.
    pub base: Fit,
    /// The base as it stands alone: its plain best fit, with intervals in a noise that was told of nothing else.
    pub before: Stand,
    /// The set that figures show beside the base: the likeliest of what had a name, be that withdrawn or not, else the likeliest with an effect.
    pub shown: Option<Weighed>,
    /// Its plain best fit; none where nothing was tried.
    pub after: Option<Stand>,
    /// Contact point of every run, mm, as the base fit sees it.
    pub contacts_mm: Vec<f64>,
    /// What the base leaves.
    pub adequacy: Adequacy,
    /// Margins, as the readings of an [`Adequacy`] refer to them.
    pub margins: Vec<Margin>,
    /// A ripple of the force, if there is one.
    pub ripple: Option<Ripple>,
    /// What it leaves.
    pub left: Option<Adequacy>,
    /// Sets of effects that were weighed, the base among them, the likeliest first.
    pub sets: Vec<Weighed>,
    /// The likeliest set of what is named, one for each choice among twins, the likeliest first.
    pub held: Vec<Weighed>,
    /// What is believed.
    pub judged: Judged,
    /// Error on what was left out.
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
    /// `mu` (MPa) and `alpha` of the likeliest set that is named at its plain best fit, each in an interval that has those of all that may be: which of these is true is not known.
    #[must_use]
    pub fn extended(&self) -> Option<[Estimate; 2]> {
        let best = self.after.as_ref().filter(|_| !self.held.is_empty())?.parameters;
        let own = self.held.iter().map(|e| e.fit.base().map(|p| p.1));
        Some(own.chain([self.judged.elastic()]).fold(best, holding))
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
    diagnose_without(&[], experiment, models, progress)
}

/// The same with a catalogue that lacks some codes: what they would explain should then be unknown.
///
/// # Errors
/// As [`diagnose`].
pub fn diagnose_without(
    codes: &[&str],
    experiment: &Experiment,
    models: &Models,
    progress: &Progress<'_>,
) -> Result<Vec<Diagnosis>, DiagnoseError> {
    let compressed = compression::materials(experiment);
    let mut each = identify::materials(experiment);
    each.retain(|material| !compressed.contains(material));
    each.iter().map(|material| one(experiment, (material, codes), models, progress)).collect()
}

fn one(
    experiment: &Experiment,
    (material, without): (&str, &[&str]),
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
            Ok(design) => diagnosis.examine(experiment, (design, without), models, progress)?,
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
        (design, without): (Design, &[&str]),
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
        candidates.retain(|c| !without.contains(&c.effect.code));
        let mut first = Search::new(prepared, candidates);
        let twins = Twins::of(&first);
        first.base.reach_in(&twins.draws);
        self.blind_to = verdict::blind_spots(&first, &twins);
        let Some(found) = sets::found(first.clone(), stated_n, progress) else {
            self.refusal = Some(Refusal::NoSuchNoise);
            return Ok(());
        };
        let evidence = self.told(experiment, (first, twins), found);
        // what finite elements did not find cannot be seen
        let unseen = missing.into_iter().filter(|code| !self.findings.iter().any(|f| f.code == *code));
        for code in unseen.collect::<Vec<_>>() {
            if !self.blind_to.contains(&code) {
                self.blind_to.push(code);
            }
        }
        self.evidence = Some(Box::new(Evidence { solves, ..evidence }));
        Ok(())
    }

    /// Verdict, names and plan of what was found, and what they rest on.
    fn told(
        &mut self,
        experiment: &Experiment,
        (mut first, clean): (Search<'_>, Twins),
        mut found: Found<'_>,
    ) -> Evidence {
        let (design, chain) = (first.problem.design, first.problem.chain);
        first.base.unseen = unseen::widening(&first.problem, &first.base);
        let adequacy = clean.adequacy(&first.base, &DMatrix::zeros(first.problem.whitening.residuals(), 0));
        self.shows_in = adequacy.shows_in.iter().map(|v| v.word()).collect();
        // in the same noise they are the same
        let others = found.is_told.then(|| Twins::of(&found.search));
        let twins = others.as_ref().unwrap_or(&clean);
        for set in &mut found.held {
            set.fit.unseen = unseen::widening(&found.search.problem, &set.fit);
            set.fit.reach_in(&twins.draws);
        }
        let search = &found.search;
        let held_out = (!found.held.is_empty()).then(|| held_out::of(experiment, search, &found.held)).flatten();
        self.cancelling = verdict::cancelling(design, &self.blind_to);
        self.proposals = plan::proposals(experiment, search, &found.rivals(), &self.blind_to);
        let with_an_effect = || found.sets.iter().find(|set| !set.fit.candidates.is_empty());
        let shown = found.held.first().or_else(with_an_effect).cloned();
        let left = shown.as_ref().map(|set| twins.adequacy(&set.fit, &set.known));
        let explained =
            shown.as_ref().map(|set| Problem::curves(design, chain, &set.fit.model, &search.problem.contacts_mm));
        let predicted = explained.as_ref().unwrap_or(&search.curves);
        let is_adequate = left.as_ref().unwrap_or(&adequacy).passes();
        let ripple = ripple::of(experiment, design, predicted, &search.noise.sensor, is_adequate);
        self.messages.extend(ripple.map(|r| r.to_string()));
        let after = shown.as_ref().map(|set| Stand::of(design, chain, &set.fit));
        let seen = verdict::Seen {
            ripple: ripple.as_ref(),
            gradient: verdict::gradient(&search.noise).copied(),
            uneven: verdict::unevenness(&search.noise),
            slipping: fault::slipping(&self.faults, design.series.len()),
        };
        verdict::conclude(self, experiment, &seen, &mut found, held_out.as_ref());
        let mut before = Stand::of(design, chain, &first.base);
        before.parameters = holding(before.parameters, found.judged.elastic());
        let Found { search, sets, held, judged, .. } = found;
        // a noise that was told about what is not named may leave the base anywhere
        let (Search { problem, noise, base, .. }, margins, adequacy) = match held.is_empty() {
            true => (first, clean.margins, adequacy),
            false => {
                let none = DMatrix::zeros(search.problem.whitening.residuals(), 0);
                let adequacy = twins.adequacy(&search.base, &none);
                (search, others.unwrap_or(clean).margins, adequacy)
            }
        };
        Evidence {
            design: design.clone(),
            noise,
            base,
            before,
            after,
            contacts_mm: problem.contacts_mm,
            adequacy,
            margins,
            ripple,
            shown,
            left,
            sets,
            held,
            judged,
            held_out,
            solves: 0,
        }
    }
}

/// True when two runs on different spots share a condition.
fn has_replicates(design: &Design) -> bool {
    let series = &design.series;
    series.iter().enumerate().any(|(i, a)| series[..i].iter().any(|b| a.condition == b.condition && a.spot != b.spot))
}
