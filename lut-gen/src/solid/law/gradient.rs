//! From principal stretches to the first Piola-Kirchhoff stress and its tangent
//! for an axisymmetric deformation gradient.
//!
//! ```text
//!     | Frr Frz  0  |
//! F = | Fzr Fzz  0  |     components in the order  [rr, rz, zr, zz, tt]
//!     |  0   0  Ftt |
//! ```

use super::{Law, Tangent};
use crate::scalar::{Dual, Real};

/// Axisymmetric deformation gradient `[Frr, Frz, Fzr, Fzz, Ftt]` (-).
pub type Gradient = [f64; 5];

/// Energy, first Piola-Kirchhoff stress and tangent at a deformation gradient.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Response {
    /// Energy per unit reference volume (MPa).
    pub energy: f64,
    /// `P = dU/dF` in the order `[rr, rz, zr, zz, tt]` (MPa).
    pub stress: [f64; 5],
    /// `A = dP/dF` (MPa), symmetric 5 x 5.
    pub tangent: [[f64; 5]; 5],
}

/// The in-plane part as a turn and a mirror image, `F = q D + r S`, with its signed principal stretches `q + r` and `q - r`.
///
/// ```text
/// D = | cos d  -sin d |     S = | cos s   sin s |     d = a - b, s = a + b for F = R(a) diag(s1, s2) R(b)^T
///     | sin d   cos d |         | sin s  -cos s |
/// ```
///
/// These two and their derivatives by the angles are orthogonal, each of square 2. No half angle and no arctangent is needed: half
/// sums and differences of `F` are lengths times the cosines and sines.
struct InPlane {
    stretches: [f64; 2],
    turn: Plane,
    mirror: Plane,
}

/// Components in the order `[rr, rz, zr, zz]`.
type Plane = [f64; 4];

impl InPlane {
    /// `None` when the determinant or the hoop stretch is not positive.
    fn of(f: &Gradient) -> Option<Self> {
        let det = f[0] * f[3] - f[1] * f[2];
        if !(det > 0.0 && f[4] > 0.0 && det.is_finite()) {
            return None;
        }
        let (e, g) = (0.5 * (f[0] + f[3]), 0.5 * (f[2] - f[1]));
        let (h, k) = (0.5 * (f[0] - f[3]), 0.5 * (f[2] + f[1]));
        let (q, r) = ((e * e + g * g).sqrt(), (h * h + k * k).sqrt());
        let (c, s) = (e / q, g / q);
        // with r = 0 any angle will do
        let (cs, ss) = if r > 0.0 { (h / r, k / r) } else { (1.0, 0.0) };
        let larger = q + r;
        Some(Self { stretches: [larger, det / larger], turn: [c, -s, s, c], mirror: [cs, ss, ss, -cs] })
    }

    /// Derivatives of turn and mirror image by their angles.
    fn by_angles(&self) -> [Plane; 2] {
        let ([c, _, s, _], [cs, ss, ..]) = (self.turn, self.mirror);
        [[-s, -c, c, -s], [-ss, cs, cs, ss]]
    }

    /// What these principal components are in the frame of the gradient, the hoop component after the others.
    fn back(&self, p: [f64; 3]) -> [f64; 5] {
        let (mean, half) = (0.5 * (p[0] + p[1]), 0.5 * (p[0] - p[1]));
        let plane = |i: usize| mean * self.turn[i] + half * self.mirror[i];
        [plane(0), plane(1), plane(2), plane(3), p[2]]
    }
}

/// Relative difference of two stretches below which the divided difference of
/// their stresses is replaced by its limit. Both errors are about 1e-10 there:
/// rounding 1e-16 / 1e-5 on one side, truncation (1e-5)^2 on the other.
const EQUAL_STRETCH: f64 = 1e-5;

/// A number in which stresses are known: plain, or with its derivative.
pub trait Strained: Real {
    /// Energy (MPa) and first Piola-Kirchhoff stress (MPa) of an elastic law at the
    /// gradient `f`; `None` when `f` does not preserve orientation.
    fn piola(law: &impl Law<Self>, f: &[Self; 5]) -> Option<(Self, [Self; 5])>;
}

impl Strained for f64 {
    fn piola(law: &impl Law, f: &[f64; 5]) -> Option<(f64, [f64; 5])> {
        first_piola(law, f)
    }
}

impl Strained for Dual {
    fn piola(law: &impl Law<Dual>, f: &[Dual; 5]) -> Option<(Dual, [Dual; 5])> {
        first_piola_dual(law, f)
    }
}

