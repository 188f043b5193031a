//! Magnetostatics in the plane and about an axis: the vector potential that makes the energy least.
//!
//! In the plane the potential A has the flux density (dA/dy, -dA/dx), about an axis (-dA/dz, dA/dr + A/r). Both have
//! |B| = |g| with g = (dA/dx, dA/dy), or (dA/dr + A/r, dA/dz), and the same energy, per mm of depth or per radian:
//! `integral (W(|B|) - M . B - J A) w` with w = 1 or r. It is convex, and its minimum is the field. A itself and not r A is
//! the unknown about an axis, for it is smooth there: r A over r loses an order.

use crate::fem::mesh::Mesh;
use crate::fem::sparse::{Factor, HELD, Pattern, Stored, elimination_order};
use crate::fem::triangle::NODES;

use super::bh::Law;
use super::point::{Point, gradient, points};

/// The plane, or the half plane of radius and height.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Geometry {
    /// Per mm of depth.
    #[default]
    Plane,
    /// Radius is x, the axis is at x = 0.
    Axisymmetric,
}

impl Geometry {
    /// The vector whose product with g is that of `v` with the flux density.
    const fn turned(self, v: [f64; 2]) -> [f64; 2] {
        match self {
            Geometry::Plane => [-v[1], v[0]],
            Geometry::Axisymmetric => [v[1], -v[0]],
        }
    }
}

/// What a region is made of.
#[derive(Debug, Clone, PartialEq)]
pub struct Matter {
    /// Its law.
    pub law: Law,
    /// Current density through the plane, A/mm^2.
    pub current: f64,
    /// Coercive field strength of a magnet along its magnetisation, A/mm; zero for all else.
    pub coercive: [f64; 2],
}

/// A field that cannot be found.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FieldError {
    /// A region has no matter.
    #[error("region {region} of the mesh has no material")]
    NoMatter {
        /// Its number.
        region: usize,
    },
    /// Nothing holds the potential.
    #[error("no node is held: the outer boundary must have a potential of zero somewhere")]
    Free,
    /// Memory.
    #[error("the matrix of {unknowns} equations does not fit into memory")]
    Memory {
        /// How many.
        unknowns: usize,
    },
    /// A triangle turns over.
    #[error("a triangle in region {region} near ({:.3}, {:.3}) mm has no area: its side on a circle is too long", at[0], at[1])]
    Degenerate {
        /// Its region.
        region: usize,
        /// Its first corner, mm.
        at: [f64; 2],
    },
    /// Newton's method does not get on.
    #[error("no equilibrium after {steps} steps: the residual is {residual:e} of the sources")]
    Steps {
        /// Steps made.
        steps: usize,
        /// What is left.
        residual: f64,
    },
}

/// Equations of a field over a mesh.
pub struct Field {
    pub(super) mesh: Mesh,
    pub(super) geometry: Geometry,
    pub(super) points: Vec<Vec<Point>>,
    /// Triangles around every node.
    pub(super) around: Vec<Vec<usize>>,
    /// Equation of every node.
    equation: Vec<usize>,
    pattern: Pattern,
    scatter: Vec<Vec<u32>>,
    factor: Factor,
    unknowns: usize,
}

/// A field that was found.
#[derive(Debug, Clone, PartialEq)]
pub struct Solution {
    /// Potential at the nodes, T mm.
    pub potential: Vec<f64>,
    /// Newton steps.
    pub steps: usize,
    /// Residual over the sources.
    pub residual: f64,
}

/// Residual of a solution, as a part of the sources.
const CLOSE: f64 = 1e-10;
/// Steps after which it is given up.
const STEPS: usize = 60;

impl Field {
    /// Prepares the equations. `held` tells the nodes with a potential of zero.
    ///
    /// # Errors
    /// [`FieldError`].
    pub fn new(mesh: Mesh, geometry: Geometry, held: impl Fn([f64; 2]) -> bool) -> Result<Self, FieldError> {
        let count = mesh.order.nodes();
        let used = used(&mesh);
        let mut equation = vec![HELD; mesh.nodes.len()];
        let mut unknowns = 0;
        for ((node, at), used) in mesh.nodes.iter().enumerate().zip(&used) {
            if *used && !held(*at) {
                equation[node] = unknowns;
                unknowns += 1;
            }
        }
        if equation.iter().zip(&used).all(|(e, used)| !used || *e != HELD) {
            return Err(FieldError::Free);
        }
        let memory = || FieldError::Memory { unknowns };
        let groups = |equation: &[usize]| -> Vec<Vec<usize>> {
            mesh.triangles.iter().map(|t| t[..count].iter().map(|n| equation[*n]).collect()).collect()
        };
        let before = groups(&equation);
        let (unordered, _) = Pattern::new(unknowns, before.iter().map(Vec::as_slice), Stored::Lower);
        let place = elimination_order(&unordered).ok_or_else(memory)?;
        for own in equation.iter_mut().filter(|own| **own != HELD) {
            *own = place[*own];
        }
        let ordered = groups(&equation);
        let (pattern, scatter) = Pattern::new(unknowns, ordered.iter().map(Vec::as_slice), Stored::Lower);
        let factor = Factor::new(&pattern).ok_or_else(memory)?;
        let points = (0..mesh.triangles.len()).map(|t| points(&mesh, geometry, t)).collect::<Result<_, _>>()?;
        let mut around = vec![Vec::new(); mesh.nodes.len()];
        for (t, triangle) in mesh.triangles.iter().enumerate() {
            triangle[..count].iter().for_each(|n| around[*n].push(t));
        }
        Ok(Field { mesh, geometry, points, around, equation, pattern, scatter, factor, unknowns })
    }

