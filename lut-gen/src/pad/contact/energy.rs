//! Energy, force and stiffness of the penalty over the parts that touch.
//!
//! With the gap `g = y - Y(x)` of a place `(x, y)` above the other side's height `Y`, the energy is
//! `e/2` times the square of negative gaps over the reference surface of the own edge. Its slope
//! pushes along `(-Y', 1)`, the normal of the other side: no friction, whatever the slope. The ends
//! of the parts are zeros of the gap or corners of the other side, so that the energy has a
//! continuous second derivative in the first case and a continuous first one in the second.

use super::opposite::{Edge, Opposite};
use super::segment::{Across, Part, touching};
use crate::fem::quadrature::gauss;
use crate::fem::shape::line3;
use crate::pad::body::section::Section;

/// Degrees of freedom of two edges: the own nodes, then those across.
pub const DOFS: usize = 12;

/// Points on a part: exact for the polynomials of the ninth degree that its stiffness is for two
/// flat edges of a ring.
const POINTS: usize = 5;

/// Rule and stiffness of a contact.
#[derive(Debug, Clone)]
pub struct Penalty {
    /// Pressure per penetration, on the reference surface (MPa/mm).
    pub mpa_per_mm: f64,
    /// Plane or ring.
    pub section: Section,
    /// 1 where the own edges lie above, -1 where they lie below.
    pub above: f64,
    /// Pressure (MPa) up to which the stiffness knows that the normal turns. A start that
    /// penetrates deeply has pressures which no body would bear, and their turning would make the
    /// stiffness indefinite.
    pub believed_mpa: f64,
    rule: Vec<(f64, f64)>,
}

/// An own edge.
#[derive(Debug, Clone, Copy)]
pub struct Own<'a> {
    /// Where its nodes were (mm).
    pub reference: &'a Edge,
    /// Where they are (mm).
    pub now: &'a Edge,
}

/// A place that touches.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Touch {
    /// Where it is (mm).
    pub at: [f64; 2],
    /// Slope of the other side there.
    pub slope: f64,
    /// Pressure on the present surface (MPa).
    pub pressure_mpa: f64,
    /// Length along the own edge now that it stands for (mm).
    pub length_mm: f64,
}

/// Force and stiffness of two edges.
#[derive(Debug, Clone)]
pub struct Push {
    /// Slope of the energy (N).
    pub force: [f64; DOFS],
    /// Its second derivative (N/mm), when it is asked for.
    pub stiffness: [[f64; DOFS]; DOFS],
}

impl Push {
    /// Nothing.
    #[must_use]
    pub fn none() -> Self {
        Self { force: [0.0; DOFS], stiffness: [[0.0; DOFS]; DOFS] }
    }
}

impl Penalty {
    /// A penalty (MPa/mm), with the pressure (MPa) up to which its turning is believed.
    #[must_use]
    pub fn new(mpa_per_mm: f64, section: Section, above: f64, believed_mpa: f64) -> Self {
        Self { mpa_per_mm, section, above, believed_mpa, rule: gauss(POINTS) }
    }

    /// Energy of an own edge; `add` gets the number of every edge that it touches, with the push of
    /// a part of it.
    pub fn push(&self, own: Own, across: &Across, stiff: bool, mut add: impl FnMut(usize, &Push)) -> f64 {
        let mut energy = 0.0;
        touching(own.now, across, self.above, |part| {
            let mut push = Push::none();
            for &(point, weight) in &self.rule {
                let Some(place) = self.place(own, across, part, point, weight) else { continue };
                energy += 0.5 * self.mpa_per_mm * place.area * place.gap * place.gap;
                let believed = (-self.believed_mpa / self.mpa_per_mm).max(place.gap);
                place.add(self.mpa_per_mm * place.area, self.above, stiff.then_some(believed), &mut push);
            }
            add(part.other, &push);
        });
        energy
    }

