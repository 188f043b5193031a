//! Current regulation of the coil: 1 kHz, on a resistance and an inductance.

use crate::number::limit;

/// The coil and its supply, and how fast the current follows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CoilCircuit {
    /// Resistance at 20 degrees Celsius, ohm (770 turns of 28 AWG, estimated).
    pub resistance_ohm: f32,
    /// Inductance, mH (estimated).
    pub inductance_mh: f32,
    /// Supply of the half bridge, V.
    pub supply_v: f32,
    /// Resistance of the hottest coil at the lowest supply, over its own: copper at 105 degrees has 1.33 of it, a supply
    /// 10 % low makes that 1.48, and tolerances the rest.
    pub highest: f32,
    /// The same of a coil at 0 degrees at a supply 10 % high, with tolerances.
    pub lowest: f32,
    /// Bandwidth of the closed loop, rad/s.
    pub bandwidth_rad_s: f32,
    /// Highest duty; below 1 so that the bootstrap of the high side refreshes.
    pub duty_max: f32,
}

impl Default for CoilCircuit {
    /// 13 ohm and 3 mH from 36 V: the 2.5 A limit needs 32.5 V cold. 200 rad/s is a fifth of what 1 kHz sampling bears.
    fn default() -> Self {
        CoilCircuit {
            resistance_ohm: 13.0,
            inductance_mh: 3.0,
            supply_v: 36.0,
            highest: 1.65,
            lowest: 0.8,
            bandwidth_rad_s: 200.0,
            duty_max: 0.98,
        }
    }
}

/// Coefficients for one sampling period.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CoilPi {
    /// Duty an A of error.
    kp: f32,
    /// Duty an A of error a step.
    ki: f32,
    /// Duty an A in steady state: the cold resistance over the supply.
    steady: f32,
    /// The same in the hottest coil.
    steady_most: f32,
    duty_max: f32,
}

/// Memory of the regulator: its integral, as duty.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct CoilPiState {
    integral: f32,
}

impl CoilCircuit {
    /// Least and most current that a duty can give, A.
    pub fn current_a(&self, duty: f32) -> (f32, f32) {
        let a = duty * self.supply_v / self.resistance_ohm;
        (a / self.highest, a / self.lowest)
    }
}

impl CoilPi {
    /// Builds the coefficients by pole-zero cancellation: `kp = bandwidth L / V`, `ki = bandwidth R / V`, so the loop is of first
    /// order with that bandwidth and does not overshoot.
    pub fn build(circuit: &CoilCircuit, period_s: f32) -> Self {
        CoilPi {
            kp: circuit.bandwidth_rad_s * circuit.inductance_mh * 1e-3 / circuit.supply_v,
            ki: circuit.bandwidth_rad_s * circuit.resistance_ohm / circuit.supply_v * period_s,
            steady: circuit.resistance_ohm / circuit.supply_v,
            steady_most: circuit.highest * circuit.resistance_ohm / circuit.supply_v,
            duty_max: circuit.duty_max,
        }
    }

    /// Duty that holds a current in a cold coil, 0 to the highest duty: what a board without fast loop would apply.
    pub fn steady_duty(&self, target_a: f32) -> f32 {
        limit(self.steady * target_a, 0.0, self.duty_max)
    }

    /// One step: duty, 0 to what the hottest coil needs for the target, whatever the reading says. A target of 0 (or NaN)
    /// switches off and forgets the integral, which is held between the duty's limits and so cannot wind up.
    pub fn step(&self, state: &mut CoilPiState, target_a: f32, measured_a: f32) -> f32 {
        if !(target_a > 0.0) {
            *state = CoilPiState::default();
            return 0.0;
        }
        let error_a = target_a - measured_a;
        let most = limit(self.steady_most * target_a, 0.0, self.duty_max);
        state.integral = limit(state.integral + self.ki * error_a, 0.0, most);
        limit(state.integral + self.kp * error_a, 0.0, most)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Coil as R-L, exact over a 1 ms step.
    fn coil_step(i: f32, duty: f32, r: f32) -> f32 {
        let c = CoilCircuit::default();
        let decay = (-r / (c.inductance_mh * 1e-3) * 1e-3f32).exp();
        let settled = duty * c.supply_v / r;
        settled + (i - settled) * decay
    }

    #[test]
    fn current_settles_on_a_hot_coil_without_overshoot_above_five_percent() {
        let pi = CoilPi::build(&CoilCircuit::default(), 1e-3);
        // 13 ohm cold, 16 ohm at about 80 degrees (copper, 0.39 %/K).
        for r in [13.0, 16.0] {
            let (mut state, mut i, mut peak) = (CoilPiState::default(), 0.0, 0.0f32);
            for _ in 0..60 {
                i = coil_step(i, pi.step(&mut state, 2.0, i), r);
                peak = peak.max(i);
            }
            // 60 ms are 12 time constants of the loop.
            assert!((i - 2.0).abs() < 1e-3, "{r} ohm: {i} A");
            assert!(peak < 2.0 * 1.05, "{r} ohm: {peak} A");
        }
    }

    #[test]
    fn zero_and_nan_targets_switch_off() {
        let pi = CoilPi::build(&CoilCircuit::default(), 1e-3);
        let mut state = CoilPiState { integral: 0.5 };
        assert_eq!(pi.step(&mut state, 0.0, 1.0), 0.0);
        assert_eq!(state, CoilPiState::default());
        assert_eq!(pi.step(&mut state, f32::NAN, 1.0), 0.0);
        // A reading that is not a number gives no duty.
        assert_eq!(pi.step(&mut state, 1.0, f32::NAN), 0.0);
    }

    #[test]
    fn integral_does_not_wind_up_at_the_duty_limit() {
        let pi = CoilPi::build(&CoilCircuit::default(), 1e-3);
        let mut state = CoilPiState::default();
        for _ in 0..10_000 {
            pi.step(&mut state, 2.5, 0.0);
        }
        // Current arrives above target: the duty must leave its limit at once.
        assert!(pi.step(&mut state, 2.5, 2.9) < 0.98);
        // Nor at the duty that the hottest coil needs for a smaller target.
        for _ in 0..10_000 {
            pi.step(&mut state, 1.0, 0.0);
        }
        assert!(pi.step(&mut state, 1.0, 1.1) < 1.65 * 13.0 / 36.0);
    }
}
