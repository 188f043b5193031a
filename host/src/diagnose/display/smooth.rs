//! A measured input without most of its noise, its corners kept.
//!
//! An effect that looks at the direction in which an input moves would take a reading's noise for motion. A piece of the input that is straight
//! to within the noise is replaced by its straight line; what is not, a jump or a tremor, stays as it was read.

use crate::experiment::motion::noise_of;

/// Samples of a piece, and how many times the noise it may scatter by to be straight: the longer a piece, the better is its scatter known.
const PIECES: [(usize, f64); 3] = [(81, 1.3), (27, 1.4), (9, 1.6)];

/// How far from a line a sample of it may lie, in times the noise: one in ten thousand lies farther.
const NEAR: f64 = 4.0;

/// The smoothed input.
#[must_use]
pub fn smoothed(time_s: &[f64], input: &[f64]) -> Vec<f64> {
    let noise = noise_of(input);
    let mut out = input.to_vec();
    let mut is_open = vec![true; input.len()];
    // the longest straight piece that a sample lies in has the least noise
    for (samples, straight) in PIECES.into_iter().filter(|(samples, _)| input.len() >= 2 * samples) {
        let last = input.len() - samples;
        let lines: Vec<(f64, f64, f64)> =
            (0..=last).map(|at| line(&time_s[at..at + samples], &input[at..at + samples])).collect();
        for k in (0..input.len()).filter(|k| is_open[*k]).collect::<Vec<_>>() {
            let own = (k.saturating_sub(samples - 1)..=k.min(last)).map(|at| lines[at]);
            // of a long line the last sample may lie behind a corner
            let near = own.filter(|(mean, slope, _)| (input[k] - mean - slope * time_s[k]).abs() <= NEAR * noise);
            let best = near.min_by(|a, b| a.2.total_cmp(&b.2));
            if let Some((mean, slope, _)) = best.filter(|(.., scatter)| *scatter <= straight * noise) {
                (out[k], is_open[k]) = (mean + slope * time_s[k], false);
            }
        }
    }
    out
}

/// Value at time 0, slope, and standard deviation about the line.
fn line(time_s: &[f64], values: &[f64]) -> (f64, f64, f64) {
    let n = values.len() as f64;
    let (t, y) = (time_s.iter().sum::<f64>() / n, values.iter().sum::<f64>() / n);
    let square: f64 = time_s.iter().map(|a| (a - t).powi(2)).sum();
    let cross: f64 = time_s.iter().zip(values).map(|(a, b)| (a - t) * (b - y)).sum();
    let slope = if square > 0.0 { cross / square } else { 0.0 };
    let rest: f64 = time_s.iter().zip(values).map(|(a, b)| (b - y - slope * (a - t)).powi(2)).sum();
    (y - slope * t, slope, (rest / (n - 2.0)).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_goes_and_a_jump_stays() {
        let time_s: Vec<f64> = (0..100).map(|k| 0.02 * f64::from(k)).collect();
        let clean: Vec<f64> = time_s.iter().map(|t| if *t < 1.0 { 0.5 * t } else { 3.0 }).collect();
        // a fixed pattern of magnitude 0.01 whose neighbours differ
        let wiggle = |k: usize| 0.01 * [1.0, -0.6, 0.3, -1.0, 0.8, -0.2, 0.5][k % 7];
        let noisy: Vec<f64> = clean.iter().enumerate().map(|(k, x)| x + wiggle(k)).collect();
        let found = smoothed(&time_s, &noisy);
        let rms = |of: &[f64]| (of.iter().zip(&clean).map(|(a, b)| (a - b).powi(2)).sum::<f64>() / 100.0).sqrt();
        assert!(rms(&found) < 0.6 * rms(&noisy), "{} of {}", rms(&found), rms(&noisy));
        assert!((found[49] - clean[49]).abs() < 0.02 && (found[50] - 3.0).abs() < 0.02);
    }
}
