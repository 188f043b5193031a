//! The tangent of the system: stiffness, and how force and residual depend on the depth.

use super::SolveError;
use crate::fem::krylov::gmres;
use crate::fem::ordered::Ordered;
use crate::fem::sparse::{HELD, Pattern, Scatter, Stored, UnsymmetricFactor, add_all, add_lower};
use crate::solid::contact::EdgeStiffness;

/// Stiffness `K = d residual / d u` with its factor.
///
/// Symmetric problems store the lower triangle. Where friction or unequal relaxation of shear
/// and bulk makes `K` unsymmetric, all of it is stored as well as a symmetric neighbour (the symmetric
/// part of the solids and [`EdgeStiffness::symmetric`]), which is factorised and preconditions the
/// iteration that solves with the whole. Under a platen, where all of the surface slides, the neighbour is too far
/// away (and seldom definite): there the whole is factorised.
pub struct Matrix {
    /// The lower triangle, its equations in the order of their elimination.
    lower: Pattern,
    lower_values: Vec<f64>,
    whole: Option<Whole>,
    factor: Ordered,
    direct_factor: Option<UnsymmetricFactor>,
    /// Diagonal shift of the last factorisation, relative; 0 when it was positive definite.
    shift: f64,
    solid_scatter: Scatter,
    edge_scatter: Scatter,
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
    solid_scatter: Scatter,
    edge_scatter: Scatter,
}

/// Largest part of the right-hand side left by the iteration: of a correction, which the next one
/// corrects, and of a solution.
const OF_A_CORRECTION: f64 = 1e-4;
const OF_A_SOLUTION: f64 = 1e-11;
/// Iterations after which the iteration is given up.
const KRYLOV_STEPS: usize = 120;
const SHIFTED_STEPS: usize = 15;

impl Matrix {
    /// An empty tangent of `n` equations coupled by the dofs of `solids` and `edges`.
    ///
    /// # Errors
    /// [`SolveError::Memory`].
    pub fn new(n: usize, solids: &[Vec<usize>], edges: &[Vec<usize>], symmetric: bool) -> Result<Self, SolveError> {
        let memory = || SolveError::Memory { unknowns: n };
        let groups = solids.iter().chain(edges).map(Vec::as_slice);
        let (lower, mut scatter, factor) = Ordered::new(n, groups.clone()).ok_or_else(memory)?;
        let edge_scatter = scatter.split_off(solids.len());
        let whole = (!symmetric).then(|| {
            let (pattern, mut scatter) = Pattern::new(n, groups, Stored::All);
            let edge_scatter = scatter.split_off(solids.len());
            Whole { values: vec![0.0; pattern.entries()], pattern, solid_scatter: scatter, edge_scatter }
        });
        Ok(Self {
            lower_values: vec![0.0; lower.entries()],
            lower,
            whole,
            factor,
            direct_factor: None,
            shift: 0.0,
            solid_scatter: scatter,
            edge_scatter,
            drive: vec![0.0; n],
            pull: vec![0.0; n],
            direct: 0.0,
        })
    }

    /// The same, with a factor of the whole in place of the iteration; a symmetric matrix stays as it is.
    ///
    /// # Errors
    /// [`SolveError::Memory`].
    pub fn factorising_all(mut self) -> Result<Self, SolveError> {
        if let Some(w) = &self.whole {
            let unknowns = self.drive.len();
            self.direct_factor = Some(UnsymmetricFactor::new(&w.pattern).ok_or(SolveError::Memory { unknowns })?);
        }
        Ok(self)
    }

    /// True when only the lower triangle is stored.
    #[must_use]
    pub fn is_symmetric(&self) -> bool {
        self.whole.is_none()
    }

    /// True when the last factorisation needed no diagonal shift: the state is a stable equilibrium. Always true where the
    /// whole of an unsymmetric matrix is factorised.
    #[must_use]
    pub fn is_definite(&self) -> bool {
        self.shift == 0.0
    }

    /// Sets everything to 0.
    pub fn clear(&mut self) {
        self.lower_values.fill(0.0);
        if let Some(w) = &mut self.whole {
            w.values.fill(0.0);
        }
        self.drive.fill(0.0);
        self.pull.fill(0.0);
        self.direct = 0.0;
    }

