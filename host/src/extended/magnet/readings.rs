//! Readings of flux density over current beside a magnet's field.

use std::collections::BTreeMap;

use nalgebra::{DMatrix, DVector};

use crate::diagnose::table::readings::COLUMNS;
use crate::experiment::{Experiment, ExperimentError, Test};
use crate::magnet::simulated::{Unsimulated, flux_at};
use crate::magnet::{located, names, parse};

/// A model that cannot be compared with recordings.
#[derive(Debug, thiserror::Error)]
pub enum GainError {
    /// No table.
    #[error(
        "the experiment has no run with test = \"table\" and a magnet; expected readings of flux density over current"
    )]
    NoTable,
    /// A magnet that is not there.
    #[error("no file {0} in the experiment's folder, and no magnet of this name; known are {known}", known = names())]
    NoMagnet(String),
    /// A row without numbers.
    #[error("{file}: no numbers in the columns x and y; name them in [columns]")]
    NoNumbers {
        /// The file.
        file: String,
    },
    /// Its field.
    #[error(transparent)]
    Field(#[from] Unsimulated),
    /// Its file.
    #[error(transparent)]
    File(#[from] ExperimentError),
}

/// Readings of an experiment's tables: currents (A) with flux densities (T).
pub(super) struct Readings {
    points: Vec<(f64, f64)>,
    currents: Vec<f64>,
}

impl Readings {
    /// All of them together.
    pub fn of(experiment: &Experiment) -> Result<Self, GainError> {
        let mut points: Vec<(f64, f64)> = Vec::new();
        for run in experiment.runs.iter().filter(|run| run.test == Test::Table) {
            let Some((_, unit)) = &run.magnet else { continue };
            let none = || GainError::NoNumbers { file: run.file.clone() };
            let column = |name: &str| run.recording.column(name).ok_or_else(none);
            let pairs = column(COLUMNS.0)?.iter().zip(column(COLUMNS.1)?);
            points.extend(pairs.filter(|(x, y)| x.is_finite() && y.is_finite()).map(|(x, y)| (x.abs(), y / unit)));
        }
        if points.is_empty() {
            return Err(GainError::NoTable);
        }
        let mut currents: Vec<f64> = points.iter().map(|(x, _)| *x).collect();
        currents.sort_by(f64::total_cmp);
        currents.dedup();
        Ok(Self { points, currents })
    }

    /// Read less what the magnet has with these parameters, T.
    pub fn left(
        &self,
        experiment: &Experiment,
        name: &str,
        set: &BTreeMap<String, f64>,
    ) -> Result<Vec<f64>, GainError> {
        let found = located(&experiment.folder.join(name), name)?;
        let (file, text) = found.ok_or_else(|| GainError::NoMagnet(name.to_owned()))?;
        let flux = flux_at(&file, &parse(&file, &text, set)?, &self.currents)?;
        let at = |x: f64| flux[self.currents.partition_point(|own| *own < x).min(self.currents.len() - 1)];
        Ok(self.points.iter().map(|(x, y)| y - at(*x)).collect())
    }
}

/// The change that leaves the least squares, and the standard deviations of its parts, by what is left; `None` where the
/// readings do not tell all parts.
pub(super) fn least_squares(jacobian: &DMatrix<f64>, left: &DVector<f64>) -> Option<(DVector<f64>, Vec<f64>)> {
    let (readings, parts) = jacobian.shape();
    let covariance = (jacobian.transpose() * jacobian).try_inverse()?;
    let change = &covariance * jacobian.transpose() * left;
    let square = (left - jacobian * &change).norm_squared() / readings.saturating_sub(parts).max(1) as f64;
    let deviations = (0..parts).map(|k| (square * covariance[(k, k)]).sqrt()).collect();
    Some((change, deviations))
}
