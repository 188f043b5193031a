//! Shapes that the regions of a magnet are drawn with.

use crate::fem::drawing::Curve;

/// A shape in the plane (x, y) or the half plane (r, z), mm.
#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    /// By its lower left and its upper right corner.
    Rectangle([f64; 2], [f64; 2]),
    /// All within a radius of a centre.
    Disc([f64; 2], f64),
    /// What lies between two radii of a centre.
    Ring {
        /// Its centre.
        centre: [f64; 2],
        /// Radii, the smaller first, more than 0.
        radii: [f64; 2],
        /// Where it begins and ends, degrees counter-clockwise from +x; a whole turn is a closed ring.
        degrees: [f64; 2],
    },
    /// By its corners, in either sense.
    Polygon(Vec<[f64; 2]>),
}

/// A shape without an inside.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{what} is {value}, expected {expected}")]
pub struct ShapeError {
    /// Which measure.
    pub what: &'static str,
    /// Its value.
    pub value: f64,
    /// What was expected.
    pub expected: &'static str,
}

impl Shape {
    /// Checks that it has an inside.
    ///
    /// # Errors
    /// [`ShapeError`] that names the measure.
    pub fn check(&self) -> Result<(), ShapeError> {
        let wrong = |what, value, expected| Err(ShapeError { what, value, expected });
        let finite = |values: &[f64]| values.iter().copied().find(|v| !v.is_finite());
        match self {
            Shape::Rectangle(a, b) => {
                if let Some(value) = finite(&[a[0], a[1], b[0], b[1]]) {
                    return wrong("a corner", value, "a number of mm");
                }
                if b[0] <= a[0] {
                    return wrong("the rectangle's width", b[0] - a[0], "more than 0 mm");
                }
                if b[1] <= a[1] {
                    return wrong("the rectangle's height", b[1] - a[1], "more than 0 mm");
                }
            }
            Shape::Disc(_, radius) if !(*radius > 0.0 && radius.is_finite()) => {
                return wrong("the radius", *radius, "more than 0 mm");
            }
            Shape::Disc(..) => {}
            Shape::Ring { radii: [inner, outer], degrees: [from, to], .. } => {
                if !(*inner > 0.0 && inner.is_finite()) {
                    return wrong("the inner radius", *inner, "more than 0 mm (a disc has none)");
                }
                if !(outer > inner && outer.is_finite()) {
                    return wrong("the outer radius", *outer, "more than the inner radius");
                }
                if !(to > from && to - from <= 360.0) {
                    return wrong("the angle of the ring", to - from, "more than 0, at most 360 degrees");
                }
            }
            Shape::Polygon(corners) => {
                if corners.len() < 3 {
                    return wrong("the number of corners", corners.len() as f64, "at least 3");
                }
                let area = signed_area(corners).abs();
                if area.is_nan() || area <= 0.0 {
                    return wrong("the polygon's area", area, "more than 0 mm^2");
                }
            }
        }
        Ok(())
    }

    /// True when a point lies inside.
    #[must_use]
    pub fn contains(&self, p: [f64; 2]) -> bool {
        match self {
            Shape::Rectangle(a, b) => (a[0]..b[0]).contains(&p[0]) && (a[1]..b[1]).contains(&p[1]),
            Shape::Disc(c, radius) => (p[0] - c[0]).hypot(p[1] - c[1]) < *radius,
            Shape::Ring { centre, radii, degrees } => {
                let (dx, dy) = (p[0] - centre[0], p[1] - centre[1]);
                let turn = (dy.atan2(dx).to_degrees() - degrees[0]).rem_euclid(360.0);
                (radii[0]..radii[1]).contains(&dx.hypot(dy)) && turn < degrees[1] - degrees[0]
            }
            Shape::Polygon(corners) => {
                // Crossings of the ray to the right.
                let crosses = |(a, b): ([f64; 2], [f64; 2])| {
                    (a[1] > p[1]) != (b[1] > p[1]) && p[0] < a[0] + (p[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0])
                };
                sides(corners).filter(|side| crosses(*side)).count() % 2 == 1
            }
        }
    }

