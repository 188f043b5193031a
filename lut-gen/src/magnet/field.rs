//! Magnetostatics in the plane and about an axis: the vector potential that makes the energy least.
//!
//! In the plane the potential A has the flux density (dA/dy, -dA/dx), about an axis (-dA/dz, dA/dr + A/r). Both have
//! |B| = |g| with g = (dA/dx, dA/dy), or (dA/dr + A/r, dA/dz), and the same energy, per mm of depth or per radian:
//! `integral (W(|B|) - M . B - J A) w` with w = 1 or r. It is convex, and its minimum is the field. A itself and not r A is
//! the unknown about an axis, for it is smooth there: r A over r loses an order.

use crate::fem::equations::Equations;
use crate::fem::krylov::dot;
use crate::fem::locate::Locator;
use crate::fem::mesh::Mesh;
use crate::fem::newton::{Found, Newton};
use crate::fem::sparse::{Factor, HELD, Pattern, Scatter, Stored, elimination_order};
use crate::fem::triangle::NODES;

use super::bh::Law;
pub use super::outside::Around;
use super::outside::Outside;
pub use super::point::Geometry;
use super::point::{Isotropic, Parts, Point};
use super::potential::{Potential, Square, add_load};

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
    /// Triangles around every node.
    pub(super) around: Vec<Vec<usize>>,
    pub(super) locator: Locator,
    /// Shape functions at the points of every triangle's rule.
    shapes: Vec<[f64; NODES]>,
    equations: Equations<1>,
    parts: Parts,
    pattern: Pattern,
    scatter: Scatter,
    factor: Factor,
    square: Square,
    pub(super) outside: Option<Outside>,
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

impl Solution {
    /// The potential as far beyond this one as `part` of the way here from `before`: where to start for currents that
    /// go on alike. `None` for a solution of another mesh.
    #[must_use]
    pub fn beyond(&self, before: &Solution, part: f64) -> Option<Vec<f64>> {
        let pairs = self.potential.iter().zip(&before.potential);
        (self.potential.len() == before.potential.len()).then(|| pairs.map(|(a, b)| a + part * (a - b)).collect())
    }
}

/// Residual of a solution, as a part of the sources: the potential is then exact to about 1e-10, a millionth of what
/// meshes leave.
const CLOSE: f64 = 1e-8;
/// Steps after which it is given up.
const STEPS: usize = 60;
/// Fall of the residual for which a correction by the last factor is made: one costs a third of a step.
const CHORD: f64 = 0.4;

impl Field {
    /// Prepares the equations. `held` tells the nodes with a potential of zero; `around` is what lies beyond the mesh if it
    /// is a circle.
    ///
    /// # Errors
    /// [`FieldError`].
    pub fn new(
        mesh: Mesh,
        geometry: Geometry,
        around: Option<Around>,
        held: impl Fn([f64; 2]) -> bool,
    ) -> Result<Self, FieldError> {
        let outside = around.map(|around| Outside::new(&mesh, geometry, around));
        let count = mesh.order.nodes();
        let mut triangles = vec![Vec::new(); mesh.nodes.len()];
        for (t, triangle) in mesh.triangles.iter().enumerate() {
            triangle[..count].iter().for_each(|n| triangles[*n].push(t));
        }
        // nodes without a triangle have no equation either
        let nodes = || mesh.nodes.iter().zip(&triangles).map(|(at, triangles)| (held(*at), !triangles.is_empty()));
        if outside.is_none() && nodes().all(|(held, used)| !(held && used)) {
            return Err(FieldError::Free);
        }
        let mut equations = Equations::<1>::number(nodes().map(|(held, used)| [held || !used]));
        let unknowns = equations.unknowns();
        let memory = || FieldError::Memory { unknowns };
        let groups = |equations: &Equations<1>| -> Vec<Vec<usize>> {
            let own = mesh.triangles.iter().map(|t| equations.group(&t[..count]));
            own.chain(outside.iter().map(|outside| outside.group(equations))).collect()
        };
        let before = groups(&equations);
        let (unordered, _) = Pattern::new(unknowns, before.iter().map(Vec::as_slice), Stored::Lower);
        equations.renumber(&elimination_order(&unordered).ok_or_else(memory)?);
        let ordered = groups(&equations);
        let (pattern, scatter) = Pattern::new(unknowns, ordered.iter().map(Vec::as_slice), Stored::Lower);
        let degenerate =
            |t: usize| FieldError::Degenerate { region: mesh.regions[t], at: mesh.nodes[mesh.triangles[t][0]] };
        Ok(Field {
            factor: Factor::new(&pattern).ok_or_else(memory)?,
            parts: Parts::new(&mesh, geometry, equations.clone()).map_err(degenerate)?,
            locator: Locator::new(&mesh),
            shapes: mesh.order.rule().iter().map(|(l, _)| mesh.order.shapes(*l)).collect(),
            square: Square::default(),
            mesh,
            geometry,
            around: triangles,
            outside,
            equations,
            pattern,
            scatter,
        })
    }

