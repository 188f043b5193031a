//! An actuator that is pushed through its stroke without a command: what force over position tells of its friction.
//!
//! The force is a sum of named parts. Dry friction is Dahl's (1968, Aerospace TOR-0158(3107-18)-1): over a way of `s` it turns from one direction
//! to the other, `dz = (sign(dx) - z) |dx| / s`, which is exact between stamps. A part is taken in only where the record asks for it
//! by BIC over the number of samples that are as good as independent.
//!
//! A load cell is smooth and a model of a few parts is not exact, so neighbouring residuals are nearly equal. Whitening would then fit the
//! quick part of the force alone; so the amounts are those of plain least squares, and the correlation goes into their intervals
//! (Newey and West) and into the choice of parts.

use crate::experiment::signal::median;
use nalgebra::{DMatrix, DVector};

use super::fit::ends;
use super::interval::LAGS;
use super::noise::{autocorrelation, ljung_box};
use super::repeat::repeated;
use crate::calibration::distribution::student_critical;
use crate::infer::descent::{Region, Residuals, Rule, minimise};

/// A recording of position and force.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Pushed {
    /// Stamps, s, rising.
    pub time_s: Vec<f64>,
    /// Position, mm.
    pub position_mm: Vec<f64>,
    /// Force, N.
    pub force_n: Vec<f64>,
    /// Another signal that the force may follow, such as a pressure, in its own unit.
    pub beside: Option<Vec<f64>>,
}

/// A part of the force.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// Constant force, N.
    Rest,
    /// Dry friction, N.
    Friction,
    /// Stiffness, N/mm.
    Stiffness,
    /// The other signal, N per its unit.
    Beside,
    /// Change of friction along the stroke, N/mm.
    FrictionSlope,
    /// Viscous friction, N s/mm.
    Viscous,
    /// Curvature of the stiffness, N/mm^2.
    Curvature,
    /// Drift, N/s.
    Drift,
    /// What is lost while running in, N; exponential in the way travelled.
    RunIn,
    /// Friction that is lost while running in, N.
    FrictionRunIn,
}

impl Part {
    /// What the greedy choice may add, beside rest and friction.
    const OFFERED: [Part; 8] = [
        Part::Stiffness,
        Part::Beside,
        Part::FrictionSlope,
        Part::Viscous,
        Part::Curvature,
        Part::Drift,
        Part::RunIn,
        Part::FrictionRunIn,
    ];

    /// Name with unit.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Part::Rest => "rest_N",
            Part::Friction => "friction_N",
            Part::Stiffness => "stiffness_N_per_mm",
            Part::Beside => "beside_N_per_unit",
            Part::FrictionSlope => "friction_slope_N_per_mm",
            Part::Viscous => "viscous_N_s_per_mm",
            Part::Curvature => "curvature_N_per_mm2",
            Part::Drift => "drift_N_per_s",
            Part::RunIn => "run_in_N",
            Part::FrictionRunIn => "friction_run_in_N",
        }
    }
}

/// What was found.
#[derive(Debug, Clone)]
pub struct PushFit {
    /// Parts of the force with their amounts and 95 % intervals.
    pub parts: Vec<(Part, f64, (f64, f64))>,
    /// Way over which friction turns, mm, with its 95 % interval.
    pub turning_mm: (f64, (f64, f64)),
    /// Way over which the actuator runs in, mm; none where no part asked for it.
    pub run_in_mm: Option<f64>,
    /// Predicted force, N.
    pub predicted_n: Vec<f64>,
    /// Force less prediction, N.
    pub residual_n: Vec<f64>,
    /// Share of the force's variance that is predicted.
    pub explained: f64,
    /// Standard deviation of the residual, N.
    pub sd_n: f64,
    /// Step of the force's numbers, N: the smallest distance of two that differ.
    pub count_n: f64,
    /// Statistic of Ljung and Box per degree of freedom, and what white noise exceeds once in a hundred records.
    pub whiteness: (f64, f64),
    /// Share of the residual's variance that comes again at the same place in every stroke.
    pub repeated: Option<f64>,
    /// Speeds of the motion, mm/s: the tenth and the ninetieth percentile of their amounts.
    pub speeds_mm_s: (f64, f64),
    /// Correlation coefficient of the errors of the friction and of the other signal's part.
    pub beside_correlation: Option<f64>,
    /// Friction without the other signal's part, N, where that was taken in.
    pub friction_alone_n: Option<f64>,
}

/// Fewest samples.
pub const LEAST_SAMPLES: usize = 100;
/// Samples over which a speed is taken, on both sides.
const SPEED_OVER: usize = 3;
/// Part of the friction's direction that is taken as known at the first stamp.
const BEGIN: f64 = 0.0;

