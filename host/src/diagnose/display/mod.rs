//! Diagnosis of the display: what its simulation gets wrong, from commanded and measured position, force,
//! current and flux, and from what a finger on it bears.
//!
//! The same questions in the same order as for an indentation ([`crate::diagnose`]), asked of every channel by itself: what a channel is told is
//! recorded, so that an effect in one leaves the others as they are.

pub mod answer;
mod borne;
pub mod channel;
pub mod command;
pub mod design;
mod discrepancy;
pub mod effect;
pub mod fit;
mod forward;
pub mod gain;
pub mod held_out;
pub mod law;
pub mod noise;
pub mod plan;
mod sample;
mod smooth;
mod verdict;
pub mod whiten;
mod winding;
mod yielding;

use std::time::Instant;

use crate::diagnose::Verdict;
use crate::experiment::{Experiment, Test};
use crate::infer::sets::{Outcome, Weighing};

use channel::Channel;
use design::{Design, Explained, Unusable};
use fit::{Estimate, Fit, Problem};
use forward::Search;
pub use forward::{Judged, Weighed};
use held_out::HeldOut;
use law::Law;
use noise::{Jitter, Noise, SensorNoise};
use plan::Proposal;
use whiten::Whitening;

/// Why a channel is not judged.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Refusal {
    /// It cannot be used.
    #[error("{0}")]
    Unusable(#[from] Unusable),
    /// Nothing tells what noise is.
    #[error(
        "no two runs repeat a command: without repeats nobody can say what is noise and what is a discrepancy; give at least one command twice, better three times"
    )]
    NoNoise,
}

/// One effect, or a set of names that stands for it.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// Code of the likeliest name.
    pub code: &'static str,
    /// Which of its forms.
    pub form: &'static str,
    /// Parameters with 95 % intervals.
    pub parameters: Vec<Estimate>,
    /// Other names that these runs cannot tell from it.
    pub ambiguous_with: Vec<&'static str>,
    /// Probability that it is there.
    pub probability: f64,
    /// Share of the misfit that it explains alone, where there is one.
    pub explains: Option<f64>,
}

/// What was found in one channel.
#[derive(Debug)]
pub struct ChannelDiagnosis {
    /// The channel.
    pub channel: Channel,
    /// The verdict.
    pub verdict: Verdict,
    /// Named effects, or the sets that stand for one.
    pub findings: Vec<Finding>,
    /// Variables in which a discrepancy shows, the worst first.
    pub shows_in: Vec<&'static str>,
    /// Effects of which a plausible amount would not be seen.
    pub blind_to: Vec<&'static str>,
    /// Next runs, the best first.
    pub proposals: Vec<Proposal>,
    /// Why it was refused, if so.
    pub refusal: Option<Refusal>,
    /// What the verdict rests on.
    pub evidence: Option<Box<Evidence>>,
    /// What the reader should know.
    pub messages: Vec<String>,
}

/// What a verdict rests on.
#[derive(Debug)]
pub struct Evidence {
    /// The runs.
    pub design: Design,
    /// The noise.
    pub noise: Noise,
    /// The base.
    pub base: Weighed,
    /// Sets that were weighed, the base among them, the likeliest first.
    pub sets: Vec<Weighed>,
    /// The likeliest set of what is named, one for each choice among twins, the likeliest first.
    pub held: Vec<Weighed>,
    /// What is believed.
    pub judged: Judged,
    /// Error on commands that were left out.
    pub held_out: Option<HeldOut>,
}

/// What was found about a display.
#[derive(Debug)]
pub struct Diagnosis {
    /// The verdict on all channels together.
    pub verdict: Verdict,
    /// Each channel that was recorded.
    pub channels: Vec<ChannelDiagnosis>,
    /// Wall time, s.
    pub seconds: f64,
}

/// True when an experiment holds runs of a display.
#[must_use]
pub fn has_runs(experiment: &Experiment) -> bool {
    experiment.runs.iter().any(|run| run.test == Test::Display)
}

/// Diagnoses the display of an experiment; `None` when it holds no run of one.
#[must_use]
pub fn diagnose(experiment: &Experiment, progress: &super::Progress<'_>) -> Option<Diagnosis> {
    if !has_runs(experiment) {
        return None;
    }
    let start = Instant::now();
    let mut channels = Vec::new();
    for channel in Channel::ALL {
        let explained = if channel == Channel::Flux { explained(&channels) } else { Explained::new() };
        match Design::of(experiment, channel, &explained) {
            Err(Unusable::Absent) => {}
            Err(cause) => channels.push(refused(channel, cause)),
            Ok(design) => {
                progress(channel.word(), channels.len(), Channel::ALL.len());
                channels.push(examined(design));
            }
        }
    }
    Some(Diagnosis { verdict: verdict::together(&channels), channels, seconds: start.elapsed().as_secs_f64() })
}

/// The coil's current as its own channel explains it and the fluid has answered it; nothing where
/// it does not.
fn explained(channels: &[ChannelDiagnosis]) -> Explained {
    let current = channels.iter().find(|c| c.channel == Channel::Current && c.verdict != Verdict::Unknown);
    let Some(evidence) = current.and_then(|c| c.evidence.as_deref()) else { return Explained::new() };
    by(&evidence.design, &evidence.held.first().unwrap_or(&evidence.base).fit.law)
}

