//! The thesis' correction for the finger's pulp (Eqs. 50 to 52; ERRATA: the second line of Eq. 52 means `nu_2`).
//!
//! The finger is a sphere by Hertz. On the soft material both give way, on the cap only the finger does. The difference is added
//! to what the shaft gives way. Beyond the force at which the sphere would be pressed in by its own radius the thesis goes back to
//! the compression itself, with a step; so does this.

/// Radius of the finger's tip, mm (thesis section 5.3).
pub const RADIUS_MM: f64 = 5.0;
/// Young's modulus of the pulp, kPa (thesis section 5.3).
pub const PULP_KPA: f64 = 126.2;
/// Poisson's ratio of the pulp (thesis section 5.3).
pub const PULP_NU: f64 = 0.5;
/// Force from which on the correction is left out, N (thesis section 5.3).
pub const SWITCH_N: f64 = 5.63;

/// The displayed material as the other body of Hertz' contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sphere {
    /// Young's modulus of the material, kPa.
    pub modulus_kpa: f64,
    /// Its Poisson's ratio.
    pub nu: f64,
}

/// Depth of a sphere, mm, at a force, N, and an effective modulus, kPa (Eq. 51).
fn depth_mm(force_n: f64, effective_kpa: f64) -> f64 {
    (3.0 * force_n / (4e-3 * effective_kpa * RADIUS_MM.sqrt())).powf(2.0 / 3.0)
}

impl Sphere {
    /// What the finger and the material give way beyond what the finger does on the cap, mm; 0 from [`SWITCH_N`] on.
    pub fn extra_mm(&self, force_n: f64) -> f64 {
        if !(force_n > 0.0 && force_n < SWITCH_N) {
            return 0.0;
        }
        let own = (1.0 - PULP_NU * PULP_NU) / PULP_KPA;
        let both = own + (1.0 - self.nu * self.nu) / self.modulus_kpa;
        depth_mm(force_n, 1.0 / both) - depth_mm(force_n, 1.0 / own)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The thesis says that the deformation is 5 mm at 5.63 N: Eq. 51 with its numbers says the same of the finger on the cap,
    /// and it is where the switch comes from.
    #[test]
    fn the_switch_is_where_the_sphere_is_pressed_in_by_its_radius() {
        let own_kpa = PULP_KPA / (1.0 - PULP_NU * PULP_NU);
        assert!((depth_mm(SWITCH_N, own_kpa) - RADIUS_MM).abs() < 0.01 * RADIUS_MM, "{}", depth_mm(SWITCH_N, own_kpa));
    }

    #[test]
    fn a_softer_material_wants_more_and_a_rigid_one_nothing() {
        let of = |kpa: f64| Sphere { modulus_kpa: kpa, nu: 0.0 }.extra_mm(2.0);
        assert!(of(50.0) > of(100.0) && of(100.0) > of(1000.0));
        assert!(of(1e9) < 1e-6);
        assert_eq!(Sphere { modulus_kpa: 50.0, nu: 0.0 }.extra_mm(SWITCH_N), 0.0);
    }
}
