//! The finger on the display: a hand pushes with a force, not to a place.

use std::f64::consts::TAU;

use super::{Source, Tremor};

/// What the hand wants to do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Touch {
    /// Largest intended force, N.
    pub peak_n: f64,
    /// Time from one press to the next, s.
    pub period_s: f64,
}

/// A finger with tremor.
#[derive(Debug, Clone)]
pub struct Finger {
    touch: Option<Touch>,
    elapsed_s: f64,
    tremor: Tremor,
    force_n: f64,
}

/// Standard deviation of the tremor, fraction of the intended force (assumed; isometric force tremor is a few percent).
const TREMOR: f64 = 0.03;

/// Loss of force when the shaft gives way, N s/mm (assumed damping of a hand, 4 N s/m).
const YIELDING_N_S_MM: f64 = 0.004;

impl Finger {
    /// A hand that does not touch yet.
    pub fn new(seed: u64) -> Self {
        Finger { touch: None, elapsed_s: 0.0, tremor: Tremor::new(seed, Source::Tremor), force_n: 0.0 }
    }

    /// Starts pressing, or lifts the finger.
    pub fn set(&mut self, touch: Option<Touch>) {
        self.touch = touch;
        self.elapsed_s = 0.0;
    }

    /// Force on the cap, N.
    pub fn force_n(&self) -> f64 {
        self.force_n
    }

    /// Lets `dt_s` pass; `retreat_mm_s` is the speed at which the cap gives way under the finger.
    pub fn step(&mut self, retreat_mm_s: f64, dt_s: f64) {
        self.tremor.step(dt_s);
        self.elapsed_s += dt_s;
        self.force_n = match self.touch {
            Some(touch) => {
                let phase = TAU * self.elapsed_s / touch.period_s.max(dt_s);
                let intended = 0.5 * touch.peak_n * (1.0 - phase.cos());
                let force = intended * (1.0 + TREMOR * self.tremor.now()) - YIELDING_N_S_MM * retreat_mm_s;
                // A finger pushes; it cannot pull.
                if intended > 0.0 { force.max(0.0) } else { 0.0 }
            }
            None => 0.0,
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hand_presses_and_lets_go_with_a_tremor_of_a_few_percent() {
        let mut finger = Finger::new(5);
        finger.set(Some(Touch { peak_n: 2.0, period_s: 2.0 }));
        let mut deviation = 0.0;
        for ms in 1..=20_000 {
            finger.step(0.0, 1e-3);
            let intended = 1.0 - (TAU * f64::from(ms) * 1e-3 / 2.0).cos();
            deviation += (finger.force_n() - intended).powi(2);
            assert!(finger.force_n() >= 0.0);
        }
        // Deviation is TREMOR times the force's root mean square, sqrt(1.5) N; narrow-band noise over
        // 20 s repeats about 20 * 10 * 0.3 times, so its own spread is near 10 %: three of those.
        let rms = (deviation / 20_000.0f64).sqrt() / (0.03 * 1.5f64.sqrt());
        assert!((0.7..1.3).contains(&rms), "{rms}");
        finger.set(None);
        finger.step(0.0, 1e-3);
        assert_eq!(finger.force_n(), 0.0);
    }
}
