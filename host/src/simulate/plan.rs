//! What has to be solved for a specification: the elastic curves and the motions of its templates.

use std::sync::atomic::{AtomicUsize, Ordering};

use lut_gen::model::Simulation;
use lut_gen::solve::{Motion, SolveError};
use rayon::prelude::*;

use crate::experiment::Test;

use super::body::Body;
use super::check::DEEPEST;
use super::condition::{Condition, FINE};
use super::effect::Effect;
use super::effect::machine::Machine;
use super::motion::{Corner, Programme, corners, through};
use super::response::Timing;
use super::session::programme;
use super::spec::{RunTemplate, Spec};
use super::{Progress, SimulateError};

/// Curves reach this much (mm) and five contact jitters beyond the deepest run, and then to the next multiple of [`ROUND_MM`]: so
/// that specifications share them.
const MARGIN_MM: f64 = 0.05;
const ROUND_MM: f64 = 0.25;

/// Motions for the finite elements pass within this of the true ones, mm.
const WITHIN_MM: f64 = 0.002;

/// A cycle does not remember the one before when less than this part of the force can be left of it.
const FORGOTTEN: f64 = 1e-3;

/// How far a lifted ball stands above the surface between cycles, mm.
const LIFTED_MM: f64 = 0.05;

/// Things with the weights of an interpolation.
pub(super) type Weighted<T> = Vec<(f64, T)>;

/// The distinct elastic solves of a condition: heights, and exponents with weights.
pub(super) type Curves = Vec<(f64, Weighted<Simulation>)>;

/// A template that touches a specimen, before its solves.
pub(super) struct Plan {
    pub template: usize,
    pub pair: (usize, usize),
    pub body: Body,
    pub programme: Programme,
    pub curves: Curves,
}

/// Solves the distinct ones of the cases in parallel.
pub(super) fn told(
    jobs: &[(&str, &Simulation)],
    what: &str,
    progress: Progress<'_>,
    solve: &(dyn Fn(&Simulation) -> Result<(), SolveError> + Sync),
) -> Result<(), SimulateError> {
    let mut distinct: Vec<(&str, &Simulation)> = Vec::new();
    for job in jobs {
        if !distinct.iter().any(|other| other.1 == job.1) {
            distinct.push(*job);
        }
    }
    let done = AtomicUsize::new(0);
    let outcomes: Vec<Result<(), SimulateError>> = distinct
        .par_iter()
        .map(|(place, case)| {
            let outcome = solve(case).map_err(|cause| SimulateError::Solve { place: (*place).to_owned(), cause });
            progress(what, done.fetch_add(1, Ordering::Relaxed) + 1, distinct.len());
            outcome
        })
        .collect();
    outcomes.into_iter().collect()
}

pub(super) fn failed(plan: &Plan, cause: SolveError) -> SimulateError {
    SimulateError::Solve { place: plan.body.place.clone(), cause }
}

/// Deepest the ball can be driven in the runs of a pair (mm), contact jitter included.
fn deepest_mm(spec: &Spec, run: &RunTemplate, machine: &Machine) -> f64 {
    run.depth_mm + machine.offset_mm + MARGIN_MM + 5.0 * spec.noise.contact_jitter_mm
}

pub(super) fn plans(spec: &Spec) -> Result<Vec<Plan>, SimulateError> {
    let machine = Machine::of(&spec.effects);
    let mut plans = Vec::new();
    for (template, run) in spec.runs.iter().enumerate().filter(|(_, run)| run.test == Test::Indentation) {
        let at = |name: &Option<String>, names: Vec<&String>| names.iter().position(|n| Some(*n) == name.as_ref());
        let specimen = at(&run.specimen, spec.specimens.iter().map(|s| &s.name).collect());
        let indenter = at(&run.indenter, spec.indenters.iter().map(|s| &s.name).collect());
        let (Some(specimen), Some(indenter)) = (specimen, indenter) else { continue };
        let body = Body::new(spec, &spec.specimens[specimen], &spec.indenters[indenter])?;
        let same = |other: &&RunTemplate| (&other.specimen, &other.indenter) == (&run.specimen, &run.indenter);
        let deepest = spec.runs.iter().filter(same).map(|one| deepest_mm(spec, one, &machine)).fold(0.0, f64::max);
        let mut peak_mm = run.depth_mm;
        let mut curves = Vec::new();
        if body.rigid_mpa.is_some() {
            let hertz = hertz(&body);
            peak_mm =
                (run.load_n / hertz).powf(2.0 / 3.0) + machine.compliance_mm_per_n * run.load_n - machine.offset_mm;
            positive(template, peak_mm)?;
        } else {
            curves = cases(spec, &body, deepest)?;
        }
        plans.push(Plan { template, pair: (specimen, indenter), body, programme: programme(run, peak_mm), curves });
    }
    Ok(plans)
}

fn positive(template: usize, peak_mm: f64) -> Result<(), SimulateError> {
    if peak_mm > 0.0 {
        return Ok(());
    }
    Err(SimulateError::Value {
        place: format!("[[run]] {}", template + 1),
        key: "largest recorded depth (mm) on the rigid block",
        value: peak_mm,
        expected: "more than 0: the contact offset must be smaller than what load_N presses in".to_owned(),
    })
}

