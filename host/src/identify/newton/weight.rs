//! How much each run counts: the noise of its condition.

use crate::identify::data::LoadingCurve;
use crate::identify::noise::{self, Noise, NoiseSource, Residual};

use super::problem::{Problem, Weight, compare};

/// Noise below this share of a run's largest force is not believed: sensors resolve no better.
const LEAST_SHARE: f64 = 1e-4;
/// And not below a micronewton, for data without noise from a model.
const LEAST_N: f64 = 1e-6;

/// What a law may miss of a run's largest force before anything is known of it: the first weights compare runs of unlike size fairly.
const FIRST_MISFIT: f64 = 0.01;

/// What is left of a curve, beside the noise of its condition.
struct Left {
    noise: Noise,
    /// Largest force, N.
    peak_n: f64,
    /// Samples.
    count: f64,
    /// Rms of what the fit left over, N, for what the parameters took.
    rms_n: f64,
    /// Neighbouring samples of that which say the same.
    correlated: f64,
}

/// What a law misses, the same share of every run's largest force: its variance, and the share of a run over which it is correlated.
///
/// A law that does not fit misses all runs, and each by its size. Were it each by its own residual, the run that happens to be
/// fitted worst would count the least, and the end would depend on where the search began.
struct Misfit {
    variance: f64,
    correlated_share: f64,
}

impl Misfit {
    /// What the residuals of the fitted curves show beyond noise.
    fn of(all: &[&Left]) -> Self {
        let excess = |left: &&Left| (left.rms_n.powi(2) - left.noise.sigma_n.powi(2)) / left.peak_n.powi(2);
        let total: f64 = all.iter().map(excess).sum();
        let long = |left: &&Left| {
            let at_zero = left.correlated * left.rms_n.powi(2);
            let own = left.noise.correlated_samples * left.noise.sigma_n.powi(2);
            (at_zero - own).max(0.0) / (left.peak_n.powi(2) * left.count)
        };
        let variance = (total / all.len().max(1) as f64).max(0.0);
        let correlated_share = if total > 0.0 { all.iter().map(long).sum::<f64>() / total } else { 0.0 };
        Self { variance, correlated_share }
    }

    /// Weight of a curve: noise and misfit together.
    fn weight(&self, left: &Left) -> Weight {
        let (noise, misfit) = (left.noise.sigma_n.powi(2), self.variance * left.peak_n.powi(2));
        let long = (self.correlated_share * left.count).clamp(1.0, left.count.max(1.0));
        let correlated = (noise * left.noise.correlated_samples + misfit * long) / (noise + misfit);
        Weight { sigma_n: (noise + misfit).sqrt(), correlated }
    }
}

impl Problem<'_> {
    /// First weights: each run's own scatter from sample to sample, and a share of its largest force.
    pub fn weigh_by_samples(&mut self, stated_n: Option<f64>) {
        self.weights = self
            .selection
            .curves
            .iter()
            .map(|data| {
                let scatter = stated_n.unwrap_or_else(|| crate::experiment::motion::noise_of(&data.force_n));
                let sigma_n = scatter.max(floor(&data.force_n)).hypot(FIRST_MISFIT * peak(&data.force_n));
                Weight { sigma_n, correlated: 1.0 }
            })
            .collect();
    }

    /// Weights from the fit: each condition's noise from the differences between its replicates; without replicates as stated; else
    /// from sample to sample; and what the law misses, from what is left over. Returns the noise of each curve, misfit included where nothing
    /// else tells it.
    pub fn weigh_by_fit(&mut self, point: &[f64], groups: &[Vec<usize>], stated_n: Option<f64>) -> Vec<Noise> {
        let tracks = self.tracks(point);
        let residuals: Vec<Residual> = (0..self.selection.curves.len())
            .map(|at| {
                let data = &self.selection.curves[at];
                let track = &tracks[self.condition_of[at]];
                let contact = self.contact(at, track);
                let mut residual_n = compare(data, track, contact).residual_n;
                data.unsure.take_out(&mut residual_n, self.variance_n2(at));
                Residual { depth_mm: places(data, contact), residual_n }
            })
            .collect();
        let all: Vec<Left> = (0..residuals.len()).map(|at| self.left(at, &residuals, groups, stated_n)).collect();
        let seen: Vec<&Left> = self.fitted().map(|at| &all[at]).collect();
        let misfit = Misfit::of(&seen);
        self.weights = all.iter().map(|left| misfit.weight(left)).collect();
        let told = all.iter().zip(&self.weights).map(|(left, weight)| match left.noise.source {
            NoiseSource::Residual => {
                Noise { sigma_n: weight.sigma_n, correlated_samples: weight.correlated, source: NoiseSource::Residual }
            }
            NoiseSource::Replicates | NoiseSource::Stated => left.noise,
        });
        told.collect()
    }

    /// What is left of one curve.
    fn left(&self, at: usize, residuals: &[Residual], groups: &[Vec<usize>], stated_n: Option<f64>) -> Left {
        let data = &self.selection.curves[at];
        let group = groups.iter().find(|group| group.contains(&data.run));
        let members: Vec<usize> = (0..residuals.len())
            .filter(|other| {
                let curve = &self.selection.curves[*other];
                group.is_some_and(|group| group.contains(&curve.run)) && !curve.hold_out
            })
            .collect();
        let own = noise::estimate(&residuals[at..=at], &[], None);
        let noise = if members.len() > 1 {
            let own: Vec<Residual> = members.iter().map(|at| residuals[*at].clone()).collect();
            noise::estimate(&own, &[(0..own.len()).collect()], stated_n)
        } else if stated_n.is_some() {
            noise::estimate(&residuals[at..=at], &[], stated_n)
        } else {
            let scatter = crate::experiment::motion::noise_of(&data.force_n);
            Noise { source: NoiseSource::Residual, sigma_n: scatter, correlated_samples: 1.0 }
        };
        let count = residuals[at].residual_n.len() as f64;
        // The residual has lost what the parameters and the contact point took.
        let free = self.unknowns.len() as f64 / self.fitted().count().max(1) as f64 + 1.0;
        let rms_n = (count / (count - free).max(1.0)).sqrt() * own.sigma_n;
        // No more than the residual scatters: rough steps of a reading are no noise of the force.
        let sigma_n = if noise.source == NoiseSource::Residual { noise.sigma_n.min(rms_n) } else { noise.sigma_n };
        let noise = Noise { sigma_n: sigma_n.max(floor(&data.force_n)), ..noise };
        Left { noise, peak_n: peak(&data.force_n).max(LEAST_N), count, rms_n, correlated: own.correlated_samples }
    }
}

/// Where each sample stands for the comparison of replicates: depth below contact, and past the peak the time since, one mm a second.
fn places(data: &LoadingCurve, contact_mm: f64) -> Vec<f64> {
    let peak_mm = data.depth_mm[..data.hold_from].iter().copied().fold(contact_mm, f64::max);
    let samples = data.depth_mm.iter().zip(&data.time_s).enumerate();
    samples.map(|(at, (d, t))| if at < data.hold_from { d - contact_mm } else { peak_mm - contact_mm + t }).collect()
}

/// Least noise of a reading, N: what its resolution makes of it, evenly within a step, is no less than a twelfth of the step's square.
fn floor(force_n: &[f64]) -> f64 {
    (LEAST_SHARE * peak(force_n)).max(LEAST_N).max(crate::experiment::motion::step_of(force_n) / 12.0_f64.sqrt())
}

fn peak(force_n: &[f64]) -> f64 {
    force_n.iter().copied().fold(0.0, f64::max)
}
