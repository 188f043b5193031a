//! Error on commands that no fit has seen, with the base law and with what was found.

use nalgebra::DVector;
use rayon::prelude::*;

use super::design::{Design, Series};
use super::fit::{Fit, Problem, alone};
use super::forward::{Search, Weighed};
use super::gain::{Gain, Missed};
use super::law::Law;
use super::whiten::Whitening;

/// Root mean square errors over commands that were left out of fit and choice alike.
#[derive(Debug, Clone, PartialEq)]
pub struct HeldOut {
    /// With the base as a plain fit, in the channel's unit.
    pub rmse_before: f64,
    /// With the effects.
    pub rmse_after: f64,
    /// Both of the law alone: without what a run's own gain, zero and time make of its errors.
    pub of_law: (f64, f64),
    /// Sum of the squares of whitened errors with the base.
    pub square_before: f64,
    /// The same with the effects.
    pub square_after: f64,
    /// Names of the commands.
    pub conditions: Vec<String>,
    /// The same over a repeat of every command that was left out: what another session of the same commands would show.
    /// `None` where no command repeats, or runs are marked `hold_out`.
    pub gain: Option<Gain>,
}

/// Parts that a command is cut into without which the others say nothing of an effect.
const PARTS: usize = 3;
/// Standard deviations of its amount from which the other commands tell of an effect: what is predicted with less is a
/// guess, and no test of the name.
const TOLD: f64 = 3.0;
/// The same as a part of what all commands tell: an effect that one command alone was made for is not known from others.
const LEAST_PART: f64 = 0.5;

/// What is left out together.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Group {
    /// Runs that are marked `hold_out`.
    Marked,
    /// A command.
    Command(usize),
    /// A part of what is compared of a command: what a step up shows is then predicted from the step down.
    Part(usize, usize),
}

impl Group {
    /// Whether a sample of a run is left out, that is in some part of what is compared of it.
    fn holds(self, series: &Series, own_part: usize) -> bool {
        match self {
            Group::Marked => series.hold_out,
            Group::Command(command) => series.condition == command && !series.hold_out,
            Group::Part(command, part) => Group::Command(command).holds(series, own_part) && own_part == part,
        }
    }
}

/// The part of what is compared of a run that each of its samples is in.
fn parts(series: &Series) -> Vec<usize> {
    let all = series.count().max(1);
    let before = series.compared.iter().scan(0, |before, compared| {
        let own = *before;
        *before += usize::from(*compared);
        Some(own)
    });
    before.map(|before| before * PARTS / all).collect()
}

/// Leaves every command out in turn, refits base and rivals on the others, takes the likeliest rival there and predicts the command with it;
/// runs that were marked `hold_out` are predicted instead where there are any, and parts of a command without which the others say nothing of
/// what is named. `None` where no covariance can be made.
#[must_use]
pub fn of(search: &Search<'_>, held: &[Weighed]) -> Option<HeldOut> {
    let design = search.problem.design;
    let marked = design.series.iter().any(|s| s.hold_out);
    let groups: Vec<Group> = match design.conditions.len() {
        _ if marked => vec![Group::Marked],
        commands => (0..commands).flat_map(|command| groups(search, held, command)).collect(),
    };
    let parts: Vec<Vec<usize>> = design.series.iter().map(parts).collect();
    let missed = |group: &Group| left_out(search, held, &|s, k| group.holds(&design.series[s], parts[s][k]));
    let each: Vec<(Miss, Miss)> = groups.par_iter().map(missed).collect();
    let sum = |of: &dyn Fn(&(Miss, Miss)) -> f64| each.iter().map(of).sum::<f64>();
    let (rmse_before, rmse_after) = errors(&each, |miss| miss.square);
    let conditions = groups.iter().map(|group| match group {
        Group::Marked => "runs marked hold_out".to_owned(),
        Group::Command(command) => design.conditions[*command].clone(),
        Group::Part(command, part) => format!("part {} of {PARTS} of {}", part + 1, design.conditions[*command]),
    });
    Some(HeldOut {
        rmse_before,
        rmse_after,
        of_law: errors(&each, |miss| miss.of_law),
        square_before: sum(&|e| e.0.whitened),
        square_after: sum(&|e| e.1.whitened),
        conditions: conditions.collect(),
        gain: if marked { None } else { repeated(search, held) },
    })
}

/// A command, or its parts where the others say too little of what is named.
fn groups(search: &Search<'_>, held: &[Weighed], command: usize) -> Vec<Group> {
    match held.first().is_none_or(|best| is_told_without(search, &best.fit, command)) {
        true => vec![Group::Command(command)],
        false => (0..PARTS).map(|part| Group::Part(command, part)).collect(),
    }
}

/// True where the other commands tell of every effect of a fit.
fn is_told_without(search: &Search<'_>, fit: &Fit, command: usize) -> bool {
    let design = search.problem.design;
    let mut others = fit.jacobian.clone();
    for (s, series) in design.series.iter().enumerate().filter(|(_, series)| series.condition == command) {
        others.rows_mut(design.first(s), series.time_s.len()).fill(0.0);
    }
    let is_told = |at: usize| match fit.coordinates[at].null {
        Some(null) => {
            let amount = (fit.x[at] - null).abs();
            let [by_others, by_all] = [&others, &fit.jacobian].map(|shown| amount * alone(shown, at).norm());
            by_others > TOLD.max(LEAST_PART * by_all)
        }
        None => true,
    };
    (search.base.coordinates.len()..fit.x.len()).all(is_told)
}