/// Hertz's factor (N/mm^1.5) on a rigid block.
pub(super) fn hertz(body: &Body) -> f64 {
    body.rigid_mpa.map_or(0.0, |modulus| 4.0 / 3.0 * modulus * body.ball.radius_mm.sqrt())
}

fn cases(spec: &Spec, body: &Body, deepest_mm: f64) -> Result<Curves, SimulateError> {
    let height = body.block.height_mm;
    let spread = spec.effects.iter().find_map(|effect| match effect {
        Effect::Tilt { angle_deg, distance_mm } => Some((distance_mm * angle_deg.to_radians().tan()).abs()),
        _ => None,
    });
    let heights = match spread {
        Some(spread) if spread > 0.0 => vec![height, height - spread, height + spread],
        _ => vec![height],
    };
    let lowest = heights.iter().copied().fold(f64::INFINITY, f64::min);
    if deepest_mm > DEEPEST * lowest {
        return Err(SimulateError::Value {
            place: body.place.clone(),
            key: "depth_mm with offset and jitter",
            value: deepest_mm,
            expected: format!("at most {} mm, 90 % of the true height", DEEPEST * lowest),
        });
    }
    let reach = ((deepest_mm / ROUND_MM).ceil() * ROUND_MM).min(0.94 * lowest);
    let alphas = match body.coarse_alpha {
        Some(neighbours) => neighbours.iter().map(|(alpha, weight)| (*weight, Some(*alpha))).collect(),
        None => vec![(1.0, None)],
    };
    heights
        .into_iter()
        .map(|h| {
            let one = |(weight, alpha): &(f64, Option<f64>)| Ok((*weight, body.elastic(reach, *alpha, h)?));
            Ok((h, alphas.iter().filter(|(weight, _)| *weight > 0.0).map(one).collect::<Result<_, SimulateError>>()?))
        })
        .collect()
}

/// Places in a hold in which the ball moves because the machine gives way: the force relaxes faster than the ball goes on.
const IN_HOLD: usize = 24;

/// Corners with others in the hold, where the machine gives way: closer together where it begins.
fn with_hold(mut corners: Vec<Corner>, all: &[Corner], condition: &Condition) -> Vec<Corner> {
    let (down_s, hold_s) = (condition.programme.down_s(), condition.programme.hold_s);
    if condition.machine.compliance_mm_per_n == 0.0 || hold_s <= 0.0 {
        return corners;
    }
    let place = |k: usize| down_s + hold_s * (k as f64 / IN_HOLD as f64).powi(3);
    corners.extend((0..=IN_HOLD).filter_map(|k| all.get(all.partition_point(|c| c.0 < place(k)))));
    corners.sort_by(|a, b| a.0.total_cmp(&b.0));
    corners.dedup_by(|b, a| b.0 <= a.0);
    corners
}

/// A motion to be solved, with the elastic press that it is compared with; its timing when time counts.
pub(super) struct Path {
    pub case: Simulation,
    pub twin: Simulation,
    pub timing: Option<Timing>,
}

/// The motion of the nominal spot, as far as it is known what history makes of the force on a machine that gives way.
pub(super) fn path(spec: &Spec, plan: &Plan, run: &RunTemplate, condition: &Condition) -> Path {
    let body = &plan.body;
    let adhesion = body.interface.adhesion.map_or(0.0, |a| (4.0 * a.range_mm).max(LIFTED_MM));
    let peak = run.depth_mm + condition.machine.offset_mm;
    let twin = body.twin(peak);
    if body.material.prony.is_empty() {
        let away = adhesion.max(run.air_mm - condition.machine.offset_mm);
        let mut motion = Motion { start_mm: -adhesion, segments: Vec::new() }.to_depth(peak, 1.0);
        if run.unload || run.cycles > 1 {
            motion = motion.to_depth(-away.max(0.0), 1.0);
        }
        if run.cycles > 1 && body.material.softening.is_some() {
            motion = motion.to_depth(peak, 1.0).to_depth(-away.max(0.0), 1.0);
        }
        return Path { case: body.along(motion), twin, timing: None };
    }
    let step_s = 1.0 / (spec.sample_hz * FINE as f64);
    let driven = condition.trajectory(step_s);
    let once: Vec<Corner> = driven.iter().enumerate().map(|(k, d)| (step_s * k as f64, *d)).collect();
    let once = with_hold(corners(&once, WITHIN_MM), &once, condition);
    let period_s = condition.duration_s + run.rest_s;
    let remembers = body.material.prony.iter().any(|t| t.g * (-run.rest_s / t.tau_s).exp() > FORGOTTEN)
        || body.material.softening.is_some();
    let cycles = if remembers { run.cycles } else { 1 };
    let mut all = once.clone();
    for cycle in 1..cycles {
        let start = period_s * cycle as f64;
        let lifted = -LIFTED_MM.max(adhesion);
        let away = (start - run.rest_s).max(0.0) + 0.01 * run.rest_s;
        all.extend([(away, lifted), (start - 0.01 * run.rest_s, lifted)]);
        all.extend(once.iter().map(|(t, d)| (start + t, *d)));
    }
    let (motion, begin_s) = through(&all, 2.0 * WITHIN_MM, run.rate_mm_s);
    Path { case: body.along(motion), twin, timing: Some(Timing { start_s: -begin_s, period_s, cycles }) }
}
