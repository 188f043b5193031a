//! The feasible region of the parameters, and what the filter does at its edge (thesis section 3.2.5).

use super::{Filter, Model};
use crate::number::limit;
use nalgebra::{SMatrix, SVector};

/// A box of parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Region<const N: usize> {
    /// Least values.
    pub low: SVector<f32, N>,
    /// Largest values.
    pub high: SVector<f32, N>,
}

impl<const N: usize> Region<N> {
    /// Widths: the standard deviations of Eq. 21.
    pub fn extent(&self) -> SVector<f32, N> {
        self.high.zip_map(&self.low, |high, low| high - low)
    }

    /// The middle.
    pub fn middle(&self) -> SVector<f32, N> {
        self.high.zip_map(&self.low, |high, low| 0.5 * (high + low))
    }

    /// The nearest point of the region, each parameter for itself; the lower edge for what is not a number.
    pub fn nearest(&self, state: &SVector<f32, N>) -> SVector<f32, N> {
        SVector::from_fn(|i, _| limit(state[i], self.low[i], self.high[i]))
    }

    /// True if every parameter lies in the region, edges included.
    pub fn contains(&self, state: &SVector<f32, N>) -> bool {
        (0..N).all(|i| state[i] >= self.low[i] && state[i] <= self.high[i])
    }
}

/// What happens to an estimate beyond the region.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Bounding {
    /// It is moved to the nearest point of the region (Fig. 20, Appendix D).
    Projection,
    /// A parameter that would leave goes `1 - coefficient` of the way from where it was to the edge (Eqs. 22-27 as
    /// ERRATA reads them: all four cases alike). 0 is projection, 1 never moves; the thesis' examples suit 0.5.
    Penalty {
        /// C_p, 0 to 1.
        coefficient: f32,
    },
    /// Eqs. 24-27 as printed, last condition mended: with the factor `1 + coefficient` for an upper edge and a negative gain or a lower
    /// edge and a positive one, which carries the estimate beyond the edge. There the model may have no value, and the filter stops moving.
    PrintedPenalty {
        /// C_p, 0 to 1.
        coefficient: f32,
    },
    /// It stays where it is; value and gradient are those of the nearest point of the region (Fig. 21).
    NearestNeighbour,
    /// The most likely point of the region under the updated covariance: a parameter held at the edge takes the others along by their
    /// correlation, which projection ignores. The model is linearised again at each trial point (iterated filter), a given number of times.
    Constrained {
        /// Linearisations a sample, at least 1.
        linearisations: u8,
    },
}

/// A filter in its region.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimator<const N: usize> {
    /// State and covariance.
    pub filter: Filter<N>,
    /// Where the parameters may lie.
    pub region: Region<N>,
    /// What happens at its edge.
    pub bounding: Bounding,
    /// Samples used.
    pub samples: u16,
}

impl<const N: usize> Estimator<N> {
    /// Starts from `initial` with the covariance of Eq. 21.
    pub fn new(initial: SVector<f32, N>, region: Region<N>, bounding: Bounding) -> Self {
        Estimator { filter: Filter::new(initial, &region.extent()), region, bounding, samples: 0 }
    }

    /// Takes one sample of noise variance `variance`; returns the innovation of Eq. 18. `None` if the model has no value there or the
    /// measurement is no number: then nothing has changed.
    pub fn step<M: Model<N>>(&mut self, model: &M, input: M::Input, measured: f32, variance: f32) -> Option<f32> {
        let before = self.filter.state;
        if let Bounding::Constrained { linearisations } = self.bounding {
            return self.constrained(model, input, measured, variance, linearisations.max(1));
        }
        let asked = match self.bounding {
            Bounding::NearestNeighbour => self.region.nearest(&before),
            _ => before,
        };
        let predicted = model.predict(&asked, input)?;
        let innovation = measured - predicted.value;
        if !innovation.is_finite() {
            return None;
        }
        let gain = self.filter.condense(&predicted.gradient, variance);
        for i in 0..N {
            let moved = before[i] + gain[i] * innovation;
            self.filter.state[i] = self.bounded(i, before[i], moved, gain[i]);
        }
        self.samples = self.samples.saturating_add(1);
        Some(innovation)
    }

