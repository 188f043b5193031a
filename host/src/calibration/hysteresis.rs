//! Is a reading a function of one variable, or does it also depend on the direction and on how often it was done before?
//!
//! Samples of one press are not independent, so a press counts as one observation: every press gives one gap between its branches and one mean, and
//! Student's t judges their scatter from press to press.

use super::distribution::{student_critical, student_two_sided};
use super::polynomial::Polynomial;

/// Samples `(x, y)` of one press: x rises to its largest value and falls again.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Press {
    /// On the way up.
    pub rising: Vec<(f64, f64)>,
    /// On the way back.
    pub falling: Vec<(f64, f64)>,
}

/// Cuts a recording into presses: x rises from below `low` past `high` and comes back below `low`. What is not finished is left out.
#[must_use]
pub fn presses(samples: &[(f64, f64)], low: f64, high: f64) -> Vec<Press> {
    let mut found = Vec::new();
    let mut start: Option<usize> = None;
    let mut reached = false;
    for (at, (x, _)) in samples.iter().enumerate() {
        if *x < low {
            if let (Some(from), true) = (start, reached) {
                found.push(press(&samples[from..at]));
            }
            (start, reached) = (Some(at), false);
        }
        reached |= *x > high;
    }
    found
}

fn press(samples: &[(f64, f64)]) -> Press {
    let top = (0..samples.len()).max_by(|a, b| samples[*a].0.total_cmp(&samples[*b].0)).unwrap_or(0);
    Press { rising: samples[..=top].to_vec(), falling: samples[top..].to_vec() }
}

/// Mean of y where x lies within a half width of a station.
fn near(branch: &[(f64, f64)], station: f64, half: f64) -> Option<f64> {
    let inside = branch.iter().filter(|(x, _)| (x - station).abs() <= half);
    let (sum, count) = inside.fold((0.0, 0.0), |(sum, count), (_, y)| (sum + y, count + 1.0));
    (count > 0.0).then(|| sum / count)
}

/// Why presses cannot be compared.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum HysteresisError {
    /// Too few presses.
    #[error("{presses} presses pass every station on both ways: at least 3 are needed to see how presses differ")]
    TooFewPresses {
        /// Usable presses.
        presses: usize,
    },
    /// No stations.
    #[error("no station: name at least one x that every press passes")]
    NoStation,
}

/// Readings of one press at every station: on the way up, on the way back.
type Readings = [(f64, f64)];

/// A mean over presses, with its scatter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mean {
    /// The mean.
    pub value: f64,
    /// 95 % interval.
    pub interval95: (f64, f64),
    /// Probability that chance puts it so far from zero.
    pub probability: f64,
}

impl Mean {
    /// Of independent values; at least two.
    fn of(values: &[f64]) -> Self {
        let count = values.len() as f64;
        let value = values.iter().sum::<f64>() / count;
        let variance = values.iter().map(|v| (v - value).powi(2)).sum::<f64>() / (count - 1.0);
        let error = (variance / count).sqrt();
        let half = student_critical(0.05, count - 1.0) * error;
        let probability = student_two_sided(value / error, count - 1.0);
        Self { value, interval95: (value - half, value + half), probability }
    }
}

/// What depends on direction and on repetition.
#[derive(Debug, Clone, PartialEq)]
pub struct Hysteresis {
    /// Presses that were used.
    pub presses: usize,
    /// y on the way back less y on the way up at equal x, mean over the stations.
    pub gap: Mean,
    /// The same at every station.
    pub gaps: Vec<Mean>,
    /// Change of y from one press to the next, both branches and all stations together.
    pub trend: Mean,
    /// Mean of y at every station: on the way up, on the way back.
    pub levels: Vec<(f64, f64)>,
}

