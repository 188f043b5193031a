//! Negative controls: an experiment changed so that a right diagnosis must, or must not, change with it.

use palpate::experiment::{Experiment, motion};
use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_pcg::Pcg64;

/// Fast runs become slow and slow ones fast: the time of every run is stretched so that its rate is another run's, the
/// slowest takes the fastest's and so on. Depths and forces stay: what depends on time is reversed.
#[must_use]
pub fn with_rates_reversed(experiment: &Experiment) -> Experiment {
    let mut changed = experiment.clone();
    let rate = |run: &palpate::experiment::Run| motion::of(&run.recording).map(|m| m.rate_mm_per_s);
    let mut rates: Vec<f64> = experiment.runs.iter().filter_map(rate).collect();
    rates.sort_by(f64::total_cmp);
    rates.dedup_by(|a, b| (*a / *b - 1.0).abs() < 0.05);
    for run in &mut changed.runs {
        let Some(own) = rate(run) else { continue };
        let near = |r: &f64| (r / own).ln().abs();
        let place = (0..rates.len()).min_by(|a, b| near(&rates[*a]).total_cmp(&near(&rates[*b])));
        let Some(place) = place else { continue };
        let stretch = rates[place] / rates[rates.len() - 1 - place];
        run.recording.time_s.iter_mut().for_each(|t| *t *= stretch);
    }
    changed
}

/// The runs in another order of the file; labels stay with their runs.
#[must_use]
pub fn with_runs_shuffled(experiment: &Experiment, seed: u64) -> Experiment {
    let mut changed = experiment.clone();
    changed.runs.shuffle(&mut Pcg64::seed_from_u64(seed));
    changed
}

/// The declared radii of the first two balls swapped.
#[must_use]
pub fn with_radii_swapped(experiment: &Experiment) -> Experiment {
    let mut changed = experiment.clone();
    if let [first, second, ..] = changed.indenters.as_mut_slice() {
        std::mem::swap(&mut first.radius_mm, &mut second.radius_mm);
    }
    changed
}

/// One run of every condition, no stated noise: nothing tells what noise is.
#[must_use]
pub fn without_replicates(experiment: &Experiment) -> Experiment {
    let mut changed = experiment.clone();
    changed.sensor.noise_n = None;
    let mut seen = Vec::new();
    changed.runs.retain(|run| {
        let rate = motion::of(&run.recording).map_or(0.0, |m| m.rate_mm_per_s);
        // rates of one condition agree within noise: a tenth of a decade apart is another
        let key = (run.specimen, run.indenter, (10.0 * rate.log10() + 100.0).round() as u64, run.cycle);
        let new = !seen.contains(&key);
        seen.push(key);
        new
    });
    changed
}

/// A run whose sensor reads its first value for ever.
#[must_use]
pub fn with_a_dead_sensor(experiment: &Experiment, run: usize) -> Experiment {
    let mut changed = experiment.clone();
    if let Some(run) = changed.runs.get_mut(run) {
        let first = run.recording.force_n.first().copied().unwrap_or(0.0);
        run.recording.force_n.iter_mut().for_each(|force| *force = first);
    }
    changed
}