    /// The mesh.
    #[must_use]
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// Number of equations.
    #[must_use]
    pub fn unknowns(&self) -> usize {
        self.equations.unknowns()
    }

    /// Points of a triangle.
    pub(super) fn points(&self, t: usize) -> impl Iterator<Item = Point> {
        let at = self.mesh.places(t);
        self.parts.points(t).into_iter().zip(&self.shapes).map(move |((volume, slope), shape)| {
            let width = match self.geometry {
                Geometry::Plane => 1.0,
                Geometry::Axisymmetric => shape.iter().zip(&at).map(|(n, x)| n * x[0]).sum(),
            };
            Point { area: volume / width, width, shape: *shape, slope }
        })
    }

    /// Finds the field of these regions, from a potential that may be near (or from none).
    ///
    /// # Errors
    /// [`FieldError::NoMatter`], [`FieldError::Steps`].
    pub fn solve(&mut self, matter: &[Matter], start: Option<&[f64]>) -> Result<Solution, FieldError> {
        if let Some(region) = self.mesh.regions.iter().find(|region| matter.get(**region).is_none()) {
            return Err(FieldError::NoMatter { region: *region });
        }
        let load = self.load(matter);
        let sources = dot(&load, &load).sqrt();
        let mut potential = vec![0.0; self.mesh.nodes.len()];
        if sources == 0.0 {
            return Ok(Solution { potential, steps: 0, residual: 0.0 });
        }
        let mut x = vec![0.0; self.unknowns()];
        for (value, equation) in start.into_iter().flatten().zip(self.equations.list()) {
            if *equation != HELD {
                x[*equation] = *value;
            }
        }
        let laws = matter.iter().map(|m| &m.law);
        self.square.renew(&self.parts, &self.mesh, laws, &self.pattern, &self.scatter, self.outside.as_ref());
        let found = self.minimise(matter, &load, CLOSE * sources, &mut x);
        let residual = found.left / sources;
        if !found.closed {
            return Err(FieldError::Steps { steps: found.steps, residual });
        }
        for (value, equation) in potential.iter_mut().zip(self.equations.list()) {
            if *equation != HELD {
                *value = x[*equation];
            }
        }
        Ok(Solution { potential, steps: found.steps, residual })
    }

    fn minimise(&mut self, matter: &[Matter], load: &[f64], close: f64, x: &mut Vec<f64>) -> Found {
        let newton = Newton { close, steps: STEPS, chord: CHORD, growth: 0.0 };
        let Field { parts, mesh, pattern, scatter, factor, square, .. } = self;
        let curved = |m: &Matter| !matches!(m.law, Law::Linear(_));
        let laws: Vec<_> = matter.iter().map(|m| curved(m).then(|| Isotropic::of(&m.law))).collect();
        let square = square.values();
        let regions = &mesh.regions;
        match parts {
            Parts::First(domain) => {
                let energy = Potential { domain, regions, laws, pattern, scatter, square, load };
                newton.minimise(&energy, pattern, factor, x)
            }
            Parts::Second(domain) => {
                let energy = Potential { domain, regions, laws, pattern, scatter, square, load };
                newton.minimise(&energy, pattern, factor, x)
            }
            Parts::Third(domain) => {
                let energy = Potential { domain, regions, laws, pattern, scatter, square, load };
                newton.minimise(&energy, pattern, factor, x)
            }
        }
    }

    /// What currents and magnets push the equations with.
    fn load(&self, matter: &[Matter]) -> Vec<f64> {
        let count = self.mesh.order.nodes();
        let mut load = vec![0.0; self.unknowns()];
        for (t, region) in self.mesh.regions.iter().enumerate() {
            let Matter { current, coercive, .. } = matter[*region];
            if current != 0.0 || coercive != [0.0; 2] {
                // A magnet pushes along its axis: what its field strength is multiplied with is the flux density.
                let push = self.geometry.turned(coercive);
                let equations = self.equations.group(&self.mesh.triangles[t][..count]);
                add_load(&self.parts.points(t), &self.shapes, push, current, &equations, &mut load);
            }
        }
        load
    }
}
