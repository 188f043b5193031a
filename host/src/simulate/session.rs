//! Who is pressed when: spots, their order and the session clock.

use rand::Rng;
use rand::seq::SliceRandom;
use rand_distr::StandardNormal;

use super::chance::{Purpose, stream};
use super::motion::Programme;
use super::spec::Spec;

/// One spot and the runs on it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Visit {
    /// Index of the template.
    pub template: usize,
    /// Number of the spot among its template's, from 0.
    pub replicate: usize,
    /// Number of the spot on its specimen, from 1.
    pub spot: i64,
    /// True less nominal depth of this spot, mm.
    pub jitter_mm: f64,
    /// Gain of this spot.
    pub gain: f64,
    /// Start of each run on the session clock, s.
    pub starts_s: Vec<f64>,
}

/// The visits in the order of the session; `durations_s` of a run of each template.
pub(super) fn visits(spec: &Spec, durations_s: &[f64]) -> Vec<Visit> {
    let mut visits = Vec::new();
    for (template, run) in spec.runs.iter().enumerate() {
        for replicate in 0..run.replicates {
            let number = visits.len() as u64;
            let mut chance = stream(spec.seed, Purpose::Spot, number);
            let (jitter, gain): (f64, f64) = (chance.sample(StandardNormal), chance.sample(StandardNormal));
            let same = |v: &&Visit| spec.runs[v.template].specimen == run.specimen;
            let spot = visits.iter().filter(same).count() as i64 + 1;
            visits.push(Visit {
                template,
                replicate,
                spot,
                jitter_mm: spec.noise.contact_jitter_mm * jitter,
                gain: 1.0 + spec.noise.gain_jitter * gain,
                starts_s: Vec::new(),
            });
        }
    }
    if spec.session.random_order {
        visits.shuffle(&mut stream(spec.seed, Purpose::Order, 0));
    }
    let mut clock_s = spec.session.start_s;
    for visit in &mut visits {
        let run = &spec.runs[visit.template];
        for cycle in 0..run.cycles {
            if cycle > 0 {
                clock_s += run.rest_s;
            }
            visit.starts_s.push(clock_s);
            clock_s += durations_s.get(visit.template).copied().unwrap_or(0.0);
        }
        clock_s += spec.session.gap_s;
    }
    visits
}

/// What the recorded depth does in the runs of a template; `peak_mm` its largest.
pub(super) fn programme(run: &super::spec::RunTemplate, peak_mm: f64) -> Programme {
    Programme {
        start_mm: -run.air_mm,
        depth_mm: peak_mm,
        rate_mm_s: run.rate_mm_s,
        hold_s: run.hold_s,
        unload: run.unload,
    }
}
