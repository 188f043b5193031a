//! Solves of one condition made before, joined: a source of forces for many fits that share it.

use lut_gen::solid::solve::SolveError;

use super::condition::Condition;
use super::surrogate::{Node, Surrogate};

/// What was solved of a condition, and how exactly it is joined.
#[derive(Debug, Clone)]
pub struct Table {
    surrogate: Surrogate,
    /// Depth of its ramp, mm.
    pub depth_mm: f64,
    /// Duration of its hold, s.
    pub hold_s: f64,
    /// Relative error bound of its forces, that of the mesh included.
    pub error: f64,
}

/// Step of a derivative, as a share of the range; as that of a fit between its own solves.
const QUOTIENT: f64 = 1e-5;

impl Table {
    /// Of a condition and its solves; `error` is a relative bound.
    #[must_use]
    pub fn of(condition: &Condition, nodes: Vec<Node>, error: f64) -> Self {
        let mut surrogate = condition.surrogate.forgotten();
        nodes.into_iter().for_each(|node| surrogate.learn(node));
        surrogate.settle();
        Self { surrogate, depth_mm: condition.depth_mm, hold_s: condition.hold_s, error }
    }

    /// Values at a point of the condition's own coordinates.
    ///
    /// # Errors
    /// [`SolveError::Parameter`] where the number of coordinates is another.
    pub fn at(&self, x: &[f64]) -> Result<Vec<f64>, SolveError> {
        if x.len() != self.surrogate.widths.len() {
            let expected = format!("but the table has {}", self.surrogate.widths.len());
            return Err(SolveError::Parameter { parameter: "coordinates", value: x.len() as f64, expected });
        }
        Ok(self.surrogate.at(x))
    }

    /// As a solve there would be.
    ///
    /// # Errors
    /// As [`Table::at`].
    pub fn node(&self, x: &[f64]) -> Result<Node, SolveError> {
        let value = self.at(x)?;
        let by = (0..x.len()).map(|axis| {
            let step = QUOTIENT * self.surrogate.widths[axis];
            let moved = |step: f64| {
                let mut x = x.to_vec();
                x[axis] += step;
                self.surrogate.at(&x)
            };
            moved(-step).iter().zip(moved(step)).map(|(low, high)| (high - low) / (2.0 * step)).collect()
        });
        Ok(Node { x: x.to_vec(), by: by.collect(), value })
    }
}
