//! From the logarithms of the principal stretches to the stress and tangent of a deformation
//! gradient.
//!
//! ```text
//!     | F0 F1 0  |
//! F = | F2 F3 0  |     components [xx, xy, yx, yy, zz]; z is the third direction of the plane, or the hoop of a ring
//!     | 0  0  F4 |
//! ```

use crate::fem::operator::Response;

/// Deformation gradient `[xx, xy, yx, yy, zz]` (-), or a stress conjugate to it (MPa).
pub type Gradient = [f64; 5];

/// No deformation.
pub const IDENTITY: Gradient = [1.0, 0.0, 0.0, 1.0, 1.0];

/// Energy and its derivatives by the logarithms of the principal stretches.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Principal {
    /// Energy per reference volume (MPa).
    pub energy: f64,
    /// Principal Kirchhoff stresses `dU / d ln l_k` (MPa).
    pub kirchhoff: [f64; 3],
    /// `d tau_k / d ln l_m` (MPa), symmetric.
    pub slope: [[f64; 3]; 3],
}

impl Principal {
    /// All of it times a factor.
    #[must_use]
    pub fn times(self, factor: f64) -> Self {
        Self {
            energy: factor * self.energy,
            kirchhoff: self.kirchhoff.map(|x| factor * x),
            slope: self.slope.map(|row| row.map(|x| factor * x)),
        }
    }
}

/// The in-plane part as a turn and a mirror image, `F = q D + r S`, whose principal stretches are
/// `q + r` and `q - r`.
///
/// `D = [c, -s, s, c]` and `S = [C, S, S, -C]` and their derivatives by the angles are orthogonal,
/// each of square 2; half sums and differences of `F` are lengths times the cosines and sines, so
/// that no arctangent is needed.
#[derive(Debug, Clone, Copy)]
pub struct Stretched {
    /// Principal stretches, the larger in-plane one first, the third direction last.
    pub stretches: [f64; 3],
    turn: [f64; 4],
    mirror: [f64; 4],
}

/// Relative difference of two stretches below which the divided difference of their stresses is its
/// limit: rounding (1e-16 / 1e-5) and truncation ((1e-5)^2) are then both below 1e-9.
const EQUAL: f64 = 1e-5;

impl Stretched {
    /// `None` when the determinant or the third stretch is not positive.
    #[must_use]
    pub fn of(f: &Gradient) -> Option<Self> {
        let det = f[0] * f[3] - f[1] * f[2];
        if !(det > 0.0 && f[4] > 0.0 && det.is_finite()) {
            return None;
        }
        let (e, g) = (0.5 * (f[0] + f[3]), 0.5 * (f[2] - f[1]));
        let (h, k) = (0.5 * (f[0] - f[3]), 0.5 * (f[2] + f[1]));
        let (q, r) = (e.hypot(g), h.hypot(k));
        let (c, s) = (e / q, g / q);
        // any angle will do for equal stretches
        let (cs, ss) = if r > 0.0 { (h / r, k / r) } else { (1.0, 0.0) };
        let larger = q + r;
        Some(Self { stretches: [larger, det / larger, f[4]], turn: [c, -s, s, c], mirror: [cs, ss, ss, -cs] })
    }

    /// Logarithms of the stretches.
    #[must_use]
    pub fn logarithms(&self) -> [f64; 3] {
        self.stretches.map(f64::ln)
    }

    /// The tensor of these principal values between the same two frames as the gradient.
    #[must_use]
    pub fn back(&self, p: [f64; 3]) -> Gradient {
        let (mean, half) = (0.5 * (p[0] + p[1]), 0.5 * (p[0] - p[1]));
        let plane = |i: usize| mean * self.turn[i] + half * self.mirror[i];
        [plane(0), plane(1), plane(2), plane(3), p[2]]
    }

