//! Energy, force and stiffness of the penalty over the parts that touch.
//!
//! With the gap `g = y - Y(x)` of a place `(x, y)` above the other side's height `Y`, the energy is `e/2` times the square of
//! negative gaps over the reference surface of the own edge. Its slope pushes along `(-Y', 1)`, the normal of the other
//! side: no friction, whatever the slope. The ends of the parts are zeros of the gap or corners of the other side, so that
//! the energy has a continuous second derivative in the first case and a continuous first one in the second.

use super::opposite::{Edge, Opposite};
use super::segment::{Across, Part, touching};
use crate::fem::quadrature::gauss;
use crate::fem::shape::line3;
use crate::pad::body::section::Section;

/// Degrees of freedom of two edges: the own nodes, then those across.
pub const DOFS: usize = 12;

/// Points on a part: exact for the polynomials of the ninth degree that its stiffness is for two flat edges of a ring.
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
    /// Pressure (MPa) up to which the stiffness knows that the normal turns. A start that penetrates deeply has pressures
    /// which no body would bear, and their turning would make the stiffness indefinite.
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

impl Penalty {
    /// A penalty (MPa/mm), with the pressure (MPa) up to which its turning is believed.
    #[must_use]
    pub fn new(mpa_per_mm: f64, section: Section, above: f64, believed_mpa: f64) -> Self {
        Self { mpa_per_mm, section, above, believed_mpa, rule: gauss(POINTS) }
    }

    /// Energy of an own edge; `add` gets the number of every edge that it touches, with the push of a part of it.
    pub fn push(&self, own: Own, across: &Across, stiff: bool, mut add: impl FnMut(usize, &Push)) -> f64 {
        let mut energy = 0.0;
        touching(own.now, across, self.above, |part| {
            let mut push = Push { force: [0.0; DOFS], stiffness: [[0.0; DOFS]; DOFS] };
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

    /// The places of an own edge that touch.
    pub fn touches(&self, own: Own, across: &Across, mut visit: impl FnMut(Part, &[Touch])) {
        touching(own.now, across, self.above, |part| {
            let touch = |&(point, weight): &(f64, f64)| {
                let place = self.place(own, across, part, point, weight)?;
                let (_, natural) = line3(place.coordinate);
                let along = [0, 1].map(|i| (0..3).map(|a| natural[a] * own.now[a][i]).sum::<f64>());
                let length = weight * 0.5 * (part.to - part.from) * along[0].hypot(along[1]);
                let force = -self.mpa_per_mm * place.area * place.gap * 1_f64.hypot(place.other.slope);
                let area = length * self.section.depth_mm(place.at[0]);
                Some(Touch {
                    at: place.at,
                    slope: place.other.slope,
                    pressure_mpa: force / area,
                    length_mm: length,
                })
            };
            let touches: Vec<Touch> = self.rule.iter().filter_map(touch).collect();
            visit(part, &touches);
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
        let area = weight * half * length * self.section.depth_mm(sum(own.reference, &n, 0));
        Some(Place { coordinate, n, at, gap: self.above * (at[1] - other.height), other, area })
    }
}

/// A point of a part.
struct Place {
    coordinate: f64,
    n: [f64; 3],
    at: [f64; 2],
    gap: f64,
    other: Opposite,
    /// Reference area that it stands for.
    area: f64,
}

impl Place {
    /// Adds `e A (g dg)` and, with the second derivative `-(e x D + D x e + Y'' D x D)` of the height's difference, `e A (dg x dg + g d2g)`:
    /// `D` is how x differs, `e` how the other side turns.
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
