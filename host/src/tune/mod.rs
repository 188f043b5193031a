//! Gains of the display's position loop, searched (thesis sections 5.5 and 5.6, Appendix E).
//!
//! | file | holds |
//! |---|---|
//! | [`gains`], [`step`] | four gains; what is read of a step |
//! | [`continuous`], `dead_time`, `modal`, `read`, `cubic` | the thesis' continuous loop (Eq. 53), exactly between samples |
//! | [`appendix`] | the same as Appendix E programs it |
//! | [`sampled`], [`windup`], `shaft` | the loop that runs: the board's own controller, hold, delay, limit, flaws (Eq. 54) |
//! | [`frequency`] | loop gain, bandwidth, margins |
//! | [`limits`], `programme`, `search` | limits, and the search by `cobyla` and `slsqp` from several starts |
//! | [`worst`], `bound`, `bound_sampled`, `discrete`, `interval` | the worst plant of a box, certified |
//! | [`roots`] | roots while coefficients vary (Eq. 56, Fig. 78) |
//! | [`study`] | all of it for one report |

pub mod appendix;
mod bound;
mod bound_sampled;
pub mod continuous;
mod cubic;
mod dead_time;
mod discrete;
mod error;
pub mod frequency;
pub mod gains;
mod interval;
pub mod limits;
mod modal;
mod programme;
mod read;
pub mod roots;
pub mod sampled;
mod search;
mod shaft;
pub mod step;
pub mod study;
pub mod windup;
pub mod worst;

pub use error::TuneError;
pub use gains::Gains;

use std::time::Instant;

use nalgebra::Complex;
use serde::Serialize;

use crate::actuator::flaws::Flaws;
use crate::actuator::plant::Plant;
use crate::actuator::uncertain::Uncertain;
use continuous::Loop;
use frequency::{Margins, OpenLoop};
use limits::{Limits, Rule, Scene, scored};
use programme::Values;
use sampled::{Exact, Sampling};
use search::{Begin, Found, Precision, Space};
use step::{AtTicks, Step};
use worst::Worst;

/// Which loop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Way {
    /// A continuous controller.
    Continuous,
    /// A sampled one with a hold.
    Sampled(Sampling),
}

impl Way {
    /// The board's limit on its command, if it cuts.
    #[must_use]
    pub fn limited(self, limits: &Limits) -> Self {
        match self {
            Self::Sampled(sampling) if limits.cut => {
                Self::Sampled(Sampling { limit_v: Some(limits.command_v), ..sampling })
            }
            other => other,
        }
    }

    fn late_s(self) -> f64 {
        match self {
            Self::Continuous => 0.0,
            // A hold is late by half a tick on average.
            Self::Sampled(sampling) => sampling.tick_s * (0.5 + sampling.ticks_late as f64),
        }
    }
}

/// What gains are wanted for.
#[derive(Debug, Clone, PartialEq)]
pub struct Asked {
    /// The plant, and the box around it.
    pub uncertain: Uncertain,
    /// What the actuator adds; only in a sampled loop.
    pub flaws: Flaws,
    /// Which loop.
    pub way: Way,
    /// What the gains must keep to.
    pub limits: Limits,
    /// What is least.
    pub rule: Rule,
    /// Least for the worst corner of the box, and limits for all of them, instead of for the plant alone.
    pub robust: bool,
}

/// Gains that were searched.
#[derive(Debug, Clone)]
pub struct Tuned {
    /// The gains, as the link carries them.
    pub gains: Gains,
    /// Largest cost over the plants that they were searched for, mm s for 1 mm.
    pub cost: f64,
    /// Costs at the ends of the searches that keep the limits, the best first.
    pub ends: Vec<f64>,
    /// Steps that were computed.
    pub calls: usize,
    /// How long the search took, s.
    pub seconds: f64,
}

/// Gains on one plant.
#[derive(Debug, Clone)]
pub struct Judged {
    /// The gains.
    pub gains: Gains,
    /// Their step.
    pub step: Step,
    /// The same read at the ticks alone, of a sampled loop.
    pub at_ticks: Option<AtTicks>,
    /// Bandwidth and margins.
    pub margins: Margins,
    /// Poles of the closed loop, 1/s, or in `z`; none of a continuous loop with dead time, which has infinitely many.
    pub poles: Vec<Complex<f64>>,
}

