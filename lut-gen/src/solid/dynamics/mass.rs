//! Lumped mass of an eight-node ring element.

use super::element::jacobian;
use crate::fem::quadrature::gauss;
use crate::fem::shape::quad8;

/// Masses of the eight nodes (t, that is N s^2/mm) of an element with reference positions `x` (mm) and
/// `density` (t/mm^3).
///
/// The row sums of a serendipity element's mass matrix are negative at the corners. Its diagonal,
/// scaled to keep the mass of the element, is positive for every shape (Hinton, Rock, Zienkiewicz 1976,
/// doi:10.1002/eqe.4290040305): `m_a = M integral N_a^2 dV / sum_b integral N_b^2 dV`. Nodes on the
/// axis get mass too, from the part of the ring their shape functions reach.
#[must_use]
pub fn lumped_mass(x: &[[f64; 2]; 8], density: f64) -> [f64; 8] {
    let rule = gauss(3);
    let (mut volume, mut square) = (0.0, [0.0; 8]);
    for &(a, wa) in &rule {
        for &(b, wb) in &rule {
            let (shape, slope) = quad8(a, b);
            let (j, radius) = jacobian(&shape, &slope, x);
            let dv = std::f64::consts::TAU * radius * (j[0][0] * j[1][1] - j[0][1] * j[1][0]) * wa * wb;
            volume += dv;
            for (s, n) in square.iter_mut().zip(shape) {
                *s += n * n * dv;
            }
        }
    }
    let sum: f64 = square.iter().sum();
    square.map(|s| density * volume * s / sum)
}
