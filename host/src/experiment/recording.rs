//! The samples of a run.

use std::collections::BTreeMap;
use std::path::Path;

use super::error::{ExperimentError, Problem};
use super::file::{DISPLAY_PAIRS, FINGER, UNDER_FINGER};

/// The samples of a run. The vectors that a kind of test does not have are empty, all others
/// have the same length.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Recording {
    /// Time in s, not falling.
    pub time_s: Vec<f64>,
    /// Position of the indenter in mm, growing into the specimen; its zero is not trusted.
    pub depth_mm: Vec<f64>,
    /// Force into the specimen in N.
    pub force_n: Vec<f64>,
    /// All other columns that hold numbers, by name; NaN where a cell holds none.
    pub others: BTreeMap<String, Vec<f64>>,
    /// Line of the file (from 1) that each sample stands in; of a workbook the number of the row.
    pub line: Vec<usize>,
    pub(super) depth_field: Option<(usize, String)>,
}

impl Recording {
    /// A recording made in memory, for models and tests.
    ///
    /// Vectors of different lengths are cut to the shortest.
    pub fn from_samples(time_s: Vec<f64>, depth_mm: Vec<f64>, force_n: Vec<f64>) -> Self {
        let count = time_s.len().min(depth_mm.len()).min(force_n.len());
        let cut = |mut samples: Vec<f64>| {
            samples.truncate(count);
            samples
        };
        Self {
            time_s: cut(time_s),
            depth_mm: cut(depth_mm),
            force_n: cut(force_n),
            line: (2..count + 2).collect(),
            ..Self::default()
        }
    }

    /// The numbers of a column by its name in the contract.
    #[must_use]
    pub fn column(&self, name: &str) -> Option<&[f64]> {
        let found = match name {
            "time_s" => &self.time_s,
            "depth_mm" => &self.depth_mm,
            "force_N" => &self.force_n,
            other => self.others.get(other)?,
        };
        (!found.is_empty()).then_some(found.as_slice())
    }

    /// Number of samples.
    pub fn len(&self) -> usize {
        self.line.len()
    }

    /// No samples at all.
    pub fn is_empty(&self) -> bool {
        self.line.is_empty()
    }

    /// Keeps the samples from a time to another (s).
    pub(super) fn keep_between(&mut self, from_s: f64, to_s: f64) {
        let start = self.time_s.partition_point(|t| *t < from_s);
        let end = self.time_s.partition_point(|t| *t <= to_s).max(start);
        if !self.time_s.is_empty() {
            self.line = self.line[start..end].to_vec();
        }
        self.columns().for_each(|values| *values = values[start..end].to_vec());
    }

    /// A pull is recorded with either sign; afterwards elongation and pull count as positive, as depth and force elsewhere.
    pub(super) fn turn_to_push(&mut self) {
        let largest = self.force_n.iter().copied().fold(0.0, |a: f64, b| if b.abs() > a.abs() { b } else { a });
        if largest < 0.0 {
            self.turn();
        }
    }

    /// A display run without what it was told, or without what was measured, says nothing.
    pub(super) fn check_pairs(&self, file: &Path) -> Result<(), ExperimentError> {
        let has = |name: &str| self.column(name).is_some();
        let under_finger = || UNDER_FINGER.iter().any(|name| has(name));
        let complete =
            |(told, measured): &(&str, &str)| has(told) && has(measured) && (*told != FINGER || under_finger());
        if DISPLAY_PAIRS.iter().any(complete) {
            return Ok(());
        }
        let under = UNDER_FINGER.join(" or ");
        let pair = |(told, measured): &(&str, &str)| match *told {
            FINGER => format!("{told} and {measured} with {under}"),
            _ => format!("{told} with {measured}"),
        };
        let pairs: Vec<String> = DISPLAY_PAIRS.iter().map(pair).collect();
        let problem = format!("a display run needs at least one pair of columns: {}", pairs.join(", or "));
        Err(ExperimentError::of_file(file, Problem::Contradiction(problem)))
    }

    /// Depth above the specimen's height is a wrong unit, direction or zero.
    pub(super) fn check_depth(&self, file: &Path, height_mm: f64) -> Result<(), ExperimentError> {
        let Some(at) = self.depth_mm.iter().position(|&depth| depth > height_mm) else {
            return Ok(());
        };
        let problem = Problem::DeeperThanSpecimen { depth_mm: self.depth_mm[at], height_mm };
        let field = self.depth_field.as_ref().map(|(index, name)| (*index, name.as_str()));
        Err(ExperimentError::of_row(file, self.line[at], field, problem))
    }
}
