//! From conditions to recordings: every visit's true forces, then the sensor's readings in the order of the session.

use rand::Rng;

use crate::experiment::Test;

use super::SimulateError;
use super::chance::{Purpose, stream};
use super::condition::{Condition, FINE};
use super::coupon;
use super::effect::placebo::{self, Place};
use super::effect::process::{Instant, Press, Rests, Span};
use super::effect::range::Range;
use super::effect::scales::Scales;
use super::effect::sensor::Sensor;
use super::effect::{Effect, outside};
use super::folder::SimulatedRun;
use super::noise::{Correlated, Wander};
use super::session::{Visit, visits};
use super::spec::Spec;

/// Digits that are written: times and depths to 1e-6 (s, mm), forces to 1e-7 N.
const TIMES: f64 = 1e6;
const FORCES: f64 = 1e7;

fn rounded(value: f64, per_unit: f64) -> f64 {
    // adding zero turns a negative zero into a positive one
    (value * per_unit).round() / per_unit + 0.0
}

/// A run before the sensor, on the fine time grid.
#[derive(Clone)]
struct Raw {
    recorded_mm: Vec<f64>,
    force_n: Vec<f64>,
}

/// All runs in the order of the session.
///
/// # Errors
/// A coupon that fails.
pub(super) fn runs(spec: &Spec, conditions: &[Condition]) -> Result<Vec<SimulatedRun>, SimulateError> {
    let durations: Vec<f64> = conditions.iter().map(|one| one.duration_s).collect();
    let visits = visits(spec, &durations);
    let step_s = 1.0 / (spec.sample_hz * FINE as f64);
    let ranges = Ranges::of(spec, conditions, &visits);
    let wander = Wander::new(spec, ranges.session_s);
    let mut sensor = Sensor::of(&spec.effects);
    let mut out: Vec<SimulatedRun> = Vec::new();
    for visit in &visits {
        let condition = &conditions[visit.template];
        let raws = pressed(spec, condition, visit, step_s)?;
        for (at, (raw, start_s)) in raws.iter().zip(&visit.starts_s).enumerate() {
            let order = out.len() + 1;
            let mut run = labelled(spec, condition, visit, at, order, *start_s);
            let reading = sensor.read(&raw.force_n, *start_s, step_s);
            sampled(spec, condition, &ranges, raw, &reading, &mut run);
            noisy(spec, &wander, order, &mut run);
            out.push(run);
        }
    }
    Ok(out)
}

/// Forces of all runs of a visit.
fn pressed(spec: &Spec, condition: &Condition, visit: &Visit, step_s: f64) -> Result<Vec<Raw>, SimulateError> {
    let template = &spec.runs[visit.template];
    if condition.specimen.is_none() {
        let count = (condition.duration_s / step_s + 1e-9) as usize + 1;
        let load = if template.test == Test::Mass { template.load_n } else { 0.0 };
        let raw = Raw { recorded_mm: Vec::new(), force_n: vec![load; count] };
        return Ok(vec![raw; template.cycles]);
    }
    if let Some(coupon) = &condition.coupon {
        let recorded = condition.recorded(step_s);
        let mut driven = condition.machine.driven(&recorded, step_s);
        driven.iter_mut().for_each(|d| *d += visit.jitter_mm);
        let forces = coupon.pressed(spec, visit, (&driven, step_s), condition.machine.compliance_mm_per_n)?;
        return Ok(forces.into_iter().map(|force_n| Raw { recorded_mm: recorded.clone(), force_n }).collect());
    }
    let elastic = condition.spot(visit.replicate);
    let mut recorded = condition.recorded(step_s);
    let mut driven = condition.machine.driven(&recorded, step_s);
    if elastic.hertz > 0.0 {
        // a stiff block is pressed to its load, wherever its surface is: the depth that is recorded then scatters
        recorded.iter_mut().for_each(|d| *d -= visit.jitter_mm);
    } else {
        driven.iter_mut().for_each(|d| *d += visit.jitter_mm);
    }
    let highest = driven.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let turn = driven.iter().rposition(|d| *d >= highest - 1e-9).unwrap_or(0);
    let mut forces = Vec::new();
    let mut before_mm = 0.0_f64;
    for cycle in 1..=template.cycles {
        let (set_mm, after_mm) = outside::set_mm(&spec.effects, cycle, highest);
        let mut peak_mm = 0.0_f64;
        let mut run = Vec::with_capacity(driven.len());
        for (k, &driven_mm) in driven.iter().enumerate() {
            let back = template.unload && k > turn;
            // the set of a cycle appears in proportion to the way back
            let way = if back { ((highest - driven_mm) / highest.max(1e-9)).clamp(0.0, 1.0) } else { 0.0 };
            let depth_mm = driven_mm - set_mm - (after_mm - set_mm) * way;
            let mut moment = condition.moment(step_s * k as f64, depth_mm, peak_mm, cycle);
            moment.back = back;
            moment.memory = visit.memory;
            moment.before_mm = before_mm;
            moment.nominal_mm = condition.nominal_mm.get(k).copied().unwrap_or(depth_mm);
            let (depth_mm, force_n) = condition.pressed(&condition.history, &elastic, moment);
            peak_mm = peak_mm.max(depth_mm);
            run.push(force_n * visit.gain);
        }
        before_mm = before_mm.max(peak_mm);
        forces.push(run);
    }
    outside::relaxed_by_power(&spec.effects, &mut forces, &visit.starts_s, step_s);
    Ok(forces.into_iter().map(|force_n| Raw { recorded_mm: recorded.clone(), force_n }).collect())
}

