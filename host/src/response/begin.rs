//! Where a fit begins: the linear part on a grid, its gain and place by least squares.

use nalgebra::{DMatrix, DVector};

use super::fit::{Record, ends};
use super::law::{Law, Structure};
use super::motion::follow;

const DAMPINGS: [f64; 4] = [0.3, 0.7, 1.2, 3.0];
/// Poles a decade.
const POLES: usize = 12;
/// Dead times that are tried, in time constants of the fastest pole that a recording can show.
const DELAYS: [f64; 6] = [0.0, 1.0, 2.0, 4.0, 8.0, 16.0];
/// Samples that a grid point is judged by.
const JUDGED: usize = 2000;

/// Laws of a structure with neither friction, play nor rate limit, the best first; of both signs of the gain.
#[must_use]
pub fn linear(record: &Record, structure: Structure) -> Vec<(f64, Law)> {
    let thin = thinned(record);
    let step_s = record.step_s();
    let whole_s = record.time_s.last().unwrap_or(&1.0) - record.time_s.first().unwrap_or(&0.0);
    let (slowest, fastest) = (2.0 / whole_s, 1.0 / step_s);
    let poles: Vec<f64> = match structure {
        Structure::Spindle => vec![1.0],
        _ => (0..POLES).map(|k| slowest * (fastest / slowest).powf((k as f64 + 0.5) / POLES as f64)).collect(),
    };
    let dampings: &[f64] = if matches!(structure, Structure::Mass | Structure::MassLag) { &DAMPINGS } else { &[1.0] };
    let lags: &[f64] = if structure == Structure::MassLag { &[0.3, 1.0] } else { &[1.0] };
    let mut found = Vec::new();
    for frequency_rad_s in poles {
        for damping in dampings {
            for lag in lags {
                for delay in DELAYS {
                    let law = Law {
                        structure,
                        gain: 1.0,
                        offset: 0.0,
                        frequency_rad_s,
                        damping: *damping,
                        lag_s: lag / frequency_rad_s,
                        delay_s: delay * 2.0 * step_s,
                        rate_mm_s: f64::INFINITY,
                        friction_v: 0.0,
                        play_mm: 0.0,
                        start_mm: 0.0,
                        start_share: 0.0,
                    };
                    found.extend(scaled(&thin, law));
                }
            }
        }
    }
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    found
}

/// Every so many samples; what a grid point is judged by need not be all of them.
fn thinned(record: &Record) -> (Record, Vec<usize>) {
    let every = record.time_s.len().div_ceil(JUDGED).max(1);
    (record.clone(), (0..record.time_s.len()).step_by(every).collect())
}

/// Gain and place by least squares, with what is left.
fn scaled((record, judged): &(Record, Vec<usize>), mut law: Law) -> Option<(f64, Law)> {
    let integrates = law.structure.integrates();
    let first_v = *record.command_v.first()?;
    law.start_mm = if integrates { 0.0 } else { first_v };
    let shape = follow(&law, &record.time_s, &record.command_v);
    let first_s = *record.time_s.first()?;
    let width = if integrates { 3 } else { 2 };
    let a = DMatrix::from_fn(judged.len(), width, |row, column| match column {
        0 => shape[judged[row]],
        1 => 1.0,
        _ => record.time_s[judged[row]] - first_s,
    });
    let y = DVector::from_iterator(judged.len(), judged.iter().map(|row| record.position_mm[*row]));
    let x = a.tr_mul(&a).lu().solve(&a.tr_mul(&y))?;
    let left = (&y - &a * &x).norm_squared();
    if !left.is_finite() || x[0] == 0.0 {
        return None;
    }
    law.gain = x[0];
    law.offset = if integrates { -x[2] / x[0] } else { x[1] };
    law.start_mm = *record.position_mm.first()?;
    Some((left, law))
}

/// What the nonlinear parts may be at first: friction, play and rate limit.
#[must_use]
pub fn flaws(record: &Record) -> Vec<(f64, f64, Option<f64>)> {
    let (low, high) = ends(&record.command_v);
    let (swing_v, travel) = (high - low, record.travel_mm());
    let limit = record.speed_mm_s();
    let mut all = Vec::new();
    for share in [0.003, 0.03] {
        for rate in [None, Some(0.9 * limit)] {
            all.push((share * swing_v, share * travel, rate));
        }
    }
    all
}