/// Root mean square errors with base and effects, of some sum of squares.
fn errors(each: &[(Miss, Miss)], square: fn(&Miss) -> f64) -> (f64, f64) {
    let sum = |of: &dyn Fn(&(Miss, Miss)) -> f64| each.iter().map(of).sum::<f64>();
    let count = sum(&|e| e.0.count).max(1.0);
    ((sum(&|e| square(&e.0)) / count).sqrt(), (sum(&|e| square(&e.1)) / count).sqrt())
}

/// What is gained on the first, second, ... time that each command was given, each predicted from the others.
fn repeated(search: &Search<'_>, held: &[Weighed]) -> Option<Gain> {
    let design = search.problem.design;
    let before: Vec<usize> = (0..design.series.len()).map(|s| given_before(design, s)).collect();
    let last = before.iter().copied().max().filter(|last| *last > 0)?;
    let missed = |n: usize| {
        let is_one = |s: usize, _: usize| before[s] == n && !design.series[s].hold_out;
        let Predicted { plain, best, .. } = predicted(search, held, &is_one);
        let [before, after] = [&plain, &best.law].map(|law| search.problem.plain(law));
        let run = |s: usize| {
            let series = &design.series[s];
            let rows = |left: &DVector<f64>| left.rows(design.first(s), series.time_s.len()).into_owned();
            let (scatter, noise) = search.problem.whitening.expected(s);
            Missed {
                command: series.condition,
                before: rows(&before),
                after: rows(&after),
                scatter: scatter.clone(),
                noise,
                count: series.count() as f64,
            }
        };
        (0..design.series.len()).filter(|s| is_one(*s, 0)).map(run).collect::<Vec<_>>()
    };
    let runs: Vec<Missed> = (0..=last).into_par_iter().flat_map_iter(missed).collect();
    Gain::of(&runs)
}

/// How often the command of a run was given before it.
fn given_before(design: &Design, s: usize) -> usize {
    design.series.iter().take(s).filter(|before| before.condition == design.series[s].condition).count()
}

/// What base and the likeliest rival miss of the samples (run, place in it) that neither has seen.
fn left_out(search: &Search<'_>, held: &[Weighed], is_predicted: &dyn Fn(usize, usize) -> bool) -> (Miss, Miss) {
    let Predicted { base, plain, best } = predicted(search, held, is_predicted);
    let shown = shown(search.problem.design, is_predicted);
    let shown = only(search, &shown);
    let before = Miss { square: shown.plain(&plain).norm_squared(), ..miss(&shown, &base) };
    (before, miss(&shown, &best))
}

/// What is fitted to the samples that are not predicted.
struct Predicted {
    /// The base in the noise.
    base: Fit,
    /// The base as a plain fit.
    plain: Law,
    /// The likeliest rival.
    best: Fit,
}

fn predicted(search: &Search<'_>, held: &[Weighed], is_predicted: &dyn Fn(usize, usize) -> bool) -> Predicted {
    let design = search.problem.design;
    let seen = shown(design, &|s, k| !is_predicted(s, k) && !design.series[s].hold_out);
    let fitted = only(search, &seen);
    let base = fitted.fit(&search.base.law);
    let rivals = held.iter().map(|e| fitted.fit(&e.fit.law));
    let best = rivals.min_by(|a, b| a.square.total_cmp(&b.square)).unwrap_or_else(|| base.clone());
    let plain = Problem::plain_base(&seen, fitted.used.clone(), &base.law);
    Predicted { base, plain, best }
}

/// A design of which only some samples (run, place in it) are compared.
fn shown(design: &Design, is_one: &dyn Fn(usize, usize) -> bool) -> Design {
    let mut own = design.clone();
    for (s, series) in own.series.iter_mut().enumerate() {
        series.compared.iter_mut().enumerate().for_each(|(k, compared)| *compared &= is_one(s, k));
    }
    own
}

/// The problem of a design of which some samples are compared.
fn only<'d>(search: &Search<'_>, design: &'d Design) -> Problem<'d> {
    let predicted: Vec<Vec<f64>> = design.series.iter().map(|s| search.base.law.predict(s)).collect();
    let is_used = |s: &Series| s.compared.iter().any(|compared| *compared);
    let used: Vec<bool> = design.series.iter().map(is_used).collect();
    let whitening = Whitening::new(design, &predicted, &search.noise);
    Problem { design, whitening, used: vec![true; used.len()] }.for_runs(used)
}

/// Sums over predicted runs.
#[derive(Clone, Copy)]
struct Miss {
    square: f64,
    /// Without what a run's own gain, zero and time make of it: they are no law's.
    of_law: f64,
    whitened: f64,
    count: f64,
}

fn miss(problem: &Problem<'_>, fit: &Fit) -> Miss {
    let plain = problem.plain(&fit.law);
    let of_law = problem.whitening.without_scatter(&plain).norm_squared();
    let used = problem.design.series.iter().zip(&problem.used).filter(|(_, used)| **used);
    let count: usize = used.map(|(s, _)| s.count()).sum();
    let mut whitened = plain.clone();
    problem.whitening.apply(&mut whitened);
    Miss { square: plain.norm_squared(), of_law, whitened: whitened.norm_squared(), count: count as f64 }
}
