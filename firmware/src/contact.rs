//! Contact detection and the first estimate of the contact point.
//!
//! Samples before contact give the zero of the force and its noise. Contact is *detected* when several samples in a row
//! exceed a multiple of the noise; by then the ball is some tenths of a millimetre deep. The contact *point* is found by going
//! back: near contact force follows `c (d0 - x)^1.5` (Hertz, x the height of the ball), so d0 is searched along one line with c
//! eliminated by least squares over the buffered samples. [`crate::palpation`] refines it with whole curves at the end.

use crate::number::sqrt;

/// Buffered samples: 2.5 mm of approach at 1 mm/s.
pub const BUFFER_LEN: usize = 128;

/// When contact counts as detected.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactConfig {
    /// Smallest threshold above zero, N: above quantisation of a 10 N cell read with 12 bits, oversampled.
    pub floor_n: f32,
    /// Threshold in standard deviations of the samples before contact.
    pub sigmas: f32,
    /// Samples in a row above the threshold. With 2.5 sigma of a known noise, 5 give one false alarm in 1e11 samples; of a noise
    /// estimated from 12 samples still one in 1e6.
    pub consecutive: u8,
    /// A sample enters zero and noise when it is this many samples old without contact.
    pub lag: u8,
    /// Samples that zero and noise need; until then only `certain_n` detects.
    pub baseline_min: u16,
    /// Force that is contact whatever the noise, N.
    pub certain_n: f32,
    /// How far before the detection the contact point may lie, mm.
    pub reach_mm: f32,
}

impl Default for ContactConfig {
    fn default() -> Self {
        ContactConfig {
            floor_n: 0.002,
            sigmas: 2.5,
            consecutive: 5,
            lag: 10,
            baseline_min: 12,
            certain_n: 0.5,
            reach_mm: 1.6,
        }
    }
}

/// One sample of the approach.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Sample {
    /// Height of the ball above the base plate, mm; falls during the approach.
    pub probe_mm: f32,
    /// Force, N.
    pub force_n: f32,
}

/// What was found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactPoint {
    /// Height of the specimen's surface above the base plate, mm.
    pub height_mm: f32,
    /// Reading of the load cell without contact, N.
    pub zero_n: f32,
    /// Standard deviation of the force before contact, N.
    pub noise_n: f32,
    /// Samples that the zero is the mean of.
    pub zero_samples: u16,
}

/// State of the detection.
#[derive(Debug, Clone)]
pub struct Contact {
    ring: [Sample; BUFFER_LEN],
    /// Samples seen, saturating.
    seen: u32,
    baseline_count: u16,
    zero_n: f32,
    variance_n2: f32,
    streak: u8,
}

impl Default for Contact {
    fn default() -> Self {
        Self::new()
    }
}

/// Zero and noise forget after this many samples, so that drift of the amplifier is followed.
const BASELINE_MEMORY: u16 = 256;

impl Contact {
    /// Nothing seen yet.
    pub const fn new() -> Self {
        Contact {
            ring: [Sample { probe_mm: 0.0, force_n: 0.0 }; BUFFER_LEN],
            seen: 0,
            baseline_count: 0,
            zero_n: 0.0,
            variance_n2: 0.0,
            streak: 0,
        }
    }

    /// Takes a sample; true in the tick in which contact is detected.
    pub fn step(&mut self, config: &ContactConfig, sample: Sample) -> bool {
        if let Some(slot) = self.ring.get_mut(self.seen as usize % BUFFER_LEN) {
            *slot = sample;
        }
        self.seen = self.seen.saturating_add(1);
        let excess_n = sample.force_n - self.zero_n;
        let established = self.baseline_count >= config.baseline_min;
        let above = if established {
            let noise_n = config.sigmas * sqrt(self.variance_n2);
            excess_n > if noise_n > config.floor_n { noise_n } else { config.floor_n }
        } else {
            sample.force_n > config.certain_n
        };
        self.streak = if above { self.streak.saturating_add(1) } else { 0 };
        if self.streak >= config.consecutive || (established && excess_n > config.certain_n) {
            return true;
        }
        if let Some(old) = self.back(usize::from(config.lag)) {
            self.learn(old.force_n);
        }
        false
    }

