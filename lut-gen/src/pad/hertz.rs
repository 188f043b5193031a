//! The fingertip as an elastic sphere: the thesis' chapter 5, the rival of the finger.

/// A body in Hertz' contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Elastic {
    /// Young's modulus (MPa); infinite for a rigid body.
    pub young_mpa: f64,
    /// Poisson's ratio.
    pub nu: f64,
}

/// Any rigid body.
pub const RIGID: Elastic = Elastic { young_mpa: f64::INFINITY, nu: 0.0 };

/// A sphere against a flat body, without friction (thesis Eqs. 50-52).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sphere {
    /// Its radius (mm).
    pub radius_mm: f64,
    /// What it is made of.
    pub of: Elastic,
}

/// The fingertip of chapter 5: 5 mm, 126.2 kPa, incompressible.
pub const FINGERTIP: Sphere = Sphere { radius_mm: 5.0, of: Elastic { young_mpa: 0.1262, nu: 0.5 } };

impl Sphere {
    /// Modulus `E*` of the contact (MPa): `1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2` (Eq. 52, whose
    /// second line prints nu1 twice).
    #[must_use]
    pub fn modulus_mpa(&self, on: Elastic) -> f64 {
        let soft = |body: Elastic| (1.0 - body.nu * body.nu) / body.young_mpa;
        1.0 / (soft(self.of) + soft(on))
    }

    /// Radius of the contact under a force (mm): `a^3 = 3 F R / (4 E*)`.
    #[must_use]
    pub fn radius_mm(&self, on: Elastic, force_n: f64) -> f64 {
        (0.75 * force_n.max(0.0) * self.radius_mm / self.modulus_mpa(on)).cbrt()
    }

    /// How far the bodies approach each other under a force (mm): `a^2 / R`.
    #[must_use]
    pub fn travel_mm(&self, on: Elastic, force_n: f64) -> f64 {
        self.radius_mm(on, force_n).powi(2) / self.radius_mm
    }

    /// Force at an approach (N): `4/3 E* sqrt(R) d^1.5`.
    #[must_use]
    pub fn force_n(&self, on: Elastic, travel_mm: f64) -> f64 {
        4.0 / 3.0 * self.modulus_mpa(on) * self.radius_mm.sqrt() * travel_mm.max(0.0).powf(1.5)
    }
}
