//! The conditions of a specification, with the curves and motions that are solved for them.

use std::sync::Arc;

use lut_gen::solid::model::{Record, Simulation};
use lut_gen::solid::solve::Station;

use super::condition::{Condition, FINE};
use super::coupon::{self, TrueCoupon};
use super::effect::Effect;
use super::effect::machine::Machine;
use super::path::{Path, path};
use super::plan::{Plan, failed, hertz, plans, told};
use super::response::{Elastic, History, Twin};
use super::session::programme;
use super::spec::{RunTemplate, Spec};
use super::{Progress, SimulateError, Solver};

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
