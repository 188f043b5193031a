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

/// Signed singular values and rotations of the in-plane part:
/// `[[Frr, Frz], [Fzr, Fzz]] = R(a) diag(s) R(b)^T`.
struct InPlane {
    s: [f64; 2],
    /// cosine and sine of `a`
    left: [f64; 2],
    /// cosine and sine of `b`
    right: [f64; 2],
}

/// Closed-form 2 x 2 singular value decomposition by half sums and differences:
/// `s1 + s2` and `s1 - s2` are lengths, `a + b` and `a - b` are angles.
/// `None` when the determinant or the hoop stretch is not positive.
fn decompose(f: &Gradient) -> Option<InPlane> {
    let det = f[0] * f[3] - f[1] * f[2];
    if !(det > 0.0 && f[4] > 0.0 && det.is_finite()) {
        return None;
    }
    let (e, g) = (0.5 * (f[0] + f[3]), 0.5 * (f[2] - f[1]));
    let (h, k) = (0.5 * (f[0] - f[3]), 0.5 * (f[2] + f[1]));
    let q = (e * e + g * g).sqrt();
    let r = (h * h + k * k).sqrt();
    // a - b = atan2(g, e), a + b = atan2(k, h); with r = 0 any angle will do.
    let (cd, sd) = (e / q, g / q);
    let (cs, ss) = if r > 0.0 { (h / r, k / r) } else { (1.0, 0.0) };
    let left = half_angle(cs * cd - ss * sd, ss * cd + cs * sd);
    // b = (a + b) - a keeps the two half angles on matching branches.
    let right = [cs * left[0] + ss * left[1], ss * left[0] - cs * left[1]];
    let s1 = q + r;
    Some(InPlane { s: [s1, det / s1], left, right })
}

/// Cosine and sine of half the angle whose cosine and sine are given.
fn half_angle(c: f64, s: f64) -> [f64; 2] {
    if c >= 0.0 {
        let ch = (0.5 * (1.0 + c)).sqrt();
        [ch, 0.5 * s / ch]
    } else {
        let sh = (0.5 * (1.0 - c)).sqrt().copysign(s);
        [0.5 * s / sh, sh]
    }
}

/// Relative difference of two stretches below which the divided difference of
/// their stresses is replaced by its limit. Both errors are about 1e-10 there:
/// rounding 1e-16 / 1e-5 on one side, truncation (1e-5)^2 on the other.
const EQUAL_STRETCH: f64 = 1e-5;

/// Energy and stress only. `None` when `F` does not preserve orientation.
pub fn first_piola(law: &impl Law, f: &Gradient) -> Option<(f64, [f64; 5])> {
    let d = decompose(f)?;
    let (energy, p) = law.stress([d.s[0], d.s[1], f[4]]);
    Some((energy, rotate_back(&d, p)))
}

/// `P = R(a) diag(p) R(b)^T` plus the hoop component.
fn rotate_back(d: &InPlane, p: [f64; 3]) -> [f64; 5] {
    let ([ca, sa], [cb, sb]) = (d.left, d.right);
    [
        ca * p[0] * cb + sa * p[1] * sb,
        ca * p[0] * sb - sa * p[1] * cb,
        sa * p[0] * cb - ca * p[1] * sb,
        sa * p[0] * sb + ca * p[1] * cb,
        p[2],
    ]
}

