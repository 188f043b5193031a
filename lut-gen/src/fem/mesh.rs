//! Graded triangle meshes of drawings: constrained Delaunay, refined to a wanted size, sides on their circles.

use std::collections::HashMap;

use spade::{AngleLimit, ConstrainedDelaunayTriangulation, HasPosition, Point2, RefinementParameters, Triangulation};

use super::drawing::{Curve, cut};
use super::triangle::{NODES, Order};

/// A mesh of triangles.
#[derive(Debug, Clone, PartialEq)]
pub struct Mesh {
    /// Order of its triangles.
    pub order: Order,
    /// Positions of the nodes, mm.
    pub nodes: Vec<[f64; 2]>,
    /// Nodes of the triangles, corners counter-clockwise and then the middles; of first order only the corners count.
    pub triangles: Vec<[usize; NODES]>,
    /// Region of every triangle.
    pub regions: Vec<usize>,
}

impl Mesh {
    /// Positions of a triangle's nodes, mm; those that its order has not are of no meaning.
    #[must_use]
    pub fn places(&self, triangle: usize) -> [[f64; 2]; NODES] {
        self.triangles[triangle].map(|n| self.nodes[n])
    }
}

/// A drawing that cannot be meshed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MeshError {
    /// A coordinate or size is not usable.
    #[error("{what} is {value}: expected {expected}")]
    Value {
        /// Which one.
        what: &'static str,
        /// The value.
        value: f64,
        /// What was expected.
        expected: &'static str,
    },
    /// Too many triangles for the memory.
    #[error("the mesh has more than {most} nodes: ask for larger triangles, or draw no details far below them")]
    TooFine {
        /// Largest number of nodes.
        most: usize,
    },
    /// A triangle turns over or has no area.
    #[error("the mesh has a triangle without area at ({:.3}, {:.3}) mm: two lines of the drawing nearly touch there", at[0], at[1])]
    Degenerate {
        /// Its middle, mm.
        at: [f64; 2],
    },
}

/// Most nodes of a mesh before the middles are added.
const MOST: usize = 400_000;

/// Smallest angle that the refinement aims at, degrees; Ruppert's method ends for it.
const ANGLE: f64 = 25.0;

/// Places nearer than this to each other are one, mm.
const SAME_MM: f64 = 1e-7;

/// Middles of sides are moved to their circle if both ends are on it within this, as a part of its radius.
const ON_CIRCLE: f64 = 1e-9;

#[derive(Debug, Clone, Copy)]
struct Vertex(Point2<f64>);

impl HasPosition for Vertex {
    type Scalar = f64;
    fn position(&self) -> Point2<f64> {
        self.0
    }
}

impl From<Point2<f64>> for Vertex {
    fn from(point: Point2<f64>) -> Self {
        Vertex(point)
    }
}

type Cdt = ConstrainedDelaunayTriangulation<Vertex>;

/// Meshes the inside of a closed drawing. `size` is the wanted length of a side at a point (mm), `region` the number of
/// the region that a point belongs to; `None` leaves a triangle out.
///
/// # Errors
/// [`MeshError`].
pub fn mesh(
    curves: &[Curve],
    order: Order,
    size: &dyn Fn([f64; 2]) -> f64,
    region: &dyn Fn([f64; 2]) -> Option<usize>,
) -> Result<Mesh, MeshError> {
    let parts = cut(curves);
    let mut cdt = Cdt::new();
    let mut known = HashMap::new();
    for part in &parts {
        let points = sampled(part, size)?;
        let mut last = None;
        for point in points {
            let handle = place(&mut cdt, &mut known, point)?;
            if let Some(last) = last.replace(handle).filter(|last| *last != handle) {
                cdt.add_constraint_and_split(last, handle, Vertex);
            }
        }
    }
    refine(&mut cdt, size)?;
    finished(&cdt, &parts, order, region)
}

