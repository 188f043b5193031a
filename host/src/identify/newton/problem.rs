//! The weighted differences between all runs and what is known of their conditions.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use crate::identify::data::{LoadingCurve, Selection};
use crate::identify::spec::{HUBER, Loss};
use crate::infer::descent::{Minimum, Quadratic, Region, Rule, Together, minimise};

use super::condition::Condition;
use super::coordinate::{Kind, Unknown, Values};
use super::surrogate::Node;
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
/// What lies beyond it costs this times its square, as far as this: a millionth beyond costs a hundredth of chi-squared.
const WALL: f64 = 1e10;
const FARTHEST: f64 = 0.01;
/// Places at which a contact point is looked for before it is refined.
const SCAN: usize = 24;
/// Samples of a run with which it is looked for, evenly taken: more only say more exactly which of the places is the nearest.
const SCANNED: usize = 2000;
/// Valleys of the scan that are followed.
const VALLEYS: usize = 3;
const REFINEMENTS: usize = 30;
/// Steps of a golden section: the bracket shrinks to a millionth.
const SECTIONS: usize = 29;
/// What is left of the rounding of a touch once the search is near: half the distance of two samples, within which no reading
/// tells where the touch was.
const SHARPER: f64 = 0.25;
/// Contact points are exact to this share of their range.
const CONTACT_SHARE: f64 = 1e-9;
/// And stand at an end of it when nearer than this: what a golden section leaves.
const END_SHARE: f64 = 1e-6;
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

    /// The same problem with nothing solved: what is asked of it next rests on no interpolation.
    #[must_use]
    pub fn clone_unsolved(&self) -> Self {
        let mut conditions = self.conditions.clone();
        conditions.iter_mut().for_each(|condition| condition.forget());
        Self {
            selection: self.selection,
            unknowns: self.unknowns.clone(),
            base: self.base.clone(),
            conditions,
            condition_of: self.condition_of.clone(),
            weights: self.weights.clone(),
            loss: self.loss,
            smooth: self.smooth,
        }
    }

    /// Faces that came to touch over a few samples, so that the search had no kinks, do so at once; true where any does.
    pub fn sharpen(&mut self) -> bool {
        let round = self.conditions.iter_mut().filter(|condition| condition.rounding_mm > 0.0);
        round.map(|condition| condition.rounding_mm *= SHARPER).count() > 0
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

    /// Tracks of all conditions; fewer than these while one is not solved anywhere, or has no force at the point.
    #[must_use]
    pub fn tracks(&self, point: &[f64]) -> Vec<Track> {
        let one = |condition: &Condition| match condition.is_homogeneous() {
            // Where the material does not exist there is no force; what was solved elsewhere says nothing of it.
            true => condition.exact_track(&self.base, &self.unknowns, point),
            false => condition.track(point),
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

    /// The best contact point of a run, mm: a scan over its range, then a bracketed search in each valley that the scan shows.
    #[must_use]
    pub fn contact(&self, at: usize, track: &Track) -> f64 {
        let data = &self.selection.curves[at];
        let (low, high) = (data.contact.low_mm, data.contact.high_mm);
        let loss = |contact: f64| self.loss_of(at, &self.compared(at, track, contact, 1));
        let stride = data.force_n.len().div_ceil(SCANNED).max(1);
        let step = (high - low) / SCAN as f64;
        let place = |i: usize| low + i as f64 * step;
        let scanned: Vec<f64> =
            (0..=SCAN).map(|i| self.loss_of(at, &self.compared(at, track, place(i), stride))).collect();
        let is_least = |i: &usize| {
            let beside = [i.checked_sub(1), Some(i + 1)].into_iter().flatten().filter_map(|j| scanned.get(j));
            beside.into_iter().all(|other| scanned[*i] <= *other)
        };
        let mut valleys: Vec<usize> = (0..=SCAN).filter(is_least).collect();
        valleys.sort_by(|a, b| scanned[*a].total_cmp(&scanned[*b]));
        let refined = valleys.iter().take(VALLEYS).map(|&i| {
            let bracket = ((place(i) - step).max(low), place(i), (place(i) + step).min(high));
            match self.loss {
                Loss::Absolute => golden(loss, bracket),
                Loss::Squares | Loss::Huber => self.refined(at, track, bracket),
            }
        });
        let refined: Vec<f64> = refined.collect();
        match refined.as_slice() {
            [] => low,
            [only] => *only,
            many => many.iter().map(|c| (*c, loss(*c))).min_by(|a, b| a.1.total_cmp(&b.1)).map_or(low, |(c, _)| c),
        }
    }

    /// Variance of a sample that carries the information of one, N2.
    pub(super) fn variance_n2(&self, at: usize) -> f64 {
        let Weight { sigma_n, correlated } = self.weights[at];
        sigma_n * sigma_n * correlated
    }

    /// Measured against modelled forces of a run at a contact point, of one sample in `of`: what its zero of the force may absorb is
    /// taken out of both, at its price.
    fn compared(&self, at: usize, track: &Track, contact_mm: f64, of: usize) -> Compared {
        let data = &self.selection.curves[at];
        let mut compared = compare_some(data, track, contact_mm, of);
        if !data.unsure.is_empty() {
            let unsure = data.unsure.at((0..data.force_n.len()).step_by(of), of);
            unsure.whiten(&mut compared.residual_n, self.variance_n2(at));
            unsure.whiten(&mut compared.by_contact, self.variance_n2(at));
        }
        compared
    }

    /// What the sensor of a run most likely read without a contact, N at each sample, beside the modelled forces.
    #[must_use]
    pub fn zero_n(&self, at: usize, force_n: &[f64]) -> Vec<f64> {
        let data = &self.selection.curves[at];
        let left: Vec<f64> = data.force_n.iter().zip(force_n).map(|(measured, model)| measured - model).collect();
        data.unsure.likely(&left, self.variance_n2(at))
    }

    /// True when a contact point stands at an end of its range: it cannot follow the parameters any farther.
    fn stands_at_end(&self, at: usize, contact_mm: f64) -> bool {
        let range = &self.selection.curves[at].contact;
        let near = END_SHARE * (range.high_mm - range.low_mm);
        contact_mm <= range.low_mm + near || contact_mm >= range.high_mm - near
    }

    /// Gauss-Newton along the contact point inside a bracket; a step that does not gain is halved.
    fn refined(&self, at: usize, track: &Track, (low, start, high): (f64, f64, f64)) -> f64 {
        let data = &self.selection.curves[at];
        let sigma_n = self.weights[at].sigma_n;
        let mut contact = start;
        let mut compared = self.compared(at, track, contact, 1);
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
            let whole_mm = (contact + slope / curvature).clamp(low, high) - contact;
            let mut move_mm = whole_mm;
            let mut gained = false;
            for _ in 0..8 {
                let next = self.compared(at, track, contact + move_mm, 1);
                let there = self.loss_of(at, &next);
                if there < value {
                    (contact, compared, value, gained) = (contact + move_mm, next, there, true);
                    break;
                }
                move_mm *= 0.5;
            }
            let enough = CONTACT_SHARE * (data.contact.high_mm - data.contact.low_mm);
            if !gained && whole_mm.abs() > enough {
                // Slopes mislead across a kink; a search without them does not.
                let around = ((contact - whole_mm.abs()).max(low), contact, (contact + whole_mm.abs()).min(high));
                return golden(|c| self.loss_of(at, &self.compared(at, track, c, 1)), around);
            }
            if !gained || move_mm.abs() < enough {
                break;
            }
        }
        contact
    }

    /// Weighted sums of modelled times measured and of squared modelled forces at a run's best contact point.
    pub(super) fn overlap(&self, at: usize, track: &Track) -> (f64, f64) {
        let data = &self.selection.curves[at];
        let weight = self.weights[at];
        let scale = 1.0 / self.variance_n2(at);
        let model = forces(data, track, self.contact(at, track));
        model.iter().zip(&data.force_n).fold((0.0, 0.0), |(mixed, own), (m, f)| {
            let w = scale * self.loss((f - m) / weight.sigma_n).1;
            (mixed + w * m * f, own + w * m * m)
        })
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

    /// How far the relaxing parts go beyond what may relax; none where one goes beyond what can.
    ///
    /// A solid keeps a part of its stiffness for ever. The wall is a steep parabola, so that a search slides along it.
    fn beyond(&self, point: &[f64]) -> Option<[f64; 2]> {
        let beyond = self.relaxing(point).map(|sum| (sum - MOST_RELAXING).max(0.0));
        beyond.iter().all(|excess| *excess <= FARTHEST).then_some(beyond)
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
        let Some(beyond) = self.beyond(point) else { return f64::INFINITY };
        let tracks = self.tracks(point);
        if tracks.len() < self.conditions.len() {
            return f64::INFINITY;
        }
        let wall: f64 = beyond.iter().map(|excess| WALL * excess * excess).sum();
        wall + self
            .fitted()
            .map(|at| {
                let track = &tracks[self.condition_of[at]];
                self.loss_of(at, &self.compared(at, track, self.contact(at, track), 1))
            })
            .sum::<f64>()
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
        let Some(beyond) = self.beyond(point).filter(|_| tracks.len() == self.conditions.len()) else {
            sum.value = f64::INFINITY;
            return sum;
        };
        let moved = self.moved(point, &tracks);
        let of = |at: usize| {
            let condition = self.condition_of[at];
            let contact = self.contact(at, &tracks[condition]);
            let data = &self.selection.curves[at];
            let compared = self.compared(at, &tracks[condition], contact, 1);
            let columns: Vec<DVector<f64>> = moved
                .iter()
                .map(|(low, high, width)| {
                    let low = forces(data, &low[condition], contact);
                    let high = forces(data, &high[condition], contact);
                    let mut slope: Vec<f64> = low.iter().zip(&high).map(|(l, h)| (h - l) / width).collect();
                    data.unsure.whiten(&mut slope, self.variance_n2(at));
                    DVector::from_vec(slope)
                })
                .collect();
            (at, compared, self.stands_at_end(at, contact), DMatrix::from_columns(&columns))
        };
        // added up in their order, so that the sum is the same on any number of threads
        let fitted: Vec<usize> = self.fitted().collect();
        let runs: Vec<(usize, Compared, bool, DMatrix<f64>)> = fitted.into_par_iter().map(of).collect();
        for (at, compared, ends, jacobian) in &runs {
            sum.value += self.loss_of(*at, compared);
            self.add(*at, (compared, *ends), jacobian, &mut sum);
        }
        self.lean(beyond, &mut sum);
        sum
    }

    /// Adds the wall of the relaxing parts.
    fn lean(&self, beyond: [f64; 2], sum: &mut Quadratic) {
        for (which, excess) in beyond.into_iter().enumerate().filter(|(_, excess)| *excess > 0.0) {
            sum.value += WALL * excess * excess;
            let belongs = |kind: Kind| match which {
                0 => matches!(kind, Kind::G(_)),
                _ => matches!(kind, Kind::K(_)),
            };
            let axes: Vec<usize> = (0..self.unknowns.len()).filter(|&i| belongs(self.unknowns[i].kind)).collect();
            for &i in &axes {
                sum.gradient[i] += WALL * excess;
                axes.iter().for_each(|&j| sum.hessian[(i, j)] += WALL);
            }
        }
    }

    /// Tracks a little below and above along each coordinate, and the distance between; one-sided at a wall.
    pub(super) fn moved(&self, point: &[f64], here: &[Track]) -> Vec<(Vec<Track>, Vec<Track>, f64)> {
        let solve = |c: &Condition| c.solve(&self.base, &self.unknowns, point).ok().map(|(solve, _)| solve);
        // What costs nothing has slopes of its own.
        let solves: Vec<Option<Node>> =
            self.conditions.iter().map(|c| c.is_homogeneous().then(|| solve(c)).flatten()).collect();
        let along = |axis: usize| {
            let (low, high) = self.unknowns[axis].bounds();
            let step = QUOTIENT * (high - low);
            let shifted = |to: f64| -> Vec<Track> {
                let mut point = point.to_vec();
                point[axis] = to;
                let track = |(at, condition): (usize, &Condition)| match &solves[at] {
                    _ if !condition.rests_on(axis) => None,
                    Some(solve) => Some(condition.track_beside(solve, axis, &point)),
                    None => condition.track(&point),
                };
                let all = self.conditions.iter().enumerate().zip(here);
                all.map(|(condition, here)| track(condition).unwrap_or_else(|| here.clone())).collect()
            };
            let (from, to) = ((point[axis] - step).max(low), (point[axis] + step).min(high));
            (shifted(from), shifted(to), (to - from).max(f64::MIN_POSITIVE))
        };
        (0..self.unknowns.len()).map(along).collect()
    }

    /// Adds a run; `ends` where its contact point stands at an end of its range and absorbs nothing.
    fn add(&self, at: usize, (compared, ends): (&Compared, bool), jacobian: &DMatrix<f64>, sum: &mut Quadratic) {
        let weight = self.weights[at];
        let scale = 1.0 / self.variance_n2(at);
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
                let share = if norm > 0.0 && !ends { column.dot(&contact_weight) / norm } else { 0.0 };
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
    let modelled = modelled(data, track, contact_mm, of);
    let measured = data.force_n.iter().step_by(of);
    let (residual_n, by_contact) = measured.zip(modelled).map(|(n, (model, slope))| (n - model, -slope)).unzip();
    Compared { residual_n, by_contact }
}

/// Modelled forces (N) at the samples.
pub fn forces(data: &LoadingCurve, track: &Track, contact_mm: f64) -> Vec<f64> {
    modelled(data, track, contact_mm, 1).into_iter().map(|(force, _)| force).collect()
}

/// Modelled forces (N) at one of so many samples, and their slopes (N/mm).
fn modelled(data: &LoadingCurve, track: &Track, contact_mm: f64, of: usize) -> Vec<(f64, f64)> {
    let depth_mm: Vec<f64> = data.depth_mm.iter().step_by(of).map(|d| d - contact_mm).collect();
    let mut both = track.ramps(&depth_mm);
    for (at, (force, slope)) in (0..data.depth_mm.len()).step_by(of).zip(&mut both) {
        if at >= data.hold_from {
            let left = track.left(data.time_s[at]);
            (*force, *slope) = (*force * left, *slope * left);
        }
    }
    both
}