/// Corners that a robust search looks at: of more coefficients they would be too many.
const MOST_VARIED: usize = 6;

/// Searches the gains.
///
/// # Errors
/// A plant that is not stable, a command limit that cannot hold the step, a box of too many coefficients or with a plant that is not
/// stable, or limits that no gains keep, with the gains that break them least.
pub fn tune(asked: &Asked) -> Result<Tuned, TuneError> {
    let begun = Instant::now();
    check(asked)?;
    let plant = &asked.uncertain.plant;
    let mut plants = vec![plant.clone()];
    if asked.robust {
        plants.extend(asked.uncertain.corners().iter().map(|values| asked.uncertain.at(values)));
    }
    let way = asked.way.limited(&asked.limits);
    let scenes: Vec<Scene> =
        plants.into_iter().map(|plant| Scene::new(way, plant, asked.flaws, (asked.limits, asked.rule))).collect();
    let scale = time_scale(plant, asked);
    let space = space(scale, asked);
    let score = |gains: &Gains| scored(&scenes, &gains.rounded(), scale);
    let begin = match asked.robust {
        false => Begin::Scattered(starts(scale, asked)),
        // The plant's own optimum, and one with some room for its neighbours: a search over every corner costs as many steps each.
        true => {
            let own = |gains: &Gains| scored(&scenes[..1], &gains.rounded(), scale);
            let scattered = Begin::Scattered(starts(scale, asked));
            let first = search::search(&own, &space, &scattered, precision(asked)).ok_or(TuneError::NoStart)?.gains;
            let calmer = Gains { kp: 0.8 * first.kp, ki: 0.8 * first.ki, ..first };
            Begin::From(vec![first, calmer])
        }
    };
    let found = search::search(&score, &space, &begin, precision(asked)).ok_or(TuneError::NoStart)?;
    let found = without_idle(found, &score);
    if found.values.broken() > 0.0 {
        return Err(nearest(asked, &scenes, &space, found));
    }
    Ok(Tuned {
        gains: found.gains.rounded(),
        cost: scale * found.values.cost(),
        ends: found.ends.iter().map(|cost| scale * cost).collect(),
        calls: found.calls,
        seconds: begun.elapsed().as_secs_f64(),
    })
}

/// Part of the cost that a gain must be worth: one that is worth less is none, and leaves no slow mode behind.
const IDLE: f64 = 1e-5;

/// Gains that do nothing taken away.
fn without_idle(found: Found, score: &dyn Fn(&Gains) -> Values) -> Found {
    let own = found.gains;
    let fewer = [Gains { ki: 0.0, ..own }, Gains { kd: 0.0, ..own }, Gains { ki: 0.0, kd: 0.0, ..own }];
    fewer.into_iter().fold(found, |best, gains| {
        let values = score(&gains);
        let as_good = values.broken() <= best.values.broken() && values.cost() <= best.values.cost() * (1.0 + IDLE);
        if as_good { Found { gains, values, ..best } } else { best }
    })
}

fn check(asked: &Asked) -> Result<(), TuneError> {
    let plant = &asked.uncertain.plant;
    let stable = |plant: &Plant| {
        let roots = plant.denominator.roots().ok_or(TuneError::NoRoots)?;
        // A plant may integrate once.
        let worst = roots.iter().copied().filter(|root| root.norm() > 1e-9).max_by(|a, b| a.re.total_cmp(&b.re));
        match worst {
            Some(pole) if pole.re >= 0.0 => Err(TuneError::Unstable { real: pole.re, imaginary: pole.im.abs() }),
            _ => Ok(()),
        }
    };
    stable(plant)?;
    if plant.denominator.at(0) == 0.0 && plant.denominator.at(1) == 0.0 {
        return Err(TuneError::Unstable { real: 0.0, imaginary: 0.0 });
    }
    let Limits { command_v, step_mm, .. } = asked.limits;
    let (gain, integrates) = (plant.numerator.at(0) / plant.denominator.at(0), plant.denominator.at(0) == 0.0);
    if !integrates && !(gain.abs() * command_v > step_mm) {
        let needed_v = step_mm / gain.abs();
        return Err(TuneError::TooWeak { needed_v, command_v, step_mm });
    }
    if gain < 0.0 {
        return Err(TuneError::Backwards { gain });
    }
    if asked.robust && asked.uncertain.bounds.len() > MOST_VARIED {
        return Err(TuneError::TooMany { found: asked.uncertain.bounds.len(), most: MOST_VARIED });
    }
    if asked.rule == Rule::AppendixE && (asked.way != Way::Continuous || plant.delay_s > 0.0) {
        return Err(TuneError::OtherLoop);
    }
    if asked.way == Way::Continuous && (asked.flaws.any() || asked.limits.cut) {
        return Err(TuneError::NotContinuous);
    }
    if asked.robust {
        for values in asked.uncertain.corners() {
            stable(&asked.uncertain.at(&values))?;
        }
    }
    Ok(())
}

