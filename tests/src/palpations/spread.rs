//! How far values scatter about their mean.

/// Spread of a parameter over many presses.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spread {
    /// Number of values.
    pub count: usize,
    /// Their mean.
    pub mean: f64,
    /// Standard deviation over mean. Of the readings of the thesis' "deviation" this is the one that does not grow with the
    /// number of presses.
    pub deviation: f64,
    /// Largest distance from the mean, over the mean: the other reading; it grows with the number of presses.
    pub largest: f64,
}

impl Spread {
    /// Of two or more values with a mean above zero; all zero for fewer.
    pub fn of(values: &[f64]) -> Self {
        let count = values.len();
        if count < 2 {
            return Spread { count, mean: 0.0, deviation: 0.0, largest: 0.0 };
        }
        let mean = values.iter().sum::<f64>() / count as f64;
        let squares: f64 = values.iter().map(|v| (v - mean) * (v - mean)).sum();
        let largest = values.iter().map(|v| (v - mean).abs()).fold(0.0, f64::max);
        Spread { count, mean, deviation: (squares / (count - 1) as f64).sqrt() / mean, largest: largest / mean }
    }
}

#[cfg(test)]
mod tests {
    use super::Spread;

    #[test]
    fn spread_of_known_values() {
        let spread = Spread::of(&[9.0, 10.0, 11.0]);
        // rounding only
        assert!((spread.mean - 10.0).abs() < 1e-12 && (spread.deviation - 0.1).abs() < 1e-12);
        assert!((spread.largest - 0.1).abs() < 1e-12);
        assert_eq!(Spread::of(&[1.0]).count, 1);
    }
}
