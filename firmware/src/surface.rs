//! The continuous force surface F(mu, alpha, depth) of a table's slice, with exact derivatives.
//!
//! Force is proportional to mu. Over alpha and depth the stored forces are joined by cubic Hermite pieces whose slopes at the nodes are
//! those of the parabola through three neighbours (for even nodes the Catmull-Rom spline): once continuously differentiable, local (16
//! stored forces a value), and differentiated exactly, piece by piece. Values of alpha may be spaced in any way. At the surface force
//! and slope are zero, as Hertz's `d^1.5` has them, and stay so above it.

mod curve;

pub use curve::Curve;

use crate::search::{MAX_FACTORS, Slice};
use protocol::lut::{Table, axis_name};

/// Force and its derivatives at one place.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Force {
    /// Force, N.
    pub force_n: f32,
    /// By the shear modulus, N/MPa.
    pub by_mu: f32,
    /// By the exponent, N.
    pub by_alpha: f32,
    /// By the depth, N/mm.
    pub by_depth: f32,
}

/// The surface of one slice.
#[derive(Debug, Clone, Copy)]
pub struct Surface<'a> {
    table: Table<'a>,
    first: usize,
    stride: usize,
    count: usize,
    /// Force per MPa for a stored force of 1.
    per_mpa: f32,
    per_step: f32,
    alphas: [f32; MAX_FACTORS],
}

impl<'a> Surface<'a> {
    /// The surface of `slice`; `None` for a table without axes `mu` and `alpha`, with fewer than four exponents or fewer than three rows.
    pub fn new(table: &Table<'a>, slice: &Slice) -> Option<Self> {
        let shapes = slice.shapes(table, 0);
        if shapes.count < 4 || table.rows() < 3 {
            return None;
        }
        table.axis(axis_name::MU)?;
        let per_mpa = match table.factor() {
            Some(factor) if factor.name == axis_name::MU => 1.0,
            Some(_) => return None,
            None => 1.0 / table.column_value(shapes.first, axis_name::MU)?,
        };
        // The columns of one rate, height and mu are those of the exponents, in order.
        let axis = table.axis(axis_name::ALPHA).filter(|a| a.len() == shapes.count)?;
        let mut alphas = [0.0; MAX_FACTORS];
        for (slot, alpha) in alphas.get_mut(..shapes.count)?.iter_mut().zip(axis.values()) {
            *slot = alpha;
        }
        Some(Surface {
            table: *table,
            first: shapes.first,
            stride: shapes.stride,
            count: shapes.count,
            per_mpa,
            per_step: 1.0 / table.depth_step_mm(),
            alphas,
        })
    }

    /// Least and largest exponent.
    pub fn alpha_range(&self) -> (f32, f32) {
        let alphas = self.alphas();
        (alphas.first().copied().unwrap_or(0.0), alphas.last().copied().unwrap_or(0.0))
    }

    /// Depth of the last row, mm.
    pub fn depth_max_mm(&self) -> f32 {
        self.table.depth_max_mm()
    }

    fn alphas(&self) -> &[f32] {
        self.alphas.get(..self.count).unwrap_or(&[])
    }

    /// Force and derivatives; zero at and above the surface. `None` for an exponent outside the grid, a depth beyond the last row, or
    /// anything that is not a number.
    pub fn at(&self, mu_mpa: f32, alpha: f32, depth_mm: f32) -> Option<Force> {
        let (column, across) = self.across(alpha)?;
        if !mu_mpa.is_finite() || depth_mm.is_nan() {
            return None;
        }
        if depth_mm <= 0.0 {
            return Some(Force::default());
        }
        let (rows, down) = self.down(depth_mm)?;
        // Blended over depth for each of the four columns, then over alpha.
        let (mut value, mut by_depth, mut by_alpha) = (0.0, 0.0, 0.0);
        for (i, (w, dw)) in across.value.iter().zip(across.slope).enumerate() {
            let column = self.first + (column + i) * self.stride;
            let (mut f, mut df) = (0.0, 0.0);
            for (row, (v, dv)) in rows.iter().zip(down.value.iter().zip(down.slope)) {
                if let Some(row) = row {
                    let stored = self.table.row_force_n(*row, column);
                    f += v * stored;
                    df += dv * stored;
                }
            }
            value += w * f;
            by_alpha += dw * f;
            by_depth += w * df;
        }
        let by_mu = self.per_mpa * value;
        let scale = self.per_mpa * mu_mpa;
        Some(Force {
            force_n: mu_mpa * by_mu,
            by_mu,
            by_alpha: scale * by_alpha,
            by_depth: scale * self.per_step * by_depth,
        })
    }

