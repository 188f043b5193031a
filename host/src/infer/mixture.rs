//! Mixtures of normal distributions.

/// A normal part of a mixture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Part {
    /// Logarithm of what is proportional to its weight.
    pub weight: f64,
    /// Its mean.
    pub mean: f64,
    /// Its standard deviation.
    pub deviation: f64,
}

/// Where a share of a mixture lies below.
#[must_use]
pub fn quantile(parts: &[Part], share: f64) -> f64 {
    /// Halvings: an interval to its last bits.
    const HALVINGS: usize = 60;
    let largest = parts.iter().map(|p| p.weight).fold(f64::NEG_INFINITY, f64::max);
    let whole: f64 = parts.iter().map(|p| (p.weight - largest).exp()).sum();
    let below = |x: f64| -> f64 {
        let each = parts.iter().map(|p| (p.weight - largest).exp() * normal_below((x - p.mean) / p.deviation));
        each.sum::<f64>() / whole
    };
    let reach = |sign: f64| move |p: &Part| p.mean + sign * 8.0 * p.deviation;
    let mut low = parts.iter().map(reach(-1.0)).fold(f64::INFINITY, f64::min);
    let mut high = parts.iter().map(reach(1.0)).fold(f64::NEG_INFINITY, f64::max);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if below(middle) < share { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// Probability that a standard normal number is smaller.
#[must_use]
pub fn normal_below(x: f64) -> f64 {
    0.5 * libm::erfc(-x * std::f64::consts::FRAC_1_SQRT_2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_share_lies_below_its_quantile() {
        let one = Part { weight: 3.0, mean: 1.0, deviation: 2.0 };
        // 97.5 % of a normal distribution
        assert!((quantile(&[one], 0.975) - (1.0 + 2.0 * 1.959_964)).abs() < 1e-5);
        let far = Part { weight: 3.0 + 3.0_f64.ln(), mean: 100.0, ..one };
        // a quarter lies with the first, half of which is below its mean
        assert!((quantile(&[one, far], 0.125) - 1.0).abs() < 1e-5);
    }
}
