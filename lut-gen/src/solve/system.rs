//! The block as a system of equations: residual, stiffness and history at a displacement.

use serde::{Deserialize, Serialize};

use super::matrix::Matrix;
use super::{SolveError, constraint};
use crate::contact::{EdgeStiffness, Grip, Sum, Surface};
use crate::element::{DOFS, Matter, Quadrature, Solid};
use crate::fem::sparse::HELD;
use crate::law::{Material, Relaxation, Strained};
use crate::mesh::BlockMesh;
use crate::scalar::Real;

/// How the bottom of the block is held.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Base {
    /// Glued: neither axial nor radial motion.
    #[default]
    Bonded,
    /// On a frictionless table: no axial motion, free radial motion.
    Sliding,
}

/// Equations of a block under a ball. Free dofs are numbered 0..unknowns.
#[derive(Debug, Clone)]
pub struct System<T = f64> {
    height_mm: T,
    solids: Vec<Solid<T>>,
    surface: Surface<T>,
    /// Equation of dof `2 node + (0 radial, 1 axial)`, [`HELD`] for held ones.
    equation: Vec<usize>,
    unknowns: usize,
}

/// What the block remembers of the last equilibrium.
#[derive(Debug, Clone, PartialEq)]
pub struct History<T = f64> {
    /// [`Material::history`] numbers of every material point, element by element.
    pub matter: Vec<T>,
    /// One grip for every point of the surface; empty without friction.
    pub grips: Vec<Grip<T>>,
}

/// One step in time: from a history, within a duration, to a depth.
#[derive(Debug)]
pub struct Step<'a, T = f64> {
    /// The material.
    pub material: &'a Material<T>,
    /// What the duration does to its Maxwell elements.
    pub relaxation: Relaxation<T>,
    /// History at the step's start.
    pub old: &'a History<T>,
    /// Depth of the ball at the step's end (mm).
    pub depth_mm: T,
}

/// Residual, energy and sums of one configuration.
#[derive(Debug, Clone)]
pub struct State<T = f64> {
    /// Residual of the free equations: internal minus contact force (N).
    pub residual: Vec<T>,
    /// Nodal contact force of the free equations (N).
    pub contact: Vec<T>,
    /// Strain energy of the elastic law plus energy of the contact (N mm).
    pub potential: T,
    /// Sums over the contact.
    pub sum: Sum<T>,
    /// Axial force of the block on its base (N), positive downward.
    pub base_force_n: T,
    /// What the block remembers of the last configuration that was evaluated.
    pub history: History<T>,
}

impl<T: Strained> System<T> {
    /// Builds the equations over `nodes`, the (possibly dual) positions of the mesh's nodes (mm),
    /// and `height_mm`, its height. `surface` lists its edges over the same nodes,
    /// `quadrature` tells how each element is integrated.
    #[must_use]
    pub fn over(
        mesh: &BlockMesh,
        nodes: &[[T; 2]],
        height_mm: T,
        base: Base,
        surface: Surface<T>,
        quadrature: impl Fn(usize) -> Quadrature,
    ) -> Self {
        let (equation, unknowns) = constraint::number(mesh, base, surface.is_bonded());
        let solid = |(i, e): (usize, &[usize; 8])| Solid::new(*e, &e.map(|n| nodes[n]), quadrature(i));
        let solids = mesh.elements.iter().enumerate().map(solid).collect();
        Self { height_mm, solids, surface, equation, unknowns }
    }

    /// Number of free equations.
    #[must_use]
    pub fn unknowns(&self) -> usize {
        self.unknowns
    }

    /// Height of the block (mm).
    #[must_use]
    pub fn height_mm(&self) -> T {
        self.height_mm
    }

    /// The elements.
    #[must_use]
    pub fn solids(&self) -> &[Solid<T>] {
        &self.solids
    }

    /// The contact.
    #[must_use]
    pub fn surface(&self) -> &Surface<T> {
        &self.surface
    }

    /// Equation of dof `2 node + (0 radial, 1 axial)`, [`HELD`] for held ones.
    #[must_use]
    pub fn equation(&self) -> &[usize] {
        &self.equation
    }

    /// An empty state of the right size.
    #[must_use]
    pub fn state(&self) -> State<T> {
        let zero = T::from(0.0);
        State {
            residual: vec![zero; self.unknowns],
            contact: vec![zero; self.unknowns],
            potential: zero,
            sum: Sum::default(),
            base_force_n: zero,
            history: History { matter: Vec::new(), grips: Vec::new() },
        }
    }

    /// The history of a block that was never touched, with the ball at a depth (mm).
    #[must_use]
    pub fn untouched(&self, material: &Material<T>, depth_mm: T) -> History<T> {
        let points: usize = self.solids.iter().map(Solid::points).sum();
        History {
            matter: vec![T::from(0.0); points * material.history()],
            grips: self.surface.grips(self.datum_mm(depth_mm)),
        }
    }

    fn datum_mm(&self, depth_mm: T) -> T {
        self.surface.datum_mm(self.height_mm, depth_mm)
    }

    /// Equations and values of the dofs of some nodes; held ones have the value 0.
    pub fn gather<const N: usize>(&self, nodes: &[usize], u: &[T]) -> ([usize; N], [T; N]) {
        let dofs: [usize; N] = std::array::from_fn(|i| self.equation[2 * nodes[i / 2] + i % 2]);
        (dofs, dofs.map(|d| if d == HELD { T::from(0.0) } else { u[d] }))
    }

