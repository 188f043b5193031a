//! What steps have shown of a curvature that an old factor does not know.

use super::krylov::dot;
use super::sparse::Factor;

/// Steps since the last factorisation: a correction by that factor which they have bettered, by the formula of Broyden,
/// Fletcher, Goldfarb and Shanno (Matthies and Strang 1979, doi:10.1002/nme.1620141104; the two loops are Nocedal's,
/// 1980, doi:10.1090/S0025-5718-1980-0572855-7).
#[derive(Debug, Default)]
pub struct Secants {
    steps: Vec<Step>,
}

/// One step.
#[derive(Debug)]
struct Step {
    /// How far it went, and how the slope changed along it.
    way: Vec<f64>,
    turn: Vec<f64>,
    /// Their product.
    work: f64,
}

impl Secants {
    /// Forgets all steps: there is a new factor.
    pub fn clear(&mut self) {
        self.steps.clear();
    }

    /// Learns of a step from one place with its slope to another. One along which the slope does not rise tells of no
    /// convex energy and is passed over.
    pub fn learn(&mut self, from: (&[f64], &[f64]), to: (&[f64], &[f64])) {
        let less = |a: &[f64], b: &[f64]| -> Vec<f64> { a.iter().zip(b).map(|(a, b)| a - b).collect() };
        let (way, turn) = (less(to.0, from.0), less(to.1, from.1));
        let work = dot(&way, &turn);
        if work > 0.0 {
            self.steps.push(Step { way, turn, work });
        }
    }

    /// The correction for a slope, in place; down is along minus it.
    pub fn correct(&self, factor: &mut Factor, x: &mut [f64]) {
        let mut parts = Vec::with_capacity(self.steps.len());
        for step in self.steps.iter().rev() {
            let part = dot(&step.way, x) / step.work;
            x.iter_mut().zip(&step.turn).for_each(|(x, turn)| *x -= part * turn);
            parts.push(part);
        }
        factor.substitute(x);
        for (step, part) in self.steps.iter().zip(parts.iter().rev()) {
            let more = part - dot(&step.turn, x) / step.work;
            x.iter_mut().zip(&step.way).for_each(|(x, way)| *x += more * way);
        }
    }
}
