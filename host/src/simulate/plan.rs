//! What has to be solved for a specification: the elastic curves of its templates.

use std::sync::atomic::{AtomicUsize, Ordering};

use lut_gen::solid::model::Simulation;
use lut_gen::solid::solve::SolveError;
use rayon::prelude::*;

use crate::experiment::Test;

use super::body::Body;
use super::check::DEEPEST;
use super::effect::Effect;
use super::effect::machine::Machine;
use super::motion::Programme;
use super::session::programme;
use super::spec::{RunTemplate, Spec};
use super::{Progress, SimulateError};

/// Curves reach this much (mm) and five contact jitters beyond the deepest run, and then to the next multiple of [`ROUND_MM`]: so
/// that specifications share them.
const MARGIN_MM: f64 = 0.05;
const ROUND_MM: f64 = 0.25;

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
