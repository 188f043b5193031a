//! The worst case over a box of plants, certified: boxes are divided until no plant can be worse than one that was found.

use super::bound::Bound;
use super::step::Step;
use crate::actuator::uncertain::Uncertain;

/// Boxes at most.
const BOXES: usize = 1500;
/// How far a bound may be above what was found before a box counts as done: of the cost, a part of it; of overshoot and undershoot,
/// mm; of the command, a part.
const CLOSE: [f64; 4] = [2e-3, 1e-3, 1e-3, 1e-3];
/// A bound of overshoot or undershoot below this is small enough whatever was found, mm.
const SMALL: f64 = 5e-3;

/// What is certain of a box.
#[derive(Debug, Clone)]
pub struct Worst {
    /// No plant of the box does worse; infinite where no bound was found.
    pub most: Step,
    /// The worst that was found, each at its own plant.
    pub found: Step,
    /// Where the worst cost was found.
    pub at: Vec<f64>,
    /// True if every plant of the box makes a stable loop.
    pub stable: bool,
    /// Boxes that were looked at.
    pub boxes: usize,
}

struct Part {
    middle: Vec<f64>,
    halves: Vec<f64>,
    most: [f64; 4],
    shares: Vec<f64>,
}

fn list(step: &Step) -> [f64; 4] {
    [step.cost, step.overshoot, step.undershoot, step.command]
}

fn step(list: [f64; 4]) -> Step {
    Step { cost: list[0], overshoot: list[1], undershoot: list[2], command: list[3] }
}

/// A bound of the part of the box with this middle and these half widths, or along which coefficient to divide it.
pub(super) type Bounding<'a> = dyn Fn(&[f64], &[f64]) -> Result<Bound, Vec<f64>> + 'a;

/// Divides the box until the bounds are close to what was found or there are too many parts.
pub(super) fn worst(uncertain: &Uncertain, evaluate: &dyn Fn(&[f64]) -> Step, bound: &Bounding<'_>) -> Worst {
    let mut found = [0.0f64; 4];
    let mut at = Vec::new();
    let mut tried = |values: &[f64], found: &mut [f64; 4]| {
        let own = list(&evaluate(values));
        if own[0] > found[0] {
            at = values.to_vec();
        }
        for (most, own) in found.iter_mut().zip(own) {
            *most = most.max(own);
        }
    };
    for corner in uncertain.corners() {
        tried(&corner, &mut found);
    }
    let part = |middle: Vec<f64>, halves: Vec<f64>| match bound(&middle, &halves) {
        Ok(bound) => Part { middle, halves, most: list(&bound.most), shares: bound.shares },
        Err(shares) => Part { middle, halves, most: [f64::INFINITY; 4], shares },
    };
    let middle: Vec<f64> = uncertain.bounds.iter().map(|(_, low, high)| 0.5 * (low + high)).collect();
    let halves: Vec<f64> = uncertain.bounds.iter().map(|(_, low, high)| 0.5 * (high - low)).collect();
    tried(&middle, &mut found);
    let mut parts = vec![part(middle, halves)];
    let mut boxes = 1;
    while boxes < BOXES {
        let gap = |part: &Part| {
            let close = [CLOSE[0] * found[0], CLOSE[1], CLOSE[2], CLOSE[3] * found[3]];
            let enough = [found[0], found[1].max(SMALL), found[2].max(SMALL), found[3]];
            (0..4).map(|k| (part.most[k] - enough[k]) / close[k]).fold(0.0, f64::max)
        };
        let Some((which, largest)) = parts.iter().map(gap).enumerate().max_by(|a, b| a.1.total_cmp(&b.1)) else {
            break;
        };
        if largest <= 1.0 {
            break;
        }
        let own = parts.swap_remove(which);
        let along = own.shares.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1)).map_or(0, |(i, _)| i);
        for side in [-0.5, 0.5] {
            let (mut middle, mut halves) = (own.middle.clone(), own.halves.clone());
            middle[along] += side * halves[along];
            halves[along] *= 0.5;
            tried(&middle, &mut found);
            parts.push(part(middle, halves));
            boxes += 1;
        }
    }
    let most = (0..4).map(|k| parts.iter().map(|part| part.most[k]).fold(found[k], f64::max)).collect::<Vec<_>>();
    Worst {
        stable: most[0].is_finite(),
        most: step([most[0], most[1], most[2], most[3]]),
        found: step(found),
        at,
        boxes,
    }
}
