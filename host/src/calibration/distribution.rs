//! Tails of the distributions of Student and Fisher.

/// Coefficients of Lanczos' approximation of the gamma function with g = 7 and nine terms (relative error below 1e-13).
const LANCZOS: [f64; 9] = [
    0.999_999_999_999_809_9,
    676.520_368_121_885_1,
    -1_259.139_216_722_402_8,
    771.323_428_777_653_1,
    -176.615_029_162_140_6,
    12.507_343_278_686_905,
    -0.138_571_095_265_720_12,
    9.984_369_578_019_572e-6,
    1.505_632_735_149_311_6e-7,
];

/// Most steps of the continued fraction; it needs of the order of the root of the larger parameter.
const STEPS: usize = 10_000;
/// Stands for zero in Lentz's method.
const TINY: f64 = 1e-300;
/// Halvings of a bracket that find a quantile.
const HALVINGS: usize = 200;

/// Logarithm of the gamma function of `x > 0`.
fn ln_gamma(x: f64) -> f64 {
    let x = x - 1.0;
    let t = x + 7.5;
    let sum = LANCZOS.iter().enumerate().skip(1).fold(LANCZOS[0], |sum, (k, c)| sum + c / (x + k as f64));
    0.5 * (2.0 * std::f64::consts::PI).ln() + (x + 0.5) * t.ln() - t + sum.ln()
}

/// Regularised incomplete beta function `I_x(a, b)` for `a, b > 0` and x in 0..=1 (DLMF 8.17.22, continued fraction by Lentz's method).
fn incomplete_beta(x: f64, a: f64, b: f64) -> f64 {
    if x <= 0.0 || x >= 1.0 {
        return x.clamp(0.0, 1.0);
    }
    // the fraction converges fast on this side of the mean
    if x > (a + 1.0) / (a + b + 2.0) {
        return 1.0 - incomplete_beta(1.0 - x, b, a);
    }
    let front = (ln_gamma(a + b) - ln_gamma(a) - ln_gamma(b) + a * x.ln() + b * (1.0 - x).ln()).exp() / a;
    let away = |value: f64| if value.abs() < TINY { TINY } else { value };
    let (mut c, mut d) = (1.0, 1.0 / away(1.0 - (a + b) * x / (a + 1.0)));
    let mut fraction = d;
    for step in 1..STEPS {
        let m = step as f64;
        let even = m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m));
        let odd = -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0));
        let before = fraction;
        for term in [even, odd] {
            d = 1.0 / away(1.0 + term * d);
            c = away(1.0 + term / c);
            fraction *= c * d;
        }
        if (fraction / before - 1.0).abs() < 1e-15 {
            break;
        }
    }
    front * fraction
}

/// Probability that a ratio of mean squares with these degrees of freedom exceeds `f`. NaN when a degree of freedom is not positive.
#[must_use]
pub fn fisher_tail(f: f64, freedom: (f64, f64)) -> f64 {
    let (above, below) = freedom;
    if !(above > 0.0 && below > 0.0) || f.is_nan() {
        return f64::NAN;
    }
    if f <= 0.0 {
        return 1.0;
    }
    incomplete_beta(below / (below + above * f), 0.5 * below, 0.5 * above)
}

/// What a ratio of mean squares exceeds with the probability `level` (within 0..1).
#[must_use]
pub fn fisher_critical(level: f64, freedom: (f64, f64)) -> f64 {
    quantile(level, |f| fisher_tail(f, freedom))
}

/// Probability that Student's t has a larger magnitude.
#[must_use]
pub fn student_two_sided(t: f64, freedom: f64) -> f64 {
    fisher_tail(t * t, (1.0, freedom))
}

/// What the magnitude of Student's t exceeds with the probability `level`.
#[must_use]
pub fn student_critical(level: f64, freedom: f64) -> f64 {
    fisher_critical(level, (1.0, freedom)).sqrt()
}

/// Where a falling tail reaches a level.
fn quantile(level: f64, tail: impl Fn(f64) -> f64) -> f64 {
    if !(level > 0.0 && level < 1.0) || tail(1.0).is_nan() {
        return f64::NAN;
    }
    let (mut low, mut high) = (0.0, 1.0);
    while tail(high) > level && high < f64::MAX / 2.0 {
        high *= 2.0;
    }
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if tail(middle) > level {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Tables of the NIST e-Handbook, sections 1.3.6.7.2 (t) and 1.3.6.7.3 (F), to the digits that they print.
    #[test]
    fn critical_values_are_those_of_printed_tables() {
        let student =
            [(0.05, 3.0, 3.182), (0.05, 7.0, 2.365), (0.01, 10.0, 3.169), (0.05, 100.0, 1.984), (0.1, 1.0, 6.314)];
        for (level, freedom, printed) in student {
            let found = student_critical(level, freedom);
            assert!((found - printed).abs() <= 5e-4, "t({level}; {freedom}) = {found}, printed {printed}");
        }
        let fisher = [
            (0.05, (18.0, 20.0), 2.151),
            (0.05, (1.0, 10.0), 4.965),
            (0.01, (4.0, 30.0), 4.018),
            (0.1, (2.0, 5.0), 3.780),
        ];
        for (level, freedom, printed) in fisher {
            let found = fisher_critical(level, freedom);
            assert!((found - printed).abs() <= 6e-4, "F({level}; {freedom:?}) = {found}, printed {printed}");
        }
    }

    #[test]
    fn tails_have_closed_forms_where_those_exist() {
        // one degree of freedom: Cauchy; two above: (1 + 2 f / n)^(-n / 2)
        let cauchy = 1.0 - 2.0 / std::f64::consts::PI * 3.0_f64.atan();
        assert!((student_two_sided(3.0, 1.0) - cauchy).abs() < 1e-12);
        assert!((fisher_tail(2.5, (2.0, 9.0)) - (1.0 + 2.0 * 2.5 / 9.0_f64).powf(-4.5)).abs() < 1e-12);
        let far = fisher_tail(40.0, (2.0, 300.0));
        assert!((far / (1.0 + 80.0 / 300.0_f64).powf(-150.0) - 1.0).abs() < 1e-9, "{far}");
        assert!(fisher_tail(1.0, (0.0, 3.0)).is_nan() && fisher_critical(0.05, (1.0, -1.0)).is_nan());
        assert_eq!(fisher_tail(-1.0, (2.0, 2.0)), 1.0);
    }
}