/// Energy and stress only. `None` when `F` does not preserve orientation.
pub fn first_piola(law: &impl Law, f: &Gradient) -> Option<(f64, [f64; 5])> {
    let plane = InPlane::of(f)?;
    let [s1, s2] = plane.stretches;
    let (energy, p) = law.stress([s1, s2, f[4]]);
    Some((energy, plane.back(p)))
}

/// Energy and stress with their derivative by the parameter that law and gradient carry.
///
/// Lengths of turn and mirror image change the stretches, so that the law itself gives their part; their angles
/// turn the frame, see [`respond`]. Equal stretches need no division: there the limit is taken.
pub fn first_piola_dual(law: &impl Law<Dual>, f: &[Dual; 5]) -> Option<(Dual, [Dual; 5])> {
    let plane = InPlane::of(&f.map(Real::value))?;
    let [s1, s2] = plane.stretches;
    let df = f.map(Real::derivative);
    let along = |mode: &Plane| 0.5 * mode.iter().zip(&df).map(|(m, df)| m * df).sum::<f64>();
    let (dq, dr) = (along(&plane.turn), along(&plane.mirror));
    let (energy, p) = law.stress([Dual::new(s1, dq + dr), Dual::new(s2, dq - dr), f[4]]);
    let (sum, difference) = (s1 + s2, s1 - s2);
    let x = if difference > EQUAL_STRETCH * sum {
        (p[0].value - p[1].value) / difference
    } else {
        // along (1, -1): U_11 - 2 U_12 + U_22, less what the parameter itself does
        let along = |by: f64| law.stress([Dual::new(s1, by), Dual::new(s2, -by), Dual::from(f[4].value)]).1;
        let (moved, still) = (along(1.0), along(0.0));
        0.5 * (moved[0].derivative - still[0].derivative - moved[1].derivative + still[1].derivative)
    };
    let y = (p[0].value + p[1].value) / sum;
    let [by_turn, by_mirror] = plane.by_angles();
    let (turned, mirrored) = (y * along(&by_turn), x * along(&by_mirror));
    let value = plane.back(p.map(Real::value));
    let mut rate = plane.back(p.map(Real::derivative));
    (0..4).for_each(|i| rate[i] += turned * by_turn[i] + mirrored * by_mirror[i]);
    Some((energy, std::array::from_fn(|i| Dual::new(value[i], rate[i]))))
}

/// Energy, stress and exact tangent. `None` when `F` does not preserve orientation.
///
/// With `dF = dq D + dr S + q dd D' + r ds S'` the stretches change by `dq + dr` and `dq - dr`, which couples the first two by
/// `d2U/dl_i dl_j`; the angles give `y/2` along `D'` and `x/2` along `S'`, with (Ogden, Non-linear Elastic Deformations, 6.1.4)
/// `x = (p1 - p2) / (s1 - s2)` and `y = (p1 + p2) / (s1 + s2)`; for equal stretches `x` tends to the mean of `U_11` and `U_22` less `U_12`.
pub fn respond(law: &impl Tangent, f: &Gradient) -> Option<Response> {
    let plane = InPlane::of(f)?;
    let [s1, s2] = plane.stretches;
    let u = law.principal([s1, s2, f[4]]);
    let (p, h) = (u.stress, u.tangent);
    let (sum, difference) = (s1 + s2, s1 - s2);
    let x =
        if difference > EQUAL_STRETCH * sum { (p[0] - p[1]) / difference } else { 0.5 * (h[0][0] + h[1][1]) - h[0][1] };
    let y = (p[0] + p[1]) / sum;

    let (turn, mirror, [by_turn, by_mirror]) = (&plane.turn, &plane.mirror, plane.by_angles());
    let (both, twice, apart) = (h[0][0] + h[1][1], 2.0 * h[0][1], h[0][0] - h[1][1]);
    let (turns, crossed, mirrors) = (0.25 * (both + twice), 0.25 * apart, 0.25 * (both - twice));
    let hoop = (0.5 * (h[0][2] + h[1][2]), 0.5 * (h[0][2] - h[1][2]));
    let mut tangent = [[0.0; 5]; 5];
    for i in 0..4 {
        let (d, s) = (turns * turn[i] + crossed * mirror[i], crossed * turn[i] + mirrors * mirror[i]);
        let (dd, ds) = (0.5 * y * by_turn[i], 0.5 * x * by_mirror[i]);
        for j in 0..4 {
            tangent[i][j] = d * turn[j] + s * mirror[j] + dd * by_turn[j] + ds * by_mirror[j];
        }
        let hoop = hoop.0 * turn[i] + hoop.1 * mirror[i];
        tangent[i][4] = hoop;
        tangent[4][i] = hoop;
    }
    tangent[4][4] = h[2][2];
    Some(Response { energy: u.energy, stress: plane.back(p), tangent })
}
