//! From forces to numbers that are independent with unit variance when the model is right.

use nalgebra::{DMatrix, DVector};

use super::design::{Design, Series};
use super::noise::{Curve, Noise, SensorNoise};
use super::spike::Spike;
use crate::infer::product::{inner, turn_rows};

/// A linear map of residuals (N, all runs one after the other) that makes their noise white.
#[derive(Debug, Clone)]
pub struct Whitening {
    /// Inverse of the lower factor of every run's covariance.
    runs: Vec<DMatrix<f64>>,
    spots: Vec<Spot>,
    /// What the simulation's own error may be, after the rest of the whitening, and its kernel.
    shared: (DMatrix<f64>, DMatrix<f64>),
    /// First entry of every run in the vector of all.
    first: Vec<usize>,
    len: usize,
}

/// Inverse of the lower factor of a covariance.
fn white(lower: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    lower.solve_lower_triangular(&DMatrix::identity(lower.nrows(), lower.nrows()))
}

/// Runs on one spot and what they share.
#[derive(Debug, Clone)]
struct Spot {
    /// Entries of its runs.
    entries: Vec<usize>,
    /// Jitter's columns after the runs' own whitening: contact, gain, then a zero for each run.
    jitter: DMatrix<f64>,
    /// `K` of `(I + Z Z')^(-1/2) = I - Z K Z'`.
    kernel: DMatrix<f64>,
    /// True where the columns are jitter between spots, whose size was estimated.
    estimated: bool,
}

/// Standard deviation of the simulated force's error, relative, along each of three smooth shapes over depth: the
/// standard mesh is within 0.14 % of finer ones (docs/verification.md), and neighbouring meshes scatter by as much.
pub(crate) const SIMULATED: f64 = 0.001;

/// `K` of `(I + Z Z')^(-1/2) = I - Z K Z'`.
pub(super) fn kernel(z: &DMatrix<f64>) -> DMatrix<f64> {
    if z.ncols() == 0 {
        return DMatrix::zeros(0, 0);
    }
    let eigen = inner(z, z).symmetric_eigen();
    // (1 - 1/sqrt(1 + x)) / x, its limit 1/2 for x -> 0
    let part = |x: f64| if x < 1e-9 { 0.5 } else { (1.0 - 1.0 / (1.0 + x).sqrt()) / x };
    let scaled = &eigen.eigenvectors * DMatrix::from_diagonal(&eigen.eigenvalues.map(part));
    scaled * eigen.eigenvectors.transpose()
}

/// What a zero wanders by in an hour, as a part of the largest force: a random walk over the session. Load cells are specified at a few
/// hundredths of a percent of full scale an hour or per kelvin, and a palpation uses a tenth of full scale: a drift has to
/// stand out of half a percent.
const WANDER: f64 = 0.005;
/// What the zero of the whole session may be off by, as a part of the largest force: it was tared once, with the noise of that moment.
const TARE: f64 = 0.005;
/// Karhunen-Loeve modes of the walk that are kept: they hold 96 % of its variance.
const MODES: usize = 5;

impl Whitening {
    /// For a noise, at the forces of a fit of the base; `None` when a covariance is not positive definite.
    #[must_use]
    pub fn new(design: &Design, curves: &[Curve], noise: &Noise) -> Option<Self> {
        Self::but_for(&[], design, curves, noise)
    }

