//! The thesis' correction for the finger's pulp (Eqs. 50 to 52).
//!
//! The finger is a sphere by Hertz ([`lut_gen::pad::hertz`]). On the soft material both give way, on the cap only the finger does.
//! The difference is added to what the shaft gives way. Beyond the force at which the sphere would be pressed in by its own radius
//! the thesis goes back to the compression itself, with a step; so does this.

use lut_gen::pad::hertz::{Elastic, FINGERTIP, RIGID};

/// Force from which on the correction is left out, N (thesis section 5.3).
pub const SWITCH_N: f64 = 5.63;

/// What the finger and the material give way beyond what the finger does on the cap, mm; 0 from [`SWITCH_N`] on.
pub fn extra_mm(material: Elastic, force_n: f64) -> f64 {
    if !(force_n > 0.0 && force_n < SWITCH_N) {
        return 0.0;
    }
    FINGERTIP.travel_mm(material, force_n) - FINGERTIP.travel_mm(RIGID, force_n)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The thesis says that the deformation is 5 mm at 5.63 N: Eq. 51 with its numbers says the same of the finger on the cap,
    /// and it is where the switch comes from.
    #[test]
    fn the_switch_is_where_the_sphere_is_pressed_in_by_its_radius() {
        let depth_mm = FINGERTIP.travel_mm(RIGID, SWITCH_N);
        assert!((depth_mm - FINGERTIP.radius_mm).abs() < 0.01 * FINGERTIP.radius_mm, "{depth_mm}");
    }

    #[test]
    fn a_softer_material_wants_more_and_a_rigid_one_nothing() {
        let of = |kpa: f64| extra_mm(Elastic { young_mpa: 1e-3 * kpa, nu: 0.0 }, 2.0);
        assert!(of(50.0) > of(100.0) && of(100.0) > of(1000.0));
        assert!(of(1e9) < 1e-6);
        assert_eq!(extra_mm(Elastic { young_mpa: 0.05, nu: 0.0 }, SWITCH_N), 0.0);
    }
}
