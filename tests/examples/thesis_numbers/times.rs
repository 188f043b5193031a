//! CPU time of a thousand identifications (thesis section 3.4).

use firmware::kalman::Bounding;
use tests::thousand::{Thousand, fastest};

use super::row::Row;

/// The thesis' times (MATLAB, one core of an i7-3770), and what is asked for, s.
const VARIANCE_S: (f64, f64) = (1.513, 0.05);
const KALMAN_S: (f64, f64) = (1304.61, 0.15);

/// The thesis' ratio of the two, and the largest that is asked for.
const RATIO: (f64, f64) = (862.0, 3.0);

/// Runs of which the fastest counts.
const REPEATS: usize = 7;

pub fn rows() -> Result<Vec<Row>, Box<dyn std::error::Error>> {
    let thousand = Thousand::new()?;
    let variance_s = fastest(REPEATS, || thousand.variance())?.seconds;
    let fast_s = fastest(REPEATS, || thousand.fast())?.seconds;
    let kalman_s = fastest(REPEATS, || thousand.kalman(Bounding::Constrained { linearisations: 1 }, 1))?.seconds;
    let row = |case: &str, (thesis, goal): (f64, f64), seconds: f64| Row {
        what: "CPU time of 1,000 identifications",
        case: case.to_owned(),
        thesis: format!("{thesis} s"),
        goal: format!("<= {goal} s"),
        measured: format!("{seconds:.3} s"),
        met: Some(seconds <= goal),
    };
    let ratio = |case: &str, ratio: f64| Row {
        what: "Kalman over variance, time",
        case: case.to_owned(),
        thesis: format!("{}", RATIO.0),
        goal: format!("<= {}", RATIO.1),
        measured: format!("{ratio:.1}"),
        met: Some(ratio <= RATIO.1),
    };
    Ok(vec![
        row("variance, Eq. 17 over 900 columns", VARIANCE_S, variance_s),
        row("variance, fast form of 30 rows", VARIANCE_S, fast_s),
        row("Kalman, one pass", KALMAN_S, kalman_s),
        ratio("against 900 columns", kalman_s / variance_s),
        ratio("against the fast form", kalman_s / fast_s),
    ])
}
