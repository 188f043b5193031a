//! Conditions: everything computed once that the runs of one template share.

use std::sync::Arc;

use lut_gen::model::{Record, Simulation};
use lut_gen::solve::Station;

use super::coupon::{self, TrueCoupon};
use super::effect::Effect;
use super::effect::machine::Machine;
use super::motion::Programme;
use super::plan::{Path, Plan, Weighted, failed, hertz, path, plans, told};
use super::response::{Elastic, History, Moment, Phase, Twin};
use super::session::{programme, share};
use super::solver::Curve;
use super::spec::{RunTemplate, Spec};
use super::{Progress, SimulateError, Solver};

/// Steps of the time grid of machine and sensor between two samples.
pub(super) const FINE: usize = 4;

/// What a template's runs share.
#[derive(Debug, Clone)]
pub(super) struct Condition {
    /// Index among the specimens in the order of the specification, if one is touched.
    pub specimen: Option<usize>,
    /// Index among the balls, if one touches it.
    pub indenter: Option<usize>,
    /// The specimen as one that is shortened as a whole.
    pub coupon: Option<TrueCoupon>,
    pub programme: Programme,
    /// Duration of a run, s.
    pub duration_s: f64,
    pub machine: Machine,
    /// Curve of each height: of the specimen, or, where it is tilted, of its lowest and highest spot.
    heights: Vec<(f64, Weighted<Arc<Curve>>)>,
    elastic: Elastic,
    pub history: History,
    /// True depth (mm) of the nominal spot on the fine grid, where time counts.
    pub nominal_mm: Vec<f64>,
    slope: Option<(f64, f64)>,
}

/// One condition a template.
///
/// # Errors
/// Values that do not go together, failing solves.
pub(super) fn conditions(
    spec: &Spec,
    solver: &Solver,
    progress: Progress<'_>,
) -> Result<Vec<Condition>, SimulateError> {
    let plans = plans(spec)?;
    let jobs: Vec<(&str, &Simulation)> = plans
        .iter()
        .flat_map(|p| p.curves.iter().flat_map(|c| c.1.iter().map(|(_, s)| (p.body.place.as_str(), s))))
        .collect();
    told(&jobs, "curves", progress, &|case| solver.curve(case).map(|_| ()))?;
    let mut conditions =
        spec.runs.iter().map(|run| without_ball(spec, run)).collect::<Result<Vec<Condition>, SimulateError>>()?;
    let mut paths = Vec::new();
    for plan in &plans {
        let (condition, path) = pressed(spec, plan, solver)?;
        conditions[plan.template] = condition;
        paths.extend(path.map(|path| (plan, path)));
    }
    solve_motions(&paths, solver, progress)?;
    for (plan, path) in &paths {
        remember(spec, &mut conditions[plan.template], (plan, path), solver)?;
    }
    // where the machine gives way the ball goes another way as the material relaxes
    let yields = |(plan, path): &(&Plan, Path)| {
        path.timing.is_some() && conditions[plan.template].machine.compliance_mm_per_n != 0.0
    };
    let again = paths.iter().filter(|one| yields(one)).map(|(plan, _)| {
        let condition = &conditions[plan.template];
        (*plan, path(spec, plan, &spec.runs[plan.template], condition))
    });
    let again: Vec<(&Plan, Path)> = again.collect();
    solve_motions(&again, solver, progress)?;
    for (plan, path) in &again {
        remember(spec, &mut conditions[plan.template], (plan, path), solver)?;
    }
    Ok(conditions)
}

fn solve_motions(paths: &[(&Plan, Path)], solver: &Solver, progress: Progress<'_>) -> Result<(), SimulateError> {
    let both = |(plan, path): &'_ (&'_ Plan, Path)| {
        let place = plan.body.place.clone();
        [(place.clone(), path.case.clone()), (place, path.twin.clone())]
    };
    let each: Vec<(String, Simulation)> = paths.iter().flat_map(both).collect();
    let jobs: Vec<(&str, &Simulation)> = each.iter().map(|(place, case)| (place.as_str(), case)).collect();
    told(&jobs, "motions", progress, &|case| solver.path(case).map(|_| ()))
}

