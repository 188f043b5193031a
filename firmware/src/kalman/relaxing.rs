//! The six parameters of hyper-viscoelastic tissue (Ogden and one Prony term, thesis section 2.11) on a surface that a board can hold.
//!
//! Force is `F = mu exp(Q)`: proportional to mu at a given product `D mu` of compressibility and modulus. Q is a quadratic polynomial in each of
//! alpha, `ln(D mu)`, `-ln(1 - g)`, k and `ln tau` through three values of each, 243 numbers a time of the press; between times it is a straight line
//! over `ln t`, which a power law of the ramp is. The derivatives are those of this surface, exactly. Thirty times take 30 kB.

use super::{Model, Prediction, Region};
use nalgebra::{SVector, Vector6};

/// Parameters besides mu.
const AXES: usize = 5;

/// Values of Q a time: three of each parameter.
pub const NODES: usize = 243;

/// The surface, borrowed from its numbers.
#[derive(Debug, Clone, Copy)]
pub struct Relaxing<'a> {
    /// Three values of alpha, `D mu`, g, k and tau (s), rising.
    values: &'a [[f32; 3]; AXES],
    /// The same as coordinates of Q.
    coordinates: [[f32; 3]; AXES],
    times_s: &'a [f32],
    /// `ln(F / mu)`, [`NODES`] a time, the last parameter fastest; mu in MPa, F in N.
    logarithms: &'a [f32],
}

/// Coordinate of parameter number `i`, and its derivative.
fn coordinate(i: usize, x: f32) -> (f32, f32) {
    match i {
        1 | 4 => (libm::logf(x), 1.0 / x),
        2 => (-libm::logf(1.0 - x), 1.0 / (1.0 - x)),
        _ => (x, 1.0),
    }
}

impl<'a> Relaxing<'a> {
    /// The surface over `values` (alpha, `D mu`, g, k, tau in s; three rising values each) at `times_s` (positive, rising, at least two).
    /// `None` if lengths, order or ranges are wrong, or anything is not a number.
    pub fn new(values: &'a [[f32; 3]; AXES], times_s: &'a [f32], logarithms: &'a [f32]) -> Option<Self> {
        let [alpha, product, g, k, tau] = values;
        let rising = values.iter().all(|v| v[0] < v[1] && v[1] < v[2]);
        let ranges = alpha[0] > 0.0 && product[0] > 0.0 && g[0] >= 0.0 && g[2] < 1.0 && k[0] >= 0.0 && tau[0] > 0.0;
        let timed = times_s.len() >= 2 && times_s[0] > 0.0 && times_s.windows(2).all(|t| t[0] < t[1]);
        let whole = logarithms.len() == NODES * times_s.len() && logarithms.iter().all(|x| x.is_finite());
        let coordinates = core::array::from_fn(|i| values[i].map(|x| coordinate(i, x).0));
        (rising && ranges && timed && whole).then_some(Relaxing { values, coordinates, times_s, logarithms })
    }

    /// Region of the states (mu MPa, alpha, D 1/MPa, g, k, tau s) for moduli from `mu_mpa.0` to `mu_mpa.1`; D is bounded so that it
    /// covers the surface for any of them.
    pub fn region(&self, mu_mpa: (f32, f32)) -> Region<6> {
        let [alpha, product, g, k, tau] = self.values;
        Region {
            low: Vector6::new(mu_mpa.0, alpha[0], product[0] / mu_mpa.1, g[0], k[0], tau[0]),
            high: Vector6::new(mu_mpa.1, alpha[2], product[2] / mu_mpa.0, g[2], k[2], tau[2]),
        }
    }