/// A run with its labels and no samples.
fn labelled(spec: &Spec, condition: &Condition, visit: &Visit, at: usize, order: usize, start_s: f64) -> SimulatedRun {
    let template = &spec.runs[visit.template];
    let cycle = at + 1;
    let plain = |name: &str| -> String {
        name.chars().map(|c| if c.is_ascii_alphanumeric() || "-_.".contains(c) { c } else { '_' }).collect()
    };
    let place = |names: Vec<&str>, index: usize| names.iter().filter(|name| **name < names[index]).count();
    let specimens = || spec.specimens.iter().map(|one| one.name.as_str()).collect::<Vec<_>>();
    let indenters = || spec.indenters.iter().map(|one| one.name.as_str()).collect::<Vec<_>>();
    let by = condition.indenter.map(|at| plain(&spec.indenters[at].name));
    let by = by.or_else(|| coupon::mode(template.test).map(|mode| mode.to_string()));
    let file = match condition.specimen.zip(by) {
        Some((specimen, by)) => format!(
            "{order:03}-{}-{by}-v{}-s{}-c{cycle}.csv",
            plain(&spec.specimens[specimen].name),
            template.rate_mm_s,
            visit.spot
        ),
        None if template.test == Test::Mass => format!("{order:03}-mass.csv"),
        None => format!("{order:03}-air.csv"),
    };
    SimulatedRun {
        file,
        test: template.test,
        specimen: condition.specimen.map(|at| place(specimens(), at)),
        indenter: condition.indenter.map(|at| place(indenters(), at)),
        spot: condition.specimen.map(|_| visit.spot),
        place_mm: condition.indenter.map(|_| visit.place_mm.map(|mm| rounded(mm, TIMES))),
        cycle: condition.specimen.map(|_| cycle as i64),
        order: order as i64,
        start_s: rounded(start_s * Scales::of(&spec.effects).time, TIMES),
        hold_out: template.hold_out,
        load_n: (template.test == Test::Mass).then_some(template.load_n),
        time_s: Vec::new(),
        depth_mm: Vec::new(),
        force_n: Vec::new(),
        exact_n: Vec::new(),
    }
}

/// Every [`FINE`]th reading, with what is added outside the sensor.
fn sampled(spec: &Spec, condition: &Condition, ranges: &Ranges, raw: &Raw, reading: &[f64], run: &mut SimulatedRun) {
    let step_s = 1.0 / spec.sample_hz;
    let scales = Scales::of(&spec.effects);
    let phase: f64 = stream(spec.seed, Purpose::Phase, run.order as u64).random();
    let peak_n = raw.force_n.iter().copied().fold(0.0, f64::max);
    let rests = condition.coupon.is_none().then(|| ranges.rests(spec, condition, run, peak_n)).flatten();
    let placebos = spec.effects.iter().any(|effect| matches!(effect, Effect::Placebo { .. }));
    for (i, k) in (0..reading.len()).step_by(FINE).enumerate() {
        let time_s = step_s * i as f64;
        let depth_mm = raw.recorded_mm.get(k).copied();
        let moves = depth_mm.is_some() && condition.programme.moves(time_s);
        let mut force_n = reading[k];
        force_n += outside::added_n(&spec.effects, time_s, depth_mm.unwrap_or(0.0), moves, phase);
        // a rest is of the press of a ball, and so is what it varies with
        if let (Some(rests), Some(depth_mm)) = (&rests, depth_mm) {
            let programme = &condition.programme;
            let back = programme.unload && time_s > programme.down_s() + programme.hold_s;
            force_n += rests.added_n(&Instant { time_s, depth_mm, back, force_n: raw.force_n[k] });
        }
        // a placebo stands for something under a ball
        if placebos
            && condition.coupon.is_none()
            && let Some(depth) = depth_mm
        {
            let place = ranges.place(condition, run, time_s, depth, raw.force_n[k], peak_n);
            force_n += placebo::added_n(&spec.effects, spec.seed, &place);
        }
        run.time_s.push(rounded(scales.time * time_s, TIMES));
        run.depth_mm.extend(depth_mm.map(|d| rounded(scales.depth * d, TIMES)));
        run.exact_n.push(force_n);
    }
}

