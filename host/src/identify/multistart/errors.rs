//! Standard errors of what has the least sum of absolute differences.

use nalgebra::DMatrix;

use crate::identify::newton::problem::{Problem, Weight};
use crate::identify::newton::valley::Solved;
use crate::identify::noise::Noise;
use crate::identify::simplex::Bounds;
use crate::identify::spec::Loss;
use crate::infer::covariance::{covariance, standard_errors};
use crate::infer::descent::Minimum;

/// Standard errors of all coordinates.
#[derive(Debug, Clone, PartialEq)]
pub struct StandardErrors {
    /// From noise; no more than the spread over the box, where the data cannot tell the parameters apart.
    pub noise: Vec<f64>,
    /// From the error bound of the simulation.
    pub model: Vec<f64>,
    /// Inverse covariance from noise.
    pub information: DMatrix<f64>,
}

/// Information of a uniform distribution over a box of side 1, and the rounding of an information matrix.
const OF_A_BOX: f64 = 12.0;
const ROUNDING: f64 = 1e-13;

impl StandardErrors {
    /// At a minimum of Eq. 14, linearised, contact points free, with the noise of every curve.
    ///
    /// Samples count alike whatever their noise, so that the covariance is that of a sandwich `B^-1 M B^-1`: `B = sum 2 f(0) J'J`, `f(0) = 1 / (sigma sqrt(2 pi))`
    /// the density of normal noise at 0, and `M = sum c J'J`, `c` samples carrying the information of one (Koenker and Bassett 1978,
    /// doi:10.2307/1913643). With one noise it is `pi/2` times that of least squares.
    #[must_use]
    pub fn of(problem: &Problem<'_>, bounds: &Bounds, minimum: &Minimum, noises: &[Noise], model_error: f64) -> Self {
        let mut squares = Solved::of(problem).on(problem.selection);
        squares.loss = Loss::Squares;
        let mut hessian = |weight: &dyn Fn(&Noise) -> Weight| {
            squares.weights = noises.iter().map(weight).collect();
            squares.quadratic(&minimum.x).hessian
        };
        let bread = hessian(&|n| Weight { sigma_n: n.sigma_n.sqrt(), correlated: 1.0 });
        let bread = bread * (2.0 / std::f64::consts::PI).sqrt();
        let meat = hessian(&|n| Weight { sigma_n: 1.0, correlated: 1.0 / n.correlated_samples });
        // In units of the box, within which everything is known to lie: what the data say nothing of has its spread and takes nothing from the others.
        let count = minimum.x.len();
        let side = |i: usize| bounds.side(i).max(f64::MIN_POSITIVE);
        let in_boxes = |m: &DMatrix<f64>| DMatrix::from_fn(count, count, |i, j| m[(i, j)] * side(i) * side(j));
        let (bread, mut meat) = (in_boxes(&bread), in_boxes(&meat));
        let least = ROUNDING * meat.diagonal().max().max(f64::MIN_POSITIVE);
        (0..count).for_each(|i| meat[(i, i)] += least);
        let mut scaled = covariance(&meat).map_or_else(|| bread.clone(), |inverse| &bread * inverse * &bread);
        (0..count).for_each(|i| scaled[(i, i)] += OF_A_BOX);
        let noise = standard_errors(&scaled).into_iter().enumerate().map(|(i, error)| error * side(i)).collect();
        let information = DMatrix::from_fn(count, count, |i, j| scaled[(i, j)] / (side(i) * side(j)));
        let at = squares.quadratic(&minimum.x);
        let model = squares.moved_by_model(&Minimum { at, ..minimum.clone() }, model_error);
        Self { noise, model, information }
    }
}