    /// Its outline.
    #[must_use]
    pub fn outline(&self) -> Vec<Curve> {
        match self {
            Shape::Rectangle(a, b) => Curve::rectangle(*a, *b).to_vec(),
            Shape::Disc(centre, radius) => vec![Curve::circle(*centre, *radius)],
            Shape::Ring { centre, radii, degrees: [from, to] } if to - from >= 360.0 => {
                radii.map(|radius| Curve::circle(*centre, radius)).to_vec()
            }
            Shape::Ring { centre, radii, degrees } => {
                let [from, to] = degrees.map(f64::to_radians);
                let at = |radius: f64, angle: f64| [centre[0] + radius * angle.cos(), centre[1] + radius * angle.sin()];
                let end = |angle: f64| Curve::Line(at(radii[0], angle), at(radii[1], angle));
                let arc = |radius: f64| Curve::Arc { centre: *centre, radius, from, to };
                vec![arc(radii[0]), arc(radii[1]), end(from), end(to)]
            }
            Shape::Polygon(corners) => sides(corners).map(|(a, b)| Curve::Line(a, b)).collect(),
        }
    }

    /// Its smallest extent, mm.
    #[must_use]
    pub fn thickness(&self) -> f64 {
        match self {
            Shape::Rectangle(a, b) => (b[0] - a[0]).min(b[1] - a[1]),
            Shape::Disc(_, radius) => 2.0 * radius,
            Shape::Ring { radii, degrees, .. } => {
                (radii[1] - radii[0]).min(radii[1] * (degrees[1] - degrees[0]).to_radians())
            }
            Shape::Polygon(corners) => {
                let around: f64 = sides(corners).map(|(a, b)| (b[0] - a[0]).hypot(b[1] - a[1])).sum();
                2.0 * signed_area(corners).abs() / around
            }
        }
    }

    /// Distance of a point from its inside, mm; 0 within.
    #[must_use]
    pub fn distance(&self, p: [f64; 2]) -> f64 {
        if self.contains(p) {
            return 0.0;
        }
        match self {
            Shape::Rectangle(a, b) => {
                let out = |i: usize| (a[i] - p[i]).max(p[i] - b[i]).max(0.0);
                out(0).hypot(out(1))
            }
            Shape::Disc(c, radius) => (p[0] - c[0]).hypot(p[1] - c[1]) - radius,
            Shape::Ring { centre, radii, .. } => {
                // Of the closed ring or of the ends, whichever is near: less than the distance of an open ring at most
                // where it is open, which makes the mesh a little finer there.
                let r = (p[0] - centre[0]).hypot(p[1] - centre[1]);
                (radii[0] - r).max(r - radii[1]).max(0.0)
            }
            Shape::Polygon(corners) => sides(corners).map(|side| from_line(p, side)).fold(f64::INFINITY, f64::min),
        }
    }

    /// The point of it that is farthest from the origin, as a distance, mm.
    #[must_use]
    pub fn reach(&self) -> f64 {
        match self {
            Shape::Rectangle(a, b) => a[0].abs().max(b[0].abs()).hypot(a[1].abs().max(b[1].abs())),
            Shape::Disc(c, radius) => c[0].hypot(c[1]) + radius,
            Shape::Ring { centre, radii, .. } => centre[0].hypot(centre[1]) + radii[1],
            Shape::Polygon(corners) => corners.iter().map(|p| p[0].hypot(p[1])).fold(0.0, f64::max),
        }
    }

    /// Lower left and upper right corner of the box around it, mm; of an open ring that around the closed one.
    #[must_use]
    pub fn bounds(&self) -> [[f64; 2]; 2] {
        let around = |c: &[f64; 2], radius: f64| [c.map(|x| x - radius), c.map(|x| x + radius)];
        match self {
            Shape::Rectangle(a, b) => [*a, *b],
            Shape::Disc(c, radius) => around(c, *radius),
            Shape::Ring { centre, radii, .. } => around(centre, radii[1]),
            Shape::Polygon(corners) => {
                corners.iter().fold([[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]], |[low, high], p| {
                    [[low[0].min(p[0]), low[1].min(p[1])], [high[0].max(p[0]), high[1].max(p[1])]]
                })
            }
        }
    }
}