/// Tells a condition what history makes of the force along its motion.
fn remember(
    spec: &Spec,
    condition: &mut Condition,
    (plan, path): (&Plan, &Path),
    solver: &Solver,
) -> Result<(), SimulateError> {
    let solved = |case: &Simulation| solver.path(case).map_err(|cause| failed(plan, cause));
    let (record, press) = (solved(&path.case)?, solved(&path.twin)?);
    let added = plan.body.interface.adhesion.is_some();
    let curve = condition.heights.first().and_then(|(_, parts)| parts.first()).map(|(_, curve)| curve.clone());
    // a record removes the penalty's softness by a derivative along depth, which says little where the ball turns, and nothing where it creeps while the
    // material relaxes: that of the smooth curve serves for both, but not for a pull before the surface
    let hard = |of: &Record| -> Vec<f64> {
        if added && path.timing.is_none() {
            return of.force_n.clone();
        }
        let force_n = |s: &Station| curve.as_ref().map_or(s.force_n, |curve| curve.hard_n(s.depth_mm, s.force_n));
        of.stations.iter().map(force_n).collect()
    };
    let twin = Twin::of(&press, &hard(&press));
    let elastic = |depth_mm: f64| twin.at(depth_mm);
    if path.timing.is_some() {
        condition.nominal_mm = condition.trajectory(1.0 / (spec.sample_hz * FINE as f64));
    }
    condition.history = match path.timing {
        Some(timing) => History::timed(&record, &hard(&record), &elastic, added, timing),
        None => History::branches(&record, &hard(&record), &elastic, added),
    };
    Ok(())
}

/// A run that no ball has a part in, or the beginning of one that will have one.
fn without_ball(spec: &Spec, run: &RunTemplate) -> Result<Condition, SimulateError> {
    let mut condition = untouched(spec, run);
    if coupon::mode(run.test).is_none() {
        return Ok(condition);
    }
    let at = spec.specimens.iter().position(|one| Some(&one.name) == run.specimen.as_ref());
    condition.machine = Machine::of(&spec.effects);
    condition.programme = programme(run, run.depth_mm);
    condition.duration_s = condition.programme.duration_s();
    let own = at.map(|at| TrueCoupon::new(spec, &spec.specimens[at], run, &condition.machine)).transpose()?;
    (condition.specimen, condition.coupon) = (at, own);
    Ok(condition)
}

/// A run that touches nothing.
fn untouched(spec: &Spec, run: &RunTemplate) -> Condition {
    Condition {
        specimen: None,
        indenter: None,
        coupon: None,
        programme: programme(run, 0.0),
        duration_s: run.hold_s,
        machine: Machine::default(),
        heights: Vec::new(),
        elastic: Elastic {
            parts: Vec::new(),
            scale: 1.0,
            hertz: 0.0,
            radius_mm: 1.0,
            cosine: 1.0,
            effects: Arc::new(spec.effects.clone()),
        },
        history: History::None,
        nominal_mm: Vec::new(),
        slope: None,
    }
}

fn pressed(spec: &Spec, plan: &Plan, solver: &Solver) -> Result<(Condition, Option<Path>), SimulateError> {
    let mut heights = Vec::new();
    for (height, cases) in &plan.curves {
        let curve = |(weight, case): &(f64, Simulation)| {
            Ok((*weight, solver.curve(case).map_err(|cause| failed(plan, cause))?))
        };
        heights.push((*height, cases.iter().map(curve).collect::<Result<Vec<_>, SimulateError>>()?));
    }
    let slope = spec.effects.iter().find_map(|effect| match effect {
        Effect::Tilt { angle_deg, distance_mm } => Some((angle_deg.to_radians(), *distance_mm)),
        _ => None,
    });
    let run = &spec.runs[plan.template];
    let condition = Condition {
        specimen: Some(plan.pair.0),
        indenter: Some(plan.pair.1),
        coupon: None,
        programme: plan.programme,
        duration_s: plan.programme.duration_s(),
        machine: Machine::of(&spec.effects),
        elastic: Elastic {
            parts: heights.first().map(|(_, parts)| parts.clone()).unwrap_or_default(),
            scale: plan.body.scale,
            hertz: hertz(&plan.body),
            radius_mm: plan.body.ball.radius_mm,
            cosine: slope.map_or(1.0, |(angle, _)| angle.cos()),
            effects: Arc::new(spec.effects.clone()),
        },
        heights,
        history: History::None,
        nominal_mm: Vec::new(),
        slope,
    };
    let path = plan.body.has_history().then(|| path(spec, plan, run, &condition));
    Ok((condition, path))
}

