//! A subject as noise on the logarithm of stiffness (Thurstone 1927, case V; Weber's law).
//!
//! A touch of a material of stiffness k is felt as `ln k + sigma * normal`. The Weber fraction w is the relative difference that two touches
//! tell apart in 75 of 100 cases: `ln(1 + w) = sqrt 2 * 0.6745 * sigma`. The subject names the material that felt nearest. If it touches the
//! real ones as well, as in the thesis, they are felt with the same noise. Two of them may then even change places; of two materials this is
//! the ABX test with differencing (Macmillan and Creelman 2005, chapter 9), `P = F(d/sqrt 2) F(d/sqrt 6) + F(-d/sqrt 2) F(-d/sqrt 6)`.
//! If the real ones are known, only the display is felt with noise, and criteria between neighbours are free.

use super::detect::quantile;
use crate::infer::mixture::normal_below;

/// Rise of twice the logarithm of the likelihood at the ends of a 95 % interval.
const RISE: f64 = 3.841_458_820_694_124;
/// Steepness (one over the deviation of a choice) that stands for none and for any.
const LEAST: f64 = 1e-2;
const MOST: f64 = 100.0;
/// Values on the grid that a maximum is looked for on, and shortenings of a bracket.
const GRID: usize = 28;
const SHORTENINGS: usize = 26;
const HALVINGS: usize = 60;
/// Deviations that an integral over a touch goes to both sides, and its steps; the distance of two touches has a kink, which takes the
/// finer steps.
const REACH: f64 = 4.5;
const DISPLAYS: i32 = 24;
const TOUCHES: i32 = 48;
/// A probability that is not followed further.
const NOTHING: f64 = 1e-13;
/// Rounds over all criteria, and what a round must gain.
const ROUNDS: usize = 60;
const GAIN: f64 = 1e-9;
/// Least probability of a cell, so that one slip is not impossible.
const SLIP: f64 = 1e-12;

/// What the display is compared with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum References {
    /// The real materials lie there and are touched.
    Touched,
    /// They are known without error.
    Known,
}

/// Deviation of a touch, in logarithms of stiffness, of a subject with a Weber fraction.
#[must_use]
pub fn deviation(weber: f64) -> f64 {
    weber.ln_1p() / (2.0_f64.sqrt() * quantile(0.75))
}

/// Weber fraction of a subject whose touches have this deviation.
#[must_use]
pub fn fraction(deviation: f64) -> f64 {
    (deviation * 2.0_f64.sqrt() * quantile(0.75)).exp_m1()
}

/// Ratio of two stiffnesses that a subject tells apart with a share of right answers; 1 at chance and below, infinite at certainty.
#[must_use]
pub fn ratio_for(right: f64, weber: f64, references: References) -> f64 {
    if right >= 1.0 {
        return f64::INFINITY;
    }
    let (mut low, mut high) = (0.0, 20.0 * deviation(weber));
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if answers(&[1.0, middle.exp()], weber, references)[0][0] < right { low = middle } else { high = middle }
    }
    (0.5 * (low + high)).exp()
}

/// Probabilities of the answers (columns) to what is shown (rows) of a subject without preferences; `stiffness` above 0, in any unit, in
/// any order.
#[must_use]
pub fn answers(stiffness: &[f64], weber: f64, references: References) -> Vec<Vec<f64>> {
    let rank = ranks(stiffness);
    let sorted: Vec<f64> = rank.iter().map(|i| stiffness[*i].ln()).collect();
    let sigma = deviation(weber);
    let ordered = match references {
        References::Touched => nearest(&sorted, sigma),
        References::Known => {
            let criteria: Vec<f64> = sorted.windows(2).map(|w| 0.5 * (w[0] + w[1]) / sigma).collect();
            probabilities(&sorted, 1.0 / sigma, &criteria)
        }
    };
    let mut out = vec![vec![0.0; stiffness.len()]; stiffness.len()];
    for (i, row) in ordered.iter().enumerate() {
        for (j, p) in row.iter().enumerate() {
            out[rank[i]][rank[j]] = *p;
        }
    }
    out
}

