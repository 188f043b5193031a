//! An element of any shape and physics: its points of integration, its force and its stiffness.

#![expect(
    clippy::needless_range_loop,
    reason = "of nested adaptors of arrays only a part is inlined, which doubles the time of a solve"
)]

use super::operator::{Operator, PointLaw, PointTangent};
use crate::scalar::Real;

/// A point of integration; it never changes during a solve.
#[derive(Debug, Clone)]
pub struct Point<T, B, const NODES: usize> {
    /// Reference volume that it stands for.
    pub volume: T,
    /// What each node does to the strain.
    pub operators: [B; NODES],
}

/// One element. Its local degrees of freedom are `C a + i`: component `i` at its node `a`.
#[derive(Debug, Clone)]
pub struct Element<T, B, const NODES: usize> {
    /// Its nodes.
    pub nodes: [usize; NODES],
    /// Its points of integration.
    pub points: Vec<Point<T, B, NODES>>,
}

impl<T: Real, B, const NODES: usize> Point<T, B, NODES> {
    /// Strain at the values `u`, from `rest` where they are zero.
    #[inline]
    pub fn strain<const C: usize, const N: usize, const D: usize>(&self, rest: [T; N], u: &[T; D]) -> [T; N]
    where
        B: Operator<T, C, N>,
    {
        const { assert!(D == C * NODES) }
        let mut strain = rest;
        let values = u.as_chunks().0;
        for a in 0..NODES {
            self.operators[a].strain(&values[a], &mut strain);
        }
        strain
    }

    /// Adds the nodal forces of a flux at the point.
    #[inline]
    pub fn add_force<const C: usize, const N: usize, const D: usize>(&self, flux: &[T; N], force: &mut [T; D])
    where
        B: Operator<T, C, N>,
    {
        const { assert!(D == C * NODES) }
        let mut whole = *flux;
        for x in &mut whole {
            *x = *x * self.volume;
        }
        for a in 0..NODES {
            let f = self.operators[a].force(&whole);
            for i in 0..C {
                force[C * a + i] += f[i];
            }
        }
    }
}

impl<B, const NODES: usize> Point<f64, B, NODES> {
    /// Adds `B' A B`; of a symmetric tangent the lower triangle, by blocks of nodes.
    #[inline]
    fn add_stiffness<const C: usize, const N: usize, const D: usize>(
        &self,
        tangent: &[[f64; N]; N],
        stiffness: &mut [[f64; D]; D],
        symmetric: bool,
    ) where
        B: Operator<f64, C, N>,
    {
        const { assert!(D == C * NODES) }
        // columns of the tangent
        let mut t = [[0.0; N]; N];
        for k in 0..N {
            for m in 0..N {
                t[k][m] = tangent[m][k] * self.volume;
            }
        }
        let blocks = stiffness.as_chunks_mut::<C>().0;
        for a in 0..NODES {
            // the node's rows of B' A
            let mut rows = [[0.0; N]; C];
            for k in 0..N {
                let f = self.operators[a].force(&t[k]);
                for i in 0..C {
                    rows[i][k] = f[i];
                }
            }
            let columns = if symmetric { a + 1 } else { NODES };
            for b in 0..columns {
                for i in 0..C {
                    let k = self.operators[b].force(&rows[i]);
                    for j in 0..C {
                        blocks[a][i][C * b + j] += k[j];
                    }
                }
            }
        }
    }
}

impl<T: Real, B, const NODES: usize> Element<T, B, NODES> {
    /// An element of these nodes and points.
    #[must_use]
    pub fn of(nodes: [usize; NODES], points: Vec<Point<T, B, NODES>>) -> Self {
        Self { nodes, points }
    }

    /// Reference volume of every point.
    pub fn volumes(&self) -> impl Iterator<Item = T> {
        self.points.iter().map(|p| p.volume)
    }

    /// Strain at every point, from `rest` where the values are zero.
    pub fn strains<const C: usize, const N: usize, const D: usize>(
        &self,
        rest: [T; N],
        u: &[T; D],
    ) -> impl Iterator<Item = [T; N]>
    where
        B: Operator<T, C, N>,
    {
        self.points.iter().map(move |p| p.strain(rest, u))
    }

    /// Adds the force, the slope of the energy by the values `u`, and returns the energy. `old` is what the points
    /// remember, one after the other; `new` receives what they will. `None` where a strain is impossible.
    #[must_use]
    pub fn force<L, const C: usize, const N: usize, const D: usize>(
        &self,
        law: &L,
        old: &[T],
        u: &[T; D],
        force: &mut [T; D],
        mut new: Option<&mut [T]>,
    ) -> Option<T>
    where
        B: Operator<T, C, N>,
        L: PointLaw<T, N>,
    {
        let (each, rest) = (law.states(), law.rest());
        let mut energy = T::from(0.0);
        for (i, point) in self.points.iter().enumerate() {
            let range = i * each..(i + 1) * each;
            let kept = new.as_deref_mut().map(|h| &mut h[range.clone()]);
            let (w, flux) = law.flux(&point.strain(rest, u), &old[range], kept)?;
            energy += point.volume * w;
            point.add_force(&flux, force);
        }
        Some(energy)
    }
}

impl<B, const NODES: usize> Element<f64, B, NODES> {
    /// Adds force and stiffness, returns the energy; `None` where a strain is impossible. Of a symmetric stiffness
    /// only the lower triangle is sure to be filled.
    #[must_use]
    pub fn stiffness<L, const C: usize, const N: usize, const D: usize>(
        &self,
        law: &L,
        old: &[f64],
        u: &[f64; D],
        force: &mut [f64; D],
        stiffness: &mut [[f64; D]; D],
        symmetric: bool,
    ) -> Option<f64>
    where
        B: Operator<f64, C, N>,
        L: PointTangent<N>,
    {
        let (each, rest) = (law.states(), law.rest());
        let mut energy = 0.0;
        for (i, point) in self.points.iter().enumerate() {
            let response = law.response(&point.strain(rest, u), &old[i * each..(i + 1) * each])?;
            energy += point.volume * response.energy;
            point.add_force(&response.flux, force);
            point.add_stiffness(&response.tangent, stiffness, symmetric);
        }
        Some(energy)
    }
}
