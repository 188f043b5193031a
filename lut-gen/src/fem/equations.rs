//! Numbers of the equations of a field: which degrees of freedom are free, and where they stand.

use super::sparse::HELD;
use crate::scalar::Real;

/// Equations of a field of `C` components at the nodes of a mesh; degree of freedom `C node + component`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Equations<const C: usize> {
    of: Vec<usize>,
    unknowns: usize,
}

impl<const C: usize> Equations<C> {
    /// Numbers the degrees of freedom that are not held, node by node.
    #[must_use]
    pub fn number(held: impl Iterator<Item = [bool; C]>) -> Self {
        let mut unknowns = 0;
        let mut of = Vec::with_capacity(C * held.size_hint().0);
        for held in held.flatten() {
            of.push(if held { HELD } else { unknowns });
            unknowns += usize::from(!held);
        }
        Self { of, unknowns }
    }

    /// Number of equations.
    #[must_use]
    pub fn unknowns(&self) -> usize {
        self.unknowns
    }

    /// Equation of every degree of freedom, [`HELD`] for none.
    #[must_use]
    pub fn list(&self) -> &[usize] {
        &self.of
    }

    /// The same equations at other places: `place` tells the new number of every one.
    pub fn renumber(&mut self, place: &[usize]) {
        for own in self.of.iter_mut().filter(|own| **own != HELD) {
            *own = place[*own];
        }
    }

    /// Equations of the degrees of freedom of some nodes, `C` each, and the values there of a vector over the equations;
    /// held ones are 0.
    #[must_use]
    pub fn gather<T: Real, const D: usize>(&self, nodes: &[usize], u: &[T]) -> ([usize; D], [T; D]) {
        let (mut dofs, mut values) = ([HELD; D], [T::from(0.0); D]);
        for i in 0..D {
            dofs[i] = self.of[C * nodes[i / C] + i % C];
            if dofs[i] != HELD {
                values[i] = u[dofs[i]];
            }
        }
        (dofs, values)
    }

    /// Equations that an element of these nodes couples.
    #[must_use]
    pub fn group(&self, nodes: &[usize]) -> Vec<usize> {
        nodes.iter().flat_map(|n| &self.of[C * n..C * (n + 1)]).copied().collect()
    }
}

/// Adds the values at the free ones of some equations to a vector over all of them.
pub fn spread<T: Real, const D: usize>(dofs: &[usize; D], values: &[T; D], out: &mut [T]) {
    for (&d, &value) in dofs.iter().zip(values) {
        if d != HELD {
            out[d] += value;
        }
    }
}
