//! How a press relaxes by Hertz's contact: what is left for the finite elements to say is small and smooth.

use lut_gen::solid::model::{HOLD_NODES, Press, RAMP_NODES, RampRelaxation};

/// Hertz's contact of a relaxing solid under a ramp and a hold, as a reference for the values of a condition.
#[derive(Debug, Clone, PartialEq)]
pub struct Reference {
    /// Places of `(g, ln tau)` of each Prony term among the coordinates.
    pub terms: Vec<(usize, usize)>,
    /// Depth of the ramp, mm.
    pub depth_mm: f64,
    /// Its rate, mm/s.
    pub rate_mm_s: f64,
    /// Duration of the hold, s; 0 without one.
    pub hold_s: f64,
}

/// Derivatives of all values by the `g` and the `ln tau` of a term.
pub type Slopes = (Vec<f64>, Vec<f64>);

impl Reference {
    /// Logarithm of the part of the elastic force that is left at the nodes of the ramp, then of what is left of the peak's force at the
    /// times of the hold; and their derivatives by every `g` and `ln tau`, in the order of the terms.
    #[must_use]
    pub fn at(&self, x: &[f64]) -> (Vec<f64>, Vec<Slopes>) {
        let axis = Press::ramp_axis();
        let depths = (0..RAMP_NODES).map(|k| self.depth_mm * axis.node(k).powi(2));
        let ramp: Vec<Left> = depths.map(|depth_mm| self.left(x, depth_mm, 0.0)).collect();
        let peak = self.left(x, self.depth_mm, 0.0);
        let times = if self.hold_s > 0.0 { Press::hold_times(self.hold_s) } else { Vec::new() };
        let hold: Vec<Left> = times.iter().map(|time_s| self.left(x, self.depth_mm, *time_s)).collect();
        debug_assert!(hold.is_empty() || hold.len() == HOLD_NODES);
        let both = |of: &dyn Fn(&Left) -> f64| -> Vec<f64> {
            ramp.iter().map(of).chain(hold.iter().map(|left| of(left) - of(&peak))).collect()
        };
        let value = both(&|left| left.part.ln());
        let by = (0..self.terms.len())
            .map(|i| (both(&|left| left.by[i].0 / left.part), both(&|left| left.by[i].1 / left.part)));
        (value, by.collect())
    }

    /// What is left of the elastic force at a depth (mm) of the ramp after standing there for a time (s).
    fn left(&self, x: &[f64], depth_mm: f64, stood_s: f64) -> Left {
        let mut left = Left { part: 1.0, by: Vec::new() };
        for &(g, tau) in &self.terms {
            let (g, tau_s) = (x[g], x[tau].exp());
            // of an element that relaxes altogether
            let element = RampRelaxation { elements: vec![(1.0, self.rate_mm_s * tau_s)] };
            let (kept, slope) = element.factor(depth_mm);
            let decay = (-stood_s / tau_s).exp();
            let by_ln_tau = decay * (kept * stood_s / tau_s - slope * depth_mm);
            left.part -= g * (1.0 - kept * decay);
            left.by.push((kept * decay - 1.0, g * by_ln_tau));
        }
        left.part = left.part.max(LEAST);
        left
    }
}

/// Part of a force that is left, and its derivatives by `(g, ln tau)` of each term.
struct Left {
    part: f64,
    by: Vec<(f64, f64)>,
}

/// Parts of two terms may add up to more than all; such a point is no material, but has to have a number.
const LEAST: f64 = 1e-3;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slopes_are_those_of_the_values_and_long_holds_keep_what_does_not_relax() {
        let reference = Reference { terms: vec![(0, 1)], depth_mm: 4.0, rate_mm_s: 1.0, hold_s: 1000.0 };
        let x = [0.8, 0.3];
        let (value, by) = reference.at(&x);
        // At the end of the hold 1 - g is left of what was there without any relaxation.
        let peak = reference.left(&x, reference.depth_mm, 0.0).part;
        assert!((value[value.len() - 1].exp() * peak / 0.2 - 1.0).abs() < 1e-6);
        for (axis, by) in [&by[0].0, &by[0].1].into_iter().enumerate() {
            let moved = |h: f64| {
                let mut x = x;
                x[axis] += h;
                reference.at(&x).0
            };
            for (i, (low, high)) in moved(-1e-5).iter().zip(moved(1e-5)).enumerate() {
                // Square of the step.
                assert!(((high - low) / 2e-5 - by[i]).abs() < 1e-7, "{axis} {i}");
            }
        }
    }
}
