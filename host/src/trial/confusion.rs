//! What was shown against what was answered.

use std::path::{Path, PathBuf};

use super::detect::{Distance, distance_of, pair};
use super::exact::{interval95, tail};
use super::information::transmitted_bits;
use super::journal::{Given, Session};

/// Counts of answers, rows shown, columns answered.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Confusion {
    /// Where they come from.
    pub title: String,
    /// Materials.
    pub names: Vec<String>,
    /// Counts.
    pub counts: Vec<Vec<u32>>,
    /// Subjects that the counts come from, where that is known: answers of one are not independent.
    pub subjects: Option<usize>,
    /// What to know about them.
    pub remarks: Vec<String>,
}

/// A share with its exact interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Share {
    /// Hits.
    pub hits: u32,
    /// Trials.
    pub trials: u32,
    /// 95 % interval after Clopper and Pearson.
    pub interval95: (f64, f64),
}

impl Share {
    fn of(hits: u32, trials: u32) -> Self {
        Self { hits, trials, interval95: interval95(hits, trials) }
    }

    /// Hits over trials; 0 without trials.
    #[must_use]
    pub fn value(&self) -> f64 {
        if self.trials == 0 { 0.0 } else { f64::from(self.hits) / f64::from(self.trials) }
    }
}

/// What is wrong with a table of counts. The texts are part of the interface.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum ConfusionError {
    /// The header is another.
    #[error("{}, line 1: \"{found}\"; expected the columns shown,answered,count", file.display())]
    Header {
        /// The file.
        file: PathBuf,
        /// What stands there.
        found: String,
    },
    /// A row that breaks a rule.
    #[error("{}, line {line}, column {column}: \"{value}\"; expected {expected}", file.display())]
    Cell {
        /// The file.
        file: PathBuf,
        /// Line, from 1.
        line: usize,
        /// Column.
        column: &'static str,
        /// What stands there.
        value: String,
        /// What was expected.
        expected: String,
    },
    /// Too few or too many materials.
    #[error("{}: {count} materials; expected 2 to 9 that are shown or answered", file.display())]
    Materials {
        /// The file.
        file: PathBuf,
        /// How many there are.
        count: usize,
    },
    /// Sessions of other materials.
    #[error("{}: shows {found}; the files before it show {expected}", file.display())]
    Other {
        /// The file.
        file: PathBuf,
        /// Its materials.
        found: String,
        /// Those of the others.
        expected: String,
    },
}

/// Largest count of a cell.
const MOST: u32 = 1_000_000;

impl Confusion {
    /// Table 8 of the thesis (section 5.8).
    #[must_use]
    pub fn thesis_table_8() -> Self {
        let names = ["ICF-400", "A2", "B1", "Plexiglas"].map(str::to_owned).to_vec();
        let counts = (0..4).map(|i| (0..4).map(|j| if i == j { 25 } else { 0 }).collect()).collect();
        Self {
            title: "Table 8 of the thesis".to_owned(),
            names,
            counts,
            subjects: Some(25),
            remarks: vec![
                "The table prints A2-400, B1-400 and Plexiglas-400; the text names ICF-400, A2, B1 and Plexiglas: 400 belongs to ICF alone."
                    .to_owned(),
                "Each subject named all four. If it knew that each comes once, the last answer followed from the others: then there are 75 \
                 free answers, not 100."
                    .to_owned(),
            ],
        }
    }

    /// Table 9 of the thesis (section 5.8).
    #[must_use]
    pub fn thesis_table_9() -> Self {
        Self {
            title: "Table 9 of the thesis".to_owned(),
            names: vec!["A2-FR".to_owned(), "A2".to_owned()],
            counts: vec![vec![17, 8], vec![11, 14]],
            subjects: Some(25),
            remarks: vec![
                "\"Not recognized\" is counted as the other material, as there are two.".to_owned(),
                "The two answers of a subject may depend on each other; the table does not tell how they pair."
                    .to_owned(),
            ],
        }
    }

