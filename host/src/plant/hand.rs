//! A hand that moves a finger's bone: an intended path through the hand's impedance, with tremor.

use std::f64::consts::PI;

use super::{Dented, Pulp, PulpLaw, Source, Tremor};

/// What the hand wants its bone to do: down from [`ABOVE_MM`] above the surface, rest, and up again.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Press {
    /// Farthest intended place of the finger's tip below the surface, mm.
    pub peak_mm: f64,
    /// Time of the way down, and of that up, s.
    pub way_s: f64,
    /// Time at the farthest place, s.
    pub hold_s: f64,
}

/// Where a press begins, mm above the surface.
pub const ABOVE_MM: f64 = 0.5;

impl Press {
    /// Intended place of the tip below the surface, mm, at a time since the press began, s.
    #[must_use]
    pub fn at(&self, time_s: f64) -> f64 {
        let part = if time_s < self.way_s {
            time_s / self.way_s
        } else if time_s < self.way_s + self.hold_s {
            1.0
        } else {
            1.0 - ((time_s - self.way_s - self.hold_s) / self.way_s).min(1.0)
        };
        (self.peak_mm + ABOVE_MM) * 0.5 * (1.0 - (PI * part).cos()) - ABOVE_MM
    }

    /// How long it lasts, s.
    #[must_use]
    pub fn lasts_s(&self) -> f64 {
        2.0 * self.way_s + self.hold_s
    }
}

/// Impedance of a hand at the finger's bone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HandLaw {
    /// Moving mass, g.
    pub mass_g: f64,
    /// Stiffness, N/mm.
    pub stiffness_n_mm: f64,
    /// Damping, N s/mm.
    pub damping_n_s_mm: f64,
    /// Tremor of the intended place, mm (standard deviation).
    pub tremor_mm: f64,
}

/// What lies under the finger.
#[derive(Debug, Clone, PartialEq)]
pub enum Under {
    /// The cap of the actuator.
    Cap,
    /// A fluid that yields.
    Fluid(Box<Dented>),
}

/// A hand with its finger.
#[derive(Debug, Clone)]
pub struct Hand {
    law: HandLaw,
    pulp: Pulp,
    under: Under,
    press: Option<Press>,
    elapsed_s: f64,
    bone_mm: f64,
    rate_mm_s: f64,
    force_n: f64,
    tremor: Tremor,
}

/// Longest step, s: 6 g on 5 N/mm swing at 900 rad/s.
const STEP_S: f64 = 1e-4;

impl Hand {
    /// A hand above what is under its finger.
    pub fn new(law: HandLaw, pulp: PulpLaw, under: Under, seed: u64) -> Self {
        Hand {
            law,
            pulp: Pulp::new(pulp),
            under,
            press: None,
            elapsed_s: 0.0,
            bone_mm: -ABOVE_MM,
            rate_mm_s: 0.0,
            force_n: 0.0,
            tremor: Tremor::new(seed, Source::Hand),
        }
    }

    /// Begins a press, from above.
    pub fn press(&mut self, press: Press) {
        (self.press, self.elapsed_s) = (Some(press), 0.0);
        (self.bone_mm, self.rate_mm_s) = (-ABOVE_MM, 0.0);
        if let Under::Fluid(dented) = &mut self.under {
            dented.level();
        }
    }

    /// Place of the finger's tip, were it not compressed, below the surface, mm.
    pub fn bone_mm(&self) -> f64 {
        self.bone_mm
    }

    /// Force of the finger, N.
    pub fn force_n(&self) -> f64 {
        self.force_n
    }

    /// Lets `dt_s` pass over a cap that has given way by `cap_mm`, or a fluid with a shear yield stress, kPa.
    pub fn step(&mut self, cap_mm: f64, yield_kpa: f64, dt_s: f64) {
        let parts = (dt_s / STEP_S).ceil().max(1.0);
        for _ in 0..parts as usize {
            self.part(cap_mm, yield_kpa, dt_s / parts);
        }
    }

    fn part(&mut self, cap_mm: f64, yield_kpa: f64, dt_s: f64) {
        self.tremor.step(dt_s);
        self.elapsed_s += dt_s;
        let Some(press) = self.press else { return };
        if self.elapsed_s > press.lasts_s() {
            (self.force_n, self.press) = (0.0, None);
            return;
        }
        let before = press.at(self.elapsed_s - dt_s);
        let (wanted, wanted_rate) = (press.at(self.elapsed_s), (press.at(self.elapsed_s) - before) / dt_s);
        let place_mm = match &mut self.under {
            Under::Cap => cap_mm,
            Under::Fluid(dented) => dented.under(self.bone_mm, yield_kpa, &self.pulp),
        };
        let compression_mm = self.bone_mm - place_mm;
        self.force_n = self.pulp.force_n(compression_mm);
        self.pulp.step(compression_mm, dt_s);
        let law = &self.law;
        let pulls = law.stiffness_n_mm * (wanted + law.tremor_mm * self.tremor.now() - self.bone_mm)
            + law.damping_n_s_mm * (wanted_rate - self.rate_mm_s);
        // 1 g is 1e-6 N s2/mm
        self.rate_mm_s += dt_s * (pulls - self.force_n) / (1e-6 * law.mass_g);
        self.bone_mm += dt_s * self.rate_mm_s;
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::plant::Curve;

    fn pulp() -> PulpLaw {
        let force: Vec<f64> = (1..=60).map(|i| 2.0 * 0.1 * f64::from(i)).collect();
        PulpLaw { slow: Curve::new(0.1, &force).unwrap(), relaxing: (0.0, 1.0) }
    }

    const LAW: HandLaw = HandLaw { mass_g: 6.0, stiffness_n_mm: 0.5, damping_n_s_mm: 0.004, tremor_mm: 0.0 };

    /// Two springs in a row: of a slow press on a stiff cap the hand's gives way as well.
    #[test]
    fn a_slow_press_on_a_cap_that_stands_shares_its_travel_between_hand_and_pulp() {
        let mut hand = Hand::new(LAW, pulp(), Under::Cap, 1);
        hand.press(Press { peak_mm: 5.0, way_s: 4.0, hold_s: 1.0 });
        (0..4900).for_each(|_| hand.step(0.0, 0.0, 1e-3));
        let exact = 5.0 / (1.0 / 0.5 + 1.0 / 2.0);
        assert!((hand.force_n() - exact).abs() < 0.01 * exact, "{} {exact}", hand.force_n());
        assert!((hand.bone_mm() - exact / 2.0).abs() < 0.02);
        (0..4200).for_each(|_| hand.step(0.0, 0.0, 1e-3));
        assert_eq!(hand.force_n(), 0.0);
    }

    #[test]
    fn a_cap_that_gives_way_is_felt_softer() {
        let felt = |softness: f64| {
            let mut hand = Hand::new(LAW, pulp(), Under::Cap, 1);
            hand.press(Press { peak_mm: 5.0, way_s: 2.0, hold_s: 1.0 });
            let mut cap = 0.0;
            for _ in 0..2500 {
                hand.step(cap, 0.0, 1e-3);
                cap += 0.02 * (softness * hand.force_n() - cap);
            }
            hand.force_n()
        };
        let exact = 5.0 / (1.0 / 0.5 + 1.0 / 2.0 + 1.0);
        assert!((felt(1.0) - exact).abs() < 0.02 && felt(0.0) > felt(1.0), "{}", felt(1.0));
    }
}
