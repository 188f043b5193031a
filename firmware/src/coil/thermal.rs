//! How hot the winding is: one heat capacity, one resistance to the surroundings, both of
//! [`Winding`].

use super::winding::{CoilCircuit, Winding};

/// Surroundings and limits of the winding.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ThermalConfig {
    /// Surroundings, degrees Celsius.
    pub ambient_c: f32,
    /// Above this the current is reduced, degrees Celsius.
    pub derate_c: f32,
    /// At this the coil is switched off as a fault, degrees Celsius (enamel of class 130).
    pub trip_c: f32,
}

impl Default for ThermalConfig {
    fn default() -> Self {
        ThermalConfig { ambient_c: 25.0, derate_c: 80.0, trip_c: 105.0 }
    }
}

/// Current that a duty gives in the winding at a temperature, A.
pub fn driven_a(circuit: &CoilCircuit, duty: f32, coil_c: f32) -> f32 {
    duty * circuit.supply_v / circuit.winding.ohm(coil_c)
}

/// Temperature after a step of `period_s` with `current_a`, degrees Celsius.
pub fn step_c(config: &ThermalConfig, winding: &Winding, coil_c: f32, current_a: f32, period_s: f32) -> f32 {
    let heating_w = current_a * current_a * winding.ohm(coil_c);
    let cooling_w = (coil_c - config.ambient_c) / winding.resistance_k_per_w;
    coil_c + (heating_w - cooling_w) * period_s / winding.capacity_j_per_k
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
        let (config, ring) = (ThermalConfig::default(), Winding::RING);
        // 1 A in 5.216 ohm at 25 degrees: 5.216 W / 6.66 J/K = 0.783 K/s.
        let after = step_c(&config, &ring, 25.0, 1.0, 1.0);
        assert!((after - 25.0 - 0.783).abs() < 0.01, "{after}");
        let mut c = 25.0;
        for _ in 0..100_000 {
            c = step_c(&config, &ring, c, 0.5, 0.02);
        }
        // Settled: T - Ta = I^2 R(T) Rth; closed form with R(T) = R20 (1 + k (T - 20)).
        let p = 0.25 * 5.115 * 20.0;
        let closed = (25.0 + p * (1.0 - 0.003_93 * 20.0)) / (1.0 - p * 0.003_93);
        assert!((c - closed).abs() < 0.05, "{c} {closed}");
    }

    /// A switch that is stuck on at full supply, from warm: the time that a person has before class
    /// 130 is reached. Nothing cools.
    #[test]
    fn a_stuck_switch_leaves_ten_seconds() {
        let (c, ring) = (CoilCircuit::default(), Winding { resistance_k_per_w: f32::INFINITY, ..Winding::RING });
        let seconds = |from_c: f32| {
            let mut coil_c = from_c;
            (1..100_000).find(|_| {
                coil_c = step_c(&ThermalConfig::default(), &ring, coil_c, driven_a(&c, 1.0, coil_c), 0.001);
                coil_c > 130.0
            })
        };
        assert!(seconds(80.0).is_some_and(|ms| ms > 9_900), "{:?}", seconds(80.0));
        assert!(seconds(25.0).is_some_and(|ms| ms > 18_000), "{:?}", seconds(25.0));
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
