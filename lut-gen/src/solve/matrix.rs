//! The tangent of the system: stiffness, and how force and residual depend on the depth.

use super::SolveError;
use super::krylov::gmres;
use super::sparse::{Factor, HELD, Pattern, Stored};

/// Stiffness `K = d residual / d u` with its factor.
///
/// Symmetric problems store the lower triangle. Where friction or unequal relaxation of shear
/// and bulk makes `K` unsymmetric, all of it is stored; its symmetric part is factorised and
/// preconditions the iteration that solves with the whole.
pub struct Matrix {
    lower: Pattern,
    lower_values: Vec<f64>,
    whole: Option<Whole>,
    factor: Factor,
    /// Diagonal shift of the last factorisation, relative; 0 when it was positive definite.
    shift: f64,
    solid_scatter: Vec<Vec<u32>>,
    edge_scatter: Vec<Vec<u32>>,
    /// `d residual / d depth` at fixed displacement (N/mm).
    pub drive: Vec<f64>,
    /// `d force / d u` at fixed depth (N/mm).
    pub pull: Vec<f64>,
    /// `d force / d depth` at fixed displacement (N/mm).
    pub direct: f64,
}

/// Every entry of an unsymmetric matrix.
struct Whole {
    pattern: Pattern,
    values: Vec<f64>,
    /// Where each entry goes in the lower triangle of the symmetric part.
    lower_of: Vec<u32>,
}

/// Largest part of the right-hand side left by the iteration.
const KRYLOV_TOLERANCE: f64 = 1e-11;
/// Iterations after which the iteration is given up.
const KRYLOV_STEPS: usize = 120;

impl Matrix {
    /// An empty tangent of `n` equations coupled by the dofs of `solids` and `edges`.
    ///
    /// # Errors
    /// [`SolveError::Memory`].
    pub fn new(n: usize, solids: &[Vec<usize>], edges: &[Vec<usize>], symmetric: bool) -> Result<Self, SolveError> {
        let groups = solids.iter().chain(edges).map(Vec::as_slice);
        let (lower, mut scatter) = Pattern::new(n, groups.clone(), Stored::Lower);
        let whole = (!symmetric).then(|| {
            let (pattern, all) = Pattern::new(n, groups, Stored::All);
            scatter = all;
            let lower_of = positions(&pattern, &lower);
            Whole { values: vec![0.0; pattern.entries()], pattern, lower_of }
        });
        let edge_scatter = scatter.split_off(solids.len());
        let factor = Factor::new(&lower).ok_or(SolveError::Memory { unknowns: n })?;
        Ok(Self {
            lower_values: vec![0.0; lower.entries()],
            lower,
            whole,
            factor,
            shift: 0.0,
            solid_scatter: scatter,
            edge_scatter,
            drive: vec![0.0; n],
            pull: vec![0.0; n],
            direct: 0.0,
        })
    }

    /// True when only the lower triangle is stored.
    #[must_use]
    pub fn is_symmetric(&self) -> bool {
        self.whole.is_none()
    }

    /// True when the last factorisation needed no diagonal shift: the state is a stable equilibrium.
    #[must_use]
    pub fn is_definite(&self) -> bool {
        self.shift == 0.0
    }

    /// Sets everything to 0.
    pub fn clear(&mut self) {
        self.values().fill(0.0);
        self.drive.fill(0.0);
        self.pull.fill(0.0);
        self.direct = 0.0;
    }

    fn values(&mut self) -> &mut [f64] {
        match &mut self.whole {
            Some(w) => &mut w.values,
            None => &mut self.lower_values,
        }
    }

    /// Adds the stiffness of a solid (its lower triangle suffices in a symmetric matrix).
    pub fn add_solid<const N: usize>(&mut self, index: usize, k: &[[f64; N]; N]) {
        let scatter = std::mem::take(&mut self.solid_scatter[index]);
        self.add(&scatter, k);
        self.solid_scatter[index] = scatter;
    }

    /// Adds the stiffness of an edge, and its part in `drive`, `pull` and `direct`: a deeper ball
    /// is the surface moved up, and the force on the ball is the sum of the axial nodal forces.
    pub fn add_edge(&mut self, index: usize, dofs: &[usize; 6], k: &[[f64; 6]; 6]) {
        let scatter = std::mem::take(&mut self.edge_scatter[index]);
        self.add(&scatter, k);
        self.edge_scatter[index] = scatter;
        for (i, &d) in dofs.iter().enumerate() {
            let (row, column) = (k[i][1] + k[i][3] + k[i][5], k[1][i] + k[3][i] + k[5][i]);
            if d != HELD {
                self.drive[d] += row;
                self.pull[d] += column;
            }
            if i % 2 == 1 {
                self.direct += row;
            }
        }
    }

