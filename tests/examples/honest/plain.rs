//! A plain elastic fit that shares nothing with those of the program but the force models: `mu`, `alpha` and a contact point for every spot by least squares on the forces
//! as they are, one group of conditions left out at a time.

use lut_gen::chain::{Chain, Model};
use palpate::diagnose::Models;
use palpate::diagnose::design::Design;
use palpate::diagnose::fit::predicted;
use palpate::experiment::Experiment;

/// Farthest that a contact point may lie from the recorded zero, mm.
const REACH_MM: f64 = 0.25;
/// Exponents that the force models cover.
const ALPHA: (f64, f64) = (1.8, 26.0);

/// What a plain fit leaves.
#[derive(Debug, Clone)]
pub struct Plain {
    /// Shear modulus, MPa, of all conditions.
    pub mu_mpa: f64,
    /// Exponent, of all conditions.
    pub alpha: f64,
    /// Root mean square on conditions left out, N, contact points at their best.
    pub left_out_n: f64,
}

struct Data<'a> {
    design: &'a Design,
    chain: &'a Chain,
}

impl Data<'_> {
    /// Measured less predicted where `counts` says so, N; else 0. `at` is ln mu, ln alpha and the contact of every spot.
    fn residual(&self, at: &[f64], counts: &dyn Fn(usize) -> bool) -> Vec<f64> {
        let contacts: Vec<f64> = self.design.series.iter().map(|s| at[2 + s.spot]).collect();
        let forces = predicted(self.design, self.chain, &Model::base(at[0].exp(), at[1].exp()), &contacts);
        let mut out = Vec::new();
        for (series, force) in self.design.series.iter().zip(&forces) {
            for (node, force_n) in series.nodes.iter().zip(force) {
                let used = !node.lifted && counts(series.group) && !series.hold_out;
                let weight = (node.samples.max(1) as f64).sqrt();
                out.push(if used { (node.force_n - force_n) * weight } else { 0.0 });
            }
        }
        out
    }

    /// Levenberg-Marquardt over the free entries of a point.
    fn fitted(&self, start: &[f64], free: &[usize], counts: &dyn Fn(usize) -> bool) -> (Vec<f64>, f64) {
        let mut x = start.to_vec();
        let mut here = self.residual(&x, counts);
        let mut square: f64 = here.iter().map(|r| r * r).sum();
        let mut damping = 1e-3;
        for _ in 0..200 {
            let columns: Vec<Vec<f64>> = free
                .iter()
                .map(|&j| {
                    let mut moved = x.clone();
                    moved[j] += 1e-4;
                    self.residual(&moved, counts).iter().zip(&here).map(|(there, here)| (here - there) / 1e-4).collect()
                })
                .collect();
            let n = free.len();
            let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
            let normal = nalgebra::DMatrix::from_fn(n, n, |i, j| {
                dot(&columns[i], &columns[j]) * if i == j { 1.0 + damping } else { 1.0 }
                    + if i == j { 1e-12 } else { 0.0 }
            });
            let right = nalgebra::DVector::from_fn(n, |i, _| dot(&columns[i], &here));
            let Some(step) = normal.cholesky().map(|c| c.solve(&right)) else { break };
            let mut next = x.clone();
            for (k, &j) in free.iter().enumerate() {
                let (low, high) = match j {
                    0 => (-14.0, 7.0),
                    1 => (ALPHA.0.ln(), ALPHA.1.ln()),
                    _ => (-REACH_MM, REACH_MM),
                };
                next[j] = (next[j] + step[k]).clamp(low, high);
            }
            let there = self.residual(&next, counts);
            let its: f64 = there.iter().map(|r| r * r).sum();
            if its < square {
                let gain = square - its;
                (x, here, square, damping) = (next, there, its, (damping * 0.2).max(1e-9));
                if gain < 1e-10 * square {
                    break;
                }
            } else {
                damping *= 8.0;
                if damping > 1e9 {
                    break;
                }
            }
        }
        (x, square)
    }

    /// The best over several exponents.
    fn best(&self, counts: &dyn Fn(usize) -> bool) -> Vec<f64> {
        let largest = self.design.largest_n();
        let free: Vec<usize> = (0..2 + self.design.spots).collect();
        let starts = [1.9_f64, 2.5, 4.0, 6.0, 8.0, 11.0, 14.0, 18.0, 22.0, 25.0];
        let ends = starts.into_iter().flat_map(|alpha| [0.015, 0.05, 0.15].map(|mu| (alpha, mu * largest))).map(
            |(alpha, mu)| {
                let mut start = vec![0.0; 2 + self.design.spots];
                (start[0], start[1]) = (mu.ln(), alpha.ln());
                self.fitted(&start, &free, counts)
            },
        );
        ends.min_by(|a, b| a.1.total_cmp(&b.1)).map(|e| e.0).unwrap_or_default()
    }
}

/// Of the only material of an experiment.
pub fn plain(experiment: &Experiment, material: &str, models: &Models) -> Option<Plain> {
    let design = Design::of(experiment, material).ok()?;
    let library = models.of(&design.geometries, &|_, _| {}).ok()?;
    let chain = Chain { library, passages: design.passages() };
    let data = Data { design: &design, chain: &chain };
    let all = data.best(&|_| true);
    let (mut square, mut count) = (0.0, 0.0);
    for group in 0..design.groups {
        let mut found = data.best(&|of| of != group);
        let own = |of: usize| of == group;
        let spots: Vec<usize> = design.series.iter().filter(|s| s.group == group).map(|s| 2 + s.spot).collect();
        for spot in &spots {
            found[*spot] = 0.0;
        }
        let mut spots = spots;
        spots.sort_unstable();
        spots.dedup();
        square += data.fitted(&found, &spots, &own).1;
        let meant = design.series.iter().filter(|s| s.group == group).flat_map(|s| &s.nodes).filter(|n| !n.lifted);
        count += meant.map(|n| n.samples.max(1) as f64).sum::<f64>();
    }
    Some(Plain { mu_mpa: all[0].exp(), alpha: all[1].exp(), left_out_n: (square / count.max(1.0)).sqrt() })
}
