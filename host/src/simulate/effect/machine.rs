//! The machine stage: from the recorded depth to where the ball would be without a force on it.

use super::Effect;

/// What the machine does to the depth; offsets and compliance are not in it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Machine {
    lag_s: f64,
    rate_limit_mm_s: Option<f64>,
    /// True less recorded depth (mm).
    pub offset_mm: f64,
    /// Recorded less true depth over force (mm/N).
    pub compliance_mm_per_n: f64,
}

impl Machine {
    /// The machine that effects make; two of a kind add up, of rate limits the lower counts.
    pub fn of(effects: &[Effect]) -> Self {
        let mut machine = Self::default();
        for effect in effects {
            match effect {
                Effect::Lag { lag_s } => machine.lag_s += lag_s,
                Effect::RateLimit { rate_mm_s } => {
                    let before = machine.rate_limit_mm_s.unwrap_or(f64::INFINITY);
                    machine.rate_limit_mm_s = Some(before.min(*rate_mm_s));
                }
                Effect::ContactOffset { offset_mm } => machine.offset_mm += offset_mm,
                Effect::Compliance { mm_per_n } => machine.compliance_mm_per_n += mm_per_n,
                _ => {}
            }
        }
        machine
    }

    /// The depth the ball is driven to, offset included, over the times `k dt_s` of the recorded depths.
    ///
    /// A first-order lag `tau dz/dt = d - z` is integrated exactly for a recorded depth that is straight between samples; the
    /// rate limit comes first, as the actuator's does.
    pub fn driven(&self, recorded: &[f64], dt_s: f64) -> Vec<f64> {
        let mut limited: Vec<f64> = recorded.to_vec();
        if let Some(rate) = self.rate_limit_mm_s {
            let most = rate * dt_s;
            for k in 1..limited.len() {
                limited[k] = limited[k - 1] + (recorded[k] - limited[k - 1]).clamp(-most, most);
            }
        }
        if self.lag_s > 0.0 {
            let x = dt_s / self.lag_s;
            let decay = (-x).exp();
            let share = (1.0 - decay) / x;
            let mut behind = 0.0;
            let mut before = limited.first().copied().unwrap_or(0.0);
            for depth in &mut limited {
                let step = *depth - before;
                before = *depth;
                // the lag e = d - z obeys de/dt = dd/dt - e / tau
                behind = decay * behind + share * step;
                *depth -= behind;
            }
        }
        limited.iter().map(|depth| depth + self.offset_mm).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Behind a ramp of rate V a first-order lag settles at V tau; the step response is exact, so only rounding is left.
    #[test]
    fn a_lag_stays_behind_a_ramp_and_catches_up_in_a_hold() {
        let dt_s = 0.002;
        let ramp: Vec<f64> = (0..4000).map(|k| (0.002 * f64::from(k)).min(4.0)).collect();
        let machine = Machine::of(&[Effect::Lag { lag_s: 0.1 }, Effect::ContactOffset { offset_mm: 0.05 }]);
        let driven = machine.driven(&ramp, dt_s);
        assert!((ramp[1500] + 0.05 - driven[1500] - 0.1).abs() < 1e-9);
        assert!((driven[3999] - 4.05).abs() < 1e-9);
    }

    #[test]
    fn a_rate_limit_is_kept_to_and_does_nothing_below() {
        let ramp: Vec<f64> = (0..100).map(|k| (0.1 * f64::from(k)).min(3.0)).collect();
        let slow = Machine::of(&[Effect::RateLimit { rate_mm_s: 5.0 }]).driven(&ramp, 0.01);
        assert!((slow[20] - 1.0).abs() < 1e-12 && (slow[99] - 3.0).abs() < 1e-12);
        let fast = Machine::of(&[Effect::RateLimit { rate_mm_s: 20.0 }]).driven(&ramp, 0.01);
        assert!(ramp.iter().zip(&fast).all(|(a, b)| (a - b).abs() < 1e-12));
    }
}
