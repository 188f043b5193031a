//! Between first and second Piola-Kirchhoff stress of an axisymmetric gradient.

use super::gradient::{Gradient, Response};
use crate::scalar::Real;

/// `F^-1` in the order `[rr, rz, zr, zz, tt]`.
fn inverse<T: Real>(f: &[T; 5]) -> [T; 5] {
    let det = f[0] * f[3] - f[1] * f[2];
    [f[3] / det, -f[1] / det, -f[2] / det, f[0] / det, T::from(1.0) / f[4]]
}

/// `S = F^-1 P` as `[rr, zz, rz, tt]`, split into the parts that belong to the deviator and
/// to the pressure of the Kirchhoff stress `P F^T`: the second is `tr(P F^T)/3 C^-1`.
pub fn split<T: Real>(f: &[T; 5], p: &[T; 5]) -> ([T; 4], [T; 4]) {
    let i = inverse(f);
    let s = [i[0] * p[0] + i[1] * p[2], i[2] * p[1] + i[3] * p[3], i[0] * p[1] + i[1] * p[3], i[4] * p[4]];
    let third = (p[0] * f[0] + p[1] * f[1] + p[2] * f[2] + p[3] * f[3] + p[4] * f[4]) / 3.0;
    let inverse_c = [i[0] * i[0] + i[1] * i[1], i[2] * i[2] + i[3] * i[3], i[0] * i[2] + i[1] * i[3], i[4] * i[4]];
    let sphere = inverse_c.map(|x| x * third);
    (std::array::from_fn(|c| s[c] - sphere[c]), sphere)
}

/// `P = F S`.
pub fn push<T: Real>(f: &[T; 5], s: &[T; 4]) -> [T; 5] {
    [
        f[0] * s[0] + f[1] * s[2],
        f[0] * s[2] + f[1] * s[1],
        f[2] * s[0] + f[3] * s[2],
        f[2] * s[2] + f[3] * s[1],
        f[4] * s[3],
    ]
}

/// Row and column of each component of a gradient; the hoop is the third direction.
const PLACE: [(usize, usize); 5] = [(0, 0), (0, 1), (1, 0), (1, 1), (2, 2)];

/// Adds `dP/dF` of `P = F S` at fixed `S`: `dP_iJ / dF_iL = S_LJ`.
pub fn add_geometric(tangent: &mut [[f64; 5]; 5], s: &[f64; 4]) {
    let at = |l: usize, j: usize| match (l, j) {
        (0, 0) => s[0],
        (1, 1) => s[1],
        (2, 2) => s[3],
        _ => s[2],
    };
    for (a, &(i, j)) in PLACE.iter().enumerate() {
        for (b, &(k, l)) in PLACE.iter().enumerate() {
            if i == k {
                tangent[a][b] += at(l, j);
            }
        }
    }
}

/// `d/dF` of the pressure part `p F^-T`, `p = P : F / 3`, of an elastic response:
/// `F^-T (x) dp/dF + p d(F^-T)/dF` with `d(F^-T)_iJ / dF_kL = -F^-1_Li F^-1_Jk`.
pub fn spherical_tangent(f: &Gradient, r: &Response) -> [[f64; 5]; 5] {
    let inv = inverse(f);
    let i3 = [[inv[0], inv[1], 0.0], [inv[2], inv[3], 0.0], [0.0, 0.0, inv[4]]];
    let p: f64 = r.stress.iter().zip(f).map(|(p, f)| p * f).sum::<f64>() / 3.0;
    std::array::from_fn(|a| {
        let (i, j) = PLACE[a];
        std::array::from_fn(|b| {
            let (k, l) = PLACE[b];
            let slope = (r.stress[b] + (0..5).map(|c| f[c] * r.tangent[c][b]).sum::<f64>()) / 3.0;
            i3[j][i] * slope - p * i3[l][i] * i3[j][k]
        })
    })
}