/// A time of the order of the best cost: the plant's time constants and delays, and the way of a plant that integrates, s.
fn time_scale(plant: &Plant, asked: &Asked) -> f64 {
    let roots = plant.denominator.roots().unwrap_or_default();
    let constants: f64 = roots.iter().filter(|root| root.norm() > 1e-9).map(|root| -root.re / root.norm_sqr()).sum();
    let speed = plant.numerator.at(0) / plant.denominator.at(1) * asked.limits.command_v;
    let way = if plant.denominator.at(0) == 0.0 { asked.limits.step_mm / speed.abs() } else { 0.0 };
    (constants.max(0.0) + plant.delay_s + asked.way.late_s() + way).clamp(1e-5, 50.0)
}

/// Where gains are looked for.
fn space(scale: f64, asked: &Asked) -> Space {
    let command = asked.limits.command_v / asked.limits.step_mm;
    let most = match asked.way {
        Way::Continuous => Gains { kp: f64::INFINITY, ki: f64::INFINITY, kd: f64::INFINITY, n: 3000.0 / scale },
        Way::Sampled(_) => Gains::from(firmware::pid::GAIN_CEILING),
    };
    let high = most.n.min(3000.0 / scale);
    Space { command, integral: command / scale, corner: ((0.3 / scale).min(0.1 * high), high), most }
}

fn starts(scale: f64, asked: &Asked) -> Vec<Gains> {
    let command = asked.limits.command_v / asked.limits.step_mm;
    // That of Appendix E, and one of half the command without a derivative.
    let thesis = Gains { kp: 3.0, ki: 10.0, kd: 0.1, n: 1.0 };
    vec![thesis, Gains { kp: 0.5 * command, ki: 0.5 * command / scale, kd: 0.0, n: 1.0 / scale }]
}

/// The board computes in f32: quotients over small steps would be its rounding.
fn precision(asked: &Asked) -> Precision {
    match asked.way {
        Way::Continuous => Precision { quotient: 1e-5, spare: 2e-6 },
        Way::Sampled(_) => Precision { quotient: 3e-4, spare: 2e-6 },
    }
}

/// The gains that break the limits least, as an error.
fn nearest(asked: &Asked, scenes: &[Scene], space: &Space, found: Found) -> TuneError {
    let broken = |gains: &Gains| {
        let values = scored(scenes, &gains.rounded(), 1.0);
        Values { costs: values.limits, limits: Vec::new() }
    };
    let least = search::search(&broken, space, &Begin::Scattered(vec![found.gains]), precision(asked));
    let gains =
        least.filter(|least| least.values.cost() < found.values.broken()).map_or(found.gains, |least| least.gains);
    let gains = gains.rounded();
    let steps: Vec<Step> = scenes.iter().map(|scene| scene.step(&gains)).collect();
    let most = |of: fn(&Step) -> f64| steps.iter().map(of).fold(0.0, f64::max);
    let margins = OpenLoop::new(asked.way, &asked.uncertain.plant).margins(&gains);
    TuneError::Infeasible {
        gains: Box::new(gains),
        step: Box::new(Step {
            cost: most(|step| step.cost),
            overshoot: most(|step| step.overshoot),
            undershoot: most(|step| step.undershoot),
            command: most(|step| step.command),
        }),
        margins: Box::new(margins),
        limits: Box::new(asked.limits),
        exactly: asked.rule == Rule::AppendixE,
    }
}

