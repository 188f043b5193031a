//! Confined compression: uniaxial strain of a Hyperfoam, in closed form and by finite elements.

use std::f64::consts::{PI, TAU};

use crate::solid::element::{DOFS, Matter, Quadrature, Solid};
use crate::solid::law::{Hyperfoam, Material};
use crate::solid::mesh::BlockMesh;
use crate::solid::solve::{Factor, HELD, Pattern, SolveError, Stored};

/// Nominal stress (MPa, negative in compression) of a Hyperfoam whose sides are held, at the axial stretch `l`:
/// with `J = l`, and `b = nu / (1 - 2 nu)`,
///
/// ```text
/// P = sum 2 mu / alpha (l^alpha - l^(-alpha b)) / l
/// ```
///
/// (thesis Eq. 1 with the stretches `[l, 1, 1]`; at small strain `P = 2 mu (1 - nu) / (1 - 2 nu) (l - 1)`, the oedometric modulus.)
/// `l` is positive.
#[must_use]
pub fn confined_stress_mpa(law: &Hyperfoam, l: f64) -> f64 {
    sum(law, |alpha, volume| (l.powf(alpha) - l.powf(volume)) / l)
}

/// Nominal stress (MPa) on the held sides at the axial stretch `l`: `sum 2 mu / alpha (1 - l^(-alpha b))`.
#[must_use]
pub fn confining_stress_mpa(law: &Hyperfoam, l: f64) -> f64 {
    sum(law, |_, volume| 1.0 - l.powf(volume))
}

/// `sum 2 mu / alpha f(alpha, -alpha b)`.
fn sum(law: &Hyperfoam, f: impl Fn(f64, f64) -> f64) -> f64 {
    let term =
        |t: &crate::solid::law::Term| 2.0 * t.mu_mpa / t.alpha * f(t.alpha, -t.alpha * t.nu / (1.0 - 2.0 * t.nu));
    law.terms().iter().map(term).sum()
}

/// A block whose base and top are held axially, its side radially, solved by finite elements.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ConfinedBlock {
    /// Nominal axial stress on the top (MPa).
    pub axial_mpa: f64,
    /// Nominal radial stress on the side (MPa).
    pub radial_mpa: f64,
    /// Largest distance of a node from the homogeneous state (mm), in a block of 3 mm.
    pub stray_mm: f64,
    /// Newton iterations.
    pub iterations: usize,
}

/// Lines of the block's mesh (mm), uneven on purpose.
const R_MM: [f64; 4] = [0.0, 1.0, 2.5, 4.0];
const Z_MM: [f64; 4] = [0.0, 0.7, 2.0, 3.0];
/// Amplitude (mm) of the disorder the iteration starts from.
const DISORDER_MM: f64 = 0.01;