/// Median of the slopes of all pairs around a sample (Theil and Sen): one reading that is off, or one late stamp, does not move it.
fn speed(record: &Pushed, k: usize) -> f64 {
    let (from, to) = (k.saturating_sub(SPEED_OVER), (k + SPEED_OVER).min(record.position_mm.len().saturating_sub(1)));
    let pairs = (from..=to).flat_map(|a| (a + 1..=to).map(move |b| (a, b)));
    let slope = |(a, b): (usize, usize)| {
        (record.position_mm[b] - record.position_mm[a]) / (record.time_s[b] - record.time_s[a]).max(1e-9)
    };
    median(pairs.map(slope))
}

struct Shapes<'a> {
    record: &'a Pushed,
    middle_mm: f64,
    travelled_mm: Vec<f64>,
    speed_mm_s: Vec<f64>,
    beside: Vec<f64>,
}

impl<'a> Shapes<'a> {
    fn of(record: &'a Pushed) -> Self {
        let (low, high) = ends(&record.position_mm);
        let x = &record.position_mm;
        let mut way = 0.0;
        let travelled_mm = (0..x.len())
            .map(|k| {
                way += if k > 0 { (x[k] - x[k - 1]).abs() } else { 0.0 };
                way
            })
            .collect();
        let speed_mm_s = (0..x.len()).map(|k| speed(record, k)).collect();
        let beside = record.beside.as_ref().map_or(Vec::new(), |values| {
            let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
            values.iter().map(|v| v - mean).collect()
        });
        Self { record, middle_mm: 0.5 * (low + high), travelled_mm, speed_mm_s, beside }
    }

    /// Direction of the friction, -1 to 1.
    fn direction(&self, turning_mm: f64) -> Vec<f64> {
        let x = &self.record.position_mm;
        let mut z = BEGIN;
        (0..x.len())
            .map(|k| {
                if k > 0 {
                    let way = x[k] - x[k - 1];
                    z = way.signum() + (z - way.signum()) * (-way.abs() / turning_mm).exp();
                }
                z
            })
            .collect()
    }

    fn matrix(&self, parts: &[Part], turning_mm: f64, run_in_mm: f64) -> DMatrix<f64> {
        let z = self.direction(turning_mm);
        let x = |k: usize| self.record.position_mm[k] - self.middle_mm;
        let first_s = self.record.time_s[0];
        DMatrix::from_fn(z.len(), parts.len(), |k, j| match parts[j] {
            Part::Rest => 1.0,
            Part::Friction => z[k],
            Part::Stiffness => x(k),
            Part::Beside => self.beside[k],
            Part::FrictionSlope => x(k) * z[k],
            Part::Viscous => self.speed_mm_s[k],
            Part::Curvature => x(k) * x(k),
            Part::Drift => self.record.time_s[k] - first_s,
            Part::RunIn => (-self.travelled_mm[k] / run_in_mm).exp(),
            Part::FrictionRunIn => z[k] * (-self.travelled_mm[k] / run_in_mm).exp(),
        })
    }
}

/// One fit: amounts of the parts, the two ways (logarithms), residual, noise.
#[derive(Debug, Clone)]
struct One {
    parts: Vec<Part>,
    amounts: DVector<f64>,
    ways: [f64; 2],
    residual: Vec<f64>,
    bic: f64,
}

/// Amounts by least squares, with columns of unit length.
fn amounts(matrix: &DMatrix<f64>, y: &DVector<f64>) -> DVector<f64> {
    let scale: Vec<f64> = matrix.column_iter().map(|c| c.norm().max(f64::MIN_POSITIVE)).collect();
    let mut unit = matrix.clone();
    unit.column_iter_mut().zip(&scale).for_each(|(mut c, s)| c /= *s);
    let right = unit.tr_mul(y);
    let inverse = unit.tr_mul(&unit).pseudo_inverse(1e-12).unwrap_or_else(|_| DMatrix::zeros(scale.len(), scale.len()));
    let mut x = inverse * right;
    x.iter_mut().zip(&scale).for_each(|(x, s)| *x /= s);
    x
}

