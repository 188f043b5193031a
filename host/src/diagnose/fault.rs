//! Data that are not what their description says: told as what they are, before anything is fitted.

use std::fmt;

use crate::experiment::motion::{self, Event, Motion};
use crate::experiment::sensor::Trouble;
use crate::experiment::signal::range;
use crate::experiment::{Experiment, Run, Test};

/// A fault of the data.
#[derive(Debug, Clone, PartialEq)]
pub enum Fault {
    /// The sensor says the same, or nothing but noise, while the ball goes down and others feel a force.
    DeadSensor {
        /// The run's file.
        run: String,
    },
    /// The motion stood and went on.
    Restarted {
        /// The run's file.
        run: String,
        /// The event in words.
        event: String,
    },
    /// Readings that are none, or a sensor at its limit.
    Reading {
        /// The run's file.
        run: String,
        /// What was wrong, and what was done.
        trouble: Trouble,
    },
    /// The force fell within one sample.
    ForceDrop {
        /// The run's file.
        run: String,
        /// The event in words.
        event: String,
    },
}

impl Fault {
    /// Stable code in answers.
    #[must_use]
    pub fn code(&self) -> &'static str {
        match self {
            Fault::DeadSensor { .. } => "dead-sensor",
            Fault::Restarted { .. } => "restart",
            Fault::ForceDrop { .. } => "force-drop",
            Fault::Reading { trouble, .. } => trouble.code(),
        }
    }

    /// File of the run that it is in.
    #[must_use]
    pub fn run(&self) -> &str {
        match self {
            Fault::DeadSensor { run }
            | Fault::Restarted { run, .. }
            | Fault::ForceDrop { run, .. }
            | Fault::Reading { run, .. } => run,
        }
    }

    /// True when nothing can be said of the experiment.
    #[must_use]
    pub fn stops(&self) -> bool {
        matches!(self, Fault::DeadSensor { .. })
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Fault::DeadSensor { run } => {
                write!(
                    f,
                    "{run}: the force sensor shows nothing while the ball goes down: a dead sensor, or no contact"
                )
            }
            Fault::Reading { run, trouble } => write!(f, "{run}: {trouble}"),
            Fault::Restarted { run, event } | Fault::ForceDrop { run, event } => write!(f, "{run}: {event}"),
        }
    }
}

/// Runs in which the force drops at once that are no accident: so many, and this part of all.
const SLIPPING: (usize, f64) = (3, 1.0 / 3.0);

/// Number of runs of a material in which the force drops while the indenter goes on, where those are too many for accidents: something slips or breaks, which no effect of the
/// catalogue does, and what is left of the runs is not what it was.
#[must_use]
pub fn slipping(faults: &[Fault], runs: usize) -> Option<usize> {
    let dropping = |fault: &Fault| matches!(fault, Fault::ForceDrop { .. });
    let mut files: Vec<String> = faults.iter().filter(|f| dropping(f)).map(|f| f.run().to_owned()).collect();
    files.sort_unstable();
    files.dedup();
    (files.len() >= SLIPPING.0 && files.len() as f64 > SLIPPING.1 * runs as f64).then_some(files.len())
}

/// A force whose range is below this many times its noise shows nothing.
const DEAD_SIGMA: f64 = 6.0;
/// A force whose range is below this share of that of the other runs shows nothing either.
const DEAD_SHARE: f64 = 0.02;

/// Faults of the runs of one material.
#[must_use]
pub fn of(experiment: &Experiment, material: &str) -> Vec<Fault> {
    let own = |run: &&Run| {
        run.test == Test::Indentation && run.specimen.is_some_and(|at| experiment.specimens[at].material == material)
    };
    let moved: Vec<(&Run, Motion)> = experiment
        .runs
        .iter()
        .filter(own)
        .filter_map(|run| motion::of(&run.recording).map(|motion| (run, motion)))
        .collect();
    // from the first sample to the turning point: a spike that ends the loading branch early does not make a sensor dead
    let force = |(run, motion): &(&Run, Motion)| {
        let depth = &run.recording.depth_mm;
        let deepest = (0..depth.len()).max_by(|a, b| depth[*a].total_cmp(&depth[*b])).unwrap_or(0);
        run.recording.force_n[motion.loading.start.min(deepest)..=deepest].to_vec()
    };
    let mut ranges: Vec<f64> = moved.iter().map(|one| range(force(one))).collect();
    ranges.sort_by(f64::total_cmp);
    let usual = ranges.get(ranges.len() / 2).copied().unwrap_or(0.0);
    let reading = |run: &Run, trouble: &Trouble| Fault::Reading { run: run.file.clone(), trouble: trouble.clone() };
    let told = experiment.runs.iter().filter(own).flat_map(|run| run.troubles.iter().map(move |t| reading(run, t)));
    let mut faults: Vec<Fault> = told.collect();
    for one in &moved {
        let (run, motion) = one;
        let force = force(one);
        let rise_n = range(force.iter().copied());
        let alone = rise_n <= DEAD_SIGMA * motion::noise_of(&force) && usual <= rise_n / DEAD_SHARE;
        let flat = rise_n <= DEAD_SHARE * usual;
        // steep short curves bend from sample to sample as noise does: only a curve that does not end higher is dead
        let ends = force.len() / 4;
        let mean = |part: &[f64]| part.iter().sum::<f64>() / part.len().max(1) as f64;
        let rises = ends > 0 && mean(&force[force.len() - ends..]) - mean(&force[..ends]) > 0.3 * rise_n;
        if force.len() > 5 && (flat || alone && !rises) {
            faults.push(Fault::DeadSensor { run: run.file.clone() });
        }
        for event in &motion.events {
            let (run, told) = (run.file.clone(), event.to_string());
            faults.push(match event {
                Event::Restarted { .. } => Fault::Restarted { run, event: told },
                Event::ForceDrop { .. } => Fault::ForceDrop { run, event: told },
            });
        }
    }
    faults
}