    /// Of journals of sessions with the same materials in any order.
    ///
    /// # Errors
    /// [`ConfusionError::Other`].
    pub fn of_journals(sessions: &[(PathBuf, Session, Vec<Given>)]) -> Result<Self, ConfusionError> {
        let names = sessions.first().map_or_else(Vec::new, |(_, session, _)| session.stimuli.clone());
        let mut counts = vec![vec![0; names.len()]; names.len()];
        let mut subjects: Vec<&str> = Vec::new();
        for (file, session, given) in sessions {
            let places: Option<Vec<usize>> =
                session.stimuli.iter().map(|name| names.iter().position(|known| known == name)).collect();
            let places = places.filter(|places| places.len() == names.len());
            let places = places.ok_or_else(|| ConfusionError::Other {
                file: file.clone(),
                found: session.stimuli.join(", "),
                expected: names.join(", "),
            })?;
            for one in given {
                counts[places[one.shown]][places[one.answered]] += 1;
            }
            if !subjects.contains(&session.subject.as_str()) {
                subjects.push(&session.subject);
            }
        }
        let missing: usize = sessions.iter().map(|(_, session, given)| session.order.len() - given.len()).sum();
        let mut remarks = Vec::new();
        if missing > 0 {
            remarks.push(format!("{missing} presentations are not answered yet."));
        }
        let title = format!("{} sessions of {} subjects", sessions.len(), subjects.len());
        Ok(Self { title, names, counts, subjects: Some(subjects.len()), remarks })
    }

