//! A meshed domain: elements, the equations of their nodes, and the sums over all of them.

use super::element::Element;
use super::equations::Equations;
use super::operator::{Operator, PointLaw, PointTangent};
use crate::scalar::Real;

/// Elements of one shape with the equations of a field of `C` components.
#[derive(Debug, Clone)]
pub struct Domain<T, B, const NODES: usize, const C: usize> {
    /// The elements.
    pub elements: Vec<Element<T, B, NODES>>,
    /// The equations of their nodes.
    pub equations: Equations<C>,
}

/// Equations of an element's degrees of freedom, its force, and its stiffness.
pub type Stiff<'a, const D: usize> = (&'a [usize; D], &'a [f64; D], &'a [[f64; D]; D]);

impl<T: Real, B, const NODES: usize, const C: usize> Domain<T, B, NODES, C> {
    /// Numbers that the domain's points remember, of which each keeps `each`.
    #[must_use]
    pub fn states(&self, each: usize) -> usize {
        each * self.elements.iter().map(|e| e.points.len()).sum::<usize>()
    }

    /// Equations that each element couples.
    #[must_use]
    pub fn groups(&self) -> Vec<Vec<usize>> {
        self.elements.iter().map(|e| self.equations.group(&e.nodes)).collect()
    }

    /// Energy at the values `u` of the equations; `add` gets every element's equations and force. `law` tells the law
    /// of an element, `None` for one that is left out. `old` is what the points remember, element by element, `new`
    /// receives what they will. `None` where a strain is impossible.
    #[must_use]
    pub fn forces<'a, L, const N: usize, const D: usize>(
        &self,
        law: impl Fn(usize) -> Option<&'a L>,
        old: &[T],
        mut new: Option<&mut [T]>,
        u: &[T],
        mut add: impl FnMut(&[usize; D], &[T; D]),
    ) -> Option<T>
    where
        B: Operator<T, C, N>,
        L: PointLaw<T, N> + 'a,
    {
        let mut energy = T::from(0.0);
        let mut at = 0;
        for (index, element) in self.elements.iter().enumerate() {
            let Some(law) = law(index) else { continue };
            let (dofs, local) = self.equations.gather(&element.nodes, u);
            let range = at..at + law.states() * element.points.len();
            at = range.end;
            let kept = new.as_deref_mut().map(|h| &mut h[range.clone()]);
            let mut force = [T::from(0.0); D];
            energy += element.force(law, &old[range], &local, &mut force, kept)?;
            add(&dofs, &force);
        }
        Some(energy)
    }
}

impl<B, const NODES: usize, const C: usize> Domain<f64, B, NODES, C> {
    /// As [`Domain::forces`] with every element's number and stiffness, and without what points will remember. Of a
    /// symmetric stiffness the lower triangle is filled.
    #[must_use]
    pub fn stiffness<'a, L, const N: usize, const D: usize>(
        &self,
        law: impl Fn(usize) -> Option<&'a L>,
        old: &[f64],
        u: &[f64],
        symmetric: bool,
        mut add: impl FnMut(usize, Stiff<D>),
    ) -> Option<f64>
    where
        B: Operator<f64, C, N>,
        L: PointTangent<N> + 'a,
    {
        let mut energy = 0.0;
        let mut at = 0;
        for (index, element) in self.elements.iter().enumerate() {
            let Some(law) = law(index) else { continue };
            let (dofs, local) = self.equations.gather(&element.nodes, u);
            let range = at..at + law.states() * element.points.len();
            at = range.end;
            let (mut force, mut k) = ([0.0; D], [[0.0; D]; D]);
            energy += element.stiffness(law, &old[range], &local, &mut force, &mut k, symmetric)?;
            add(index, (&dofs, &force, &k));
        }
        Some(energy)
    }
}
