//! The field around a circle or sphere about the origin: air without sources, in closed form.
//!
//! Between the meshed circle of radius R and a boundary of no potential at the radius F (or none, F infinite) the potential
//! is a sum of modes. In the plane they are cos and sin of n times the angle, falling as `(R/r)^n (1 - (r/F)^2n)`; about an
//! axis the associated Legendre functions `P_n^1`, falling as `(R/r)^(n+1) (1 - (r/F)^(2n+1))`. The energy out there is a
//! square of the amplitudes, and these are integrals of the potential along the circle: one dense group of its nodes.

use std::collections::HashMap;
use std::f64::consts::{PI, TAU};

use crate::fem::equations::Equations;
use crate::fem::mesh::Mesh;
use crate::fem::quadrature::gauss;
use crate::fem::triangle::{NODES, SIDES};

use super::point::Geometry;

/// What a mirror at x = 0 does to the flux of a plane magnet whose other half is its image.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mirror {
    /// Flux crosses it at right angles: an image's current flows the same way.
    Across,
    /// Flux runs along it: an image's current flows the other way.
    Along,
}

/// Circle up to which a magnet is meshed, and what lies beyond.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Around {
    /// Radius of the meshed circle or sphere about the origin, mm.
    pub near_mm: f64,
    /// Radius where the potential is zero, mm; `None` where nothing bounds the field.
    pub far_mm: Option<f64>,
    /// Only the half at x of 0 and more is meshed, beside this mirror. Not used about an axis.
    pub mirror: Option<Mirror>,
}

/// Points of integration on a side of the circle: a cubic times a mode that turns by less than half on it.
const POINTS: usize = 8;
/// How near a node must be to the circle, as a part of its radius: sides on an arc have their nodes on it.
const ON_CIRCLE: f64 = 1e-6;

/// A mode of the potential.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Mode {
    /// Its order n.
    order: usize,
    /// It is a sine; about an axis always false.
    is_sine: bool,
    /// Twice the energy at an amplitude of 1, over the reluctivity.
    weight: f64,
}

/// Modes outside of a meshed circle, and how its nodes make them.
#[derive(Debug, Clone)]
pub(super) struct Outside {
    around: Around,
    geometry: Geometry,
    /// Nodes on the circle.
    nodes: Vec<usize>,
    modes: Vec<Mode>,
    /// Amplitude of every mode by the potentials of the nodes, mode after mode.
    amplitudes: Vec<f64>,
}

impl Outside {
    /// Modes around a mesh: as many orders as its circle has sides.
    pub fn new(mesh: &Mesh, geometry: Geometry, around: Around) -> Self {
        let sides = sides(mesh, around.near_mm);
        let count = mesh.order.nodes();
        let mut nodes: Vec<usize> = sides.iter().flat_map(|(t, _)| &mesh.triangles[*t][..count]).copied().collect();
        nodes.retain(|n| is_on(mesh.nodes[*n], around.near_mm));
        nodes.sort_unstable();
        nodes.dedup();
        let modes = modes(geometry, around, sides.len());
        let mut amplitudes = vec![0.0; modes.len() * nodes.len()];
        let rule = gauss(POINTS);
        for (t, side) in sides {
            let place = |n: usize| nodes.binary_search(&mesh.triangles[t][n]).ok();
            let places: [Option<usize>; NODES] = std::array::from_fn(|n| (n < count).then(|| place(n)).flatten());
            for (x, weight) in &rule {
                let (angle, turned, shapes) = on_side(mesh, geometry, (t, side), 0.5 * (1.0 + x));
                let turned = 0.5 * weight * turned;
                each(geometry, &modes, angle, |m, value| {
                    // the image of the half has as much of a mode
                    let value =
                        if around.mirror.is_some() && geometry == Geometry::Plane { 2.0 * value } else { value };
                    for (place, shape) in places.iter().zip(shapes) {
                        if let Some(place) = place {
                            amplitudes[m * nodes.len() + place] += turned * value * shape;
                        }
                    }
                });
            }
        }
        Self { around, geometry, nodes, modes, amplitudes }
    }

    /// Equations of the nodes on the circle.
    pub fn group(&self, equations: &Equations<1>) -> Vec<usize> {
        equations.group(&self.nodes)
    }

