//! Coulomb friction, a step at a time.
//!
//! Over a step every place that touches resists its slip `s` with the energy `f (sqrt(s^2 + s0^2) -
//! s0)`: the shear is the limit `f`, the coefficient times the pressure, once it slips by more than
//! a few `s0`, and where it sticks it creeps by less than `s0`. The limit, the direction and what
//! lies across are those of the last pass over the step, so that a pass has an energy and a
//! symmetric stiffness; passes are repeated until the force stays.

use super::energy::{DOFS, Own, Penalty, Push};
use super::opposite::Edge;
use super::segment::Across;

/// A coefficient of friction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Friction {
    /// Shear over pressure of a place that slips, 0 to 2.
    pub coefficient: f64,
    /// Slip in a step by which a place is told to slip (mm): far below that of a step.
    pub creep_mm: f64,
}

/// A place that touched in the last pass.
#[derive(Debug, Clone, Copy)]
pub struct Grip {
    /// Number of the own edge.
    pub own: usize,
    /// Number of the edge across, 0 for a rigid body.
    pub other: usize,
    /// Shape functions of the own edge there, and of the edge across.
    shapes: ([f64; 3], Option<[f64; 3]>),
    /// Direction along the surface.
    tangent: [f64; 2],
    /// Largest shear force (N).
    limit: f64,
    /// Where it was at the start of the step, less what lies across (mm).
    start: [f64; 2],
}

/// Positions of an own edge and of what lies across.
#[derive(Debug, Clone, Copy)]
pub struct Ends<'a> {
    /// The own edge.
    pub own: &'a Edge,
    /// The edge across; `None` for a rigid body.
    pub other: Option<&'a Edge>,
    /// Height of a rigid body's tip (mm).
    pub tip_mm: f64,
}

fn place(shapes: &[f64; 3], edge: &Edge) -> [f64; 2] {
    [0, 1].map(|i| (0..3).map(|a| shapes[a] * edge[a][i]).sum())
}

impl Grip {
    /// Tells where both sides were at the start of the step.
    pub fn begin(&mut self, ends: &Ends) {
        self.start = self.apart(ends);
    }

    fn apart(&self, ends: &Ends) -> [f64; 2] {
        let at = place(&self.shapes.0, ends.own);
        let across = match (&self.shapes.1, ends.other) {
            (Some(shapes), Some(edge)) => place(shapes, edge),
            _ => [0.0, ends.tip_mm],
        };
        [at[0] - across[0], at[1] - across[1]]
    }

    /// Energy (N mm) of the slip since the start of the step; force and, when it is asked for,
    /// stiffness go to `push`.
    pub fn resist(&self, friction: &Friction, ends: &Ends, stiff: bool, push: &mut Push) -> f64 {
        let now = self.apart(ends);
        let slip: f64 = (0..2).map(|i| self.tangent[i] * (now[i] - self.start[i])).sum();
        let (creep, length) = (friction.creep_mm, slip.hypot(friction.creep_mm));
        let mut along = [0.0; DOFS];
        for a in 0..3 {
            for i in 0..2 {
                along[2 * a + i] = self.tangent[i] * self.shapes.0[a];
                along[6 + 2 * a + i] = self.shapes.1.map_or(0.0, |m| -self.tangent[i] * m[a]);
            }
        }
        let shear = self.limit * slip / length;
        push.force.iter_mut().zip(&along).for_each(|(f, a)| *f += shear * a);
        if stiff {
            let k = self.limit * creep * creep / length.powi(3);
            for i in 0..DOFS {
                for j in 0..=i {
                    push.stiffness[i][j] += k * along[i] * along[j];
                }
            }
        }
        self.limit * (length - creep)
    }
}

impl Penalty {
    /// Adds the grips of an own edge where it touches; where they were at the start of the step is
    /// told by [`Grip::begin`].
    pub fn grips(&self, friction: &Friction, (number, own): (usize, Own), across: &Across, grips: &mut Vec<Grip>) {
        self.places(own, across, |part, place| {
            let slope = place.other.slope;
            let size = 1_f64.hypot(slope);
            grips.push(Grip {
                own: number,
                other: part.other,
                shapes: (place.n, place.other.shapes.map(|s| s.0)),
                tangent: [1.0 / size, slope / size],
                limit: -friction.coefficient * self.mpa_per_mm * place.area * place.gap * size,
                start: [0.0; 2],
            });
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Shear is the energy's slope, the stiffness the shear's (central differences of 1e-6 mm), and
    /// far slip has the limit.
    #[test]
    fn shear_and_stiffness_are_difference_quotients() {
        let grip = Grip {
            own: 0,
            other: 0,
            shapes: ([0.2, 0.7, 0.1], Some([0.1, 0.6, 0.3])),
            tangent: [0.8, 0.6],
            limit: 0.3,
            start: [0.01, 0.02],
        };
        let friction = Friction { coefficient: 0.5, creep_mm: 0.01 };
        let of = |q: &[f64; DOFS], stiff: bool| {
            let edge = |from: usize| [0, 1, 2].map(|a| [q[from + 2 * a], q[from + 2 * a + 1]]);
            let (own, other) = (edge(0), edge(6));
            let mut push = Push::none();
            let ends = Ends { own: &own, other: Some(&other), tip_mm: 0.0 };
            let energy = grip.resist(&friction, &ends, stiff, &mut push);
            (energy, push)
        };
        let q: [f64; DOFS] = std::array::from_fn(|i| 0.01 * ((3 * i) as f64).sin());
        let (_, push) = of(&q, true);
        for i in 0..DOFS {
            let moved = |h: f64| {
                let mut q = q;
                q[i] += h;
                of(&q, false)
            };
            let (plus, minus) = (moved(1e-6), moved(-1e-6));
            assert!(((plus.0 - minus.0) / 2e-6 - push.force[i]).abs() < 1e-8);
            for j in 0..=i {
                let slope = (plus.1.force[j] - minus.1.force[j]) / 2e-6;
                assert!((slope - push.stiffness[i][j]).abs() < 1e-6, "{i} {j}");
            }
        }
        let far = of(&std::array::from_fn(|i| if i < 6 { 10.0 } else { 0.0 }), false).1;
        let shear = [0, 1].map(|i| far.force[i] + far.force[2 + i] + far.force[4 + i]);
        assert!((shear[0].hypot(shear[1]) - 0.3).abs() < 1e-6, "{shear:?}");
    }
}