    /// Adds the stiffness of a solid; in a symmetric matrix its lower triangle suffices.
    pub fn add_solid<const N: usize>(&mut self, index: usize, k: &[[f64; N]; N]) {
        let Some(w) = &mut self.whole else {
            return add_lower(&mut self.lower_values, &self.solid_scatter[index], k);
        };
        add_all(&mut w.values, &w.solid_scatter[index], k);
        let half: [[f64; N]; N] = std::array::from_fn(|i| std::array::from_fn(|j| 0.5 * (k[i][j] + k[j][i])));
        add_lower(&mut self.lower_values, &self.solid_scatter[index], &half);
    }

    /// Adds the stiffness of an edge, and its part in `drive`, `pull` and `direct`: a deeper ball
    /// is the surface moved up, and the force on the ball is the sum of the axial nodal forces.
    pub fn add_edge(&mut self, index: usize, dofs: &[usize; 6], k: &EdgeStiffness) {
        add_lower(&mut self.lower_values, &self.edge_scatter[index], &k.symmetric);
        if let Some(w) = &mut self.whole {
            add_all(&mut w.values, &w.edge_scatter[index], &k.whole);
        }
        let k = &k.whole;
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

    /// Adds a multiple of the size of every diagonal entry to it, before the factorisation.
    pub fn damp(&mut self, part: f64) {
        for &d in self.lower.diagonal() {
            self.lower_values[d] += part * self.lower_values[d].abs();
        }
        if let Some(w) = &mut self.whole {
            for &d in w.pattern.diagonal() {
                w.values[d] += part * w.values[d].abs();
            }
        }
    }

    /// Norm of the diagonal (N/mm).
    #[must_use]
    pub fn diagonal_norm(&self) -> f64 {
        self.lower.diagonal().iter().map(|&d| self.lower_values[d].powi(2)).sum::<f64>().sqrt()
    }

    /// Factorises the stiffness or its symmetric neighbour; while it is not positive definite,
    /// with a growing multiple of its diagonal added. False when that does not help either.
    pub fn factorise(&mut self) -> bool {
        self.shift = 0.0;
        if let (Some(factor), Some(w)) = (&mut self.direct_factor, &self.whole) {
            return factor.factorise(&w.pattern, &w.values);
        }
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

    /// Newton's direction: solves with the whole matrix where it is unsymmetric, else with the factor,
    /// which is that of a shifted matrix where the matrix is not definite.
    pub fn correct(&mut self, x: &mut [f64]) {
        if let Some(factor) = &self.direct_factor {
            if !factor.solve(x) {
                x.fill(f64::NAN);
            }
            return;
        }
        // the factor of a shifted matrix preconditions badly: then its own direction is soon taken
        let steps = if self.shift > 0.0 { SHIFTED_STEPS } else { KRYLOV_STEPS };
        if !self.iterate(x, OF_A_CORRECTION, steps) {
            self.factor.solve(x);
        }
    }

    /// Solves `K x = b` in place with the matrix itself, shift or not. False when the iteration fails.
    pub fn solve(&mut self, x: &mut [f64]) -> bool {
        if let Some(factor) = &self.direct_factor {
            return factor.solve(x);
        }
        if self.whole.is_none() && self.shift == 0.0 {
            self.factor.solve(x);
            return true;
        }
        self.iterate(x, OF_A_SOLUTION, KRYLOV_STEPS)
    }

    /// Column `j` of the matrix as assembled, for checks.
    pub fn column(&self, j: usize, out: &mut [f64]) {
        let mut unit = vec![0.0; out.len()];
        unit[j] = 1.0;
        match &self.whole {
            Some(w) => w.pattern.multiply(&w.values, &unit, out),
            None => {
                let place = self.factor.place();
                let mut placed = vec![0.0; out.len()];
                let starts = self.lower.starts();
                for (column, range) in starts.windows(2).enumerate() {
                    for k in range[0]..range[1] {
                        let row = self.lower.rows()[k];
                        if column == place[j] {
                            placed[row] = self.lower_values[k];
                        } else if row == place[j] {
                            placed[column] = self.lower_values[k];
                        }
                    }
                }
                out.iter_mut().zip(place).for_each(|(out, place)| *out = placed[*place]);
            }
        }
    }

    fn iterate(&mut self, x: &mut [f64], tolerance: f64, steps: usize) -> bool {
        let Some(w) = &self.whole else {
            return false;
        };
        let factor = &mut self.factor;
        gmres(|v, out| w.pattern.multiply(&w.values, v, out), |v| factor.solve(v), x, tolerance, steps)
    }
}