    fn add<const N: usize>(&mut self, scatter: &[u32], k: &[[f64; N]; N]) {
        let symmetric = self.whole.is_none();
        let values = self.values();
        let mut at = scatter.iter();
        for (i, row) in k.iter().enumerate() {
            let columns = if symmetric { i + 1 } else { N };
            for (v, &place) in row[..columns].iter().zip(at.by_ref()) {
                if place != u32::MAX {
                    values[place as usize] += v;
                }
            }
        }
    }

    /// Norm of the diagonal (N/mm).
    #[must_use]
    pub fn diagonal_norm(&self) -> f64 {
        self.lower.diagonal().iter().map(|&d| self.lower_values[d].powi(2)).sum::<f64>().sqrt()
    }

    /// Factorises the (symmetric part of the) stiffness; while it is not positive definite,
    /// with a growing multiple of its diagonal added. False when that does not help either.
    pub fn factorise(&mut self) -> bool {
        if let Some(w) = &self.whole {
            self.lower_values.fill(0.0);
            for (v, &place) in w.values.iter().zip(&w.lower_of) {
                self.lower_values[place as usize] += 0.5 * v;
            }
            // a diagonal entry is met once, the others twice
            for &d in self.lower.diagonal() {
                self.lower_values[d] *= 2.0;
            }
        }
        self.shift = 0.0;
        for _ in 0..8 {
            if self.factor.factorise(&self.lower, &self.lower_values) {
                return true;
            }
            let next = if self.shift == 0.0 { 1e-3 } else { 4.0 * self.shift };
            let grow = (1.0 + next) / (1.0 + self.shift);
            for &d in self.lower.diagonal() {
                let v = &mut self.lower_values[d];
                *v = if *v > 0.0 { *v * grow } else { v.abs().max(1e-12) };
            }
            self.shift = next;
        }
        false
    }

    /// A direction that reduces the residual: solves with the whole matrix where it is
    /// unsymmetric and definite, else with the (shifted) factor.
    pub fn correct(&mut self, x: &mut [f64]) {
        if self.shift > 0.0 || !self.iterate(x) {
            self.factor.solve(x);
        }
    }

    /// Solves with the last factor, whatever the matrix has become since.
    pub fn chord(&mut self, x: &mut [f64]) {
        self.factor.solve(x);
    }

    /// Solves `K x = b` in place with the matrix itself, shift or not. False when the iteration fails.
    pub fn solve(&mut self, x: &mut [f64]) -> bool {
        if self.whole.is_none() && self.shift == 0.0 {
            self.factor.solve(x);
            return true;
        }
        self.iterate(x)
    }

    /// Column `j` of the matrix as assembled, for checks.
    pub fn column(&self, j: usize, out: &mut [f64]) {
        out.fill(0.0);
        let (pattern, values) = match &self.whole {
            Some(w) => (&w.pattern, &w.values),
            None => (&self.lower, &self.lower_values),
        };
        for k in pattern.starts()[j]..pattern.starts()[j + 1] {
            out[pattern.rows()[k]] = values[k];
        }
    }

    fn iterate(&mut self, x: &mut [f64]) -> bool {
        let Some(w) = &self.whole else {
            return false;
        };
        let factor = &mut self.factor;
        gmres(|v, out| multiply(&w.pattern, &w.values, v, out), |v| factor.solve(v), x, KRYLOV_TOLERANCE, KRYLOV_STEPS)
    }
}

fn multiply(pattern: &Pattern, values: &[f64], v: &[f64], out: &mut [f64]) {
    out.fill(0.0);
    for (j, w) in pattern.starts().windows(2).enumerate() {
        for k in w[0]..w[1] {
            out[pattern.rows()[k]] += values[k] * v[j];
        }
    }
}

/// For each entry of `all`, its place in the lower triangle.
fn positions(all: &Pattern, lower: &Pattern) -> Vec<u32> {
    let mut out = Vec::with_capacity(all.entries());
    for (j, w) in all.starts().windows(2).enumerate() {
        for &i in &all.rows()[w[0]..w[1]] {
            let (row, column) = (i.max(j), i.min(j));
            let (a, b) = (lower.starts()[column], lower.starts()[column + 1]);
            let at = lower.rows()[a..b].partition_point(|&r| r < row);
            out.push((a + at) as u32);
        }
    }
    out
}
