//! Data that are not what their description says: told as what they are, before anything is fitted.

use std::fmt;

use crate::experiment::motion::{self, Event};
use crate::experiment::{Experiment, Test};

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
                write!(f, "{run}: the force sensor shows nothing while the ball goes down: a dead sensor, or no contact")
            }
            Fault::Restarted { run, event } | Fault::ForceDrop { run, event } => write!(f, "{run}: {event}"),
        }
    }
}

/// A force whose range is below this many times its noise shows nothing.
const DEAD_SIGMA: f64 = 6.0;

/// Faults of the runs of one material.
#[must_use]
pub fn of(experiment: &Experiment, material: &str) -> Vec<Fault> {
    let mut faults = Vec::new();
    for run in &experiment.runs {
        let own = run.specimen.is_some_and(|at| experiment.specimens[at].material == material);
        if run.test != Test::Indentation || !own {
            continue;
        }
        let Some(motion) = motion::of(&run.recording) else { continue };
        let force = &run.recording.force_n[motion.loading.clone()];
        let (low, high) = force.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), f| (a.min(*f), b.max(*f)));
        if force.len() > 5 && high - low <= DEAD_SIGMA * motion::noise_of(force) {
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
