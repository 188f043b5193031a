//! Parameters from one sample at a time: the Kalman filter of thesis section 3.2.3 on a continuous model with exact derivatives.
//!
//! [`Filter`] is Eqs. 18-20 for any number of states and a scalar measurement, [`Model`] what is measured at a state, [`bounds`] the
//! feasible region and what happens at its edge, [`indentation`] the model of a table's slice, [`identify`] a whole press,
//! [`bank`] filters side by side for a valley that bends.
//!
//! # Arithmetic
//! The covariance is kept as `U D U^T`, U unit upper triangular and D diagonal (Bierman 1977, Factorization Methods for Discrete Sequential
//! Estimation, section V.3). It is symmetric by form, and positive because each element of D is multiplied by a quotient of positive
//! numbers; Eq. 20 as printed subtracts nearly equal matrices and loses both in f32. Sums over states are written out: nalgebra's products of larger matrices
//! may call other code on a host than on the board, and both must give the same bits.

pub mod bank;
pub mod bounds;
pub mod identify;
pub mod indentation;
pub mod relaxing;

pub use bounds::{Bounding, Estimator, Region};

use crate::number::sqrt;
use nalgebra::{SMatrix, SVector};

/// What a model says at a state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Prediction<const N: usize> {
    /// The measured quantity: H_n(x) of Eq. 18.
    pub value: f32,
    /// Its derivative by every state: h_n of Eqs. 19-20.
    pub gradient: SVector<f32, N>,
}

/// A measurement as a function of the state.
pub trait Model<const N: usize> {
    /// What a measurement is taken at: a depth, or a time.
    type Input: Copy;

    /// Value and gradient at a state; `None` where the model has none.
    fn predict(&self, state: &SVector<f32, N>, input: Self::Input) -> Option<Prediction<N>>;
}

/// State and covariance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Filter<const N: usize> {
    /// Estimate.
    pub state: SVector<f32, N>,
    /// Unit upper triangular factor of the covariance.
    u: SMatrix<f32, N, N>,
    /// Diagonal factor, positive.
    d: SVector<f32, N>,
}

/// Least element of D that is kept: a covariance far below f32's resolution of any parameter, and still normal.
const LEAST_VARIANCE: f32 = 1e-30;

impl<const N: usize> Filter<N> {
    /// A filter that starts from `state` with independent standard deviations; those of Eq. 21 are [`Region::extent`]. A deviation that is
    /// not a positive number counts as the least there is.
    pub fn new(state: SVector<f32, N>, deviations: &SVector<f32, N>) -> Self {
        let variance = |x: f32| if x * x > LEAST_VARIANCE { x * x } else { LEAST_VARIANCE };
        Filter { state, u: SMatrix::identity(), d: deviations.map(variance) }
    }

    /// Covariance P, exactly symmetric.
    pub fn covariance(&self) -> SMatrix<f32, N, N> {
        let mut p = SMatrix::zeros();
        for i in 0..N {
            for j in i..N {
                let mut sum = 0.0;
                for k in j..N {
                    sum += self.u[(i, k)] * self.d[k] * self.u[(j, k)];
                }
                p[(i, j)] = sum;
                p[(j, i)] = sum;
            }
        }
        p
    }

    /// Standard error of every state.
    pub fn deviations(&self) -> SVector<f32, N> {
        let p = self.covariance();
        SVector::from_fn(|i, _| sqrt(p[(i, i)]))
    }

    /// Variance of the predicted measurement, without noise: `h P h^T`.
    pub fn spread(&self, gradient: &SVector<f32, N>) -> f32 {
        let mut sum = 0.0;
        for j in 0..N {
            let f = self.turned(gradient, j);
            sum += f * f * self.d[j];
        }
        sum
    }

    /// Element j of `U^T h`.
    fn turned(&self, gradient: &SVector<f32, N>, j: usize) -> f32 {
        let mut f = gradient[j];
        for i in 0..j {
            f += self.u[(i, j)] * gradient[i];
        }
        f
    }

    /// Eq. 20 for a measurement of noise variance `variance` (R_n, positive): replaces the covariance and returns the gain of Eq. 19.
    /// Nothing changes, and the gain is zero, if gradient or variance are no finite numbers.
    pub fn condense(&mut self, gradient: &SVector<f32, N>, variance: f32) -> SVector<f32, N> {
        let mut gain = SVector::zeros();
        let total = self.spread(gradient) + variance;
        if !(variance > 0.0 && total.is_finite()) {
            return gain;
        }
        let mut before = variance;
        // `U^T h` is needed of the old U, of which column j is read before it is replaced.
        for j in 0..N {
            let f = self.turned(gradient, j);
            let v = self.d[j] * f;
            let after = before + f * v;
            let share = f / before;
            for i in 0..j {
                let u = self.u[(i, j)];
                self.u[(i, j)] = u - share * gain[i];
                gain[i] += u * v;
            }
            gain[j] = v;
            let d = self.d[j] * (before / after);
            self.d[j] = if d > LEAST_VARIANCE { d } else { LEAST_VARIANCE };
            before = after;
        }
        let scale = 1.0 / before;
        gain.map(|g| g * scale)
    }
}

#[cfg(test)]
mod tests;
