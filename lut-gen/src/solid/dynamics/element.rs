//! Internal force of one element in the current configuration.

use crate::fem::quadrature::gauss;
use crate::fem::shape::quad8;
use crate::solid::element::{DOFS, Matter, Quadrature};
use crate::solid::law::Gradient;

/// One quadrature point.
#[derive(Debug, Clone)]
struct Point {
    shape: [f64; 8],
    /// Derivatives of the shape functions by the natural coordinates.
    slope: [[f64; 2]; 8],
    weight: f64,
    /// Inverse of the reference Jacobian, `d natural / d reference`, row by row (1/mm).
    from_reference: [[f64; 2]; 2],
    /// Its determinant's inverse (mm^2).
    reference_area: f64,
    /// Reference radius (mm).
    radius: f64,
}

/// Where a point is now: `d current / d natural` (mm) and radius (mm).
struct Current {
    jacobian: [[f64; 2]; 2],
    radius: f64,
}

/// An eight-node ring element in the updated-Lagrangian form.
///
/// Virtual work over the current volume, `f_a = integral sigma grad N_a dv` with the Cauchy stress
/// `sigma` and gradients by the current position. As `sigma dv = P F^T dV` and `grad N = F^-T Grad N`, it is the
/// total-Lagrangian force `integral P Grad N_a dV` of [`crate::solid::element::Solid`] point by point: the
/// two differ by rounding only (tested), and only in what has to be stored and inverted.
#[derive(Debug, Clone)]
pub struct UpdatedElement {
    /// Its nodes, in the order of [`quad8`].
    pub nodes: [usize; 8],
    points: Vec<Point>,
}

impl UpdatedElement {
    /// Prepares an element with the reference positions `x` (mm).
    #[must_use]
    pub fn new(nodes: [usize; 8], x: &[[f64; 2]; 8], quadrature: Quadrature) -> Self {
        let rule = gauss(match quadrature {
            Quadrature::Reduced => 2,
            Quadrature::Full => 3,
        });
        let points = rule.iter().flat_map(|&(a, wa)| rule.iter().map(move |&(b, wb)| (a, b, wa * wb)));
        Self { nodes, points: points.map(|(a, b, weight)| Point::new(x, a, b, weight)).collect() }
    }

    /// Number of material points.
    #[must_use]
    pub fn points(&self) -> usize {
        self.points.len()
    }

    /// Adds the internal force (N) at the current positions `x` (mm) to `force` and returns the strain
    /// energy (N mm) of the elastic law; `new` receives the history at the step's end. `None` when the
    /// element is turned inside out.
    #[must_use]
    pub fn force(
        &self,
        matter: &Matter,
        old: &[f64],
        x: &[[f64; 2]; 8],
        force: &mut [f64; DOFS],
        mut new: Option<&mut [f64]>,
    ) -> Option<f64> {
        let each = matter.material.history();
        let mut energy = 0.0;
        for (i, point) in self.points.iter().enumerate() {
            let range = i * each..(i + 1) * each;
            let (f, current) = point.deformation(x);
            let kept = new.as_deref_mut().map(|h| &mut h[range.clone()]);
            let (w, p) = matter.material.stress(matter.step, &f, &old[range], kept)?;
            point.add_force(&f, &p, &current, force);
            energy += w * std::f64::consts::TAU * point.radius * point.reference_area * point.weight;
        }
        Some(energy)
    }
}

impl Point {
    fn new(x: &[[f64; 2]; 8], a: f64, b: f64, weight: f64) -> Self {
        let (shape, slope) = quad8(a, b);
        let (j, radius) = jacobian(&shape, &slope, x);
        let (from_reference, reference_area) = inverse(&j);
        Self { shape, slope, weight, from_reference, reference_area, radius }
    }

    /// Deformation gradient, and the current Jacobian with its radius.
    fn deformation(&self, x: &[[f64; 2]; 8]) -> (Gradient, Current) {
        let (j, r) = jacobian(&self.shape, &self.slope, x);
        let g = &self.from_reference;
        let product = |i: usize, k: usize| j[i][0] * g[0][k] + j[i][1] * g[1][k];
        let f = [product(0, 0), product(0, 1), product(1, 0), product(1, 1), r / self.radius];
        (f, Current { jacobian: j, radius: r })
    }

    /// `integral sigma grad N dv` over the current volume of the point, `2 pi r det(j) w`.
    fn add_force(&self, f: &Gradient, p: &[f64; 5], current: &Current, force: &mut [f64; DOFS]) {
        let (to_natural, area) = inverse(&current.jacobian);
        let r = current.radius;
        let volume = std::f64::consts::TAU * r * area * self.weight;
        // Cauchy stress P F^T / J times that volume
        let s = volume / ((f[0] * f[3] - f[1] * f[2]) * f[4]);
        let rr = s * (p[0] * f[0] + p[1] * f[1]);
        let rz = s * (p[0] * f[2] + p[1] * f[3]);
        let zz = s * (p[2] * f[2] + p[3] * f[3]);
        let tt_over_r = s * p[4] * f[4] / r;
        for (a, d) in self.slope.iter().enumerate() {
            let by_r = d[0] * to_natural[0][0] + d[1] * to_natural[1][0];
            let by_z = d[0] * to_natural[0][1] + d[1] * to_natural[1][1];
            force[2 * a] += rr * by_r + rz * by_z + tt_over_r * self.shape[a];
            force[2 * a + 1] += rz * by_r + zz * by_z;
        }
    }
}

/// `[d r, d z] / d natural` and the radius.
pub(super) fn jacobian(shape: &[f64; 8], slope: &[[f64; 2]; 8], x: &[[f64; 2]; 8]) -> ([[f64; 2]; 2], f64) {
    let (mut j, mut radius) = ([[0.0; 2]; 2], 0.0);
    for i in 0..8 {
        radius += shape[i] * x[i][0];
        for k in 0..2 {
            j[k][0] += slope[i][0] * x[i][k];
            j[k][1] += slope[i][1] * x[i][k];
        }
    }
    (j, radius)
}

/// Inverse and determinant.
fn inverse(j: &[[f64; 2]; 2]) -> ([[f64; 2]; 2], f64) {
    let det = j[0][0] * j[1][1] - j[0][1] * j[1][0];
    ([[j[1][1] / det, -j[0][1] / det], [-j[1][0] / det, j[0][0] / det]], det)
}
