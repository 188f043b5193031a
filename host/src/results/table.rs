//! A table of many experiments: for the terminal, and as `table.csv`.

use crate::identify::Identification;
use crate::identify::fit::Parameter;
use crate::report::{Page, number};

/// What became of one experiment.
#[derive(Debug)]
pub struct Row {
    /// Its folder, as it was asked for.
    pub experiment: String,
    /// Its title; none where it could not be read.
    pub name: String,
    /// What was found of its materials, or why nothing was.
    pub found: Result<Vec<Identification>, String>,
}

/// A table of many experiments.
#[derive(Debug, Default)]
pub struct Table {
    /// One an experiment.
    pub rows: Vec<Row>,
}

/// A line of the table: an experiment with one of its materials, if it has any.
struct Line<'a> {
    row: &'a Row,
    material: Option<&'a Identification>,
}

impl Line<'_> {
    fn parameter(&self, name: &str) -> Option<&Parameter> {
        self.material?.fit.as_ref()?.parameters.iter().find(|parameter| parameter.name == name)
    }

    fn outcome(&self) -> &'static str {
        match (self.material, &self.row.found) {
            (Some(one), _) => one.outcome.word(),
            (None, Ok(_)) => "nothing-to-identify",
            (None, Err(_)) => "failed",
        }
    }
}

impl Table {
    fn lines(&self) -> Vec<Line<'_>> {
        let of_row = |row| -> Vec<Line<'_>> {
            let none = Line { row, material: None };
            match &row.found {
                Ok(all) if !all.is_empty() => all.iter().map(|one| Line { row, material: Some(one) }).collect(),
                _ => vec![none],
            }
        };
        self.rows.iter().flat_map(of_row).collect()
    }

    /// Names of all parameters, in order of appearance.
    fn names(&self) -> Vec<String> {
        let mut names: Vec<String> = Vec::new();
        let found = self.rows.iter().filter_map(|row| row.found.as_ref().ok()).flatten();
        for parameter in found.filter_map(|one| one.fit.as_ref()).flat_map(|fit| &fit.parameters) {
            if !names.contains(&parameter.name) {
                names.push(parameter.name.clone());
            }
        }
        names
    }

    /// Experiments without an answer.
    #[must_use]
    pub fn failed(&self) -> Vec<&Row> {
        self.rows.iter().filter(|row| row.found.is_err()).collect()
    }

    /// The table for a terminal: columns under their heads, two blanks apart.
    #[must_use]
    pub fn text(&self) -> String {
        aligned(&self.cells())
    }

    /// The table as a page.
    #[must_use]
    pub fn page(&self) -> Page {
        let fitted = self.rows.len() - self.failed().len();
        let mut page = Page::new("Identification of many experiments", "");
        page.verdict(&format!("{fitted} of {} experiments were read and fitted.", self.rows.len()));
        for row in self.failed() {
            let why = row.found.as_ref().err().map_or("", String::as_str);
            page.warning(&format!("{}: {why}", row.experiment));
        }
        let cells = self.cells();
        if let Some((head, rows)) = cells.split_first() {
            page.table(&head.iter().map(String::as_str).collect::<Vec<_>>(), rows);
        }
        page.paragraph("Each experiment has a folder of its own beside this page. 95 % intervals are in brackets.");
        page
    }

    /// Head and lines.
    fn cells(&self) -> Vec<Vec<String>> {
        let names = self.names();
        let mut cells = vec![vec!["experiment".to_owned(), "material".to_owned(), "outcome".to_owned()]];
        cells[0].extend(names.iter().cloned());
        cells[0].push("residual, N".to_owned());
        for line in self.lines() {
            let name = if line.row.name.is_empty() { &line.row.experiment } else { &line.row.name };
            let material = line.material.map_or("-", |one| one.material.as_str());
            let mut row = vec![name.clone(), material.to_owned(), line.outcome().to_owned()];
            let told = |p: &Parameter| {
                format!("{} ({} to {})", number(p.value), number(p.interval95.low), number(p.interval95.high))
            };
            row.extend(names.iter().map(|name| line.parameter(name).map_or_else(|| "-".to_owned(), told)));
            let fit = line.material.and_then(|one| one.fit.as_ref());
            row.push(fit.map_or_else(|| "-".to_owned(), |fit| number(fit.rmse_n)));
            cells.push(row);
        }
        cells
    }

    /// The table as CSV, one line an experiment and material, with a value and two ends of an interval a parameter.
    #[must_use]
    pub fn csv(&self) -> String {
        let names = self.names();
        let mut head: Vec<String> = ["experiment", "name", "material", "outcome"].map(str::to_owned).to_vec();
        for name in &names {
            head.extend([name.clone(), format!("{name} low95"), format!("{name} high95")]);
        }
        head.extend(["rmse_N", "noise_N", "error"].map(str::to_owned));
        let number = |x: f64| if x.is_finite() { format!("{x}") } else { String::new() };
        let row = |line: &Line<'_>| {
            let material = line.material.map_or("", |one| one.material.as_str());
            let mut row = vec![
                line.row.experiment.clone(),
                line.row.name.clone(),
                material.to_owned(),
                line.outcome().to_owned(),
            ];
            for name in &names {
                match line.parameter(name) {
                    Some(p) => row.extend([p.value, p.interval95.low, p.interval95.high].map(number)),
                    None => row.extend([String::new(), String::new(), String::new()]),
                }
            }
            let fit = line.material.and_then(|one| one.fit.as_ref());
            row.extend(
                [fit.map(|fit| fit.rmse_n), fit.map(|fit| fit.noise.sigma_n)]
                    .map(|x| x.map_or_else(String::new, number)),
            );
            row.push(
                line.row
                    .found
                    .as_ref()
                    .err()
                    .map(|told| told.lines().next().unwrap_or_default().to_owned())
                    .unwrap_or_default(),
            );
            row
        };
        csv(head, self.lines().iter().map(row))
    }
}