/// Noise, the wandering zero and quantisation.
fn noisy(spec: &Spec, wander: &Wander, order: usize, run: &mut SimulatedRun) {
    let noise = &spec.noise;
    let mut correlated = Correlated::new(noise, stream(spec.seed, Purpose::Sensor, order as u64), 1.0 / spec.sample_hz);
    for (time_s, exact_n) in run.time_s.iter().zip(&run.exact_n) {
        let sigma = noise.sensor_n.hypot(noise.proportional * exact_n);
        let mut force_n = exact_n + sigma * correlated.next() + wander.at(run.start_s + time_s);
        if noise.quantum_n > 0.0 {
            force_n = (force_n / noise.quantum_n).round() * noise.quantum_n;
        }
        run.force_n.push(rounded(force_n, FORCES));
    }
}

/// Ranges of the variables within the experiment, for placebos and rests.
struct Ranges {
    session_s: f64,
    rate: Range,
    radius: Range,
    cycles: usize,
    /// Declared radius of each ball, mm.
    radii: Vec<f64>,
    /// Of rests, where there are any.
    span: Option<Span>,
}

impl Ranges {
    fn of(spec: &Spec, conditions: &[Condition], visits: &[Visit]) -> Self {
        let ends = |v: &Visit| v.starts_s.last().copied().unwrap_or(0.0) + conditions[v.template].duration_s;
        let press = |c: &Condition| {
            let radius_mm = spec.indenters.get(c.indenter?)?.radius_mm;
            Some((c.programme.depth_mm, radius_mm, c.duration_s))
        };
        let rests = spec.effects.iter().any(|effect| matches!(effect, Effect::Rest(_)));
        let presses = || conditions.iter().filter_map(press).collect::<Vec<_>>();
        Self {
            span: rests.then(|| Span::of(spec, &presses(), visits.iter().map(|v| v.starts_s.len()).sum())),
            session_s: visits.iter().map(ends).fold(0.0, f64::max),
            rate: Range::of(spec.runs.iter().map(|run| run.rate_mm_s)),
            radius: Range::of(spec.indenters.iter().map(|one| one.radius_mm)),
            cycles: spec.runs.iter().map(|run| run.cycles).max().unwrap_or(1),
            radii: spec.indenters.iter().map(|one| one.radius_mm).collect(),
        }
    }

    /// The rests of a run under a ball.
    fn rests(&self, spec: &Spec, condition: &Condition, run: &SimulatedRun, peak_n: f64) -> Option<Rests<'_>> {
        let (specimen, ball) = (condition.specimen?, condition.indenter?);
        let spot = run.spot.unwrap_or(0).unsigned_abs();
        let press = Press {
            rate_mm_s: condition.programme.rate_mm_s,
            radius_mm: spec.indenters.get(ball)?.radius_mm,
            height_mm: spec.specimens.get(specimen)?.height_mm,
            cycle: run.cycle.unwrap_or(1).unsigned_abs() as usize,
            order: run.order.unsigned_abs() as usize,
            // spots are numbered on their specimens, fewer than a million on each
            spot: 1_000_000 * specimen as u64 + spot,
            depth_mm: condition.programme.depth_mm,
            peak_n,
        };
        Some(Rests::of(&spec.effects, spec.seed, self.span.as_ref()?, press))
    }

    fn place(
        &self,
        condition: &Condition,
        run: &SimulatedRun,
        time_s: f64,
        depth_mm: f64,
        force_n: f64,
        peak_n: f64,
    ) -> Place {
        let radius = condition.indenter.and_then(|at| self.radii.get(at)).copied().unwrap_or(1.0);
        let cycle = run.cycle.unwrap_or(1) as f64 - 1.0;
        Place {
            depth: depth_mm / condition.programme.depth_mm,
            time: time_s / condition.duration_s,
            clock: (run.start_s + time_s) / self.session_s.max(1e-9),
            rate: self.rate.part(condition.programme.rate_mm_s),
            radius: self.radius.part(radius),
            cycle: cycle / self.cycles.saturating_sub(1).max(1) as f64,
            force_n,
            peak_n,
        }
    }
}
