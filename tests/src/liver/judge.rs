//! Profile likelihood by a search of its own: least squares over all seven unknowns, the contact point among them, on a table of solves.
//!
//! The profile of a parameter is walked in even steps from the best point to either side, every step from several starts.

use nalgebra::{DMatrix, DVector};
use palpate::experiment::Experiment;
use palpate::identify::newton::coordinate::Unknown;
use palpate::identify::newton::problem::forces as modelled;
use palpate::identify::newton::table::Table;
use palpate::identify::newton::track::Track;
use palpate::infer::covariance::standard_errors;
use palpate::infer::descent::{Region, Residuals, Rule, minimise};
use palpate::infer::starts::{descend_from, filling};
use rayon::prelude::*;

use super::table::{problem, selection};
use super::{AIR_MM, TRUTH};

/// 95 % quantile of chi-squared with one degree of freedom.
const RISE: f64 = 3.841_458_820_694_124;
/// Steps of a walk: halves of a standard error, at most a sixteenth of the range.
const STEP_OF_ERROR: f64 = 0.5;
const STEP_OF_RANGE: f64 = 1.0 / 16.0;
/// Starts of the first search besides the truth, and of every step of a walk besides the last one's end.
const STARTS: usize = 6;
const OTHERS: usize = 2;
/// Relative accuracy of the objective: a thousandth of what ends an interval at the 500 or so of a fit.
const RULE: Rule = Rule { most_steps: 40, settled: 1e-3, settled_share: 0.0, rival: None };

/// One parameter's profile.
#[derive(Debug, Clone, PartialEq)]
pub struct Profile {
    /// 95 % interval, in the parameter's unit.
    pub interval: (f64, f64),
    /// The data close it below and above.
    pub closed: (bool, bool),
    /// Narrow against what it could be, by the rule a fit judges with: a factor of 3, or half of the range.
    pub narrow: bool,
}

impl Profile {
    /// True where the profile is closed on both sides, and narrow.
    #[must_use]
    pub fn identifies(&self) -> bool {
        self.closed.0 && self.closed.1 && self.narrow
    }
}

/// Profiles of all six parameters, in the order of [`TRUTH`]'s names.
#[must_use]
pub fn profiles(experiment: &Experiment, table: &Table) -> Vec<Profile> {
    let selection = selection(experiment);
    let problem = problem(experiment, &selection);
    let unknowns = &problem.unknowns;
    let (Some(data), Some(condition)) = (selection.curves.first(), problem.conditions.first()) else {
        return Vec::new();
    };
    let contact = unknowns.len();
    let predicted = |x: &[f64]| -> DVector<f64> {
        let local: Vec<f64> = condition.locals.iter().map(|at| x[*at]).collect();
        let track =
            Track::new(table.depth_mm, table.hold_s, &table.at(&local).unwrap_or_default(), x[condition.modulus]);
        DVector::from_vec(modelled(data, &track, x[contact]))
    };
    let measured = DVector::from_column_slice(&data.force_n);
    let mut ends: Vec<(f64, f64)> = unknowns.iter().map(Unknown::bounds).collect();
    ends.push((data.contact.low_mm, data.contact.high_mm));
    let region = Region::of(ends);
    // The scatter is that of what the best point leaves over; until then any unit serves.
    let (forces, box_of, prediction) = (&measured, &region, &predicted);
    let search = |unit: f64| Residuals {
        residual: move |x: &[f64]| (forces - prediction(x)) / unit,
        jacobian: move |x: &[f64], _: &DVector<f64>| slopes(x, box_of, unit, prediction),
    };
    let mut truth: Vec<f64> = TRUTH
        .named()
        .iter()
        .filter_map(|(name, value)| unknowns.iter().find(|u| u.name == *name).map(|u| u.coordinate(*value)))
        .collect();
    truth.push(AIR_MM);
    let mut starts = filling(&region, STARTS);
    // What scales the force, where it begins and how it relaxes are read off the recording well enough: the starts differ in the rest.
    for start in &mut starts {
        for at in [condition.modulus, contact] {
            start[at] = truth[at];
        }
    }
    starts.push(truth);
    let peak = measured.max();
    let Some(first) = descend_from(&search(0.01 * peak), &region, &starts, &RULE).into_iter().next() else {
        return Vec::new();
    };
    let freedom = (measured.len() - region.low.len()) as f64;
    let unit = 0.01 * peak * (first.value / freedom).sqrt();
    let objective = search(unit);
    let best = minimise(&objective, &region, &first.x, &Rule::default());
    let errors = standard_errors(&best.at.hessian);
    let walk = |axis: usize, sign: f64| -> (f64, bool) {
        let bound = if sign < 0.0 { region.low[axis] } else { region.high[axis] };
        let range = region.high[axis] - region.low[axis];
        let step = (STEP_OF_ERROR * errors[axis]).min(STEP_OF_RANGE * range).max(1e-4 * range);
        let (mut at, mut from, mut before) = (best.x[axis], best.x.clone(), 0.0);
        loop {
            let next = if sign < 0.0 { (at - step).max(bound) } else { (at + step).min(bound) };
            let held = Region { held: Some(axis), ..region.clone() };
            let mut starts = vec![from.clone()];
            // Another branch of the valley is sought from elsewhere.
            starts.extend(filling(&region, OTHERS).into_iter().map(|other| {
                let mut start = best.x.clone();
                for i in 0..start.len() {
                    if errors[i] > STEP_OF_RANGE * (region.high[i] - region.low[i]) {
                        start[i] = other[i];
                    }
                }
                start
            }));
            starts.iter_mut().for_each(|start| start[axis] = next);
            let ends = starts.iter().map(|start| minimise(&objective, &held, start, &RULE));
            let Some(end) = ends.min_by(|a, b| a.value.total_cmp(&b.value)) else { return (at, false) };
            let rose = (end.value - best.value).max(0.0).sqrt();
            let limit = RISE.sqrt();
            if rose >= limit {
                let share = if rose > before { (limit - before) / (rose - before) } else { 1.0 };
                return (at + share * (next - at), true);
            }
            if next == bound {
                return (bound, false);
            }
            (at, from, before) = (next, end.x, rose);
        }
    };
    let jobs: Vec<(usize, f64)> = (0..unknowns.len()).flat_map(|axis| [(axis, -1.0), (axis, 1.0)]).collect();
    let walked: Vec<(f64, bool)> = jobs.par_iter().map(|(axis, sign)| walk(*axis, *sign)).collect();
    walked
        .chunks(2)
        .zip(unknowns)
        .map(|(pair, unknown)| {
            let (low, high) = (pair[0].0, pair[1].0);
            let (from, to) = unknown.bounds();
            let narrow =
                if unknown.is_logarithmic() { high - low <= 3.0_f64.ln() } else { high - low <= 0.5 * (to - from) };
            Profile { interval: (unknown.value(low), unknown.value(high)), closed: (pair[0].1, pair[1].1), narrow }
        })
        .collect()
}

/// Derivative of the prediction over a unit, by one-sided quotients towards the inside.
fn slopes(x: &[f64], region: &Region, unit: f64, predicted: &impl Fn(&[f64]) -> DVector<f64>) -> DMatrix<f64> {
    let here = predicted(x);
    let columns: Vec<DVector<f64>> = (0..x.len())
        .map(|axis| {
            let size = 1e-6 * (region.high[axis] - region.low[axis]);
            let step = if x[axis] + size > region.high[axis] { -size } else { size };
            let mut moved = x.to_vec();
            moved[axis] += step;
            (predicted(&moved) - &here) / (step * unit)
        })
        .collect();
    DMatrix::from_columns(&columns)
}
