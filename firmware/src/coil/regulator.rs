//! Current regulation of the coil: 1 kHz, on a resistance and an inductance that falls as the core
//! saturates.

use super::winding::{CoilCircuit, LINKAGES, at, stretch};
use crate::number::limit;

/// Coefficients for one sampling period.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CoilPi {
    /// Duty over current, at the told currents: its difference between target and reading is the
    /// proportional part.
    action: [f32; LINKAGES],
    /// Part by which the integral follows the duty in a step, for each stretch between told
    /// currents.
    follows: [f32; LINKAGES],
    /// Duty an A in steady state: the cold resistance over the supply.
    steady: f32,
    /// The same in the hottest circuit.
    steady_most: f32,
    duty_max: f32,
}

/// Memory of the regulator: its integral, as duty.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct CoilPiState {
    integral: f32,
}

impl CoilPi {
    /// Builds the coefficients: every step closes the same part of the distance in *flux linkage*,
    /// so the bandwidth is the same at rest (40 mH) and in saturation (5 mH), and a step of the
    /// target overshoots by less than 5 % of it however far it goes.
    ///
    /// In a stretch of inductance L, over a period T, the current keeps `a = exp(-R T / L)` of its
    /// distance from V d / R. With `kp = g R / (V (1 - a))` and an integral that follows the duty
    /// by `1 - a`, the regulator's zero lies on this pole, exactly, and what is left is `g / (z -
    /// 1)`, with `g = 1 - exp(-bandwidth T)`. `R / (1 - a)` is `L / T + R / 2` within 5 %, whence
    /// the action below. The margins over inductance, temperature and supply:
    /// `tests::the_loop_keeps_its_bandwidth_and_margin_from_rest_to_saturation_cold_and_hot`.
    pub fn build(circuit: &CoilCircuit, period_s: f32) -> Self {
        let (winding, volt, ohm) = (&circuit.winding, circuit.supply_v, circuit.working_ohm());
        let gain = 1.0 - libm::expf(-circuit.bandwidth_rad_s * period_s);
        let mut action = [0.0; LINKAGES];
        let mut follows = [0.0; LINKAGES];
        for (i, (action, follows)) in action.iter_mut().zip(&mut follows).enumerate() {
            let current_a = i as f32 * super::winding::LINKAGE_STEP_A;
            let half_drop_v = 0.5 * ohm * current_a;
            *action = gain / volt * (at(&winding.linkage_wb, current_a) / period_s + half_drop_v);
            *follows = 1.0 - libm::expf(-ohm * period_s / winding.inductance_h(i));
        }
        CoilPi {
            action,
            follows,
            steady: winding.resistance_ohm / volt,
            steady_most: circuit.highest() * winding.resistance_ohm / volt,
            duty_max: circuit.duty_max,
        }
    }

    /// Duty that holds a current in a cold coil, 0 to the highest duty: what a board without fast loop would apply.
    pub fn steady_duty(&self, target_a: f32) -> f32 {
        limit(self.steady * target_a, 0.0, self.duty_max)
    }

    /// One step: duty, 0 to what the hottest circuit needs for the target, whatever the reading
    /// says. A target of 0 (or NaN) switches off and forgets the integral. The integral follows the
    /// duty that is applied, limited as it is, and so cannot wind up.
    pub fn step(&self, state: &mut CoilPiState, target_a: f32, measured_a: f32) -> f32 {
        if !(target_a > 0.0) {
            *state = CoilPiState::default();
            return 0.0;
        }
        let most = limit(self.steady_most * target_a, 0.0, self.duty_max);
        let proportional = at(&self.action, target_a) - at(&self.action, measured_a);
        let duty = limit(state.integral + proportional, 0.0, most);
        let follows = self.follows.get(stretch(measured_a)).copied().unwrap_or(0.0);
        state.integral = limit(state.integral + follows * (duty - state.integral), 0.0, most);
        duty
    }
}

#[cfg(test)]
mod tests;
