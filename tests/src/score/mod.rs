//! The score of a diagnosis on hidden cases: what was true, what could be seen of it, what was answered, and how good that is.
//!
//! A [`suite`] lists cases; [`Scored::of`] makes one, has it diagnosed and judges the answer; a [`table::Score`] adds them up.
//! What can be seen is decided without the diagnosis' verdict, from forces without noise ([`mod@strength`]).

pub mod control;
pub mod cores;
pub mod coverage;
mod detail;
pub mod follow;
pub mod oracle;
pub mod outcome;
pub mod rate;
pub mod share;
pub mod strength;
pub mod suite;
pub mod table;

use lut_gen::chain::LibraryError;
use palpate::diagnose::sets::Weighed;
use palpate::diagnose::{self, DiagnoseError, Diagnosis, Evidence, Finding, Models, Verdict};
use palpate::experiment::Experiment;
use palpate::identify;
use palpate::simulate::{SimulateError, Solver, Spec};

use crate::hidden::{Case, Design, Truth, What};
use coverage::Hit;
use follow::Followed;
use oracle::Gain;
use outcome::Outcome;
use strength::Strength;

/// A case that could not be scored.
#[derive(Debug, thiserror::Error)]
pub enum ScoreError {
    /// The data could not be made.
    #[error("not made: {0}")]
    Made(#[from] SimulateError),
    /// The diagnosis failed: an error of the program, whatever the data.
    #[error("not diagnosed: {0}")]
    Diagnosed(#[from] DiagnoseError),
    /// The force models could not be made.
    #[error("no force model: {0}")]
    Model(#[from] LibraryError),
    /// The data could not be written.
    #[error("not written: {0}")]
    Written(#[from] std::io::Error),
    /// An experiment of one material has one answer.
    #[error("{0} answers to an experiment of one material")]
    Answers(usize),
}

/// What was answered, without the evidence.
#[derive(Debug, Clone, PartialEq)]
pub struct Answer {
    /// Verdict.
    pub verdict: Verdict,
    /// Names.
    pub findings: Vec<Finding>,
    /// Variables in which a discrepancy shows.
    pub shows_in: Vec<&'static str>,
    /// Blind spots.
    pub blind_to: Vec<&'static str>,
    /// Why no diagnosis was made, if so.
    pub reason: Option<String>,
    /// Priors twice as wide would say something else.
    pub rests_on_priors: bool,
    /// Wall time with the force models known, s.
    pub seconds: f64,
}

impl Answer {
    /// Of a diagnosis.
    #[must_use]
    pub fn of(diagnosis: &Diagnosis) -> Self {
        Self {
            verdict: diagnosis.verdict,
            findings: diagnosis.findings.clone(),
            shows_in: diagnosis.shows_in.clone(),
            blind_to: diagnosis.blind_to.clone(),
            reason: diagnosis.refusal.as_ref().map(ToString::to_string),
            rests_on_priors: diagnosis.evidence.as_deref().is_some_and(|e| !e.judged.wider.is_same),
            seconds: diagnosis.seconds,
        }
    }

    /// Verdict, names with their rivals and parameters, on one line.
    #[must_use]
    pub fn line(&self) -> String {
        let names: Vec<String> = self
            .findings
            .iter()
            .map(|f| {
                let parameters: Vec<String> = f.parameters.iter().map(|(n, v, _)| format!("{n}={v:.3}")).collect();
                let rivals: String = f.ambiguous_with.iter().map(|code| format!("|{code}")).collect();
                format!("{}({}){rivals}", f.code, parameters.join(" "))
            })
            .collect();
        let reason = self.reason.iter().map(|reason| format!(" because {reason}"));
        let reason: String = reason.collect();
        format!("{} {} in {:?}{reason}", self.verdict.word().to_uppercase(), names.join(" + "), self.shows_in)
    }
}

/// One case with its score.
#[derive(Debug, Clone)]
pub struct Scored {
    /// Design.
    pub design: Design,
    /// Seed.
    pub seed: u64,
    /// What was true.
    pub truth: Truth,
    /// How far each effect moves the data, in standard deviations of the noise along it; `None` where no run could be used.
    pub strength: Option<Vec<f64>>,
    /// The same to one who has to tell the noise from repeats, see [`Strength::told`].
    pub told: Option<Vec<f64>>,
    /// What was answered.
    pub answer: Answer,
    /// How good that is.
    pub outcome: Outcome,
    /// Held-out errors with the base, with what was found, and with what an oracle would have found; where something shows.
    pub gain: Option<Gain>,
    /// What became of an ambiguous answer when its plan was followed.
    pub followed: Option<Followed>,
    /// Parameters whose truth is known, and whether their intervals hold it.
    pub hits: Vec<Hit>,
    /// What the answer rests on, on one line: the likeliest single effects, noise and base against the truth.
    pub detail: String,
    /// Time of making the data and of the oracle, s.
    pub other_s: f64,
}

impl Scored {
    /// Makes a case, has it diagnosed, and scores the answer.
    ///
    /// # Errors
    /// [`ScoreError`]: when a solve fails.
    pub fn of(case: &Case, solver: &Solver, models: &Models) -> Result<Self, ScoreError> {
        let start = std::time::Instant::now();
        let truth = case.truth();
        let without: Vec<&str> = match truth.what {
            What::Deleted(code, _) => vec![code],
            _ => Vec::new(),
        };
        let made = case.make(solver)?;
        let experiment = made.experiment();
        known_models(&experiment, models)?;
        let diagnoses = diagnose::diagnose_without(&without, &experiment, models, &|_, _, _| {})?;
        let [diagnosis] = diagnoses.as_slice() else { return Err(ScoreError::Answers(diagnoses.len())) };
        let answer = Answer::of(diagnosis);
        let strength = match &diagnosis.evidence {
            Some(evidence) => Some(strength::strength(&made, evidence, models, solver)?),
            None => None,
        };
        let of = |which: fn(&Strength) -> f64| strength.as_ref().map(|each| each.iter().map(which).collect::<Vec<_>>());
        let (strength, told) = (of(|s| s.known), of(|s| s.told));
        let outcome = Outcome::of(&truth, strength.as_deref(), &answer);
        let gain = oracle::gain(&truth, diagnosis, &experiment, models);
        let followed =
            if diagnosis.verdict == Verdict::Ambiguous && matches!(truth.what, What::Catalogue(..) | What::Pair(..)) {
                Followed::of(case, &experiment, diagnosis, strength.as_deref(), (solver, models))?
            } else {
                None
            };
        let hits = coverage::hits(&truth, &outcome, diagnosis, &experiment);
        let detail = diagnosis.evidence.as_deref().map_or_else(String::new, |e| detail(e, &made.truth));
        let other_s = start.elapsed().as_secs_f64() - answer.seconds;
        Ok(Self {
            design: case.design,
            seed: case.seed,
            truth,
            strength,
            told,
            answer,
            outcome,
            gain,
            followed,
            hits,
            detail,
            other_s,
        })
    }

    /// True when every effect shows; false when there is none.
    #[must_use]
    pub fn all_visible(&self) -> bool {
        self.strength.as_ref().is_some_and(|s| !s.is_empty() && s.iter().all(|s| *s > strength::SEEN))
    }

    /// True when an effect shows to one who has to tell the noise from repeats.
    #[must_use]
    pub fn any_told(&self) -> bool {
        self.told.as_ref().is_some_and(|s| s.iter().any(|s| *s > strength::SEEN))
    }

    /// True when an effect shows.
    #[must_use]
    pub fn any_visible(&self) -> bool {
        self.strength.as_ref().is_some_and(|s| s.iter().any(|s| *s > strength::SEEN))
    }

    /// Design, seed, truth, answer and score on one line.
    #[must_use]
    pub fn line(&self) -> String {
        let effects: Vec<String> = self
            .truth
            .effects
            .iter()
            .map(|e| e.to_toml().replace('\n', " ").replace("[[effect]] code = ", ""))
            .collect();
        let followed = self.followed.as_ref().map_or_else(String::new, |f| {
            let made: Vec<String> = f.runs.iter().map(|run| format!("{:?}", run.on)).collect();
            let before: String = f.before.iter().map(|answer| format!("{}, then ", answer.line())).collect();
            format!(
                " ==> after {} runs {before}{} -> {} by {}",
                f.runs.len(),
                f.answer.line(),
                f.outcome.word(),
                made.join(", ")
            )
        });
        let strength: Vec<String> = self.strength.iter().flatten().map(|s| format!("{s:.1}")).collect();
        format!(
            "{} {} {:?} {:?} [{}] strength {} -> {} -> {}{followed} | {} | true mu {:.4} alpha {:.2} | diagnosed {:.1} s, the rest {:.1} s",
            self.design.name(),
            self.seed,
            self.truth.what,
            self.truth.noise,
            effects.join(" + ").trim(),
            strength.join(" "),
            self.answer.line(),
            self.outcome.word().to_uppercase(),
            self.detail,
            self.truth.foam.mu_mpa,
            self.truth.foam.alpha,
            self.answer.seconds,
            self.other_s,
        )
    }
}

/// Makes the force models of an experiment, so that a diagnosis is timed without them.
fn known_models(experiment: &Experiment, models: &Models) -> Result<(), LibraryError> {
    for material in identify::materials(experiment) {
        if let Ok(design) = diagnose::design::Design::of(experiment, &material) {
            models.of(&design.geometries, &|_, _| {})?;
        }
    }
    Ok(())
}

/// How many of the likeliest sets a line tells.
const TOLD: usize = 6;

/// The likeliest sets, each with its probability and the discrepancies beside it (% of the force). Estimates of the noise stand before what is true.
fn detail(e: &Evidence, spec: &Spec) -> String {
    let top = |(set, probability): (&Weighed, &f64)| {
        let codes: Vec<&str> = set.fit.codes().collect();
        let beside: String = e.judged.beside(set).map(|(over, size)| format!(" {over} {:.1}", 100.0 * size)).collect();
        format!("{}:{probability:.3}{beside}", codes.join("+"))
    };
    let tops: Vec<String> = e.sets.iter().zip(&e.judged.sets).take(TOLD).map(top).collect();
    let (n, t) = (&e.noise, &spec.noise);
    let ripple = e.ripple.map_or_else(String::new, |r| {
        format!(" ripple over {:?} {:.2} amplitude {:.5} share {:.2}", r.over, r.frequency, r.amplitude_n, r.share)
    });
    format!(
        "worst {:.2}{ripple} | {} | sigma {:.4}/{:.4} contact {:.3}/{:.3} gain {:.4}/{:.4} time {:.2}/{:.2} white {:.1} relative {:.3}/{:.3} \
         | base mu {:.4} alpha {:.2} square {:.0} of {}",
        e.adequacy.worst(),
        tops.join(" "),
        n.sensor.sigma_n,
        t.sensor_n,
        n.jitter.contact_mm,
        t.contact_jitter_mm,
        n.jitter.gain,
        t.gain_jitter,
        n.sensor.correlation_s,
        t.correlation_s,
        n.sensor.white,
        n.sensor.relative,
        t.proportional,
        e.base.model.mu_mpa,
        e.base.model.alpha,
        e.base.square,
        e.base.residual.len(),
    )
}
