//! Heights of an encoder beside those of the frames (Fig. 63).

use std::path::{Path, PathBuf};

use miette::{IntoDiagnostic, WrapErr, miette};

use crate::track::{Measure, Position};

/// What an encoder read.
#[derive(Debug)]
pub(super) struct Encoder {
    file: PathBuf,
    /// Time (s, rising) and height (mm, up), shifted by the median difference once compared.
    pub rows: Vec<[f64; 2]>,
    /// Root of the mean squared difference after that shift, mm; none where no time is common.
    pub apart_mm: Option<f64>,
    /// Frames that were compared.
    pub compared: usize,
}

impl Encoder {
    /// Reads a file of two columns, with a head or without.
    pub fn read(file: &Path) -> miette::Result<Self> {
        let named = || format!("--encoder: {}", file.display());
        let mut reader = csv::ReaderBuilder::new();
        let mut reader =
            reader.has_headers(false).flexible(true).from_path(file).into_diagnostic().wrap_err_with(named)?;
        let mut rows: Vec<[f64; 2]> = Vec::new();
        for (at, record) in reader.records().enumerate() {
            let record = record.into_diagnostic().wrap_err_with(named)?;
            let number = |column: usize| {
                let value = record.get(column).and_then(|text| text.trim().parse::<f64>().ok());
                value.filter(|value| value.is_finite())
            };
            match (number(0), number(1)) {
                (Some(time), Some(height)) => rows.push([time, height]),
                _ if at == 0 => {}
                _ => {
                    let line = record.position().map_or(at as u64 + 1, csv::Position::line);
                    return Err(miette!("{}, line {line}: expected time (s) and height (mm)", named()));
                }
            }
        }
        if rows.len() < 2 || rows.windows(2).any(|pair| pair[1][0] <= pair[0][0]) {
            return Err(miette!("{}: expected at least two rows with rising times", named()));
        }
        Ok(Self { file: file.to_owned(), rows, apart_mm: None, compared: 0 })
    }

    /// Its name.
    pub fn name(&self) -> String {
        self.file.display().to_string()
    }

    fn at(&self, time: f64) -> Option<f64> {
        let after = self.rows.partition_point(|row| row[0] < time);
        let (b, a) = (self.rows.get(after)?, self.rows.get(after.checked_sub(1)?)?);
        Some(a[1] + (b[1] - a[1]) * (time - a[0]) / (b[0] - a[0]))
    }

    /// Takes its zero from the frames, and tells how far the two are apart.
    pub fn compare(&mut self, positions: &[Position], measure: &Measure) {
        let Some(first) = positions.first().and_then(|position| position.tip) else { return };
        let pairs = positions.iter().filter_map(|position| {
            let (time, tip) = (position.time_s?, position.tip?);
            Some(measure.height(&first, &tip) - self.at(time)?)
        });
        let mut apart: Vec<f64> = pairs.collect();
        apart.sort_by(f64::total_cmp);
        let (Some(low), Some(high)) = (apart.get(apart.len().saturating_sub(1) / 2), apart.get(apart.len() / 2)) else {
            return;
        };
        // The median: a place that is wrong, or an encoder that slips for a while, leaves the zero where it is.
        let zero = 0.5 * (low + high);
        self.rows.iter_mut().for_each(|row| row[1] += zero);
        let squares = apart.iter().map(|d| (d - zero).powi(2)).sum::<f64>();
        self.apart_mm = Some((squares / apart.len() as f64).sqrt());
        self.compared = apart.len();
    }
}
