//! Single readings that are off by what no noise of the rest is: heavy tails, a knock, a bit that was lost. One of nine standard deviations decides by itself which of two
//! effects is likelier.

use nalgebra::DVector;

use super::design::Design;
use super::whiten::Whitening;

/// Standard deviations that hardly any node of ten thousand is off by, were its noise normal.
pub(super) const SPIKE: f64 = 4.5;
/// Part of the nodes that may be spikes of a noise with long tails: what moves more of them is no noise.
const SPIKES: f64 = 0.005;
/// Standard deviations by which the same node of its repeats, in the mean, may be off to the same side: what they share is no accident.
const SHARED: f64 = 1.5;

/// A node that is off by itself.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Spike {
    /// Its run among the series.
    pub series: usize,
    /// Its place there.
    pub node: usize,
    /// Standard deviations that it is off by.
    pub size: f64,
}

/// Spikes of whitened residuals; none where they are too many to be accidents, or where nothing repeats them.
pub(super) fn of(design: &Design, whitening: &Whitening, residual: &DVector<f64>) -> Vec<Spike> {
    let off = |series: usize, node: usize| residual[whitening.first(series) + node];
    let mut spikes = Vec::new();
    if are_many(residual) {
        return spikes;
    }
    for (series, own) in design.series.iter().enumerate() {
        let repeats = |other: &usize| {
            let other = (*other != series).then(|| &design.series[*other]);
            other.is_some_and(|o| o.condition == own.condition && o.nodes.len() == own.nodes.len())
        };
        let repeats: Vec<usize> = (0..design.series.len()).filter(repeats).collect();
        for node in (0..own.nodes.len()).filter(|node| off(series, *node).abs() > SPIKE) {
            let size = off(series, node);
            let theirs = repeats.iter().map(|other| off(*other, node)).sum::<f64>() / repeats.len().max(1) as f64;
            if !repeats.is_empty() && theirs * size.signum() < SHARED {
                spikes.push(Spike { series, node, size: size.abs() });
            }
        }
    }
    spikes
}

/// True where more is far off than accidents are.
pub(super) fn are_many(residual: &DVector<f64>) -> bool {
    let far = residual.iter().filter(|r| r.abs() > SPIKE).count();
    far as f64 > SPIKES * residual.len() as f64
}
