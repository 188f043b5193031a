//! A measured input without most of its noise, its corners kept.
//!
//! An effect that looks at the direction in which an input moves would take a reading's noise for motion, and what
//! follows the input steeply has its noise in it. Of all ways to cut a reading into pieces, each at rest or with a
//! straight line of its own, the one of the least squares is taken, each piece priced as its parameters (Bellman 1961;
//! the price is Schwarz's). What is not straight becomes short pieces, down to a sample as it was read.

use std::ops::Range;

use crate::experiment::signal::noise_of;

/// Parameters of a rest (its level and where it begins) and of a line: each costs the logarithm of the number of samples.
const OF_REST: f64 = 2.0;
const OF_LINE: f64 = 3.0;
/// Samples of the longest piece: a longer one has next to no noise left, and the search takes its square.
const LONGEST: usize = 2000;
/// How far from both lines beside it a single reading may say them to be, in times the noise, and be wrong itself.
const NEAR: f64 = 4.0;
/// Samples by which the end of a piece may be off.
const ABOUT: usize = 8;

/// Samples of a piece from which its line is better known than a reading.
const LEAST_PIECE: usize = 3;
/// Readings by themselves that are told one by one; of more the noise is found from what repeats differ by.
const MOST_ALONE: usize = 40;

/// An error that is left in a smoothed input, in its unit, for one standard deviation.
#[derive(Debug, Clone, PartialEq)]
pub struct Left {
    /// The first sample that it is in.
    pub first: usize,
    /// The error at this and the following.
    pub errors: Vec<f64>,
}

/// What the lines of pieces are wrong by in level and slope, and readings by themselves by their noise.
fn left(time_s: &[f64], cuts: &[Range<usize>], lines: &[Line], noise: f64) -> Vec<Left> {
    let (long, short): (Vec<_>, Vec<_>) = cuts.iter().zip(lines).partition(|(own, _)| own.len() >= LEAST_PIECE);
    let mut out = Vec::new();
    for (own, line) in long {
        let (times, count) = (&time_s[own.clone()], own.len() as f64);
        out.push(Left { first: own.start, errors: vec![noise / count.sqrt(); own.len()] });
        let mean = times.iter().sum::<f64>() / count;
        let square: f64 = times.iter().map(|t| (t - mean).powi(2)).sum();
        if line.slope != 0.0 && square > 0.0 {
            let errors = times.iter().map(|t| noise * (t - mean) / square.sqrt());
            out.push(Left { first: own.start, errors: errors.collect() });
        }
    }
    let alone: Vec<usize> = short.into_iter().flat_map(|(own, _)| own.clone()).collect();
    if alone.len() <= MOST_ALONE {
        out.extend(alone.into_iter().map(|first| Left { first, errors: vec![noise] }));
    }
    out
}

/// The smoothed input, and what errors are left in it.
#[must_use]
pub fn smoothed(time_s: &[f64], input: &[f64]) -> (Vec<f64>, Vec<Left>) {
    let noise = noise_of(input);
    if noise <= 0.0 || input.len() < 3 {
        return (input.to_vec(), Vec::new());
    }
    let sums = Sums::of(time_s, input);
    let mut cuts = sums.cut(noise);
    let lines: Vec<Line> = cuts.iter().map(|own| sums.best(own.start, own.end, noise)).collect();
    meet(time_s, &mut cuts, &lines, noise);
    let mut out = input.to_vec();
    for (own, line) in cuts.iter().zip(&lines).filter(|(own, _)| own.len() > 1) {
        own.clone().for_each(|k| out[k] = line.at(time_s[k]));
    }
    // a reading by itself between two lines that agree about it is wrong
    for at in (1..cuts.len().saturating_sub(1)).filter(|at| cuts[*at].len() == 1) {
        let [before, after] = [at - 1, at + 1].map(|beside| lines[beside].at(time_s[cuts[at].start]));
        if cuts[at - 1].len() > 2 && cuts[at + 1].len() > 2 && (before - after).abs() < NEAR * noise {
            out[cuts[at].start] = 0.5 * (before + after);
        }
    }
    (out, left(time_s, &cuts, &lines, noise))
}

