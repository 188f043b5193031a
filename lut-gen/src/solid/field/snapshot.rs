//! One equilibrium as fields over the mesh.

use super::PointState;
use crate::fem::quadrature::gauss;
use crate::fem::shape::{line3, quad8};
use crate::solid::contact::{Ball, Surface};
use crate::solid::law::Gradient;
use crate::solid::mesh::BlockMesh;
use crate::solid::solve::SolveError;

/// Why there are no fields.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FieldError {
    /// No equilibrium was found.
    #[error(transparent)]
    Solve(#[from] SolveError),
    /// The displacement turns an element inside out, so there are no stretches.
    #[error("element {element} is turned inside out at depth {depth_mm} mm")]
    Inverted {
        /// Index of the element.
        element: usize,
        /// Depth of the ball (mm).
        depth_mm: f64,
    },
    /// Fields describe a ball; a platen presses here.
    #[error("fields are for a ball, but a platen presses the specimen")]
    Platen,
    /// Displacements that do not belong to the mesh.
    #[error("displacements of {given} nodes given, but the mesh has {nodes}")]
    Nodes {
        /// Nodes of the displacement.
        given: usize,
        /// Nodes of the mesh.
        nodes: usize,
    },
}

/// Where on its path a simulation is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    /// Time since the motion's start (s).
    pub time_s: f64,
    /// Depth of the ball's lowest point below the undeformed top (mm).
    pub depth_mm: f64,
    /// Force on the ball (N), upward.
    pub force_n: f64,
}

/// Fields of a block at one step.
///
/// Strain and stress are computed at the 2 x 2 quadrature points, where they are most accurate,
/// carried bilinearly to the nodes of each element (Hinton and Campbell, 1974,
/// doi:10.1002/nme.1620080303) and averaged over the elements that meet at a node. Stretches are
/// carried as logarithms, so that they stay positive; Mises' stress is that of the averaged tensor.
#[derive(Debug, Clone, PartialEq)]
pub struct Field {
    /// Reference positions `[r, z]` (mm), base at z = 0.
    pub nodes: Vec<[f64; 2]>,
    /// Nodes of each element: four corners counter-clockwise, then the middles of the sides from the first corner on.
    pub elements: Vec<[usize; 8]>,
    /// Edges of the top from the axis outward: inner, middle, outer node.
    pub top: Vec<[usize; 3]>,
    /// Displacement `[r, z]` of each node (mm).
    pub displacement_mm: Vec<[f64; 2]>,
    /// Strain and stress at each node.
    pub state: Vec<PointState>,
    /// Contact pressure at each node (MPa per current area); 0 off the contact.
    pub pressure_mpa: Vec<f64>,
    /// The ball.
    pub ball: Ball,
    /// Height of the undeformed block (mm).
    pub height_mm: f64,
    /// Depth and force.
    pub step: Step,
}

impl Field {
    /// Fields of a mesh at a displacement (mm, one `[r, z]` a node).
    ///
    /// `stress` gives the first Piola-Kirchhoff stress (MPa) at a material point and its gradient, `None`
    /// where that turns the point inside out. Points are counted over the 2 x 2 points of one element
    /// after the other, as in [`crate::solid::solve::History`].
    ///
    /// # Errors
    /// [`FieldError::Nodes`], [`FieldError::Inverted`] and [`FieldError::Platen`].
    pub fn new(
        mesh: &BlockMesh,
        displacement_mm: Vec<[f64; 2]>,
        stress: impl Fn(usize, &Gradient) -> Option<[f64; 5]>,
        surface: &Surface,
        step: Step,
    ) -> Result<Self, FieldError> {
        let (given, nodes) = (displacement_mm.len(), mesh.nodes.len());
        if given != nodes {
            return Err(FieldError::Nodes { given, nodes });
        }
        let ball = surface.ball().ok_or(FieldError::Platen)?;
        let state = nodal_states(mesh, &displacement_mm, stress)
            .map_err(|element| FieldError::Inverted { element, depth_mm: step.depth_mm })?;
        let mut field = Self {
            nodes: mesh.nodes.clone(),
            elements: mesh.elements.clone(),
            top: mesh.top.clone(),
            displacement_mm,
            state,
            pressure_mpa: vec![0.0; nodes],
            ball,
            height_mm: mesh.height_mm,
            step,
        };
        field.pressure_mpa = field.pressures(surface);
        Ok(field)
    }

    /// Current position `[r, z]` of a node (mm).
    #[must_use]
    pub fn position_mm(&self, node: usize) -> [f64; 2] {
        let (x, u) = (self.nodes[node], self.displacement_mm[node]);
        [x[0] + u[0], x[1] + u[1]]
    }

    /// Height of the ball's centre above the base (mm).
    #[must_use]
    pub fn centre_mm(&self) -> f64 {
        self.height_mm + self.ball.radius_mm - self.step.depth_mm
    }

    /// Largest nodal Mises stress (MPa).
    #[must_use]
    pub fn largest_mises_mpa(&self) -> f64 {
        self.state.iter().map(PointState::mises_mpa).fold(0.0, f64::max)
    }

