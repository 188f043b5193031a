//! A magnet beside a table: its flux density by finite elements, and what its parts would change.

use std::path::Path;

use super::readings::Unusable;
use crate::experiment::Run;
use crate::magnet::simulated::{Simulated, simulate};
use crate::magnet::uncertain::PARTS;
use crate::magnet::{located, names};

/// Currents that are solved at most; between them lines are straight.
const MOST: usize = 33;

/// A magnet's flux density over current, in the unit of the table.
#[derive(Debug)]
pub(super) struct Beside {
    currents: Vec<f64>,
    simulated: Simulated,
    unit: f64,
}

/// What the magnet has for one reading.
#[derive(Debug, Clone, Copy)]
pub(super) struct Says {
    /// Flux density.
    pub flux: f64,
    /// Its change for a plausible difference of each part; 0 for parts that the file does not tell.
    pub changes: [f64; PARTS.len()],
}

impl Beside {
    /// Of tables that name a magnet; `None` where none does.
    pub fn of(folder: &Path, runs: &[&Run]) -> Result<Option<Self>, Unusable> {
        let Some((name, unit)) = runs.iter().find_map(|run| run.magnet.clone()) else { return Ok(None) };
        if let Some(other) = runs.iter().find(|run| run.magnet.as_ref() != Some(&(name.clone(), unit))) {
            return Err(Unusable::OtherMagnet { file: other.file.clone(), magnet: name });
        }
        let wrong = |cause: String| Unusable::Magnet { magnet: name.clone(), cause };
        let (file, text) =
            located(&folder.join(&name), &name).map_err(|cause| wrong(cause.to_string()))?.ok_or_else(|| {
                let folder = folder.display();
                wrong(format!("no such file in {folder}, and no magnet of this name; known are {}", names()))
            })?;
        let mut currents: Vec<f64> = runs
            .iter()
            .flat_map(|run| run.recording.column(super::readings::COLUMNS.0).unwrap_or(&[]).iter().map(|x| x.abs()))
            .filter(|x| x.is_finite())
            .collect();
        currents.sort_by(f64::total_cmp);
        currents.dedup_by(|a, b| (*a - *b).abs() < 1e-9);
        if let (true, Some(first), Some(last)) = (currents.len() > MOST, currents.first(), currents.last()) {
            let step = (last - first) / (MOST - 1) as f64;
            currents = (0..MOST).map(|i| first + step * i as f64).collect();
        }
        let simulated = simulate(&file, &text, &currents).map_err(|cause| wrong(cause.to_string()))?;
        Ok(Some(Beside { currents, simulated, unit }))
    }

    /// True for parts that the magnet's file tells something of.
    pub fn tells(&self) -> [bool; PARTS.len()] {
        std::array::from_fn(|part| self.simulated.changes_t[part].is_some())
    }

    /// At a current.
    pub fn at(&self, ampere: f64) -> Says {
        let ampere = ampere.abs();
        let i = self.currents.partition_point(|own| *own <= ampere).clamp(1, self.currents.len().max(2) - 1);
        let of = |values: &[f64]| match (self.currents.get(i), values.get(i)) {
            (Some(end), Some(value)) => {
                let place = (ampere - self.currents[i - 1]) / (end - self.currents[i - 1]);
                self.unit * (values[i - 1] + place * (value - values[i - 1]))
            }
            _ => self.unit * values.first().copied().unwrap_or(0.0),
        };
        Says {
            flux: of(&self.simulated.flux_t),
            changes: std::array::from_fn(|part| self.simulated.changes_t[part].as_deref().map_or(0.0, of)),
        }
    }
}