impl ConfinedBlock {
    /// Solves for the axial stretch `l`, from a disordered state. There must be a stable neighbourhood: the stiffness of
    /// the disordered state is no longer positive for alpha 4, nu 0.3 at `l = 0.5`.
    ///
    /// # Errors
    /// [`SolveError::NoConvergence`], its depth the shortening (mm), and [`SolveError::Memory`].
    pub fn solve(law: &Hyperfoam, l: f64) -> Result<Self, SolveError> {
        let mesh = BlockMesh::from_lines(&R_MM, &Z_MM);
        let [width, height] = [mesh.radius_mm, mesh.height_mm];
        let mut unknowns = 0;
        let mut equation = Vec::new();
        for [r, z] in &mesh.nodes {
            for held in [*r == 0.0 || *r == width, *z == 0.0 || *z == height] {
                equation.push(if held { HELD } else { unknowns });
                unknowns += usize::from(!held);
            }
        }
        let homogeneous: Vec<f64> = mesh.nodes.iter().flat_map(|x| [0.0, (l - 1.0) * x[1]]).collect();
        let disorder = |i: usize| if equation[i] == HELD { 0.0 } else { DISORDER_MM * (2.3 * i as f64).sin() };
        let mut u: Vec<f64> = homogeneous.iter().enumerate().map(|(i, x)| x + disorder(i)).collect();
        let material = Material::from(law.clone());
        let block = Block::new(&mesh, &equation, unknowns);
        let mut factor = Factor::new(&block.pattern).ok_or(SolveError::Memory { unknowns })?;
        let failed = |iterations| SolveError::NoConvergence {
            depth_mm: 0.0,
            wanted_mm: (1.0 - l) * height,
            time_s: 0.0,
            iterations,
            case: format!("confined compression of {law:?}"),
        };
        for iterations in 1..=30 {
            let (force, values) = block.evaluate(&material, &u).ok_or_else(|| failed(iterations))?;
            let mut change = vec![0.0; unknowns];
            for (&e, f) in equation.iter().zip(&force).filter(|(e, _)| **e != HELD) {
                change[e] = -f;
            }
            if !factor.factorise(&block.pattern, &values) {
                return Err(failed(iterations));
            }
            factor.solve(&mut change);
            for (&e, u) in equation.iter().zip(&mut u).filter(|(e, _)| **e != HELD) {
                *u += change[e];
            }
            if change.iter().all(|c| c.abs() < 1e-13) {
                let on = |axis: usize, at: f64| -> f64 {
                    let nodes = mesh.nodes.iter().zip(force.chunks_exact(2));
                    nodes.filter(|(x, _)| x[axis] == at).map(|(_, f)| f[axis]).sum()
                };
                let stray = u.iter().zip(&homogeneous).map(|(a, b)| (a - b).abs());
                return Ok(Self {
                    axial_mpa: on(1, height) / (PI * width * width),
                    radial_mpa: on(0, width) / (TAU * width * height),
                    stray_mm: stray.fold(0.0, f64::max),
                    iterations,
                });
            }
        }
        Err(failed(30))
    }
}

/// Elements of the block and where their stiffness goes.
struct Block {
    solids: Vec<Solid>,
    pattern: Pattern,
    scatter: Vec<Vec<u32>>,
}

impl Block {
    fn new(mesh: &BlockMesh, equation: &[usize], unknowns: usize) -> Self {
        let solid = |e: &[usize; 8]| Solid::new(*e, &e.map(|n| mesh.nodes[n]), Quadrature::Reduced);
        let solids: Vec<Solid> = mesh.elements.iter().map(solid).collect();
        let dofs = |s: &Solid| s.nodes.iter().flat_map(|n| [equation[2 * n], equation[2 * n + 1]]).collect();
        let groups: Vec<Vec<usize>> = solids.iter().map(dofs).collect();
        let (pattern, scatter) = Pattern::new(unknowns, groups.iter().map(Vec::as_slice), Stored::Lower);
        Self { solids, pattern, scatter }
    }

    /// Internal force of every dof (N) and the stiffness' values at the displacement of every dof.
    fn evaluate(&self, material: &Material, u: &[f64]) -> Option<(Vec<f64>, Vec<f64>)> {
        let step = material.relaxation(0.0);
        let matter = Matter { material, step: &step };
        let (mut force, mut values) = (vec![0.0; u.len()], vec![0.0; self.pattern.entries()]);
        for (solid, scatter) in self.solids.iter().zip(&self.scatter) {
            let dof = |i: usize| 2 * solid.nodes[i / 2] + i % 2;
            let local: [f64; DOFS] = std::array::from_fn(|i| u[dof(i)]);
            let (mut f, mut k) = ([0.0; DOFS], [[0.0; DOFS]; DOFS]);
            solid.stiffness(&matter, &[], &local, &mut f, &mut k, true)?;
            for (i, f) in f.into_iter().enumerate() {
                force[dof(i)] += f;
            }
            let lower = k.iter().enumerate().flat_map(|(i, row)| &row[..=i]);
            for (&place, k) in scatter.iter().zip(lower).filter(|(p, _)| **p != u32::MAX) {
                values[place as usize] += k;
            }
        }
        Some((force, values))
    }
}