/// Energy and stress with their derivative by the parameter that law and gradient carry.
///
/// In the principal frame the normal components of `dF` change the stretches, so that the
/// law itself gives their part; the two shear components turn the frame, see [`respond`].
/// Equal stretches need no division: there the limit is taken.
pub fn first_piola_dual(law: &impl Law<Dual>, f: &[Dual; 5]) -> Option<(Dual, [Dual; 5])> {
    let d = decompose(&f.map(Real::value))?;
    let ([ca, sa], [cb, sb]) = (d.left, d.right);
    let df = f.map(Real::derivative);
    // R(a)^T dF R(b)
    let rows = [[ca * df[0] + sa * df[2], ca * df[1] + sa * df[3]], [ca * df[2] - sa * df[0], ca * df[3] - sa * df[1]]];
    let turned = rows.map(|r| [r[0] * cb + r[1] * sb, r[1] * cb - r[0] * sb]);
    let (energy, p) = law.stress([Dual::new(d.s[0], turned[0][0]), Dual::new(d.s[1], turned[1][1]), f[4]]);
    let (sum, difference) = (d.s[0] + d.s[1], d.s[0] - d.s[1]);
    let x = if difference > EQUAL_STRETCH * sum {
        (p[0].value - p[1].value) / difference
    } else {
        // along (1, -1): U_11 - 2 U_12 + U_22, less what the parameter itself does
        let along = |s: f64| law.stress([Dual::new(d.s[0], s), Dual::new(d.s[1], -s), Dual::from(f[4].value)]).1;
        let (moved, still) = (along(1.0), along(0.0));
        0.5 * (moved[0].derivative - still[0].derivative - moved[1].derivative + still[1].derivative)
    };
    let y = (p[0].value + p[1].value) / sum;
    let (same, crossed) = (0.5 * (x + y), 0.5 * (x - y));
    let slope = [
        p[0].derivative,
        same * turned[0][1] + crossed * turned[1][0],
        crossed * turned[0][1] + same * turned[1][0],
        p[1].derivative,
    ];
    // R(a) slope R(b)^T
    let back = [
        [ca * slope[0] - sa * slope[2], ca * slope[1] - sa * slope[3]],
        [sa * slope[0] + ca * slope[2], sa * slope[1] + ca * slope[3]],
    ];
    let rate = back.map(|r| [r[0] * cb - r[1] * sb, r[0] * sb + r[1] * cb]);
    let value = rotate_back(&d, p.map(Real::value));
    let rate = [rate[0][0], rate[0][1], rate[1][0], rate[1][1], p[2].derivative];
    Some((energy, std::array::from_fn(|i| Dual::new(value[i], rate[i]))))
}

/// Energy, stress and exact tangent. `None` when `F` does not preserve orientation.
///
/// In the principal frame the normal components couple by `d2U/dl_i dl_j`, the
/// two shear components by (Ogden, Non-linear Elastic Deformations, 6.1.4)
/// `A_1212 = (x + y) / 2`, `A_1221 = (x - y) / 2` with
/// `x = (p1 - p2) / (s1 - s2)` and `y = (p1 + p2) / (s1 + s2)`;
/// for equal stretches `x` tends to `U_11 - U_12`.
pub fn respond(law: &impl Tangent, f: &Gradient) -> Option<Response> {
    let d = decompose(f)?;
    let u = law.principal([d.s[0], d.s[1], f[4]]);
    let (p, h) = (u.stress, u.tangent);
    let (sum, difference) = (d.s[0] + d.s[1], d.s[0] - d.s[1]);
    let x =
        if difference > EQUAL_STRETCH * sum { (p[0] - p[1]) / difference } else { 0.5 * (h[0][0] + h[1][1]) - h[0][1] };
    let y = (p[0] + p[1]) / sum;
    let (same, crossed) = (0.5 * (x + y), 0.5 * (x - y));

    let ([ca, sa], [cb, sb]) = (d.left, d.right);
    // Modes of the principal frame (n1 n1', n2 n2', n1 n2', n2 n1') in [rr, rz, zr, zz].
    let m11 = [ca * cb, ca * sb, sa * cb, sa * sb];
    let m22 = [sa * sb, -sa * cb, -ca * sb, ca * cb];
    let m12 = [-ca * sb, ca * cb, -sa * sb, sa * cb];
    let m21 = [-sa * cb, -sa * sb, ca * cb, ca * sb];
    let mut tangent = [[0.0; 5]; 5];
    for i in 0..4 {
        let a11 = h[0][0] * m11[i] + h[0][1] * m22[i];
        let a22 = h[0][1] * m11[i] + h[1][1] * m22[i];
        let a12 = same * m12[i] + crossed * m21[i];
        let a21 = crossed * m12[i] + same * m21[i];
        for j in 0..4 {
            tangent[i][j] = a11 * m11[j] + a22 * m22[j] + a12 * m12[j] + a21 * m21[j];
        }
        let hoop = h[0][2] * m11[i] + h[1][2] * m22[i];
        tangent[i][4] = hoop;
        tangent[4][i] = hoop;
    }
    tangent[4][4] = h[2][2];
    Some(Response { energy: u.energy, stress: rotate_back(&d, p), tangent })
}
