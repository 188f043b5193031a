//! Gains on the plant: step, margins, poles.

use nalgebra::Complex;

use super::bound_sampled;
use super::continuous::Loop;
use super::frequency::OpenLoop;
use super::gains::Gains;
use super::limits::{Rule, Scene};
use super::sampled::Exact;
use super::{Asked, Judged, Way};
use crate::actuator::plant::Plant;

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
