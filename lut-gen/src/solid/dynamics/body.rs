//! The block as masses at nodes with forces between them.

use super::{UpdatedElement, lumped_mass};
use crate::solid::contact::{Sum, Surface};
use crate::solid::element::{DOFS, Matter, Quadrature, Solid};
use crate::solid::law::Material;
use crate::solid::mesh::BlockMesh;
use crate::solid::solve::{Base, History, Step};

/// A block with lumped mass under a ball.
#[derive(Debug, Clone)]
pub struct Body {
    pub(super) elements: Vec<UpdatedElement>,
    /// The same elements for their stiffness, which gives the critical step.
    pub(super) solids: Vec<Solid>,
    /// Lumped mass of the nodes of each element (t).
    pub(super) element_mass: Vec<[f64; 8]>,
    /// Edge of the surface on top of an element.
    pub(super) edge_of: Vec<Option<usize>>,
    pub(super) surface: Surface,
    pub(super) reference: Vec<[f64; 2]>,
    mass: Vec<f64>,
    held: Vec<[bool; 2]>,
    base: Vec<bool>,
    height_mm: f64,
}

/// Forces and energies at one moment.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Forces {
    /// Internal force of each node `[r, z]` (N), as the elements resist.
    pub internal: Vec<[f64; 2]>,
    /// Force of each node on the ball `[r, z]` (N).
    pub contact: Vec<[f64; 2]>,
    /// Strain energy of the elastic law (N mm).
    pub strain_energy: f64,
    /// Sums over the contact.
    pub sum: Sum,
    /// Axial force of the block on its base (N), positive downward.
    pub base_force_n: f64,
}

impl Body {
    /// A block with a base held as told; `density` in t/mm^3 (1 kg/m^3 is 1e-12 t/mm^3).
    #[must_use]
    pub fn new(mesh: &BlockMesh, base: Base, surface: Surface, density: f64) -> Self {
        let bottom = |x: &[f64; 2]| x[1] <= 1e-9 * mesh.height_mm;
        let held = mesh.nodes.iter().map(|x| [x[0] == 0.0 || (bottom(x) && base == Base::Bonded), bottom(x)]).collect();
        Self::held(mesh, held, surface, density)
    }

    /// A block whose nodes are held in the directions told, `[r, z]` a node of the mesh; others are free.
    #[must_use]
    pub fn held(mesh: &BlockMesh, mut held: Vec<[bool; 2]>, surface: Surface, density: f64) -> Self {
        held.resize(mesh.nodes.len(), [false; 2]);
        let place = |e: &[usize; 8]| e.map(|n| mesh.nodes[n]);
        let element_mass: Vec<[f64; 8]> = mesh.elements.iter().map(|e| lumped_mass(&place(e), density)).collect();
        let mut mass = vec![0.0; mesh.nodes.len()];
        for (element, share) in mesh.elements.iter().zip(&element_mass) {
            for (node, m) in element.iter().zip(share) {
                mass[*node] += m;
            }
        }
        let edge_of = mesh.elements.iter().map(|e| surface.edges().iter().position(|edge| edge[1] == e[6])).collect();
        Self {
            elements: mesh.elements.iter().map(|e| UpdatedElement::new(*e, &place(e), Quadrature::Reduced)).collect(),
            solids: mesh.elements.iter().map(|e| Solid::new(*e, &place(e), Quadrature::Reduced)).collect(),
            element_mass,
            edge_of,
            surface,
            reference: mesh.nodes.clone(),
            base: mesh.nodes.iter().map(|x| x[1] <= 1e-9 * mesh.height_mm).collect(),
            mass,
            held,
            height_mm: mesh.height_mm,
        }
    }

    /// Lumped mass of each node (t).
    #[must_use]
    pub fn mass(&self) -> &[f64] {
        &self.mass
    }

    /// Reference position of each node (mm).
    #[must_use]
    pub fn reference_mm(&self) -> &[[f64; 2]] {
        &self.reference
    }

    /// Directions in which each node is held.
    #[must_use]
    pub fn held_directions(&self) -> &[[bool; 2]] {
        &self.held
    }

    /// Height of the ball's centre above the base (mm) at a depth.
    pub(super) fn centre_mm(&self, depth_mm: f64) -> f64 {
        self.surface.datum_mm(self.height_mm, depth_mm)
    }

    /// Displacements of an edge of the surface at the current positions `x`.
    pub(super) fn edge_displacement(&self, edge: &[usize; 3], x: &[[f64; 2]]) -> [f64; 6] {
        std::array::from_fn(|i| x[edge[i / 2]][i % 2] - self.reference[edge[i / 2]][i % 2])
    }

    /// The history of a block that was never touched, with the ball at a depth (mm).
    #[must_use]
    pub fn untouched(&self, material: &Material, depth_mm: f64) -> History {
        let points: usize = self.elements.iter().map(UpdatedElement::points).sum();
        History { matter: vec![0.0; points * material.history()], grips: self.surface.grips(self.centre_mm(depth_mm)) }
    }

    /// Where what an element remembers lies in the history.
    pub(super) fn remembered(&self, step: &Step, index: usize) -> std::ops::Range<usize> {
        let each = step.material.history() * self.elements[index].points();
        index * each..(index + 1) * each
    }

    /// Where the grips of an edge lie in the history; empty without friction.
    pub(super) fn grips(&self, index: usize) -> std::ops::Range<usize> {
        let per = if self.surface.has_friction() { self.surface.per_edge() } else { 0 };
        index * per..(index + 1) * per
    }

    /// Forces at the end of a step at the current positions `x` (mm); `new` receives the history.
    ///
    /// # Errors
    /// The index of the first element that is turned inside out.
    pub fn evaluate(&self, step: &Step, x: &[[f64; 2]], new: &mut History, out: &mut Forces) -> Result<(), usize> {
        for forces in [&mut out.internal, &mut out.contact] {
            forces.clear();
            forces.resize(x.len(), [0.0; 2]);
        }
        (out.strain_energy, out.sum, out.base_force_n) = (0.0, Sum::default(), 0.0);
        let matter = Matter { material: step.material, step: &step.relaxation };
        for (index, element) in self.elements.iter().enumerate() {
            let mut force = [0.0; DOFS];
            let range = self.remembered(step, index);
            let old = &step.old.matter[range.clone()];
            let energy =
                element.force(&matter, old, &element.nodes.map(|n| x[n]), &mut force, Some(&mut new.matter[range]));
            out.strain_energy += energy.filter(|e| e.is_finite()).ok_or(index)?;
            for (a, &node) in element.nodes.iter().enumerate() {
                out.internal[node][0] += force[2 * a];
                out.internal[node][1] += force[2 * a + 1];
                if self.base[node] {
                    out.base_force_n += force[2 * a + 1];
                }
            }
        }
        let centre = self.centre_mm(step.depth_mm);
        for (index, edge) in self.surface.edges().iter().enumerate() {
            let (mut force, u) = ([0.0; 6], self.edge_displacement(edge, x));
            let grips = self.grips(index);
            let (old, kept) = (&step.old.grips[grips.clone()], Some(&mut new.grips[grips]));
            self.surface.edge(index, centre, &u, old, kept, &mut force, None, &mut out.sum);
            for (i, f) in force.iter().enumerate() {
                out.contact[edge[i / 2]][i % 2] += f;
            }
        }
        Ok(())
    }
}
