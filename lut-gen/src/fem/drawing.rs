//! Lines and arcs in the plane, cut where they meet.

/// A curve of a drawing, mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Curve {
    /// Straight, from one point to another.
    Line([f64; 2], [f64; 2]),
    /// Part of a circle, counter-clockwise.
    Arc {
        /// Its centre.
        centre: [f64; 2],
        /// Its radius, mm.
        radius: f64,
        /// Where it begins, rad.
        from: f64,
        /// Where it ends, rad; more than `from`.
        to: f64,
    },
}

/// Two places on a curve are one when they are nearer than this, as a part of its length.
const SAME: f64 = 1e-9;

impl Curve {
    /// A whole circle.
    #[must_use]
    pub const fn circle(centre: [f64; 2], radius: f64) -> Self {
        Curve::Arc { centre, radius, from: 0.0, to: std::f64::consts::TAU }
    }

    /// The four sides of a rectangle.
    #[must_use]
    pub const fn rectangle([x0, y0]: [f64; 2], [x1, y1]: [f64; 2]) -> [Self; 4] {
        [
            Curve::Line([x0, y0], [x1, y0]),
            Curve::Line([x1, y0], [x1, y1]),
            Curve::Line([x1, y1], [x0, y1]),
            Curve::Line([x0, y1], [x0, y0]),
        ]
    }

    /// The point at a place from 0 to 1.
    #[must_use]
    pub fn at(&self, place: f64) -> [f64; 2] {
        match *self {
            Curve::Line(a, b) => [a[0] + place * (b[0] - a[0]), a[1] + place * (b[1] - a[1])],
            Curve::Arc { centre, radius, from, to } => {
                let angle = from + place * (to - from);
                [centre[0] + radius * angle.cos(), centre[1] + radius * angle.sin()]
            }
        }
    }

    /// Its length, mm.
    #[must_use]
    pub fn length(&self) -> f64 {
        match *self {
            Curve::Line(a, b) => (b[0] - a[0]).hypot(b[1] - a[1]),
            Curve::Arc { radius, from, to, .. } => radius * (to - from),
        }
    }

    /// The place of a point that lies on its line or circle, if it is within the curve.
    fn place(&self, p: [f64; 2]) -> Option<f64> {
        let place = match *self {
            Curve::Line(a, b) => {
                let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
                ((p[0] - a[0]) * dx + (p[1] - a[1]) * dy) / (dx * dx + dy * dy)
            }
            Curve::Arc { centre, from, to, .. } => {
                let turn = ((p[1] - centre[1]).atan2(p[0] - centre[0]) - from).rem_euclid(std::f64::consts::TAU);
                // A hair before the beginning is the beginning.
                let turn = if std::f64::consts::TAU - turn < SAME { 0.0 } else { turn };
                turn / (to - from)
            }
        };
        (-SAME..=1.0 + SAME).contains(&place).then(|| place.clamp(0.0, 1.0))
    }

    /// Points in which two curves' lines and circles meet.
    fn meet(&self, other: &Curve) -> Vec<[f64; 2]> {
        match (*self, *other) {
            (Curve::Line(a, b), Curve::Line(c, d)) => {
                let (u, v) = ([b[0] - a[0], b[1] - a[1]], [d[0] - c[0], d[1] - c[1]]);
                let cross = u[0] * v[1] - u[1] * v[0];
                if cross.abs() <= SAME * u[0].hypot(u[1]) * v[0].hypot(v[1]) {
                    // Along each other: they are cut at each other's ends.
                    return [a, b, c, d]
                        .into_iter()
                        .filter(|p| distance(*p, a, u) < SAME && distance(*p, c, v) < SAME)
                        .collect();
                }
                let s = ((c[0] - a[0]) * v[1] - (c[1] - a[1]) * v[0]) / cross;
                vec![[a[0] + s * u[0], a[1] + s * u[1]]]
            }
            (Curve::Line(a, b), Curve::Arc { centre, radius, .. }) => line_and_circle(a, b, centre, radius),
            (Curve::Arc { centre, radius, .. }, Curve::Line(a, b)) => line_and_circle(a, b, centre, radius),
            (Curve::Arc { centre: p, radius: r, from, to }, Curve::Arc { centre: q, radius: s, from: f2, to: t2 }) => {
                let (dx, dy) = (q[0] - p[0], q[1] - p[1]);
                let d = dx.hypot(dy);
                if d <= SAME * r {
                    let ends = |angle: f64| [p[0] + r * angle.cos(), p[1] + r * angle.sin()];
                    return if (r - s).abs() <= SAME * r { [from, to, f2, t2].map(ends).to_vec() } else { Vec::new() };
                }
                let along = (d * d + r * r - s * s) / (2.0 * d);
                let square = r * r - along * along;
                if square < 0.0 {
                    return Vec::new();
                }
                let (ux, uy, aside) = (dx / d, dy / d, square.sqrt());
                [1.0, -1.0]
                    .map(|sign| [p[0] + along * ux - sign * aside * uy, p[1] + along * uy + sign * aside * ux])
                    .to_vec()
            }
        }
    }