/// Looks at gains on the plant.
pub fn judge(asked: &Asked, gains: &Gains) -> Judged {
    let plant = &asked.uncertain.plant;
    let way = asked.way.limited(&asked.limits);
    let scene = Scene::new(way, plant.clone(), asked.flaws, (asked.limits, Rule::Text));
    let at_ticks = match way {
        Way::Continuous => None,
        Way::Sampled(sampling) => Some(Exact::new(plant, sampling, asked.flaws).at_ticks(gains, asked.limits.step_mm)),
    };
    Judged {
        gains: *gains,
        step: scene.step(gains),
        at_ticks,
        margins: OpenLoop::new(way, plant).margins(gains),
        poles: poles(way, plant, gains),
    }
}

/// Poles of the closed loop, the slowest first.
fn poles(way: Way, plant: &Plant, gains: &Gains) -> Vec<Complex<f64>> {
    let own = match way {
        Way::Continuous if plant.delay_s > 0.0 => return Vec::new(),
        Way::Continuous => Loop::continuous(plant, gains),
        Way::Sampled(sampling) => bound_sampled::closed(plant, sampling, gains),
    };
    let mut poles = own.chi.roots().unwrap_or_default();
    let slow = |pole: &Complex<f64>| if way == Way::Continuous { pole.re } else { pole.norm() };
    poles.sort_by(|a, b| slow(b).total_cmp(&slow(a)).then(a.im.total_cmp(&b.im)));
    poles
}

/// Why there is no certificate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum NoCertificate {
    /// A continuous loop with dead time has infinitely many poles.
    DeadTime,
    /// Speed, friction, backlash or a cut command: the loop is not linear.
    NotLinear,
    /// Too many coefficients vary.
    TooMany,
    /// Nothing varies.
    NoBox,
}

/// The worst plant of the box for these gains: what is certain, and what was found.
///
/// # Errors
/// The reason why nothing is certain.
pub fn certify(asked: &Asked, gains: &Gains) -> Result<Worst, NoCertificate> {
    let uncertain = &asked.uncertain;
    let size = asked.limits.step_mm;
    if uncertain.bounds.is_empty() {
        return Err(NoCertificate::NoBox);
    }
    if uncertain.bounds.len() > MOST_VARIED {
        return Err(NoCertificate::TooMany);
    }
    if asked.flaws.any() || asked.limits.cut {
        return Err(NoCertificate::NotLinear);
    }
    let evaluate = |values: &[f64]| linear(asked, values, gains);
    let mut worst = match asked.way {
        Way::Continuous if uncertain.plant.delay_s > 0.0 => return Err(NoCertificate::DeadTime),
        Way::Continuous => {
            worst::worst(uncertain, &evaluate, &|middle, halves| bound::bound(uncertain, gains, middle, halves))
        }
        Way::Sampled(sampling) => worst::worst(uncertain, &evaluate, &|middle, halves| {
            bound_sampled::bound(uncertain, sampling, gains, middle, halves)
        }),
    };
    worst.most.command *= size;
    worst.found.command *= size;
    Ok(worst)
}

/// A step of 1 mm of a linear loop with a plant of the box; of a sampled loop at its ticks.
fn linear(asked: &Asked, values: &[f64], gains: &Gains) -> Step {
    let plant = asked.uncertain.at(values);
    match asked.way {
        Way::Continuous => continuous::evaluate(&plant, gains),
        Way::Sampled(sampling) => Exact::of_ticks(&plant, sampling).read_at_ticks(gains),
    }
}

/// The worst of random plants of the box, to compare with [`certify`]: each number at its own plant; the command in V.
pub fn sample(asked: &Asked, gains: &Gains, samples: usize) -> Step {
    use rand::{Rng, SeedableRng};
    use rayon::prelude::*;
    let worst = |a: Step, b: Step| Step {
        cost: a.cost.max(b.cost),
        overshoot: a.overshoot.max(b.overshoot),
        undershoot: a.undershoot.max(b.undershoot),
        command: a.command.max(b.command),
    };
    let none = || Step { cost: 0.0, overshoot: 0.0, undershoot: 0.0, command: 0.0 };
    let drawn = (0..samples).into_par_iter().map(|i| {
        let mut chance = rand_pcg::Pcg64::seed_from_u64(i as u64);
        let values: Vec<f64> =
            asked.uncertain.bounds.iter().map(|(_, low, high)| chance.random_range(*low..=*high)).collect();
        linear(asked, &values, gains)
    });
    let step = drawn.reduce(none, worst);
    Step { command: asked.limits.step_mm * step.command, ..step }
}

#[cfg(test)]
mod tests;