fn fitted(shapes: &Shapes<'_>, parts: &[Part], ways: [f64; 2]) -> One {
    let force = &shapes.record.force_n;
    let y = DVector::from_column_slice(force);
    let runs_in = parts.iter().any(|p| matches!(p, Part::RunIn | Part::FrictionRunIn));
    let travel = {
        let (low, high) = ends(&shapes.record.position_mm);
        (high - low).max(1e-9)
    };
    let whole = shapes.travelled_mm.last().copied().unwrap_or(1.0).max(1e-9);
    let region = Region {
        low: vec![(1e-4 * travel).ln(), (0.05 * travel).ln()],
        high: vec![travel.ln(), whole.ln()],
        held: if runs_in { None } else { Some(1) },
    };
    // The amounts are solved for at every point; slopes are those of what then is left.
    let left = |w: &[f64]| {
        let matrix = shapes.matrix(parts, w[0].exp(), w[1].exp());
        &y - &matrix * amounts(&matrix, &y)
    };
    let objective = Residuals {
        residual: |w: &[f64]| left(w),
        jacobian: |w: &[f64], r: &DVector<f64>| {
            let columns: Vec<DVector<f64>> = (0..2)
                .map(|i| {
                    let mut moved = w.to_vec();
                    moved[i] += 1e-4;
                    if region.held == Some(i) { DVector::zeros(r.len()) } else { (r - left(&moved)) / 1e-4 }
                })
                .collect();
            DMatrix::from_columns(&columns)
        },
    };
    let end = minimise(&objective, &region, &ways, &Rule { most_steps: 30, settled_share: 1e-7, ..Rule::default() });
    let ways = [end.x[0], end.x[1]];
    let plain = shapes.matrix(parts, ways[0].exp(), ways[1].exp());
    let amounts = amounts(&plain, &y);
    let predicted = &plain * &amounts;
    let residual: Vec<f64> = force.iter().zip(predicted.iter()).map(|(f, p)| f - p).collect();
    let count = (parts.len() + 1 + usize::from(runs_in)) as f64;
    let n = independent(&residual);
    let bic = n * (end.value / residual.len() as f64).max(f64::MIN_POSITIVE).ln() + count * n.ln();
    One { parts: parts.to_vec(), amounts, ways, residual, bic }
}

/// Lag from which on a residual no longer depends on itself: the first without positive correlation.
fn memory(residual: &[f64]) -> (usize, f64) {
    let rho = autocorrelation(residual, residual.len() / 8);
    let end = rho.iter().position(|r| *r <= 0.0).unwrap_or(rho.len());
    (end, 1.0 + 2.0 * rho[1..end.max(1)].iter().sum::<f64>())
}

/// Number of samples that tell as much as these do, were they independent.
fn independent(residual: &[f64]) -> f64 {
    (residual.len() as f64 / memory(residual).1).max(10.0)
}

/// Finds friction and what else a pushed actuator's force is made of; `None` for fewer than [`LEAST_SAMPLES`] samples or no motion.
#[must_use]
pub fn push(record: &Pushed) -> Option<PushFit> {
    let (low, high) = ends(&record.position_mm);
    if record.time_s.len() < LEAST_SAMPLES || high <= low {
        return None;
    }
    let shapes = Shapes::of(record);
    let travel = high - low;
    let whole = shapes.travelled_mm.last().copied().unwrap_or(travel);
    let ways = [(0.02 * travel).ln(), (0.2 * whole).max(0.1 * travel).ln()];
    let mut best = fitted(&shapes, &[Part::Rest, Part::Friction], ways);
    loop {
        let offered = Part::OFFERED.iter().filter(|p| !best.parts.contains(p));
        let offered = offered.filter(|p| **p != Part::Beside || record.beside.is_some());
        let tried = offered.map(|part| fitted(&shapes, &[best.parts.as_slice(), &[*part]].concat(), best.ways));
        let Some(next) = tried.min_by(|a, b| a.bic.total_cmp(&b.bic)) else { break };
        if next.bic > best.bic - super::choose::CLEARLY {
            break;
        }
        best = next;
    }
    Some(told(&shapes, best))
}

