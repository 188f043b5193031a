//! The analog converter: 12 bit, oversampled.

use super::{Noise, Source};

/// Codes of the converter (STM32F429 data sheet: 12 bit).
const CODES: f64 = 4096.0;

/// Readings averaged into one.
pub const OVERSAMPLED: usize = 16;

/// Input noise, codes (typical of the STM32F4's converter at 3.3 V; it is also the dither that makes the
/// average finer than a code).
const NOISE_CODES: f64 = 0.7;

/// A ratiometric converter.
#[derive(Debug, Clone)]
pub struct Converter {
    noise: Noise,
}

impl Converter {
    /// A converter with its own noise.
    pub fn new(seed: u64) -> Self {
        Converter { noise: Noise::new(seed, Source::Converter) }
    }

    /// Voltages of the oversampled readings with the input's noise, in codes and not rounded, of a voltage that is a fraction of the
    /// reference, 0 to 1.
    pub fn voltages(&mut self, true_ratio: f64) -> [f64; OVERSAMPLED] {
        std::array::from_fn(|_| true_ratio * CODES + NOISE_CODES * self.noise.normal())
    }

    /// Mean of the oversampled readings of a voltage, both as fraction of the reference, 0 to 1.
    pub fn ratio(&mut self, true_ratio: f64) -> f32 {
        // The first transition lies at half a code (STM32F429 data sheet): a code stands for the voltages about its own.
        let sum: f64 = self.voltages(true_ratio).map(|code| code.round().clamp(0.0, CODES - 1.0)).iter().sum();
        (sum / OVERSAMPLED as f64 / CODES) as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn oversampling_resolves_below_a_code_without_bias() {
        let mut converter = Converter::new(3);
        let truth = 0.123_456;
        let n = 400;
        let mean = (0..n).map(|_| f64::from(converter.ratio(truth))).sum::<f64>() / f64::from(n);
        // Each reading has about 0.76 codes of noise (dither and quantisation), 16 averaged, n of them:
        // four standard errors.
        let tolerance = 4.0 * 0.76 / (16.0 * f64::from(n)).sqrt() / 4096.0;
        assert!((mean - truth).abs() < tolerance, "{mean} for {truth}");
    }

    #[test]
    fn rails_hold() {
        let mut converter = Converter::new(3);
        assert!(converter.ratio(2.0) <= 1.0);
        assert!(converter.ratio(-1.0) >= 0.0);
    }
}
