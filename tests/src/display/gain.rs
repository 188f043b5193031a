//! Whether what naming an effect gains is what is printed.

use palpate::diagnose::display::ChannelDiagnosis;
use palpate::diagnose::display::channel::Channel;
use palpate::diagnose::display::design::Design;
use palpate::diagnose::display::fit::Problem;
use palpate::diagnose::display::law::Law;
use palpate::experiment::Experiment;
use palpate::extended::display::{DisplayModel, Gain};
use palpate::simulate::display::Subject;
use rayon::prelude::*;

use super::Case;

/// A printed gain is right within this part.
pub const RIGHT: f64 = 0.1;
/// Seeds between one session and the next, and between those of the truth and those of a validation.
const NEXT_DAY: u64 = 1_000_000;
const VALIDATION: u64 = 500 * NEXT_DAY;
/// Sessions that a validation begins with, and runs that it may take: a gain of 5 % is known to a
/// tenth of itself after some 3000.
const FIRST: usize = 4;
const MOST: usize = 4000;
/// Heights of presses over those of the diagnosed ones: the same, and commands that nobody has given.
const LESS: f64 = 0.93;

/// Gain, as the part of the error that is gone: printed, and true.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gains {
    /// On the page.
    pub printed: f64,
    /// Its interval, also there.
    pub interval: (f64, f64),
    /// In new sessions of the same commands.
    pub truth: f64,
    /// In sessions of like commands, less far.
    pub less_far: f64,
}

impl Gains {
    /// Of a channel of which something is named, the true gain over some new sessions: runs have gains of their own, and the
    /// mean square of a dozen of them is known to a third only. None otherwise.
    #[must_use]
    pub fn of(channel: &ChannelDiagnosis, model: &DisplayModel, case: &Case, days: u64) -> Option<Self> {
        let evidence = channel.evidence.as_deref()?;
        let printed = evidence.held_out.as_ref()?.gain?;
        let own = model.channels.iter().find(|own| own.channel == channel.channel)?;
        let alone = own.law_alone()?;
        // both laws err on the same presses
        let squares = |day: u64, height: f64| -> Option<(f64, f64)> {
            let fresh = fresh(case, day, (channel.channel, height));
            let explained = model.explained(&fresh, channel.channel);
            let design = Design::of(&fresh, channel.channel, &explained).ok()?;
            let square = |law: &Law| Problem::unweighted(&design).plain(law).norm_squared();
            Some((square(&alone), square(&own.law())))
        };
        let gain = |height: f64, days: u64| -> Option<f64> {
            let each: Option<Vec<_>> = (1..=days).into_par_iter().map(|day| squares(day, height)).collect();
            let (before, after) = each?.into_iter().fold((0.0, 0.0), |sum, own| (sum.0 + own.0, sum.1 + own.1));
            Some(1.0 - (after / before).sqrt())
        };
        Some(Self {
            printed: printed.part(),
            interval: printed.part95,
            truth: gain(1.0, days)?,
            less_far: gain(LESS, days.div_ceil(4))?,
        })
    }

    /// Within a tenth of the error that was there before: ten points of the gain.
    #[must_use]
    pub fn is_near(&self) -> bool {
        (self.printed - self.truth).abs() <= RIGHT
    }

    /// Within a tenth of itself.
    #[must_use]
    pub fn is_right(&self) -> bool {
        is_right(self.printed, self.truth)
    }
}

/// True for a gain within a tenth of the true one.
#[must_use]
pub fn is_right(gain: f64, truth: f64) -> bool {
    (gain - truth).abs() <= RIGHT * truth.abs()
}

/// A model's gain as a laboratory measures it: after some sessions as many as the program asks for, once.
#[derive(Debug, Clone, PartialEq)]
pub struct Validated {
    /// As the program tells it.
    pub gain: Gain,
}

impl Validated {
    /// Of a channel of a model; none where its runs cannot be used.
    #[must_use]
    pub fn of(channel: Channel, model: &DisplayModel, case: &Case) -> Option<Self> {
        let mut days = VALIDATION / NEXT_DAY..;
        let mut day = || days.next().map(|day| fresh(case, day, (channel, 1.0)));
        let mut all = day()?;
        let each = all.runs.len();
        let mut record = |wanted: usize| -> Option<Gain> {
            while all.runs.len() < wanted {
                all.runs.extend(day()?.runs);
            }
            model.gain(&all).ok()?.into_iter().find(|own| own.channel == channel)
        };
        let most = MOST / each * each;
        let first = record(FIRST * each)?;
        let wanted = first.more_runs().map_or(most, |more| first.runs.len() + more);
        record(wanted.min(most)).map(|gain| Self { gain })
    }

    /// Runs that were recorded.
    #[must_use]
    pub fn runs(&self) -> usize {
        self.gain.runs.len()
    }

    /// True where the program says that the gain is known closely.
    #[must_use]
    pub fn is_close(&self) -> bool {
        self.gain.more_runs() == Some(0)
    }
}

/// The same display on another day: the same kinds of presses, to heights of their own, with new noise and new gains of every run.
fn fresh(case: &Case, day: u64, (channel, height): (Channel, f64)) -> Experiment {
    let mut spec = case.spec(true);
    spec.seed = case.seed + day * NEXT_DAY;
    spec.runs.retain(|run| shows(run.subject, channel));
    for run in &mut spec.runs {
        run.values.iter_mut().for_each(|value| *value *= height);
    }
    let mut experiment = spec.experiment();
    for run in &mut experiment.runs {
        run.file = format!("{day}/{}", run.file);
    }
    experiment
}

/// True where runs of a subject record a channel.
fn shows(subject: Subject, channel: Channel) -> bool {
    match channel {
        Channel::Position => subject == Subject::Position,
        Channel::Force => subject == Subject::Force,
        Channel::Current | Channel::Flux => subject == Subject::Coil,
        Channel::Pulp => subject == Subject::Pulp,
        Channel::Fluid => subject == Subject::Fluid,
    }
}
