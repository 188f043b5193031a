//! Factors of the covariance of a run's windows, in as many steps as there are windows.
//!
//! Noise whose correlation falls exponentially knows of its past only what it was last: one number, carried from each window to the next, holds all that those before
//! it have in common with those after it (Foreman-Mackey et al. 2017, doi:10.3847/1538-3881/aa9332). A factor, and each column that it turns, cost a multiple of the number of windows, not its cube
//! and square.

use nalgebra::{DMatrix, Dim, Dyn, Matrix, VecStorage};

use super::design::Node;
use super::scatter::SensorNoise;

/// Cholesky's factor `L` of the covariance `L L'` of a run's windows, N.
#[derive(Debug, Clone)]
pub struct Factor {
    links: Vec<Link>,
}

/// A column, or several.
type Columns<C> = Matrix<f64, Dyn, C, VecStorage<f64, Dyn, C>>;

/// A window in the chain: `z = y - reads f`, `f' = fades f + leaves z`, where `f` is what is carried along and `size` the standard deviation of `z`.
#[derive(Debug, Clone, Copy)]
struct Link {
    reads: f64,
    fades: f64,
    leaves: f64,
    size: f64,
}

/// White parts that are added to a covariance until it is positive definite.
const WHITENED: [f64; 4] = [0.0, 1e-9, 1e-6, 1e-3];

impl SensorNoise {
    /// Variance of the mean of a window, N^2; `force_n` is what the model predicts there.
    #[must_use]
    pub fn variance(&self, node: &Node, force_n: f64) -> f64 {
        let (_, with_own) = sums(node, self.correlation_s);
        self.variance_at(self.level_n(force_n), node, with_own)
    }

    /// The same at the level of a sample (N), with the mean correlation of the window's samples with each other.
    fn variance_at(&self, level_n: f64, node: &Node, with_own: f64) -> f64 {
        level_n.powi(2) * ((1.0 - self.white) * with_own + self.white / node.samples as f64)
    }

    /// Standard deviation of a sample at a force, both in N.
    fn level_n(&self, force_n: f64) -> f64 {
        self.sigma_n.hypot(self.relative * force_n)
    }

    /// Factor of the covariance of the means of a run's windows, with as little of a white part added as makes it positive definite: rounding may leave one that is not. `force_n` is what the
    /// model predicts there. `None` where numbers are none.
    ///
    /// For samples whose correlation falls by `rho` from one to the next: the exact double sums. Windows that overlap count as one after the other. Where the contact has
    /// lifted nothing is compared, and nothing may be concluded from it about the windows beside: they are independent of it.
    #[must_use]
    pub fn factor(&self, nodes: &[Node], force_n: &[f64]) -> Option<Factor> {
        WHITENED.iter().find_map(|part| Factor::of(self, nodes, force_n, 1.0 + part))
    }
}

/// Mean correlation of a window's samples with its last, and with each other.
fn sums(node: &Node, correlation_s: f64) -> (f64, f64) {
    let n = node.samples as f64;
    let x = step_s(node) / correlation_s;
    if n * x < 1e-6 {
        return (1.0, 1.0);
    }
    let (lost, whole) = (-(-x).exp_m1(), -(-n * x).exp_m1());
    let rho = 1.0 - lost;
    (whole / (n * lost), (n * (1.0 - rho * rho) - 2.0 * rho * whole) / (n * n * lost * lost))
}

fn step_s(node: &Node) -> f64 {
    node.length_s / node.samples as f64
}

/// From the middle of a window to its last sample, s.
fn reach_s(node: &Node) -> f64 {
    0.5 * (node.length_s - step_s(node))
}

impl Factor {
    fn of(noise: &SensorNoise, nodes: &[Node], force_n: &[f64], white: f64) -> Option<Self> {
        let left = |gap_s: f64| (-gap_s.max(0.0) / noise.correlation_s).exp();
        let mut links = Vec::with_capacity(nodes.len());
        // variance of what is carried along, and the last sample of the window before, s
        let (mut carried, mut last_s) = (0.0, f64::NEG_INFINITY);
        for (node, force_n) in nodes.iter().zip(force_n) {
            let (with_last, with_own) = sums(node, noise.correlation_s);
            let level_n = noise.level_n(*force_n);
            let variance = noise.variance_at(level_n, node, with_own);
            let shared = if node.lifted { 0.0 } else { level_n * (1.0 - noise.white).sqrt() * with_last };
            let reads = shared * left(node.time_s - reach_s(node) - last_s);
            let fades = left(node.time_s + reach_s(node) - last_s);
            let own = variance * white - reads * reads * carried;
            if !(own > 0.0 && own.is_finite()) {
                return None;
            }
            let leaves = (shared - fades * reads * carried) / own;
            links.push(Link { reads, fades, leaves, size: own.sqrt() });
            carried = fades * fades * carried + own * leaves * leaves;
            last_s = last_s.max(node.time_s + reach_s(node));
        }
        Some(Self { links })
    }

