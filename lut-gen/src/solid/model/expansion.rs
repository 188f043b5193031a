//! A Chebyshev expansion over Poisson's ratio, height, exponent and depth.

use serde::{Deserialize, Serialize};

use super::Axis;
use super::chebyshev::polynomials;
use super::profile::MAX_TERMS;

/// `q = sum c T(nu) T(1/h) T(ln alpha) T(2 s - 1)`, `s = sqrt(d / d_max)`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Expansion {
    /// Poisson's ratio, height, exponent.
    pub axes: [Axis; 3],
    terms: usize,
    /// `[nu][height][alpha][depth]`.
    coefficients: Vec<f64>,
}

/// `q` and its derivatives by `s` and the parameters.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Expanded {
    pub value: f64,
    pub by_s: f64,
    /// By Poisson's ratio, height, exponent.
    pub by: [f64; 3],
    /// The same of `by_s`.
    pub by_s_and: [f64; 3],
}

/// Polynomials of one axis and their slopes.
struct Basis {
    value: [f64; MAX_TERMS],
    slope: [f64; MAX_TERMS],
}

impl Basis {
    fn at(x: f64, dx: f64, terms: usize) -> Self {
        let mut out = Self { value: [0.0; MAX_TERMS], slope: [0.0; MAX_TERMS] };
        polynomials(x, &mut out.value[..terms], &mut out.slope[..terms]);
        out.slope[..terms].iter_mut().for_each(|s| *s *= dx);
        out
    }
}

impl Expansion {
    /// From depth coefficients at the nodes of the axes, `[nu][height][alpha][depth]`.
    pub fn through(axes: [Axis; 3], terms: usize, mut nodes: Vec<f64>) -> Self {
        let mut stride = terms;
        for axis in axes.iter().rev() {
            let block = stride * axis.nodes;
            for start in (0..nodes.len()).step_by(block) {
                for at in start..start + stride {
                    let line: Vec<f64> = (0..axis.nodes).map(|k| nodes[at + k * stride]).collect();
                    for (k, c) in axis.coefficients(&line).into_iter().enumerate() {
                        nodes[at + k * stride] = c;
                    }
                }
            }
            stride = block;
        }
        Self { axes, terms, coefficients: nodes }
    }

    /// Coefficients in depth at the parameters in the order of the axes.
    pub fn slice(&self, parameters: [f64; 3]) -> Vec<f64> {
        let [nu, height, alpha]: [Basis; 3] = std::array::from_fn(|i| {
            let (x, dx) = self.axes[i].local(parameters[i]);
            Basis::at(x, dx, self.axes[i].nodes)
        });
        let [nn, nh, na] = self.axes.map(|a| a.nodes);
        let mut out = vec![0.0; self.terms];
        let mut rows = self.coefficients.chunks_exact(self.terms);
        for i in 0..nn {
            for j in 0..nh {
                let outer = nu.value[i] * height.value[j];
                for (k, row) in (0..na).zip(rows.by_ref()) {
                    let weight = outer * alpha.value[k];
                    out.iter_mut().zip(row).for_each(|(o, c)| *o += weight * c);
                }
            }
        }
        out
    }

    /// Value and derivatives at `s` in (0, 1] and the parameters in the order of the axes.
    pub fn at(&self, s: f64, parameters: [f64; 3]) -> Expanded {
        let depth = Basis::at(2.0 * s - 1.0, 2.0, self.terms);
        let [nu, height, alpha]: [Basis; 3] = std::array::from_fn(|i| {
            let (x, dx) = self.axes[i].local(parameters[i]);
            Basis::at(x, dx, self.axes[i].nodes)
        });
        let [nn, nh, na] = self.axes.map(|a| a.nodes);
        let (t, dt) = (&depth.value[..self.terms], &depth.slope[..self.terms]);
        let mut out = Expanded::default();
        let mut rows = self.coefficients.chunks_exact(self.terms);
        for i in 0..nn {
            // value and slope by s; then of both the derivatives by height and by exponent
            let mut sum = [0.0; 6];
            for j in 0..nh {
                let mut part = [0.0; 4];
                for (k, row) in (0..na).zip(rows.by_ref()) {
                    let (mut q, mut dq) = (0.0, 0.0);
                    for ((c, t), dt) in row.iter().zip(t).zip(dt) {
                        q += c * t;
                        dq += c * dt;
                    }
                    part[0] += alpha.value[k] * q;
                    part[1] += alpha.value[k] * dq;
                    part[2] += alpha.slope[k] * q;
                    part[3] += alpha.slope[k] * dq;
                }
                let (b, db) = (height.value[j], height.slope[j]);
                let each = [b * part[0], b * part[1], db * part[0], db * part[1], b * part[2], b * part[3]];
                sum.iter_mut().zip(each).for_each(|(s, e)| *s += e);
            }
            let (c, dc) = (nu.value[i], nu.slope[i]);
            out.value += c * sum[0];
            out.by_s += c * sum[1];
            out.by[0] += dc * sum[0];
            out.by_s_and[0] += dc * sum[1];
            out.by[1] += c * sum[2];
            out.by_s_and[1] += c * sum[3];
            out.by[2] += c * sum[4];
            out.by_s_and[2] += c * sum[5];
        }
        out
    }
}
