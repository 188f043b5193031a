//! Parts of an edge that touch, with their ends located inside the elements.

use super::opposite::{Edge, Opposite, coordinate, faces};
use super::rigid::Rigid;
use crate::fem::shape::line3;

/// What lies across from an edge, at its present place.
#[derive(Debug, Clone)]
pub enum Across<'a> {
    /// A rigid body, with the height of its tip now (mm).
    Rigid(&'a Rigid, f64),
    /// Edges from the axis outward, those that face this side.
    Edges(Vec<Edge>),
}

impl<'a> Across<'a> {
    /// Of edges from the axis outward, up to the first that turns away.
    #[must_use]
    pub fn edges(all: impl Iterator<Item = Edge>) -> Self {
        Self::Edges(all.take_while(faces).collect())
    }

    /// What lies there; `number` is that of the edge. `None` beside it.
    #[must_use]
    pub fn at(&self, number: usize, x: f64, above: f64) -> Option<Opposite> {
        match self {
            Self::Rigid(rigid, tip) => {
                let [height, slope, bend] = rigid.shape.profile(x, above)?;
                Some(Opposite { height: tip + height, slope, bend, shapes: None })
            }
            Self::Edges(edges) => Some(Opposite::edge(edges.get(number)?, x)),
        }
    }
}

/// A part of an edge that touches one edge of the other side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Part {
    /// Number of the other edge, 0 for a rigid body.
    pub other: usize,
    /// Its ends in the own edge's coordinate.
    pub from: f64,
    /// The outer end.
    pub to: f64,
}

/// Places at which a part is looked at for a change of sign, besides those where the gap turns: it
/// is nearly a parabola.
const LOOKS: usize = 5;
/// Parts shorter than this are left out; their share of an integral is as small.
const SHORTEST: f64 = 1e-12;

/// Gap at a coordinate of an own edge (mm), negative where it penetrates; `above` is 1 for an edge
/// above the other side, -1 for one below. `None` where nothing lies across.
#[must_use]
pub fn gap(own: &Edge, across: &Across, other: usize, above: f64, at: f64) -> Option<f64> {
    let (n, _) = line3(at);
    let [x, y] = [0, 1].map(|i| (0..3).map(|a| n[a] * own[a][i]).sum::<f64>());
    Some(above * (y - across.at(other, x, above)?.height))
}

/// The parts of an own edge, which faces the other side, that penetrate.
pub fn touching(own: &Edge, across: &Across, above: f64, mut visit: impl FnMut(Part)) {
    let mut between = |other: usize, from: f64, to: f64| {
        if to - from > SHORTEST {
            penetrating(&|at| gap(own, across, other, above, at), other, [from, to], &mut visit);
        }
    };
    let Across::Edges(edges) = across else { return between(0, -1.0, 1.0) };
    let first = edges.partition_point(|e| e[2][0] <= own[0][0]);
    for (other, edge) in edges.iter().enumerate().skip(first) {
        if edge[0][0] >= own[2][0] {
            break;
        }
        let end = |x: f64| coordinate(own, x).clamp(-1.0, 1.0);
        between(other, end(edge[0][0]), end(edge[2][0]));
    }
}

fn penetrating(gap: &dyn Fn(f64) -> Option<f64>, other: usize, [from, to]: [f64; 2], visit: &mut impl FnMut(Part)) {
    // beside a rigid body nothing is touched
    let look = |at: f64| [at, gap(at).unwrap_or(f64::MAX)];
    let mut looked: Vec<[f64; 2]> =
        (0..LOOKS).map(|i| look(from + (to - from) * i as f64 / (LOOKS - 1) as f64)).collect();
    let turns: Vec<f64> = looked.windows(3).filter_map(|w| turn([w[0], w[1], w[2]])).collect();
    looked.extend(turns.into_iter().map(look));
    looked.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mut start = (looked[0][1] < 0.0).then_some(from);
    for pair in looked.windows(2) {
        if (pair[0][1] < 0.0) == (pair[1][1] < 0.0) {
            continue;
        }
        let edge = crossing(&|at| look(at)[1], pair[0], pair[1]);
        match start.take() {
            Some(from) => visit(Part { other, from, to: edge }),
            None => start = Some(edge),
        }
    }
    if let Some(from) = start {
        visit(Part { other, from, to });
    }
}

