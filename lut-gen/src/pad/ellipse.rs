//! Prints with two radii from a press about an axis: the thesis' correction (section 4.1.2).
//!
//! Fingerprints are ellipses with radii `a` and `b = k a`; a press about an axis has circles of
//! radius `a`. On a plate the print grows by `k` (Eqs. 28-30). On a soft body the contact is taken
//! for a cap of a sphere, `r = A / (2 pi c)` with its area `A` and height `c` (Eq. 31), and then
//! for the cap of an ellipsoid with radii `r, k r, r` and the same height (Eqs. 33-38).

use std::f64::consts::{PI, TAU};

use super::error::{PadError, demand};
use crate::fem::quadrature::gauss;

/// Angles round the axis: their rule converges like a geometric series, by a factor of at least 0.5
/// an angle for ratios up to 3.
const ROUND: usize = 128;
/// Parts of the way from the tip to the edge, with five points each.
const PARTS: usize = 8;

/// Area of the cap of an ellipsoid with radii `r1, r2, r3` (mm) and height `cap_mm` along the third
/// (mm2): thesis Eq. 36, whose print mixes its radii up, as it must be,
///
/// ```text
/// dA = sin v sqrt( r3^2 sin^2 v (r2^2 cos^2 u + r1^2 sin^2 u) + r1^2 r2^2 cos^2 v ) du dv
/// 0 < u < 2 pi,   0 < v < arccos(1 - c / r3)
/// ```
///
/// # Errors
/// [`PadError::Value`] for a radius that is not positive, or a height outside 0 to `2 r3`.
pub fn cap_area_mm2([r1, r2, r3]: [f64; 3], cap_mm: f64) -> Result<f64, PadError> {
    for radius in [r1, r2, r3] {
        demand(radius > 0.0 && radius.is_finite(), "an ellipsoid's radius (mm)", radius, "more than 0")?;
    }
    demand((0.0..=2.0 * r3).contains(&cap_mm), "a cap's height (mm)", cap_mm, "0 to twice the third radius")?;
    let end = (1.0 - cap_mm / r3).acos();
    let (half, mut area) = (0.5 * end / PARTS as f64, 0.0);
    for part in 0..PARTS {
        let middle = end * (part as f64 + 0.5) / PARTS as f64;
        for (at, weight) in gauss(5) {
            let (sin_v, cos_v) = (middle + half * at).sin_cos();
            let around: f64 = (0..ROUND)
                .map(|i| {
                    let (sin_u, cos_u) = (TAU * i as f64 / ROUND as f64).sin_cos();
                    let across = (r2 * cos_u).powi(2) + (r1 * sin_u).powi(2);
                    ((r3 * sin_v).powi(2) * across + (r1 * r2 * cos_v).powi(2)).sqrt()
                })
                .sum();
            area += half * weight * sin_v * around * TAU / ROUND as f64;
        }
    }
    Ok(area)
}

/// A contact with two radii.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Print {
    /// Radii of its flat print (mm).
    pub radii_mm: [f64; 2],
    /// Area of its flat print (mm2): Eq. 30.
    pub flat_mm2: f64,
    /// Area of the curved contact (mm2): Eq. 36.
    pub area_mm2: f64,
}

/// Caps lower than this part of their radius are flat.
const FLAT: f64 = 1e-6;

impl Print {
    /// Of a round contact of this radius, curved area and cap height, with the ratio `k` of its
    /// radii.
    ///
    /// # Errors
    /// [`PadError::Value`] for a ratio outside 0.2 to 5, or a cap that is none.
    pub fn of(radius_mm: f64, area_mm2: f64, cap_mm: f64, ratio: f64) -> Result<Self, PadError> {
        demand((0.2..=5.0).contains(&ratio), "the ratio of a print's radii", ratio, "0.2 to 5")?;
        let radii_mm = [radius_mm, ratio * radius_mm];
        let flat_mm2 = PI * radii_mm[0] * radii_mm[1];
        let curved = if cap_mm > FLAT * radius_mm {
            let r = area_mm2 / (TAU * cap_mm);
            cap_area_mm2([r, ratio * r, r], cap_mm)?
        } else {
            ratio * area_mm2
        };
        Ok(Self { radii_mm, flat_mm2, area_mm2: curved })
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    /// `2 pi r c`; the rule leaves 1e-10.
    #[test]
    fn a_cap_of_a_sphere_has_its_area() {
        for cap in [0.01, 1.0, 5.0, 10.0] {
            let part = cap_area_mm2([5.0; 3], cap).unwrap() / (TAU * 5.0 * cap) - 1.0;
            assert!(part.abs() < 1e-10, "{cap}: {part:e}");
        }
    }

    /// Spheroid of radii 8, 8, 4: `2 pi a^2 (1 + (1 - e^2) / e artanh e)` with `e^2 = 1 - c^2/a^2`.
    #[test]
    fn a_whole_spheroid_has_its_area() {
        let e = 0.75_f64.sqrt();
        let closed = TAU * 64.0 * (1.0 + 0.25 / e * e.atanh());
        assert!((cap_area_mm2([8.0, 8.0, 4.0], 8.0).unwrap() / closed - 1.0).abs() < 1e-8);
        let turned = cap_area_mm2([8.0, 4.0, 8.0], 16.0).unwrap();
        assert!((turned / closed - 1.0).abs() < 1e-8, "{turned} {closed}");
    }

    #[test]
    fn a_round_print_stays_as_it_is() {
        let round = Print::of(3.0, 30.0, 0.5, 1.0).unwrap();
        assert!((round.area_mm2 - 30.0).abs() < 1e-8 && (round.flat_mm2 - 9.0 * PI).abs() < 1e-12);
        let flat = Print::of(3.0, 9.0 * PI, 0.0, 1.4).unwrap();
        assert!((flat.area_mm2 - flat.flat_mm2).abs() < 1e-12 && flat.radii_mm[1] == 1.4 * 3.0);
    }

    #[test]
    fn what_is_no_cap_is_refused() {
        let text = cap_area_mm2([5.0; 3], 11.0).unwrap_err().to_string();
        assert_eq!(text, "a cap's height (mm) is 11: expected 0 to twice the third radius");
        let text = Print::of(3.0, 30.0, 0.5, 9.0).unwrap_err().to_string();
        assert_eq!(text, "the ratio of a print's radii is 9: expected 0.2 to 5");
    }
}