    /// Makes of columns with this covariance such of independent numbers of unit variance: `L^-1 C`.
    #[must_use]
    pub fn whitened<C: Dim>(&self, mut columns: Columns<C>) -> Columns<C> {
        for mut column in columns.column_iter_mut() {
            let mut carried = 0.0;
            for (value, link) in column.iter_mut().zip(&self.links) {
                let new = *value - link.reads * carried;
                carried = link.fades * carried + link.leaves * new;
                *value = new / link.size;
            }
        }
        columns
    }

    /// `L` itself.
    #[must_use]
    pub fn lower(&self) -> DMatrix<f64> {
        let mut out = DMatrix::identity(self.links.len(), self.links.len());
        for (first, mut column) in out.column_iter_mut().enumerate() {
            let mut carried = 0.0;
            for (value, link) in column.iter_mut().zip(&self.links).skip(first) {
                let new = *value * link.size;
                *value = new + link.reads * carried;
                carried = link.fades * carried + link.leaves * new;
            }
        }
        out
    }

    /// Logarithm of the determinant of the covariance.
    #[must_use]
    pub fn log_determinant(&self) -> f64 {
        2.0 * self.links.iter().map(|link| link.size.ln()).sum::<f64>()
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::super::design::Branch;
    use super::*;

    /// Windows of different lengths, a pause between two of them, one that has lifted.
    fn nodes() -> Vec<Node> {
        let lengths_s = [0.1, 0.1, 0.04, 0.3, 0.1, 0.1];
        let mut end_s = 0.0;
        let of = |(k, length_s): (usize, f64)| {
            let first_s = end_s + if k == 3 { 0.2 } else { 0.0 };
            end_s = first_s + length_s;
            let samples = (length_s / 0.01_f64).round() as usize;
            let time_s = first_s + 0.5 * length_s;
            Node {
                time_s,
                depth_mm: 1.0,
                force_n: 1.0,
                length_s,
                samples,
                branch: Branch::Loading,
                held_s: 0.0,
                lifted: k == 4,
            }
        };
        lengths_s.into_iter().enumerate().map(of).collect()
    }

    const FORCE_N: [f64; 6] = [0.0, 0.1, 0.2, 0.5, 0.4, 0.3];

    fn noise(white: f64, correlation_s: f64) -> SensorNoise {
        SensorNoise { sigma_n: 0.02, white, correlation_s, relative: 0.05 }
    }

    /// Of the samples themselves: every pair of them.
    fn covariance(noise: &SensorNoise, nodes: &[Node]) -> DMatrix<f64> {
        let times =
            |n: &Node| -> Vec<f64> { (0..n.samples).map(|k| n.time_s - reach_s(n) + k as f64 * step_s(n)).collect() };
        let level = |i: usize| noise.sigma_n.hypot(noise.relative * FORCE_N[i]);
        DMatrix::from_fn(nodes.len(), nodes.len(), |i, j| {
            let (a, b) = (times(&nodes[i]), times(&nodes[j]));
            let pairs = a.iter().flat_map(|s| b.iter().map(move |t| (-(s - t).abs() / noise.correlation_s).exp()));
            let mean = pairs.sum::<f64>() / (a.len() * b.len()) as f64;
            let white = if i == j { noise.white / a.len() as f64 } else { 0.0 };
            let apart = i != j && (nodes[i].lifted || nodes[j].lifted);
            if apart { 0.0 } else { level(i) * level(j) * ((1.0 - noise.white) * mean + white) }
        })
    }

    /// With a short memory, a long one, and none.
    #[test]
    fn a_factor_is_that_of_the_covariance_of_every_two_samples() {
        let nodes = nodes();
        for noise in [noise(0.0, 0.005), noise(0.3, 0.08), noise(0.0, 2.5), noise(1.0, 0.1)] {
            let dense = covariance(&noise, &nodes).cholesky().unwrap();
            let factor = noise.factor(&nodes, &FORCE_N).unwrap();
            // the double sums lose as many digits as the square of a step in times of correlation has
            assert!((factor.lower() - dense.l()).amax() < 1e-8 * noise.sigma_n, "{noise:?}");
            let log = 2.0 * dense.l_dirty().diagonal().map(f64::ln).sum();
            assert!((factor.log_determinant() - log).abs() < 1e-6, "{noise:?}");
            let columns = DMatrix::from_fn(nodes.len(), 3, |i, j| ((i * 7 + j * 3) as f64).sin());
            let white = dense.l().solve_lower_triangular(&columns).unwrap();
            assert!((factor.whitened(columns) - &white).amax() < 1e-7 * white.amax(), "{noise:?}");
        }
    }

    /// Whatever windows are, what is told of them is positive definite; what is no number has no factor.
    #[test]
    fn windows_that_overlap_have_a_factor_and_numbers_that_are_none_have_not() {
        let mut nodes = nodes();
        nodes.iter_mut().for_each(|n| n.time_s *= 0.3);
        nodes.swap(1, 2);
        assert!(noise(0.0, 2.5).factor(&nodes, &FORCE_N).is_some());
        assert!(noise(0.0, 2.5).factor(&nodes, &[f64::NAN; 6]).is_none());
        assert!(SensorNoise { sigma_n: 0.0, relative: 0.0, ..noise(0.0, 0.1) }.factor(&nodes, &FORCE_N).is_none());
    }
}
