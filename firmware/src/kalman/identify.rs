//! A whole press through a filter.

use super::bounds::Estimator;
use super::{Filter, Model};

/// Takes every sample (what it was measured at, what was measured), `passes` times; returns how many samples the last pass used.
///
/// A later pass starts from the estimate of the one before with the covariance of Eq. 21 again, so that no sample counts twice: the first samples
/// were linearised at the initial estimate, far off, and their information points in a wrong direction. Thesis: one pass.
pub fn identify<M: Model<N>, const N: usize>(
    estimator: &mut Estimator<N>,
    model: &M,
    samples: impl Iterator<Item = (M::Input, f32)> + Clone,
    variance: f32,
    passes: u8,
) -> u16 {
    for pass in 0..passes {
        if pass > 0 {
            estimator.filter = Filter::new(estimator.filter.state, &estimator.region.extent());
        }
        estimator.samples = 0;
        for (input, measured) in samples.clone() {
            estimator.step(model, input, measured, variance);
        }
    }
    estimator.samples
}
