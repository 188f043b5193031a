//! From forces to numbers that are independent with unit variance when the model is right.

use std::sync::Arc;

use nalgebra::{DMatrix, DVector};

use super::design::{Design, Series};
use super::noise::{Curve, Noise, SensorNoise};
use super::spike::Spike;
use crate::infer::lowrank::Fold;
use crate::infer::product::turn_rows;

/// A linear map of residuals (N, all runs one after the other) that makes their noise white.
#[derive(Debug, Clone)]
pub struct Whitening {
    /// Inverse of the lower factor of every run's covariance.
    runs: Arc<Vec<DMatrix<f64>>>,
    spots: Arc<Vec<Spot>>,
    /// What all runs share, after the runs' own whitening.
    common: Arc<DMatrix<f64>>,
    /// The same after the rest of the whitening.
    shared: Arc<Fold>,
    /// First entry of every run in the vector of all.
    first: Arc<Vec<usize>>,
    len: usize,
    /// That of all rows, where some are left out.
    whole: Option<Arc<Whitening>>,
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
    /// Jitter after the runs' own whitening: contact, gain, then a zero for each run.
    jitter: Fold,
    /// True where the columns are jitter between spots, whose size was estimated.
    estimated: bool,
}

/// Standard deviation of the simulated force's error, relative, along each of three smooth shapes over depth: the
/// standard mesh is within 0.14 % of finer ones (docs/verification.md), and neighbouring meshes scatter by as much.
pub(crate) const SIMULATED: f64 = 0.001;

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
            runs.push(white(&check.factor(&noise.sensor)?)?);
        }
        let mut spots = Vec::new();
        for spot in 0..design.spots {
            let members: Vec<usize> = (0..design.series.len()).filter(|s| design.series[*s].spot == spot).collect();
            let entries: Vec<usize> =
                members.iter().flat_map(|s| first[*s]..first[*s] + design.series[*s].nodes.len()).collect();
            let mut jitter = DMatrix::zeros(entries.len(), 2 + members.len());
            let mut row = 0;
            for (at, &s) in members.iter().enumerate() {
                let curve = &curves[s];
                let smooth_n = design.smooth_n(s, &curve.force_n);
                for (k, node) in design.series[s].nodes.iter().enumerate() {
                    // what is not compared says nothing of the spot
                    if !node.lifted {
                        jitter[(row, 0)] = -noise.jitter.contact_mm * curve.slope_n_per_mm[k];
                        jitter[(row, 1)] = noise.jitter.gain * smooth_n[k];
                        jitter[(row, 2 + at)] = noise.jitter.zero_n;
                    }
                    row += 1;
                }
                let rows = row - curve.force_n.len();
                let own = jitter.rows(rows, curve.force_n.len()).into_owned();
                let white = &runs[s] * own;
                jitter.rows_mut(rows, curve.force_n.len()).copy_from(&white);
            }
            spots.push(Spot { entries, jitter: Fold::of(jitter), estimated: true });
        }
        for (at, check) in design.checks.iter().enumerate() {
            let run = design.series.len() + at;
            let entries: Vec<usize> = (first[run]..first[run] + check.rows()).collect();
            let jitter = &runs[run] * check.freedom(&noise.jitter);
            spots.push(Spot { entries, jitter: Fold::of(jitter), estimated: false });
        }
        let mut common = common(design, curves, &first, len);
        turn_runs(&runs, &first, &mut common);
        Some(Self::of(runs, spots, common, Arc::new(first)))
    }

    /// From runs and errors that runs have whitened.
    fn of(runs: Vec<DMatrix<f64>>, spots: Vec<Spot>, common: DMatrix<f64>, first: Arc<Vec<usize>>) -> Self {
        let mut shared = common.clone();
        fold_spots(&spots, &mut shared);
        Self {
            runs: Arc::new(runs),
            spots: Arc::new(spots),
            len: common.nrows(),
            common: Arc::new(common),
            shared: Arc::new(Fold::of(shared)),
            first,
            whole: None,
        }
    }

    /// The same where some rows count only. The others are removed: the noise of those that are used is theirs alone, and rows that are not become 0 whatever they are.
    /// `None` when what is left of a run's covariance is not positive definite.
    ///
    /// # Panics
    /// When there are fewer flags than residuals.
    #[must_use]
    pub fn for_rows(&self, used: &[bool]) -> Option<Self> {
        let whole = self.whole.clone().unwrap_or_else(|| Arc::new(self.clone()));
        let mut runs = Vec::new();
        // what turns errors that a run has whitened into those that its used rows whiten
        let mut turns = Vec::new();
        for (run, first) in whole.runs.iter().zip(whole.first.iter()) {
            let own = Kept::of(run, &used[*first..first + run.nrows()])?;
            runs.push(own.white);
            turns.push(own.turn);
        }
        let mut common = whole.common.as_ref().clone();
        turn_runs(&turns, &whole.first, &mut common);
        let spots = whole.spots.iter().map(|spot| {
            let mut columns = DMatrix::zeros(whole.len, spot.jitter.len());
            for (k, entry) in spot.entries.iter().enumerate() {
                columns.row_mut(*entry).copy_from(&spot.jitter.columns().row(k));
            }
            turn_runs(&turns, &whole.first, &mut columns);
            Spot { jitter: Fold::of(columns.select_rows(&spot.entries)), ..spot.clone() }
        });
        let masked = Self::of(runs, spots.collect(), common, whole.first.clone());
        Some(Self { whole: Some(whole), ..masked })
    }

    /// Logarithm of the determinant of the covariance of the rows that count.
    #[must_use]
    pub fn log_determinant(&self) -> f64 {
        let sensor = self.runs.iter().flat_map(|run| (0..run.nrows()).map(|k| run[(k, k)]));
        let sensor: f64 = sensor.filter(|d| *d > 0.0).map(|d| -2.0 * d.ln()).sum();
        sensor + self.spots.iter().map(|spot| spot.jitter.price()).sum::<f64>() + self.shared.price()
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
        turn_runs(&self.runs, &self.first, columns);
    }

    fn apply_spots(&self, columns: &mut DMatrix<f64>) {
        fold_spots(&self.spots, columns);
    }

    fn apply_shared(&self, columns: &mut DMatrix<f64>) {
        *columns = self.shared.all_taken_off(std::mem::replace(columns, DMatrix::zeros(0, 0)));
    }

    /// What makes of independent unit normal numbers what this whitening makes of another noise of the sensor, run by run; `None` when a covariance is not positive definite.
    #[must_use]
    pub fn colours(&self, design: &Design, curves: &[Curve], sensor: &SensorNoise) -> Option<Vec<DMatrix<f64>>> {
        let of = |((series, curve), white): ((&Series, &Curve), &DMatrix<f64>)| {
            let its = sensor.factor(&series.nodes, &curve.force_n)?;
            Some(white * its.lower())
        };
        design.series.iter().zip(curves).zip(self.runs.iter()).map(of).collect()
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
        for (colour, first) in colours.iter().zip(self.first.iter()) {
            turn_rows(colour, &mut values, *first);
        }
        for spot in self.spots.iter() {
            let size = |k: usize| if spot.estimated { jitter[k.min(2)] } else { 1.0 };
            let amounts = DVector::from_fn(spot.jitter.len(), |k, _| size(k) * normal());
            let shift = spot.jitter.columns() * amounts;
            for (k, &entry) in spot.entries.iter().enumerate() {
                values[entry] += shift[k];
            }
        }
        self.apply_spots(&mut values);
        let columns = self.shared.columns();
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
                contact_sigma_mm * spot.jitter.amounts(&own).get(0).copied().unwrap_or(0.0)
            })
            .collect()
    }
}

