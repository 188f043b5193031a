//! Whether what naming an effect gains is what is printed.

use palpate::diagnose::display::ChannelDiagnosis;
use palpate::diagnose::display::design::Design;
use palpate::diagnose::display::fit::Problem;
use palpate::diagnose::display::law::Law;
use palpate::experiment::Experiment;
use palpate::extended::display::DisplayModel;

use super::Case;

/// A printed gain is right within this part.
pub const RIGHT: f64 = 0.1;
/// New sessions that the true gain is taken over: gains scatter from run to run.
const DAYS: u64 = 4;
/// Heights of their presses over those of the diagnosed ones.
const LESS: f64 = 0.93;

/// Gain, as the part of the error that is gone: printed, and true.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gains {
    /// On the page.
    pub printed: f64,
    /// Its interval, also there.
    pub interval: (f64, f64),
    /// In new sessions.
    pub truth: f64,
}

impl Gains {
    /// Of a channel of which something is named; none otherwise.
    #[must_use]
    pub fn of(channel: &ChannelDiagnosis, model: &DisplayModel, case: &Case) -> Option<Self> {
        let evidence = channel.evidence.as_deref()?;
        let printed = evidence.held_out.as_ref()?.gain?;
        let own = model.channels.iter().find(|own| own.channel == channel.channel)?;
        let square = |law: &Law| -> Option<f64> {
            let each = (0..DAYS).map(|day| {
                let fresh = fresh(case, day);
                let explained = model.explained(&fresh, channel.channel);
                let design = Design::of(&fresh, channel.channel, &explained).ok()?;
                Some(Problem::unweighted(&design).plain(law).norm_squared())
            });
            each.sum()
        };
        let truth = 1.0 - (square(&own.law())? / square(&evidence.base.fit.law)?).sqrt();
        Some(Self { printed: printed.part(), interval: printed.part95, truth })
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

/// The same display on another day: the same kinds of presses, a little less far, with new noise and new gains of every run.
fn fresh(case: &Case, day: u64) -> Experiment {
    let mut spec = case.spec(true);
    spec.seed = case.seed + (day + 1) * 1_000_000;
    for run in &mut spec.runs {
        run.values.iter_mut().for_each(|value| *value *= LESS);
    }
    spec.experiment()
}
