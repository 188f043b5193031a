//! The weighted differences between all runs and what is known of their conditions.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use crate::identify::data::{LoadingCurve, Selection};
use crate::identify::spec::{HUBER, Loss};
use crate::infer::descent::{Minimum, Quadratic, Region, Rule, Together, minimise};

use super::condition::Condition;
use super::coordinate::{Kind, Unknown, Values};
use super::track::Track;

/// How much a run's samples count.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Weight {
    /// Standard deviation of a sample, N.
    pub sigma_n: f64,
    /// Samples that carry the information of one.
    pub correlated: f64,
}

/// All that a fit works on.
pub struct Problem<'a> {
    /// Data.
    pub selection: &'a Selection,
    /// Free parameters.
    pub unknowns: Vec<Unknown>,
    /// Parameters that are not free.
    pub base: Values,
    /// Forward problems.
    pub conditions: Vec<Condition>,
    /// Condition of every curve of the selection.
    pub condition_of: Vec<usize>,
    /// Weight of every curve.
    pub weights: Vec<Weight>,
    /// Loss.
    pub loss: Loss,
    /// Absolute differences below this many standard deviations count as squares, so that there is a smallest one.
    pub smooth: f64,
}

/// Most of the stiffness that may relax.
pub const MOST_RELAXING: f64 = 0.98;
/// Places at which a contact point is looked for before it is refined.
const SCAN: usize = 24;
/// Samples of a run with which it is looked for, evenly taken: more only say more exactly which of the places is the nearest.
const SCANNED: usize = 2000;
const REFINEMENTS: usize = 30;
/// Steps of a golden section: the bracket shrinks to a millionth.
const SECTIONS: usize = 29;
/// Contact points are exact to this share of their range.
const CONTACT_SHARE: f64 = 1e-9;
/// Step of a derivative by a coordinate, as a share of its range: the surrogate is smooth, so that the quotient's error is its square.
const QUOTIENT: f64 = 1e-6;

/// Forces of one run at one contact point.
pub struct Compared {
    /// Measured minus modelled force, N.
    pub residual_n: Vec<f64>,
    /// Derivative of the modelled force by the contact point, N/mm.
    pub by_contact: Vec<f64>,
}

