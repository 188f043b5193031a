//! Exact binomial statements.

use crate::calibration::distribution::fisher_critical;

/// 95 % interval of a probability from `hits` of `trials` (Clopper and Pearson 1934, doi:10.1093/biomet/26.4.404), by quantiles of
/// Fisher's distribution. 0 to 1 without trials.
#[must_use]
pub fn interval95(hits: u32, trials: u32) -> (f64, f64) {
    interval(hits, trials, 0.05)
}

/// The interval that misses with at most the probability `miss`, half of it on each side.
#[must_use]
pub fn interval(hits: u32, trials: u32, miss: f64) -> (f64, f64) {
    let (k, n) = (f64::from(hits.min(trials)), f64::from(trials));
    let low = if k == 0.0 {
        0.0
    } else {
        let f = fisher_critical(0.5 * miss, (2.0 * (n - k + 1.0), 2.0 * k));
        k / (k + (n - k + 1.0) * f)
    };
    let high = if k == n {
        1.0
    } else {
        let f = fisher_critical(0.5 * miss, (2.0 * (k + 1.0), 2.0 * (n - k)));
        (k + 1.0) * f / (n - k + (k + 1.0) * f)
    };
    (low, high)
}

/// Probabilities of 0 to n hits in n trials.
fn binomial(n: u32, p: f64) -> Vec<f64> {
    if p <= 0.0 || p >= 1.0 {
        let sure = if p <= 0.0 { 0 } else { n };
        return (0..=n).map(|k| f64::from(u8::from(k == sure))).collect();
    }
    // Logarithms, so that no term of a large n vanishes on the way.
    let mut log = f64::from(n) * (1.0 - p).ln();
    let odds = (p / (1.0 - p)).ln();
    (0..=n)
        .map(|k| {
            let here = log.exp();
            log += (f64::from(n - k) / f64::from(k + 1)).ln() + odds;
            here
        })
        .collect()
}

/// Probability of `hits` or more by chance alone.
#[must_use]
pub fn tail(hits: u32, trials: u32, chance: f64) -> f64 {
    binomial(trials, chance).iter().skip(hits as usize).sum::<f64>().min(1.0)
}

/// Most trials that a sample size is searched among.
pub const MOST_TRIALS: u32 = 5000;

/// Fewest trials after which a subject that is right with probability `right` is found better than `chance` (one-sided 5 %) with
/// probability `power`, here and for the next twenty numbers of trials, as the power goes up and down; none within [`MOST_TRIALS`].
#[must_use]
pub fn trials_to_beat_chance(right: f64, chance: f64, power: f64) -> Option<u32> {
    const STAYS: u32 = 20;
    if right <= chance {
        return None;
    }
    let mut since = None;
    for n in 1..=MOST_TRIALS {
        let under_chance = binomial(n, chance);
        // The fewest hits that chance reaches at most once in twenty.
        let (mut left, mut needed) = (0.0, n + 1);
        for k in (0..=n).rev() {
            left += under_chance[k as usize];
            if left > 0.05 {
                break;
            }
            needed = k;
        }
        let found: f64 = binomial(n, right).iter().skip(needed as usize).sum();
        match (found >= power, since) {
            (true, None) => since = Some(n),
            (false, _) => since = None,
            _ => {}
        }
        if since.is_some_and(|first| n - first >= STAYS) {
            return since;
        }
    }
    None
}

/// Fewest trials for which the interval around a probability is no wider than twice `half`; none within [`MOST_TRIALS`].
#[must_use]
pub fn trials_for_width(right: f64, half: f64) -> Option<u32> {
    let narrow = |n: u32| {
        let hits = (right * f64::from(n)).round() as u32;
        let (low, high) = interval95(hits, n);
        high - low <= 2.0 * half
    };
    let (mut low, mut high) = (1, MOST_TRIALS);
    if !narrow(high) {
        return None;
    }
    while high - low > 1 {
        let middle = u32::midpoint(low, high);
        if narrow(middle) { high = middle } else { low = middle }
    }
    Some(high)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Closed forms: n of n has (miss/2)^(1/n), 0 of n its mirror image.
    #[test]
    fn the_ends_of_certainty_have_closed_forms() {
        for n in [1, 4, 25, 100] {
            let low = 0.025_f64.powf(1.0 / f64::from(n));
            let (got, one) = interval95(n, n);
            assert!((got - low).abs() < 1e-9 && one == 1.0, "{n}: {got} for {low}");
            let (zero, high) = interval95(0, n);
            assert!(zero == 0.0 && (high - (1.0 - low)).abs() < 1e-9);
        }
    }

    /// The definition: at the lower end as many hits or more have probability 2.5 %, at the upper end as many or fewer.
    #[test]
    fn the_ends_are_where_the_tails_have_a_fortieth() {
        for (k, n) in [(17, 25), (14, 25), (1, 8), (31, 50), (99, 100)] {
            let (low, high) = interval95(k, n);
            assert!((tail(k, n, low) - 0.025).abs() < 1e-7, "{k} of {n}");
            assert!((1.0 - tail(k + 1, n, high) - 0.025).abs() < 1e-7, "{k} of {n}");
        }
    }

    #[test]
    fn a_coverage_of_95_percent_is_held_for_every_probability() {
        for p in [0.03, 0.2, 0.5, 0.68, 0.9] {
            let covered: f64 = (0..=40)
                .filter(|k| {
                    let (low, high) = interval95(*k, 40);
                    low <= p && p <= high
                })
                .map(|k| binomial(40, p)[k as usize])
                .sum();
            assert!(covered >= 0.95, "{p}: {covered}");
        }
    }

    /// By hand: heads every time has p = 2^-n, so 5 tosses are the fewest that beat chance at 5 %.
    #[test]
    fn sample_sizes_have_the_power_that_is_asked_for() {
        assert_eq!(trials_to_beat_chance(1.0, 0.5, 0.8), Some(5));
        assert_eq!(trials_to_beat_chance(0.5, 0.5, 0.8), None);
        let n = trials_to_beat_chance(0.62, 0.5, 0.8);
        // Normal approximation with correction: ((1.645 x 0.5 + 0.842 x 0.485) / 0.12)^2 = 106.
        assert!(n.is_some_and(|n| (95..=125).contains(&n)), "{n:?}");
        let n = trials_for_width(0.8, 0.1);
        // 1.96^2 x 0.16 / 0.01 = 61; the exact interval is wider.
        assert!(n.is_some_and(|n| (61..=80).contains(&n)), "{n:?}");
    }
}