    /// First Piola-Kirchhoff stress (MPa) of these principal Kirchhoff stresses.
    #[must_use]
    pub fn stress(&self, kirchhoff: [f64; 3]) -> Gradient {
        self.back([0, 1, 2].map(|k| kirchhoff[k] / self.stretches[k]))
    }

    /// Energy, first Piola-Kirchhoff stress and tangent.
    ///
    /// With `dF = dq D + dr S + q dd D' + r ds S'` the stretches change by `dq + dr` and `dq - dr`;
    /// the angles give `y / 2` along `D'` and `x / 2` along `S'`, `x = (p1 - p2) / (l1 - l2)` and
    /// `y = (p1 + p2) / (l1 + l2)` (Ogden, Non-linear Elastic Deformations, 6.1.4); for equal
    /// stretches `x` is the mean of `H11` and `H22` less `H12`, the derivatives of the nominal
    /// stresses `p_k = tau_k / l_k` by the stretches.
    #[must_use]
    pub fn respond(&self, u: &Principal) -> Response<5> {
        let l = self.stretches;
        let p: [f64; 3] = std::array::from_fn(|k| u.kirchhoff[k] / l[k]);
        let h: [[f64; 3]; 3] = std::array::from_fn(|k| {
            std::array::from_fn(|m| (u.slope[k][m] - if k == m { u.kirchhoff[k] } else { 0.0 }) / (l[k] * l[m]))
        });
        let (sum, difference) = (l[0] + l[1], l[0] - l[1]);
        let x = if difference > EQUAL * sum { (p[0] - p[1]) / difference } else { 0.5 * (h[0][0] + h[1][1]) - h[0][1] };
        let y = (p[0] + p[1]) / sum;
        let ([c, _, s, _], [cs, ss, ..]) = (self.turn, self.mirror);
        let (by_turn, by_mirror) = ([-s, -c, c, -s], [-ss, cs, cs, ss]);
        let (turn, mirror) = (&self.turn, &self.mirror);
        let (both, twice, apart) = (h[0][0] + h[1][1], 2.0 * h[0][1], h[0][0] - h[1][1]);
        let (turns, crossed, mirrors) = (0.25 * (both + twice), 0.25 * apart, 0.25 * (both - twice));
        let third = (0.5 * (h[0][2] + h[1][2]), 0.5 * (h[0][2] - h[1][2]));
        let mut tangent = [[0.0; 5]; 5];
        for i in 0..4 {
            let (d, s) = (turns * turn[i] + crossed * mirror[i], crossed * turn[i] + mirrors * mirror[i]);
            let (dd, ds) = (0.5 * y * by_turn[i], 0.5 * x * by_mirror[i]);
            for j in 0..4 {
                tangent[i][j] = d * turn[j] + s * mirror[j] + dd * by_turn[j] + ds * by_mirror[j];
            }
            tangent[i][4] = third.0 * turn[i] + third.1 * mirror[i];
            tangent[4][i] = tangent[i][4];
        }
        tangent[4][4] = h[2][2];
        Response { energy: u.energy, flux: self.back(p), tangent }
    }
}

/// Cauchy stress `[xx, yy, xy, zz]` (MPa) of a first Piola-Kirchhoff stress: `P F' / J`.
#[must_use]
pub fn cauchy(f: &Gradient, p: &Gradient) -> [f64; 4] {
    let j = (f[0] * f[3] - f[1] * f[2]) * f[4];
    [(p[0] * f[0] + p[1] * f[1]) / j, (p[2] * f[2] + p[3] * f[3]) / j, (p[0] * f[2] + p[1] * f[3]) / j, p[4] * f[4] / j]
}

/// Von Mises' equivalent of a stress `[xx, yy, xy, zz]`.
#[must_use]
pub fn mises(s: &[f64; 4]) -> f64 {
    let d = (s[0] - s[1]).powi(2) + (s[1] - s[3]).powi(2) + (s[3] - s[0]).powi(2);
    (0.5 * d + 3.0 * s[2] * s[2]).sqrt()
}