impl Problem<'_> {
    /// The box of the coordinates.
    #[must_use]
    pub fn region(&self) -> Region {
        let (low, high) = self.unknowns.iter().map(Unknown::bounds).unzip();
        Region { low, high, held: None }
    }

    /// The minimum near a point inside a region, on what is solved.
    #[must_use]
    pub fn minimised(&self, region: &Region, start: &[f64]) -> Minimum {
        minimise(&Together(|x: &[f64]| self.quadratic(x)), region, start, &Rule::default()).into()
    }

    /// Curves that are fitted.
    pub fn fitted(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.selection.curves.len()).filter(|at| !self.selection.curves[*at].hold_out)
    }

    /// Number of fitted samples.
    #[must_use]
    pub fn samples(&self) -> usize {
        self.fitted().map(|at| self.selection.curves[at].force_n.len()).sum()
    }

    /// Tracks of all conditions; empty while one of them is not solved anywhere.
    #[must_use]
    pub fn tracks(&self, point: &[f64]) -> Vec<Track> {
        let one = |condition: &Condition| {
            let exact =
                condition.is_exact(&self.base).then(|| condition.exact_track(&self.base, &self.unknowns, point));
            exact.flatten().or_else(|| condition.track(point))
        };
        self.conditions.iter().map_while(one).collect()
    }

    /// Loss of one difference in standard deviations, and its weight in the equivalent square.
    fn loss(&self, u: f64) -> (f64, f64) {
        let size = u.abs();
        match self.loss {
            Loss::Squares => (u * u, 1.0),
            Loss::Huber if size <= HUBER => (u * u, 1.0),
            Loss::Huber => (HUBER * (2.0 * size - HUBER), HUBER / size),
            Loss::Absolute if size <= self.smooth => (u * u / self.smooth + self.smooth, 1.0 / self.smooth),
            Loss::Absolute => (2.0 * size, 1.0 / size),
        }
    }

    /// Square root of the weight of a difference (N) of a run, 1/N.
    pub(super) fn root_weight(&self, at: usize, residual_n: f64) -> f64 {
        let Weight { sigma_n, correlated } = self.weights[at];
        (self.loss(residual_n / sigma_n).1 / correlated).sqrt() / sigma_n
    }

    /// Loss of a run.
    fn loss_of(&self, at: usize, compared: &Compared) -> f64 {
        let weight = self.weights[at];
        compared.residual_n.iter().map(|r| self.loss(r / weight.sigma_n).0).sum::<f64>() / weight.correlated
    }

    /// The best contact point of a run, mm: a scan over its range, then a bracketed search.
    #[must_use]
    pub fn contact(&self, at: usize, track: &Track) -> f64 {
        let data = &self.selection.curves[at];
        let (low, high) = (data.contact.low_mm, data.contact.high_mm);
        let loss = |contact: f64| self.loss_of(at, &compare(data, track, contact));
        let stride = data.force_n.len().div_ceil(SCANNED).max(1);
        let scanned = |contact: f64| self.loss_of(at, &compare_some(data, track, contact, stride));
        let step = (high - low) / SCAN as f64;
        let places = (0..=SCAN).map(|i| low + i as f64 * step);
        let best = places.map(|c| (c, scanned(c))).min_by(|a, b| a.1.total_cmp(&b.1)).map_or(low, |(c, _)| c);
        let bracket = ((best - step).max(low), best, (best + step).min(high));
        match self.loss {
            Loss::Absolute => golden(loss, bracket),
            Loss::Squares | Loss::Huber => self.refined(at, track, bracket),
        }
    }

    /// Gauss-Newton along the contact point inside a bracket; a step that does not gain is halved.
    fn refined(&self, at: usize, track: &Track, (low, start, high): (f64, f64, f64)) -> f64 {
        let data = &self.selection.curves[at];
        let sigma_n = self.weights[at].sigma_n;
        let mut contact = start;
        let mut compared = compare(data, track, contact);
        let mut value = self.loss_of(at, &compared);
        for _ in 0..REFINEMENTS {
            let (mut slope, mut curvature) = (0.0, 0.0);
            for (r, by) in compared.residual_n.iter().zip(&compared.by_contact) {
                let weight = self.loss(r / sigma_n).1;
                slope += weight * r * by;
                curvature += weight * by * by;
            }
            if curvature <= 0.0 {
                break;
            }
            let mut move_mm = (contact + slope / curvature).clamp(low, high) - contact;
            let mut gained = false;
            for _ in 0..8 {
                let next = compare(data, track, contact + move_mm);
                let there = self.loss_of(at, &next);
                if there < value {
                    (contact, compared, value, gained) = (contact + move_mm, next, there, true);
                    break;
                }
                move_mm *= 0.5;
            }
            if !gained || move_mm.abs() < CONTACT_SHARE * (data.contact.high_mm - data.contact.low_mm) {
                break;
            }
        }
        contact
    }

    /// Sums of the relaxing parts, of the shear and of the bulk.
    #[must_use]
    pub fn relaxing(&self, point: &[f64]) -> [f64; 2] {
        let mut sums = [0.0; 2];
        for (unknown, x) in self.unknowns.iter().zip(point) {
            match unknown.kind {
                Kind::G(_) => sums[0] += x,
                Kind::K(_) => sums[1] += x,
                _ => {}
            }
        }
        sums
    }

    /// A solid keeps a part of its stiffness for ever: no sum of relaxing parts reaches 1.
    fn holds_together(&self, point: &[f64]) -> bool {
        self.relaxing(point).iter().all(|sum| *sum <= MOST_RELAXING)
    }

    /// What a fit leaves over on average, in the standard deviations of the weights.
    #[must_use]
    pub fn spread(&self, minimum: &Minimum) -> f64 {
        let count: f64 =
            self.fitted().map(|at| self.selection.curves[at].force_n.len() as f64 / self.weights[at].correlated).sum();
        let mean = minimum.at.value / count.max(1.0);
        if self.loss == Loss::Absolute { 0.5 * mean } else { mean.sqrt() }
    }

    /// Objective at a point, contact points at their best; infinite while nothing is solved.
    #[must_use]
    pub fn value(&self, point: &[f64]) -> f64 {
        let tracks = self.tracks(point);
        if tracks.len() < self.conditions.len() || !self.holds_together(point) {
            return f64::INFINITY;
        }
        self.fitted()
            .map(|at| {
                let track = &tracks[self.condition_of[at]];
                self.loss_of(at, &compare(&self.selection.curves[at], track, self.contact(at, track)))
            })
            .sum()
    }

    /// Objective with its Gauss-Newton model, contact points at their best.
    ///
    /// They are eliminated: what a shift of a run's contact point would absorb is taken out of its derivatives (Kaufman 1975,
    /// doi:10.1007/BF01932995).
    #[must_use]
    pub fn quadratic(&self, point: &[f64]) -> Quadratic {
        self.quadratic_on(point, self.tracks(point))
    }

    /// As [`Problem::quadratic`], with a relative error of the force in one condition, see [`Track::with_error`].
    #[must_use]
    pub fn quadratic_with_error(&self, point: &[f64], condition: usize, size: f64, waves: f64) -> Quadratic {
        let mut tracks = self.tracks(point);
        if let Some(track) = tracks.get_mut(condition) {
            *track = track.clone().with_error(size, waves);
        }
        self.quadratic_on(point, tracks)
    }

    fn quadratic_on(&self, point: &[f64], tracks: Vec<Track>) -> Quadratic {
        let count = self.unknowns.len();
        let mut sum = Quadratic { value: 0.0, gradient: DVector::zeros(count), hessian: DMatrix::zeros(count, count) };
        if tracks.len() < self.conditions.len() || !self.holds_together(point) {
            sum.value = f64::INFINITY;
            return sum;
        }
        let moved: Vec<(Vec<Track>, Vec<Track>, f64)> = (0..count).map(|axis| self.moved(point, axis)).collect();
        let of = |at: usize| {
            let condition = self.condition_of[at];
            let contact = self.contact(at, &tracks[condition]);
            let data = &self.selection.curves[at];
            let compared = compare(data, &tracks[condition], contact);
            let columns: Vec<DVector<f64>> = moved
                .iter()
                .map(|(low, high, width)| {
                    let low = forces(data, &low[condition], contact);
                    let high = forces(data, &high[condition], contact);
                    DVector::from_iterator(low.len(), low.iter().zip(&high).map(|(l, h)| (h - l) / width))
                })
                .collect();
            (at, compared, DMatrix::from_columns(&columns))
        };
        // added up in their order, so that the sum is the same on any number of threads
        let fitted: Vec<usize> = self.fitted().collect();
        let runs: Vec<(usize, Compared, DMatrix<f64>)> = fitted.into_par_iter().map(of).collect();
        for (at, compared, jacobian) in &runs {
            sum.value += self.loss_of(*at, compared);
            self.add(*at, compared, jacobian, &mut sum);
        }
        sum
    }

    /// Tracks a little below and above along one coordinate, and the distance between.
    pub(super) fn moved(&self, point: &[f64], axis: usize) -> (Vec<Track>, Vec<Track>, f64) {
        let (low, high) = self.unknowns[axis].bounds();
        let step = QUOTIENT * (high - low);
        // At a wall one-sided: beyond it there may be no material.
        let (from, to) = ((point[axis] - step).max(low), (point[axis] + step).min(high));
        let shifted = |to: f64| {
            let mut point = point.to_vec();
            point[axis] = to;
            self.tracks(&point)
        };
        (shifted(from), shifted(to), (to - from).max(f64::MIN_POSITIVE))
    }

    fn add(&self, at: usize, compared: &Compared, jacobian: &DMatrix<f64>, sum: &mut Quadratic) {
        let weight = self.weights[at];
        let scale = 1.0 / (weight.sigma_n * weight.sigma_n * weight.correlated);
        let w = |r: f64| scale * self.loss(r / weight.sigma_n).1;
        let rows = compared.residual_n.len();
        let weighted = DVector::from_fn(rows, |i, _| w(compared.residual_n[i]));
        let residual = DVector::from_column_slice(&compared.residual_n);
        let by_contact = DVector::from_column_slice(&compared.by_contact);
        let with_weight = |v: &DVector<f64>| v.component_mul(&weighted);
        let contact_weight = with_weight(&by_contact);
        let norm = by_contact.dot(&contact_weight);
        let mut hessian = DMatrix::zeros(jacobian.ncols(), jacobian.ncols());
        let columns: Vec<DVector<f64>> = jacobian
            .column_iter()
            .map(|column| {
                let share = if norm > 0.0 { column.dot(&contact_weight) / norm } else { 0.0 };
                column - share * &by_contact
            })
            .collect();
        for (i, a) in columns.iter().enumerate() {
            let weighted = with_weight(a);
            sum.gradient[i] -= weighted.dot(&residual);
            for (j, b) in columns.iter().enumerate().take(i + 1) {
                hessian[(i, j)] = weighted.dot(b);
                hessian[(j, i)] = hessian[(i, j)];
            }
        }
        sum.hessian += hessian;
    }
}