    /// Adds the curvature of the energy to the values of a pattern at the places of the circle's group, lower triangle row
    /// by row. `reluctivity` is that of the air, A/(T mm).
    pub fn add(&self, reluctivity: f64, places: &[u32], values: &mut [f64]) {
        let count = self.nodes.len();
        let mut rest = places;
        for i in 0..count {
            let Some((own, after)) = rest.split_at_checked(i + 1) else { return };
            for (j, place) in own.iter().enumerate().filter(|(_, place)| **place != u32::MAX) {
                let rows = self.modes.iter().zip(self.amplitudes.chunks(count));
                let sum: f64 = rows.map(|(mode, row)| mode.weight * row[i] * row[j]).sum();
                values[*place as usize] += reluctivity * sum;
            }
            rest = after;
        }
    }

    /// Amplitudes of the modes of a potential over the mesh's nodes, T mm.
    fn of(&self, potential: &[f64]) -> Vec<f64> {
        let along: Vec<f64> = self.nodes.iter().map(|n| potential[*n]).collect();
        let row = |row: &[f64]| row.iter().zip(&along).map(|(a, b)| a * b).sum();
        self.amplitudes.chunks(self.nodes.len().max(1)).map(row).collect()
    }

    /// Energy of the field out there, in the units of [`super::energy::Energy`].
    pub fn energy(&self, reluctivity: f64, potential: &[f64]) -> f64 {
        let squares = self.of(potential).into_iter().zip(&self.modes).map(|(a, mode)| mode.weight * a * a);
        0.5 * reluctivity * squares.sum::<f64>()
    }

    /// Flux density at a point beyond the circle, along x and y or r and z; `None` for one that is not there.
    pub fn flux_density(&self, potential: &[f64], at: [f64; 2]) -> Option<[f64; 2]> {
        let Around { near_mm, far_mm, .. } = self.around;
        let r = at[0].hypot(at[1]);
        if !(r >= near_mm && far_mm.is_none_or(|far| r <= far)) {
            return None;
        }
        let amplitudes = self.of(potential);
        let angle = angle_of(self.geometry, at);
        Some(match self.geometry {
            Geometry::Plane => self.plane(&amplitudes, r, angle),
            Geometry::Axisymmetric => self.about_axis(&amplitudes, r, angle),
        })
    }

    fn plane(&self, amplitudes: &[f64], r: f64, angle: f64) -> [f64; 2] {
        // slopes of the potential along the radius and around
        let (mut out, mut round) = (0.0, 0.0);
        for (mode, a) in self.modes.iter().zip(amplitudes) {
            let n = mode.order as f64;
            let (value, slope) = self.around.fall(mode.order, r);
            let (sin, cos) = (n * angle).sin_cos();
            let (own, turned) = if mode.is_sine { (sin, n * cos) } else { (cos, -n * sin) };
            out += a * slope * own;
            round += a * value * turned / r;
        }
        let (sin, cos) = angle.sin_cos();
        Geometry::Plane.flux([out * cos - round * sin, out * sin + round * cos])
    }

    fn about_axis(&self, amplitudes: &[f64], r: f64, angle: f64) -> [f64; 2] {
        // along the radius: d(sin P_n^1)/d angle = sin n (n + 1) P_n; around: the slope of the radius times the potential
        let (mut out, mut round) = (0.0, 0.0);
        legendre(self.modes.len(), angle.cos(), |n, p, slope| {
            let (value, falls) = self.around.fall_about_axis(n, r);
            let (a, order) = (amplitudes[n - 1], n as f64);
            out += a * value * order * (order + 1.0) * p / r;
            round -= a * (falls + value / r) * angle.sin() * slope;
        });
        let (sin, cos) = angle.sin_cos();
        [out * sin + round * cos, out * cos - round * sin]
    }
}

impl Around {
    /// Part of the amplitude of mode `n` of the plane that is left at a radius, and its slope.
    fn fall(self, n: usize, r: f64) -> (f64, f64) {
        let Around { near_mm: near, far_mm, .. } = self;
        if n == 0 {
            // A mean potential has no flux where nothing bounds it.
            return far_mm
                .map_or((1.0, 0.0), |far| ((far / r).ln() / (far / near).ln(), -1.0 / (r * (far / near).ln())));
        }
        let n = n as i32;
        let (falls, rises) = ((near / r).powi(n), far_mm.map_or(0.0, |far| (r / far).powi(n) * (near / far).powi(n)));
        let all = 1.0 - far_mm.map_or(0.0, |far| (near / far).powi(2 * n));
        ((falls - rises) / all, -f64::from(n) * (falls + rises) / (r * all))
    }

