//! Conditions: everything computed once that the runs of one template share.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use lut_gen::model::Simulation;
use lut_gen::solve::Motion;
use rayon::prelude::*;

use crate::experiment::Test;

use super::body::Body;
use super::check::DEEPEST;
use super::effect::Effect;
use super::effect::machine::Machine;
use super::motion::{Corner, Programme, corners, through};
use super::response::{Elastic, History, Moment, Timing};
use super::session::programme;
use super::solver::Curve;
use super::spec::{RunTemplate, Spec};
use super::{Progress, SimulateError, Solver};

/// Steps of the time grid of machine and sensor between two samples.
pub(super) const FINE: usize = 4;

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

/// What a template's runs share.
#[derive(Debug, Clone)]
pub(super) struct Condition {
    /// Indices among the declared specimens and balls in the order of the specification.
    pub pair: Option<(usize, usize)>,
    pub programme: Programme,
    /// Duration of a run, s.
    pub duration_s: f64,
    pub machine: Machine,
    /// Curve of each height: of the specimen, or, where it is tilted, of its lowest and highest spot.
    heights: Vec<(f64, Weighted<Arc<Curve>>)>,
    elastic: Elastic,
    pub history: History,
    slope: Option<(f64, f64)>,
}

/// Things with the weights of an interpolation.
type Weighted<T> = Vec<(f64, T)>;

/// The distinct elastic solves of a condition: heights, and exponents with weights.
type Curves = Vec<(f64, Weighted<Simulation>)>;

/// A template that touches a specimen, before its solves.
struct Plan {
    template: usize,
    pair: (usize, usize),
    body: Body,
    programme: Programme,
    curves: Curves,
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
    let mut conditions: Vec<Condition> = spec.runs.iter().map(|run| untouched(spec, run)).collect();
    let mut paths = Vec::new();
    for plan in &plans {
        let (condition, path) = pressed(spec, plan, solver)?;
        conditions[plan.template] = condition;
        paths.extend(path.map(|path| (plan, path)));
    }
    let jobs: Vec<(&str, &Simulation)> =
        paths.iter().map(|(plan, path)| (plan.body.place.as_str(), &path.case)).collect();
    told(&jobs, "motions", progress, &|case| solver.path(case).map(|_| ()))?;
    for (plan, path) in &paths {
        let record = solver.path(&path.case).map_err(|cause| failed(plan, cause))?;
        let condition = &mut conditions[plan.template];
        let unit = Elastic {
            parts: condition.heights[0].1.clone(),
            scale: 1.0,
            hertz: 0.0,
            cosine: 1.0,
            radius_mm: plan.body.ball.radius_mm,
            effects: Arc::new(Vec::new()),
        };
        let elastic = |depth: f64| unit.at(depth).0;
        let added = plan.body.interface.adhesion.is_some();
        condition.history = match (path.timing, unit.parts.first()) {
            (Some(timing), Some((_, curve))) => History::timed(&record, curve, &elastic, added, timing),
            _ => History::branches(&record, &elastic, added),
        };
    }
    Ok(conditions)
}

/// Solves the distinct ones of the cases in parallel.
fn told(
    jobs: &[(&str, &Simulation)],
    what: &str,
    progress: Progress<'_>,
    solve: &(dyn Fn(&Simulation) -> Result<(), lut_gen::solve::SolveError> + Sync),
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

fn failed(plan: &Plan, cause: lut_gen::solve::SolveError) -> SimulateError {
    SimulateError::Solve { place: plan.body.place.clone(), cause }
}

/// Deepest the ball can be driven in the runs of a pair (mm), contact jitter included.
fn deepest_mm(spec: &Spec, run: &RunTemplate, machine: &Machine) -> f64 {
    run.depth_mm + machine.offset_mm + MARGIN_MM + 5.0 * spec.noise.contact_jitter_mm
}

fn plans(spec: &Spec) -> Result<Vec<Plan>, SimulateError> {
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
fn hertz(body: &Body) -> f64 {
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

/// A run that touches nothing.
fn untouched(spec: &Spec, run: &RunTemplate) -> Condition {
    Condition {
        pair: None,
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
        slope: None,
    }
}

/// A motion to be solved; its timing when time counts.
struct Path {
    case: Simulation,
    timing: Option<Timing>,
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
        pair: Some(plan.pair),
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
        slope,
    };
    let path = plan.body.has_history().then(|| path(spec, plan, run, &condition));
    Ok((condition, path))
}

fn path(spec: &Spec, plan: &Plan, run: &RunTemplate, condition: &Condition) -> Path {
    let body = &plan.body;
    let adhesion = body.interface.adhesion.map_or(0.0, |a| (4.0 * a.range_mm).max(LIFTED_MM));
    if body.material.prony.is_empty() {
        let peak = run.depth_mm + condition.machine.offset_mm;
        let away = adhesion.max(run.air_mm - condition.machine.offset_mm);
        let mut motion = Motion { start_mm: -adhesion, segments: Vec::new() }.to_depth(peak, 1.0);
        if run.unload || run.cycles > 1 {
            motion = motion.to_depth(-away.max(0.0), 1.0);
        }
        if run.cycles > 1 && body.material.softening.is_some() {
            motion = motion.to_depth(peak, 1.0).to_depth(-away.max(0.0), 1.0);
        }
        return Path { case: body.along(motion), timing: None };
    }
    let step_s = 1.0 / (spec.sample_hz * FINE as f64);
    let driven = condition.trajectory(step_s);
    let once: Vec<Corner> = driven.iter().enumerate().map(|(k, d)| (step_s * k as f64, *d)).collect();
    let once = corners(&once, WITHIN_MM);
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
    Path { case: body.along(motion), timing: Some(Timing { start_s: -begin_s, period_s, cycles }) }
}

impl Condition {
    /// Elastic response of the spot of a number (from 0).
    pub fn spot(&self, replicate: usize) -> Elastic {
        let mut elastic = self.elastic.clone();
        if let (Some((angle, distance_mm)), [_, low, high]) = (self.slope, self.heights.as_slice()) {
            // left, right, half left, half right, ...
            let side = if replicate.is_multiple_of(2) { -1.0 } else { 1.0 };
            let place = side * distance_mm * angle.tan() / (1 + replicate / 2) as f64;
            let part = (0.5 * (low.0 + high.0) + place - low.0) / (high.0 - low.0);
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

    /// True depth (mm) every `step_s` of a nominal spot, with the elastic force in the machine's compliance.
    fn trajectory(&self, step_s: f64) -> Vec<f64> {
        let driven = self.machine.driven(&self.recorded(step_s), step_s);
        if self.machine.compliance_mm_per_n == 0.0 {
            return driven;
        }
        let mut peak = 0.0_f64;
        driven
            .iter()
            .map(|z| {
                let moment = Moment { time_s: 0.0, depth_mm: *z, peak_mm: peak, back: false, cycle: 1 };
                let (depth, _) = self.pressed(&History::None, &self.elastic, moment);
                peak = peak.max(depth);
                depth
            })
            .collect()
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
