//! CMA-ES and Hooke-Jeeves. Own code: the one crate of CMA-ES brings a second nalgebra and a statistics library, and there is none
//! that is kept of Hooke and Jeeves.

use nalgebra::{DMatrix, DVector};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

use crate::infer::eigen;

use super::landscape::Counted;

/// First step of both, as a share of the box.
const FIRST_STEP: f64 = 0.2;
/// Steps below this share of the box end a search.
const LAST_STEP: f64 = 1e-7;

/// Evolution strategy with covariance matrix adaptation: (mu/mu_w, lambda) with the default constants of Hansen's tutorial
/// (arXiv:1604.00772, Table 1), without negative weights.
pub fn cma_es(problem: &Counted<'_>, start: &[f64], seed: u64, budget: usize) {
    let mut chance = Pcg64::seed_from_u64(seed);
    let mut state = Cma::new(start);
    while problem.evaluations() + state.lambda <= budget && state.sigma > LAST_STEP && state.sigma.is_finite() {
        if !state.generation(problem, &mut chance) {
            return;
        }
    }
}

struct Cma {
    lambda: usize,
    weights: Vec<f64>,
    mu_eff: f64,
    c_sigma: f64,
    d_sigma: f64,
    c_c: f64,
    c_1: f64,
    c_mu: f64,
    chi: f64,
    mean: DVector<f64>,
    sigma: f64,
    path_sigma: DVector<f64>,
    path_c: DVector<f64>,
    covariance: DMatrix<f64>,
    generations: i32,
}

impl Cma {
    fn new(start: &[f64]) -> Self {
        let count = start.len();
        let n = count as f64;
        let lambda = 4 + (3.0 * n.ln()).floor() as usize;
        let raw: Vec<f64> = (1..=lambda / 2).map(|i| ((lambda as f64 + 1.0) / 2.0).ln() - (i as f64).ln()).collect();
        let sum: f64 = raw.iter().sum();
        let weights: Vec<f64> = raw.iter().map(|w| w / sum).collect();
        let mu_eff = 1.0 / weights.iter().map(|w| w * w).sum::<f64>();
        let c_sigma = (mu_eff + 2.0) / (n + mu_eff + 5.0);
        let c_1 = 2.0 / ((n + 1.3).powi(2) + mu_eff);
        let c_mu = (1.0 - c_1).min(2.0 * (mu_eff - 2.0 + 1.0 / mu_eff) / ((n + 2.0).powi(2) + mu_eff));
        Self {
            lambda,
            weights,
            mu_eff,
            c_sigma,
            d_sigma: 1.0 + 2.0 * (((mu_eff - 1.0) / (n + 1.0)).sqrt() - 1.0).max(0.0) + c_sigma,
            c_c: (4.0 + mu_eff / n) / (n + 4.0 + 2.0 * mu_eff / n),
            c_1,
            c_mu,
            chi: n.sqrt() * (1.0 - 1.0 / (4.0 * n) + 1.0 / (21.0 * n * n)),
            mean: DVector::from_column_slice(start),
            sigma: FIRST_STEP,
            path_sigma: DVector::zeros(count),
            path_c: DVector::zeros(count),
            covariance: DMatrix::identity(count, count),
            generations: 0,
        }
    }

    /// One generation; false when the covariance has degenerated.
    fn generation(&mut self, problem: &Counted<'_>, chance: &mut Pcg64) -> bool {
        let n = self.mean.len();
        let Some(eigen) = eigen::symmetric(self.covariance.clone()) else { return false };
        if eigen.eigenvalues.iter().any(|value| value.is_nan() || *value <= 0.0) {
            return false;
        }
        let roots = eigen.eigenvalues.map(f64::sqrt);
        let mut offspring: Vec<(f64, DVector<f64>)> = (0..self.lambda)
            .map(|_| {
                let z = DVector::from_fn(n, |_, _| StandardNormal.sample(chance));
                let y = &eigen.eigenvectors * roots.component_mul(&z);
                let point = &self.mean + self.sigma * &y;
                (problem.mirrored(point.as_slice()), y)
            })
            .collect();
        offspring.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut step = DVector::zeros(n);
        for (weight, (_, y)) in self.weights.iter().zip(&offspring) {
            step += *weight * y;
        }
        self.mean += self.sigma * &step;
        self.generations += 1;
        let whitened = &eigen.eigenvectors * (eigen.eigenvectors.tr_mul(&step).component_div(&roots));
        self.path_sigma = (1.0 - self.c_sigma) * &self.path_sigma
            + (self.c_sigma * (2.0 - self.c_sigma) * self.mu_eff).sqrt() * whitened;
        let length = self.path_sigma.norm();
        let fading = (1.0 - (1.0 - self.c_sigma).powi(2 * self.generations)).sqrt();
        let short = length / fading < (1.4 + 2.0 / (n as f64 + 1.0)) * self.chi;
        self.path_c *= 1.0 - self.c_c;
        if short {
            self.path_c += (self.c_c * (2.0 - self.c_c) * self.mu_eff).sqrt() * &step;
        }
        let stalled = if short { 0.0 } else { self.c_c * (2.0 - self.c_c) };
        self.covariance *= 1.0 + self.c_1 * stalled - self.c_1 - self.c_mu;
        self.covariance += self.c_1 * &self.path_c * self.path_c.transpose();
        for (weight, (_, y)) in self.weights.iter().zip(&offspring) {
            self.covariance += self.c_mu * *weight * y * y.transpose();
        }
        self.sigma *= (self.c_sigma / self.d_sigma * (length / self.chi - 1.0)).exp();
        true
    }
}

/// Pattern search (Hooke and Jeeves 1961, doi:10.1145/321062.321069): a move along each coordinate in turn, then a leap in the
/// direction that the moves took together; steps are halved where nothing gains.
pub fn hooke_jeeves(problem: &Counted<'_>, start: &[f64], budget: usize) {
    let mut step = FIRST_STEP;
    let mut base = start.to_vec();
    let mut value = problem.value(&base);
    while step > LAST_STEP && problem.evaluations() < budget {
        let (mut next, mut there) = explored(problem, &base, value, step);
        if there >= value {
            step *= 0.5;
            continue;
        }
        while there < value && problem.evaluations() < budget {
            let leap: Vec<f64> = next.iter().zip(&base).map(|(n, b)| (2.0 * n - b).clamp(0.0, 1.0)).collect();
            (base, value) = (next, there);
            let landed = problem.value(&leap);
            (next, there) = explored(problem, &leap, landed, step);
        }
    }
}

fn explored(problem: &Counted<'_>, from: &[f64], value: f64, step: f64) -> (Vec<f64>, f64) {
    let (mut point, mut best) = (from.to_vec(), value);
    for axis in 0..point.len() {
        for by in [step, -step] {
            let old = point[axis];
            point[axis] = (old + by).clamp(0.0, 1.0);
            let there = if point[axis] == old { f64::INFINITY } else { problem.value(&point) };
            if there < best {
                best = there;
                break;
            }
            point[axis] = old;
        }
    }
    (point, best)
}