    /// The same about an axis.
    fn fall_about_axis(self, n: usize, r: f64) -> (f64, f64) {
        let Around { near_mm: near, far_mm, .. } = self;
        let n = n as i32;
        let falls = (near / r).powi(n + 1);
        let rises = far_mm.map_or(0.0, |far| (r / far).powi(n) * (near / far).powi(n + 1));
        let all = 1.0 - far_mm.map_or(0.0, |far| (near / far).powi(2 * n + 1));
        let n = f64::from(n);
        ((falls - rises) / all, -((n + 1.0) * falls + n * rises) / (r * all))
    }
}

/// Modes up to an order, with what their squares weigh.
fn modes(geometry: Geometry, around: Around, most: usize) -> Vec<Mode> {
    let Around { near_mm: near, far_mm, mirror } = around;
    let nears = |power: i32| far_mm.map_or(0.0, |far| (near / far).powi(power));
    let mut modes = Vec::new();
    match geometry {
        Geometry::Plane => {
            // Without a boundary nothing drives the mean potential: any weight makes it zero.
            let mean = far_mm.map_or(1.0, |far| 1.0 / (far / near).ln());
            // Of the energy of a whole circle the meshed half has a half. The potential is the same or the opposite at -x: there
            // the cosine of order n is (-1)^n of itself, and the sine -(-1)^n.
            let share = if mirror.is_some() { 0.5 } else { 1.0 };
            let belongs = |order: usize, is_sine: bool| {
                let is_same = (order.is_multiple_of(2)) != is_sine;
                mirror.is_none_or(|mirror| is_same == (mirror == Mirror::Across))
            };
            if belongs(0, false) {
                modes.push(Mode { order: 0, is_sine: false, weight: share * TAU * mean });
            }
            for order in 1..=most {
                let q = nears(2 * order as i32);
                let weight = share * PI * order as f64 * (1.0 + q) / (1.0 - q);
                let both = [false, true].into_iter().filter(|is_sine| belongs(order, *is_sine));
                modes.extend(both.map(|is_sine| Mode { order, is_sine, weight }));
            }
        }
        Geometry::Axisymmetric => {
            for order in 1..=most {
                let (n, q) = (order as f64, nears(2 * order as i32 + 1));
                let square = 2.0 * n * (n + 1.0) / (2.0 * n + 1.0);
                modes.push(Mode { order, is_sine: false, weight: near * square * (n + (n + 1.0) * q) / (1.0 - q) });
            }
        }
    }
    modes
}

/// What the potential at an angle is multiplied with for the amplitude of every mode.
fn each(geometry: Geometry, modes: &[Mode], angle: f64, mut add: impl FnMut(usize, f64)) {
    match geometry {
        Geometry::Plane => {
            for (m, mode) in modes.iter().enumerate() {
                let (sin, cos) = (mode.order as f64 * angle).sin_cos();
                let norm = if mode.order == 0 { TAU } else { PI };
                add(m, if mode.is_sine { sin } else { cos } / norm);
            }
        }
        Geometry::Axisymmetric => legendre(modes.len(), angle.cos(), |n, _, slope| {
            let order = n as f64;
            let square = 2.0 * order * (order + 1.0) / (2.0 * order + 1.0);
            add(n - 1, angle.sin() * angle.sin() * slope / square);
        }),
    }
}

/// Legendre's polynomials of the orders 1 to `most` at a cosine, and their slopes by it.
fn legendre(most: usize, x: f64, mut of: impl FnMut(usize, f64, f64)) {
    let (mut before, mut p, mut slope_before, mut slope) = (1.0, x, 0.0, 1.0);
    for n in 1..=most {
        of(n, p, slope);
        let k = n as f64;
        // Bonnet's recursion, and P'_(n+1) = P'_(n-1) + (2n + 1) P_n.
        (before, p, slope_before, slope) =
            (p, ((2.0 * k + 1.0) * x * p - k * before) / (k + 1.0), slope, slope_before + (2.0 * k + 1.0) * p);
    }
}