    /// Evaluates residual, sums and history at the displacement `u`. False when an element is turned inside out.
    #[must_use]
    pub fn evaluate(&self, step: &Step<T>, u: &[T], out: &mut State<T>) -> bool {
        self.clear(out);
        // all of it is written below: only its size is taken over, once
        out.history.matter.resize(step.old.matter.len(), T::from(0.0));
        if out.history.grips.len() != step.old.grips.len() {
            out.history.grips.clone_from(&step.old.grips);
        }
        let each = step.material.history();
        let mut at = 0;
        for solid in &self.solids {
            let (dofs, local) = self.gather::<DOFS>(&solid.nodes, u);
            let range = at..at + each * solid.points();
            at = range.end;
            let matter =
                Matter { material: step.material, step: &step.relaxation, history: &step.old.matter[range.clone()] };
            let kept = (each > 0).then(|| &mut out.history.matter[range]);
            let mut force = [T::from(0.0); DOFS];
            let Some(energy) = solid.force(&matter, &local, &mut force, kept) else { return false };
            out.potential += energy;
            spread(&dofs, &force, out);
        }
        let per = if self.surface.has_friction() { self.surface.per_edge() } else { 0 };
        for (index, edge) in self.surface.edges().iter().enumerate() {
            let (dofs, local) = self.gather::<6>(edge, u);
            let mut force = [T::from(0.0); 6];
            let grips = index * per..(index + 1) * per;
            let kept = Some(&mut out.history.grips[grips.clone()]);
            let datum = self.datum_mm(step.depth_mm);
            self.surface.edge(index, datum, &local, &step.old.grips[grips], kept, &mut force, None, &mut out.sum);
            press(&dofs, &force, out);
        }
        close(out);
        true
    }

    fn clear(&self, out: &mut State<T>) {
        let zero = T::from(0.0);
        out.residual.fill(zero);
        out.contact.fill(zero);
        out.sum = Sum::default();
        out.potential = zero;
        out.base_force_n = zero;
    }
}

impl System {
    /// Builds the equations of a mesh.
    #[must_use]
    pub fn new(mesh: &BlockMesh, base: Base, surface: Surface, quadrature: Quadrature) -> Self {
        Self::over(mesh, &mesh.nodes, mesh.height_mm, base, surface, |_| quadrature)
    }

    /// An empty tangent; `symmetric` must be false with friction or an unsymmetric material.
    ///
    /// # Errors
    /// [`SolveError::Memory`].
    pub fn matrix(&self, symmetric: bool) -> Result<Matrix, SolveError> {
        let dofs = |nodes: &[usize]| -> Vec<usize> {
            nodes.iter().flat_map(|n| [self.equation[2 * n], self.equation[2 * n + 1]]).collect()
        };
        let solids: Vec<_> = self.solids.iter().map(|s| dofs(&s.nodes)).collect();
        let edges: Vec<_> = self.surface.edges().iter().map(|e| dofs(e)).collect();
        let matrix = Matrix::new(self.unknowns, &solids, &edges, symmetric)?;
        if self.surface.ball().is_some() { Ok(matrix) } else { matrix.factorising_all() }
    }

    /// As [`System::evaluate`], with the tangent and without the history.
    #[must_use]
    pub fn assemble(&self, step: &Step, u: &[f64], out: &mut State, matrix: &mut Matrix) -> bool {
        self.clear(out);
        matrix.clear();
        let symmetric = matrix.is_symmetric();
        let each = step.material.history();
        let mut at = 0;
        for (index, solid) in self.solids.iter().enumerate() {
            let (dofs, local) = self.gather::<DOFS>(&solid.nodes, u);
            let range = at..at + each * solid.points();
            at = range.end;
            let matter = Matter { material: step.material, step: &step.relaxation, history: &step.old.matter[range] };
            let (mut force, mut k) = ([0.0; DOFS], [[0.0; DOFS]; DOFS]);
            let Some(energy) = solid.stiffness(&matter, &local, &mut force, &mut k, symmetric) else { return false };
            out.potential += energy;
            spread(&dofs, &force, out);
            matrix.add_solid(index, &k);
        }
        let per = if self.surface.has_friction() { self.surface.per_edge() } else { 0 };
        for (index, edge) in self.surface.edges().iter().enumerate() {
            let (dofs, local) = self.gather::<6>(edge, u);
            let (mut force, mut k) = ([0.0; 6], EdgeStiffness::default());
            let old = &step.old.grips[index * per..(index + 1) * per];
            let energy = out.sum.energy;
            let datum = self.datum_mm(step.depth_mm);
            self.surface.edge(index, datum, &local, old, None, &mut force, Some(&mut k), &mut out.sum);
            if out.sum.energy != energy {
                press(&dofs, &force, out);
                matrix.add_edge(index, &dofs, &k);
            }
        }
        close(out);
        true
    }
}

/// Nodal forces of a solid: the only held axial dofs are those of the base.
fn spread<T: Real>(dofs: &[usize; DOFS], force: &[T; DOFS], out: &mut State<T>) {
    for (i, (&d, &f)) in dofs.iter().zip(force).enumerate() {
        if d != HELD {
            out.residual[d] += f;
        } else if i % 2 == 1 {
            out.base_force_n += f;
        }
    }
}

fn press<T: Real>(dofs: &[usize; 6], force: &[T; 6], out: &mut State<T>) {
    for (&d, &f) in dofs.iter().zip(force) {
        if d != HELD {
            out.contact[d] += f;
        }
    }
}

fn close<T: Real>(out: &mut State<T>) {
    out.potential += out.sum.energy;
    for (r, c) in out.residual.iter_mut().zip(&out.contact) {
        *r += *c;
    }
}
