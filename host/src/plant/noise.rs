//! Seeded randomness, one stream a source.

use rand::{Rng, SeedableRng};
use rand_distr::StandardNormal;
use rand_pcg::Pcg64;

/// What is random; each source has its own stream.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u64)]
pub enum Source {
    /// White force noise at the load cell.
    Force = 1,
    /// Gain of a palpation.
    Gain = 2,
    /// Where the surface really is.
    Surface = 3,
    /// Which foam comes next.
    Choice = 4,
    /// Input noise of the analog converter.
    Converter = 5,
    /// Tremor of the hand.
    Tremor = 6,
    /// Repeatability of the FSR.
    Fsr = 7,
    /// Tremor of a hand that moves a bone.
    Hand = 8,
    /// Constants of a drawn plant.
    Constants = 9,
    /// Instruments beside a display: a load cell under it, a camera.
    Instruments = 10,
}

/// A stream of random numbers.
#[derive(Debug, Clone)]
pub struct Noise(Pcg64);

impl Noise {
    /// The stream of a source; the same seed gives the same numbers.
    pub fn new(seed: u64, source: Source) -> Self {
        // Seeds and sources are small numbers: SplitMix64's mixing (Steele, Lea, Flood 2014) spreads them.
        let mut z = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15).wrapping_add(source as u64);
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        Noise(Pcg64::seed_from_u64(z ^ (z >> 31)))
    }

    /// A normally distributed number, mean 0, standard deviation 1.
    pub fn normal(&mut self) -> f64 {
        self.0.sample(StandardNormal)
    }

    /// A number from `0..n`; 0 for `n` = 0.
    pub fn below(&mut self, n: usize) -> usize {
        self.0.random_range(0..n.max(1))
    }

    /// Shuffles in place.
    pub fn shuffle<T>(&mut self, items: &mut [T]) {
        use rand::seq::SliceRandom;
        items.shuffle(&mut self.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn streams_repeat_and_differ_by_seed_and_source() {
        let first = |seed, source| Noise::new(seed, source).normal();
        assert_eq!(first(1, Source::Force), first(1, Source::Force));
        assert_ne!(first(1, Source::Force), first(2, Source::Force));
        assert_ne!(first(1, Source::Force), first(1, Source::Gain));
    }

    #[test]
    fn normal_numbers_have_mean_0_and_deviation_1() {
        let mut noise = Noise::new(7, Source::Force);
        let n = 20_000;
        let (mut sum, mut squares) = (0.0, 0.0);
        for _ in 0..n {
            let x = noise.normal();
            sum += x;
            squares += x * x;
        }
        let n = f64::from(n);
        // Four standard errors of mean and variance: 4/sqrt(n) and 4 sqrt(2/n).
        assert!((sum / n).abs() < 4.0 / n.sqrt());
        assert!((squares / n - 1.0).abs() < 4.0 * (2.0 / n).sqrt());
    }
}