    /// Sample `age` steps before the newest.
    fn back(&self, age: usize) -> Option<Sample> {
        let index = (self.seen as usize).checked_sub(1 + age)?;
        self.ring.get(index % BUFFER_LEN).copied().filter(|_| age < BUFFER_LEN)
    }

    /// Running mean and variance (Welford, with a memory).
    fn learn(&mut self, force_n: f32) {
        self.baseline_count = (self.baseline_count + 1).min(BASELINE_MEMORY);
        let weight = 1.0 / f32::from(self.baseline_count);
        let off_n = force_n - self.zero_n;
        self.zero_n += weight * off_n;
        self.variance_n2 = (1.0 - weight) * (self.variance_n2 + weight * off_n * off_n);
    }

    /// Buffered samples, oldest first.
    pub fn samples(&self) -> impl Iterator<Item = Sample> + '_ {
        let held = (self.seen as usize).min(BUFFER_LEN);
        (0..held).rev().filter_map(|age| self.back(age))
    }

    /// The contact point by back-extrapolation; call once contact is detected. Costs about 40 passes over the buffer.
    pub fn locate(&self, config: &ContactConfig) -> ContactPoint {
        let newest = self.back(0).unwrap_or_default();
        let coarse_mm = config.reach_mm / 32.0;
        let (best, _) = self.line_search(newest.probe_mm + 0.5 * coarse_mm, coarse_mm, 32, self.zero_n);
        // The zero again, from the buffer before the contact alone: the running one may have seen its beginning.
        let (mut sum, mut count) = (0.0, 0u16);
        for s in self.samples().filter(|s| s.probe_mm > best + 2.0 * coarse_mm) {
            sum += s.force_n;
            count += 1;
        }
        let (zero_n, zero_samples) = if count >= config.baseline_min {
            (sum / f32::from(count), count)
        } else {
            (self.zero_n, self.baseline_count)
        };
        let fine_mm = coarse_mm / 4.0;
        let (height_mm, _) = self.line_search(best - 4.0 * fine_mm, fine_mm, 9, zero_n);
        ContactPoint { height_mm, zero_n, noise_n: sqrt(self.variance_n2), zero_samples }
    }

    /// Least misfit over `steps` heights from `from_mm` upwards, refined by a parabola.
    fn line_search(&self, from_mm: f32, step_mm: f32, steps: usize, zero_n: f32) -> (f32, f32) {
        least(from_mm, step_mm, steps, |height_mm| self.misfit(height_mm, zero_n))
    }

    /// Squares left by the best `c (d0 - x)^1.5` with `d0 = height_mm`, N^2.
    fn misfit(&self, height_mm: f32, zero_n: f32) -> f32 {
        let (mut ff, mut pf, mut pp) = (0.0, 0.0, 0.0);
        for s in self.samples() {
            let force_n = s.force_n - zero_n;
            ff += force_n * force_n;
            let depth_mm = height_mm - s.probe_mm;
            if depth_mm > 0.0 {
                let p = depth_mm * sqrt(depth_mm);
                pf += p * force_n;
                pp += p * p;
            }
        }
        // A negative amplitude would be adhesion to nothing.
        if pp > 0.0 && pf > 0.0 { ff - pf * pf / pp } else { ff }
    }
}

/// The place of the least of `steps` values of `f` at `from, from + step, ...`, moved by the parabola through it and its
/// neighbours, and the least value.
pub fn least(from: f32, step: f32, steps: usize, mut f: impl FnMut(f32) -> f32) -> (f32, f32) {
    let mut line = LeastOnLine::new(from, step);
    for _ in 0..steps {
        let x = line.next_x();
        line.put(f(x));
    }
    line.result()
}

/// Search for the least value along a line, one evaluation at a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LeastOnLine {
    from: f32,
    step: f32,
    taken: u16,
    best: u16,
    value: f32,
    before: f32,
    after: f32,
    last: f32,
}

impl LeastOnLine {
    /// Places `from, from + step, ...`.
    pub const fn new(from: f32, step: f32) -> Self {
        LeastOnLine {
            from,
            step,
            taken: 0,
            best: 0,
            value: f32::INFINITY,
            before: f32::INFINITY,
            after: f32::INFINITY,
            last: f32::INFINITY,
        }
    }

    /// Number of values so far.
    pub const fn taken(&self) -> u16 {
        self.taken
    }

