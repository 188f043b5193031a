//! What recordings show beyond the first loading, and the fit does not use: later loadings, and falls of the force in holds.

use std::ops::Range;

use crate::experiment::motion::{Motion, noise_of};
use crate::experiment::{Experiment, Recording, Run};

use super::data::{LoadingCurve, Selection};

/// A fall of this share of the force counts, and of this many times the noise.
const LEAST_SHARE: f64 = 0.02;
const LEAST_SIGMA: f64 = 5.0;
/// Part of a hold at its end whose mean is where the force falls to.
const END: usize = 10;

/// A fall of the force in a hold.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Fall {
    /// Share of the force at the beginning of the hold.
    share: f64,
    /// Length of the hold, s.
    lasts_s: f64,
}

/// The fall of the force in a hold, where noise is not all of it.
fn fall_in(recording: &Recording, hold: Range<usize>) -> Option<Fall> {
    let (force, time) = (recording.force_n.get(hold.clone())?, recording.time_s.get(hold)?);
    if force.len() < 2 * END {
        return None;
    }
    let end = &force[force.len() - force.len() / END..];
    // The largest of the first readings: the ball may still arrive.
    let begin = force[..force.len() / END].iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let fall = begin - end.iter().sum::<f64>() / end.len() as f64;
    let share = fall / begin;
    let visible = begin > 0.0 && share > LEAST_SHARE && fall > LEAST_SIGMA * noise_of(force);
    visible.then(|| Fall { share, lasts_s: time[time.len() - 1] - time[0] })
}

impl Selection {
    /// What happened in a run, and what of it is not used.
    pub(super) fn tell(&mut self, run: &Run, motion: &Motion) {
        let told = motion.events.iter().map(|event| format!("{}: {event}", run.file));
        self.messages.extend(told.chain(later_loadings(run, motion)));
    }

    /// Holds that are not fitted although the force falls in them: what relaxes there has relaxed on the way down as well.
    pub(super) fn tell_holds(&mut self, experiment: &Experiment, motions: &[Option<Motion>]) {
        if self.holds {
            return;
        }
        let of = |curve: &LoadingCurve| {
            let run = &experiment.runs[curve.run];
            let hold = motions.get(curve.run)?.as_ref()?.hold.clone()?;
            Some((&run.file, fall_in(&run.recording, hold)?))
        };
        let falls: Vec<_> = self.curves.iter().filter_map(of).collect();
        let Some((file, most)) = falls.iter().max_by(|a, b| a.1.share.total_cmp(&b.1.share)) else { return };
        self.messages.push(format!(
            "the force falls by {:.0} % in the hold of {:.1} s of {file} ({} run(s) show a fall): the material relaxes, or the machine \
             gives way. Without --relax, mu and alpha are those of this speed and are no material constants: use --relax 1, or \
             `palpate diagnose` for the cause",
            100.0 * most.share,
            most.lasts_s,
            falls.len(),
        ));
    }
}

/// Loadings after the first, which alone is fitted.
fn later_loadings(run: &Run, motion: &Motion) -> Option<String> {
    let depth = |range: &std::ops::Range<usize>| run.recording.depth_mm[range.end - 1];
    let deepest = motion.loadings.iter().max_by(|a, b| depth(a).total_cmp(&depth(b)))?;
    let (first_mm, deepest_mm) = (depth(&motion.loading), depth(deepest));
    if motion.loadings.len() < 2 {
        return None;
    }
    let used = format!(
        "{}: {} loadings are recorded and the first is used, to {first_mm:.2} mm",
        run.file,
        motion.loadings.len()
    );
    let travel_mm = first_mm - run.recording.depth_mm[motion.loading.start];
    if deepest_mm - first_mm < DEEPER * travel_mm {
        return Some(format!("{used}; from_s and to_s in its [[run]] choose another"));
    }
    Some(format!(
        "{used}; a later one goes to {deepest_mm:.2} mm and is not used: write from_s = {:.1} in its [[run]] to choose it",
        run.recording.time_s[deepest.start]
    ))
}

/// A later loading is deeper when it goes this share of the first one's travel beyond it.
const DEEPER: f64 = 0.05;
