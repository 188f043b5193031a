//! Page of a subject test.

use super::Page;
use super::figure::{Axis, Figure, Series, Stroke};
use crate::trial::confusion::Confusion;

/// Share of right answers of each material with its exact interval, and what a subject would do.
#[must_use]
pub fn shares(table: &Confusion, predicted: Option<&[Vec<f64>]>, weber: f64) -> Figure {
    let last = table.names.len() as f64;
    let mut figure = Figure::new(
        "Right answers",
        Axis::new("material (number of its row)").over(0.5, last + 0.5),
        Axis::new("share").over(0.0, 1.05),
    );
    let chance = 1.0 / last;
    figure = figure.with(Series::new("guessing", vec![(0.5, chance), (last + 0.5, chance)], Stroke::Dotted, 5));
    let cells = table.cells();
    let whiskers = cells.iter().enumerate().flat_map(|(i, row)| {
        let (x, (low, high)) = (i as f64 + 1.0, row[i].interval95);
        // A point that is not finite breaks the line.
        [(x, low), (x, high), (x, f64::NAN)]
    });
    figure = figure.with(Series::new("", whiskers.collect(), Stroke::Solid, 0));
    let found = cells.iter().enumerate().map(|(i, row)| (i as f64 + 1.0, row[i].value())).collect();
    figure = figure.with(Series::new("found, 95 %", found, Stroke::Dots, 0));
    if let Some(predicted) = predicted {
        let points = predicted.iter().enumerate().map(|(i, row)| (i as f64 + 1.0, row[i])).collect();
        let label = format!("Weber {:.0} %", 100.0 * weber);
        figure = figure.with(Series::new(&label, points, Stroke::Circles, 1));
    }
    figure
}

/// The page: what was found, the table, the picture.
#[must_use]
pub fn page(table: &Confusion, lines: &[String], figure: &str) -> Page {
    let mut page = Page::new("Subject test", &table.title);
    if let Some((first, rest)) = lines.split_first() {
        page.verdict(first);
        page.list(rest);
    }
    page.section("Confusion table");
    page.paragraph(
        "Rows: shown. Columns: answered. Counts with exact 95 % intervals (Clopper and Pearson) of the row's share.",
    );
    let mut head = vec!["", "shown"];
    head.extend(table.names.iter().map(String::as_str));
    let rows: Vec<Vec<String>> = table
        .cells()
        .iter()
        .enumerate()
        .map(|(i, row)| {
            let cell = |share: &crate::trial::confusion::Share| {
                let (low, high) = share.interval95;
                format!("{} ({:.0} to {:.0} %)", share.hits, 100.0 * low, 100.0 * high)
            };
            [(i + 1).to_string(), table.names[i].clone()].into_iter().chain(row.iter().map(cell)).collect()
        })
        .collect();
    page.table(&head, &rows);
    page.figure(figure, "Right answers of each material, and what a subject with the stated Weber fraction would do.");
    page
}
