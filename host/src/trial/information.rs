//! Information that goes from what is shown to what is answered.

/// Bits an answer carries about the stimulus: as counted, and less the bias of counting (Miller 1955): `(r - 1)(c - 1) / (2 N ln 2)` for r
/// rows and c columns with counts. The second is not below 0.
#[must_use]
pub fn transmitted_bits(counts: &[Vec<u32>]) -> (f64, f64) {
    let total: f64 = counts.iter().flatten().map(|n| f64::from(*n)).sum();
    if total == 0.0 {
        return (0.0, 0.0);
    }
    let rows: Vec<f64> = counts.iter().map(|row| row.iter().map(|n| f64::from(*n)).sum()).collect();
    let width = counts.first().map_or(0, Vec::len);
    let columns: Vec<f64> = (0..width).map(|j| counts.iter().map(|row| f64::from(row[j])).sum()).collect();
    let mut bits = 0.0;
    for (row, row_sum) in counts.iter().zip(&rows) {
        for (n, column_sum) in row.iter().zip(&columns) {
            let n = f64::from(*n);
            if n > 0.0 {
                bits += n / total * (n * total / (row_sum * column_sum)).log2();
            }
        }
    }
    let used = |sums: &[f64]| sums.iter().filter(|sum| **sum > 0.0).count() as f64;
    let bias = (used(&rows) - 1.0) * (used(&columns) - 1.0) / (2.0 * total * std::f64::consts::LN_2);
    (bits, (bits - bias).max(0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn certainty_is_the_logarithm_of_the_choices_and_guessing_nothing() {
        let sure: Vec<Vec<u32>> = (0..4).map(|i| (0..4).map(|j| if i == j { 25 } else { 0 }).collect()).collect();
        assert!((transmitted_bits(&sure).0 - 2.0).abs() < 1e-12);
        assert_eq!(transmitted_bits(&[vec![10, 10], vec![10, 10]]), (0.0, 0.0));
        // A binary channel that errs in one of ten: 1 - H(0.1) = 0.531 bits.
        assert!((transmitted_bits(&[vec![90, 10], vec![10, 90]]).0 - 0.531_004).abs() < 1e-6);
    }
}
