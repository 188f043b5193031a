//! A sheet of triangles with a value at each corner, and the regions above a level.

use std::collections::{BTreeMap, HashMap};

use lut_gen::fem::shape::quad8;

/// Triangles a side of an element of eight nodes is divided into.
const FINER: usize = 3;

/// A triangulated drawing, mm.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Sheet {
    /// Corners.
    pub points: Vec<[f64; 2]>,
    /// Their values.
    pub values: Vec<f64>,
    /// Triangles, all of one sense.
    pub triangles: Vec<[usize; 3]>,
}

/// A node of an element that is drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Node {
    /// Where it was, mm; by this neighbours know each other.
    pub rest: [f64; 2],
    /// Where it is, mm.
    pub now: [f64; 2],
    /// Its value.
    pub value: f64,
}

/// Points of a sheet by where they were, to a millionth of a millimetre.
pub type Known = HashMap<[i64; 2], usize>;

/// A corner of a region: a point of the sheet (twice the same index), or where the level cuts the line between two.
type Corner = (usize, usize);

impl Sheet {
    /// Adds an element of eight nodes, or with `side` -1 its image across x = 0. Elements of one call of `known` share their
    /// points.
    pub fn add(&mut self, element: &[Node; 8], side: f64, known: &mut Known) {
        let mut grid = Vec::with_capacity((FINER + 1) * (FINER + 1));
        for i in 0..=FINER {
            for j in 0..=FINER {
                let at = |k: usize| 2.0 * k as f64 / FINER as f64 - 1.0;
                let (shape, _) = quad8(at(i), at(j));
                let (mut rest, mut x, mut value) = ([0.0; 2], [0.0; 2], 0.0);
                for (n, node) in shape.iter().zip(element) {
                    for k in 0..2 {
                        rest[k] += n * node.rest[k];
                        x[k] += n * node.now[k];
                    }
                    value += n * node.value;
                }
                let key = [side * rest[0], rest[1]].map(|c| (1e6 * c).round() as i64);
                grid.push(*known.entry(key).or_insert_with(|| {
                    self.points.push([side * x[0], x[1]]);
                    self.values.push(value);
                    self.points.len() - 1
                }));
            }
        }
        for i in 0..FINER {
            for j in 0..FINER {
                let at = |di: usize, dj: usize| grid[(i + di) * (FINER + 1) + j + dj];
                for [a, b, c] in [[at(0, 0), at(1, 0), at(1, 1)], [at(0, 0), at(1, 1), at(0, 1)]] {
                    // the mirror image runs the other way round
                    self.triangles.push(if side > 0.0 { [a, b, c] } else { [a, c, b] });
                }
            }
        }
    }

    /// Outlines of the region where the value is at least `level`, as closed loops; holes run the other way.
    ///
    /// Each triangle is cut to the region, and lines that two triangles share cancel.
    pub fn region(&self, level: f64) -> Vec<Vec<[f64; 2]>> {
        let inside = |i: usize| self.values[i] >= level;
        let mut lines: BTreeMap<Corner, Vec<Corner>> = BTreeMap::new();
        for triangle in &self.triangles {
            let mut polygon: Vec<Corner> = Vec::with_capacity(4);
            for k in 0..3 {
                let (a, b) = (triangle[k], triangle[(k + 1) % 3]);
                if inside(a) {
                    polygon.push((a, a));
                }
                if inside(a) != inside(b) {
                    polygon.push((a.min(b), a.max(b)));
                }
            }
            for (k, &from) in polygon.iter().enumerate() {
                let to = polygon[(k + 1) % polygon.len()];
                let back = lines.get_mut(&to).and_then(|ends| Some((ends.iter().position(|e| *e == from)?, ends)));
                match back {
                    Some((at, ends)) => {
                        ends.swap_remove(at);
                    }
                    None => lines.entry(from).or_default().push(to),
                }
            }
        }
        self.loops(lines, level)
    }

    fn loops(&self, mut lines: BTreeMap<Corner, Vec<Corner>>, level: f64) -> Vec<Vec<[f64; 2]>> {
        let mut loops = Vec::new();
        loop {
            lines.retain(|_, ends| !ends.is_empty());
            let Some((&start, _)) = lines.first_key_value() else { return loops };
            let (mut outline, mut here) = (Vec::new(), start);
            while let Some(next) = lines.get_mut(&here).and_then(Vec::pop) {
                outline.push(self.place(here, level));
                here = next;
            }
            loops.push(outline);
        }
    }

    fn place(&self, (a, b): Corner, level: f64) -> [f64; 2] {
        let (p, q) = (self.points[a], self.points[b]);
        if a == b {
            return p;
        }
        let t = ((level - self.values[a]) / (self.values[b] - self.values[a])).clamp(0.0, 1.0);
        [p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1])]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A square of 2 x 2 mm in four triangles around its middle, value 1 there and 0 at the corners.
    fn roof() -> Sheet {
        Sheet {
            points: vec![[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0], [1.0, 1.0]],
            values: vec![0.0, 0.0, 0.0, 0.0, 1.0],
            triangles: vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]],
        }
    }

    fn area(outline: &[[f64; 2]]) -> f64 {
        let next = outline.iter().cycle().skip(1);
        outline.iter().zip(next).map(|(a, b)| 0.5 * (a[0] * b[1] - b[0] * a[1])).sum()
    }

    #[test]
    fn regions_of_a_roof_are_squares() {
        for (level, side) in [(0.0, 2.0), (0.25, 1.5), (0.5, 1.0)] {
            let loops = roof().region(level);
            assert_eq!(loops.len(), 1, "one loop: lines between triangles cancel");
            assert_eq!(loops[0].len(), 4);
            assert!((area(&loops[0]) - side * side).abs() < 1e-12);
        }
        assert!(roof().region(1.5).is_empty());
    }

    #[test]
    fn a_hole_runs_the_other_way() {
        let mut valley = roof();
        for value in &mut valley.values {
            *value = 1.0 - *value;
        }
        let mut areas: Vec<f64> = valley.region(0.5).iter().map(|l| area(l)).collect();
        areas.sort_by(f64::total_cmp);
        assert_eq!(areas, [-1.0, 4.0]);
    }
}
