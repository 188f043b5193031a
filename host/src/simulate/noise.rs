//! What chance adds to readings.

use rand::Rng;
use rand_distr::{StandardNormal, StudentT};
use rand_pcg::Pcg64;

use super::chance::{Purpose, stream};
use super::spec::{Noise, Spec};

/// Correlated noise of unit standard deviation, sample after sample.
#[derive(Debug, Clone)]
pub(super) struct Correlated {
    chance: Pcg64,
    keep: f64,
    state: Option<f64>,
    tails: Option<StudentT<f64>>,
}

impl Correlated {
    /// The noise of a run, sampled every `step_s`.
    pub fn new(noise: &Noise, chance: Pcg64, step_s: f64) -> Self {
        let keep = if noise.correlation_s > 0.0 { (-step_s / noise.correlation_s).exp() } else { 0.0 };
        let tails = if noise.heavy_tails { StudentT::new(3.0).ok() } else { None };
        Self { chance, keep, state: None, tails }
    }

    /// The next value: AR(1) with the stationary variance from the first sample on.
    pub fn next(&mut self) -> f64 {
        let fresh = match &self.tails {
            // the variance of t with 3 degrees of freedom is 3
            Some(tails) => self.chance.sample(tails) / 3.0_f64.sqrt(),
            None => self.chance.sample(StandardNormal),
        };
        let value = match self.state {
            None => fresh,
            Some(before) => self.keep * before + (1.0 - self.keep * self.keep).sqrt() * fresh,
        };
        self.state = Some(value);
        value
    }
}

/// Seconds between the knots of the wandering zero.
const KNOT_S: f64 = 10.0;

/// The wandering zero of a session of a length (s), a random walk.
#[derive(Debug, Clone)]
pub(super) struct Wander(Vec<f64>);

impl Wander {
    pub fn new(spec: &Spec, session_s: f64) -> Self {
        let step = spec.noise.drift_n_per_h * (KNOT_S / 3600.0).sqrt();
        if step == 0.0 {
            return Self(Vec::new());
        }
        let mut chance = stream(spec.seed, Purpose::Drift, 0);
        let mut walk = vec![0.0];
        for _ in 0..(session_s / KNOT_S).ceil() as usize + 1 {
            let last = walk.last().copied().unwrap_or(0.0);
            walk.push(last + step * chance.sample::<f64, _>(StandardNormal));
        }
        Self(walk)
    }

    /// Zero (N) at a session time (s).
    pub fn at(&self, clock_s: f64) -> f64 {
        let place = clock_s / KNOT_S;
        let knot = place as usize;
        match (self.0.get(knot), self.0.get(knot + 1)) {
            (Some(a), Some(b)) => a + (b - a) * (place - knot as f64),
            _ => self.0.last().copied().unwrap_or(0.0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn draws(noise: &Noise, count: usize) -> Vec<f64> {
        let mut one = Correlated::new(noise, stream(3, Purpose::Sensor, 0), 0.02);
        (0..count).map(|_| one.next()).collect()
    }

    fn moments(x: &[f64]) -> (f64, f64) {
        let n = x.len() as f64;
        let variance = x.iter().map(|x| x * x).sum::<f64>() / n;
        let next = x.windows(2).map(|w| w[0] * w[1]).sum::<f64>() / n;
        (variance, next / variance)
    }

    /// 200,000 samples of correlation 0.82 hold about 20,000 independent squares: the variance scatters by 1 %.
    #[test]
    fn the_noise_has_unit_variance_and_the_stated_correlation() {
        let (variance, next) = moments(&draws(&Noise { correlation_s: 0.1, ..Noise::default() }, 200_000));
        assert!((variance - 1.0).abs() < 0.05, "{variance}");
        assert!((next - (-0.2_f64).exp()).abs() < 0.01, "{next}");
        let (_, white) = moments(&draws(&Noise::default(), 200_000));
        assert!(white.abs() < 0.01, "{white}");
    }

    /// 1.4 % of t_3 lies beyond 4 of its scale, 2.3 standard deviations scaled by sqrt 3 ...; of normal noise 6e-5 beyond 4 sd.
    #[test]
    fn heavy_tails_are_heavy() {
        let far = |heavy_tails| {
            let noise = Noise { heavy_tails, ..Noise::default() };
            draws(&noise, 100_000).iter().filter(|x| x.abs() > 4.0).count()
        };
        assert!(far(true) > 300 && far(false) < 30, "{} {}", far(true), far(false));
    }

    /// A walk of 360 steps ends within four of its standard deviations.
    #[test]
    fn the_zero_wanders_by_about_its_hourly_amount() {
        let mut spec = Spec::new("walk", 5);
        spec.noise.drift_n_per_h = 0.01;
        let walk = Wander::new(&spec, 3600.0);
        assert!(walk.at(0.0) == 0.0 && walk.at(3600.0) != 0.0 && walk.at(3600.0).abs() < 0.04);
        assert!((walk.at(5.0) - 0.5 * walk.at(10.0)).abs() < 1e-15);
    }
}
