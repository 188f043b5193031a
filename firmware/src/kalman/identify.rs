//! A whole press through a filter.

use super::Model;
use super::bounds::Estimator;

/// Takes every sample (what it was measured at, what was measured), `passes` times; returns how many samples the last pass used.
///
/// The first pass is the filter of the thesis, linearised at every estimate. Each later one begins with the first estimate and covariance again, so that
/// no sample counts twice, and is linearised where the pass before it ended: the first samples of a press are noise, and information
/// that was gathered where they had led points in a wrong direction. Thesis: one pass.
pub fn identify<M: Model<N>, const N: usize>(
    estimator: &mut Estimator<N>,
    model: &M,
    samples: impl Iterator<Item = (M::Input, f32)> + Clone,
    variance: f32,
    passes: u8,
) -> u16 {
    let first = estimator.filter;
    estimator.samples = 0;
    for (input, measured) in samples.clone() {
        estimator.step(model, input, measured, variance);
    }
    for _ in 1..passes {
        let reference = estimator.region.nearest(&estimator.filter.state);
        estimator.filter = first;
        estimator.samples = 0;
        for (input, measured) in samples.clone() {
            estimator.step_about(model, &reference, input, measured, variance);
        }
        estimator.filter.state = estimator.most_likely();
    }
    estimator.samples
}