/// Probability that the touch of material j is the nearest to that of the display, by what is shown; `logarithms` rise.
fn nearest(logarithms: &[f64], sigma: f64) -> Vec<Vec<f64>> {
    if let [soft, stiff] = logarithms {
        let d = (stiff - soft) / sigma;
        let (a, b) = (normal_below(d / 2.0_f64.sqrt()), normal_below(d / 6.0_f64.sqrt()));
        let right = a * b + (1.0 - a) * (1.0 - b);
        return vec![vec![right, 1.0 - right], vec![1.0 - right, right]];
    }
    let nodes = |count: i32| -> Vec<(f64, f64)> {
        let step = 2.0 * REACH / f64::from(count);
        let all: Vec<(f64, f64)> = (0..=count)
            .map(|k| {
                let x = -REACH + step * f64::from(k);
                (x, (-0.5 * x * x).exp())
            })
            .collect();
        let sum: f64 = all.iter().map(|(_, weight)| weight).sum();
        all.into_iter().map(|(x, weight)| (x, weight / sum)).collect()
    };
    let (displays, touches) = (nodes(DISPLAYS), nodes(TOUCHES));
    let row = |shown: &f64| -> Vec<f64> {
        let mut row = vec![0.0; logarithms.len()];
        for (x, weight) in &displays {
            let display = shown + sigma * x;
            for (j, own) in logarithms.iter().enumerate() {
                for (y, of_touch) in &touches {
                    let far = (own + sigma * y - display).abs();
                    let mut left = weight * of_touch;
                    for (_, other) in logarithms.iter().enumerate().filter(|(k, _)| *k != j) {
                        let z = |edge: f64| normal_below((edge - other) / sigma);
                        left *= 1.0 - (z(display + far) - z(display - far));
                        if left < NOTHING {
                            break;
                        }
                    }
                    row[j] += left;
                }
            }
        }
        let sum: f64 = row.iter().sum();
        row.iter().map(|p| p / sum).collect()
    };
    logarithms.iter().map(row).collect()
}

/// Indices from the softest to the stiffest.
fn ranks(stiffness: &[f64]) -> Vec<usize> {
    let mut rank: Vec<usize> = (0..stiffness.len()).collect();
    rank.sort_by(|a, b| stiffness[*a].total_cmp(&stiffness[*b]));
    rank
}

/// Probabilities by rank; criteria are in deviations.
fn probabilities(logarithms: &[f64], steepness: f64, criteria: &[f64]) -> Vec<Vec<f64>> {
    let row = |x: &f64| {
        let below = |j: usize| match j {
            0 => 0.0,
            j if j > criteria.len() => 1.0,
            j => normal_below(criteria[j - 1] - steepness * x),
        };
        (0..logarithms.len()).map(|j| below(j + 1) - below(j)).collect()
    };
    logarithms.iter().map(row).collect()
}

/// A Weber fraction as answers tell it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// Most likely value; 0 where every answer is right in its order, infinite where answers say nothing of the stimuli.
    pub value: f64,
    /// 95 % interval by the likelihood's profile over all preferences.
    pub interval95: (f64, f64),
}

/// The Weber fraction of a subject from counts (rows shown, columns answered) and stiffnesses; where the references are
/// known, its preferences (criteria) are free. None
/// without two stimuli that were shown and differ in stiffness.
#[must_use]
pub fn estimate(counts: &[Vec<u32>], stiffness: &[f64], references: References) -> Option<Estimate> {
    let rank = ranks(stiffness);
    let sorted: Vec<f64> = rank.iter().map(|i| stiffness[*i].ln()).collect();
    let by_rank: Vec<Vec<u32>> = rank.iter().map(|i| rank.iter().map(|j| counts[*i][*j]).collect()).collect();
    let shown: Vec<f64> =
        by_rank.iter().zip(&sorted).filter(|(row, _)| row.iter().sum::<u32>() > 0).map(|(_, s)| *s).collect();
    let spread = shown.last()? - shown.first()?;
    if spread <= 0.0 || !spread.is_finite() {
        return None;
    }
    let middle = shown.iter().sum::<f64>() / shown.len() as f64;
    let centred: Vec<f64> = sorted.iter().map(|s| s - middle).collect();
    let likelihood = |log_steepness: f64| match references {
        References::Known => best(&centred, &by_rank, log_steepness.exp()),
        References::Touched => counted(&nearest(&centred, (-log_steepness).exp()), &by_rank),
    };
    // Steepness in deviations over the spread, from none to any.
    let (low, high) = ((LEAST / spread).ln(), (MOST / spread).ln());
    let grid: Vec<(f64, f64)> = (0..=GRID)
        .map(|k| {
            let at = low + (high - low) * k as f64 / GRID as f64;
            (at, likelihood(at))
        })
        .collect();
    let top = grid.iter().enumerate().max_by(|a, b| a.1.1.total_cmp(&b.1.1)).map(|(k, _)| k)?;
    let (mut at, mut value) = grid[top];
    if top > 0 && top < GRID {
        (at, value) = golden(grid[top - 1].0, grid[top + 1].0, &likelihood);
    }
    let falls = |x: f64| 2.0 * (value - likelihood(x)) - RISE;
    let end = |mut inside: f64, mut outside: f64| {
        if falls(outside) <= 0.0 {
            return None;
        }
        for _ in 0..SHORTENINGS {
            let middle = 0.5 * (inside + outside);
            if falls(middle) > 0.0 { outside = middle } else { inside = middle }
        }
        Some(0.5 * (inside + outside))
    };
    let weber = |log_steepness: f64| fraction((-log_steepness).exp());
    // Right to the end of what is looked at: the top of a plateau.
    let plateau = 2.0 * (value - grid[GRID].1) < 1e-6;
    let flat = 2.0 * (value - grid[0].1) < 1e-6;
    Some(Estimate {
        value: if flat {
            f64::INFINITY
        } else if plateau {
            0.0
        } else {
            weber(at)
        },
        interval95: (end(at, high).map_or(0.0, weber), end(at, low).map_or(f64::INFINITY, weber)),
    })
}

