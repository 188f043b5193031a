//! How many palpations are recognised (thesis Tables 3 and 4).

use std::fmt::Write as _;

use tests::palpations::{Count, Study};

use super::Bench;
use super::row::Row;

/// Totals of Table 3, percent, at 1, 2 and 4 mm/s.
const THESIS: [f64; 3] = [96.7, 91.3, 98.0];

/// Least part recognised that is asked for, percent.
const GOAL: f64 = 99.0;

pub fn rows(bench: &Bench, studies: &[Study]) -> Vec<Row> {
    let row = |(study, thesis): (&Study, f64)| {
        let count = study.recognised(&bench.foams, None);
        Row {
            what: "recognised, variance search (Table 3)",
            case: format!("{} mm/s", study.rate_mm_s),
            thesis: format!("{thesis} %"),
            goal: format!(">= {GOAL} %"),
            measured: text(count),
            met: Some(count.percent() >= GOAL),
        }
    };
    let filtered = |study: &Study| {
        let count = study.recognised_by_filter(&bench.foams, None);
        Row {
            what: "recognised, Kalman filter (Table 4)",
            case: format!("{} mm/s", study.rate_mm_s),
            thesis: if study.rate_mm_s == KALMAN_RATE_MM_S { format!("{KALMAN} %") } else { "none printed".into() },
            goal: format!(">= {KALMAN_GOAL} %"),
            measured: text(count),
            met: Some(count.percent() >= KALMAN_GOAL),
        }
    };
    studies.iter().zip(THESIS).map(row).chain(studies.iter().map(filtered)).collect()
}

/// Total of Table 4, percent, at the rate of the text above it, and what is asked for.
const KALMAN: f64 = 99.3;
const KALMAN_RATE_MM_S: f64 = 2.0;
const KALMAN_GOAL: f64 = 99.5;

/// Recognition foam by foam, by the board and by the thesis' way.
pub fn table(bench: &Bench, studies: &[Study]) -> String {
    let mut out = String::from("| rate, way |");
    for foam in &bench.foams {
        let _ = write!(out, " {} |", foam.name);
    }
    out.push_str(" all | at least, 95 % |\n|---|");
    out.push_str(&"---|".repeat(bench.foams.len() + 2));
    out.push('\n');
    for study in studies {
        let board = |foam| study.recognised(&bench.foams, foam);
        line(&mut out, &format!("{} mm/s, board", study.rate_mm_s), bench, &board);
        let filter = |foam| study.recognised_by_filter(&bench.foams, foam);
        line(&mut out, &format!("{} mm/s, Kalman", study.rate_mm_s), bench, &filter);
        let thesis = |foam| study.recognised_by_threshold(&bench.foams, foam);
        line(&mut out, &format!("{} mm/s, thesis' way", study.rate_mm_s), bench, &thesis);
    }
    out
}

fn line(out: &mut String, title: &str, bench: &Bench, count: &dyn Fn(Option<usize>) -> Count) {
    let _ = write!(out, "| {title} |");
    for foam in 0..bench.foams.len() {
        let _ = write!(out, " {:.1} % |", count(Some(foam)).percent());
    }
    let all = count(None);
    let _ = writeln!(out, " {} | {:.1} % |", text(all), 100.0 * lower_bound(all));
}

pub fn text(count: Count) -> String {
    format!("{} of {} ({:.1} %)", count.right, count.of, count.percent())
}

/// Lower bound of the true rate with 95 % confidence (Wilson's score, one sided): all of 1,500 right still leaves 0.2 %.
fn lower_bound(count: Count) -> f64 {
    const Z: f64 = 1.645;
    let (n, p) = (count.of.max(1) as f64, count.right as f64 / count.of.max(1) as f64);
    let middle = p + Z * Z / (2.0 * n);
    let half = Z * (p * (1.0 - p) / n + Z * Z / (4.0 * n * n)).sqrt();
    (middle - half) / (1.0 + Z * Z / n)
}
