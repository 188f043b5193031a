//! Readings of a press that contradict its motion: what tells a broken wire or a still arm that no rail tells.
//!
//! While the probe goes down the force on it does not fall and its height does, at the commanded rate. A pin
//! whose wire is off keeps its voltage, or follows the channel converted before it in about a second
//! (`docs/decisions/0012-wires.md`).

use protocol::TICK_S;

/// Bounds of what a sound press reads.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlausibleConfig {
    /// Force below the tared zero, or below the force at the start of the approach, N, that no specimen gives:
    /// 11 deviations of the largest noise of a bench (0.07 N), smoothed over [`SMOOTHING`].
    pub pull_n: f32,
    /// Loss of force in contact, as fraction of the largest. A foam under a ball at constant rate loses none.
    pub loss: f32,
    /// The same at small forces, N.
    pub loss_n: f32,
    /// The same, standard deviations of the force before contact: three readings in a row, one in 1e11.
    pub loss_sigmas: f32,
    /// Distance between the probe and where its rate has brought it within the last second, s of motion: a still
    /// probe has it after 0.5 s, a rate that is 40 % off never.
    pub slip_s: f32,
    /// The same, mm, for noise and the arm's start.
    pub slip_mm: f32,
    /// Ticks that the arm may take to reach its rate, from its way home at the worst.
    pub settle_ticks: u32,
    /// Readings in a row that contradict.
    pub consecutive: u8,
}

impl Default for PlausibleConfig {
    fn default() -> Self {
        PlausibleConfig {
            pull_n: 0.25,
            loss: 0.05,
            loss_n: 0.1,
            loss_sigmas: 6.0,
            slip_s: 0.4,
            slip_mm: 0.1,
            settle_ticks: 10,
            consecutive: 3,
        }
    }
}

/// Weight of a reading in the smoothed force: noise is divided by 3, and a change is seen after 5 ticks.
pub const SMOOTHING: f32 = 0.2;

/// Ticks of the approach whose mean is its zero.
const ZERO_TICKS: u32 = 5;

/// Memory of the expected motion, s.
const MEMORY_S: f32 = 1.0;

/// One reading of a press.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reading {
    /// Height of the probe, mm.
    pub probe_mm: f32,
    /// Load cell, N.
    pub force_n: f32,
    /// Commanded rate, mm/s.
    pub rate_mm_s: f32,
    /// Noise of the force before contact, N, once there is contact.
    pub contact_noise_n: Option<f32>,
}

/// What contradicts, with the reading and its bound.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Contradiction {
    /// Force, N, below this bound, N.
    pub force_n: Option<(f32, f32)>,
    /// Distance from the expected height, mm, above this bound, mm.
    pub slip_mm: Option<(f32, f32)>,
}

/// Memory of one press; `Default` is its beginning.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Plausible {
    ticks: u32,
    zero_n: f32,
    smooth_n: f32,
    peak_n: f32,
    expected_mm: f32,
    lost: u8,
    slipped: u8,
}

impl Plausible {
    /// Takes a reading while the arm runs.
    pub fn step(&mut self, config: &PlausibleConfig, reading: &Reading) -> Contradiction {
        self.ticks = self.ticks.saturating_add(1);
        Contradiction { force_n: self.force(config, reading), slip_mm: self.motion(config, reading) }
    }

    fn force(&mut self, config: &PlausibleConfig, reading: &Reading) -> Option<(f32, f32)> {
        let force_n = reading.force_n;
        if self.ticks <= ZERO_TICKS {
            self.zero_n += (force_n - self.zero_n) / self.ticks as f32;
            self.smooth_n = self.zero_n;
        } else {
            self.smooth_n += SMOOTHING * (force_n - self.smooth_n);
        }
        // A press may begin in contact: its zero is then a force, and the tared one still holds.
        let (value_n, bound_n) = match reading.contact_noise_n {
            None => (self.smooth_n, self.zero_n.max(0.0) - config.pull_n),
            Some(noise_n) => {
                self.peak_n = self.peak_n.max(force_n);
                let loss_n = (config.loss * self.peak_n).max(config.loss_n).max(config.loss_sigmas * noise_n);
                (force_n, self.peak_n - loss_n)
            }
        };
        let lost = value_n < bound_n;
        self.lost = if lost { self.lost.saturating_add(1) } else { 0 };
        (self.lost >= config.consecutive).then_some((value_n, bound_n))
    }

