//! The block as a system of equations: residual and stiffness at a displacement.

use super::SolveError;
use super::sparse::{Factor, HELD, Pattern};
use crate::contact::{Sum, Surface};
use crate::element::{DOFS, LOWER, Quadrature, Solid};
use crate::law::Law;
use crate::mesh::BlockMesh;

/// How the bottom of the block is held.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Base {
    /// Glued: neither axial nor radial motion.
    #[default]
    Bonded,
    /// On a frictionless table: no axial motion, free radial motion.
    Sliding,
}

/// Equations of a block under a ball. Free dofs are numbered 0..unknowns.
#[derive(Debug)]
pub struct System {
    height_mm: f64,
    solids: Vec<Solid>,
    surface: Surface,
    /// Equation of dof `2 node + (0 radial, 1 axial)`, [`HELD`] for held ones.
    equation: Vec<usize>,
    unknowns: usize,
    pattern: Pattern,
    solid_scatter: Vec<Vec<u32>>,
    edge_scatter: Vec<Vec<u32>>,
}

/// Residual, energy and sums of one configuration.
#[derive(Debug, Clone)]
pub struct State {
    /// Residual of the free equations: internal minus contact force (N).
    pub residual: Vec<f64>,
    /// Nodal contact force of the free equations (N).
    pub contact: Vec<f64>,
    /// `d residual / d depth` at fixed displacement (N/mm).
    pub drive: Vec<f64>,
    /// Values of the stiffness in the system's pattern (N/mm).
    pub values: Vec<f64>,
    /// Strain energy plus penalty energy (N mm).
    pub potential: f64,
    /// Sums over the contact.
    pub sum: Sum,
    /// Axial force of the block on its base (N), positive downward.
    pub base_force_n: f64,
}

impl System {
    /// Builds the equations. `surface` lists its edges over the nodes of `mesh`.
    #[must_use]
    pub fn new(mesh: &BlockMesh, base: Base, surface: Surface, quadrature: Quadrature) -> Self {
        let (equation, unknowns) = number(mesh, base);
        let solids: Vec<Solid> =
            mesh.elements.iter().map(|e| Solid::new(*e, &e.map(|n| mesh.nodes[n]), quadrature)).collect();
        let dofs = |nodes: &[usize]| -> Vec<usize> {
            nodes.iter().flat_map(|n| [equation[2 * n], equation[2 * n + 1]]).collect()
        };
        let mut groups: Vec<Vec<usize>> = solids.iter().map(|s| dofs(&s.nodes)).collect();
        let count = groups.len();
        groups.extend(surface.edges().iter().map(|e| dofs(e)));
        let (pattern, mut solid_scatter) = Pattern::new(unknowns, groups.iter().map(Vec::as_slice));
        let edge_scatter = solid_scatter.split_off(count);
        Self { height_mm: mesh.height_mm, solids, surface, equation, unknowns, pattern, solid_scatter, edge_scatter }
    }

    /// Number of free equations.
    #[must_use]
    pub fn unknowns(&self) -> usize {
        self.unknowns
    }

    /// Pattern of the stiffness.
    #[must_use]
    pub fn pattern(&self) -> &Pattern {
        &self.pattern
    }

    /// Symbolic factorisation of the stiffness.
    ///
    /// # Errors
    /// [`SolveError::Memory`].
    pub fn factor(&self) -> Result<Factor, SolveError> {
        Factor::new(&self.pattern).ok_or(SolveError::Memory { unknowns: self.unknowns })
    }

    /// An empty state of the right size.
    #[must_use]
    pub fn state(&self) -> State {
        State {
            residual: vec![0.0; self.unknowns],
            contact: vec![0.0; self.unknowns],
            drive: vec![0.0; self.unknowns],
            values: vec![0.0; self.pattern.entries()],
            potential: 0.0,
            sum: Sum::default(),
            base_force_n: 0.0,
        }
    }

