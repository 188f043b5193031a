//! How hot the winding is: one heat capacity, one resistance to the surroundings.

use crate::coil::regulator::CoilCircuit;

/// Thermal model of the winding and its limits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ThermalConfig {
    /// Heat capacity, J/K: 61 m of 28 AWG copper weigh 44 g, at 0.385 J/(g K).
    pub capacity_j_per_k: f32,
    /// Resistance to the surroundings, K/W (assumed; the core is left out, which errs to the hot side).
    pub resistance_k_per_w: f32,
    /// Surroundings, degrees Celsius.
    pub ambient_c: f32,
    /// Resistance of the winding at 20 degrees Celsius, ohm.
    pub winding_ohm: f32,
    /// Above this the current is reduced, degrees Celsius.
    pub derate_c: f32,
    /// At this the coil is switched off as a fault, degrees Celsius (enamel of class 130).
    pub trip_c: f32,
}

impl Default for ThermalConfig {
    fn default() -> Self {
        ThermalConfig {
            capacity_j_per_k: 17.0,
            resistance_k_per_w: 5.0,
            ambient_c: 25.0,
            winding_ohm: 13.0,
            derate_c: 80.0,
            trip_c: 105.0,
        }
    }
}

/// Temperature coefficient of copper, 1/K.
const COPPER_PER_K: f32 = 0.003_93;

/// Resistance of the winding at a temperature, ohm.
pub fn winding_ohm(config: &ThermalConfig, coil_c: f32) -> f32 {
    config.winding_ohm * (1.0 + COPPER_PER_K * (coil_c - 20.0))
}

/// Current that a duty gives in the winding at a temperature, A.
pub fn driven_a(config: &ThermalConfig, circuit: &CoilCircuit, duty: f32, coil_c: f32) -> f32 {
    duty * circuit.supply_v / winding_ohm(config, coil_c)
}

/// Temperature after a step of `period_s` with `current_a`, degrees Celsius.
pub fn step_c(config: &ThermalConfig, coil_c: f32, current_a: f32, period_s: f32) -> f32 {
    let heating_w = current_a * current_a * winding_ohm(config, coil_c);
    let cooling_w = (coil_c - config.ambient_c) / config.resistance_k_per_w;
    coil_c + (heating_w - cooling_w) * period_s / config.capacity_j_per_k
}

/// Fraction of the current limit that may be used: 1 up to `derate_c`, 0 at `trip_c`; 0 for NaN.
pub fn allowed_fraction(config: &ThermalConfig, coil_c: f32) -> f32 {
    crate::number::limit((config.trip_c - coil_c) / (config.trip_c - config.derate_c), 0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn heating_starts_at_power_over_capacity_and_settles_at_power_times_resistance() {
        let config = ThermalConfig::default();
        // 1 A in 13.26 ohm at 25 degrees: 13.26 W / 17 J/K = 0.78 K/s.
        let after = step_c(&config, 25.0, 1.0, 1.0);
        assert!((after - 25.0 - 0.78).abs() < 0.01, "{after}");
        let mut c = 25.0;
        for _ in 0..100_000 {
            c = step_c(&config, c, 0.5, 0.02);
        }
        // Settled: T - Ta = I^2 R(T) Rth; closed form with R(T) = R20 (1 + k (T - 20)).
        let p = 0.25 * 13.0 * 5.0;
        let closed = (25.0 + p * (1.0 - 0.003_93 * 20.0)) / (1.0 - p * 0.003_93);
        assert!((c - closed).abs() < 0.05, "{c} {closed}");
    }

    #[test]
    fn current_is_reduced_before_the_trip() {
        let config = ThermalConfig::default();
        assert_eq!(allowed_fraction(&config, 25.0), 1.0);
        assert_eq!(allowed_fraction(&config, 92.5), 0.5);
        assert_eq!(allowed_fraction(&config, 105.0), 0.0);
        assert_eq!(allowed_fraction(&config, f32::NAN), 0.0);
    }
}