/// Largest logarithm of the likelihood over all criteria; concave in them, so that one after the other leads there.
fn best(logarithms: &[f64], counts: &[Vec<u32>], steepness: f64) -> f64 {
    let mut criteria: Vec<f64> = logarithms.windows(2).map(|w| 0.5 * (w[0] + w[1]) * steepness).collect();
    let reach = 10.0 + steepness * (logarithms[logarithms.len() - 1] - logarithms[0]);
    let mut value = likelihood(logarithms, counts, steepness, &criteria);
    for _ in 0..ROUNDS {
        let before = value;
        for j in 0..criteria.len() {
            let low = if j > 0 { criteria[j - 1] } else { steepness * logarithms[0] - reach };
            let top = logarithms[logarithms.len() - 1];
            let high = if j + 1 < criteria.len() { criteria[j + 1] } else { steepness * top + reach };
            let at = |c: f64| {
                let mut moved = criteria.clone();
                moved[j] = c;
                likelihood(logarithms, counts, steepness, &moved)
            };
            let (place, better) = golden(low, high, &at);
            if better > value {
                (criteria[j], value) = (place, better);
            }
        }
        if value - before < GAIN {
            break;
        }
    }
    value
}

fn likelihood(logarithms: &[f64], counts: &[Vec<u32>], steepness: f64, criteria: &[f64]) -> f64 {
    counted(&probabilities(logarithms, steepness, criteria), counts)
}

/// Logarithm of the likelihood of counts.
fn counted(probabilities: &[Vec<f64>], counts: &[Vec<u32>]) -> f64 {
    let cells = counts.iter().flatten().zip(probabilities.iter().flatten());
    cells.filter(|(n, _)| **n > 0).map(|(n, p)| f64::from(*n) * p.max(SLIP).ln()).sum()
}