fn told(shapes: &Shapes<'_>, one: One) -> PushFit {
    let record = shapes.record;
    let n = record.force_n.len() as f64;
    let runs_in = one.parts.iter().any(|p| matches!(p, Part::RunIn | Part::FrictionRunIn));
    let at = |ways: [f64; 2]| shapes.matrix(&one.parts, ways[0].exp(), ways[1].exp()) * &one.amounts;
    let plain = shapes.matrix(&one.parts, one.ways[0].exp(), one.ways[1].exp());
    let mut columns: Vec<DVector<f64>> = plain.column_iter().map(|c| c.clone_owned()).collect();
    for i in 0..=usize::from(runs_in) {
        let (mut a, mut b) = (one.ways, one.ways);
        a[i] -= 1e-4;
        b[i] += 1e-4;
        columns.push((at(b) - at(a)) / 2e-4);
    }
    let slopes = DMatrix::from_columns(&columns);
    let white = DVector::from_column_slice(&one.residual);
    let variance = white.norm_squared() / (n - columns.len() as f64).max(1.0);
    let scale: Vec<f64> = slopes.column_iter().map(|c| c.norm().max(f64::MIN_POSITIVE)).collect();
    let unit = DMatrix::from_fn(slopes.nrows(), slopes.ncols(), |i, j| slopes[(i, j)] / scale[j]);
    let inverse = unit.tr_mul(&unit).pseudo_inverse(1e-13).unwrap_or_else(|_| DMatrix::zeros(scale.len(), scale.len()));
    let whiteness = ljung_box(white.as_slice(), LAGS, 0);
    let inner = if whiteness.0 > whiteness.1 {
        &inverse * super::interval::meat(&unit, &white, 2 * memory(&one.residual).0) * &inverse
    } else {
        &inverse * variance
    };
    let t = student_critical(0.05, n - columns.len() as f64);
    let reach = |j: usize| t * inner[(j, j)].max(0.0).sqrt() / scale[j];
    let amount = |(j, part): (usize, &Part)| {
        let value = one.amounts[j];
        (*part, value, (value - reach(j), value + reach(j)))
    };
    let place = |part: Part| one.parts.iter().position(|p| *p == part);
    let beside_correlation = place(Part::Beside)
        .zip(place(Part::Friction))
        .map(|(a, b)| inner[(a, b)] / (inner[(a, a)] * inner[(b, b)]).sqrt());
    let alone = place(Part::Beside).map(|beside| {
        let parts: Vec<Part> = one.parts.iter().enumerate().filter(|(j, _)| *j != beside).map(|(_, p)| *p).collect();
        fitted(shapes, &parts, one.ways).amounts[1]
    });
    let mean = record.force_n.iter().sum::<f64>() / n;
    let all: f64 = record.force_n.iter().map(|f| (f - mean).powi(2)).sum();
    let left: f64 = one.residual.iter().map(|r| r * r).sum();
    let (turning, turning_reach) = (one.ways[0], reach(one.parts.len()));
    PushFit {
        parts: one.parts.iter().enumerate().map(amount).collect(),
        turning_mm: (turning.exp(), ((turning - turning_reach).exp(), (turning + turning_reach).exp())),
        run_in_mm: runs_in.then(|| one.ways[1].exp()),
        predicted_n: record.force_n.iter().zip(&one.residual).map(|(f, r)| f - r).collect(),
        explained: if all > 0.0 { 1.0 - left / all } else { 0.0 },
        sd_n: (left / n).sqrt(),
        count_n: count(&record.force_n),
        repeated: repeated(&record.position_mm, &one.residual),
        speeds_mm_s: speeds(&shapes.speed_mm_s),
        residual_n: one.residual,
        whiteness,
        beside_correlation,
        friction_alone_n: alone,
    }
}

/// Tenth and ninetieth percentile of the amounts.
fn speeds(all: &[f64]) -> (f64, f64) {
    let mut sorted: Vec<f64> = all.iter().map(|v| v.abs()).collect();
    sorted.sort_by(f64::total_cmp);
    let at = |share: f64| sorted[(share * (sorted.len() - 1) as f64) as usize];
    (at(0.1), at(0.9))
}

impl PushFit {
    /// A part with its interval, if it was taken in.
    #[must_use]
    pub fn part(&self, part: Part) -> Option<(f64, (f64, f64))> {
        self.parts.iter().find(|(p, ..)| *p == part).map(|(_, value, interval)| (*value, *interval))
    }

    /// What one should know before using the numbers, a sentence each.
    #[must_use]
    pub fn remarks(&self) -> Vec<String> {
        let mut told = vec![
            "The recording has no command: order, gain, delay, rate limit and backlash cannot be known from it; friction can.".to_owned(),
        ];
        let (slow, fast) = self.speeds_mm_s;
        if self.part(Part::Viscous).is_some() {
            told.push(format!(
                "Dry and viscous friction are told apart by speeds of {slow:.1} to {fast:.1} mm/s only; strokes at a tenth of the speed would decide."
            ));
        }
        if let (Some(rho), Some(alone)) = (self.beside_correlation, self.friction_alone_n) {
            told.push(format!(
                "The other signal changes with the direction of motion as friction does (their errors correlate by {rho:.2}): without it the \
                 friction would be {alone:.3} N. Strokes at a second pressure would tell them apart."
            ));
        }
        let percent = |share: f64| format!("{:.1} %", 100.0 * share);
        let mut rest = format!(
            "The parts explain {} of the force's variance; {:.3} N are left",
            percent(self.explained),
            self.sd_n
        );
        if let Some(repeated) = self.repeated {
            rest += &format!(
                ", {} of which comes again at the same place and direction in every stroke: a pattern of the bore and the seal, not noise",
                percent(repeated)
            );
        }
        told.push(format!("{rest}. The sensor's step is {:.3} N.", self.count_n));
        if self.whiteness.0 > self.whiteness.1 {
            told.push(
                "What is left depends on its past; the intervals take that into account (Newey and West).".to_owned(),
            );
        }
        told
    }
}

/// Smallest distance of two numbers that differ.
#[must_use]
pub fn count(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let steps = sorted.windows(2).map(|w| w[1] - w[0]).filter(|step| *step > 1e-9);
    let least = steps.fold(f64::INFINITY, f64::min);
    if least.is_finite() { least } else { 0.0 }
}
