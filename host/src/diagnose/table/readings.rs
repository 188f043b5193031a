//! The readings of a table: what stands beside what, in which order and from which side.

use super::magnet::Beside;
use crate::experiment::{Experiment, Run, Test};
use crate::magnet::uncertain::PARTS;

/// Columns of a table, by their names in the contract: what was set, what was read, and what a simulation
/// has for it where there is one.
pub const COLUMNS: (&str, &str, &str) = ("x", "y", "simulated");
/// Part of the range of x within which two readings are of one x.
const SAME: f64 = 2e-3;

/// One row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reading {
    /// What was set.
    pub x: f64,
    /// What was read.
    pub y: f64,
    /// What a simulation has for it.
    pub simulated: Option<f64>,
    /// What a plausible difference of each part of a magnet adds, in spans; 0 beside none.
    pub built: [f64; PARTS.len()],
    /// Place of the line, or of the simulated value, in its range: 0 to 1.
    pub level: f64,
    /// 1 where x came from below, -1 from above, 0 for the first of a file.
    pub way: f64,
    /// Place in the order of all readings, 0 to 1.
    pub order: f64,
    /// Time since x was set, s; 0 where no time is recorded.
    pub rest_s: f64,
    /// Number of its x, from the smallest.
    pub place: usize,
    /// Number of its file.
    pub file: usize,
}

/// All readings of one table.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// Files, in the order of the description.
    pub files: Vec<String>,
    /// Readings, file by file.
    pub readings: Vec<Reading>,
    /// Different x, the smallest first.
    pub places: Vec<f64>,
    /// Largest less smallest y.
    pub span: f64,
    /// Largest less smallest x.
    pub range: f64,
    /// A simulated value stands beside every reading.
    pub is_simulated: bool,
    /// Parts of a magnet of which its file tells what they may differ by.
    pub parts: [bool; PARTS.len()],
    /// Time is recorded.
    pub has_time: bool,
}

/// Why a table cannot be used.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Unusable {
    /// A column is missing.
    #[error("{file}: no column {column}; name it in [columns], such as {column} = \"{example}\" (found {found})")]
    Missing {
        /// The file.
        file: String,
        /// The column.
        column: &'static str,
        /// A name for it.
        example: &'static str,
        /// Columns that are there.
        found: String,
    },
    /// A cell is no number.
    #[error("{file}, line {line}: column {column} holds no number")]
    NoNumber {
        /// The file.
        file: String,
        /// The line, from 1.
        line: usize,
        /// The column.
        column: &'static str,
    },
    /// Nothing varies.
    #[error("{column} is {value} in all rows; a table needs different ones")]
    Still {
        /// The column.
        column: &'static str,
        /// Its value.
        value: f64,
    },
    /// A magnet that cannot stand beside the table.
    #[error("magnet \"{magnet}\": {cause}")]
    Magnet {
        /// Its name.
        magnet: String,
        /// Why.
        cause: String,
    },
    /// Files of one table beside different magnets.
    #[error("{file} has not the magnet \"{magnet}\" of the others; name one magnet, and one flux_unit, for all files")]
    OtherMagnet {
        /// A file without it.
        file: String,
        /// The magnet of the others.
        magnet: String,
    },
    /// A magnet and a simulated column.
    #[error("{file} has a column simulated and a magnet; expected one of the two")]
    Twice {
        /// The file.
        file: String,
    },
    /// Some files have a simulated column and some have none.
    #[error("{file} has no column simulated while others have one; simulate all rows or none")]
    Mixed {
        /// A file without it.
        file: String,
    },
}

impl Table {
    /// Of the runs of an experiment that are tables; they are passes of one. None where there is none.
    ///
    /// # Errors
    /// See [`Unusable`].
    pub fn of(experiment: &Experiment) -> Result<Option<Self>, Unusable> {
        let runs: Vec<&Run> = experiment.runs.iter().filter(|run| run.test == Test::Table).collect();
        if runs.is_empty() {
            return Ok(None);
        }
        let has = |run: &&&Run| run.recording.column(COLUMNS.2).is_some();
        let is_simulated = runs.iter().any(|run| has(&run));
        if let Some(bare) = runs.iter().find(|run| is_simulated && !has(run)) {
            return Err(Unusable::Mixed { file: bare.file.clone() });
        }
        let beside = Beside::of(&experiment.folder, &runs)?;
        if let (true, Some(_), [first, ..]) = (is_simulated, &beside, runs.as_slice()) {
            return Err(Unusable::Twice { file: first.file.clone() });
        }
        let has_time = runs.iter().all(|run| time_of(run).is_some());
        let mut readings = Vec::new();
        for (file, run) in runs.iter().enumerate() {
            readings.extend(of_run(run, file, is_simulated)?);
        }
        let files = runs.iter().map(|run| run.file.clone()).collect();
        if let Some(beside) = &beside {
            for r in &mut readings {
                let says = beside.at(r.x);
                (r.simulated, r.built) = (Some(says.flux), says.changes);
            }
        }
        let parts = beside.as_ref().map_or([false; PARTS.len()], Beside::tells);
        told(files, readings, (is_simulated || beside.is_some(), has_time), parts).map(Some)
    }