    /// As [`Estimator::step`], but with the model linearised at `reference` instead of the estimate and without regard to the region: ask for
    /// [`Estimator::most_likely`] after the last sample. A press taken about one reference is one Gauss-Newton step from it: the covariance is then that of
    /// least squares, where the plain filter adds information from wherever its first, noisy samples had carried it.
    pub fn step_about<M: Model<N>>(
        &mut self,
        model: &M,
        reference: &SVector<f32, N>,
        input: M::Input,
        measured: f32,
        variance: f32,
    ) -> Option<f32> {
        let predicted = model.predict(reference, input)?;
        let mut innovation = measured - predicted.value;
        for i in 0..N {
            innovation -= predicted.gradient[i] * (self.filter.state[i] - reference[i]);
        }
        if !innovation.is_finite() {
            return None;
        }
        let gain = self.filter.condense(&predicted.gradient, variance);
        for i in 0..N {
            self.filter.state[i] += gain[i] * innovation;
        }
        self.samples = self.samples.saturating_add(1);
        Some(innovation)
    }

    /// The most likely point of the region under the estimate and its covariance.
    pub fn most_likely(&self) -> SVector<f32, N> {
        let mut state = self.filter.state;
        if !self.region.contains(&state) {
            most_likely(&self.region, &mut state, self.filter.covariance());
        }
        state
    }

    /// Parameter number `i`, which a gain would move from `before` to `moved`.
    fn bounded(&self, i: usize, before: f32, moved: f32, gain: f32) -> f32 {
        let (low, high) = (self.region.low[i], self.region.high[i]);
        let edge = if moved > high { high } else { low };
        let inside = moved >= low && moved <= high;
        match self.bounding {
            _ if inside => moved,
            Bounding::NearestNeighbour | Bounding::Constrained { .. } => moved,
            Bounding::Projection => edge,
            Bounding::Penalty { coefficient } => before + (1.0 - coefficient) * (edge - before),
            Bounding::PrintedPenalty { coefficient } => {
                // Eqs. 24 and 27 draw back, Eqs. 25 and 26 overshoot.
                let back = (moved > high) == (gain >= 0.0);
                let share = if back { 1.0 - coefficient } else { 1.0 + coefficient };
                before + share * (edge - before)
            }
        }
    }

    fn constrained<M: Model<N>>(
        &mut self,
        model: &M,
        input: M::Input,
        measured: f32,
        variance: f32,
        linearisations: u8,
    ) -> Option<f32> {
        let prior = self.filter;
        let mut at = self.region.nearest(&prior.state);
        let mut first = None;
        for _ in 0..linearisations {
            let predicted = model.predict(&at, input)?;
            // What the line through this point predicts at the prior's state.
            let mut innovation = measured - predicted.value;
            if !innovation.is_finite() {
                return None;
            }
            first = first.or(Some(innovation));
            for i in 0..N {
                innovation -= predicted.gradient[i] * (prior.state[i] - at[i]);
            }
            self.filter = prior;
            let gain = self.filter.condense(&predicted.gradient, variance);
            for i in 0..N {
                self.filter.state[i] = prior.state[i] + gain[i] * innovation;
            }
            at = self.most_likely();
            self.filter.state = at;
        }
        self.samples = self.samples.saturating_add(1);
        first
    }
}

/// Moves `state` to the most likely point of the region under covariance `p`: the parameter farthest out, in deviations, is
/// held at its edge and the others follow their regression on it; then the next one.
fn most_likely<const N: usize>(region: &Region<N>, state: &mut SVector<f32, N>, mut p: SMatrix<f32, N, N>) {
    let mut held = [false; N];
    for _ in 0..N {
        let mut farthest = (N, 0.0);
        for i in 0..N {
            let out = state[i] - limit(state[i], region.low[i], region.high[i]);
            let far = out * out / p[(i, i)];
            if !held[i] && far > farthest.1 {
                farthest = (i, far);
            }
        }
        let (i, _) = farthest;
        if i == N {
            break;
        }
        let shift = limit(state[i], region.low[i], region.high[i]) - state[i];
        for j in 0..N {
            if !held[j] && j != i {
                state[j] += p[(j, i)] / p[(i, i)] * shift;
            }
        }
        state[i] += shift;
        held[i] = true;
        let column: [f32; N] = core::array::from_fn(|j| p[(j, i)]);
        for j in 0..N {
            for k in 0..N {
                p[(j, k)] -= column[j] * column[k] / column[i];
            }
        }
    }
    *state = region.nearest(state);
}