    /// The part between two places.
    fn part(&self, begin: f64, end: f64) -> Curve {
        match *self {
            Curve::Line(..) => Curve::Line(self.at(begin), self.at(end)),
            Curve::Arc { centre, radius, from, to } => {
                Curve::Arc { centre, radius, from: from + begin * (to - from), to: from + end * (to - from) }
            }
        }
    }
}

/// Distance of a point from a line through `a` along `u`, as a part of the length of `u`.
fn distance(p: [f64; 2], a: [f64; 2], u: [f64; 2]) -> f64 {
    ((p[0] - a[0]) * u[1] - (p[1] - a[1]) * u[0]).abs() / (u[0] * u[0] + u[1] * u[1])
}

fn line_and_circle(a: [f64; 2], b: [f64; 2], centre: [f64; 2], radius: f64) -> Vec<[f64; 2]> {
    let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
    let square = dx * dx + dy * dy;
    let nearest = ((centre[0] - a[0]) * dx + (centre[1] - a[1]) * dy) / square;
    let foot = [a[0] + nearest * dx, a[1] + nearest * dy];
    let rest = radius * radius - (foot[0] - centre[0]).powi(2) - (foot[1] - centre[1]).powi(2);
    if rest < -SAME * radius * radius {
        return Vec::new();
    }
    let half = (rest.max(0.0) / square).sqrt();
    [half, -half].map(|s| [foot[0] + s * dx, foot[1] + s * dy]).to_vec()
}

/// The same curves, none of which meets another but at its ends.
#[must_use]
pub fn cut(curves: &[Curve]) -> Vec<Curve> {
    let mut parts = Vec::new();
    for (i, curve) in curves.iter().enumerate() {
        let mut places = vec![0.0, 1.0];
        for (j, other) in curves.iter().enumerate() {
            if i != j {
                let met = curve.meet(other).into_iter().filter(|p| other.place(*p).is_some());
                places.extend(met.filter_map(|p| curve.place(p)));
            }
        }
        places.sort_by(f64::total_cmp);
        places.dedup_by(|a, b| (*a - *b).abs() <= 10.0 * SAME);
        parts.extend(places.windows(2).map(|pair| curve.part(pair[0], pair[1])));
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rectangle_across_a_circle_is_cut_where_they_meet() {
        let mut curves = vec![Curve::circle([0.0, 0.0], 5.0)];
        curves.extend(Curve::rectangle([-3.0, -10.0], [3.0, 10.0]));
        let parts = cut(&curves);
        // The circle in five (it begins at an angle of nothing), two sides in three, two whole.
        assert_eq!(parts.len(), 5 + 3 + 1 + 3 + 1);
        let corner = [3.0, 4.0];
        let meets = |p: [f64; 2]| (p[0] - corner[0]).hypot(p[1] - corner[1]) < 1e-9;
        assert_eq!(parts.iter().filter(|part| meets(part.at(0.0)) || meets(part.at(1.0))).count(), 4);
        let length: f64 = parts.iter().map(Curve::length).sum();
        assert!((length - (std::f64::consts::TAU * 5.0 + 2.0 * 6.0 + 2.0 * 20.0)).abs() < 1e-9);
    }

    #[test]
    fn lines_along_each_other_are_cut_at_their_ends() {
        let parts = cut(&[Curve::Line([0.0, 0.0], [4.0, 0.0]), Curve::Line([1.0, 0.0], [6.0, 0.0])]);
        let ends: Vec<f64> = parts.iter().map(|part| part.at(1.0)[0]).collect();
        assert_eq!(ends, [1.0, 4.0, 4.0, 6.0]);
    }
}
