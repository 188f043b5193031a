//! Contact integrated over the undeformed surface.

use super::{Ball, Indenter, Interface, Penalty, Platen, Touch};
use crate::fem::quadrature::gauss;
use crate::fem::shape::line3;
use crate::scalar::Real;

/// One quadrature point of the surface.
#[derive(Debug, Clone, Copy)]
struct Point<T> {
    /// Reference area of the ring it stands for, `2 pi R w` (mm^2).
    area: f64,
    /// Reference position `[r, z]` (mm).
    at: [T; 2],
    /// Shape functions of the three nodes of its edge.
    shape: [f64; 3],
}

/// What a point of the surface remembers of the last equilibrium when there is friction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grip<T = f64> {
    /// Depth inside the ball (mm), negative outside.
    pub depth_mm: T,
    /// Length along the ball's meridian (mm).
    pub arc_mm: T,
    /// Frictional traction per reference area (MPa), positive against outward motion.
    pub traction_mpa: T,
}

/// The part of the block's surface that can touch the ball or the platen.
///
/// The pressure per reference area is `p(g)` of a [`Penalty`] of the penetration `g`, the gradient
/// of an energy. Integrating between the nodes lets the contact edge move smoothly through an element.
///
/// Friction is Coulomb's law with an elastic slip of the stiffness `p / g` along the ball's
/// meridian, the arc length of the point below the ball being its slip coordinate:
/// `t = clamp(t_old + p/g (arc - arc_old), -mu p, mu p)`, so that points stick up to a slip of
/// `mu g`. A point that entered within the step takes the part of its motion after its entry.
#[derive(Debug, Clone)]
pub struct Surface<T = f64> {
    indenter: Indenter<T>,
    interface: Interface<T>,
    edges: Vec<[usize; 3]>,
    points: Vec<Point<T>>,
    per_edge: usize,
    penalty: Penalty<T>,
}

/// Sums over the surface at one configuration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sum<T = f64> {
    /// Energy of penalty and adhesion (N mm).
    pub energy: T,
    /// Complementary energy of the penalty, elastic slip included (N mm).
    pub penalty_energy: T,
    /// Force on the ball, upward (N).
    pub force_n: T,
    /// Points in contact.
    pub active: usize,
    /// Points in contact that slide.
    pub sliding: usize,
    /// Largest current radius of a point in contact (mm).
    pub radius_mm: f64,
}

impl<T: Real> Default for Sum<T> {
    fn default() -> Self {
        let zero = T::from(0.0);
        Self { energy: zero, penalty_energy: zero, force_n: zero, active: 0, sliding: 0, radius_mm: 0.0 }
    }
}

/// Derivative of an edge's nodal forces by the displacement of its three nodes
/// (radial, axial each): `K[i][j] = d force_i / d u_j` (N/mm).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct EdgeStiffness {
    /// All of it, not symmetric where points slide.
    pub whole: [[f64; 6]; 6],
    /// Without the dependence of the sliding traction on the pressure: symmetric, and definite
    /// where the surface is. The symmetric part of the whole is not: it has a negative
    /// eigenvalue near `-k mu^2 / 4` at every sliding point.
    pub symmetric: [[f64; 6]; 6],
}

/// Force of one point on the ball's surface, per reference area, and its derivative by the position.
struct Traction<T> {
    /// Gradient of the energy `[r, z]` (MPa).
    force: [T; 2],
    /// Its derivative (MPa/mm), `[force][position]`.
    slope: [[T; 2]; 2],
    /// The same without what sliding makes of the pressure.
    symmetric: [[T; 2]; 2],
    energy: T,
    penalty_energy: T,
    friction: T,
    slides: bool,
}

impl<T: Real> Surface<T> {
    /// Contact of a ball or a platen with the edges of `edges` that start within `reach_mm` of the axis.
    #[must_use]
    pub fn new(
        indenter: impl Into<Indenter<T>>,
        interface: Interface<T>,
        nodes: &[[T; 2]],
        edges: &[[usize; 3]],
        reach_mm: f64,
        per_edge: usize,
        penalty: Penalty<T>,
    ) -> Self {
        let rule = gauss(per_edge);
        let edges: Vec<_> = edges.iter().copied().filter(|e| nodes[e[0]][0].value() < reach_mm).collect();
        let mut points = Vec::with_capacity(edges.len() * per_edge);
        for e in &edges {
            for &(x, w) in &rule {
                let (shape, slope) = line3(x);
                let sum = |f: &[f64; 3], k: usize| (0..3).fold(T::from(0.0), |s, i| s + nodes[e[i]][k] * f[i]);
                let at = [sum(&shape, 0), sum(&shape, 1)];
                let length = sum(&slope, 0).value().hypot(sum(&slope, 1).value());
                let area = std::f64::consts::TAU * at[0].value() * length * w;
                points.push(Point { area, at, shape });
            }
        }
        Self { indenter: indenter.into(), interface, edges, points, per_edge, penalty }
    }

