//! Logarithms of forces at the nodes of a force model, from solves there and what energies tell of their slopes.

use super::force::{DEPTH, TERMS};
use super::potential::{Ramp, slopes};
use super::{Axis, DepthProfile};

/// Least force over Hertz's whose logarithm is taken: below every solve, it only keeps a failed fit finite.
const LEAST: f64 = 1e-9;

/// `q = ln(F / (H d^1.5)) / s`, or a derivative of it, over the depth (the nodes of [`DEPTH`]) at the nodes of three axes: Poisson's ratio, height, exponent.
#[derive(Debug, Clone)]
pub(super) struct Nodes {
    counts: [usize; 3],
    /// The last axis runs first.
    rows: Vec<[f64; TERMS]>,
}

impl Nodes {
    /// Of solves at the nodes.
    pub fn of(ramps: &[Ramp], counts: [usize; 3]) -> Self {
        Self { counts, rows: ramps.iter().map(|ramp| logarithm(&ramp.profile)).collect() }
    }

    /// Their derivatives by the parameter of an axis, which is one of those that the ramps' energies were followed by. Hertz's factor depends on Poisson's ratio: `hertz` is the derivative of its
    /// logarithm at each node of the axis.
    pub fn slopes(
        &self,
        ramps: &[Ramp],
        (at, axis): (usize, &Axis),
        parameter: usize,
        hertz: impl Fn(f64) -> f64,
    ) -> Self {
        let s: [f64; TERMS] = std::array::from_fn(|k| DEPTH.node(k));
        let mut rows = self.rows.clone();
        for line in self.lines(at) {
            let each: Vec<&Ramp> = line.iter().map(|row| &ramps[*row]).collect();
            let hertz: Vec<f64> = (0..axis.nodes).map(|k| hertz(axis.node(k))).collect();
            let by = slopes(&each, parameter, (|values| axis.derivatives(values), &hertz), &s);
            for ((row, by), hertz) in line.iter().zip(by).zip(hertz) {
                rows[*row] = std::array::from_fn(|j| (by[j] * (-s[j] * self.rows[*row][j]).exp() - hertz) / s[j]);
            }
        }
        Self { counts: self.counts, rows }
    }

    /// At twice as many nodes of an axis, with the slopes at those that are.
    pub fn osculated(&self, slopes: &Self, (at, axis): (usize, &Axis)) -> Self {
        self.doubled(at, axis, |line, j| {
            let of = |nodes: &Self| line.iter().map(|row| nodes.rows[*row][j]).collect::<Vec<f64>>();
            axis.osculating(&of(self), &of(slopes))
        })
    }

    /// At twice as many nodes of an axis, by the polynomial through those that are.
    pub fn interpolated(&self, (at, axis): (usize, &Axis)) -> Self {
        self.doubled(at, axis, |line, j| {
            let values: Vec<f64> = line.iter().map(|row| self.rows[*row][j]).collect();
            axis.coefficients(&values)
        })
    }

    /// Depth coefficients, as an expansion is made from.
    pub fn coefficients(&self) -> Vec<f64> {
        self.rows.iter().flat_map(|row| DEPTH.coefficients(row)).collect()
    }

    fn doubled(&self, at: usize, axis: &Axis, of: impl Fn(&[usize], usize) -> Vec<f64>) -> Self {
        let twice = twice(axis);
        let mut counts = self.counts;
        counts[at] = twice.nodes;
        let mut out = Self { counts, rows: vec![[0.0; TERMS]; counts.iter().product()] };
        for (from, to) in self.lines(at).iter().zip(out.lines(at)) {
            for j in 0..TERMS {
                let coefficients = of(from, j);
                to.iter()
                    .enumerate()
                    .for_each(|(k, row)| out.rows[*row][j] = twice.evaluate(&coefficients, twice.node(k)));
            }
        }
        out
    }

    /// Places of the rows along every line of an axis.
    fn lines(&self, at: usize) -> Vec<Vec<usize>> {
        let stride: usize = self.counts[at + 1..].iter().product();
        let block = stride * self.counts[at];
        let starts = (0..self.counts.iter().product()).step_by(block).flat_map(|start| start..start + stride);
        starts.map(|start| (0..self.counts[at]).map(|k| start + k * stride).collect()).collect()
    }
}

/// An axis with twice as many nodes.
pub(super) fn twice(axis: &Axis) -> Axis {
    Axis { nodes: 2 * axis.nodes, ..*axis }
}

/// `q` of a profile.
fn logarithm(profile: &DepthProfile) -> [f64; TERMS] {
    let at = |s: f64| {
        let d = s * s * profile.depth_max_mm;
        (profile.force_n(d) / (profile.hertz * d * d.sqrt())).max(LEAST).ln() / s
    };
    std::array::from_fn(|k| at(DEPTH.node(k)))
}

#[cfg(test)]
mod tests {
    use super::super::Scale;
    use super::*;

    /// Of the middle one of three axes: a polynomial of twice as many terms is met everywhere, whatever the others are.
    #[test]
    fn a_line_is_made_of_the_nodes_of_its_axis() {
        let axis = Axis { low: 1.0, high: 3.0, nodes: 3, scale: Scale::Log };
        let value = |x: f64, i: usize, k: usize| {
            let t = x.ln();
            ((i + 1) as f64 + t.powi(5) + k as f64 * t * t, (5.0 * t.powi(4) + 2.0 * k as f64 * t) / x)
        };
        let of = |counts: [usize; 3], axis: &Axis, which: fn((f64, f64)) -> f64| {
            let place = |row: usize| (row / (counts[1] * counts[2]), row / counts[2] % counts[1], row % counts[2]);
            let rows = (0..counts.iter().product()).map(|row| {
                let (i, j, k) = place(row);
                [which(value(axis.node(j), i, k)); TERMS]
            });
            Nodes { counts, rows: rows.collect() }
        };
        let found = of([2, 3, 4], &axis, |v| v.0).osculated(&of([2, 3, 4], &axis, |v| v.1), (1, &axis));
        let expected = of([2, 6, 4], &twice(&axis), |v| v.0);
        assert_eq!(found.counts, expected.counts);
        let pairs = found.rows.as_flattened().iter().zip(expected.rows.as_flattened());
        assert!(pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) < 1e-12);
    }
}