    /// The same but for spikes, whose own noise is as large as they are: the rest of their run is as it was, and they say next to nothing.
    #[must_use]
    pub(super) fn but_for(spikes: &[Spike], design: &Design, curves: &[Curve], noise: &Noise) -> Option<Self> {
        let mut first = Vec::new();
        let mut len = 0;
        let mut runs = Vec::new();
        for (at, (series, curve)) in design.series.iter().zip(curves).enumerate() {
            first.push(len);
            len += series.nodes.len();
            let nodes = series.nodes.len();
            let mut white =
                noise.sensor.factor(&series.nodes, &curve.force_n)?.whitened(DMatrix::identity(nodes, nodes));
            for spike in spikes.iter().filter(|spike| spike.series == at) {
                white.row_mut(spike.node).unscale_mut(spike.size);
            }
            runs.push(white);
        }
        for check in &design.checks {
            first.push(len);
            len += check.rows();
            runs.push(white(&check.factor(noise)?)?);
        }
        let shared = (DMatrix::zeros(len, 0), DMatrix::zeros(0, 0));
        let mut out = Self { runs, spots: Vec::new(), shared, first, len };
        for spot in 0..design.spots {
            let members: Vec<usize> = (0..design.series.len()).filter(|s| design.series[*s].spot == spot).collect();
            let entries: Vec<usize> =
                members.iter().flat_map(|s| out.first[*s]..out.first[*s] + design.series[*s].nodes.len()).collect();
            let mut jitter = DMatrix::zeros(entries.len(), 2 + members.len());
            let mut row = 0;
            for (at, &s) in members.iter().enumerate() {
                let curve = &curves[s];
                for (k, node) in design.series[s].nodes.iter().enumerate() {
                    // what is not compared says nothing of the spot
                    if !node.lifted {
                        jitter[(row, 0)] = -noise.jitter.contact_mm * curve.slope_n_per_mm[k];
                        jitter[(row, 1)] = noise.jitter.gain * curve.force_n[k];
                        jitter[(row, 2 + at)] = noise.jitter.zero_n;
                    }
                    row += 1;
                }
                let rows = row - curve.force_n.len();
                let own = jitter.rows(rows, curve.force_n.len()).into_owned();
                let white = &out.runs[s] * own;
                jitter.rows_mut(rows, curve.force_n.len()).copy_from(&white);
            }
            let kernel = kernel(&jitter);
            out.spots.push(Spot { entries, jitter, kernel, estimated: true });
        }
        for (at, check) in design.checks.iter().enumerate() {
            let run = design.series.len() + at;
            let entries: Vec<usize> = (out.first[run]..out.first[run] + check.rows()).collect();
            let jitter = &out.runs[run] * check.freedom(noise);
            let kernel = kernel(&jitter);
            out.spots.push(Spot { entries, jitter, kernel, estimated: false });
        }
        out.share(design, curves);
        Some(out)
    }

    /// Adds what all runs share: the error of the simulation, smooth over depth for every geometry by itself, the tare, and the wandering zero.
    fn share(&mut self, design: &Design, curves: &[Curve]) {
        let smooth = 3 * design.geometries.len();
        let mut columns = DMatrix::zeros(self.len, smooth + 1 + MODES);
        let peaks = curves.iter().flat_map(|c| c.force_n.iter().copied());
        let peak_n = peaks.chain(design.checks.iter().map(|check| check.scale_n)).fold(0.0, f64::max);
        columns.column_mut(smooth).fill(TARE * peak_n);
        for (at, check) in design.checks.iter().enumerate() {
            let first = self.first[design.series.len() + at];
            (check.readings()..check.rows()).for_each(|row| columns[(first + row, smooth)] = 0.0);
        }
        self.wander(design, peak_n, &mut columns.columns_mut(smooth + 1, MODES));
        for (s, (series, curve)) in design.series.iter().zip(curves).enumerate() {
            let depth_mm = design.geometries[series.geometry].depth_mm;
            for (k, (node, force_n)) in series.nodes.iter().zip(&curve.force_n).enumerate() {
                let x = 2.0 * (node.depth_mm / depth_mm).clamp(0.0, 1.0).sqrt() - 1.0;
                for (j, shape) in [1.0, x, 1.5 * x * x - 0.5].into_iter().enumerate() {
                    columns[(self.first[s] + k, 3 * series.geometry + j)] = SIMULATED * force_n * shape;
                }
                if node.lifted {
                    columns.row_mut(self.first[s] + k).fill(0.0);
                }
            }
        }
        self.apply_to(&mut columns);
        let kernel = kernel(&columns);
        self.shared = (columns, kernel);
    }

    /// Brownian motion of the zero over the session clock, mode by mode; nothing where no clock is known.
    fn wander(&self, design: &Design, peak_n: f64, columns: &mut nalgebra::DMatrixViewMut<'_, f64>) {
        let runs = design.series.iter().map(|s| (s.start_s, s.nodes.len()));
        let checks = design.checks.iter().map(|check| (check.start_s, check.readings()));
        let (starts, lengths): (Vec<Option<f64>>, Vec<usize>) = runs.chain(checks).unzip();
        let Some(starts) = starts.into_iter().collect::<Option<Vec<f64>>>() else { return };
        let first = starts.iter().copied().fold(f64::INFINITY, f64::min);
        let length_s = starts.iter().copied().fold(first, f64::max) - first;
        if length_s <= 0.0 {
            return;
        }
        let size_n = WANDER * peak_n * (length_s / 3600.0).sqrt();
        for (s, length) in lengths.into_iter().enumerate() {
            for mode in 0..MODES {
                let wave = (mode as f64 + 0.5) * std::f64::consts::PI;
                let value = size_n * 2.0_f64.sqrt() * (wave * (starts[s] - first) / length_s).sin() / wave;
                columns.view_mut((self.first[s], mode), (length, 1)).fill(value);
            }
        }
    }