/// A run of which some rows are left out.
struct Kept {
    /// What whitens the others; 0 in all rows and columns that are left out.
    white: DMatrix<f64>,
    /// The same after the whitening of all rows.
    turn: DMatrix<f64>,
}

impl Kept {
    fn of(white: &DMatrix<f64>, used: &[bool]) -> Option<Self> {
        let n = white.nrows();
        let gone = |k: usize| !used[k];
        let apart = |k: usize| (0..n).all(|j| j == k || (white[(k, j)] == 0.0 && white[(j, k)] == 0.0));
        if !(0..n).any(|k| used[k]) || (0..n).filter(|k| gone(*k)).all(apart) {
            // nothing of what stays was told of what goes
            let own = |i: usize, j: usize| if used[i] && used[j] { white[(i, j)] } else { 0.0 };
            let stays = DVector::from_iterator(n, used.iter().map(|used| f64::from(u8::from(*used))));
            return Some(Self { white: DMatrix::from_fn(n, n, own), turn: DMatrix::from_diagonal(&stays) });
        }
        let rows: Vec<usize> = (0..n).filter(|k| used[*k]).collect();
        let lower = white.solve_lower_triangular(&DMatrix::identity(n, n))?;
        let own = lower.select_rows(&rows);
        let inverse = self::white(&(&own * own.transpose()).cholesky()?.unpack())?;
        let turned = &inverse * &own;
        let (mut white, mut turn) = (DMatrix::zeros(n, n), DMatrix::zeros(n, n));
        for (i, row) in rows.iter().enumerate() {
            turn.row_mut(*row).copy_from(&turned.row(i));
            rows.iter().enumerate().for_each(|(j, column)| white[(*row, *column)] = inverse[(i, j)]);
        }
        Some(Self { white, turn })
    }
}