    /// The ball, where it is one that presses.
    #[must_use]
    pub fn ball(&self) -> Option<Ball<T>> {
        match self.indenter {
            Indenter::Ball(ball) => Some(ball),
            Indenter::Platen(_) => None,
        }
    }

    /// True when the top is glued to a platen.
    #[must_use]
    pub fn is_bonded(&self) -> bool {
        matches!(self.indenter, Indenter::Platen(Platen { bonded: true }))
    }

    /// Height (mm) of the ball's centre or of the platen's face above the base of a block of `height_mm` at a depth.
    #[must_use]
    pub fn datum_mm(&self, height_mm: T, depth_mm: T) -> T {
        self.indenter.datum_mm(height_mm, depth_mm)
    }

    /// Friction and adhesion.
    #[must_use]
    pub fn interface(&self) -> Interface<T> {
        self.interface
    }

    /// The edges, in the order of [`Surface::edge`].
    #[must_use]
    pub fn edges(&self) -> &[[usize; 3]] {
        &self.edges
    }

    /// Points of one edge.
    #[must_use]
    pub fn per_edge(&self) -> usize {
        self.per_edge
    }

    /// True when points keep a [`Grip`].
    #[must_use]
    pub fn has_friction(&self) -> bool {
        self.interface.friction.value() > 0.0
    }

    /// Pressure per reference area (MPa) at a point of the surface in its current position: the
    /// penalty's inside the indenter, adhesion's (negative) outside.
    #[must_use]
    pub fn pressure_mpa(&self, x: [T; 2], datum_mm: T) -> T {
        let g = self.indenter.touch(x, datum_mm).depth_mm;
        match &self.interface.adhesion {
            _ if g.value() > 0.0 => self.penalty.push(g).1,
            Some(adhesion) => adhesion.pull(g).1,
            None => T::from(0.0),
        }
    }

    /// Grips of an untouched surface under an indenter whose datum is at `datum_mm`; empty without friction.
    #[must_use]
    pub fn grips(&self, datum_mm: T) -> Vec<Grip<T>> {
        let free = |p: &Point<T>| {
            let t = self.indenter.touch(p.at, datum_mm);
            Grip { depth_mm: t.depth_mm, arc_mm: t.arc_mm, traction_mpa: T::from(0.0) }
        };
        if self.has_friction() { self.points.iter().map(free).collect() } else { Vec::new() }
    }

    fn position(p: &Point<T>, u: &[T; 6]) -> [T; 2] {
        let mut x = p.at;
        for (a, n) in p.shape.iter().enumerate() {
            x[0] += u[2 * a] * *n;
            x[1] += u[2 * a + 1] * *n;
        }
        x
    }

    /// Adds one edge's nodal forces (gradient of the energy, N) to `force` and its derivative
    /// to `stiffness` when given. `u` holds the edge's dofs, `old` the grips of its points at the
    /// step's start, `new` receives those at its end; both are empty without friction.
    #[expect(clippy::too_many_arguments, reason = "one loop serves residual, stiffness and history")]
    pub fn edge(
        &self,
        index: usize,
        datum_mm: T,
        u: &[T; 6],
        old: &[Grip<T>],
        mut new: Option<&mut [Grip<T>]>,
        force: &mut [T; 6],
        mut stiffness: Option<&mut EdgeStiffness>,
        sum: &mut Sum<T>,
    ) {
        let points = &self.points[index * self.per_edge..][..self.per_edge];
        for (i, p) in points.iter().enumerate() {
            let x = Self::position(p, u);
            let touch = self.indenter.touch(x, datum_mm);
            let traction = self.traction(&touch, old.get(i));
            if let Some(grip) = new.as_deref_mut().and_then(|n| n.get_mut(i)) {
                let traction_mpa = traction.as_ref().map_or(T::from(0.0), |t| t.friction);
                *grip = Grip { depth_mm: touch.depth_mm, arc_mm: touch.arc_mm, traction_mpa };
            }
            let Some(t) = traction else { continue };
            sum.energy += t.energy * p.area;
            sum.penalty_energy += t.penalty_energy * p.area;
            sum.force_n += t.force[1] * p.area;
            if touch.depth_mm.value() > 0.0 {
                sum.active += 1;
                sum.sliding += usize::from(t.slides);
                sum.radius_mm = sum.radius_mm.max(x[0].value());
            }
            for (a, n) in p.shape.iter().enumerate() {
                force[2 * a] += t.force[0] * (p.area * n);
                force[2 * a + 1] += t.force[1] * (p.area * n);
            }
            if let Some(k) = stiffness.as_deref_mut() {
                let scaled = |slope: [[T; 2]; 2]| slope.map(|r| r.map(|x| x.value() * p.area));
                add_stiffness(&mut k.whole, &p.shape, &scaled(t.slope));
                add_stiffness(&mut k.symmetric, &p.shape, &scaled(t.symmetric));
            }
        }
    }