    /// Visits the points of every part of an own edge that touches.
    pub(super) fn places(&self, own: Own, across: &Across, mut visit: impl FnMut(Part, &Place)) {
        touching(own.now, across, self.above, |part| {
            for &(point, weight) in &self.rule {
                if let Some(place) = self.place(own, across, part, point, weight) {
                    visit(part, &place);
                }
            }
        });
    }

    /// The places of an own edge that touch.
    pub fn touches(&self, own: Own, across: &Across, mut visit: impl FnMut(Part, Touch)) {
        self.places(own, across, |part, place| {
            let (_, natural) = line3(place.coordinate);
            let along = [0, 1].map(|i| (0..3).map(|a| natural[a] * own.now[a][i]).sum::<f64>());
            let length_mm = place.length * along[0].hypot(along[1]);
            let slope = place.other.slope;
            let force = -self.mpa_per_mm * place.area * place.gap * 1_f64.hypot(slope);
            let pressure_mpa = force / (length_mm * self.section.depth_mm(place.at[0]));
            visit(part, Touch { at: place.at, slope, pressure_mpa, length_mm });
        });
    }

    fn place(&self, own: Own, across: &Across, part: Part, point: f64, weight: f64) -> Option<Place> {
        let half = 0.5 * (part.to - part.from);
        let coordinate = part.from + half * (1.0 + point);
        let (n, natural) = line3(coordinate);
        let sum = |edge: &Edge, f: &[f64; 3], i: usize| (0..3).map(|a| f[a] * edge[a][i]).sum::<f64>();
        let at = [sum(own.now, &n, 0), sum(own.now, &n, 1)];
        let other = across.at(part.other, at[0], self.above)?;
        let length = sum(own.reference, &natural, 0).hypot(sum(own.reference, &natural, 1));
        let natural_length = weight * half;
        let area = natural_length * length * self.section.depth_mm(sum(own.reference, &n, 0));
        let gap = self.above * (at[1] - other.height);
        Some(Place { coordinate, n, at, gap, other, area, length: natural_length })
    }
}

/// A point of a part.
pub(super) struct Place {
    /// The own edge's coordinate and shape functions there.
    pub coordinate: f64,
    pub n: [f64; 3],
    /// Position (mm), gap (mm), and what lies across.
    pub at: [f64; 2],
    pub gap: f64,
    pub other: Opposite,
    /// Reference area that it stands for (mm2), and length of the own edge's coordinate.
    pub area: f64,
    pub length: f64,
}

