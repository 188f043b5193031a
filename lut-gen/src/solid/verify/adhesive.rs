//! Adhesion of a rigid sphere and an elastic half-space: the limits and what lies between.

use std::f64::consts::PI;

/// One state of an adhesive contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Adhered {
    /// Radius in contact (mm).
    pub contact_radius_mm: f64,
    /// Force on the sphere (N), negative when it is pulled.
    pub force_n: f64,
    /// Depth of the sphere (mm), negative above the undeformed surface.
    pub depth_mm: f64,
}

/// A sphere on a half-space: `E*` (MPa), work of adhesion (N/mm), radius (mm), all positive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AdhesiveContact {
    /// `E* = E / (1 - nu^2)` (MPa).
    pub plane_modulus_mpa: f64,
    /// Work of adhesion `w` (N/mm).
    pub work_n_per_mm: f64,
    /// Radius of the sphere `R` (mm).
    pub radius_mm: f64,
}

impl AdhesiveContact {
    /// State of JKR's contact at a radius in contact (mm): no range of attraction
    /// (Johnson, Kendall and Roberts 1971, doi:10.1098/rspa.1971.0141):
    /// `F = 4 E* a^3 / (3 R) - sqrt(8 pi w E* a^3)`, `d = a^2 / R - sqrt(2 pi w a / E*)`.
    #[must_use]
    pub fn jkr(&self, contact_radius_mm: f64) -> Adhered {
        let Self { plane_modulus_mpa: e, work_n_per_mm: w, radius_mm: r } = *self;
        let a = contact_radius_mm;
        Adhered {
            contact_radius_mm: a,
            force_n: 4.0 * e * a.powi(3) / (3.0 * r) - (8.0 * PI * w * e * a.powi(3)).sqrt(),
            depth_mm: a * a / r - (2.0 * PI * w * a / e).sqrt(),
        }
    }

    /// Least force of JKR's contact (N), `-3/2 pi w R`.
    #[must_use]
    pub fn jkr_pull_off_n(&self) -> f64 {
        -1.5 * PI * self.work_n_per_mm * self.radius_mm
    }

    /// Least force of a rigid contact (N), `-2 pi w R`
    /// (Derjaguin, Muller and Toporov 1975, doi:10.1016/0021-9797(75)90018-1).
    #[must_use]
    pub fn dmt_pull_off_n(&self) -> f64 {
        -2.0 * PI * self.work_n_per_mm * self.radius_mm
    }

    /// Maugis' parameter `lambda = 2 s (R / (pi w K^2))^(1/3)`, `K = 4/3 E*`, of an attraction whose
    /// largest traction is `s` (MPa): JKR far above 1, DMT far below.
    #[must_use]
    pub fn maugis_parameter(&self, largest_traction_mpa: f64) -> f64 {
        let k = 4.0 / 3.0 * self.plane_modulus_mpa;
        2.0 * largest_traction_mpa * (self.radius_mm / (PI * self.work_n_per_mm * k * k)).cbrt()
    }

    /// State of Maugis' contact, attracted by a constant traction in the ring between the contact's
    /// radius `a` and `m a`, `m > 1` (Maugis 1992, doi:10.1016/0021-9797(92)90285-T, in the form of
    /// Johnson and Greenwood 1997, doi:10.1006/jcis.1997.4984). Every `m` is one state.
    #[must_use]
    pub fn maugis(&self, lambda: f64, m: f64) -> Adhered {
        let Self { plane_modulus_mpa, work_n_per_mm: w, radius_mm: r } = *self;
        let k = 4.0 / 3.0 * plane_modulus_mpa;
        let (root, angle) = ((m * m - 1.0).sqrt(), (1.0 / m).acos());
        // the energy spent to open the gap at the ring's edge is w: square * A^2 + linear * A = 1
        let square = 0.5 * lambda * (root + (m * m - 2.0) * angle);
        let linear = 4.0 / 3.0 * lambda * lambda * (1.0 - m + root * angle);
        let a = 2.0 / (linear + (linear * linear + 4.0 * square).sqrt());
        Adhered {
            contact_radius_mm: a * (PI * w * r * r / k).cbrt(),
            force_n: PI * w * r * (a.powi(3) - lambda * a * a * (root + m * m * angle)),
            depth_mm: (PI * PI * w * w * r / (k * k)).cbrt() * (a * a - 4.0 / 3.0 * lambda * a * root),
        }
    }
}