impl Hysteresis {
    /// Compares presses at stations of x, where y is the mean of the samples within a half width.
    ///
    /// # Errors
    /// See [`HysteresisError`].
    pub fn of(presses: &[Press], stations: &[f64], half: f64) -> Result<Self, HysteresisError> {
        if stations.is_empty() {
            return Err(HysteresisError::NoStation);
        }
        let both = |press: &Press| -> Option<Vec<(f64, f64)>> {
            stations.iter().map(|x| near(&press.rising, *x, half).zip(near(&press.falling, *x, half))).collect()
        };
        let used: Vec<Vec<(f64, f64)>> = presses.iter().filter_map(both).collect();
        if used.len() < 3 {
            return Err(HysteresisError::TooFewPresses { presses: used.len() });
        }
        let count = used.len() as f64;
        let over = |values: &dyn Fn(&Readings) -> f64| -> Vec<f64> { used.iter().map(|press| values(press)).collect() };
        let mean = |list: &mut dyn Iterator<Item = f64>| list.sum::<f64>() / stations.len() as f64;
        let gap = Mean::of(&over(&|press| mean(&mut press.iter().map(|(up, back)| back - up))));
        let gaps = (0..stations.len()).map(|k| Mean::of(&over(&|press| press[k].1 - press[k].0))).collect();
        let levels = (0..stations.len()).map(|k| {
            let sum = used.iter().fold((0.0, 0.0), |sum, press| (sum.0 + press[k].0, sum.1 + press[k].1));
            (sum.0 / count, sum.1 / count)
        });
        let middle = over(&|press| mean(&mut press.iter().map(|(up, back)| 0.5 * (up + back))));
        let points: Vec<(f64, f64)> = middle.iter().enumerate().map(|(n, y)| (n as f64, *y)).collect();
        let line = Polynomial::fit(&points, 1).map_err(|_| HysteresisError::TooFewPresses { presses: used.len() })?;
        let trend = Mean {
            value: line.coefficients[1].0,
            interval95: line.interval95(1),
            probability: line.probability(1, 0.0),
        };
        Ok(Self { presses: used.len(), gap, gaps, trend, levels: levels.collect() })
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use rand::{Rng, SeedableRng};
    use rand_pcg::Pcg64;

    use super::*;

    /// Presses to x = 1 with y = x + noise, a gap on the way back and a change per press. Noise is a step a press and a step a sample.
    fn recording(gap: f64, change: f64, seed: u64) -> Vec<(f64, f64)> {
        let mut chance = Pcg64::seed_from_u64(seed);
        let mut samples = Vec::new();
        for n in 0..12 {
            let press = chance.random_range(-0.02..0.02);
            for k in 0..200 {
                let x = 1.0 - (f64::from(k) - 100.0).abs() / 100.0;
                let back = if k > 100 { gap } else { 0.0 };
                let y = x + back + change * f64::from(n) + press + chance.random_range(-0.01..0.01);
                samples.push((x, y));
            }
        }
        samples.push((0.0, 0.0));
        samples
    }

    fn examined(gap: f64, change: f64, seed: u64) -> Hysteresis {
        let presses = presses(&recording(gap, change, seed), 0.1, 0.9);
        assert_eq!(presses.len(), 12);
        Hysteresis::of(&presses, &[0.3, 0.5, 0.7], 0.05).unwrap()
    }

    #[test]
    fn a_gap_and_a_trend_are_found_with_their_sizes() {
        let found = examined(-0.1, 0.02, 1);
        assert!((found.gap.value + 0.1).abs() < 0.01 && found.gap.probability < 1e-6, "{found:?}");
        assert!((found.trend.value - 0.02).abs() < 0.005 && found.trend.probability < 1e-4, "{found:?}");
        assert!((found.levels[1].0 - 0.5 - 5.5 * 0.02).abs() < 0.02);
        assert_eq!((found.presses, found.gaps.len()), (12, 3));
    }

    /// With common steps of a press in all its samples a test on samples would find something every time: at the 5 % level this one may in 4 of 40
    /// (probability of more than 4: 4.8 %), and 40 seeds are fixed.
    #[test]
    fn without_either_nothing_is_found() {
        let found: Vec<Hysteresis> = (0..40).map(|seed| examined(0.0, 0.0, 100 + seed)).collect();
        let gaps = found.iter().filter(|f| f.gap.probability < 0.05).count();
        let trends = found.iter().filter(|f| f.trend.probability < 0.05).count();
        assert!(gaps <= 4 && trends <= 4, "{gaps} gaps and {trends} trends of 40");
    }

    #[test]
    fn unfinished_presses_are_left_out_and_too_few_are_refused() {
        let mut samples = recording(0.0, 0.0, 3);
        samples.truncate(2 * 200 + 150);
        let found = presses(&samples, 0.1, 0.9);
        assert_eq!(found.len(), 2);
        let told = Hysteresis::of(&found, &[0.5], 0.05).unwrap_err().to_string();
        assert_eq!(told, "2 presses pass every station on both ways: at least 3 are needed to see how presses differ");
        assert_eq!(Hysteresis::of(&found, &[], 0.05).unwrap_err(), HysteresisError::NoStation);
    }
}
