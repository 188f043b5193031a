//! The search, from what is asked for to gains or the reason why there are none.

use std::time::Instant;

use super::error::TuneError;
use super::frequency::OpenLoop;
use super::gains::Gains;
use super::limits::{Limits, Rule, Scene, scored};
use super::programme::Values;
use super::search::{self, Begin, Found, Precision, Space};
use super::step::Step;
use super::{Asked, MOST_VARIED, Tuned, Way};
use crate::actuator::plant::Plant;

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
    let mut found = search::search(&score, &space, &begin, precision(asked)).ok_or(TuneError::NoStart)?;
    if found.values.broken() > 0.0 {
        // where hardly any gains keep the limits, they are looked for first, and then the best of them
        let gains = least_broken(asked, &scenes, &space, &found);
        let from = Begin::From(vec![gains]);
        found = search::search(&score, &space, &from, precision(asked)).ok_or(TuneError::NoStart)?;
        if found.values.broken() > 0.0 {
            return Err(nearest(asked, &scenes, gains));
        }
    }
    let found = without_idle(found, &score);
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
    if !integrates && gain.abs() * command_v <= step_mm {
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
    let command = proportional(asked);
    let most = match asked.way {
        Way::Continuous => Gains { kp: f64::INFINITY, ki: f64::INFINITY, kd: f64::INFINITY, n: 3000.0 / scale },
        Way::Sampled(_) => Gains::from(firmware::pid::GAIN_CEILING),
    };
    let high = most.n.min(3000.0 / scale);
    Space { command, integral: command / scale, corner: ((0.3 / scale).min(0.1 * high), high), most }
}

/// Size of the proportional gain, V/mm: what the command's limit allows in a step, or what the loop hardly bears, some times
/// what makes a plant of second order with these delays swing. A plant that is fast beside a tick bears far less.
fn proportional(asked: &Asked) -> f64 {
    const SOME: f64 = 3.0;
    let plant = &asked.uncertain.plant;
    let late_s = plant.delay_s + asked.way.late_s();
    let [a, b, c] = [0, 1, 2].map(|power| plant.denominator.at(power));
    let bearable = SOME * (a + b / late_s + c / (late_s * late_s)) / plant.numerator.at(0).abs();
    (asked.limits.command_v / asked.limits.step_mm).min(bearable)
}

fn starts(scale: f64, asked: &Asked) -> Vec<Gains> {
    let command = proportional(asked);
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

/// The gains that break the limits least.
fn least_broken(asked: &Asked, scenes: &[Scene], space: &Space, found: &Found) -> Gains {
    let broken = |gains: &Gains| {
        let values = scored(scenes, &gains.rounded(), 1.0);
        Values { costs: values.limits, limits: Vec::new() }
    };
    let least = search::search(&broken, space, &Begin::Scattered(vec![found.gains]), precision(asked));
    least.filter(|least| least.values.cost() < found.values.broken()).map_or(found.gains, |least| least.gains)
}

/// They, as an error.
fn nearest(asked: &Asked, scenes: &[Scene], gains: Gains) -> TuneError {
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