fn is_on([x, y]: [f64; 2], radius: f64) -> bool {
    (x.hypot(y) / radius - 1.0).abs() < ON_CIRCLE
}

/// A triangle and the corners of one of its sides.
type Side = (usize, (usize, usize));

/// Triangles with a side on the circle. A side between two triangles is a chord.
fn sides(mesh: &Mesh, radius: f64) -> Vec<Side> {
    let mut sides: HashMap<[usize; 2], Option<Side>> = HashMap::new();
    for (t, triangle) in mesh.triangles.iter().enumerate() {
        for side in SIDES {
            let (a, b) = (triangle[side.0], triangle[side.1]);
            if is_on(mesh.nodes[a], radius) && is_on(mesh.nodes[b], radius) {
                sides.entry([a.min(b), a.max(b)]).and_modify(|own| *own = None).or_insert(Some((t, side)));
            }
        }
    }
    let mut sides: Vec<Side> = sides.into_values().flatten().collect();
    sides.sort_unstable();
    sides
}

/// Angle of a place from 0 to 1 on a side, how fast it turns there, and the triangle's shape functions.
fn on_side(mesh: &Mesh, geometry: Geometry, (t, (from, to)): Side, place: f64) -> (f64, f64, [f64; NODES]) {
    let (mut l, mut along) = ([0.0; 3], [0.0; 3]);
    (l[from], l[to]) = (1.0 - place, place);
    (along[from], along[to]) = (-1.0, 1.0);
    let (shapes, slopes) = (mesh.order.shapes(l), mesh.order.slopes(l));
    let (mut x, mut moved) = ([0.0; 2], [0.0; 2]);
    for (n, node) in mesh.triangles[t].iter().enumerate().take(mesh.order.nodes()) {
        let slope = slopes[n][0] * along[1] + slopes[n][1] * along[2];
        for (k, p) in mesh.nodes[*node].into_iter().enumerate() {
            x[k] += shapes[n] * p;
            moved[k] += slope * p;
        }
    }
    let turned = (x[0] * moved[1] - x[1] * moved[0]).abs() / (x[0] * x[0] + x[1] * x[1]);
    (angle_of(geometry, x), turned, shapes)
}

