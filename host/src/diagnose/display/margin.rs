//! Variables over which a residual is averaged: a discrepancy shows in some of them.

use nalgebra::{DMatrix, DVector};

use super::design::{Design, Series};
use super::fit::Problem;

/// What a margin is a function of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Variable {
    /// What was told.
    Level,
    /// Whether it rises, falls, or rests after either.
    Direction,
    /// How fast it changes.
    Rate,
    /// Time since it changed last.
    Hold,
    /// Time in the run.
    Clock,
    /// Which command.
    Command,
}

impl Variable {
    /// The words in answers.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Variable::Level => "level",
            Variable::Direction => "direction",
            Variable::Rate => "rate",
            Variable::Hold => "hold time",
            Variable::Clock => "time in the run",
            Variable::Command => "command",
        }
    }
}

/// One bin of a variable as a direction in the whitened data.
#[derive(Debug, Clone)]
pub struct Margin {
    /// The variable.
    pub variable: Variable,
    /// An offset of all samples in this bin, whitened.
    pub direction: DVector<f64>,
}

/// What a sample is like.
#[derive(Debug, Clone, Copy)]
struct Place {
    level: f64,
    /// 0 rising, 1 falling, 2 at rest after rising, 3 at rest after falling, 4 not moved yet.
    direction: usize,
    rate: f64,
    since_s: f64,
    clock: f64,
}

const LEVELS: usize = 6;
/// Bins that show what repeats along the range.
const FINE: usize = 24;
const CLOCKS: usize = 8;
/// Edges of the bins of time since the last change, s.
const SINCE_S: [f64; 7] = [0.03, 0.07, 0.15, 0.4, 1.0, 3.0, 10.0];
/// Edges of the bins of rate over the largest.
const RATES: [f64; 3] = [0.03, 0.1, 0.4];
/// Changes below this share of the range are none.
const STILL: f64 = 2e-3;
/// Parts that every command's run is cut into.
const PARTS: usize = 10;

/// All margins of a design.
#[must_use]
pub fn margins(problem: &Problem<'_>) -> Vec<Margin> {
    let design = problem.design;
    let inputs = || design.series.iter().flat_map(|s| s.input.iter().copied());
    let (low, high) = inputs().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
    let places: Vec<Vec<Place>> = design.series.iter().map(|s| places(s, low, high - low)).collect();
    let steep = places.iter().flatten().map(|p| p.rate).fold(0.0, f64::max).max(1e-12);
    let bin = |edges: &[f64], x: f64| edges.iter().take_while(|edge| x >= **edge).count();
    let mut list = Vec::new();
    let mut add = |variable: Variable, bins: usize, of: &dyn Fn(usize, &Place) -> Option<usize>| {
        let mut raw = DMatrix::zeros(design.samples(), bins);
        for (s, own) in places.iter().enumerate().filter(|(s, _)| problem.used[*s]) {
            for (k, place) in own.iter().enumerate().filter(|(k, _)| design.series[s].compared[*k]) {
                if let Some(at) = of(s, place) {
                    raw[(design.first(s) + k, at.min(bins - 1))] = 1.0;
                }
            }
        }
        for column in raw.column_iter().filter(|c| c.sum() > 2.5) {
            let mut direction = column.into_owned();
            problem.whitening.apply(&mut direction);
            list.push(Margin { variable, direction });
        }
    };
    let level = |p: &Place| ((p.level * LEVELS as f64) as usize).min(LEVELS - 1);
    add(Variable::Level, LEVELS, &|_, p| Some(level(p)));
    add(Variable::Level, FINE, &|_, p| Some((p.level * FINE as f64) as usize));
    add(Variable::Direction, 5, &|_, p| Some(p.direction));
    add(Variable::Direction, 4 * LEVELS, &|_, p| (p.direction < 4).then(|| p.direction * LEVELS + level(p)));
    add(Variable::Rate, 2 * (RATES.len() + 1), &|_, p| {
        (p.direction < 2).then(|| p.direction * (RATES.len() + 1) + bin(&RATES, p.rate / steep))
    });
    for sign in [2, 3] {
        add(Variable::Hold, SINCE_S.len() + 1, &|_, p| (p.direction == sign).then(|| bin(&SINCE_S, p.since_s)));
    }
    add(Variable::Clock, CLOCKS, &|_, p| Some((p.clock * CLOCKS as f64) as usize));
    add(Variable::Command, design.conditions.len() * PARTS, &|s, p| {
        let part = ((p.clock * PARTS as f64) as usize).min(PARTS - 1);
        Some(design.series[s].condition * PARTS + part)
    });
    list
}

fn places(series: &Series, low: f64, range: f64) -> Vec<Place> {
    let (time_s, input) = (&series.time_s, &series.input);
    let (begin_s, end_s) = (time_s.first().copied().unwrap_or(0.0), time_s.last().copied().unwrap_or(1.0));
    let (mut changed_s, mut sign, mut settled) = (begin_s, 4, input.first().copied().unwrap_or(0.0));
    let mut out = Vec::with_capacity(input.len());
    for (k, x) in input.iter().enumerate() {
        let moved = x - settled;
        let now = if moved.abs() > STILL * range {
            (changed_s, settled) = (time_s[k], *x);
            sign = usize::from(moved < 0.0);
            sign
        } else if sign < 4 {
            2 + sign
        } else {
            4
        };
        let span_s = if k > 0 { (time_s[k] - time_s[k - 1]).max(1e-6) } else { f64::INFINITY };
        out.push(Place {
            level: (x - low) / range.max(1e-12),
            direction: now,
            rate: moved.abs() / span_s,
            since_s: time_s[k] - changed_s,
            clock: (time_s[k] - begin_s) / (end_s - begin_s).max(1e-9),
        });
    }
    out
}

/// Smooth functions of the same variables that mean nothing, one a column, whitened: what an effect must beat.
#[must_use]
pub fn placebos(problem: &Problem<'_>, count: usize, mut uniform: impl FnMut() -> f64) -> DMatrix<f64> {
    let design: &Design = problem.design;
    let inputs = || design.series.iter().flat_map(|s| s.input.iter().copied());
    let (low, high) = inputs().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
    let places: Vec<Vec<Place>> = design.series.iter().map(|s| places(s, low, high - low)).collect();
    let columns: Vec<DVector<f64>> = (0..count)
        .map(|_| {
            let (waves, phase) = (std::f64::consts::PI * (0.5 + 2.5 * uniform()), std::f64::consts::TAU * uniform());
            let variable = (4.0 * uniform()) as usize;
            let signs: Vec<f64> = (0..64).map(|_| if uniform() < 0.5 { 1.0 } else { -1.0 }).collect();
            let mut column = DVector::zeros(design.samples());
            for (s, own) in places.iter().enumerate().filter(|(s, _)| problem.used[*s]) {
                for (k, p) in own.iter().enumerate().filter(|(k, _)| design.series[s].compared[*k]) {
                    let along = match variable {
                        0 | 1 => p.level,
                        2 => p.clock,
                        _ => (1.0 + p.since_s / 0.05).ln() / 5.0,
                    };
                    let sign =
                        if variable == 1 { signs[p.direction] } else { signs[8 + design.series[s].condition % 56] };
                    column[design.first(s) + k] = design.span * sign * (waves * along + phase).cos();
                }
            }
            problem.whitening.apply(&mut column);
            column
        })
        .collect();
    DMatrix::from_columns(&columns)
}
