//! The next run: among feasible commands the one that puts the rivals farthest apart, their parameters free.

use nalgebra::{DMatrix, DVector};

use super::channel::Channel;
use super::design::{self, Design, Series};
use super::fit::{Fit, Problem};
use super::forward::{Search, Weighed, with};
use super::law;
use super::whiten::Whitening;
use crate::infer::lowrank;

/// A run and what it would tell.
#[derive(Debug, Clone, PartialEq)]
pub struct Proposal {
    /// What to do.
    pub what: String,
    /// Codes that it separates or shows.
    pub decides: Vec<&'static str>,
    /// Distance in standard deviations.
    pub distance: f64,
}

/// Sampling of a planned run, s.
const TICK_S: f64 = 0.02;
/// Proposals that are told.
const MOST: usize = 3;
/// What a slow run is called.
const SLOW: &str = "a slow triangle";
/// Distance below which a run decides nothing.
const LEAST: f64 = 3.0;

/// A planned command: a name and the command over time.
struct Planned {
    what: String,
    series: Series,
}

/// Proposals, the best first: between the rivals where there are any, else for the first effects that this design is blind to.
#[must_use]
pub fn proposals(search: &Search<'_>, held: &[Weighed], blind: &[&'static str]) -> Vec<Proposal> {
    let mut list: Vec<Proposal> = Vec::new();
    for planned in planned(search.problem.design) {
        let (decides, distance) =
            if held.len() > 1 { apart(search, held, &planned) } else { shown(search, blind, &planned) };
        if distance > LEAST {
            list.push(Proposal { what: planned.what, decides, distance });
        }
    }
    list.sort_by(|a, b| b.distance.total_cmp(&a.distance));
    list.truncate(MOST);
    list
}

/// Smallest distance between the best explanation and its rivals of another name.
fn apart(search: &Search<'_>, held: &[Weighed], planned: &Planned) -> (Vec<&'static str>, f64) {
    let codes = |fit: &Fit| -> Vec<&'static str> { fit.effects.iter().map(|e| e.code).collect() };
    let own = codes(&held[0].fit);
    let (mut decides, mut least) = (own.clone(), f64::INFINITY);
    for rival in held[1..].iter().filter(|r| codes(&r.fit) != own) {
        least = least.min(distance(search, &held[0].fit, &rival.fit, planned));
        decides.extend(codes(&rival.fit).into_iter().filter(|c| !own.contains(c)));
    }
    decides.sort_unstable();
    decides.dedup();
    (decides, if least.is_finite() { least } else { 0.0 })
}

/// Largest distance that a plausible amount of a blind spot would have from the base.
fn shown(search: &Search<'_>, blind: &[&'static str], planned: &Planned) -> (Vec<&'static str>, f64) {
    let (mut decides, mut most) = (Vec::new(), 0.0_f64);
    for effect in search.effects.iter().filter(|e| blind.contains(&e.code)) {
        let settings = law::plausible(effect);
        let Some(setting) = settings.get(settings.len() / 2) else { continue };
        let mut other = search.base.clone();
        other.law = with(&other.law, setting.clone());
        let far = distance(search, &other, &search.base, planned);
        if far > LEAST && !decides.contains(&effect.code) {
            decides.push(effect.code);
        }
        most = most.max(far);
    }
    (decides, most)
}

/// Standard deviations between what two fits predict of a run, the parameters of the second free within what the data left open.
fn distance(search: &Search<'_>, truth: &Fit, rival: &Fit, planned: &Planned) -> f64 {
    let design = Design {
        channel: search.problem.design.channel,
        series: vec![planned.series.clone()],
        conditions: vec![planned.what.clone()],
        span: search.problem.design.span,
        messages: Vec::new(),
    };
    let mut design = design;
    let predicted = search.base.law.predict(&planned.series);
    design.series[0].output = truth.law.predict(&planned.series);
    let whitening = Whitening::new(&design, &[predicted], &search.noise);
    let problem = Problem { design: &design, whitening, used: vec![true] };
    let (difference, jacobian) = problem.linear(rival);
    // what the data leave open of the parameters is an error of the prediction
    lowrank::apart(&difference, &jacobian, &rival.jacobian)
}

impl Problem<'_> {
    /// Residual of a fit's law and its derivative on these data, without fitting.
    fn linear(&self, fit: &Fit) -> (DVector<f64>, DMatrix<f64>) {
        (self.residual(&fit.law), self.jacobian(&fit.law, &fit.coordinates, &fit.x))
    }
}