impl Condition {
    /// Elastic response of the spot of a number (from 0).
    pub fn spot(&self, replicate: usize) -> Elastic {
        let mut elastic = self.elastic.clone();
        if let (Some((angle, distance_mm)), [_, low, high]) = (self.slope, self.heights.as_slice()) {
            let higher = distance_mm * share(replicate) * angle.tan();
            let part = (0.5 * (low.0 + high.0) + higher - low.0) / (high.0 - low.0);
            elastic.parts = low.1.iter().map(|(w, c)| (w * (1.0 - part), c.clone())).collect();
            elastic.parts.extend(high.1.iter().map(|(w, c)| (w * part, c.clone())));
        }
        elastic
    }

    /// Recorded depth (mm) every `step_s`.
    pub fn recorded(&self, step_s: f64) -> Vec<f64> {
        let count = (self.duration_s / step_s + 1e-9) as usize + 1;
        (0..count).map(|k| self.programme.depth_at(step_s * k as f64)).collect()
    }

    /// True depth (mm) every `step_s` of a nominal spot, with the force in the machine's compliance that history is known to make.
    pub fn trajectory(&self, step_s: f64) -> Vec<f64> {
        let driven = self.machine.driven(&self.recorded(step_s), step_s);
        if self.machine.compliance_mm_per_n == 0.0 {
            return driven;
        }
        let one = |(k, z): (usize, &f64)| {
            let mut moment = self.moment(step_s * k as f64, *z, *z, 1);
            moment.nominal_mm = self.nominal_mm.get(k).copied().unwrap_or(*z);
            self.pressed(&self.history, &self.elastic, moment).0
        };
        driven.iter().enumerate().map(one).collect()
    }

    /// A moment of a run at a time (s), where the machine drives the ball to `depth_mm` from a largest depth of `peak_mm`.
    pub fn moment(&self, time_s: f64, depth_mm: f64, peak_mm: f64, cycle: usize) -> Moment {
        let end_s = self.programme.down_s();
        let start_s = end_s + self.programme.hold_s;
        let phase = if time_s <= end_s {
            Phase::Down { end_s }
        } else if time_s <= start_s || !self.programme.unload {
            Phase::Hold
        } else {
            Phase::Back { start_s }
        };
        let rate_mm_s = self.programme.rate_mm_s;
        Moment {
            time_s,
            depth_mm,
            nominal_mm: depth_mm,
            rate_mm_s,
            phase,
            peak_mm,
            before_mm: 0.0,
            back: false,
            cycle,
            memory: 1.0,
        }
    }

    /// True depth (mm) and force (N) where the machine drives the ball to `at.depth_mm`: `y + c F(y) = z` by Newton's method.
    pub fn pressed(&self, history: &History, elastic: &Elastic, at: Moment) -> (f64, f64) {
        let compliance = self.machine.compliance_mm_per_n;
        let wanted = at.depth_mm;
        let mut moment = at;
        let (mut force, mut slope) = history.force_n(elastic, &moment);
        if compliance == 0.0 || wanted <= 0.0 {
            return (wanted, force);
        }
        let (mut low, mut high) = (0.0, wanted);
        for _ in 0..ITERATIONS {
            let miss = moment.depth_mm + compliance * force - wanted;
            if miss.abs() < 1e-10 {
                break;
            }
            if miss > 0.0 {
                high = moment.depth_mm;
            } else {
                low = moment.depth_mm;
            }
            let next = moment.depth_mm - miss / (1.0 + compliance * slope.max(0.0));
            moment.depth_mm = if next > low && next < high { next } else { 0.5 * (low + high) };
            (force, slope) = history.force_n(elastic, &moment);
        }
        (moment.depth_mm, force)
    }
}

const ITERATIONS: usize = 50;
