//! Fingertip as an elastic sphere on a flat elastic material (Hertz; thesis Eqs. 47-52).

use core::f32::consts::PI;

/// Radius of the fingertip, mm (thesis section 5.3).
pub const RADIUS_MM: f32 = 5.0;
/// Young's modulus of the fingertip, MPa (thesis section 5.3: 126.2 kPa).
pub const YOUNG_MPA: f32 = 0.1262;
/// Poisson's ratio of the fingertip (thesis section 5.3).
pub const POISSON: f32 = 0.5;

/// Combined modulus `E*`, MPa, of fingertip and a flat material: `1/E* = (1-nu1^2)/E1 + (1-nu2^2)/E2` (Eq. 49; ERRATA row
/// Eq. 52). Foams: nu2 = 0. An infinite `material_mpa` is the rigid shaft.
pub fn combined_modulus_mpa(material_mpa: f32) -> f32 {
    1.0 / ((1.0 - POISSON * POISSON) / YOUNG_MPA + 1.0 / material_mpa)
}

/// Radius of the contact area, mm: `a^3 = 3 F R / (4 E*)` (Eq. 50), at most the fingertip's own radius, where
/// Hertz ends; 0 without force.
pub fn contact_radius_mm(force_n: f32, material_mpa: f32) -> f32 {
    let cube = 0.75 * force_n * RADIUS_MM / combined_modulus_mpa(material_mpa);
    if !(cube > 0.0) {
        return 0.0;
    }
    let a = libm::cbrtf(cube);
    if a < RADIUS_MM { a } else { RADIUS_MM }
}

/// Indentation of the fingertip, mm: `d = a^2 / R` with the unlimited radius (Eq. 51); 0 without force.
pub fn indentation_mm(force_n: f32, material_mpa: f32) -> f32 {
    let cube = 0.75 * force_n * RADIUS_MM / combined_modulus_mpa(material_mpa);
    if !(cube > 0.0) {
        return 0.0;
    }
    let a = libm::cbrtf(cube);
    a * a / RADIUS_MM
}

/// Mean normal stress over the contact area, MPa; 0 without force.
pub fn mean_stress_mpa(force_n: f32, material_mpa: f32) -> f32 {
    let a = contact_radius_mm(force_n, material_mpa);
    if a > 0.0 { force_n / (PI * a * a) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn section_5_3_force_at_five_millimetres() {
        // ERRATA row Sec. 5.3: 5.61 N gives d = 5 mm on a rigid shaft (three digits: 0.1 % of force, 0.07 % of depth).
        let d = indentation_mm(5.61, f32::INFINITY);
        assert!((d - 5.0).abs() < 5e-3, "{d}");
    }

    #[test]
    fn softer_material_gives_a_larger_area_and_area_is_limited() {
        assert!(contact_radius_mm(0.2, 0.1) > contact_radius_mm(0.2, 1.0));
        assert_eq!(contact_radius_mm(100.0, 0.1), RADIUS_MM);
        assert_eq!(mean_stress_mpa(0.0, 0.1), 0.0);
        assert_eq!(mean_stress_mpa(f32::NAN, 0.1), 0.0);
    }
}
