//! What the filter does at the edge of its region (thesis Figs. 33 and 34).

use std::fmt::Write as _;
use std::path::Path;

use palpate::report::figure::{Axis, Figure, Series, Stroke};
use protocol::lut::Table;
use tests::bounding::{BOUNDINGS, Benchmark, End, HIGH, LOW, initial_estimates, run, table as bytes};

use super::row::Row;
use super::save;

/// The two places of the target: case, what the thesis saw, what is asked for, file of the picture.
const PLACES: [(&str, Benchmark, &str, &str, &str); 2] = [
    (
        "target near the edge, Fig. 33",
        Benchmark::EDGE,
        "nearest neighbour best, then penalty, then projection",
        "the same order; one that never fails",
        "thesis-bounding-edge.svg",
    ),
    (
        "target in the middle, Fig. 34",
        Benchmark::CENTRE,
        "only nearest neighbour fails at times",
        "the same; one that never fails",
        "thesis-bounding-centre.svg",
    ),
];

/// Rows, the table of successes, and the pictures.
pub fn measure(docs: &Path) -> Result<(Vec<Row>, String), Box<dyn std::error::Error>> {
    let bytes = bytes()?;
    let table = Table::parse(&bytes).map_err(|e| e.to_string())?;
    let initial = initial_estimates();
    let mut rows = Vec::new();
    let mut out = String::from("| bounding | near the edge | in the middle |\n|---|---|---|\n");
    let mut counts = Vec::new();
    for (case, benchmark, thesis, goal, file) in PLACES {
        let runs = BOUNDINGS.map(|(_, bounding)| run(&table, &benchmark, bounding, &initial).unwrap_or_default());
        let found = runs.each_ref().map(|ends| ends.iter().filter(|end| end.success).count());
        let all = initial.len();
        let [projection, penalty, neighbour, _, constrained] = found;
        let order = match file.contains("edge") {
            true => neighbour > penalty && penalty > projection,
            false => projection == all && penalty == all && neighbour < all,
        };
        save(docs, file, &picture(case, &benchmark, &runs))?;
        rows.push(Row {
            what: "bounding, successes of 400",
            case: case.to_owned(),
            thesis: thesis.to_owned(),
            goal: goal.to_owned(),
            measured: format!(
                "nearest neighbour {neighbour}, penalty {penalty}, projection {projection}, ours {constrained}"
            ),
            met: Some(order && constrained == all),
        });
        counts.push(found);
    }
    for (i, (name, _)) in BOUNDINGS.iter().enumerate() {
        let _ = write!(out, "| {name} |");
        for found in &counts {
            let _ = write!(out, " {} of {} |", found[i], initial.len());
        }
        out.push('\n');
    }
    Ok((rows, out))
}

/// Where the identifications end, with the bounds of the region dashed.
fn picture(case: &str, benchmark: &Benchmark, runs: &[Vec<End>; 5]) -> String {
    let title = format!("Last estimates from 400 initial ones, {case}; dashed: bounds");
    let room = |k: usize| 0.08 * (HIGH[k] - LOW[k]);
    let axis = |label: &str, k: usize| Axis::new(label).over(LOW[k] - room(k), HIGH[k] + room(k));
    let mut figure = Figure::new(&title, axis("alpha", 1), axis("mu (MPa)", 0));
    figure.size = (760.0, 400.0);
    let corners = [(LOW[1], LOW[0]), (HIGH[1], LOW[0]), (HIGH[1], HIGH[0]), (LOW[1], HIGH[0]), (LOW[1], LOW[0])];
    figure = figure.with(Series::new("", corners.to_vec(), Stroke::Dashed, 5));
    for (i, ((name, _), ends)) in BOUNDINGS.iter().zip(runs).enumerate() {
        let success = ends.iter().filter(|end| end.success).count();
        // The last point carries the label: the target, so that labels of all boundings lie side by side.
        let mut points: Vec<(f64, f64)> =
            ends.iter().map(|end| (f64::from(end.estimate[1]), f64::from(end.estimate[0]))).collect();
        points.push((f64::from(benchmark.alpha), f64::from(benchmark.mu_mpa)));
        figure = figure.with(Series::new(&format!("{name}: {success}"), points, Stroke::Circles, i));
    }
    figure.svg()
}
