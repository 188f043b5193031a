//! How far the identified exponent of B1 scatters (thesis section 3.4).

use std::fmt::Write as _;

use tests::palpations::{Spread, Study};

use super::Bench;
use super::row::Row;

/// "Deviation of identified parameter alpha for material B1", percent, at 1, 2 and 4 mm/s.
const THESIS: [f64; 3] = [28.0, 21.3, 7.3];

pub fn rows(bench: &Bench, studies: &[Study]) -> Vec<Row> {
    let b1 = bench.foam("B1");
    let row = |(study, thesis): (&Study, f64)| {
        let percent = 100.0 * study.alpha(b1).deviation;
        Row {
            what: "spread of alpha, B1",
            case: format!("{} mm/s", study.rate_mm_s),
            thesis: format!("{thesis} %"),
            goal: format!("< {} %", 0.5 * thesis),
            measured: format!(
                "{percent:.1} % ({:.1} % the thesis' way)",
                100.0 * study.alpha_by_threshold(b1).deviation
            ),
            met: Some(percent < 0.5 * thesis),
        }
    };
    studies.iter().zip(THESIS).map(row).collect()
}

/// Mean and spread of the exponent, foam by foam.
pub fn table(bench: &Bench, studies: &[Study]) -> String {
    let mut out = String::from(
        "| foam (alpha) | rate | board: mean | deviation | farthest | Kalman: mean | deviation | farthest | thesis' way: mean | deviation | farthest |\n|---|---|---|---|---|---|---|---|---|---|---|\n",
    );
    for (i, foam) in bench.foams.iter().enumerate() {
        for study in studies {
            let _ = write!(out, "| {} ({}) | {} mm/s |", foam.name, foam.alpha, study.rate_mm_s);
            let ways = [study.alpha(i), study.alpha_by_filter(i), study.alpha_by_threshold(i)];
            let _ = writeln!(out, "{}", ways.map(columns).concat());
        }
    }
    out
}

fn columns(spread: Spread) -> String {
    format!(" {:.2} | {:.1} % | {:.1} % |", spread.mean, 100.0 * spread.deviation, 100.0 * spread.largest)
}
