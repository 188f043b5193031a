//! The block as a system of equations: residual, stiffness and history at a displacement.

use serde::{Deserialize, Serialize};

use super::matrix::Matrix;
use super::{SolveError, constraint};
use crate::fem::domain::{Domain, Stiff};
use crate::fem::equations::spread;
use crate::fem::sparse::HELD;
use crate::scalar::Real;
use crate::solid::contact::{EdgeStiffness, Grip, Sum, Surface};
use crate::solid::element::{DOFS, Matter, Quadrature, Ring, Solid};
use crate::solid::law::{Material, Relaxation, Strained};
use crate::solid::mesh::BlockMesh;

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
    /// Its dof `2 node` is radial, the next one axial.
    block: Domain<T, Ring<T>, 8, 2>,
    surface: Surface<T>,
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
        let equations = constraint::number(mesh, base, surface.is_bonded());
        let solid = |(i, e): (usize, &[usize; 8])| Solid::new(*e, &e.map(|n| nodes[n]), quadrature(i));
        let elements = mesh.elements.iter().enumerate().map(solid).collect();
        Self { height_mm, block: Domain { elements, equations }, surface }
    }

    /// Number of free equations.
    #[must_use]
    pub fn unknowns(&self) -> usize {
        self.block.equations.unknowns()
    }

    /// Height of the block (mm).
    #[must_use]
    pub fn height_mm(&self) -> T {
        self.height_mm
    }

    /// The elements.
    #[must_use]
    pub fn solids(&self) -> &[Solid<T>] {
        &self.block.elements
    }

    /// The contact.
    #[must_use]
    pub fn surface(&self) -> &Surface<T> {
        &self.surface
    }

    /// Equation of dof `2 node + (0 radial, 1 axial)`, [`HELD`] for held ones.
    #[must_use]
    pub fn equation(&self) -> &[usize] {
        self.block.equations.list()
    }

    /// An empty state of the right size.
    #[must_use]
    pub fn state(&self) -> State<T> {
        let zero = T::from(0.0);
        State {
            residual: vec![zero; self.unknowns()],
            contact: vec![zero; self.unknowns()],
            potential: zero,
            sum: Sum::default(),
            base_force_n: zero,
            history: History { matter: Vec::new(), grips: Vec::new() },
        }
    }

    /// The history of a block that was never touched, with the ball at a depth (mm).
    #[must_use]
    pub fn untouched(&self, material: &Material<T>, depth_mm: T) -> History<T> {
        History {
            matter: vec![T::from(0.0); self.block.states(material.history())],
            grips: self.surface.grips(self.datum_mm(depth_mm)),
        }
    }

    fn datum_mm(&self, depth_mm: T) -> T {
        self.surface.datum_mm(self.height_mm, depth_mm)
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
        let matter = Matter { material: step.material, step: &step.relaxation };
        let State { residual, base_force_n, history, .. } = &mut *out;
        let energy = self.block.forces(
            |_| Some(&matter),
            &step.old.matter,
            Some(&mut history.matter),
            u,
            |dofs: &[usize; DOFS], force| resist(dofs, force, residual, base_force_n),
        );
        let Some(energy) = energy else { return false };
        out.potential = energy;
        let per = if self.surface.has_friction() { self.surface.per_edge() } else { 0 };
        for (index, edge) in self.surface.edges().iter().enumerate() {
            let (dofs, local) = self.block.equations.gather::<_, 6>(edge, u);
            let mut force = [T::from(0.0); 6];
            let grips = index * per..(index + 1) * per;
            let kept = Some(&mut out.history.grips[grips.clone()]);
            let datum = self.datum_mm(step.depth_mm);
            self.surface.edge(index, datum, &local, &step.old.grips[grips], kept, &mut force, None, &mut out.sum);
            spread(&dofs, &force, &mut out.contact);
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
        let edges: Vec<_> = self.surface.edges().iter().map(|e| self.block.equations.group(e)).collect();
        let matrix = Matrix::new(self.unknowns(), &self.block.groups(), &edges, symmetric)?;
        if self.surface.ball().is_some() { Ok(matrix) } else { matrix.factorising_all() }
    }

    /// As [`System::evaluate`], with the tangent and without the history.
    #[must_use]
    pub fn assemble(&self, step: &Step, u: &[f64], out: &mut State, matrix: &mut Matrix) -> bool {
        self.clear(out);
        matrix.clear();
        let symmetric = matrix.is_symmetric();
        let matter = Matter { material: step.material, step: &step.relaxation };
        let State { residual, base_force_n, .. } = &mut *out;
        let law = |_| Some(&matter);
        let add = |index, (dofs, force, k): Stiff<DOFS>| {
            resist(dofs, force, residual, base_force_n);
            matrix.add_solid(index, k);
        };
        let Some(energy) = self.block.stiffness(law, &step.old.matter, u, symmetric, add) else { return false };
        out.potential = energy;
        let per = if self.surface.has_friction() { self.surface.per_edge() } else { 0 };
        for (index, edge) in self.surface.edges().iter().enumerate() {
            let (dofs, local) = self.block.equations.gather::<_, 6>(edge, u);
            let (mut force, mut k) = ([0.0; 6], EdgeStiffness::default());
            let old = &step.old.grips[index * per..(index + 1) * per];
            let energy = out.sum.energy;
            let datum = self.datum_mm(step.depth_mm);
            self.surface.edge(index, datum, &local, old, None, &mut force, Some(&mut k), &mut out.sum);
            if out.sum.energy != energy {
                spread(&dofs, &force, &mut out.contact);
                matrix.add_edge(index, &dofs, &k);
            }
        }
        close(out);
        true
    }
}

/// Nodal forces of a solid: the only held axial dofs are those of the base.
fn resist<T: Real>(dofs: &[usize; DOFS], force: &[T; DOFS], residual: &mut [T], base_force_n: &mut T) {
    for (i, (&d, &f)) in dofs.iter().zip(force).enumerate() {
        if d != HELD {
            residual[d] += f;
        } else if i % 2 == 1 {
            *base_force_n += f;
        }
    }
}

fn close<T: Real>(out: &mut State<T>) {
    out.potential += out.sum.energy;
    for (r, c) in out.residual.iter_mut().zip(&out.contact) {
        *r += *c;
    }
}
