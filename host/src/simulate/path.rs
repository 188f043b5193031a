//! The motions that have to be solved where history counts.

use lut_gen::solid::model::Simulation;
use lut_gen::solid::solve::Motion;

use super::condition::{Condition, FINE};
use super::motion::{Corner, corners, through};
use super::plan::Plan;
use super::response::Timing;
use super::spec::{RunTemplate, Spec};

/// Motions for the finite elements pass within this of the true ones, mm.
const WITHIN_MM: f64 = 0.002;

/// A cycle does not remember the one before when less than this part of the force can be left of it.
const FORGOTTEN: f64 = 1e-3;

/// How far a lifted ball stands above the surface between cycles, mm.
const LIFTED_MM: f64 = 0.05;

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
