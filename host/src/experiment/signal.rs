//! Noise, resolution, extent and slope of a signal.

/// Noise of a smooth signal: standard deviation from the median absolute second difference, so
/// that neither a trend nor a few jumps count.
pub fn noise_of(signal: &[f64]) -> f64 {
    let bends = signal.windows(3).map(|w| (w[0] - 2.0 * w[1] + w[2]).abs());
    // 0.6745 is the median of |x| for unit normal x; a second difference has variance 6.
    median(bends) / 0.6745 / 6.0_f64.sqrt()
}

/// Resolution of a reading: the least difference between neighbours that differ; 0 where none do.
pub fn step_of(signal: &[f64]) -> f64 {
    let steps = signal.windows(2).map(|w| (w[1] - w[0]).abs()).filter(|step| *step > 0.0);
    let least = steps.fold(f64::INFINITY, f64::min);
    if least.is_finite() { least } else { 0.0 }
}

/// The upper of two middle values; 0 of none.
pub fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}

/// Least and largest value; (infinity, minus infinity) of none.
pub fn extent(values: impl IntoIterator<Item = f64>) -> (f64, f64) {
    values.into_iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)))
}

/// From the least to the largest value; 0 of none.
pub fn range(values: impl IntoIterator<Item = f64>) -> f64 {
    let (low, high) = extent(values);
    (high - low).max(0.0)
}

/// Median of what a signal rises by from sample to sample.
pub fn usual_rise(signal: &[f64]) -> f64 {
    median(signal.windows(2).map(|w| w[1] - w[0]))
}

/// Means of so many neighbours each; the last of those that are left.
pub fn averaged(values: &[f64], together: usize) -> Vec<f64> {
    values.chunks(together.max(1)).map(|block| block.iter().sum::<f64>() / block.len() as f64).collect()
}

/// Arithmetic mean; `None` of none.
pub fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (sum, count) = values.fold((0.0, 0usize), |(sum, count), value| (sum + value, count + 1));
    (count > 0).then(|| sum / count as f64)
}

/// Slope of the least-squares line.
pub fn slope(x: &[f64], y: &[f64]) -> Option<f64> {
    let count = x.len() as f64;
    let (mean_x, mean_y) = (x.iter().sum::<f64>() / count, y.iter().sum::<f64>() / count);
    let sxx: f64 = x.iter().map(|x| (x - mean_x).powi(2)).sum();
    let sxy: f64 = x.iter().zip(y).map(|(x, y)| (x - mean_x) * (y - mean_y)).sum();
    let slope = sxy / sxx;
    slope.is_finite().then_some(slope)
}
