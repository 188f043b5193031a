//! What a display's model gains on recordings that no fit has seen, how sure that is, and how many runs would tell it closely.

use serde_json::{Value, json};

use crate::calibration::distribution::student_critical;
use crate::diagnose::display::channel::Channel;

/// A gain is known closely when its interval ends within this part of it on either side.
pub const CLOSELY: f64 = 0.1;
/// Level that an interval misses: 95 % intervals.
const MISSED: f64 = 0.05;

/// What is missed of one run.
#[derive(Debug, Clone, PartialEq)]
pub struct Missed {
    /// Its file.
    pub file: String,
    /// Place of its command.
    pub command: usize,
    /// Samples that were compared.
    pub samples: usize,
    /// Sum of the squares of measured less predicted with the base law.
    pub before: f64,
    /// The same with the model.
    pub after: f64,
    /// The same with the base law fitted to these very runs.
    pub fitted: f64,
}

/// How far the farther end of a gain's 95 % interval is, over what is close: 1 or less is close. Infinite where nothing is gained.
pub(crate) fn looseness(part: f64, (low, high): (f64, f64)) -> f64 {
    if part > 0.0 { (part - low).max(high - part) / (CLOSELY * part) } else { f64::INFINITY }
}

/// Runs of which each says how far another may be off: repeats of one command.
#[derive(Debug, Clone, PartialEq)]
struct Group {
    /// Runs.
    count: usize,
    /// What they add to the variance of the logarithm of the ratio of both errors.
    variance: f64,
}

/// What a model gains on the runs of one channel. Every command counts alike, however often it was given.
#[derive(Debug, Clone, PartialEq)]
pub struct Gain {
    /// The channel.
    pub channel: Channel,
    /// The base law is that of the model's file, a fit to the diagnosed runs; else it is the one fitted to these runs.
    pub is_as_diagnosed: bool,
    /// Every run.
    pub runs: Vec<Missed>,
    /// The part of the error that is gone, with 95 % certainty; `None` where no two runs can be compared.
    pub part95: Option<(f64, f64)>,
}

impl Gain {
    /// Of runs of a channel.
    #[must_use]
    pub fn new(channel: Channel, is_as_diagnosed: bool, runs: Vec<Missed>) -> Self {
        let part95 = interval(&runs);
        Self { channel, is_as_diagnosed, runs, part95 }
    }

    /// Samples that were compared.
    #[must_use]
    pub fn samples(&self) -> usize {
        self.runs.iter().map(|run| run.samples).sum()
    }

    /// Root mean square error of the base law, in the channel's unit.
    #[must_use]
    pub fn base(&self) -> f64 {
        rms(&self.runs, |run| run.before)
    }

    /// The same of the model as it is.
    #[must_use]
    pub fn model(&self) -> f64 {
        rms(&self.runs, |run| run.after)
    }

    /// The same of the base law fitted to these very runs.
    #[must_use]
    pub fn fitted_base(&self) -> f64 {
        rms(&self.runs, |run| run.fitted)
    }

    /// The part of the base law's error that is gone; less than nothing where the model errs more. NaN without any error.
    #[must_use]
    pub fn part(&self) -> f64 {
        1.0 - self.model() / self.base()
    }

    /// Runs that are wanted beside these before the gain is known closely, as far as these tell: 0 where it is, `None` where they do
    /// not tell it from no gain. Of every command alike: more of those that differ most would ask for too few of a command whose
    /// first runs were alike by chance, and end with gains that are too large. Asking again and again does as well: a gain that
    /// looks large needs fewer runs.
    #[must_use]
    pub fn more_runs(&self) -> Option<usize> {
        let part95 = self.part95.filter(|(low, _)| *low > 0.0)?;
        let off = looseness(self.part(), part95);
        // an interval is as wide as one over the root of the runs
        Some((self.runs.len() as f64 * (off * off - 1.0).max(0.0)).ceil() as usize)
    }