    /// Pressure at the nodes of the top: the penalty's pressure, which is per reference area, over
    /// the ratio of current to reference area, averaged where two edges meet.
    fn pressures(&self, surface: &Surface) -> Vec<f64> {
        let mut sum = vec![0.0; self.nodes.len()];
        let mut count = vec![0_u32; self.nodes.len()];
        for edge in &self.top {
            for (node, at) in edge.iter().zip([-1.0, 0.0, 1.0]) {
                let x = self.position_mm(*node);
                let nominal = surface.pressure_mpa(x, self.centre_mm());
                sum[*node] += nominal / self.area_ratio(edge, at);
                count[*node] += 1;
            }
        }
        sum.iter().zip(&count).map(|(p, n)| if *n > 0 { p / f64::from(*n) } else { 0.0 }).collect()
    }

    /// Current over reference area of the top at the natural coordinate `at` of an edge. On the
    /// axis the ratio of the radii is that of their slopes.
    fn area_ratio(&self, edge: &[usize; 3], at: f64) -> f64 {
        let (shape, slope) = line3(at);
        let (mut x, mut dx, mut r, mut dr) = ([0.0; 2], [0.0; 2], 0.0, 0.0);
        for (i, &node) in edge.iter().enumerate() {
            let p = self.position_mm(node);
            for k in 0..2 {
                x[k] += shape[i] * p[k];
                dx[k] += slope[i] * p[k];
            }
            r += shape[i] * self.nodes[node][0];
            dr += slope[i] * self.nodes[node][0];
        }
        let hoop = if r > 0.0 { x[0] / r } else { dx[0] / dr };
        hoop * dx[0].hypot(dx[1]) / dr
    }
}

/// Natural coordinates of the nodes of an element.
const NATURAL: [[f64; 2]; 8] =
    [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0], [0.0, -1.0], [1.0, 0.0], [0.0, 1.0], [-1.0, 0.0]];

/// States at the nodes, or the first element that is turned inside out.
fn nodal_states(
    mesh: &BlockMesh,
    u: &[[f64; 2]],
    stress: impl Fn(usize, &Gradient) -> Option<[f64; 5]>,
) -> Result<Vec<PointState>, usize> {
    // logarithms of three stretches, then four stresses
    let mut sum = vec![[0.0; 7]; mesh.nodes.len()];
    let mut count = vec![0_u32; mesh.nodes.len()];
    let rule: Vec<f64> = gauss(2).iter().map(|(x, _)| *x).collect();
    for (index, element) in mesh.elements.iter().enumerate() {
        let (x, v) = (element.map(|n| mesh.nodes[n]), element.map(|n| u[n]));
        for (i, &a) in rule.iter().enumerate() {
            for (j, &b) in rule.iter().enumerate() {
                let f = gradient(&x, &v, a, b);
                let state = PointState::new(&f, &stress(4 * index + 2 * i + j, &f).ok_or(index)?);
                let ([l1, l2, l3], [rr, zz, tt, rz]) = (state.stretch.map(f64::ln), state.cauchy_mpa);
                for (node, [p, q]) in element.iter().zip(NATURAL) {
                    // bilinear functions that are 1 at one quadrature point and 0 at the others
                    let share = 0.25 * (1.0 + p * a / (a * a)) * (1.0 + q * b / (b * b));
                    for (s, value) in sum[*node].iter_mut().zip([l1, l2, l3, rr, zz, tt, rz]) {
                        *s += share * value;
                    }
                }
            }
        }
        for node in element {
            count[*node] += 1;
        }
    }
    let mean = |(s, n): (&[f64; 7], &u32)| {
        let s = s.map(|value| value / f64::from(*n));
        PointState { stretch: [s[0], s[1], s[2]].map(f64::exp), cauchy_mpa: [s[3], s[4], s[5], s[6]] }
    };
    Ok(sum.iter().zip(&count).map(mean).collect())
}

/// Deformation gradient at natural coordinates `(a, b)` of an element with reference positions `x`.
fn gradient(x: &[[f64; 2]; 8], u: &[[f64; 2]; 8], a: f64, b: f64) -> Gradient {
    let (n, d) = quad8(a, b);
    // [derivative of r, z, u_r, u_z by a and b], radius and its change
    let (mut jacobian, mut radius, mut change) = ([[0.0; 2]; 4], 0.0, 0.0);
    for i in 0..8 {
        for k in 0..2 {
            jacobian[0][k] += d[i][k] * x[i][0];
            jacobian[1][k] += d[i][k] * x[i][1];
            jacobian[2][k] += d[i][k] * u[i][0];
            jacobian[3][k] += d[i][k] * u[i][1];
        }
        radius += n[i] * x[i][0];
        change += n[i] * u[i][0];
    }
    let [r, z, ur, uz] = jacobian;
    let det = r[0] * z[1] - r[1] * z[0];
    let by_r = |g: [f64; 2]| (g[0] * z[1] - g[1] * z[0]) / det;
    let by_z = |g: [f64; 2]| (g[1] * r[0] - g[0] * r[1]) / det;
    [1.0 + by_r(ur), by_z(ur), by_r(uz), 1.0 + by_z(uz), 1.0 + change / radius]
}
