//! Which order a recording asks for, and whether it shows a rate limit.

use super::begin;
use super::fit::{Fitted, Problem, Record, parameters};
use super::law::{Law, Parameter, Structure};
use super::noise::Coloured;

/// Steps of a first search, and of a last one.
const SHORT: usize = 12;
const LONG: usize = 60;
/// Most rounds around the end of the last search.
const ROUNDS: usize = 3;
/// Linear starts that are followed.
const FOLLOWED: usize = 2;
/// BIC by which a more complex law must be better: odds of 20 to 1 (Kass and Raftery 1995, doi:10.2307/2291091, "strong").
pub const CLEARLY: f64 = 6.0;

/// A law that was tried.
#[derive(Debug, Clone)]
pub struct Tried {
    /// The fit, with a rate limit or without, whichever the recording asks for.
    pub fitted: Fitted,
    /// Its criterion.
    pub bic: f64,
    /// BIC of the rival with or without the limit, less that of this one.
    pub limit_bic: f64,
}

impl Tried {
    /// The recording reaches a rate limit.
    #[must_use]
    pub fn is_limited(&self) -> bool {
        self.fitted.free.contains(&Parameter::Rate)
    }
}

/// Fits a structure from several starts, with a rate limit and without.
#[must_use]
pub fn tried(record: &Record, structure: Structure) -> Option<Tried> {
    let laws = begin::linear(record, structure).into_iter().map(|(_, law)| law).filter(|law| law.gain > 0.0);
    let laws: Vec<Law> = laws.take(FOLLOWED).collect();
    let mut best: [Option<Fitted>; 2] = [None, None];
    for law in &laws {
        for (friction_v, play_mm, rate) in begin::flaws(record) {
            let base = Law { friction_v, play_mm, rate_mm_s: rate.unwrap_or(f64::INFINITY), ..*law };
            let fitted = search(record, base, &Coloured::default(), SHORT);
            keep(&mut best[usize::from(rate.is_some())], fitted);
        }
    }
    // A limit that turned out useless is the start of a fit without, and the other way round.
    let [free, limited] = best;
    if let Some(limited) = &limited {
        let base = Law { rate_mm_s: f64::INFINITY, ..limited.law };
        let fitted = search(record, base, &Coloured::default(), SHORT);
        let mut free = free;
        keep(&mut free, fitted);
        let free = settled(record, free?);
        let limited = settled(record, limited.clone());
        return Some(judged(free, limited));
    }
    None
}

fn search(record: &Record, base: Law, noise: &Coloured, steps: usize) -> Fitted {
    let mut free = parameters(base.structure);
    if base.rate_mm_s.is_finite() {
        free.push(Parameter::Rate);
    }
    Problem { record, base, free, noise: noise.clone() }.search(steps, None)
}

fn keep(best: &mut Option<Fitted>, fitted: Fitted) {
    if best.as_ref().is_none_or(|best| fitted.misfit() < best.misfit()) {
        *best = Some(fitted);
    }
}

/// To the end, and again under the noise that is left.
fn settled(record: &Record, fitted: Fitted) -> Fitted {
    let mut fitted = search(record, fitted.law, &fitted.noise, LONG);
    for _ in 0..2 {
        let noise = Coloured::of(&fitted.residual_mm);
        if noise == fitted.noise {
            break;
        }
        fitted = search(record, fitted.law, &noise, LONG);
    }
    fitted
}

/// Searches again from places around the end of a search, until none of them is better: friction, play and dead time have kinks, at which a
/// descent may stop.
fn kicked(record: &Record, mut fitted: Fitted) -> Fitted {
    for _ in 0..ROUNDS {
        let before = fitted.misfit();
        let noise = fitted.noise.clone();
        for law in around(record, &fitted.law) {
            let other = search(record, law, &noise, SHORT);
            if other.misfit() < fitted.misfit() {
                fitted = search(record, other.law, &noise, LONG);
            }
        }
        if fitted.misfit() > before * (1.0 - 1e-6) {
            break;
        }
    }
    fitted
}

/// Laws around a law.
fn around(record: &Record, law: &Law) -> Vec<Law> {
    let step_s = record.step_s();
    let (low_v, high_v) = super::fit::ends(&record.command_v);
    let (some_v, some_mm) = (1e-3 * (high_v - low_v), 1e-3 * record.travel_mm());
    let mut all: Vec<Law> = [-0.4, 0.0, 0.4].iter().map(|share| Law { start_share: *share, ..*law }).collect();
    for (friction, play) in [(0.5, 1.5), (1.5, 0.5), (0.0, 2.0), (2.0, 0.0)] {
        let friction_v = friction * law.friction_v.max(some_v);
        all.push(Law { friction_v, play_mm: play * law.play_mm.max(some_mm), ..*law });
    }
    for late in [-1.0, 1.0] {
        all.push(Law { delay_s: (law.delay_s + late * step_s).max(0.0), ..*law });
    }
    all
}

/// Fits the law of a fit to another recording of it.
pub(super) fn again(record: &Record, fitted: &Fitted) -> Fitted {
    kicked(record, search(record, fitted.law, &fitted.noise, LONG))
}

fn judged(free: Fitted, limited: Fitted) -> Tried {
    let (without, with) = (free.bic(), limited.bic());
    if with < without - CLEARLY {
        return Tried { fitted: limited, bic: with, limit_bic: without - with };
    }
    Tried { fitted: free, bic: without, limit_bic: with - without }
}

/// Fits all structures; the chosen one is the simplest that no other beats clearly. The order is that of [`Structure::ALL`].
#[must_use]
pub fn chosen(record: &Record, structures: &[Structure], progress: &dyn Fn(usize)) -> Option<(usize, Vec<Tried>)> {
    let mut all: Vec<Tried> = Vec::new();
    for (done, structure) in structures.iter().enumerate() {
        progress(done);
        all.extend(tried(record, *structure));
    }
    let least = all.iter().map(|tried| tried.bic).min_by(f64::total_cmp)?;
    let at = all.iter().position(|tried| tried.bic < least + CLEARLY)?;
    let best = all.get_mut(at)?;
    best.fitted = kicked(record, best.fitted.clone());
    best.bic = best.fitted.bic();
    Some((at, all))
}
