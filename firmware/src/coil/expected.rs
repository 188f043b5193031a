//! The current that there must be: what the duties so far have made of it in a sound circuit.

use super::winding::CoilCircuit;

/// Bounds of the current, for one sampling period.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExpectedLaw {
    /// A an unit of duty, in the hottest and in the coldest circuit.
    settled_a: (f32, f32),
    /// Part of the way that even the slowest circuit goes in a period.
    part: f32,
}

/// Least and most current, A; `Default` is a coil at rest.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Expected {
    /// Least, A.
    pub least_a: f32,
    /// Most, A.
    pub most_a: f32,
}

impl ExpectedLaw {
    /// Builds the bounds. They hold for every inductance from none to the largest of the circuit:
    /// the core's saturation changes it eightfold, and a built core is not the drawn one.
    pub fn build(circuit: &CoilCircuit, period_s: f32) -> Self {
        ExpectedLaw { settled_a: circuit.settled_a(1.0), part: 1.0 - libm::expf(-period_s / circuit.slowest_s()) }
    }

    /// One period with a duty: towards more current at once, towards less as slowly as the slowest
    /// circuit; the least current the other way round.
    pub fn step(&self, state: &mut Expected, duty: f32) {
        let (least_a, most_a) = (duty * self.settled_a.0, duty * self.settled_a.1);
        let (low, high) = (least_a - state.least_a, most_a - state.most_a);
        state.least_a += if low < 0.0 { low } else { self.part * low };
        state.most_a += if high > 0.0 { high } else { self.part * high };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Circuits of 2 to 50 mH, cold to hot, under duties that jump: the current is never outside.
    #[test]
    fn a_sound_current_is_never_outside() {
        let c = CoilCircuit::default();
        let law = ExpectedLaw::build(&c, 1e-3);
        for henry in [2e-3f32, 5e-3, 15e-3, 40e-3, 49e-3] {
            for (ohm, volt) in [(4.5f32, 16.5f32), (5.115, 15.0), (7.4, 13.5)] {
                let (mut bounds, mut current_a) = (Expected::default(), 0.0f32);
                for i in 0..2000 {
                    let duty = [0.98, 0.2, 0.0, 0.6, 0.3][i / 37 % 5];
                    law.step(&mut bounds, duty);
                    let rest_a = duty * volt / ohm;
                    current_a = rest_a + (current_a - rest_a) * (-ohm / henry * 1e-3).exp();
                    // f32 of some amperes.
                    let inside = bounds.least_a - 1e-5..=bounds.most_a + 1e-5;
                    assert!(inside.contains(&current_a), "{henry} H, {ohm} ohm, step {i}: {current_a} {inside:?}");
                }
            }
        }
    }
}
