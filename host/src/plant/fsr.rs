//! The force sensing resistor on the display's cap.

use super::{Noise, Source};

/// Conductance over force is linear (thesis Eq. 43, ERRATA: mS over units of 100 gf), with what the
/// Interlink 400 data sheet adds: repeatability, hysteresis, creep.
#[derive(Debug, Clone)]
pub struct Fsr {
    slope_ms: f64,
    offset_ms: f64,
    divider_kohm: f64,
    noise: Noise,
    /// Force the hysteresis remembers, N.
    held_n: f64,
    /// Time under load, s.
    loaded_s: f64,
    reading_noise: f64,
    flaws: FsrFlaws,
}

/// What a real sensor adds to the line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FsrFlaws {
    /// Half width of the hysteresis, fraction of the force.
    pub hysteresis: f64,
    /// Creep, fraction of the reading per decade of time under load.
    pub creep: f64,
    /// Exponent of conductance over force; 1 is the line. The two agree at 3 N.
    pub power: f64,
    /// Noise of one reading, fraction.
    pub noise: f64,
}

impl FsrFlaws {
    /// The thesis' line, without noise.
    pub const NONE: Self = Self { hysteresis: 0.0, creep: 0.0, power: 1.0, noise: 0.0 };
}

impl Default for FsrFlaws {
    /// Those of the bench.
    fn default() -> Self {
        Self { hysteresis: HYSTERESIS, creep: CREEP, power: 1.0, noise: NOISE }
    }
}

/// 100 gf in N.
const UNIT_N: f64 = 0.980_665;

/// Width of the hysteresis, fraction of the force: +10 % (data sheet), half of it to either side.
const HYSTERESIS: f64 = 0.05;

/// Creep, fraction of the reading per decade of time under load (data sheet: below 5 %).
const CREEP: f64 = 0.03;

/// Noise of one reading, fraction (data sheet: repeatability 2 % from touch to touch; within a touch far less).
const NOISE: f64 = 0.005;

/// Conductance without load, mS (data sheet: above 10 MOhm).
const OPEN_MS: f64 = 1e-4;

/// Force at which a bent sensor reads as the line does, N.
const PIVOT_N: f64 = 3.0;

/// Force below which the sensor counts as untouched and its creep recovers, N.
const TOUCHED_N: f64 = 0.05;

impl Fsr {
    /// A sensor with the law `conductance = slope F + offset`, F in 100 gf, behind a divider.
    pub fn new(slope_ms: f64, offset_ms: f64, divider_kohm: f64, seed: u64) -> Self {
        Fsr {
            slope_ms,
            offset_ms,
            divider_kohm,
            noise: Noise::new(seed, Source::Fsr),
            held_n: 0.0,
            loaded_s: 0.0,
            reading_noise: 0.0,
            flaws: FsrFlaws::default(),
        }
    }

    /// The same sensor with other flaws.
    #[must_use]
    pub fn with(mut self, flaws: FsrFlaws) -> Self {
        self.flaws = flaws;
        self
    }

    /// Lets `dt_s` pass under a force.
    pub fn step(&mut self, force_n: f64, dt_s: f64) {
        // Play: what the sensor feels lags by a fixed share of the force, on either side.
        let play = self.flaws.hysteresis * force_n.max(0.0);
        self.held_n = self.held_n.clamp(force_n - play, force_n + play).max(0.0);
        self.loaded_s = if force_n > TOUCHED_N { self.loaded_s + dt_s } else { 0.0 };
    }

    /// Draws the noise of the next reading.
    pub fn next_sample(&mut self) {
        self.reading_noise = self.flaws.noise * self.noise.normal();
    }

    /// Conductance, mS.
    pub fn conductance_ms(&self) -> f64 {
        // Decades since a tenth of a second.
        let decades = (1.0 + self.loaded_s / 0.1).log10();
        let gain = (1.0 + self.flaws.creep * decades) * (1.0 + self.reading_noise);
        let bent = self.flaws.power != 1.0;
        let felt_n = if bent { PIVOT_N * (self.held_n / PIVOT_N).powf(self.flaws.power) } else { self.held_n };
        (gain * (self.slope_ms * felt_n / UNIT_N + self.offset_ms)).max(OPEN_MS)
    }

    /// Voltage over the fixed resistor, fraction of the reference.
    pub fn ratio(&self) -> f64 {
        let r = 1.0 / self.conductance_ms();
        self.divider_kohm / (self.divider_kohm + r)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sensor() -> Fsr {
        Fsr::new(0.079, -0.016, 1.6, 1)
    }

    #[test]
    fn unloading_reads_higher_and_holding_creeps() {
        let mut fsr = sensor();
        for i in 0..200 {
            fsr.step(4.0 * f64::from(i) / 200.0, 1e-3);
        }
        fsr.step(2.0, 1e-3);
        let after_more = fsr.conductance_ms();
        let mut fresh = sensor();
        for i in 0..=200 {
            fresh.step(2.0 * f64::from(i) / 200.0, 1e-3);
        }
        let from_less = fresh.conductance_ms();
        assert!(after_more > from_less * 1.05);
        for _ in 0..10_000 {
            fresh.step(2.0, 1e-3);
        }
        let crept = fresh.conductance_ms() / from_less;
        assert!((1.03..1.10).contains(&crept), "{crept}");
    }

    #[test]
    fn without_load_it_is_open() {
        assert!(1.0 / sensor().conductance_ms() >= 1e4);
    }
}