    /// Of a CSV with the columns shown, answered and count.
    ///
    /// # Errors
    /// [`ConfusionError`].
    pub fn parse(file: &Path, text: &str) -> Result<Self, ConfusionError> {
        let file = || file.to_owned();
        let mut lines = text.trim_start_matches('\u{feff}').lines().enumerate();
        let first = lines.next().map_or("", |(_, line)| line.trim());
        if first.replace(' ', "") != "shown,answered,count" {
            return Err(ConfusionError::Header { file: file(), found: first.to_owned() });
        }
        let mut rows: Vec<(usize, usize, u32)> = Vec::new();
        let mut names: Vec<String> = Vec::new();
        for (at, line) in lines.filter(|(_, line)| !line.trim().is_empty()) {
            let wrong = |column: &'static str, value: &str, expected: &str| ConfusionError::Cell {
                file: file(),
                line: at + 1,
                column,
                value: value.to_owned(),
                expected: expected.to_owned(),
            };
            let cells: Vec<&str> = line.split(',').map(str::trim).collect();
            let [shown, answered, count] = cells.as_slice() else {
                return Err(wrong("count", line, "three cells: shown, answered, count"));
            };
            let mut place = |column: &'static str, name: &str| {
                if name.is_empty() {
                    return Err(wrong(column, name, "the name of a material"));
                }
                let known = names.iter().position(|known| known == name);
                Ok(known.unwrap_or_else(|| {
                    names.push(name.to_owned());
                    names.len() - 1
                }))
            };
            let (i, j) = (place("shown", shown)?, place("answered", answered)?);
            let number = count.parse::<u32>().ok().filter(|n| *n <= MOST);
            rows.push((i, j, number.ok_or_else(|| wrong("count", count, "a whole number of 0 to 1000000"))?));
        }
        if !(2..=super::journal::MOST_STIMULI).contains(&names.len()) {
            return Err(ConfusionError::Materials { file: file(), count: names.len() });
        }
        let mut counts = vec![vec![0; names.len()]; names.len()];
        for (i, j, count) in rows {
            counts[i][j] += count;
        }
        Ok(Self { title: file().display().to_string(), names, counts, subjects: None, remarks: Vec::new() })
    }

    /// Share of each answer (columns) to each stimulus (rows).
    #[must_use]
    pub fn cells(&self) -> Vec<Vec<Share>> {
        let row = |row: &Vec<u32>| {
            let trials = row.iter().sum();
            row.iter().map(|hits| Share::of(*hits, trials)).collect()
        };
        self.counts.iter().map(row).collect()
    }

    /// Right answers of all.
    #[must_use]
    pub fn total(&self) -> Share {
        let hits = self.counts.iter().enumerate().map(|(i, row)| row[i]).sum();
        Share::of(hits, self.counts.iter().flatten().sum())
    }

    /// Probability of as many right answers by guessing.
    #[must_use]
    pub fn by_chance(&self) -> f64 {
        let total = self.total();
        tail(total.hits, total.trials, 1.0 / self.names.len() as f64)
    }

    /// d' of an unbiased choice among all, with its interval from the exact one of the share of right answers.
    #[must_use]
    pub fn distance(&self) -> (f64, (f64, f64)) {
        let (total, choices) = (self.total(), self.names.len());
        let (low, high) = total.interval95;
        (distance_of(total.value(), choices), (distance_of(low, choices), distance_of(high, choices)))
    }

    /// d' of every pair, from the trials in which one of them was shown and one of them answered.
    #[must_use]
    pub fn pairs(&self) -> Vec<(usize, usize, Distance)> {
        let n = &self.counts;
        let all = (0..self.names.len()).flat_map(|i| (i + 1..self.names.len()).map(move |j| (i, j)));
        all.filter_map(|(i, j)| Some((i, j, pair([[n[i][i], n[i][j]], [n[j][i], n[j][j]]])?))).collect()
    }

    /// Bits that an answer carries, as counted and less the bias; and the most that it could.
    #[must_use]
    pub fn bits(&self) -> (f64, f64, f64) {
        let (counted, corrected) = transmitted_bits(&self.counts);
        (counted, corrected, (self.names.len() as f64).log2())
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    /// Table 8: 25 of 25 has (0.025)^(1/25) to 1, 100 of 100 has (0.025)^(1/100) to 1.
    #[test]
    fn table_8_is_certain_to_86_percent_each() {
        let table = Confusion::thesis_table_8();
        for (i, row) in table.cells().iter().enumerate() {
            assert!((row[i].interval95.0 - 0.025_f64.powf(0.04)).abs() < 1e-9 && row[i].interval95.1 == 1.0);
        }
        assert!((table.total().interval95.0 - 0.025_f64.powf(0.01)).abs() < 1e-9);
        assert!((table.bits().0 - 2.0).abs() < 1e-12 && table.distance().0.is_infinite());
        assert!(table.by_chance() < 1e-50);
    }

    /// Table 9: 17 of 25 has 0.4650 to 0.8505, 14 of 25 has 0.3493 to 0.7560, 31 of 50 has 0.4717 to 0.7535 (R's binom.test).
    #[test]
    fn table_9_is_not_surely_better_than_guessing() {
        let table = Confusion::thesis_table_9();
        let cells = table.cells();
        let near = |(a, b): (f64, f64), (c, d): (f64, f64)| (a - c).abs() < 1e-4 && (b - d).abs() < 1e-4;
        assert!(near(cells[0][0].interval95, (0.4650, 0.8505)), "{:?}", cells[0][0]);
        assert!(near(cells[1][1].interval95, (0.3493, 0.7560)), "{:?}", cells[1][1]);
        assert!(near(table.total().interval95, (0.4717, 0.7535)), "{:?}", table.total());
        // P(31 or more of 50 by guessing) = 0.0595.
        assert!((table.by_chance() - 0.0595).abs() < 1e-4, "{}", table.by_chance());
    }

    #[test]
    fn counts_are_read_and_mistakes_told() {
        let parsed = |text: &str| Confusion::parse(Path::new("a.csv"), text);
        let table = parsed("shown,answered,count\nA,A,3\nA,B,1\nB,B,4\n\nA,A,2\n").unwrap();
        assert_eq!((table.names.len(), table.counts), (2, vec![vec![5, 1], vec![0, 4]]));
        assert!(parsed("a,b\n").unwrap_err().to_string().ends_with("expected the columns shown,answered,count"));
        let error = parsed("shown,answered,count\nA,B,-1\n").unwrap_err().to_string();
        assert_eq!(error, "a.csv, line 2, column count: \"-1\"; expected a whole number of 0 to 1000000");
        assert!(parsed("shown,answered,count\nA,B\n").unwrap_err().to_string().contains("three cells"));
        assert!(parsed("shown,answered,count\nA,A,1\n").unwrap_err().to_string().starts_with("a.csv: 1 materials"));
    }
}