/// What the fluid has answered of the current of every run, by a law.
fn by(current: &Design, law: &Law) -> Explained {
    current.series.iter().map(|series| (series.file.clone(), law.answered_a(series))).collect()
}

/// The coil's current of an experiment as a law explains it and the fluid has answered it; without a law, as the base does that
/// is fitted to these very runs. Nothing where it was not recorded.
///
/// What remembers in steel turns with every wiggle of its current: noise would be taken for loops.
#[must_use]
pub fn answered(experiment: &Experiment, law: Option<&Law>) -> Explained {
    let Ok(design) = Design::of(experiment, Channel::Current, &Explained::new()) else { return Explained::new() };
    match law {
        Some(law) => by(&design, law),
        None => by(&design, &Problem::unweighted(&design).fit(&Law::nominal(Channel::Current)).law),
    }
}

fn empty(channel: Channel, verdict: Verdict) -> ChannelDiagnosis {
    ChannelDiagnosis {
        channel,
        verdict,
        findings: Vec::new(),
        shows_in: Vec::new(),
        blind_to: Vec::new(),
        proposals: Vec::new(),
        refusal: None,
        evidence: None,
        messages: Vec::new(),
    }
}

fn refused(channel: Channel, cause: Unusable) -> ChannelDiagnosis {
    let verdict = match cause {
        Unusable::Dead { .. } => Verdict::Refused,
        Unusable::Absent | Unusable::Still { .. } | Unusable::Short { .. } => Verdict::TooFewData,
    };
    ChannelDiagnosis { refusal: Some(cause.into()), ..empty(channel, verdict) }
}

fn examined(design: Design) -> ChannelDiagnosis {
    let mut out = empty(design.channel, Verdict::Refused);
    out.messages.clone_from(&design.messages);
    let Some((problem, base, noise)) = prepared(&design) else {
        out.refusal = Some(Refusal::NoNoise);
        return out;
    };
    out.messages.extend(base.at_ends());
    let search = Search::new(problem, base, noise);
    let groups = discrepancy::groups(&search.problem, &search.base.law, &search.noise);
    let Some(mut found) = Weighing::of(&search, &groups, search.base.law.base.len()) else {
        out.refusal = Some(Refusal::NoNoise);
        return out;
    };
    out.blind_to = found.blind_to(&search, &groups, search.effects.iter().map(|effect| effect.code));
    let held_out = (!found.held.is_empty()).then(|| held_out::of(&search, &found.held)).flatten();
    let left = found.sets.first().map(|best| verdict::left(&search, &groups, best));
    let is_irregular = left.as_ref().is_some_and(verdict::Left::is_irregular);
    let is_gross = left.as_ref().is_some_and(verdict::Left::is_gross);
    found.keep_names(!is_gross && verdict::hold(&found.held, held_out.as_ref()));
    if found.judged.outcome == Outcome::Unknown && found.judged.partly.is_empty() && found.judged.nothing > ALARM {
        found.judged.outcome = Outcome::Clean;
    }
    if is_irregular && found.judged.outcome == Outcome::Clean {
        found.judged.outcome = Outcome::Unknown;
    }
    out.proposals = plan::proposals(&search, &found.rivals(), &out.blind_to);
    out.verdict = found.judged.outcome.into();
    out.findings = found.held.first().map_or_else(Vec::new, |best| verdict::findings(&found.judged, best));
    out.shows_in = found.shows_in(&groups);
    if is_irregular && found.judged.outcome != Outcome::Clean {
        out.shows_in.push("no order");
    }
    let Weighing { base, sets, held, judged } = found;
    let noise = search.noise;
    out.evidence = Some(Box::new(Evidence { noise, base, sets, held, judged, held_out, design: design.clone() }));
    out
}

/// Probability that nothing is wrong, above which there is no alarm: a channel has few effects, each of them likely
/// beforehand, and the likeliest is soon more likely than not.
const ALARM: f64 = 0.05;

/// Rounds in which noise and base are found, each from the other.
const ROUNDS: usize = 2;

/// Noise and base fit; `None` without repeats.
fn prepared(design: &Design) -> Option<(Problem<'_>, Fit, Noise)> {
    // before anything is known: a hundredth of the span, white
    let sensor = SensorNoise { sigma: 0.01 * design.span.max(1e-9), white: 0.5, correlation_s: 0.1, relative: 0.0 };
    let jitter = Jitter { gain: design.channel.expected_gain(), zero: 0.0, slide: 0.0 };
    let mut noise = Noise { sensor, jitter, freedom: 5.0, sensor_freedom: 50.0 };
    let used: Vec<bool> = design.series.iter().map(|s| !s.hold_out).collect();
    let mut law = Law::nominal(design.channel);
    for round in 0..=ROUNDS {
        let predicted: Vec<Vec<f64>> = design.series.iter().map(|s| law.predict(s)).collect();
        if round > 0 {
            noise = noise::estimate(design, &predicted)?;
        }
        let whitening = Whitening::new(design, &predicted, &noise);
        let problem = Problem { design, whitening, used: Vec::new() }.for_runs(used.clone());
        let fit = problem.fit(&law);
        if round == ROUNDS {
            return Some((problem, fit, noise));
        }
        law = fit.law;
    }
    None
}