    /// Q and its derivatives by the five coordinates, at time number `row`.
    fn at(&self, row: usize, weights: &[[f32; 3]; AXES], slopes: &[[f32; 3]; AXES]) -> Option<[f32; AXES + 1]> {
        let stored = self.logarithms.get(row * NODES..(row + 1) * NODES)?;
        // One parameter after the other is taken out, the fastest first; an entry is the value and the derivatives so far.
        let mut entries = [[0.0; AXES + 1]; NODES / 3];
        let last = AXES - 1;
        for (entry, three) in entries.iter_mut().zip(stored.as_chunks::<3>().0) {
            for (i, x) in three.iter().enumerate() {
                entry[0] += weights[last][i] * x;
                entry[1 + last] += slopes[last][i] * x;
            }
        }
        let mut count = NODES / 3;
        for axis in (0..last).rev() {
            count /= 3;
            for at in 0..count {
                let mut out = [0.0; AXES + 1];
                for i in 0..3 {
                    let from = entries[3 * at + i];
                    out[0] += weights[axis][i] * from[0];
                    out[1 + axis] += slopes[axis][i] * from[0];
                    for later in axis + 1..AXES {
                        out[1 + later] += weights[axis][i] * from[1 + later];
                    }
                }
                entries[at] = out;
            }
        }
        Some(entries[0])
    }
}

/// Weights of three nodes in the parabola through them, and in its slope.
fn parabola(nodes: &[f32; 3], x: f32) -> ([f32; 3], [f32; 3]) {
    let [a, b, c] = *nodes;
    let (p, q, r) = ((a - b) * (a - c), (b - a) * (b - c), (c - a) * (c - b));
    (
        [(x - b) * (x - c) / p, (x - a) * (x - c) / q, (x - a) * (x - b) / r],
        [((x - b) + (x - c)) / p, ((x - a) + (x - c)) / q, ((x - a) + (x - b)) / r],
    )
}

impl Model<6> for Relaxing<'_> {
    /// Time since contact, s.
    type Input = f32;

    /// States mu (MPa), alpha, D (1/MPa), g, k, tau (s). `None` for a time before the first or after the last one, and for parameters that a material
    /// cannot have; outside its three values a parameter is held at the nearest, where the force does not change with it.
    fn predict(&self, state: &Vector6<f32>, time_s: f32) -> Option<Prediction<6>> {
        let [mu, alpha, d, g, k, tau]: [f32; 6] = (*state).into();
        if !(mu > 0.0 && d > 0.0 && mu.is_finite() && d.is_finite()) {
            return None;
        }
        let (mut weights, mut slopes, mut inner) = ([[0.0; 3]; AXES], [[0.0; 3]; AXES], [0.0; AXES]);
        for (i, x) in [alpha, d * mu, g, k, tau].into_iter().enumerate() {
            if x.is_nan() {
                return None;
            }
            let [low, _, high] = self.values[i];
            let held = crate::number::limit(x, low, high);
            let (at, by) = coordinate(i, held);
            (weights[i], slopes[i]) = parabola(&self.coordinates[i], at);
            inner[i] = if held == x { by } else { 0.0 };
        }
        let row = self.times_s.partition_point(|t| *t <= time_s).checked_sub(1)?.min(self.times_s.len() - 2);
        let (before, after) = (self.times_s[row], self.times_s[row + 1]);
        // One part in a thousand beyond the last time is rounding.
        if !(time_s <= after * 1.001) {
            return None;
        }
        let share = libm::logf(time_s / before) / libm::logf(after / before);
        let (first, second) = (self.at(row, &weights, &slopes)?, self.at(row + 1, &weights, &slopes)?);
        let q: [f32; AXES + 1] = core::array::from_fn(|i| first[i] + share * (second[i] - first[i]));
        let per_mpa = libm::expf(q[0]);
        let value = mu * per_mpa;
        let by = |i: usize| value * q[1 + i] * inner[i];
        let gradient: SVector<f32, 6> = Vector6::new(per_mpa + d * by(1), by(0), mu * by(1), by(2), by(3), by(4));
        Some(Prediction { value, gradient })
    }
}