    /// First of the four columns around `alpha`, and their weights.
    fn across(&self, alpha: f32) -> Option<(usize, Weights)> {
        let alphas = self.alphas();
        let (low, high) = self.alpha_range();
        if !(alpha >= low && alpha <= high) {
            return None;
        }
        let below = alphas.partition_point(|a| *a <= alpha).clamp(1, self.count - 1) - 1;
        let from = below.saturating_sub(1).min(self.count - 4);
        let nodes: &[f32; 4] = alphas.get(from..from + 4)?.try_into().ok()?;
        Some((from, Weights::between(nodes, below - from, alpha)))
    }

    /// The four rows around a depth (`None` is depth zero, which has no row) and their weights, by steps.
    fn down(&self, depth_mm: f32) -> Option<([Option<usize>; 4], Weights)> {
        let (rows, at) = (self.table.rows(), depth_mm * self.per_step);
        // One thousandth of a step beyond the last row is rounding, not depth.
        if !(at <= rows as f32 + 1e-3) {
            return None;
        }
        // Depth k steps is row k - 1.
        let below = (at as usize).min(rows - 1);
        let mut weights = Weights::even((at - below as f32).min(1.0));
        if below == 0 {
            // The curve is continued evenly above the surface, which makes the slope there zero.
            return Some(([Some(0), None, Some(0), Some(1)], weights));
        }
        if below + 1 == rows {
            weights.continue_parabola();
        }
        let before = below.checked_sub(2);
        Some(([before, Some(below - 1), Some(below), Some((below + 1).min(rows - 1))], weights))
    }
}

/// Weights of four nodes for value and derivative.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Weights {
    value: [f32; 4],
    slope: [f32; 4],
}

impl Weights {
    /// At `t` of 0 to 1 between the second and third of four even nodes.
    fn even(t: f32) -> Self {
        let (s, c) = (t * t, t * t * t);
        Weights {
            value: [s - 0.5 * (t + c), 1.0 - 2.5 * s + 1.5 * c, 0.5 * t + 2.0 * s - 1.5 * c, 0.5 * (c - s)],
            slope: [2.0 * t - 0.5 - 1.5 * s, 4.5 * s - 5.0 * t, 0.5 + 4.0 * t - 4.5 * s, 1.5 * s - t],
        }
    }

    /// For a missing fourth node: the parabola through the other three stands in for it.
    fn continue_parabola(&mut self) {
        for [a, b, c, d] in [&mut self.value, &mut self.slope] {
            *a += *d;
            *b -= 3.0 * *d;
            *c += 3.0 * *d;
            *d = 0.0;
        }
    }

    /// At `x` in interval number `interval` of four nodes.
    fn between(nodes: &[f32; 4], interval: usize, x: f32) -> Self {
        let (low, high) = (interval.min(2), interval.min(2) + 1);
        let h = nodes[high] - nodes[low];
        let t = (x - nodes[low]) / h;
        let (s, c) = (t * t, t * t * t);
        let mut out = Weights { value: [0.0; 4], slope: [0.0; 4] };
        let step = 2.0 * c - 3.0 * s;
        let step_slope = 6.0 * (s - t) / h;
        out.value[low] += 1.0 + step;
        out.value[high] -= step;
        out.slope[low] += step_slope;
        out.slope[high] -= step_slope;
        let bends = [(low, h * (c - 2.0 * s + t), 3.0 * s - 4.0 * t + 1.0), (high, h * (c - s), 3.0 * s - 2.0 * t)];
        for (node, value, slope) in bends {
            let from = node.saturating_sub(1).min(1);
            let [a, b, c] = parabola_slope(nodes[from], nodes[from + 1], nodes[from + 2], nodes[node]);
            for (i, w) in [(from, a), (from + 1, b), (from + 2, c)] {
                out.value[i] += value * w;
                out.slope[i] += slope * w;
            }
        }
        out
    }
}

/// Weights of the values at `a < b < c` in the slope at `x` of the parabola through them.
fn parabola_slope(a: f32, b: f32, c: f32, x: f32) -> [f32; 3] {
    [
        ((x - b) + (x - c)) / ((a - b) * (a - c)),
        ((x - a) + (x - c)) / ((b - a) * (b - c)),
        ((x - a) + (x - b)) / ((c - a) * (c - b)),
    ]
}

#[cfg(test)]
mod tests;