    /// As JSON, its keys with the channel's unit.
    #[must_use]
    pub fn json(&self) -> Value {
        let unit = self.channel.unit();
        let finite = |x: f64| x.is_finite().then_some(x);
        json!({
            "channel": self.channel.word(), "runs": self.runs.len(), "samples": self.samples(),
            format!("rmse_{unit}_fitted_base"): self.fitted_base(),
            format!("rmse_{unit}_base"): self.base(),
            format!("rmse_{unit}_model"): self.model(),
            "base": if self.is_as_diagnosed { "as diagnosed" } else { "fitted to these runs" },
            "gain": finite(self.part()),
            "gain_interval95": self.part95.map(|(low, high)| [finite(low), finite(high)]),
            "more_runs": self.more_runs(),
        })
    }
}

/// How many runs each run shares its command with, itself among them.
fn shared(runs: &[Missed]) -> Vec<f64> {
    let times = |command: usize| runs.iter().filter(|run| run.command == command).count() as f64;
    runs.iter().map(|run| times(run.command)).collect()
}

/// Sum over commands of the mean over the runs of each.
fn sum(runs: &[Missed], of: impl Fn(&Missed) -> f64) -> f64 {
    runs.iter().zip(shared(runs)).map(|(run, times)| of(run) / times).sum()
}

/// Root mean square of what is missed.
fn rms(runs: &[Missed], square: impl Fn(&Missed) -> f64) -> f64 {
    (sum(runs, square) / sum(runs, |run| run.samples as f64).max(1.0)).sqrt()
}

/// Repeats of each command. Commands that were given once are a group together, which makes the interval wider, for they
/// differ by what they ask for as well; one alone is in the last group.
fn groups(runs: &[Missed]) -> Vec<Group> {
    let (before, after) = (sum(runs, |run| run.before), sum(runs, |run| run.after));
    let own = |run: &Missed, times: f64| 0.5 * (run.after / after - run.before / before) / times;
    let commands = runs.iter().map(|run| run.command + 1).max().unwrap_or(0);
    // what each run adds to the logarithm of the ratio of both errors
    let mut groups: Vec<Vec<f64>> = vec![Vec::new(); commands];
    runs.iter().zip(shared(runs)).for_each(|(run, times)| groups[run.command].push(own(run, times)));
    let (mut groups, single): (Vec<_>, Vec<_>) =
        groups.into_iter().filter(|own| !own.is_empty()).partition(|own| own.len() > 1);
    let single: Vec<f64> = single.into_iter().flatten().collect();
    match groups.last_mut() {
        Some(last) if single.len() == 1 => last.extend(single),
        _ if single.len() > 1 => groups.push(single),
        _ => {}
    }
    let told = |group: Vec<f64>| {
        let count = group.len() as f64;
        let mean = group.iter().sum::<f64>() / count;
        let apart: f64 = group.iter().map(|own| (own - mean).powi(2)).sum();
        Group { count: group.len(), variance: apart * count / (count - 1.0) }
    };
    groups.into_iter().map(told).collect()
}