/// Points along a curve, as far from each other as wanted there; an arc turns by at most 15 degrees between two.
fn sampled(part: &Curve, size: &dyn Fn([f64; 2]) -> f64) -> Result<Vec<[f64; 2]>, MeshError> {
    const LOOKS: usize = 64;
    let length = part.length();
    if !(length > 0.0 && length.is_finite()) {
        return Err(MeshError::Value { what: "the length of a line", value: length, expected: "more than 0 mm" });
    }
    // How many sides are wanted up to a place: the integral of 1 over the size.
    let mut sum = vec![0.0; LOOKS + 1];
    for i in 0..LOOKS {
        let wanted = size(part.at((i as f64 + 0.5) / LOOKS as f64));
        if !(wanted > 0.0 && wanted.is_finite()) {
            return Err(MeshError::Value { what: "a wanted size", value: wanted, expected: "more than 0 mm" });
        }
        sum[i + 1] = sum[i] + length / LOOKS as f64 / wanted;
    }
    let turns = match part {
        Curve::Line(..) => 1.0,
        Curve::Arc { from, to, .. } => (to - from) / 15_f64.to_radians(),
    };
    let sides = sum[LOOKS].max(turns).ceil().max(1.0);
    if sides > MOST as f64 {
        return Err(MeshError::TooFine { most: MOST });
    }
    let mut places = vec![0.0];
    let mut at = 0;
    for side in 1..sides as usize {
        let wanted = sum[LOOKS] * side as f64 / sides;
        while sum[at + 1] < wanted {
            at += 1;
        }
        places.push((at as f64 + (wanted - sum[at]) / (sum[at + 1] - sum[at])) / LOOKS as f64);
    }
    places.push(1.0);
    Ok(places.into_iter().map(|place| part.at(place)).collect())
}

type Known = HashMap<(i64, i64), spade::handles::FixedVertexHandle>;

/// The vertex at a point; one that is there already, but for rounding, is taken.
fn place(cdt: &mut Cdt, known: &mut Known, p: [f64; 2]) -> Result<spade::handles::FixedVertexHandle, MeshError> {
    let cell = |x: f64| (x / (4.0 * SAME_MM)).round() as i64;
    let (i, j) = (cell(p[0]), cell(p[1]));
    for near in (-1..=1).flat_map(|di| (-1..=1).map(move |dj| (i + di, j + dj))) {
        if let Some(handle) = known.get(&near) {
            let at = cdt.vertex(*handle).position();
            if (at.x - p[0]).hypot(at.y - p[1]) <= SAME_MM {
                return Ok(*handle);
            }
        }
    }
    let bad =
        |_| MeshError::Value { what: "a coordinate", value: p[0].abs().max(p[1].abs()), expected: "a number of mm" };
    let handle = cdt.insert(Vertex(Point2::new(p[0], p[1]))).map_err(bad)?;
    known.insert((i, j), handle);
    Ok(handle)
}

/// Inserts points until no triangle is larger than wanted, then until no angle is sharper than need be. Curves stay as
/// they were sampled: a point on a chord would not be on its circle.
fn refine(cdt: &mut Cdt, size: &dyn Fn([f64; 2]) -> f64) -> Result<(), MeshError> {
    loop {
        let wanted: Vec<Point2<f64>> = cdt
            .inner_faces()
            .filter_map(|face| {
                let [a, b, c] = face.positions();
                let middle = Point2::new((a.x + b.x + c.x) / 3.0, (a.y + b.y + c.y) / 3.0);
                // Of an equilateral triangle of the wanted side, and a fifth more.
                let side = size([middle.x, middle.y]);
                (face.area() > 0.52 * side * side).then_some(middle)
            })
            .collect();
        if wanted.is_empty() {
            break;
        }
        if cdt.num_vertices() + wanted.len() > MOST {
            return Err(MeshError::TooFine { most: MOST });
        }
        for point in wanted {
            // A middle of a triangle is a number where its corners are.
            let _ = cdt.insert(Vertex(point));
        }
    }
    let parameters = RefinementParameters::new()
        .with_angle_limit(AngleLimit::from_deg(ANGLE))
        .with_max_additional_vertices(cdt.num_vertices())
        .keep_constraint_edges();
    cdt.refine(parameters);
    Ok(())
}