    /// Where the next value is wanted.
    pub fn next_x(&self) -> f32 {
        self.from + self.step * f32::from(self.taken)
    }

    /// Takes the value at [`LeastOnLine::next_x`].
    pub fn put(&mut self, value: f32) {
        if value < self.value {
            (self.best, self.before, self.value) = (self.taken, self.last, value);
            self.after = f32::INFINITY;
        } else if self.taken == self.best + 1 {
            self.after = value;
        }
        self.last = value;
        self.taken = self.taken.saturating_add(1);
    }

    /// Place and value of the least, by the parabola through it and its neighbours.
    pub fn result(&self) -> (f32, f32) {
        let x = self.from + self.step * f32::from(self.best);
        let curvature = self.before - 2.0 * self.value + self.after;
        if !(curvature > 0.0 && curvature.is_finite()) {
            return (x, self.value);
        }
        let slope = self.before - self.after;
        let shift = 0.5 * slope / curvature;
        (x + shift * self.step, self.value - 0.25 * slope * shift)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;
    use crate::testbed::{Chance, LIBRARY, Press};

    fn detect(samples: &[Sample]) -> Option<ContactPoint> {
        let config = ContactConfig::default();
        let mut contact = Contact::new();
        let found = samples.iter().any(|s| contact.step(&config, *s));
        found.then(|| contact.locate(&config))
    }

    #[test]
    fn a_clean_press_is_located_to_three_hundredths_of_a_millimetre() {
        // What is left is the departure of the foam from Hertz over the depth at which contact is detected.
        for foam in LIBRARY {
            for rate in [1.0, 2.0, 4.0] {
                let press = Press::clean(foam, rate);
                let point = detect(&press.samples(&mut Chance(1))).unwrap();
                let off_mm = f64::from(point.height_mm) - press.surface_mm();
                assert!(off_mm.abs() < 0.03, "{} at {rate} mm/s: {off_mm} mm", foam.name);
                assert!((point.zero_n - 0.01).abs() < 1e-4, "{}: zero {}", foam.name, point.zero_n);
            }
        }
    }

    #[test]
    fn noise_of_one_percent_leaves_a_tenth_of_a_millimetre_for_stiff_and_soft_foams() {
        let mut chance = Chance(2);
        for foam in LIBRARY {
            for rate in [1.0, 2.0, 4.0] {
                let offs: Vec<f64> = (0..40)
                    .map(|_| {
                        let press = Press::noisy(foam, rate, &mut chance);
                        let point = detect(&press.samples(&mut chance)).unwrap();
                        f64::from(point.height_mm) - press.surface_mm()
                    })
                    .collect();
                let rms = (offs.iter().map(|o| o * o).sum::<f64>() / offs.len() as f64).sqrt();
                // Measured 0.06 to 0.17 mm over 60 presses each, most at 4 mm/s; 0.25 is half above the worst.
                assert!(rms < 0.25, "{} at {rate} mm/s: {rms} mm", foam.name);
            }
        }
    }

    #[test]
    fn noise_alone_is_no_contact() {
        let mut chance = Chance(3);
        let (config, mut alarms) = (ContactConfig::default(), 0);
        for _ in 0..200 {
            let mut contact = Contact::new();
            for i in 0..1000 {
                let sample = Sample { probe_mm: 50.0 - 0.02 * i as f32, force_n: 0.05 * chance.normal() as f32 };
                if contact.step(&config, sample) {
                    alarms += 1;
                    break;
                }
            }
        }
        // 2e5 samples; the estimate in `ContactConfig::consecutive` expects none.
        assert_eq!(alarms, 0);
    }

    #[test]
    fn a_press_that_begins_in_contact_is_contact() {
        let config = ContactConfig::default();
        let mut contact = Contact::new();
        let sample = Sample { probe_mm: 10.0, force_n: 2.0 };
        assert!((0..10).any(|_| contact.step(&config, sample)));
        assert!(contact.locate(&config).height_mm.is_finite());
    }

    #[test]
    fn least_finds_the_bottom_of_a_parabola_between_places() {
        let (x, _) = least(0.0, 0.1, 11, |x| (x - 0.537) * (x - 0.537));
        assert!((x - 0.537).abs() < 1e-5, "{x}");
        // At an end there is no parabola.
        assert_eq!(least(0.0, 0.1, 3, |x| x).0, 0.0);
    }
}
