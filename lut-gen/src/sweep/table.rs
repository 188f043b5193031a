//! The merged table of a sweep, and its bytes.
//!
//! ```text
//! "PALSWEP1", u32 length of text, text (JSON: specification, engine, failed points, error bound),
//! f64 forces [point][rate][sample] of the points that did not fail, in the order of their numbers,
//! SHA-256 of all before
//! ```
//! Numbers are little-endian; forces are in N.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::{Forces, SweepAxis, SweepSpec, journal};

/// First bytes of a sweep's table.
pub const TABLE_MAGIC: &[u8; 8] = b"PALSWEP1";

/// Bytes of the hash at the end.
const HASH: usize = 32;

/// Stated error of a sweep's table, in units of the peak of a curve; `None` where nothing was checked.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct SweepErrorBound {
    /// Largest difference to solves on a mesh refined by 1.5.
    pub discretisation: Option<f64>,
    /// Grid points that were solved again for it.
    pub finer: usize,
    /// Largest difference of the interpolated to the solved curve in the middle of cells.
    pub interpolation: Option<f64>,
    /// Middles of cells that were solved for it.
    pub between: usize,
}

/// The forces of a whole sweep.
#[derive(Debug, Clone, PartialEq)]
pub struct SweepTable {
    /// What it covers.
    pub spec: SweepSpec,
    /// What computed it.
    pub engine: String,
    /// Jobs that failed, checks among them, and why.
    pub failed: BTreeMap<usize, String>,
    /// How far the forces can be trusted. Quantisation adds nothing: they are stored as they were computed.
    pub error: SweepErrorBound,
    /// Forces of every grid point; `None` where it failed.
    pub points: Vec<Option<Forces>>,
}

/// Why there is no force, or no table.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TableError {
    /// A value outside an axis, or not one value an axis.
    #[error("{parameter} = {value} lies outside the table, which covers {low} to {high}")]
    Outside {
        /// Name of the axis.
        parameter: &'static str,
        /// The value.
        value: f64,
        /// Least value of the axis.
        low: f64,
        /// Largest value of the axis.
        high: f64,
    },
    /// Another number of values than axes.
    #[error("{found} values for a table of {axes} axes")]
    Axes {
        /// Values given.
        found: usize,
        /// Axes of the table.
        axes: usize,
    },
    /// A point that is needed has failed.
    #[error("the table has no curve at {label}: {error}")]
    Failed {
        /// Its parameters.
        label: String,
        /// Why it failed.
        error: String,
    },
    /// Not a table of a sweep.
    #[error("the file does not begin like the table of a sweep")]
    Foreign,
    /// The hash does not agree.
    #[error("the table is damaged: its SHA-256 is wrong ({0} bytes)")]
    Damaged(usize),
    /// The hash agrees, but the contents are not understood.
    #[error("the table is of another version: {0}")]
    Version(String),
}

#[derive(Serialize, Deserialize)]
struct Head {
    spec: SweepSpec,
    engine: String,
    failed: BTreeMap<usize, String>,
    error: SweepErrorBound,
}

impl SweepTable {
    /// The file; the same bytes for the same table.
    #[must_use]
    pub fn bytes(&self) -> Vec<u8> {
        let head = Head {
            spec: self.spec.clone(),
            engine: self.engine.clone(),
            failed: self.failed.clone(),
            error: self.error,
        };
        let text = serde_json::to_string(&head).unwrap_or_default();
        let mut bytes = TABLE_MAGIC.to_vec();
        bytes.extend((text.len() as u32).to_le_bytes());
        bytes.extend(text.as_bytes());
        bytes.extend(self.points.iter().flatten().flatten().flatten().flat_map(|f| f.to_le_bytes()));
        let hash = Sha256::digest(&bytes);
        bytes.extend(hash);
        bytes
    }