    /// Number of residuals.
    #[must_use]
    pub fn residuals(&self) -> usize {
        self.len
    }

    /// First entry of a run; runs without the specimen come after the others.
    #[must_use]
    pub fn first(&self, run: usize) -> usize {
        self.first[run]
    }

    /// Whitens residuals in place.
    pub fn apply(&self, values: &mut DVector<f64>) {
        let mut column = DMatrix::from_vec(values.len(), 1, std::mem::take(values).data.into());
        self.apply_to(&mut column);
        *values = DVector::from_vec(column.data.into());
    }

    /// Whitens residuals in place, a column each.
    pub fn apply_to(&self, columns: &mut DMatrix<f64>) {
        self.apply_runs(columns);
        self.apply_spots(columns);
        self.apply_shared(columns);
    }

    fn apply_runs(&self, columns: &mut DMatrix<f64>) {
        for (white, first) in self.runs.iter().zip(&self.first) {
            turn_rows(white, columns, *first);
        }
    }

    fn apply_shared(&self, values: &mut DMatrix<f64>) {
        let (columns, kernel) = &self.shared;
        if columns.ncols() > 0 {
            *values -= columns * (kernel * inner(columns, values));
        }
    }

    fn apply_spots(&self, values: &mut DMatrix<f64>) {
        for spot in &self.spots {
            let own = values.select_rows(&spot.entries);
            let change = &spot.jitter * (&spot.kernel * inner(&spot.jitter, &own));
            for (k, &entry) in spot.entries.iter().enumerate() {
                values.row_mut(entry).zip_apply(&change.row(k), |value, change| *value -= change);
            }
        }
    }

    /// What makes of independent unit normal numbers what this whitening makes of another noise of the sensor, run by run; `None` when a covariance is not positive definite.
    #[must_use]
    pub fn colours(&self, design: &Design, curves: &[Curve], sensor: &SensorNoise) -> Option<Vec<DMatrix<f64>>> {
        let of = |((series, curve), white): ((&Series, &Curve), &DMatrix<f64>)| {
            let its = sensor.factor(&series.nodes, &curve.force_n)?;
            Some(white * its.lower())
        };
        design.series.iter().zip(curves).zip(&self.runs).map(of).collect()
    }

    /// A draw of what whitened residuals would be if sensor noise were `sensor` times that of some [`Whitening::colours`] and jitter of contact, gain and zero
    /// were `jitter` times what was estimated; `normal` gives independent unit normal numbers.
    pub fn draw(
        &self,
        colours: &[DMatrix<f64>],
        sensor: f64,
        jitter: [f64; 3],
        mut normal: impl FnMut() -> f64,
    ) -> DVector<f64> {
        let mut values = DMatrix::from_fn(self.len, 1, |_, _| sensor * normal());
        for (colour, first) in colours.iter().zip(&self.first) {
            turn_rows(colour, &mut values, *first);
        }
        for spot in &self.spots {
            let size = |k: usize| if spot.estimated { jitter[k.min(2)] } else { 1.0 };
            let amounts = DVector::from_fn(spot.jitter.ncols(), |k, _| size(k) * normal());
            let shift = &spot.jitter * amounts;
            for (k, &entry) in spot.entries.iter().enumerate() {
                values[entry] += shift[k];
            }
        }
        self.apply_spots(&mut values);
        let (columns, _) = &self.shared;
        values += columns * DMatrix::from_fn(columns.ncols(), 1, |_, _| normal());
        self.apply_shared(&mut values);
        DVector::from_vec(values.data.into())
    }

    /// Contact point (mm) of every spot that residuals speak for, given the jitter: the mean of its distribution.
    #[must_use]
    pub fn contacts_mm(&self, residuals: &DVector<f64>, contact_sigma_mm: f64) -> Vec<f64> {
        let mut half = DMatrix::from_column_slice(self.len, 1, residuals.as_slice());
        self.apply_runs(&mut half);
        self.spots
            .iter()
            .map(|spot| {
                let own = DVector::from_fn(spot.entries.len(), |k, _| half[spot.entries[k]]);
                let mut normal = inner(&spot.jitter, &spot.jitter);
                for k in 0..normal.nrows() {
                    normal[(k, k)] += 1.0;
                }
                let right = spot.jitter.tr_mul(&own);
                normal.cholesky().map_or(0.0, |c| contact_sigma_mm * c.solve(&right)[0])
            })
            .collect()
    }
}