impl Place {
    /// Adds `e A (g dg)` and, with the second derivative `-(e x D + D x e + Y'' D x D)` of the
    /// height's difference, `e A (dg x dg + g d2g)`: `D` is how x differs, `e` how the other side
    /// turns.
    fn add(&self, weight: f64, above: f64, believed: Option<f64>, push: &mut Push) {
        let slope = self.other.slope;
        let (mut v, mut across, mut turn) = ([0.0; DOFS], [0.0; DOFS], [0.0; DOFS]);
        for a in 0..3 {
            (v[2 * a], v[2 * a + 1]) = (-slope * self.n[a], self.n[a]);
            across[2 * a] = self.n[a];
            if let Some((m, along)) = &self.other.shapes {
                (v[6 + 2 * a], v[7 + 2 * a]) = (slope * m[a], -m[a]);
                across[6 + 2 * a] = -m[a];
                (turn[6 + 2 * a], turn[7 + 2 * a]) = (-slope * along[a], along[a]);
            }
        }
        let f = weight * self.gap * above;
        push.force.iter_mut().zip(&v).for_each(|(force, v)| *force += f * v);
        if let Some(gap) = believed {
            let f = weight * gap * above;
            let bend = self.other.bend;
            for i in 0..DOFS {
                for j in 0..=i {
                    let second = turn[i] * across[j] + across[i] * turn[j] + bend * across[i] * across[j];
                    push.stiffness[i][j] += weight * v[i] * v[j] - f * second;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::rigid::{Rigid, Shape};
    use super::*;

    const REFERENCE: Edge = [[0.5, 0.0], [1.0, 0.02], [1.5, 0.1]];
    /// Nodes of two edges across, the middle one of both, on one parabola so that there is no
    /// corner between them; the own edge lies over parts of both.
    const OTHERS: [[f64; 2]; 5] = [[0.0, 0.11], [0.55, 0.070125], [1.1, 0.0605], [1.65, 0.081125], [2.2, 0.132]];
    const N: usize = 16;

    /// Energy, force and, when it is asked for, stiffness over the own nodes and those across.
    fn of(penalty: &Penalty, q: &[f64], stiff: bool, rigid: Option<&Rigid>) -> (f64, [f64; N], [[f64; N]; N]) {
        let edge = |from: usize| [0, 1, 2].map(|a| [q[from + 2 * a], q[from + 2 * a + 1]]);
        let now = edge(0);
        let edges = || Across::edges([edge(6), edge(10)].into_iter());
        let across = rigid.map_or_else(edges, |r| Across::Rigid(r, r.tip_mm));
        let (mut force, mut k) = ([0.0; N], [[0.0; N]; N]);
        let energy = penalty.push(Own { reference: &REFERENCE, now: &now }, &across, stiff, |other, push| {
            let at = |i: usize| if i < 6 { i } else { i + 4 * other };
            for i in (0..DOFS).filter(|i| at(*i) < N) {
                force[at(i)] += push.force[i];
                for j in 0..=i {
                    k[at(i)][at(j)] += push.stiffness[i][j];
                    if i != j {
                        k[at(j)][at(i)] += push.stiffness[i][j];
                    }
                }
            }
        });
        (energy, force, k)
    }

    fn start() -> Vec<f64> {
        REFERENCE.iter().chain(&OTHERS).flatten().copied().collect()
    }

    /// Force and stiffness by central differences of 1e-6. The points move with the parts' ends, so
    /// that the energy of the rule is the force's integral to the rule's own error only: 1e-6 of it
    /// here.
    #[test]
    fn force_and_stiffness_are_difference_quotients() {
        let ball = |tip_mm: f64| Rigid { shape: Shape::Ball { radius_mm: 3.0 }, tip_mm };
        let (below, over) = (ball(0.1), ball(-0.1));
        for (above, rigid) in [(1.0, None), (-1.0, None), (1.0, Some(&below)), (-1.0, Some(&over))] {
            for section in [Section::Plane, Section::Ring] {
                let penalty = Penalty::new(10.0, section, above, f64::INFINITY);
                let q = start();
                let (energy, force, k) = of(&penalty, &q, true, rigid);
                assert!(energy > 0.0, "{above} {rigid:?}");
                let scale = k.iter().flatten().fold(0.0_f64, |m, x| m.max(x.abs()));
                let size = force.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
                for i in 0..if rigid.is_some() { 6 } else { N } {
                    let moved = |h: f64| {
                        let mut q = q.clone();
                        q[i] += h;
                        of(&penalty, &q, false, rigid)
                    };
                    let (plus, minus) = (moved(1e-6), moved(-1e-6));
                    let slope = (plus.0 - minus.0) / 2e-6;
                    assert!((slope - force[i]).abs() < 1e-4 * size, "{above} {i}: {slope} {}", force[i]);
                    for (j, row) in k.iter().enumerate() {
                        let slope = (plus.1[j] - minus.1[j]) / 2e-6;
                        assert!((slope - row[i]).abs() < 1e-3 * scale, "{above} {i} {j}: {slope} {}", row[i]);
                    }
                }
            }
        }
    }

    /// What one side gets the other gives.
    #[test]
    fn forces_balance() {
        let (_, force, _) = of(&Penalty::new(10.0, Section::Plane, 1.0, 1.0), &start(), false, None);
        for i in 0..2 {
            let sum: f64 = force.iter().skip(i).step_by(2).sum();
            assert!(sum.abs() < 1e-14, "{i}: {sum}");
        }
    }
}