    /// `None` where nothing acts.
    fn traction(&self, touch: &Touch<T>, old: Option<&Grip<T>>) -> Option<Traction<T>> {
        let (g, n, zero) = (touch.depth_mm, touch.normal, T::from(0.0));
        let touching = g.value() > 0.0;
        let (energy, pressure, slope) =
            if touching { self.penalty.push(g) } else { self.interface.adhesion.as_ref()?.pull(g) };
        let stored = if touching { pressure * g - energy } else { zero };
        // a touching point has gained the whole work of adhesion
        let gained = self.interface.adhesion.as_ref().filter(|_| touching).map_or(zero, |a| a.work_n_per_mm);
        // force -p n; its derivative: p' n n' - p c (1 - n n'), the second for the turning normal
        let bend = pressure * touch.curvature;
        let h = |i: usize, j: usize| {
            let nn = n[i] * n[j];
            slope * nn - if i == j { bend * (-nn + 1.0) } else { -(bend * nn) }
        };
        let mut t = Traction {
            force: [-(pressure * n[0]), -(pressure * n[1])],
            slope: [[h(0, 0), h(0, 1)], [h(1, 0), h(1, 1)]],
            symmetric: [[h(0, 0), h(0, 1)], [h(1, 0), h(1, 1)]],
            energy: energy - gained,
            penalty_energy: stored,
            friction: zero,
            slides: false,
        };
        if let (true, Some(old)) = (touching, old) {
            self.rub(touch, old, pressure, slope, &mut t);
        }
        Some(t)
    }

    /// Adds friction. With `a` the arc, `grad a = s t`, `t = [-n_z, n_r]`, its second
    /// derivative is `-c s (n t' + t n')` on the sphere and 0 on the shank.
    fn rub(&self, touch: &Touch<T>, old: &Grip<T>, pressure: T, slope: T, out: &mut Traction<T>) {
        let (g, n) = (touch.depth_mm, touch.normal);
        let along = [-n[1] * touch.arc_slope, n[0] * touch.arc_slope];
        let (k, by_depth) = self.penalty.secant(g);
        let moved = touch.arc_mm - old.arc_mm;
        // the part of the motion that counts, and its derivative by the depth
        let entered = old.depth_mm.value() <= 0.0;
        let span = g - old.depth_mm;
        let (part, by_entry) =
            if entered { (g / span, -(old.depth_mm / (span * span))) } else { (T::from(1.0), T::from(0.0)) };
        // trial traction and its derivative by the position; dg/dx = -n
        let before = if entered { T::from(0.0) } else { old.traction_mpa };
        let mut traction = before + k * part * moved;
        let turn = (by_depth * part + k * by_entry) * moved;
        let mut by = [0, 1].map(|i| along[i] * k * part - n[i] * turn);
        let limit = self.interface.friction * pressure;
        out.slides = traction.value().abs() > limit.value();
        if out.slides {
            let sign = traction.value().signum();
            traction = limit * sign;
            by = n.map(|n| -(n * self.interface.friction * slope * sign));
        } else {
            let slip_energy = traction * traction * 0.5 / k;
            out.energy += slip_energy;
            out.penalty_energy += slip_energy;
        }
        out.friction = traction;
        for i in 0..2 {
            out.force[i] += traction * along[i];
            for j in 0..2 {
                let turn = -(touch.curvature * (n[i] * along[j] + along[i] * n[j])) * traction;
                out.slope[i][j] += along[i] * by[j] + turn;
                out.symmetric[i][j] += if out.slides { turn } else { along[i] * along[j] * k * part + turn };
            }
        }
    }
}

fn add_stiffness(k: &mut [[f64; 6]; 6], shape: &[f64; 3], slope: &[[f64; 2]; 2]) {
    for (a, na) in shape.iter().enumerate() {
        for (b, nb) in shape.iter().enumerate() {
            for i in 0..2 {
                for j in 0..2 {
                    k[2 * a + i][2 * b + j] += na * nb * slope[i][j];
                }
            }
        }
    }
}