/// Moves the ends of pieces to where their lines meet, where they do: some readings about a corner fit either as well.
fn meet(time_s: &[f64], cuts: &mut [Range<usize>], lines: &[Line], noise: f64) {
    for at in 1..cuts.len() {
        let (before, after) = (&lines[at - 1], &lines[at]);
        let end_s = time_s[cuts[at].start];
        let apart = after.at(end_s) - before.at(end_s);
        let bend = before.slope - after.slope;
        if apart.abs() > NEAR * noise || bend == 0.0 {
            continue;
        }
        let meets = time_s.partition_point(|t| *t < end_s + apart / bend);
        if meets.abs_diff(cuts[at].start) <= ABOUT && meets > cuts[at - 1].start && meets < cuts[at].end {
            (cuts[at - 1].end, cuts[at].start) = (meets, meets);
        }
    }
}

/// A line.
struct Line {
    /// Mean time, s, and value there.
    mean: (f64, f64),
    slope: f64,
    /// Sum of the squares about it, in those of the noise, and the price of its parameters.
    cost: f64,
}

impl Line {
    fn at(&self, time_s: f64) -> f64 {
        self.mean.1 + self.slope * (time_s - self.mean.0)
    }
}

/// Sums over the first samples of time, value, and their products.
struct Sums(Vec<[f64; 5]>);

impl Sums {
    fn of(time_s: &[f64], input: &[f64]) -> Self {
        // about their means: what is summed stays small
        let mean = |of: &[f64]| of.iter().sum::<f64>() / of.len().max(1) as f64;
        let (t0, y0) = (mean(time_s), mean(input));
        let mut sum = [0.0; 5];
        let mut all = vec![sum];
        for (t, y) in time_s.iter().map(|t| t - t0).zip(input.iter().map(|y| y - y0)) {
            sum.iter_mut().zip([t, y, t * t, t * y, y * y]).for_each(|(sum, own)| *sum += own);
            all.push(sum);
        }
        all.push([t0, y0, 0.0, 0.0, 0.0]);
        Self(all)
    }

    fn count(&self) -> usize {
        self.0.len() - 2
    }

    /// The rest or the line of some samples, whichever costs less.
    fn best(&self, start: usize, end: usize, noise: f64) -> Line {
        let n = (end - start) as f64;
        let [t, y, tt, ty, yy] = std::array::from_fn(|at| self.0[end][at] - self.0[start][at]);
        let [t0, y0, ..] = self.0[self.count() + 1];
        let mean = (t0 + t / n, y0 + y / n);
        let (own, cross, whole) = (tt - t * t / n, ty - t * y / n, (yy - y * y / n).max(0.0));
        let price = (self.count() as f64).ln();
        let rest = Line { mean, slope: 0.0, cost: whole / (noise * noise) + OF_REST * price };
        if end - start < 2 || own <= 0.0 {
            return rest;
        }
        let left = if end - start > 2 { (whole - cross * cross / own).max(0.0) } else { 0.0 };
        let line = Line { mean, slope: cross / own, cost: left / (noise * noise) + OF_LINE * price };
        if line.cost < rest.cost { line } else { rest }
    }

    /// The pieces of the least cost.
    fn cut(&self, noise: f64) -> Vec<Range<usize>> {
        let count = self.count();
        let mut best = vec![(0.0, 0)];
        // where the last piece may begin
        let mut open: Vec<usize> = Vec::new();
        for end in 1..=count {
            open.push(end - 1);
            let told: Vec<f64> = open.iter().map(|start| best[*start].0 + self.best(*start, end, noise).cost).collect();
            let least =
                told.iter().zip(&open).fold(
                    (f64::INFINITY, 0),
                    |least: (f64, usize), (own, start)| {
                        if *own < least.0 { (*own, *start) } else { least }
                    },
                );
            best.push(least);
            // what is behind by the price of a piece stays behind: a piece could begin here instead
            let behind = least.0 + OF_LINE * (count as f64).ln();
            let mut told = told.iter();
            open.retain(|start| told.next().is_some_and(|own| *own <= behind) && end - start < LONGEST);
        }
        let mut cuts = Vec::new();
        let mut end = count;
        while end > 0 {
            cuts.push(best[end].1..end);
            end = best[end].1;
        }
        cuts.reverse();
        cuts
    }
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
        let (found, _) = smoothed(&time_s, &read);
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
        let (found, _) = smoothed(&time_s, &noisy);
        let rms = |of: &[f64]| (of.iter().zip(&clean).map(|(a, b)| (a - b).powi(2)).sum::<f64>() / 100.0).sqrt();
        assert!(rms(&found) < 0.6 * rms(&noisy), "{} of {}", rms(&found), rms(&noisy));
        assert!((found[49] - clean[49]).abs() < 0.02 && (found[50] - 3.0).abs() < 0.02);
    }
}
