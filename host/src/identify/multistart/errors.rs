//! Standard errors of what has the least sum of absolute differences.

use nalgebra::DMatrix;

use crate::identify::newton::problem::{Problem, Weight};
use crate::identify::newton::valley::Solved;
use crate::identify::noise::Noise;
use crate::identify::spec::Loss;
use crate::infer::covariance::{covariance, standard_errors};
use crate::infer::descent::Minimum;

/// Standard errors of all coordinates.
#[derive(Debug, Clone, PartialEq)]
pub struct StandardErrors {
    /// From noise; infinite where the data cannot tell the parameters apart.
    pub noise: Vec<f64>,
    /// From the error bound of the simulation.
    pub model: Vec<f64>,
    /// Inverse covariance from noise.
    pub information: DMatrix<f64>,
}

impl StandardErrors {
    /// At a minimum of Eq. 14, linearised, contact points free, with the noise of every curve.
    ///
    /// Samples count alike whatever their noise, so that the covariance is that of a sandwich `B^-1 M B^-1`: `B = sum 2 f(0) J'J`, `f(0) = 1 / (sigma sqrt(2 pi))`
    /// the density of normal noise at 0, and `M = sum c J'J`, `c` samples carrying the information of one (Koenker and Bassett 1978,
    /// doi:10.2307/1913643). With one noise it is `pi/2` times that of least squares.
    #[must_use]
    pub fn of(problem: &Problem<'_>, minimum: &Minimum, noises: &[Noise], model_error: f64) -> Self {
        let mut squares = Solved::of(problem).on(problem.selection);
        squares.loss = Loss::Squares;
        let mut hessian = |weight: &dyn Fn(&Noise) -> Weight| {
            squares.weights = noises.iter().map(weight).collect();
            squares.quadratic(&minimum.x).hessian
        };
        let bread = hessian(&|n| Weight { sigma_n: n.sigma_n.sqrt(), correlated: 1.0 });
        let bread = bread * (2.0 / std::f64::consts::PI).sqrt();
        let meat = hessian(&|n| Weight { sigma_n: 1.0, correlated: 1.0 / n.correlated_samples });
        let count = minimum.x.len();
        let information = covariance(&meat).map_or_else(|| bread.clone(), |inverse| &bread * inverse * &bread);
        let noise = match covariance(&bread) {
            Some(inverse) => {
                let both = &inverse * meat * &inverse;
                (0..count).map(|i| both[(i, i)].max(0.0).sqrt()).collect()
            }
            None => standard_errors(&information),
        };
        let at = squares.quadratic(&minimum.x);
        let model = squares.moved_by_model(&Minimum { at, ..minimum.clone() }, model_error);
        Self { noise, model, information }
    }
}
