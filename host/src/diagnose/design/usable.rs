//! The runs of one material that can be used, with their contacts, and whether the zero of the force drifts from one to the next.

use crate::experiment::motion::{self, Event, Motion};
use crate::experiment::{BaseLaw, Experiment, Test};
use crate::identify::contact;

/// Least samples of a loading branch.
pub(in super::super) const LEAST_SAMPLES: usize = 12;
/// Recorded zeros within this distance (mm) of the contact were meant to be the contact.
pub(in super::super) const MEANT_MM: f64 = 0.4;

/// Readings at the beginning of a run whose mean is the force it begins at, and the parts of the largest force that a reading of them lies within and two runs differ by where
/// the zero drifts. Of a fast run all but the first may lie well past the contact, so that the mean says nothing of whether one began at no force.
const FIRST: usize = 3;
const DRIFTED: (f64, f64) = (0.02, 0.05);

/// A run before windows are cut.
pub(super) struct Raw {
    pub run: usize,
    pub motion: Motion,
    pub contact_mm: f64,
}

/// True where some runs begin at no force and others far from it, as those of a session whose zero drifts do; all that were triggered by a force begin at that one.
fn zero_drifts(experiment: &Experiment) -> bool {
    let rigid = |at: usize| experiment.specimens[at].base_law == BaseLaw::Rigid;
    let pressed =
        experiment.runs.iter().filter(|run| run.test == Test::Indentation && !run.specimen.is_some_and(rigid));
    let forces = pressed.map(|run| run.recording.force_n.as_slice());
    let (mut nearest, mut low, mut high, mut peak) = (f64::INFINITY, f64::INFINITY, f64::NEG_INFINITY, 0.0_f64);
    for own in forces {
        let begin = begins_at_n(own);
        (low, high) = (low.min(begin), high.max(begin));
        nearest = own.iter().take(FIRST).fold(nearest, |least, reading| least.min(reading.abs()));
        peak = own.iter().copied().fold(peak, f64::max);
    }
    nearest < DRIFTED.0 * peak && high - low > DRIFTED.1 * peak
}

/// Mean of the first readings, N.
fn begins_at_n(force_n: &[f64]) -> f64 {
    let first = &force_n[..force_n.len().min(FIRST)];
    first.iter().sum::<f64>() / first.len().max(1) as f64
}

/// The runs of a material that can be used; of every other one a message says why not.
pub(super) fn raw_runs(experiment: &Experiment, material: &str, messages: &mut Vec<String>) -> Vec<Raw> {
    let mut raws = Vec::new();
    let drifts = zero_drifts(experiment);
    for (at, run) in experiment.runs.iter().enumerate() {
        let (Some(specimen), Some(indenter), Test::Indentation) = (run.specimen, run.indenter, run.test) else {
            continue;
        };
        let its = &experiment.specimens[specimen];
        if its.material != material || its.base_law == BaseLaw::Rigid {
            continue;
        }
        let Some(ball_mm) = experiment.indenters[indenter].radius_mm.known() else { continue };
        if its.height_mm.known().is_none() {
            messages.push(format!(
                "{}: the height of specimen \"{}\" is unknown; a diagnosis needs a declared one, which it may then find wrong",
                run.file, its.name
            ));
            continue;
        }
        let Some(motion) = motion::of(&run.recording) else {
            messages.push(format!("{}: the ball never went down", run.file));
            continue;
        };
        let loading = motion.loading.clone();
        let depth = &run.recording.depth_mm[loading.clone()];
        let force_n = &run.recording.force_n[loading.clone()];
        let zero_n = if drifts { begins_at_n(force_n) } else { 0.0 };
        let force_n: Vec<f64> = force_n.iter().map(|f| f - zero_n).collect();
        let guess = contact::guess(depth, &force_n, ball_mm);
        let Some(guess) = guess.filter(|_| depth.len() >= LEAST_SAMPLES) else {
            messages.push(format!("{}: no contact, or fewer than {LEAST_SAMPLES} samples on the way down", run.file));
            continue;
        };
        for event in &motion.events {
            messages.push(format!("{}: {event}", run.file));
        }
        raws.push(Raw { run: at, motion, contact_mm: guess.contact_mm });
    }
    raws
}

/// Contacts (mm), rising, of the runs whose way down no fall of the force ends early, if half of them are such: what is left of one before a knock may be a tenth of a millimetre and the noise.
pub(super) fn contacts(raws: &[Raw]) -> Vec<f64> {
    let whole = |raw: &&Raw| !raw.motion.events.iter().any(|event| matches!(event, Event::ForceDrop { .. }));
    let of = |raws: &mut dyn Iterator<Item = &Raw>| -> Vec<f64> {
        let mut each: Vec<f64> = raws.map(|raw| raw.contact_mm).collect();
        each.sort_by(f64::total_cmp);
        each
    };
    let own = of(&mut raws.iter().filter(whole));
    if 2 * own.len() >= raws.len() { own } else { of(&mut raws.iter()) }
}