/// Lines of cells, each column as wide as its widest cell.
fn aligned(rows: &[Vec<String>]) -> String {
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let width = |at: usize| rows.iter().filter_map(|row| row.get(at)).map(|cell| cell.chars().count()).max();
    let widths: Vec<usize> = (0..columns).map(|at| width(at).unwrap_or(0)).collect();
    let mut out = String::new();
    for row in rows {
        let cells: Vec<String> = row.iter().zip(&widths).map(|(cell, wide)| format!("{cell:wide$}")).collect();
        out.push_str(cells.join("  ").trim_end());
        out.push('\n');
    }
    out
}

/// Text of a CSV file.
pub(super) fn csv(head: Vec<String>, rows: impl Iterator<Item = Vec<String>>) -> String {
    let mut writer = csv::Writer::from_writer(Vec::new());
    for row in std::iter::once(head).chain(rows) {
        // memory takes every record, and all have as many cells as the head
        let _ = writer.write_record(row);
    }
    let bytes = writer.into_inner().unwrap_or_default();
    String::from_utf8_lossy(&bytes).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failed_experiment_is_a_line_like_the_others() {
        let rows = vec![
            Row { experiment: "a".to_owned(), name: "Air, only".to_owned(), found: Ok(Vec::new()) },
            Row { experiment: "b".to_owned(), name: String::new(), found: Err("line 3: no number\nmore".to_owned()) },
        ];
        let table = Table { rows };
        assert_eq!(table.failed().len(), 1);
        assert!(table.text().contains("Air, only   -         nothing-to-identify"), "{}", table.text());
        assert_eq!(
            table.csv(),
            "experiment,name,material,outcome,rmse_N,noise_N,error\n\
             a,\"Air, only\",,nothing-to-identify,,,\nb,,,failed,,,line 3: no number\n"
        );
    }
}
