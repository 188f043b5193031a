//! What of a pushed actuator's residual comes again at the same place in every stroke.

use super::fit::ends;

/// Places along the travel.
const PLACES: usize = 40;
/// Share of the travel by which the shaft must turn back before a new stroke begins.
const TURN: f64 = 0.2;

/// Strokes of a motion: for every sample its stroke, and whether that goes up.
#[must_use]
pub fn strokes(position_mm: &[f64]) -> Vec<(usize, bool)> {
    let (low, high) = ends(position_mm);
    let turn = TURN * (high - low);
    let (mut stroke, mut up, mut extreme) = (0, true, position_mm.first().copied().unwrap_or(0.0));
    let mut begins = vec![(0, true)];
    let mut at_extreme = 0;
    for (k, x) in position_mm.iter().enumerate() {
        let further = if up { *x >= extreme } else { *x <= extreme };
        if further {
            (extreme, at_extreme) = (*x, k);
        } else if (extreme - x).abs() > turn {
            up = !up;
            begins.push((at_extreme, up));
            (extreme, at_extreme) = (*x, k);
        }
    }
    let mut out = Vec::with_capacity(position_mm.len());
    for k in 0..position_mm.len() {
        while begins.get(stroke + 1).is_some_and(|(begin, _)| *begin <= k) {
            stroke += 1;
        }
        out.push((stroke, begins[stroke].1));
    }
    out
}

/// Share of the residual's variance that repeats at the same place and in the same direction, from the products of different strokes, so
/// that noise does not count; 0 to 1. None for fewer than two strokes of each direction.
#[must_use]
pub fn repeated(position_mm: &[f64], residual: &[f64]) -> Option<f64> {
    let (low, high) = ends(position_mm);
    let of = strokes(position_mm);
    let count = of.last().map_or(0, |(stroke, _)| stroke + 1);
    if count < 4 {
        return None;
    }
    let mean = residual.iter().sum::<f64>() / residual.len() as f64;
    let variance = residual.iter().map(|r| (r - mean).powi(2)).sum::<f64>() / residual.len() as f64;
    // Mean residual of every stroke at every place.
    let mut sums = vec![[(0.0, 0_usize); PLACES]; count];
    for (k, (stroke, _)) in of.iter().enumerate() {
        let place = ((position_mm[k] - low) / (high - low) * PLACES as f64) as usize;
        let (sum, samples) = &mut sums[*stroke][place.min(PLACES - 1)];
        *sum += residual[k] - mean;
        *samples += 1;
    }
    let is_up: Vec<bool> = (0..count).map(|s| of.iter().any(|(stroke, up)| *stroke == s && *up)).collect();
    let (mut product, mut weight) = (0.0, 0.0);
    for up in [true, false] {
        for place in 0..PLACES {
            let of_stroke = |s: usize| sums.get(s).and_then(|places| places.get(place)).copied();
            let there: Vec<(f64, usize)> =
                (0..count).filter(|s| is_up[*s] == up).filter_map(of_stroke).filter(|(_, n)| *n > 0).collect();
            let samples: usize = there.iter().map(|(_, n)| n).sum();
            let m = there.len() as f64;
            if m < 2.0 {
                continue;
            }
            let means: Vec<f64> = there.iter().map(|(sum, n)| sum / *n as f64).collect();
            let all: f64 = means.iter().sum();
            let own: f64 = means.iter().map(|r| r * r).sum();
            product += samples as f64 * (all * all - own) / (m * (m - 1.0));
            weight += samples as f64;
        }
    }
    (weight > 0.0 && variance > 0.0).then(|| (product / weight / variance).clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    /// A triangle of eight strokes; the residual is a ripple of the place plus another that no stroke repeats.
    #[test]
    fn what_repeats_is_told_from_what_does_not() {
        let place = |k: usize| {
            let phase = (k % 400) as f64 / 200.0;
            20.0 * if phase < 1.0 { phase } else { 2.0 - phase }
        };
        let position: Vec<f64> = (0..1600).map(place).collect();
        assert_eq!(strokes(&position).last().unwrap().0, 7);
        let mut state = 1_u64;
        let mut white = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        };
        // Ripple of variance 1/2, white noise of variance 1/2.
        let residual: Vec<f64> = position.iter().map(|x| (0.6 * x).sin() + 6.0_f64.sqrt() * white()).collect();
        let share = repeated(&position, &residual).unwrap();
        // 1600 samples: a share of a half within 0.06.
        assert!((share - 0.5).abs() < 0.06, "{share}");
        let noise: Vec<f64> = position.iter().map(|_| white()).collect();
        assert!(repeated(&position, &noise).unwrap() < 0.05);
    }
}
