//! Diagnosis of a material that is compressed as a whole and never indented: between platens or in a ring,
//! once or many times.
//!
//! The same questions in the same order as for an indentation ([`crate::diagnose`]), with the same catalogue:
//! effects of the material, the machine and the sensor show in a coupon, those of ball and contact do not.

pub mod answer;
mod discrepancy;
mod forward;
mod held_out;

use std::time::Instant;

use lut_gen::chain::{Chain, Library};
use lut_gen::effect::CATALOGUE;

use super::check::{self, Check, Coupon};
use super::design::Design;
use super::finding::{Finding, Verdict};
use super::fit::Problem;
use super::noise::{self, Noise};
use super::prepared::{Prepared, base_fit, used};
use super::search::{self, Search};
use super::sets::{Judged, Weighed, findings};
use super::whiten::Whitening;
use crate::experiment::{BaseLaw, Experiment, Test};
use crate::infer::sets::{Misfits, Weighing};
use forward::Coupons;

pub use held_out::HeldOut;

/// Parameters that all sets have: `mu` and `alpha`.
const ELASTIC: usize = 2;

/// Why a material is not judged.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Refusal {
    /// No coupon can be used.
    #[error("no compression can be used: {0}")]
    NothingToFit(String),
    /// Nothing tells what noise is.
    #[error(
        "no two compressions repeat each other and no noise is stated: without one of them nobody can say what is noise and what is a discrepancy; repeat one, or state [sensor] noise_N"
    )]
    NoNoise,
    /// No explanation can be weighed.
    #[error("the base law cannot be fitted to these compressions: no number came of it")]
    NoFit,
}

/// A compression with what is predicted of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// A name: its file, and its cycle where there are several.
    pub name: String,
    /// Shortening at every window, mm.
    pub depth_mm: Vec<f64>,
    /// Force that was read, N.
    pub measured_n: Vec<f64>,
    /// By the base.
    pub base_n: Vec<f64>,
    /// By what was found; none where nothing was named.
    pub extended_n: Option<Vec<f64>>,
}

/// What was found about one material.
#[derive(Debug)]
pub struct Diagnosis {
    /// Its name.
    pub material: String,
    /// The verdict.
    pub verdict: Verdict,
    /// Names, the most important first.
    pub findings: Vec<Finding>,
    /// What the misfit of the base varies with, the largest first.
    pub shows_in: Vec<&'static str>,
    /// Effects of which a plausible amount would not be seen.
    pub blind_to: Vec<&'static str>,
    /// Why it is not judged, if so.
    pub refusal: Option<Refusal>,
    /// What the reader should know.
    pub messages: Vec<String>,
    /// What the verdict rests on.
    pub evidence: Option<Box<Evidence>>,
    /// Wall time, s.
    pub seconds: f64,
}

/// What a verdict rests on.
#[derive(Debug)]
pub struct Evidence {
    /// The noise.
    pub noise: Noise,
    /// The base.
    pub base: Weighed,
    /// Sets that were weighed, the likeliest first.
    pub sets: Vec<Weighed>,
    /// The likeliest set of what is named, one for each choice among twins.
    pub held: Vec<Weighed>,
    /// What is believed.
    pub judged: Judged,
    /// Error on compressions that were left out.
    pub held_out: Option<HeldOut>,
    /// All compressions.
    pub curves: Vec<Curve>,
}

/// Materials that are compressed and never indented.
#[must_use]
pub fn materials(experiment: &Experiment) -> Vec<String> {
    let all = crate::identify::materials(experiment);
    let of = |material: &str, tests: &[Test]| {
        experiment.runs.iter().any(|run| {
            let its = run.specimen.map(|at| &experiment.specimens[at]);
            let is_soft = its.is_some_and(|its| its.material == material && its.base_law != BaseLaw::Rigid);
            is_soft && tests.contains(&run.test)
        })
    };
    let is_one =
        |material: &String| of(material, &[Test::Uniaxial, Test::Confined]) && !of(material, &[Test::Indentation]);
    all.into_iter().filter(is_one).collect()
}

/// Diagnoses every material that is compressed and never indented.
#[must_use]
pub fn diagnose(experiment: &Experiment) -> Vec<Diagnosis> {
    materials(experiment).into_iter().map(|material| one(experiment, material)).collect()
}

fn one(experiment: &Experiment, material: String) -> Diagnosis {
    let start = Instant::now();
    let mut out = Diagnosis {
        material,
        verdict: Verdict::Refused,
        findings: Vec::new(),
        shows_in: Vec::new(),
        blind_to: Vec::new(),
        refusal: None,
        messages: Vec::new(),
        evidence: None,
        seconds: 0.0,
    };
    if let Err(cause) = out.examine(experiment) {
        if matches!(cause, Refusal::NothingToFit(_)) {
            out.verdict = Verdict::TooFewData;
        }
        out.refusal = Some(cause);
    }
    out.seconds = start.elapsed().as_secs_f64();
    out
}

