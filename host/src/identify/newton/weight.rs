//! How much each run counts: the noise of its condition.

use crate::identify::data::LoadingCurve;
use crate::identify::noise::{self, Noise, NoiseSource, Residual};

use super::problem::{Problem, Weight, compare};

/// Noise below this share of a run's largest force is not believed: sensors resolve no better.
const LEAST_SHARE: f64 = 1e-4;
/// And not below a micronewton, for data without noise from a model.
const LEAST_N: f64 = 1e-6;

impl Problem<'_> {
    /// First weights: each run's own scatter from sample to sample.
    pub fn weigh_by_samples(&mut self, stated_n: Option<f64>) {
        self.weights = self
            .selection
            .curves
            .iter()
            .map(|data| {
                let scatter = stated_n.unwrap_or_else(|| crate::experiment::motion::noise_of(&data.force_n));
                Weight { sigma_n: scatter.max(floor(&data.force_n)), correlated: 1.0 }
            })
            .collect();
    }

    /// Weights from the fit: each condition's noise from the differences between its replicates; without replicates as stated; else
    /// from what is left over, misfit included. Returns what was used for each curve.
    pub fn weigh_by_fit(&mut self, point: &[f64], groups: &[Vec<usize>], stated_n: Option<f64>) -> Vec<Noise> {
        let tracks = self.tracks(point);
        let residuals: Vec<Residual> = (0..self.selection.curves.len())
            .map(|at| {
                let data = &self.selection.curves[at];
                let track = &tracks[self.condition_of[at]];
                let contact = self.contact(at, track);
                let residual_n = compare(data, track, contact).residual_n;
                Residual { depth_mm: places(data, contact), residual_n }
            })
            .collect();
        let free = self.unknowns.len() as f64 / self.fitted().count().max(1) as f64 + 1.0;
        let noises: Vec<Noise> = (0..residuals.len())
            .map(|at| {
                let group = groups.iter().find(|group| group.contains(&self.selection.curves[at].run));
                let members: Vec<usize> = (0..residuals.len())
                    .filter(|other| {
                        let curve = &self.selection.curves[*other];
                        group.is_some_and(|group| group.contains(&curve.run)) && !curve.hold_out
                    })
                    .collect();
                let noise = if members.len() > 1 {
                    let own: Vec<Residual> = members.iter().map(|at| residuals[*at].clone()).collect();
                    noise::estimate(&own, &[(0..own.len()).collect()], stated_n)
                } else {
                    noise::estimate(&residuals[at..=at], &[], stated_n)
                };
                // The residual has lost what the parameters and the contact point took.
                let count = residuals[at].residual_n.len() as f64;
                let lost =
                    if noise.source == NoiseSource::Residual { (count / (count - free).max(1.0)).sqrt() } else { 1.0 };
                Noise { sigma_n: (lost * noise.sigma_n).max(floor(&self.selection.curves[at].force_n)), ..noise }
            })
            .collect();
        self.weights = noises.iter().map(|n| Weight { sigma_n: n.sigma_n, correlated: n.correlated_samples }).collect();
        noises
    }
}

/// Where each sample stands for the comparison of replicates: depth below contact, and past the peak the time since, one mm a second.
fn places(data: &LoadingCurve, contact_mm: f64) -> Vec<f64> {
    let peak_mm = data.depth_mm[..data.hold_from].iter().copied().fold(contact_mm, f64::max);
    let samples = data.depth_mm.iter().zip(&data.time_s).enumerate();
    samples.map(|(at, (d, t))| if at < data.hold_from { d - contact_mm } else { peak_mm - contact_mm + t }).collect()
}

fn floor(force_n: &[f64]) -> f64 {
    let peak = force_n.iter().copied().fold(0.0, f64::max);
    (LEAST_SHARE * peak).max(LEAST_N)
}
