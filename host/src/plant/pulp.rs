//! The pulp between a finger's bone and what it touches.

use super::Curve;

/// Force of the pulp at rest over its compression, from finite elements, and what of it relaxes.
#[derive(Debug, Clone, PartialEq)]
pub struct PulpLaw {
    /// Force after all relaxation over compression, N and mm.
    pub slow: Curve,
    /// Part of the instantaneous force that relaxes, 0 to less than 1, and its time, s.
    pub relaxing: (f64, f64),
}

/// Force of the round finger on a plate, by finite elements.
const ROUND: &str = include_str!("../../plants/pulp.csv");

impl PulpLaw {
    /// The round finger, giving way `softness` times as far; of its force at once a part relaxes, in a time (s).
    pub fn round(softness: f64, relaxing: (f64, f64)) -> Self {
        let rows = ROUND.lines().filter_map(|line| line.split_once(','));
        let points: Vec<(f64, f64)> = rows.filter_map(|(u, n)| Some((u.parse().ok()?, n.parse().ok()?))).collect();
        let step = points.first().map_or(0.0, |first| first.0);
        let force: Vec<f64> = points.iter().map(|point| point.1).collect();
        // A test reads the table; a spring of 1 N/mm stands for one that is none.
        let slow = Curve::new(softness * step, &force)
            .or_else(|| Curve::new(1.0, &[1.0, 2.0]))
            .unwrap_or_else(|| unreachable!("a spring"));
        PulpLaw { slow, relaxing }
    }
}

/// The pulp of a finger that touches.
#[derive(Debug, Clone)]
pub struct Pulp {
    law: PulpLaw,
    /// The instantaneous elastic force, as slowly as its relaxing part follows it, N.
    followed_n: f64,
}

impl Pulp {
    /// A pulp at rest.
    pub fn new(law: PulpLaw) -> Self {
        Pulp { law, followed_n: 0.0 }
    }

    /// Instantaneous elastic force at a compression, N: what is left of it is the slow curve.
    fn instant_n(&self, compression_mm: f64) -> f64 {
        self.law.slow.force_n(compression_mm) / (1.0 - self.law.relaxing.0)
    }

    /// Force at a compression now, N; a finger pushes and cannot pull.
    pub fn force_n(&self, compression_mm: f64) -> f64 {
        if compression_mm <= 0.0 {
            return 0.0;
        }
        (self.instant_n(compression_mm) - self.law.relaxing.0 * self.followed_n).max(0.0)
    }

    /// Compression at which the force is `force_n` now, mm; 0 for no force.
    pub fn compression_mm(&self, force_n: f64) -> f64 {
        let (mut low, mut high) = (0.0, 1.0);
        while self.force_n(high) < force_n && high < FARTHEST_MM {
            high *= 2.0;
        }
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if self.force_n(middle) < force_n { low = middle } else { high = middle }
        }
        0.5 * (low + high)
    }

    /// Lets `dt_s` pass at a compression.
    pub fn step(&mut self, compression_mm: f64, dt_s: f64) {
        let instant = if compression_mm > 0.0 { self.instant_n(compression_mm) } else { 0.0 };
        self.followed_n += (instant - self.followed_n) * (1.0 - (-dt_s / self.law.relaxing.1).exp());
    }
}

/// No pulp is compressed so far, mm.
const FARTHEST_MM: f64 = 64.0;
/// Halvings of an interval of 64 mm: 1e-11 mm.
const HALVINGS: usize = 42;

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn pulp() -> Pulp {
        let force: Vec<f64> = (1..=40).map(|i| (0.1 * f64::from(i)).powi(2)).collect();
        Pulp::new(PulpLaw { slow: Curve::new(0.1, &force).unwrap(), relaxing: (0.25, 0.5) })
    }

    #[test]
    fn a_held_pulp_relaxes_to_its_slow_curve() {
        let mut pulp = pulp();
        assert!((pulp.force_n(2.0) - 4.0 / 0.75).abs() < 1e-9, "all at once");
        for _ in 0..500 {
            pulp.step(2.0, 1e-3);
        }
        // one time constant
        let exact = 4.0 / 0.75 * (0.75 + 0.25 * (-1.0_f64).exp());
        assert!((pulp.force_n(2.0) - exact).abs() < 1e-9, "{}", pulp.force_n(2.0));
        (0..20_000).for_each(|_| pulp.step(2.0, 1e-3));
        assert!((pulp.force_n(2.0) - 4.0).abs() < 1e-9);
        assert_eq!(pulp.force_n(-0.1), 0.0);
        assert_eq!(pulp.force_n(0.5), 0.0, "it lags behind a finger that lifts");
    }

    #[test]
    fn compression_is_the_inverse_of_force() {
        let mut pulp = pulp();
        (0..100).for_each(|_| pulp.step(1.0, 1e-3));
        for force_n in [0.3, 1.0, 7.0, 30.0] {
            assert!((pulp.force_n(pulp.compression_mm(force_n)) - force_n).abs() < 1e-8, "{force_n}");
        }
    }
}
