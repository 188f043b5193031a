//! Magneto-rheological fluid MRF-122-2ED, taken as a hydrocarbon fluid of 22 % iron by volume (assumption).
//!
//! Carlson's fits to LORD fluids: `tau_y = C 271700 phi^1.5239 tanh(6.33e-6 H)` Pa and
//! `B = 1.91 phi^1.133 (1 - exp(-10.97 mu0 H)) + mu0 H` T, H in A/m, C = 1 for hydrocarbon oil.

use core::f32::consts::PI;

/// Permeability of free space, T m/A.
const MU0: f32 = 4.0e-7 * PI;

/// Volume fraction of iron.
pub const IRON_FRACTION: f32 = 0.22;

/// Yield stress in saturation, Pa: `271700 * 0.22^1.5239`.
const SATURATION_PA: f32 = 27_040.2;

/// Flux density the iron adds in saturation, T: `1.91 * 0.22^1.133`.
const SATURATION_T: f32 = 0.343_549;

/// Highest fraction of the saturation stress that is asked for: beyond it the field rises without use.
const SATURATION_MARGIN: f32 = 0.98;

/// Mean contact stress over shear yield stress of a material that flows under an indenter: 3 (Tabor 1951, The Hardness of
/// Metals: fully plastic mean pressure = 3 times the uniaxial yield stress) times sqrt 3 (von Mises: uniaxial over
/// shear). Assumption, to be replaced by the finger-pad model.
pub const STRESS_OVER_YIELD: f32 = 5.196_152;

/// Shear yield stress, Pa, at which the fluid flows under a mean contact stress in MPa; at most 98 % of saturation.
pub fn yield_stress_pa_for(mean_stress_mpa: f32) -> f32 {
    let yield_pa = mean_stress_mpa * 1.0e6 / STRESS_OVER_YIELD;
    crate::number::limit(yield_pa, 0.0, SATURATION_MARGIN * SATURATION_PA)
}

/// Yield stress, Pa, at a field in A/m.
pub fn yield_stress_pa(field_a_per_m: f32) -> f32 {
    SATURATION_PA * libm::tanhf(6.33e-6 * field_a_per_m)
}

/// Field, A/m, for a yield stress in Pa below saturation; the inverse of [`yield_stress_pa`].
pub fn field_a_per_m(yield_stress_pa: f32) -> f32 {
    libm::atanhf(yield_stress_pa / SATURATION_PA) / 6.33e-6
}

/// Flux density in the fluid, T, at a field in A/m.
pub fn flux_density_t(field_a_per_m: f32) -> f32 {
    let b0 = MU0 * field_a_per_m;
    SATURATION_T * (1.0 - libm::expf(-10.97 * b0)) + b0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn published_points_of_the_fit() {
        // Computed values for 122EG, C = 1 (three digits printed: half a unit of the last).
        for (ka_per_m, kpa, tesla) in
            [(50.0, 8.3, 0.234), (100.0, 15.1, 0.383), (150.0, 20.0, 0.489), (200.0, 23.1, 0.573)]
        {
            let h = ka_per_m * 1e3;
            assert!((yield_stress_pa(h) / 1e3 - kpa).abs() < 0.051, "{ka_per_m}");
            assert!((flux_density_t(h) - tesla).abs() < 0.000_6, "{ka_per_m}");
            // Round trip within f32 of tanh near 1.
            assert!((field_a_per_m(yield_stress_pa(h)) / h - 1.0).abs() < 1e-5);
        }
        let exact = 271_700.0 * f64::from(IRON_FRACTION).powf(1.5239);
        assert!((f64::from(SATURATION_PA) / exact - 1.0).abs() < 1e-4, "{exact}");
        let exact = 1.91 * f64::from(IRON_FRACTION).powf(1.133);
        assert!((f64::from(SATURATION_T) / exact - 1.0).abs() < 1e-4, "{exact}");
    }

    #[test]
    fn demand_beyond_saturation_stays_finite() {
        let h = field_a_per_m(yield_stress_pa_for(1.0));
        assert!(h.is_finite() && h < 400e3, "{h}");
        assert_eq!(yield_stress_pa_for(f32::NAN), 0.0);
    }
}
