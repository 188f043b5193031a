//! Who is pressed when: spots, their order and the session clock.

use rand::Rng;
use rand::seq::SliceRandom;
use rand_distr::StandardNormal;

use super::chance::{Purpose, stream};
use super::effect::Effect;
use super::motion::Programme;
use super::spec::{RunTemplate, Spec};

/// Spots lie within this share of the specimen's radius.
const INSIDE: f64 = 0.5;

/// One spot and the runs on it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Visit {
    /// Index of the template.
    pub template: usize,
    /// Number of the spot among its template's, from 0.
    pub replicate: usize,
    /// Number of the spot on its specimen, from 1.
    pub spot: i64,
    /// Where that is, mm from the middle of the specimen: along its slope, if it has one, and across.
    pub place_mm: [f64; 2],
    /// True less nominal depth of this spot, mm.
    pub jitter_mm: f64,
    /// Gain of this spot.
    pub gain: f64,
    /// What relaxation, softening, friction and adhesion do at this spot, of what they do on the nominal one.
    pub memory: f64,
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
            let memory: f64 = chance.sample(StandardNormal);
            let same = |v: &&Visit| spec.runs[v.template].specimen == run.specimen;
            let spot = visits.iter().filter(same).count() as i64 + 1;
            visits.push(Visit {
                template,
                replicate,
                spot,
                place_mm: place_mm(spec, template, replicate),
                jitter_mm: spec.noise.contact_jitter_mm * jitter,
                gain: 1.0 + spec.noise.gain_jitter * gain,
                memory: (spec.noise.memory_jitter * memory).exp(),
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

/// Where on its line a spot lies, in parts of the farthest: left, right, half left, half right, ...
pub(super) fn share(replicate: usize) -> f64 {
    let side = if replicate.is_multiple_of(2) { -1.0 } else { 1.0 };
    side / (1 + replicate / 2) as f64
}

/// The spots of a template lie on a line along the slope, the lines of a specimen's templates beside each other.
fn place_mm(spec: &Spec, template: usize, replicate: usize) -> [f64; 2] {
    let on = |run: &RunTemplate| run.specimen == spec.runs[template].specimen;
    let radius_mm = spec.specimens.iter().find(|one| Some(&one.name) == spec.runs[template].specimen.as_ref());
    let inside_mm = radius_mm.map_or(0.0, |one| INSIDE * one.radius_mm);
    let slope_mm = spec.effects.iter().find_map(|effect| match effect {
        Effect::Tilt { distance_mm, .. } => Some(*distance_mm),
        _ => None,
    });
    let lines = spec.runs.iter().filter(|run| on(run)).count();
    let line = spec.runs[..template].iter().filter(|run| on(run)).count();
    let across = if lines > 1 { 2.0 * line as f64 / (lines - 1) as f64 - 1.0 } else { 0.0 };
    [slope_mm.unwrap_or(inside_mm) * share(replicate), inside_mm * across]
}

/// What the recorded depth does in the runs of a template; `peak_mm` its largest.
pub(super) fn programme(run: &RunTemplate, peak_mm: f64) -> Programme {
    Programme {
        start_mm: -run.air_mm,
        depth_mm: peak_mm,
        rate_mm_s: run.rate_mm_s,
        hold_s: run.hold_s,
        unload: run.unload,
    }
}