fn turn_runs(by: &[DMatrix<f64>], first: &[usize], columns: &mut DMatrix<f64>) {
    for (turn, first) in by.iter().zip(first) {
        turn_rows(turn, columns, *first);
    }
}

fn fold_spots(spots: &[Spot], columns: &mut DMatrix<f64>) {
    for spot in spots {
        let own = spot.jitter.all_taken_off(columns.select_rows(&spot.entries));
        spot.entries.iter().enumerate().for_each(|(k, &entry)| columns.row_mut(entry).copy_from(&own.row(k)));
    }
}

/// What all runs share, N: the error of the simulation, smooth over depth for every geometry by itself, the tare, and the wandering zero.
fn common(design: &Design, curves: &[Curve], first: &[usize], len: usize) -> DMatrix<f64> {
    let smooth = 3 * design.geometries.len();
    let mut columns = DMatrix::zeros(len, smooth + 1 + MODES);
    let peaks = curves.iter().flat_map(|c| c.force_n.iter().copied());
    let peak_n = peaks.chain(design.checks.iter().map(|check| check.scale_n)).fold(0.0, f64::max);
    columns.column_mut(smooth).fill(TARE * peak_n);
    for (at, check) in design.checks.iter().enumerate() {
        let first = first[design.series.len() + at];
        (check.readings()..check.rows()).for_each(|row| columns[(first + row, smooth)] = 0.0);
    }
    wander(design, peak_n, first, &mut columns.columns_mut(smooth + 1, MODES));
    for (s, (series, curve)) in design.series.iter().zip(curves).enumerate() {
        let depth_mm = design.geometries[series.geometry].depth_mm;
        for (k, (node, force_n)) in series.nodes.iter().zip(&curve.force_n).enumerate() {
            let x = 2.0 * (node.depth_mm / depth_mm).clamp(0.0, 1.0).sqrt() - 1.0;
            for (j, shape) in [1.0, x, 1.5 * x * x - 0.5].into_iter().enumerate() {
                columns[(first[s] + k, 3 * series.geometry + j)] = SIMULATED * force_n * shape;
            }
            if node.lifted {
                columns.row_mut(first[s] + k).fill(0.0);
            }
        }
    }
    columns
}

/// Brownian motion of the zero over the session clock, mode by mode; nothing where no clock is known.
fn wander(design: &Design, peak_n: f64, first: &[usize], columns: &mut nalgebra::DMatrixViewMut<'_, f64>) {
    let runs = design.series.iter().map(|s| (s.start_s, s.nodes.len()));
    let checks = design.checks.iter().map(|check| (check.start_s, check.readings()));
    let (starts, lengths): (Vec<Option<f64>>, Vec<usize>) = runs.chain(checks).unzip();
    let Some(starts) = starts.into_iter().collect::<Option<Vec<f64>>>() else { return };
    let begin = starts.iter().copied().fold(f64::INFINITY, f64::min);
    let length_s = starts.iter().copied().fold(begin, f64::max) - begin;
    if length_s <= 0.0 {
        return;
    }
    let size_n = WANDER * peak_n * (length_s / 3600.0).sqrt();
    for (s, length) in lengths.into_iter().enumerate() {
        for mode in 0..MODES {
            let wave = (mode as f64 + 0.5) * std::f64::consts::PI;
            let value = size_n * 2.0_f64.sqrt() * (wave * (starts[s] - begin) / length_s).sin() / wave;
            columns.view_mut((first[s], mode), (length, 1)).fill(value);
        }
    }
}