fn sides(corners: &[[f64; 2]]) -> impl Iterator<Item = ([f64; 2], [f64; 2])> {
    corners.iter().copied().zip(corners.iter().copied().cycle().skip(1))
}

fn signed_area(corners: &[[f64; 2]]) -> f64 {
    sides(corners).map(|(a, b)| 0.5 * (a[0] * b[1] - a[1] * b[0])).sum()
}

fn from_line(p: [f64; 2], (a, b): ([f64; 2], [f64; 2])) -> f64 {
    let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
    let place = (((p[0] - a[0]) * dx + (p[1] - a[1]) * dy) / (dx * dx + dy * dy)).clamp(0.0, 1.0);
    (p[0] - a[0] - place * dx).hypot(p[1] - a[1] - place * dy)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::panic)]
    use super::*;

    fn shapes() -> [Shape; 4] {
        [
            Shape::Rectangle([1.0, -2.0], [4.0, 5.0]),
            Shape::Disc([1.0, 1.0], 2.5),
            Shape::Ring { centre: [0.0, 1.0], radii: [2.0, 5.0], degrees: [300.0, 400.0] },
            Shape::Polygon(vec![[0.0, 0.0], [6.0, 0.0], [2.0, 2.0], [0.0, 6.0]]),
        ]
    }

    /// The area by counting points is what the outline encloses, by Green's theorem over its curves.
    #[test]
    fn what_a_shape_contains_has_the_area_of_its_measures() {
        let exact = [21.0, std::f64::consts::PI * 6.25, 100_f64.to_radians() * 0.5 * 21.0, 12.0];
        for (shape, exact) in shapes().iter().zip(exact) {
            let n = 1200;
            let step = 16.0 / f64::from(n);
            let at = |i: i32| -8.0 + step * (f64::from(i) + 0.5);
            let count =
                (0..n).flat_map(|i| (0..n).map(move |j| (i, j))).filter(|(i, j)| shape.contains([at(*i), at(*j)]));
            let area = count.count() as f64 * step * step;
            assert!((area / exact - 1.0).abs() < 2e-3, "{shape:?}: {area} for {exact}");
        }
    }

    #[test]
    fn an_outline_separates_inside_from_outside() {
        for shape in shapes() {
            assert!(shape.check().is_ok());
            for curve in shape.outline() {
                let (a, b) = (curve.at(0.4999), curve.at(0.5001));
                let m = curve.at(0.5);
                let (nx, ny) = (b[1] - a[1], a[0] - b[0]);
                let size = nx.hypot(ny);
                let side = |sign: f64| [m[0] + sign * 1e-4 * nx / size, m[1] + sign * 1e-4 * ny / size];
                assert_ne!(shape.contains(side(1.0)), shape.contains(side(-1.0)), "{shape:?} {curve:?}");
                assert!(shape.distance(m) < 1e-9 && shape.reach() >= m[0].hypot(m[1]) - 1e-9);
                assert!(shape.bounds()[0][0] <= m[0] + 1e-9);
            }
        }
    }

    #[test]
    fn shapes_without_an_inside_are_told_by_their_measure() {
        let text = |shape: Shape| shape.check().unwrap_err().to_string();
        assert_eq!(
            text(Shape::Rectangle([0.0, 0.0], [0.0, 1.0])),
            "the rectangle's width is 0, expected more than 0 mm"
        );
        assert_eq!(
            text(Shape::Ring { centre: [0.0; 2], radii: [3.0, 2.0], degrees: [0.0, 360.0] }),
            "the outer radius is 2, expected more than the inner radius"
        );
        assert_eq!(text(Shape::Polygon(vec![[0.0; 2]; 2])), "the number of corners is 2, expected at least 3");
    }
}
