//! How well stimuli are told apart, in standard deviations of what is felt.

use crate::infer::mixture::normal_below;

const Z95: f64 = 1.959_963_984_540_054;
/// Largest d' that is looked for.
const MOST: f64 = 12.0;
const HALVINGS: usize = 80;

/// Quantile of the standard normal distribution, -8 to 8.
#[must_use]
pub fn quantile(share: f64) -> f64 {
    let (mut low, mut high) = (-8.0, 8.0);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if normal_below(middle) < share { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// Density of the standard normal distribution.
fn density(x: f64) -> f64 {
    (-0.5 * x * x).exp() / (2.0 * std::f64::consts::PI).sqrt()
}

/// A d' with its 95 % interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Distance {
    /// Estimate.
    pub value: f64,
    /// Interval.
    pub interval95: (f64, f64),
    /// Criterion: 0 for an observer without preference, above 0 for one that prefers the second answer.
    pub criterion: f64,
    /// Counts of 0 made the log-linear correction necessary: half a count is added to every cell.
    pub corrected: bool,
}

/// d' of two stimuli with two answers, `[[a, b], [c, d]]` with the rows shown and the columns answered: z(a/(a+b)) - z(c/(c+d)). With an empty
/// cell half a count is added to each (Hautus 1995, doi:10.3758/BF03203619). Interval after Gourevitch and Galanter (1967,
/// doi:10.1007/BF02289402). None where a stimulus was not shown.
#[must_use]
pub fn pair(counts: [[u32; 2]; 2]) -> Option<Distance> {
    let sums = counts.map(|row| row[0] + row[1]);
    if sums.contains(&0) {
        return None;
    }
    let corrected = counts.iter().flatten().any(|n| *n == 0);
    let more = if corrected { 0.5 } else { 0.0 };
    let part = |row: usize| {
        let n = f64::from(sums[row]) + 2.0 * more;
        let p = (f64::from(counts[row][0]) + more) / n;
        let z = quantile(p);
        (z, p * (1.0 - p) / (n * density(z).powi(2)))
    };
    let ((hit, hit_variance), (alarm, alarm_variance)) = (part(0), part(1));
    let reach = Z95 * (hit_variance + alarm_variance).sqrt();
    let value = hit - alarm;
    Some(Distance { value, interval95: (value - reach, value + reach), criterion: -0.5 * (hit + alarm), corrected })
}

/// Share of right answers of an unbiased observer that chooses among `choices` equally distant stimuli: the integral of
/// `phi(x - d) Phi(x)^(m - 1)` (Green and Swets 1966, chapter 6).
#[must_use]
pub fn right_of(distance: f64, choices: usize) -> f64 {
    const STEP: f64 = 0.01;
    let power = i32::try_from(choices.saturating_sub(1)).unwrap_or(i32::MAX);
    // The trapezoidal rule is exact to rounding for a smooth function that vanishes at both ends.
    let count = ((distance.abs() + 18.0) / STEP) as usize;
    (0..=count)
        .map(|k| {
            let x = -9.0 + distance.min(0.0) + STEP * k as f64;
            density(x - distance) * normal_below(x).powi(power)
        })
        .sum::<f64>()
        * STEP
}

/// d' at which an unbiased observer of `choices` is right with this probability: 0 at chance and below, infinite at certainty.
#[must_use]
pub fn distance_of(right: f64, choices: usize) -> f64 {
    if right >= 1.0 {
        return f64::INFINITY;
    }
    if right * choices as f64 <= 1.0 {
        return 0.0;
    }
    let (mut low, mut high) = (0.0, MOST);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if right_of(middle, choices) < right { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};
    use rand_pcg::Pcg64Mcg;

    use super::*;

    #[test]
    fn quantiles_are_those_of_tables() {
        for (p, z) in [(0.5, 0.0), (0.75, 0.674_489_75), (0.975, 1.959_963_98), (0.001, -3.090_232_3)] {
            assert!((quantile(p) - z).abs() < 1e-7, "{p}");
        }
    }

    /// Table 9 by hand: z(0.68) = 0.4677, z(11/25) = -0.1510.
    #[test]
    fn the_thesis_pair_has_a_distance_of_0_62() {
        let found = pair([[17, 8], [11, 14]]).unwrap();
        assert!((found.value - 0.6187).abs() < 2e-4 && !found.corrected, "{found:?}");
        assert!(found.interval95.0 < 0.0 && found.interval95.1 > 1.2, "{found:?}");
        assert!(pair([[25, 0], [0, 25]]).unwrap().corrected);
        assert_eq!(pair([[0, 0], [1, 2]]), None);
    }

    /// For two choices the share is Phi(d / sqrt 2); for m at d = 0 it is 1 / m; of four it is counted over 200,000 draws, whose standard error
    /// is 0.11 %.
    #[test]
    fn shares_of_choices_agree_with_closed_forms_and_draws() {
        for d in [0.0, 0.5, 2.0] {
            assert!((right_of(d, 2) - normal_below(d / 2.0_f64.sqrt())).abs() < 1e-9);
        }
        assert!((right_of(0.0, 5) - 0.2).abs() < 1e-9);
        let mut random = Pcg64Mcg::seed_from_u64(3);
        let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
        let right = (0..200_000).filter(|_| normal() + 1.0 > normal().max(normal()).max(normal())).count();
        assert!((right_of(1.0, 4) - right as f64 / 2e5).abs() < 0.0045, "{} {right}", right_of(1.0, 4));
        assert!((distance_of(right_of(1.7, 3), 3) - 1.7).abs() < 1e-9);
        assert_eq!(distance_of(0.2, 2), 0.0);
    }
}