    fn gather<const N: usize>(&self, nodes: &[usize], u: &[f64]) -> ([usize; N], [f64; N]) {
        let dofs: [usize; N] = std::array::from_fn(|i| self.equation[2 * nodes[i / 2] + i % 2]);
        (dofs, dofs.map(|d| if d == HELD { 0.0 } else { u[d] }))
    }

    /// Evaluates residual and sums at displacement `u` and depth, and the stiffness
    /// if wanted. False when an element is turned inside out.
    #[must_use]
    pub fn evaluate(&self, law: &impl Law, u: &[f64], depth_mm: f64, stiffness: bool, out: &mut State) -> bool {
        out.residual.fill(0.0);
        out.contact.fill(0.0);
        out.drive.fill(0.0);
        out.sum = Sum::default();
        out.base_force_n = 0.0;
        if stiffness {
            out.values.fill(0.0);
        }
        match self.solids(law, u, stiffness, out) {
            Some(energy) => out.potential = energy,
            None => return false,
        }
        self.edges(u, depth_mm, stiffness, out);
        out.potential += out.sum.energy;
        for (r, c) in out.residual.iter_mut().zip(&out.contact) {
            *r += c;
        }
        true
    }

    fn solids(&self, law: &impl Law, u: &[f64], stiffness: bool, out: &mut State) -> Option<f64> {
        let mut energy = 0.0;
        for (solid, scatter) in self.solids.iter().zip(&self.solid_scatter) {
            let (dofs, local) = self.gather::<DOFS>(&solid.nodes, u);
            let mut force = [0.0; DOFS];
            if stiffness {
                let mut lower = [0.0; LOWER];
                energy += solid.stiffness(law, &local, &mut force, &mut lower)?;
                for (&place, &k) in scatter.iter().zip(&lower) {
                    if place != u32::MAX {
                        out.values[place as usize] += k;
                    }
                }
            } else {
                energy += solid.force(law, &local, &mut force)?;
            }
            for (i, (&d, f)) in dofs.iter().zip(force).enumerate() {
                if d != HELD {
                    out.residual[d] += f;
                } else if i % 2 == 1 {
                    // the only held axial dofs are those of the base
                    out.base_force_n += f;
                }
            }
        }
        Some(energy)
    }

    fn edges(&self, u: &[f64], depth_mm: f64, stiffness: bool, out: &mut State) {
        let centre = self.height_mm + self.surface.ball().radius_mm - depth_mm;
        for (index, (edge, scatter)) in self.surface.edges().iter().zip(&self.edge_scatter).enumerate() {
            let (dofs, local) = self.gather::<6>(edge, u);
            let mut force = [0.0; 6];
            let mut k = [[0.0; 7]; 7];
            let before = out.sum.active;
            let wanted = stiffness.then_some(&mut k);
            self.surface.edge(index, centre, &local, &mut force, wanted, &mut out.sum);
            if out.sum.active == before {
                continue;
            }
            for (i, &d) in dofs.iter().enumerate() {
                if d != HELD {
                    out.contact[d] += force[i];
                    out.drive[d] += k[i][6];
                }
            }
            if stiffness {
                let mut at = scatter.iter();
                for (i, row) in k.iter().enumerate().take(6) {
                    for (v, &place) in row[..=i].iter().zip(at.by_ref()) {
                        if place != u32::MAX {
                            out.values[place as usize] += v;
                        }
                    }
                }
            }
        }
    }
}

/// Equation numbers: the axis does not move radially, the base as told.
fn number(mesh: &BlockMesh, base: Base) -> (Vec<usize>, usize) {
    let mut next = 0;
    let mut equation = Vec::with_capacity(2 * mesh.nodes.len());
    for x in &mesh.nodes {
        // the lines are scaled, so that the lowest may miss zero by rounding
        let bottom = x[1] <= 1e-9 * mesh.height_mm;
        let held = [x[0] == 0.0 || (bottom && base == Base::Bonded), bottom];
        for h in held {
            equation.push(if h { HELD } else { next });
            next += usize::from(!h);
        }
    }
    (equation, next)
}