/// 95 % interval of the part of the error that is gone, runs of one command drawn from what it does: the logarithm of the ratio
/// of both errors to first order in the squares of each run (delta method), degrees of freedom by Satterthwaite.
fn interval(runs: &[Missed]) -> Option<(f64, f64)> {
    let groups = groups(runs);
    let variance: f64 = groups.iter().map(|group| group.variance).sum();
    // NaN without an error
    if variance.is_nan() || variance <= 0.0 {
        return None;
    }
    let lost = groups.iter().map(|group| group.variance.powi(2) / (group.count as f64 - 1.0));
    let freedom = variance * variance / lost.sum::<f64>();
    let width = variance.sqrt() * student_critical(MISSED, freedom);
    let ratio = (sum(runs, |run| run.after) / sum(runs, |run| run.before)).sqrt();
    Some((1.0 - ratio * width.exp(), 1.0 - ratio * (-width).exp()))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};
    use rand_pcg::Pcg64;

    use super::*;

    /// Commands of sizes 1, 2 and 4: a run errs by its own gain of unit deviation, before by `OFF` as well.
    const SIZES: [f64; 3] = [1.0, 2.0, 4.0];
    const OFF: f64 = 2.0;

    /// So many runs of each command.
    fn drawn(chance: &mut Pcg64, times: [usize; 3]) -> Gain {
        let mut run = |command: usize| {
            let own: f64 = StandardNormal.sample(chance);
            let square = |error: f64| (SIZES[command] * error).powi(2);
            Missed {
                file: command.to_string(),
                command,
                samples: 1,
                before: square(own + OFF),
                after: square(own),
                fitted: 0.0,
            }
        };
        let runs = (0..3).flat_map(|command| vec![command; times[command]]).map(&mut run).collect();
        Gain::new(Channel::Force, true, runs)
    }

    #[test]
    fn the_interval_holds_the_true_gain_and_the_runs_asked_for_tell_it_closely() {
        let mut chance = Pcg64::seed_from_u64(5);
        let truth = 1.0 - 1.0 / (1.0 + OFF * OFF).sqrt();
        let holds = |gain: &Gain| gain.part95.is_some_and(|(low, high)| low <= truth && truth <= high);
        for times in [[12, 12, 12], [6, 9, 24]] {
            let held = (0..1000).filter(|_| holds(&drawn(&mut chance, times))).count();
            // squares of a dozen runs a command are not normal: 95 % less a few
            assert!((900..=975).contains(&held), "{held} of 1000");
        }
        let mut close = 0;
        for _ in 0..200 {
            let more = drawn(&mut chance, [24; 3]).more_runs().unwrap().div_ceil(3);
            let then = drawn(&mut chance, [24 + more; 3]);
            close += usize::from((then.part() - truth).abs() <= CLOSELY * truth);
        }
        // the number asked for is itself known to a third only
        assert!(close >= 180, "{close} of 200");
    }

    #[test]
    fn every_command_counts_alike_however_often_it_was_given() {
        let run =
            |command, before, after| Missed { file: String::new(), command, samples: 2, before, after, fitted: 0.0 };
        let [a, b] = [run(0, 8.0, 2.0), run(1, 32.0, 2.0)];
        let once = Gain::new(Channel::Force, true, vec![a.clone(), b.clone()]);
        let often = Gain::new(Channel::Force, true, vec![a, b.clone(), b.clone(), b]);
        // means of 20 and of 2 over two samples each
        assert!((once.base() - 10f64.sqrt()).abs() < 1e-12 && (once.model() - 1.0).abs() < 1e-12);
        assert_eq!((often.base(), often.model()), (once.base(), once.model()));
    }

    #[test]
    fn what_is_close_asks_for_nothing_and_what_is_no_gain_for_nothing_either() {
        let run =
            |command, before, after| Missed { file: String::new(), command, samples: 1, before, after, fitted: 0.0 };
        let close = Gain::new(Channel::Force, true, vec![run(0, 4.0, 1.0), run(0, 4.04, 1.0), run(1, 4.0, 1.01)]);
        assert_eq!((close.more_runs(), (close.part() - 0.5).abs() < 0.01), (Some(0), true), "{close:?}");
        let none = Gain::new(Channel::Force, true, vec![run(0, 4.0, 1.0), run(0, 1.0, 4.0)]);
        assert_eq!(none.more_runs(), None);
        assert!(none.part95.unwrap().0 < 0.0);
        // a command that was given once tells nothing of how runs differ
        let alone = Gain::new(Channel::Force, true, vec![run(0, 4.0, 1.0)]);
        assert_eq!((alone.part95, alone.more_runs(), alone.part()), (None, None, 0.5));
        let of_each = [(0, 4.0), (1, 9.0), (2, 16.0)].map(|(command, before)| run(command, before, 1.0));
        assert!(Gain::new(Channel::Force, true, of_each.to_vec()).part95.is_some());
        assert_eq!(Gain::new(Channel::Force, true, Vec::new()).part95, None);
    }
}
