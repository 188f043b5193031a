//! What gains must keep to, and how a candidate is scored.

use serde::Serialize;

use super::appendix;
use super::continuous;
use super::frequency::{Coarse, OpenLoop};
use super::gains::Gains;
use super::programme::Values;
use super::sampled::Exact;
use super::step::{HORIZON_S, Step};
use super::way::Way;
use crate::actuator::flaws::Flaws;
use crate::actuator::plant::Plant;

/// Limits of a step (thesis section 5.5) and of the loop's margins.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Limits {
    /// Largest absolute command, V.
    pub command_v: f64,
    /// Overshoot, part of the step.
    pub overshoot: f64,
    /// Undershoot after the target was reached first, part of the step.
    pub undershoot: f64,
    /// Peak sensitivity; none for no limit.
    pub sensitivity: Option<f64>,
    /// Phase margin, degrees; none for no limit.
    pub phase_deg: Option<f64>,
    /// The step, mm.
    pub step_mm: f64,
    /// The command is cut at its limit instead of keeping below it by itself.
    pub cut: bool,
}

impl Default for Limits {
    /// Those of the thesis.
    fn default() -> Self {
        Self {
            command_v: f64::from(firmware::pid::U_MAX_V),
            overshoot: 0.05,
            undershoot: 0.05,
            sensitivity: None,
            phase_deg: None,
            step_mm: 1.0,
            cut: false,
        }
    }
}

/// What is least.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Rule {
    /// Eqs. 53 and 54 with limits that must be kept.
    #[default]
    Text,
    /// As Appendix E programs it: 1001 samples over 10 s, and overshoot and undershoot that are 0.05 mm, no less.
    AppendixE,
}

/// Mean error over the whole time, part of the step, above which a loop does not follow: gains of almost nothing keep every limit.
const ARRIVES: f64 = 0.1;

/// A plant that gains are scored on.
pub(super) struct Scene {
    plant: Plant,
    exact: Option<Exact>,
    coarse: Option<Coarse>,
    limits: Limits,
    rule: Rule,
}

impl Scene {
    pub fn new(way: Way, plant: Plant, flaws: Flaws, (limits, rule): (Limits, Rule)) -> Self {
        let exact = match way {
            Way::Continuous => None,
            Way::Sampled(sampling) => Some(Exact::new(&plant, sampling, flaws)),
        };
        let margins = limits.sensitivity.is_some() || limits.phase_deg.is_some();
        let coarse = margins.then(|| Coarse::new(OpenLoop::new(way, &plant)));
        Self { plant, exact, coarse, limits, rule }
    }

    /// The step of the limits' size; the command in V, all else for 1 mm.
    pub fn step(&self, gains: &Gains) -> Step {
        let size = self.limits.step_mm;
        match &self.exact {
            Some(exact) => exact.scaled(gains, size, &mut |_, _, _| {}),
            None if self.rule == Rule::AppendixE => appendix::evaluate(&self.plant, gains).step,
            None => {
                let step = continuous::evaluate(&self.plant, gains);
                Step { command: size * step.command, ..step }
            }
        }
    }

    /// The largest of the limits that are broken, in the units of [`Scene::score`].
    pub fn score(&self, gains: &Gains, scale: f64) -> (f64, Vec<f64>) {
        let limits = &self.limits;
        let step = self.step(gains);
        let mut broken = vec![step.overshoot - limits.overshoot, step.undershoot - limits.undershoot];
        if !limits.cut {
            broken.push(step.command / limits.command_v - 1.0);
        }
        broken.push(step.cost / HORIZON_S - ARRIVES);
        if self.rule == Rule::AppendixE {
            broken.extend([limits.overshoot - step.overshoot, limits.undershoot - step.undershoot]);
            broken.iter_mut().for_each(|part| *part -= appendix::TOLERANCE);
        }
        if let Some(coarse) = &self.coarse {
            let (peak, phase) = coarse.margins(gains);
            broken.extend(limits.sensitivity.map(|most| (peak / most - 1.0).min(10.0)));
            broken.extend(limits.phase_deg.map(|least| (least - phase) / 60.0));
        }
        (step.cost / scale, broken)
    }
}

/// Scores of several scenes: every limit in every one.
pub(super) fn scored(scenes: &[Scene], gains: &Gains, scale: f64) -> Values {
    let mut values = Values { costs: Vec::new(), limits: Vec::new() };
    for scene in scenes {
        let (cost, broken) = scene.score(gains, scale);
        values.costs.push(cost);
        values.limits.extend(broken);
    }
    values
}