    /// The mesh.
    #[must_use]
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// Number of equations.
    #[must_use]
    pub fn unknowns(&self) -> usize {
        self.unknowns
    }

    /// Finds the field of these regions, from a potential that may be near (or from none).
    ///
    /// # Errors
    /// [`FieldError::NoMatter`], [`FieldError::Steps`].
    pub fn solve(&mut self, matter: &[Matter], start: Option<&[f64]>) -> Result<Solution, FieldError> {
        if let Some(region) = self.mesh.regions.iter().find(|region| matter.get(**region).is_none()) {
            return Err(FieldError::NoMatter { region: *region });
        }
        let mut potential = start.map_or_else(|| vec![0.0; self.mesh.nodes.len()], <[f64]>::to_vec);
        let mut values = vec![0.0; self.pattern.entries()];
        let mut state = self.assemble(matter, &potential, &mut values);
        let mut left = f64::INFINITY;
        for step in 0..STEPS {
            left = norm(&state.residual) / state.sources.max(f64::MIN_POSITIVE);
            if left <= CLOSE || state.sources == 0.0 {
                return Ok(Solution { potential, steps: step, residual: left });
            }
            if !self.factor.factorise(&self.pattern, &values) {
                break;
            }
            let mut change = state.residual.clone();
            self.factor.solve(&mut change);
            // The residual is the slope of the energy: down along minus the change.
            let fall: f64 = change.iter().zip(&state.residual).map(|(c, r)| c * r).sum();
            let (mut part, before) = (1.0, potential.clone());
            loop {
                for (own, (old, equation)) in potential.iter_mut().zip(before.iter().zip(&self.equation)) {
                    if *equation != HELD {
                        *own = old - part * change[*equation];
                    }
                }
                // With its matrix: the whole step is nearly always taken.
                let next = self.assemble(matter, &potential, &mut values);
                // Armijo's rule, but for what rounding leaves of the energy.
                if next.energy <= state.energy - 1e-4 * part * fall + 1e-13 * state.energy.abs() || part < 1e-4 {
                    state = next;
                    break;
                }
                part *= 0.5;
            }
        }
        Err(FieldError::Steps { steps: STEPS, residual: left })
    }

    /// Residual and energy at a potential, and the matrix into `values`.
    fn assemble(&self, matter: &[Matter], potential: &[f64], values: &mut [f64]) -> State {
        let count = self.mesh.order.nodes();
        let mut state = State { residual: vec![0.0; self.unknowns], energy: 0.0, sources: 0.0 };
        let mut sources = vec![0.0; self.unknowns];
        values.fill(0.0);
        for (t, triangle) in self.mesh.triangles.iter().enumerate() {
            let matter = &matter[self.mesh.regions[t]];
            let own: [f64; NODES] = std::array::from_fn(|n| if n < count { potential[triangle[n]] } else { 0.0 });
            let mut force = [0.0; NODES];
            let mut source = [0.0; NODES];
            let mut tangent = [[0.0; NODES]; NODES];
            for point in &self.points[t] {
                let g = gradient(point, &own);
                let b = g[0].hypot(g[1]);
                let law = matter.law.at(b);
                // H / B, and how it changes with the square of B.
                let secant = if b > 1e-12 { law.h / b } else { law.slope };
                let turn = if b > 1e-12 { (law.slope - secant) / (b * b) } else { 0.0 };
                let volume = point.area * point.width;
                // A magnet pushes along its axis: what its field strength is multiplied with is the flux density.
                let push = self.geometry.turned(matter.coercive);
                let here: f64 = (0..count).map(|n| point.shape[n] * own[n]).sum();
                state.energy += volume * (law.energy - push[0] * g[0] - push[1] * g[1] - matter.current * here);
                for n in 0..count {
                    let s = point.slope[n];
                    let along = g[0] * s[0] + g[1] * s[1];
                    force[n] += volume * secant * along;
                    source[n] += volume * (push[0] * s[0] + push[1] * s[1] + matter.current * point.shape[n]);
                    for (value, o) in tangent[n].iter_mut().zip(&point.slope).take(n + 1) {
                        let other = g[0] * o[0] + g[1] * o[1];
                        *value += volume * (secant * (s[0] * o[0] + s[1] * o[1]) + turn * along * other);
                    }
                }
            }
            for n in 0..count {
                let equation = self.equation[triangle[n]];
                if equation != HELD {
                    state.residual[equation] += force[n] - source[n];
                    sources[equation] += source[n];
                }
            }
            let mut places = self.scatter[t].iter();
            for (n, row) in tangent.iter().enumerate().take(count) {
                for value in row.iter().take(n + 1) {
                    if let Some(place) = places.next().filter(|place| **place != u32::MAX) {
                        values[*place as usize] += value;
                    }
                }
            }
        }
        state.sources = norm(&sources);
        state
    }
}

/// Residual of the free equations, energy, and size of the sources.
struct State {
    residual: Vec<f64>,
    energy: f64,
    sources: f64,
}

fn norm(x: &[f64]) -> f64 {
    x.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// Nodes that belong to a triangle.
fn used(mesh: &Mesh) -> Vec<bool> {
    let mut used = vec![false; mesh.nodes.len()];
    for triangle in &mesh.triangles {
        triangle[..mesh.order.nodes()].iter().for_each(|n| used[*n] = true);
    }
    used
}
