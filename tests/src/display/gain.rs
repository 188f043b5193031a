//! Whether what naming an effect gains is what is printed.

use palpate::diagnose::display::ChannelDiagnosis;
use palpate::diagnose::display::channel::Channel;
use palpate::diagnose::display::design::Design;
use palpate::diagnose::display::fit::Problem;
use palpate::diagnose::display::law::Law;
use palpate::experiment::Experiment;
use palpate::extended::display::DisplayModel;
use palpate::simulate::display::Subject;

use super::Case;

/// A printed gain is right within this part.
pub const RIGHT: f64 = 0.1;
/// New sessions that the true gain is taken over: runs have gains of their own, and the mean square of a dozen of them is
/// known to a third only.
const DAYS: u64 = 16;
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
    /// Of a channel of which something is named; none otherwise.
    #[must_use]
    pub fn of(channel: &ChannelDiagnosis, model: &DisplayModel, case: &Case) -> Option<Self> {
        let evidence = channel.evidence.as_deref()?;
        let printed = evidence.held_out.as_ref()?.gain?;
        let own = model.channels.iter().find(|own| own.channel == channel.channel)?;
        // both laws err on the same presses
        let gain = |height: f64| -> Option<f64> {
            let (mut before, mut after) = (0.0, 0.0);
            for day in 0..DAYS {
                let fresh = fresh(case, day, (channel.channel, height));
                let explained = model.explained(&fresh, channel.channel);
                let design = Design::of(&fresh, channel.channel, &explained).ok()?;
                let square = |law: &Law| Problem::unweighted(&design).plain(law).norm_squared();
                before += square(&evidence.base.fit.law);
                after += square(&own.law());
            }
            Some(1.0 - (after / before).sqrt())
        };
        Some(Self { printed: printed.part(), interval: printed.part95, truth: gain(1.0)?, less_far: gain(LESS)? })
    }

    /// Within a tenth of the error that was there before: ten points of the gain.
    #[must_use]
    pub fn is_near(&self) -> bool {
        (self.printed - self.truth).abs() <= RIGHT
    }

    /// Within a tenth of itself.
    #[must_use]
    pub fn is_right(&self) -> bool {
        (self.printed - self.truth).abs() <= RIGHT * self.truth.abs()
    }
}

/// The same display on another day: the same kinds of presses, to heights of their own, with new noise and new gains of every run.
fn fresh(case: &Case, day: u64, (channel, height): (Channel, f64)) -> Experiment {
    let mut spec = case.spec(true);
    spec.seed = case.seed + (day + 1) * 1_000_000;
    spec.runs.retain(|run| shows(run.subject, channel));
    for run in &mut spec.runs {
        run.values.iter_mut().for_each(|value| *value *= height);
    }
    spec.experiment()
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