/// Maximum of a function with one top: golden section.
fn golden(mut low: f64, mut high: f64, of: &impl Fn(f64) -> f64) -> (f64, f64) {
    const SHARE: f64 = 0.618_033_988_749_894_9;
    let (mut a, mut b) = (high - SHARE * (high - low), low + SHARE * (high - low));
    let (mut at_a, mut at_b) = (of(a), of(b));
    for _ in 0..SHORTENINGS {
        if at_a > at_b {
            (high, b, at_b) = (b, a, at_a);
            a = high - SHARE * (high - low);
            at_a = of(a);
        } else {
            (low, a, at_a) = (a, b, at_b);
            b = low + SHARE * (high - low);
            at_b = of(b);
        }
    }
    if at_a > at_b { (a, at_a) } else { (b, at_b) }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::print_stdout)]
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};
    use rand_pcg::Pcg64Mcg;

    use super::*;

    #[test]
    fn a_weber_fraction_is_what_75_of_100_pairs_are_told_by() {
        let sigma = deviation(0.15);
        assert!((normal_below(1.15_f64.ln() / (2.0_f64.sqrt() * sigma)) - 0.75).abs() < 1e-9);
        assert!((fraction(sigma) - 0.15).abs() < 1e-12);
    }

    #[test]
    fn rows_are_probabilities_in_any_order_of_the_stimuli() {
        let (a, b) =
            (answers(&[1.0, 2.0, 3.0], 0.3, References::Known), answers(&[3.0, 1.0, 2.0], 0.3, References::Known));
        for row in &a {
            assert!((row.iter().sum::<f64>() - 1.0).abs() < 1e-12);
        }
        assert!((a[0][1] - b[1][2]).abs() < 1e-12 && (a[2][2] - b[0][0]).abs() < 1e-12);
    }

    #[test]
    fn certainty_and_guessing_have_one_sided_intervals() {
        let sure = estimate(&[vec![25, 0], vec![0, 25]], &[1.0, 2.0], References::Touched).unwrap();
        assert_eq!((sure.value, sure.interval95.0), (0.0, 0.0));
        assert!(sure.interval95.1 > 0.1 && sure.interval95.1 < 1.0, "{sure:?}");
        let guess = estimate(&[vec![12, 13], vec![13, 12]], &[1.0, 2.0], References::Touched).unwrap();
        assert!(guess.value.is_infinite() && guess.interval95.1.is_infinite() && guess.interval95.0 > 0.3, "{guess:?}");
        assert_eq!(estimate(&[vec![5, 5], vec![5, 5]], &[1.0, 1.0], References::Touched), None);
    }

    /// Subjects that touch: the display and every real material are felt with noise, and the nearest is named. They share no code
    /// with the estimate.
    fn subject(random: &mut Pcg64Mcg, stiffness: &[f64], weber: f64, repeats: u32) -> Vec<Vec<u32>> {
        let sigma = (1.0 + weber).ln() / 0.953_872_6;
        let mut counts = vec![vec![0; stiffness.len()]; stiffness.len()];
        for (shown, row) in counts.iter_mut().enumerate() {
            for _ in 0..repeats {
                let mut felt =
                    |k: f64| k.ln() + sigma * <StandardNormal as Distribution<f64>>::sample(&StandardNormal, random);
                let display = felt(stiffness[shown]);
                let real: Vec<f64> = stiffness.iter().map(|k| (felt(*k) - display).abs()).collect();
                let nearest = (0..real.len()).min_by(|a, b| real[*a].total_cmp(&real[*b])).unwrap();
                row[nearest] += 1;
            }
        }
        counts
    }

    /// Shares of simulated subjects agree with the integral: 20000 answers have a standard error of 0.35 %, four of them are 1.4 %.
    #[test]
    fn simulated_subjects_answer_as_computed() {
        let mut random = Pcg64Mcg::seed_from_u64(7);
        for stiffness in [vec![1.0, 1.2], vec![1.0, 1.2, 1.5, 1.6]] {
            let computed = answers(&stiffness, 0.2, References::Touched);
            for (row, counts) in computed.iter().zip(subject(&mut random, &stiffness, 0.2, 20_000)) {
                for (p, n) in row.iter().zip(counts) {
                    assert!((p - f64::from(n) / 2e4).abs() < 0.014, "{p} for {n}");
                }
            }
        }
    }

    #[test]
    fn a_ratio_for_a_share_gives_the_share() {
        for references in [References::Touched, References::Known] {
            let ratio = ratio_for(0.62, 0.15, references);
            assert!((answers(&[2.0, 2.0 * ratio], 0.15, references)[1][1] - 0.62).abs() < 1e-9);
        }
        assert!((ratio_for(0.5, 0.15, References::Touched) - 1.0).abs() < 1e-6);
    }

    /// Coverage of the interval over 300 subjects a case of two materials, 100 of three, which take longer: three standard errors of 95 %
    /// (1.3 and 2.2 %) on both sides.
    #[test]
    fn a_stated_weber_fraction_is_recovered() {
        let mut random = Pcg64Mcg::seed_from_u64(2026);
        let cases: [(&[f64], f64, u32); 2] = [(&[1.0, 1.3], 0.15, 60), (&[1.0, 1.4, 1.9], 0.3, 30)];
        for (stiffness, weber, repeats) in cases {
            let mut inside = 0;
            let mut found = Vec::new();
            let subjects = if stiffness.len() == 2 { 300 } else { 100 };
            for _ in 0..subjects {
                let one =
                    estimate(&subject(&mut random, stiffness, weber, repeats), stiffness, References::Touched).unwrap();
                inside += u32::from(one.interval95.0 <= weber && weber <= one.interval95.1);
                found.push(one.value);
            }
            found.sort_by(f64::total_cmp);
            println!(
                "{stiffness:?} {weber}: {inside} of {subjects} intervals hold it, median {:.3}",
                found[subjects / 2]
            );
            let share = f64::from(inside) / subjects as f64;
            let error = 3.0 * (0.95 * 0.05 / subjects as f64).sqrt();
            assert!((share - 0.95).abs() <= error, "{stiffness:?}: {inside} of {subjects}");
            assert!((found[subjects / 2] / weber - 1.0).abs() < 0.1, "{stiffness:?}: median {}", found[subjects / 2]);
        }
    }
}