/// Commands that can be given to a channel, scaled to the range that was used.
fn planned(design: &Design) -> Vec<Planned> {
    let inputs = || design.series.iter().flat_map(|s| s.input.iter().copied());
    let (low, high) = inputs().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
    // of a finger's way through the air nothing is planned
    let low = if design.channel.is_finger() { low.max(0.0) } else { low };
    let range = high - low;
    let unit = design.channel.input_unit();
    let of = if design.channel == Channel::Pulp { " of compression" } else { "" };
    let told = |x: f64| format!("{x:.2} {unit}{of}");
    let square = |height: f64, half_s: f64| move |t: f64| if (t / half_s) as i64 % 2 == 1 { height } else { 0.0 };
    let triangle = |height: f64, half_s: f64| {
        move |t: f64| {
            let phase = (t / half_s) % 2.0;
            height * if phase < 1.0 { phase } else { 2.0 - phase }
        }
    };
    let mut list: Vec<Programme> = Vec::new();
    for share in [0.1, 0.3, 1.0] {
        let height = share * range;
        // nobody presses a finger in no time
        if !design.channel.is_finger() {
            list.push((format!("steps of {} and back, every 1.5 s", told(height)), 9.0, Box::new(square(height, 1.5))));
        }
        list.push((format!("{SLOW} of {}, 4 s each way", told(height)), 16.0, Box::new(triangle(height, 4.0))));
    }
    list.push((format!("a fast triangle of {}, 0.4 s each way", told(range)), 6.0, Box::new(triangle(range, 0.4))));
    if design.channel.is_finger() {
        list.push((
            format!("{} within 0.4 s, held for 30 s", told(range)),
            31.0,
            Box::new(move |t| range * (t / 0.4).min(1.0)),
        ));
    } else if design.channel != Channel::Position {
        list.push((
            format!("{} held for 60 s after a second at rest", told(range)),
            61.0,
            Box::new(move |t| if t < 1.0 { 0.0 } else { range }),
        ));
        list.push((
            format!("short touches of {} and {} by turns, 1 s each", told(0.4 * range), told(range)),
            12.0,
            Box::new(move |t: f64| if t % 2.0 < 1.0 { 0.0 } else { range * if t % 4.0 < 2.0 { 0.4 } else { 1.0 } }),
        ));
    }
    let gap_mm = design.series.iter().map(|s| s.gap_mm).fold(f64::INFINITY, f64::min);
    let mut out: Vec<Planned> =
        list.into_iter().map(|(what, span_s, of)| run(design, what, (low, gap_mm), span_s, &*of)).collect();
    if design.channel == Channel::Fluid {
        let slow: Vec<Planned> =
            out.iter().filter(|one| one.what.starts_with(SLOW)).flat_map(|one| at_currents(design, one)).collect();
        out.iter_mut().for_each(|one| one.what.push_str(", at the largest current that was used"));
        out.extend(slow);
    }
    if design.channel == Channel::Flux {
        let second_mm = if gap_mm > 0.0 { 1.5 * gap_mm } else { 0.0 };
        if second_mm > 0.0 {
            let what = format!("a triangle of {} at a gap of {second_mm:.2} mm", told(range));
            let mut one = run(design, what, (low, gap_mm), 16.0, &triangle(range, 4.0));
            (one.series.gap_mm, one.series.gap_ratio) = (second_mm, 1.5);
            out.push(one);
        }
    }
    out
}

/// A current in words, and the yield stress over the largest one at a time, s.
type Drive = (&'static str, Box<dyn Fn(f64) -> f64>);

/// Slow presses into a fluid at other currents than the largest.
fn at_currents(design: &Design, press: &Planned) -> Vec<Planned> {
    // four steps on the first way down
    let falling = |t: f64| 1.0 - 0.25 * t.floor().clamp(0.0, 3.0);
    let kinds: [Drive; 3] = [
        ("at a tenth of the largest yield stress", Box::new(|_| 0.1)),
        ("without current", Box::new(|_| 0.0)),
        ("at a current that falls in steps on the way down", Box::new(falling)),
    ];
    let made = |(words, part): Drive| {
        let mut series = press.series.clone();
        series.yield_kpa.iter_mut().zip(&series.time_s).for_each(|(kpa, t)| *kpa *= part(*t));
        series.compared =
            design::compared(design.channel, &series.time_s, (&series.input, &series.input), &series.yield_kpa);
        Planned { what: format!("{}, {words}", press.what), series }
    };
    kinds.into_iter().map(made).collect()
}

/// What to do in words, its length (s), and the command above the lowest over time (s).
type Programme = (String, f64, Box<dyn Fn(f64) -> f64>);

fn run(design: &Design, what: String, (low, gap_mm): (f64, f64), span_s: f64, of: &dyn Fn(f64) -> f64) -> Planned {
    let time_s: Vec<f64> = (0..=(span_s / TICK_S) as usize).map(|k| k as f64 * TICK_S).collect();
    let input: Vec<f64> = time_s.iter().map(|t| low + of(*t)).collect();
    let output = vec![0.0; input.len()];
    let most_kpa = design.series.iter().flat_map(|s| s.yield_kpa.iter().copied()).reduce(f64::max);
    let yield_kpa = most_kpa.map_or_else(Vec::new, |most_kpa| vec![most_kpa; input.len()]);
    let compared = design::compared(design.channel, &time_s, (&input, &input), &yield_kpa);
    let gap_mm = if gap_mm.is_finite() { gap_mm } else { 0.0 };
    let series = Series {
        file: what.clone(),
        channel: design.channel,
        time_s,
        input,
        yield_kpa,
        output,
        compared,
        is_answered: false,
        left: [Vec::new(), Vec::new()],
        gap_ratio: 1.0,
        gap_mm,
        condition: 0,
        hold_out: false,
    };
    Planned { what, series }
}