    /// Reads the file.
    ///
    /// # Errors
    /// [`TableError`]: foreign, damaged (any changed or missing byte), or of another version.
    pub fn parse(bytes: &[u8]) -> Result<Self, TableError> {
        if !bytes.starts_with(TABLE_MAGIC) {
            return Err(TableError::Foreign);
        }
        let damaged = || TableError::Damaged(bytes.len());
        let end = bytes.len().checked_sub(HASH).ok_or_else(damaged)?;
        if Sha256::digest(&bytes[..end])[..] != bytes[end..] {
            return Err(damaged());
        }
        let length = bytes.get(8..12).and_then(|b| b.try_into().ok()).map_or(0, u32::from_le_bytes) as usize;
        let text = bytes[..end].get(12..12 + length).ok_or_else(damaged)?;
        let version = |text: String| TableError::Version(text);
        let head: Head = serde_json::from_slice(text).map_err(|e| version(e.to_string()))?;
        head.spec.check().map_err(|e| version(e.to_string()))?;
        let grid = head.spec.grid();
        let (rates, samples) = (head.spec.motion.rates_mm_s.len(), head.spec.motion.samples());
        let size = 8 * rates * samples;
        let solved = grid - head.failed.range(..grid).count();
        let numbers = &bytes[12 + length..end];
        if numbers.len() != solved * size {
            return Err(version(format!("{} bytes of forces where {} are due", numbers.len(), solved * size)));
        }
        let mut parts = numbers.chunks_exact(size);
        let points = (0..grid)
            .map(|job| {
                let absent = head.failed.contains_key(&job);
                if absent { None } else { parts.next().map(|b| journal::forces(b, rates, samples)) }
            })
            .collect();
        Ok(Self { spec: head.spec, engine: head.engine, failed: head.failed, error: head.error, points })
    }

    /// The forces at values of all axes, in their order: products along factor axes, else linear
    /// between the points in the axes' coordinates. The logarithm of the force is interpolated
    /// where it has one at all corners, else the force.
    ///
    /// # Errors
    /// [`TableError`]: a value outside its axis, or a corner whose solve failed.
    pub fn forces_at(&self, values: &[f64]) -> Result<Forces, TableError> {
        let axes = &self.spec.axes;
        if values.len() != axes.len() {
            return Err(TableError::Axes { found: values.len(), axes: axes.len() });
        }
        let mut factor = 1.0;
        let mut place = Vec::new();
        for (axis, &value) in axes.iter().zip(values) {
            let outside = || TableError::Outside {
                parameter: axis.parameter.name(),
                value,
                low: axis.values.first().copied().unwrap_or(f64::NAN),
                high: axis.values.last().copied().unwrap_or(f64::NAN),
            };
            let located = axis.locate(value).ok_or_else(outside)?;
            if axis.factor {
                factor *= value;
            } else {
                place.push(located);
            }
        }
        let mut forces = self.interpolate(&place)?;
        forces.iter_mut().flatten().for_each(|f| *f *= factor);
        Ok(forces)
    }

    /// What the table says of the middle of a cell, where a check was solved.
    pub(super) fn between(&self, job: usize) -> Option<Forces> {
        let point = self.spec.point(job)?;
        let place: Option<Vec<_>> = self.solved_axes().map(|axis| axis.locate(point.get(axis.parameter)?)).collect();
        self.interpolate(&place?).ok()
    }

    fn solved_axes(&self) -> impl Iterator<Item = &SweepAxis> {
        self.spec.axes.iter().filter(|a| !a.factor)
    }

    /// Between the corners of a cell, by index and share along every solved axis.
    fn interpolate(&self, place: &[(usize, f64)]) -> Result<Forces, TableError> {
        let mut corners = vec![(0_usize, 1.0_f64)];
        for (axis, &(below, share)) in self.solved_axes().zip(place) {
            let n = axis.solved();
            let step = |&(at, weight): &(usize, f64)| {
                let upper = (share > 0.0).then_some((at * n + below + 1, weight * share));
                [Some((at * n + below, weight * (1.0 - share))), upper].into_iter().flatten()
            };
            corners = corners.iter().flat_map(step).collect();
        }
        let mut curves = Vec::with_capacity(corners.len());
        for (job, weight) in corners {
            let Some(Some(forces)) = self.points.get(job) else {
                let error = self.failed.get(&job).cloned().unwrap_or_default();
                return Err(TableError::Failed { label: self.spec.label(job), error });
            };
            curves.push((forces, weight));
        }
        let (rates, samples) = (self.spec.motion.rates_mm_s.len(), self.spec.motion.samples());
        let mean = |rate: usize, sample: usize| {
            let at = |forces: &Forces| forces[rate][sample];
            if let [(only, _)] = curves[..] {
                at(only)
            } else if curves.iter().all(|(f, _)| at(f) > 0.0) {
                curves.iter().map(|(f, w)| w * at(f).ln()).sum::<f64>().exp()
            } else {
                curves.iter().map(|(f, w)| w * at(f)).sum()
            }
        };
        Ok((0..rates).map(|r| (0..samples).map(|s| mean(r, s)).collect()).collect())
    }
}