/// The angle in which a place is: from +x, or about an axis from +z.
fn angle_of(geometry: Geometry, at: [f64; 2]) -> f64 {
    match geometry {
        Geometry::Plane => at[1].atan2(at[0]),
        Geometry::Axisymmetric => at[0].atan2(at[1]),
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::fem::drawing::Curve;
    use crate::fem::mesh::mesh;
    use crate::fem::triangle::Order;

    const NEAR_MM: f64 = 10.0;

    fn disc(geometry: Geometry, order: Order) -> Mesh {
        let curves = match geometry {
            Geometry::Plane => vec![Curve::circle([0.0; 2], NEAR_MM)],
            Geometry::Axisymmetric => vec![
                Curve::Arc { centre: [0.0; 2], radius: NEAR_MM, from: -0.5 * PI, to: 0.5 * PI },
                Curve::Line([0.0, NEAR_MM], [0.0, -NEAR_MM]),
            ],
        };
        let inside = |p: [f64; 2]| {
            let right = geometry == Geometry::Plane || p[0] > 0.0;
            (right && p[0].hypot(p[1]) < NEAR_MM).then_some(0)
        };
        mesh(&curves, order, &|_| 1.0, &inside).unwrap()
    }

    /// A potential outside, by place: its value, and its flux density.
    type Known = fn([f64; 2]) -> (f64, [f64; 2]);

    /// Two currents of 1 A into and out of the plane at x = +-3: A = mu0/4pi ln(r1^2/r2^2), with mu0 = 4 pi.
    fn wires([x, y]: [f64; 2]) -> (f64, [f64; 2]) {
        let (a, b) = ((x + 3.0).powi(2) + y * y, (x - 3.0).powi(2) + y * y);
        let slope = [2.0 * (x + 3.0) / a - 2.0 * (x - 3.0) / b, 2.0 * y / a - 2.0 * y / b];
        ((a / b).ln(), [slope[1], -slope[0]])
    }

    /// A magnetic dipole along the axis at z = 4: A = r / d^3.
    fn dipole([r, z]: [f64; 2]) -> (f64, [f64; 2]) {
        let up = z - 4.0;
        let d = r.hypot(up);
        (r / d.powi(3), [3.0 * r * up / d.powi(5), (2.0 * up * up - r * r) / d.powi(5)])
    }

    #[test]
    fn wires_and_a_dipole_go_on_beyond_the_circle() {
        let cases: [(Geometry, Known, f64); 2] =
            [(Geometry::Plane, wires, 3e-4), (Geometry::Axisymmetric, dipole, 1e-3)];
        for (geometry, known, close) in cases {
            let mesh = disc(geometry, Order::Third);
            let outside = Outside::new(&mesh, geometry, Around { near_mm: NEAR_MM, far_mm: None, mirror: None });
            let potential: Vec<f64> = mesh.nodes.iter().map(|p| known(*p).0).collect();
            for at in [[8.0, 8.0], [0.5, 12.0], [20.0, -3.0], [30.0, -40.0]] {
                let (found, told) = (outside.flux_density(&potential, at).unwrap(), known(at).1);
                let (off, size) = ((found[0] - told[0]).hypot(found[1] - told[1]), told[0].hypot(told[1]));
                assert!(off < close * size, "{geometry:?} {at:?}: {found:?} for {told:?}");
            }
            assert_eq!(outside.flux_density(&potential, [0.0, 9.0]), None);
        }
    }

    /// The energy out there is half the integral of potential times field strength over the circle.
    #[test]
    fn the_energy_is_that_of_the_integral_over_the_circle() {
        let cases: [(Geometry, Known); 2] = [(Geometry::Plane, wires), (Geometry::Axisymmetric, dipole)];
        for (geometry, known) in cases {
            let mesh = disc(geometry, Order::Third);
            let outside = Outside::new(&mesh, geometry, Around { near_mm: NEAR_MM, far_mm: None, mirror: None });
            let potential: Vec<f64> = mesh.nodes.iter().map(|p| known(*p).0).collect();
            let turn = if geometry == Geometry::Plane { TAU } else { PI };
            let parts = 4000;
            let integral: f64 = (0..parts)
                .map(|i| turn * (f64::from(i) + 0.5) / f64::from(parts))
                .map(|angle| {
                    let ([x, y], width) = match geometry {
                        Geometry::Plane => ([angle.cos(), angle.sin()].map(|v| NEAR_MM * v), 1.0),
                        Geometry::Axisymmetric => {
                            ([angle.sin(), angle.cos()].map(|v| NEAR_MM * v), NEAR_MM * angle.sin())
                        }
                    };
                    let (a, b) = known([x, y]);
                    // the field strength along the circle: in the plane counter-clockwise, about an axis from +z on
                    let along = match geometry {
                        Geometry::Plane => (x * b[1] - y * b[0]) / NEAR_MM,
                        Geometry::Axisymmetric => (y * b[0] - x * b[1]) / NEAR_MM,
                    };
                    0.5 * a * along * width * NEAR_MM * turn / f64::from(parts)
                })
                .sum();
            let found = outside.energy(1.0, &potential);
            assert!((found / integral - 1.0).abs() < 1e-3, "{geometry:?}: {found} for {integral}");
        }
    }

    #[test]
    fn a_far_boundary_holds_the_potential() {
        let around = Around { near_mm: 10.0, far_mm: Some(25.0), mirror: None };
        for n in 0..6 {
            for (name, fall) in
                [("plane", Around::fall as fn(Around, usize, f64) -> (f64, f64)), ("axis", Around::fall_about_axis)]
            {
                if n == 0 && name == "axis" {
                    continue;
                }
                assert!((fall(around, n, 10.0).0 - 1.0).abs() < 1e-14 && fall(around, n, 25.0).0.abs() < 1e-14);
                let step = 1e-5;
                let quotient = (fall(around, n, 15.0 + step).0 - fall(around, n, 15.0 - step).0) / (2.0 * step);
                assert!((quotient - fall(around, n, 15.0).1).abs() < 1e-8, "{name} {n}");
            }
        }
    }
}