/// Circles of the drawing.
fn circles(parts: &[Curve]) -> Vec<([f64; 2], f64)> {
    let mut circles: Vec<([f64; 2], f64)> = Vec::new();
    for part in parts {
        if let Curve::Arc { centre, radius, .. } = *part
            && !circles.contains(&(centre, radius))
        {
            circles.push((centre, radius));
        }
    }
    circles
}

fn finished(
    cdt: &Cdt,
    parts: &[Curve],
    order: Order,
    region: &dyn Fn([f64; 2]) -> Option<usize>,
) -> Result<Mesh, MeshError> {
    let circles = circles(parts);
    let mut mesh = Mesh { order, nodes: Vec::new(), triangles: Vec::new(), regions: Vec::new() };
    let mut corner = HashMap::new();
    let mut middle = HashMap::new();
    for face in cdt.inner_faces() {
        let positions = face.positions();
        let centre = [0, 1].map(|i| positions.iter().map(|p| if i == 0 { p.x } else { p.y }).sum::<f64>() / 3.0);
        let Some(number) = region(centre) else { continue };
        if face.area() <= 1e-12 * size_of(&positions) {
            return Err(MeshError::Degenerate { at: centre });
        }
        let corners = face.vertices().map(|v| {
            let p = v.position();
            *corner.entry(v.fix().index()).or_insert_with(|| {
                mesh.nodes.push([p.x, p.y]);
                mesh.nodes.len() - 1
            })
        });
        let mut nodes = [0; NODES];
        nodes[..3].copy_from_slice(&corners);
        let inner = order.on_side();
        for (side, edge) in face.adjacent_edges().into_iter().enumerate() {
            let fixed = edge.as_undirected();
            let first = *middle.entry(fixed.fix().index()).or_insert_with(|| {
                let [a, b] = fixed.positions();
                let circle = if fixed.is_constraint_edge() { on_circle(&circles, a, b) } else { None };
                let at = |k: usize| between(circle, [a.x, a.y], [b.x, b.y], k as f64 / (inner + 1) as f64);
                mesh.nodes.extend((1..=inner).map(at));
                mesh.nodes.len() - inner
            });
            // The side's own sense: its first corner's node first.
            let along = edge.from().fix() == fixed.vertices()[0].fix();
            for k in 0..inner {
                nodes[3 + inner * side + k] = first + if along { k } else { inner - 1 - k };
            }
        }
        if order == Order::Third {
            // Where a cubic that takes the sides' bend has its centre.
            let sum = |list: &[usize], i: usize| list.iter().map(|n| mesh.nodes[*n][i]).sum::<f64>();
            let centre = [0, 1].map(|i| sum(&nodes[3..9], i) / 4.0 - sum(&nodes[..3], i) / 6.0);
            nodes[9] = mesh.nodes.len();
            mesh.nodes.push(centre);
        }
        mesh.triangles.push(nodes);
        mesh.regions.push(number);
    }
    Ok(mesh)
}

/// Square of the longest side.
fn size_of(corners: &[Point2<f64>; 3]) -> f64 {
    (0..3).map(|i| corners[i].distance_2(corners[(i + 1) % 3])).fold(0.0, f64::max)
}

/// The circle that two points lie on.
fn on_circle(circles: &[([f64; 2], f64)], a: Point2<f64>, b: Point2<f64>) -> Option<([f64; 2], f64)> {
    circles.iter().copied().find(|(centre, radius)| {
        let on = |p: Point2<f64>| ((p.x - centre[0]).hypot(p.y - centre[1]) - radius).abs() <= ON_CIRCLE * radius;
        on(a) && on(b)
    })
}

