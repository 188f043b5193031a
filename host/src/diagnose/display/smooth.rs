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
            // of a long line the last sample may lie behind a corner; a wrong reading lies between two that are near
            let near = |(mean, slope, _): &(f64, f64, f64), k: usize| {
                (input[k] - mean - slope * time_s[k]).abs() <= NEAR * noise
            };
            let is_of = |line: &(f64, f64, f64)| {
                near(line, k) || (k > 0 && k + 1 < input.len() && near(line, k - 1) && near(line, k + 1))
            };
            let best = own.filter(is_of).min_by(|a, b| a.2.total_cmp(&b.2));
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

    /// A long line takes the sample behind a corner for its own unless it lies too far from it; one wrong reading is still smoothed.
    #[test]
    fn a_corner_keeps_its_place_and_a_wrong_reading_goes() {
        let time_s: Vec<f64> = (0..400).map(|k| 0.02 * f64::from(k)).collect();
        let clean: Vec<f64> = time_s.iter().map(|t| (1.5 * t).min(6.0)).collect();
        let wiggle = |k: usize| 0.004 * [1.0, -0.6, 0.3, -1.0, 0.8, -0.2, 0.5][k % 7];
        let mut read: Vec<f64> = clean.iter().enumerate().map(|(k, x)| x + wiggle(k)).collect();
        read[100] += 0.016;
        let found = smoothed(&time_s, &read);
        // the ramp ends at sample 200; its step is 0.03 a sample
        assert!((198..204).all(|k| (found[k] - clean[k]).abs() < 0.012), "{:?}", &found[198..204]);
        assert!((found[100] - clean[100]).abs() < 0.01, "{}", found[100]);
    }

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