/// The least value inside a bracket by golden section: absolute differences have kinks that stop a gradient.
fn golden(loss: impl Fn(f64) -> f64, (low, middle, high): (f64, f64, f64)) -> f64 {
    let ratio = 0.5 * (5.0_f64.sqrt() - 1.0);
    let (mut a, mut b) = (low, high);
    let (mut left, mut right) = (b - ratio * (b - a), a + ratio * (b - a));
    let (mut of_left, mut of_right) = (loss(left), loss(right));
    for _ in 0..SECTIONS {
        if of_left < of_right {
            (b, right, of_right) = (right, left, of_left);
            left = b - ratio * (b - a);
            of_left = loss(left);
        } else {
            (a, left, of_left) = (left, right, of_right);
            right = a + ratio * (b - a);
            of_right = loss(right);
        }
    }
    let (best, value) = if of_left < of_right { (left, of_left) } else { (right, of_right) };
    if value < loss(middle) { best } else { middle }
}

/// Measured against modelled forces at a contact point.
pub fn compare(data: &LoadingCurve, track: &Track, contact_mm: f64) -> Compared {
    compare_some(data, track, contact_mm, 1)
}

/// The same for one of so many samples only.
fn compare_some(data: &LoadingCurve, track: &Track, contact_mm: f64, of: usize) -> Compared {
    let pairs = (0..data.force_n.len()).step_by(of).map(|at| {
        let (model, slope) = modelled(data, track, contact_mm, at);
        (data.force_n[at] - model, -slope)
    });
    let (residual_n, by_contact) = pairs.unzip();
    Compared { residual_n, by_contact }
}

/// Modelled forces (N) at the samples.
pub fn forces(data: &LoadingCurve, track: &Track, contact_mm: f64) -> Vec<f64> {
    (0..data.force_n.len()).map(|at| modelled(data, track, contact_mm, at).0).collect()
}

/// Modelled force (N) at a sample, and its slope (N/mm).
fn modelled(data: &LoadingCurve, track: &Track, contact_mm: f64, at: usize) -> (f64, f64) {
    let depth_mm = data.depth_mm[at] - contact_mm;
    if at < data.hold_from { track.ramp(depth_mm) } else { track.hold(depth_mm, data.time_s[at]) }
}