/// A point between two others, on their circle if they have one: at this part of the way or of the shorter arc.
fn between(circle: Option<([f64; 2], f64)>, a: [f64; 2], b: [f64; 2], part: f64) -> [f64; 2] {
    let Some((centre, radius)) = circle else { return [0, 1].map(|i| a[i] + part * (b[i] - a[i])) };
    let angle = |p: [f64; 2]| (p[1] - centre[1]).atan2(p[0] - centre[0]);
    let from = angle(a);
    let mut turn = angle(b) - from;
    turn -= std::f64::consts::TAU * (turn / std::f64::consts::TAU).round();
    let at = from + part * turn;
    [centre[0] + radius * at.cos(), centre[1] + radius * at.sin()]
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn area(mesh: &Mesh) -> f64 {
        let x = |n: usize| mesh.nodes[n];
        let sum = |t: &[usize; NODES]| {
            mesh.order
                .rule()
                .iter()
                .map(|(l, w)| {
                    let mut j = [[0.0; 2]; 2];
                    for (n, slope) in t.iter().zip(mesh.order.slopes(*l)).take(mesh.order.nodes()) {
                        for (row, x) in j.iter_mut().zip(x(*n)) {
                            row[0] += x * slope[0];
                            row[1] += x * slope[1];
                        }
                    }
                    0.5 * w * (j[0][0] * j[1][1] - j[0][1] * j[1][0])
                })
                .sum::<f64>()
        };
        mesh.triangles.iter().map(sum).sum()
    }

    #[test]
    fn a_disc_has_its_area_to_the_fourth_order_and_its_triangles_the_wanted_size() {
        let disc = [Curve::circle([1.0, -2.0], 3.0)];
        let exact = std::f64::consts::PI * 9.0;
        let of = |size: f64, order| area(&mesh(&disc, order, &|_| size, &|_| Some(0)).unwrap());
        let [coarse, fine] = [0.8, 0.4].map(|size| (of(size, Order::Second) / exact - 1.0).abs());
        let cubic = (of(0.8, Order::Third) / exact - 1.0).abs();
        // Both err by the fourth power of the angle, cubics less.
        assert!(cubic < 0.5 * coarse, "{cubic:e} {coarse:e}");
        assert!(coarse < 2e-4 && fine < coarse / 10.0, "{coarse:e} {fine:e}");
        assert!((of(0.4, Order::First) / exact - 1.0).abs() > 1e-3);
    }

    #[test]
    fn regions_are_kept_apart_and_grading_follows_the_size() {
        let mut curves = vec![Curve::circle([0.0, 0.0], 20.0)];
        curves.extend(Curve::rectangle([-1.0, -1.0], [1.0, 1.0]));
        let inside = |p: [f64; 2]| p[0].abs() < 1.0 && p[1].abs() < 1.0;
        let size = |p: [f64; 2]| 0.2 + 0.2 * p[0].hypot(p[1]);
        let mesh = mesh(&curves, Order::Second, &size, &|p| Some(usize::from(inside(p)))).unwrap();
        let of = |number: usize| mesh.regions.iter().filter(|r| **r == number).count();
        assert!(of(1) > 60 && mesh.triangles.len() < 4000, "{} of {}", of(1), mesh.triangles.len());
        let one = Mesh {
            triangles: mesh.triangles.iter().zip(&mesh.regions).filter(|(_, r)| **r == 1).map(|(t, _)| *t).collect(),
            ..mesh.clone()
        };
        assert!((area(&one) - 4.0).abs() < 1e-9, "{}", area(&one));
    }

    #[test]
    fn sizes_and_lines_that_are_no_numbers_are_errors() {
        let line = [Curve::Line([0.0, 0.0], [0.0, 0.0])];
        let text = mesh(&line, Order::Second, &|_| 1.0, &|_| Some(0)).unwrap_err().to_string();
        assert_eq!(text, "the length of a line is 0: expected more than 0 mm");
        let disc = [Curve::circle([0.0, 0.0], 1.0)];
        let text = mesh(&disc, Order::Second, &|_| f64::NAN, &|_| Some(0)).unwrap_err().to_string();
        assert_eq!(text, "a wanted size is NaN: expected more than 0 mm");
        assert!(matches!(mesh(&disc, Order::Second, &|_| 1e-6, &|_| Some(0)), Err(MeshError::TooFine { .. })));
    }
}
