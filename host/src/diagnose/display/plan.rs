//! The next run: among feasible commands the one that puts the rivals farthest apart, their parameters free.

use nalgebra::{DMatrix, DVector};

use super::channel::Channel;
use super::command::Command;
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
    /// The same in numbers.
    pub command: Command,
}

/// Sampling of a planned run, s.
const TICK_S: f64 = 0.02;
/// Proposals that are told.
const MOST: usize = 3;
/// What a slow run is called.
const SLOW: &str = "a slow triangle";
/// Distance below which a run decides nothing.
const LEAST: f64 = 3.0;

/// A planned command: in words, in numbers, and as a run.
struct Planned {
    what: String,
    command: Command,
    series: Series,
}

/// Proposals, the best first: between the rivals where there are any, else for the first effects that this design is blind to.
#[must_use]
pub fn proposals(search: &Search<'_>, rivals: &[&Weighed], blind: &[&'static str]) -> Vec<Proposal> {
    let mut list: Vec<Proposal> = Vec::new();
    for planned in planned(search.problem.design) {
        let (decides, distance) =
            if rivals.len() > 1 { apart(search, rivals, &planned) } else { shown(search, blind, &planned) };
        if distance > LEAST {
            list.push(Proposal { what: planned.what, decides, distance, command: planned.command });
        }
    }
    list.sort_by(|a, b| b.distance.total_cmp(&a.distance));
    list.truncate(MOST);
    list
}

/// Smallest distance between the best explanation and its rivals of another name.
fn apart(search: &Search<'_>, rivals: &[&Weighed], planned: &Planned) -> (Vec<&'static str>, f64) {
    let codes = |fit: &Fit| -> Vec<&'static str> { fit.effects.iter().map(|e| e.code).collect() };
    let own = codes(&rivals[0].fit);
    let (mut decides, mut least) = (own.clone(), f64::INFINITY);
    for rival in rivals[1..].iter().filter(|r| codes(&r.fit) != own) {
        least = least.min(distance(search, &rivals[0].fit, &rival.fit, planned));
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
        first_alike: vec![0],
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
    let to_and_fro = |height: f64, count: usize| -> Vec<f64> {
        (0..count).map(|i| if i % 2 == 1 { low + height } else { low }).collect()
    };
    let held = |count: usize| [low].into_iter().chain(std::iter::repeat_n(high, count)).collect::<Vec<f64>>();
    let mut list: Vec<(String, Command)> = Vec::new();
    for share in [0.1, 0.3, 1.0] {
        let height = share * range;
        // nobody presses a finger in no time
        if !design.channel.is_finger() {
            let what = format!("steps of {} and back, every 1.5 s", told(height));
            list.push((what, Command::new(to_and_fro(height, 6), 1.5, 0.0)));
        }
        let what = format!("{SLOW} of {}, 4 s each way", told(height));
        let press = Command::new(to_and_fro(height, 5), 0.0, 4.0);
        list.push((what.clone(), press.clone()));
        if design.channel == Channel::Fluid {
            list.extend(at_currents(&what, &press, (low, height)));
        }
    }
    let what = format!("a fast triangle of {}, 0.4 s each way", told(range));
    list.push((what, Command::new(to_and_fro(range, 16), 0.0, 0.4)));
    if design.channel.is_finger() {
        list.push((format!("{} within 0.4 s, held for 30 s", told(range)), Command::new(held(76), 0.0, 0.4)));
    } else if design.channel != Channel::Position {
        let what = format!("{} held for 60 s after a second at rest", told(range));
        list.push((what, Command::new(held(60), 1.0, 0.0)));
        let what = format!("short touches of {} and {} by turns, 1 s each", told(0.4 * range), told(range));
        let touches = (0..12).map(|i| [low, low + 0.4 * range, low, high][i % 4]).collect();
        list.push((what, Command::new(touches, 1.0, 0.0)));
    }
    let gap_mm = gap_mm(design);
    if design.channel == Channel::Flux && gap_mm > 0.0 {
        let second_mm = 1.5 * gap_mm;
        let what = format!("a triangle of {} at a gap of {second_mm:.2} mm", told(range));
        list.push((what, Command { gap_mm: Some(second_mm), ..Command::new(to_and_fro(range, 5), 0.0, 4.0) }));
    }
    if design.channel == Channel::Fluid {
        let most = list.iter_mut().filter(|(_, command)| command.yield_parts.is_empty());
        most.for_each(|(what, _)| what.push_str(", at the largest current that was used"));
    }
    list.into_iter().map(|(what, command)| run(design, what, command)).collect()
}

/// A slow press into a fluid, by its words, from a place down by a height, mm, at other currents than the largest.
fn at_currents(what: &str, press: &Command, (low, height): (f64, f64)) -> [(String, Command); 3] {
    let slow = |part: f64| Command { yield_parts: vec![part], ..press.clone() };
    // four parts of the way down and up, a second each
    let quarter = |i: usize| low + 0.25 * height * [0.0, 1.0, 2.0, 3.0, 4.0, 3.0, 2.0, 1.0][i % 8];
    let falling = Command {
        yield_parts: vec![1.0, 1.0, 0.75, 0.5, 0.25],
        ..Command::new((0..=16).map(quarter).collect(), 0.0, 1.0)
    };
    [
        (format!("{what}, at a tenth of the largest yield stress"), slow(0.1)),
        (format!("{what}, without current"), slow(0.0)),
        (format!("{what}, at a current that falls in steps on the way down"), falling),
    ]
}

/// Smallest gap of a design, mm; 0 where none is recorded.
fn gap_mm(design: &Design) -> f64 {
    let least_mm = design.series.iter().map(|s| s.gap_mm).fold(f64::INFINITY, f64::min);
    if least_mm.is_finite() { least_mm } else { 0.0 }
}

fn run(design: &Design, what: String, command: Command) -> Planned {
    let time_s: Vec<f64> = (0..=(command.length_s() / TICK_S) as usize).map(|k| k as f64 * TICK_S).collect();
    let input: Vec<f64> = time_s.iter().map(|t| command.at(*t)).collect();
    let output = vec![0.0; input.len()];
    let most_kpa = design.series.iter().flat_map(|s| s.yield_kpa.iter().copied()).reduce(f64::max);
    let yields = |most_kpa| time_s.iter().map(|t| most_kpa * command.yield_part(*t)).collect();
    let yield_kpa: Vec<f64> = most_kpa.map_or_else(Vec::new, yields);
    let compared = design::compared(design.channel, &time_s, (&input, &input), &yield_kpa);
    let least_mm = gap_mm(design);
    let gap_ratio = command.gap_mm.filter(|_| least_mm > 0.0).map_or(1.0, |mm| mm / least_mm);
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
        gap_ratio,
        gap_mm: command.gap_mm.unwrap_or(least_mm),
        condition: 0,
        hold_out: false,
    };
    Planned { what, command, series }
}
