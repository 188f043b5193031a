//! Shares of counted cases with the bounds that so few cases leave.

use palpate::infer::covariance::Z95;

/// Upper end of the one-sided 95 % interval of Clopper and Pearson (1934, doi:10.1093/biomet/26.4.404) of a share seen
/// `hits` times in `cases`: 1 when there are no cases.
#[must_use]
pub fn upper95(hits: usize, cases: usize) -> f64 {
    if hits >= cases {
        return 1.0;
    }
    let (mut low, mut high) = (0.0, 1.0);
    // 60 halvings leave less than the spacing of numbers
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if at_most(hits, cases, middle) > 0.05 { low = middle } else { high = middle }
    }
    high
}

/// Lower end, likewise: 0 when there are no cases.
#[must_use]
pub fn lower95(hits: usize, cases: usize) -> f64 {
    if hits == 0 { 0.0 } else { 1.0 - upper95(cases.saturating_sub(hits), cases) }
}

/// Ends of the two-sided 95 % interval of Wilson (1927, doi:10.1080/01621459.1927.10502953): (0, 1) without cases.
#[must_use]
pub fn wilson95(hits: usize, cases: usize) -> (f64, f64) {
    if cases == 0 {
        return (0.0, 1.0);
    }
    let (n, p) = (cases as f64, hits as f64 / cases as f64);
    let middle = p + Z95 * Z95 / (2.0 * n);
    let half = Z95 * (p * (1.0 - p) / n + Z95 * Z95 / (4.0 * n * n)).sqrt();
    let whole = 1.0 + Z95 * Z95 / n;
    (((middle - half) / whole).max(0.0), ((middle + half) / whole).min(1.0))
}

/// Probability of at most `hits` in `cases` at a share of `p`, 0 < p < 1.
fn at_most(hits: usize, cases: usize, p: f64) -> f64 {
    let mut log_term = cases as f64 * (-p).ln_1p();
    let mut sum = log_term.exp();
    for k in 1..=hits {
        log_term += ((cases + 1 - k) as f64 / k as f64).ln() + p.ln() - (-p).ln_1p();
        sum += log_term.exp();
    }
    sum
}

/// "3 of 40 (7.5 %)"; "none" without cases.
#[must_use]
pub fn share(hits: usize, cases: usize) -> String {
    if cases == 0 { "none".to_owned() } else { format!("{hits} of {cases} ({:.1} %)", percent(hits, cases)) }
}

/// "3 of 40 (8 %, 3 to 20)", with the 95 % bounds; "none" without cases.
#[must_use]
pub fn bounded(hits: usize, cases: usize) -> String {
    if cases == 0 {
        return "none".to_owned();
    }
    let (low, high) = wilson95(hits, cases);
    format!("{hits} of {cases} ({:.0} %, {:.0} to {:.0})", percent(hits, cases), 100.0 * low, 100.0 * high)
}

/// The middle and the largest of some times; none without one.
pub fn middle_and_worst(times: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    let mut times: Vec<f64> = times.collect();
    times.sort_by(f64::total_cmp);
    Some((*times.get(times.len() / 2)?, *times.last()?))
}

/// Percent; 0 without cases.
#[must_use]
pub fn percent(hits: usize, cases: usize) -> f64 {
    if cases == 0 { 0.0 } else { 100.0 * hits as f64 / cases as f64 }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// None of n: 1 - 0.05^(1/n). One of 20: the 95 % quantile of a beta distribution of 2 and 19, 0.21611 (R: qbeta(0.95, 2, 19)).
    #[test]
    fn bounds_are_those_of_clopper_and_pearson() {
        for cases in [1, 10, 100, 400] {
            let exact = 1.0 - 0.05_f64.powf(1.0 / cases as f64);
            assert!((upper95(0, cases) - exact).abs() < 1e-12, "{cases}");
            assert!((lower95(cases, cases) - (1.0 - exact)).abs() < 1e-12, "{cases}");
        }
        assert!((upper95(1, 20) - 0.216_11).abs() < 5e-5, "{}", upper95(1, 20));
        assert!((upper95(5, 5), upper95(0, 0), lower95(0, 7)) == (1.0, 1.0, 0.0));
    }

    /// The bound is where so few hits, or fewer, come up once in twenty times.
    #[test]
    fn the_bound_gives_one_in_twenty() {
        for (hits, cases) in [(3, 100), (12, 40), (39, 40)] {
            assert!((at_most(hits, cases, upper95(hits, cases)) - 0.05).abs() < 1e-9);
        }
    }

    /// 8 of 10: 0.4902 and 0.9433 (R: prop.test(8, 10, correct = FALSE)).
    #[test]
    fn bounds_are_those_of_wilson() {
        let (low, high) = wilson95(8, 10);
        assert!((low - 0.4902).abs() < 5e-5 && (high - 0.9433).abs() < 5e-5, "{low} {high}");
        assert_eq!((wilson95(0, 0), wilson95(0, 9).0, wilson95(9, 9).1), ((0.0, 1.0), 0.0, 1.0));
    }

    #[test]
    fn shares_are_told_with_their_counts() {
        assert_eq!(share(3, 40), "3 of 40 (7.5 %)");
        assert_eq!(share(0, 0), "none");
    }
}