/// Where the parabola through three equally distant places turns, if it does between them.
fn turn([a, b, c]: [[f64; 2]; 3]) -> Option<f64> {
    let (slope, bend) = (0.5 * (c[1] - a[1]), a[1] - 2.0 * b[1] + c[1]);
    (slope.abs() < bend.abs() && bend.is_finite()).then(|| b[0] - slope / bend * (b[0] - a[0]))
}

/// Where a function changes its sign between two places with their values: regula falsi with
/// Illinois' halving.
fn crossing(f: &dyn Fn(f64) -> f64, mut a: [f64; 2], mut b: [f64; 2]) -> f64 {
    for _ in 0..60 {
        let finite = a[1] < f64::MAX && b[1] < f64::MAX;
        let part = if finite { a[1] / (a[1] - b[1]) } else { 0.5 };
        let at = a[0] + part * (b[0] - a[0]);
        let value = f(at);
        if value == 0.0 || (b[0] - a[0]).abs() < SHORTEST {
            return at;
        }
        if (value < 0.0) == (b[1] < 0.0) {
            a[1] *= 0.5;
        } else {
            a = b;
        }
        let moved = (at - b[0]).abs();
        b = [at, value];
        if moved < SHORTEST {
            return at;
        }
    }
    b[0]
}

#[cfg(test)]
mod tests {
    use super::super::rigid::Shape;
    use super::*;

    fn parts(own: &Edge, across: &Across) -> Vec<(usize, f64, f64)> {
        let mut parts = Vec::new();
        touching(own, across, 1.0, |p| parts.push((p.other, p.from, p.to)));
        parts
    }

    const PLATE: Rigid = Rigid { shape: Shape::Plate, tip_mm: 0.0 };

    /// An edge whose height is `x^2 - 0.09` lies below the plate from -0.3 to 0.3, one that is
    /// `0.0001 - x^2` beyond 0.01.
    #[test]
    fn the_edge_of_the_contact_is_found_inside_the_element() {
        let below = |height: f64, bend: f64| [[-1.0, height + bend], [0.0, height], [1.0, height + bend]];
        let one = parts(&below(-0.09, 1.0), &Across::Rigid(&PLATE, 0.0));
        assert!(one.len() == 1 && (one[0].1 + 0.3).abs() < 1e-9 && (one[0].2 - 0.3).abs() < 1e-9, "{one:?}");
        // too narrow to be seen at the looks alone
        let bump = parts(&below(1e-4, -1.0), &Across::Rigid(&PLATE, 0.0));
        assert!(bump.len() == 2 && (bump[0].2 + 0.01).abs() < 1e-9 && (bump[1].1 - 0.01).abs() < 1e-9, "{bump:?}");
        assert!(parts(&below(0.1, 1.0), &Across::Rigid(&PLATE, 0.0)).is_empty());
    }

    #[test]
    fn parts_end_at_the_corners_of_the_other_side() {
        let own = [[0.0, -0.1], [1.0, -0.1], [2.0, -0.1]];
        let flat = |from: f64, to: f64| [[from, 0.0], [0.5 * (from + to), 0.0], [to, 0.0]];
        let across = Across::edges([flat(-1.0, 0.5), flat(0.5, 1.75), flat(1.75, 3.0)].into_iter());
        let parts = parts(&own, &across);
        let ends: Vec<(usize, f64, f64)> = vec![(0, -1.0, -0.5), (1, -0.5, 0.75), (2, 0.75, 1.0)];
        assert!(parts.len() == 3, "{parts:?}");
        for (a, b) in parts.iter().zip(&ends) {
            assert!(a.0 == b.0 && (a.1 - b.1).abs() < 1e-12 && (a.2 - b.2).abs() < 1e-12, "{parts:?}");
        }
    }

    #[test]
    fn edges_that_turn_away_do_not_touch() {
        let away = [[1.0, 0.0], [0.5, 0.0], [0.0, 0.0]];
        let Across::Edges(edges) = Across::edges([away].into_iter()) else { return };
        assert!(edges.is_empty());
    }
}