    /// Rows as points.
    #[must_use]
    pub fn points(&self) -> Vec<(f64, f64)> {
        self.readings.iter().map(|r| (self.places[r.place], r.y)).collect()
    }

    /// True where some x was reached from both sides.
    #[must_use]
    pub fn has_both_ways(&self) -> bool {
        let is = |way: f64| self.readings.iter().any(|r| r.way == way);
        is(1.0) && is(-1.0)
    }

    /// Readings of one x from one side, which repeat each other.
    #[must_use]
    pub fn repeats(&self) -> Vec<Vec<usize>> {
        let mut groups: Vec<Vec<usize>> = Vec::new();
        for (at, r) in self.readings.iter().enumerate() {
            let is_same = |other: &usize| {
                let o = self.readings[*other];
                // the first of a file came from rest, as what rises does
                o.place == r.place && (o.way < 0.0) == (r.way < 0.0)
            };
            match groups.iter_mut().find(|group| group.first().is_some_and(is_same)) {
                Some(group) => group.push(at),
                None => groups.push(vec![at]),
            }
        }
        groups
    }
}

/// Time of every row, where each has one.
fn time_of(run: &Run) -> Option<&[f64]> {
    run.recording.column("time_s").filter(|t| t.iter().all(|v| v.is_finite()))
}

/// Rows of one file.
fn of_run(run: &Run, file: usize, is_simulated: bool) -> Result<Vec<Reading>, Unusable> {
    let column = |name: &'static str, example: &'static str| {
        let found = || run.recording.others.keys().cloned().collect::<Vec<_>>().join(", ");
        let missing = || Unusable::Missing { file: run.file.clone(), column: name, example, found: found() };
        let values = run.recording.column(name).ok_or_else(missing)?;
        match values.iter().position(|v| !v.is_finite()) {
            Some(at) => Err(Unusable::NoNumber {
                file: run.file.clone(),
                line: run.recording.line.get(at).copied().unwrap_or(0),
                column: name,
            }),
            None => Ok(values),
        }
    };
    let (x, y) = (column(COLUMNS.0, "current_A")?, column(COLUMNS.1, "flux_T")?);
    let simulated = if is_simulated { Some(column(COLUMNS.2, "flux_simulated_T")?) } else { None };
    let time_s = time_of(run);
    let mut set_s = time_s.and_then(|t| t.first().copied()).unwrap_or(0.0);
    let mut way = 0.0;
    let rows = (0..x.len()).map(|k| {
        if k > 0 && x[k] != x[k - 1] {
            way = (x[k] - x[k - 1]).signum();
            set_s = time_s.map_or(0.0, |t| t[k]);
        }
        let rest_s = time_s.map_or(0.0, |t| (t[k] - set_s).max(0.0));
        let simulated = simulated.map(|s| s[k]);
        let built = [0.0; PARTS.len()];
        Reading { x: x[k], y: y[k], simulated, built, level: 0.0, way, order: 0.0, rest_s, place: 0, file }
    });
    Ok(rows.collect())
}

/// The table of some rows: places, levels and order.
fn told(
    files: Vec<String>,
    mut readings: Vec<Reading>,
    (is_simulated, has_time): (bool, bool),
    parts: [bool; PARTS.len()],
) -> Result<Table, Unusable> {
    let (low, high) = ends(readings.iter().map(|r| r.x));
    if high <= low {
        return Err(Unusable::Still { column: COLUMNS.0, value: low });
    }
    let (y_low, y_high) = ends(readings.iter().map(|r| r.y));
    if y_high <= y_low {
        return Err(Unusable::Still { column: COLUMNS.1, value: y_low });
    }
    let told = |r: &Reading| r.simulated.unwrap_or(r.x);
    let (from, to) = ends(readings.iter().map(told));
    if to <= from {
        return Err(Unusable::Still { column: COLUMNS.2, value: from });
    }
    let mut all: Vec<f64> = readings.iter().map(|r| r.x).collect();
    all.sort_by(f64::total_cmp);
    let mut places: Vec<f64> = Vec::new();
    for x in all {
        if places.last().is_none_or(|last| x - last > SAME * (high - low)) {
            places.push(x);
        }
    }
    let last = readings.len().saturating_sub(1).max(1) as f64;
    let span = y_high - y_low;
    for (at, r) in readings.iter_mut().enumerate() {
        r.built = r.built.map(|change| change / span);
        r.level = (told(r) - from) / (to - from);
        r.order = at as f64 / last;
        r.place = places.partition_point(|place| *place <= r.x).saturating_sub(1);
    }
    Ok(Table { files, readings, places, span, range: high - low, is_simulated, parts, has_time })
}

fn ends(values: impl Iterator<Item = f64>) -> (f64, f64) {
    values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)))
}