/// The coupons of a material as a design without a ball.
fn design(experiment: &Experiment, material: &str) -> Result<Design, Refusal> {
    let is_coupon = |check: &Check| check.coupon().is_some();
    let (all, messages) = check::of(experiment, material, 0.0);
    let peak = all.iter().filter(|c| is_coupon(c)).flat_map(Check::measured).fold(0.0, f64::max);
    if peak <= 0.0 {
        return Err(Refusal::NothingToFit(messages.join("; ")));
    }
    // the zero wanders by a part of the largest force
    let (mut checks, mut messages) = check::of(experiment, material, peak);
    checks.retain(is_coupon);
    messages.extend(Coupon::rub(checks.iter_mut().filter_map(Check::coupon_mut)).err());
    Ok(Design {
        material: material.to_owned(),
        series: Vec::new(),
        checks,
        geometries: Vec::new(),
        rates_mm_per_s: Vec::new(),
        spots: 0,
        conditions: 0,
        groups: 0,
        zero_is_contact: true,
        zero_mm: 0.0,
        messages,
    })
}

impl Diagnosis {
    fn examine(&mut self, experiment: &Experiment) -> Result<(), Refusal> {
        let design = design(experiment, &self.material)?;
        self.messages.clone_from(&design.messages);
        let noise = noise::of_coupons_alone(&design, experiment.sensor.noise_n).ok_or(Refusal::NoNoise)?;
        let chain = Chain { library: Library::default(), passages: Vec::new() };
        let whitening = Whitening::new(&design, &[], &noise).ok_or(Refusal::NoFit)?;
        let used = used(&design);
        let problem = Problem {
            design: &design,
            chain: &chain,
            contacts_mm: Vec::new(),
            back_n: nalgebra::DVector::zeros(whitening.residuals()),
            whitening,
            used,
            whole: None,
        };
        let peak = design.checks.iter().flat_map(Check::measured).fold(0.0, f64::max);
        let base = base_fit(&problem, 0.05 * peak);
        let candidates = search::candidates(&design);
        let mut search = Search::new(Prepared { problem, base, noise }, candidates);
        // an effect of ball or contact changes nothing here
        let mut shows = search.signatures.iter().map(|signature| signature.amax() > 1e-6);
        search.candidates.retain(|_| shows.next().is_some_and(|shows| shows));
        self.judge(experiment, search)
    }

    fn judge(&mut self, experiment: &Experiment, search: Search<'_>) -> Result<(), Refusal> {
        let coupons = Coupons::new(search);
        let groups = &coupons.groups;
        let mut found = Weighing::of(&coupons, groups, ELASTIC).ok_or(Refusal::NoFit)?;
        let best = found.held.first();
        let held_out = best.and_then(|best| held_out::of(&coupons, best));
        let predicts = held_out.as_ref().is_none_or(HeldOut::gains);
        found.keep_names(predicts && best.is_some_and(|best| !best.fit.at_bound));
        self.verdict = found.judged.outcome.into();
        let told = |best: &Weighed| findings(&found.judged, best, |_| Vec::new());
        self.findings = found.held.first().map_or_else(Vec::new, told);
        self.shows_in = found.shows_in(groups);
        self.blind_to = found.blind_to(&coupons, groups, CATALOGUE.iter().map(|effect| effect.code));
        let curves = curves(experiment, &coupons, &found.base, found.held.first());
        let Weighing { base, sets, held, judged } = found;
        let noise = coupons.search.noise.clone();
        self.evidence = Some(Box::new(Evidence { noise, base, sets, held, judged, held_out, curves }));
        Ok(())
    }
}

/// Compressions with what plain fits of base and set predict of them.
fn curves(experiment: &Experiment, coupons: &Coupons<'_>, base: &Weighed, best: Option<&Weighed>) -> Vec<Curve> {
    let checks = &coupons.search.problem.design.checks;
    let plain = |set: &Weighed| {
        let model = coupons.model(set, &nalgebra::DMatrix::zeros(0, 0), None).0.0;
        coupons.plainly(&model, &coupons.measured()).0
    };
    let (base, best) = (plain(base), best.map(plain));
    let names: Vec<String> = experiment
        .runs
        .iter()
        .filter(|run| {
            let its = run.specimen.map(|at| &experiment.specimens[at]);
            [Test::Uniaxial, Test::Confined].contains(&run.test)
                && its.is_some_and(|its| its.material == coupons.search.problem.design.material)
        })
        .map(|run| run.cycle.map_or_else(|| run.file.clone(), |cycle| format!("{}, cycle {cycle}", run.file)))
        .collect();
    let named = |at: usize| names.get(at).filter(|_| names.len() == checks.len()).cloned();
    let each = checks.iter().enumerate().filter_map(|(at, check)| {
        let nodes = check.coupon()?.nodes();
        Some(Curve {
            name: named(at).unwrap_or_else(|| format!("compression {}", at + 1)),
            depth_mm: nodes.iter().map(|n| n.depth_mm).collect(),
            measured_n: check.measured(),
            base_n: check.predicted(&base),
            extended_n: best.as_ref().map(|model| check.predicted(model)),
        })
    });
    each.collect()
}