    fn motion(&mut self, config: &PlausibleConfig, reading: &Reading) -> Option<(f32, f32)> {
        if self.ticks <= config.settle_ticks {
            self.expected_mm = reading.probe_mm;
            return None;
        }
        self.expected_mm -= reading.rate_mm_s * TICK_S;
        let slip_mm = reading.probe_mm - self.expected_mm;
        self.expected_mm += slip_mm * TICK_S / MEMORY_S;
        let bound_mm = config.slip_mm + config.slip_s * reading.rate_mm_s;
        self.slipped = if slip_mm.abs() > bound_mm { self.slipped.saturating_add(1) } else { 0 };
        (self.slipped >= config.consecutive).then_some((slip_mm, bound_mm))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testbed::{Chance, LIBRARY, Press};

    fn step(state: &mut Plausible, probe_mm: f32, force_n: f32, contact_noise_n: Option<f32>) -> Contradiction {
        let reading = Reading { probe_mm, force_n, rate_mm_s: 4.0, contact_noise_n };
        state.step(&PlausibleConfig::default(), &reading)
    }

    /// Presses of every foam at every rate with the bench's noise, the softest and the stiffest.
    #[test]
    fn no_sound_press_contradicts_itself() {
        let mut chance = Chance(9);
        for foam in LIBRARY {
            for rate in [1.0, 2.0, 4.0] {
                for _ in 0..40 {
                    let press = Press::noisy(foam, rate, &mut chance);
                    let mut state = Plausible::default();
                    let noise_n = (0.01 * foam.force_n(4.0)) as f32;
                    for sample in press.samples(&mut chance) {
                        // Contact is found some tenths of a millimetre below the surface.
                        let deep = press.surface_mm() as f32 - sample.probe_mm > 0.3;
                        let reading = Reading {
                            probe_mm: sample.probe_mm,
                            force_n: sample.force_n,
                            rate_mm_s: rate as f32,
                            contact_noise_n: deep.then_some(noise_n),
                        };
                        let found = state.step(&PlausibleConfig::default(), &reading);
                        assert_eq!(found, Contradiction::default(), "{} at {rate} mm/s", foam.name);
                    }
                }
            }
        }
    }

    #[test]
    fn a_load_cell_half_a_newton_below_its_zero_is_found_before_the_probe_has_gone_a_tenth_of_a_millimetre_further() {
        let mut state = Plausible::default();
        let found = (1..100).find(|i| step(&mut state, 20.0 - 0.08 * *i as f32, -0.5, None).force_n.is_some());
        assert_eq!(found, Some(3));
    }

    #[test]
    fn two_bad_readings_between_good_ones_are_no_contradiction() {
        let mut state = Plausible::default();
        for i in 0..60 {
            let mm = 20.0 - 0.08 * i as f32;
            assert_eq!(step(&mut state, mm, 1.0, Some(0.01)), Contradiction::default());
        }
        for i in 60..69 {
            let mm = 20.0 - 0.08 * i as f32;
            let (probe_mm, force_n) = if i % 3 < 2 { (mm + 5.0, 0.5) } else { (mm, 1.0) };
            assert_eq!(step(&mut state, probe_mm, force_n, Some(0.01)), Contradiction::default(), "{i}");
        }
    }

    /// What a cell that was not tared reads in the air is the least that a press may read.
    #[test]
    fn a_load_cell_that_begins_at_a_newton_and_sinks_is_found_above_its_tared_zero() {
        let mut state = Plausible::default();
        for i in 0..20 {
            assert_eq!(step(&mut state, 20.0 - 0.08 * i as f32, 1.0, None), Contradiction::default());
        }
        let found = (1..100).find(|i| step(&mut state, 18.4 - 0.08 * *i as f32, 0.5, None).force_n.is_some());
        // Four readings until the smoothed one has lost a quarter of a newton, and two more.
        assert_eq!(found, Some(6));
    }

    #[test]
    fn a_force_that_fades_in_contact_is_found_in_a_tenth_of_a_second() {
        // 5 N, then a bare pin: to -0.5 N with 1.25 s.
        let mut state = Plausible::default();
        for i in 0..60 {
            let found = step(&mut state, 20.0 - 0.08 * i as f32, 0.1 * i as f32, Some(0.01));
            assert_eq!(found, Contradiction::default());
        }
        let fading = |i: i32| 6.4 * (-0.02 * i as f32 / 1.25).exp() - 0.5;
        let found =
            (1..100).find(|i| step(&mut state, 15.2 - 0.08 * *i as f32, fading(*i), Some(0.01)).force_n.is_some());
        assert!(found.is_some_and(|ticks| ticks <= 6), "{found:?}");
    }

    #[test]
    fn a_probe_that_stands_or_goes_half_as_fast_is_found_and_one_a_quarter_too_slow_is_not() {
        for (share, expected) in [(0.0, 38..44), (0.5, 100..112), (2.0, 38..44)] {
            let mut state = Plausible::default();
            let found =
                (1..1000).find(|i| step(&mut state, 90.0 - 0.08 * share * *i as f32, 0.0, None).slip_mm.is_some());
            assert!(found.is_some_and(|ticks| expected.contains(&ticks)), "{share}: {found:?}");
        }
        for share in [0.75, 1.0, 1.25] {
            let mut state = Plausible::default();
            let found =
                (1..900).find(|i| step(&mut state, 90.0 - 0.08 * share * *i as f32, 0.0, None).slip_mm.is_some());
            assert_eq!(found, None, "{share}");
        }
    }
}
