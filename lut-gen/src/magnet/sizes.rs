//! The mesh of a design: how long its sides are where.

use crate::fem::drawing::{Curve, cut};
use crate::fem::mesh::{Mesh, MeshError, mesh};
use crate::fem::triangle::Order;

use super::design::{Design, DesignError, Region};

/// How sides follow the regions' sizes.
struct Grading {
    /// How they grow with the distance from a region.
    growth: f64,
    /// How they grow from a corner, where the field has a singularity if a permeability jumps around it.
    from_corner: f64,
    /// Their size there over that of the region, around a corner of steel and around one of weaker materials.
    at_corner: [f64; 2],
}

/// Least seconds at equal error of the ring electromagnet's curve; a triangle of third order bears sides that grow faster.
const LINEAR_AND_QUADRATIC: Grading = Grading { growth: 0.25, from_corner: 0.3, at_corner: [0.1, 0.1] };
const CUBIC: Grading = Grading { growth: 0.5, from_corner: 0.6, at_corner: [0.05, 0.1] };
/// Ratio of permeabilities around a corner up to which its materials are weak: the singularity of a fluid beside air is mild.
const WEAK: f64 = 30.0;
/// Longest side as a part of the mesh's radius.
const LONGEST: f64 = 0.12;
/// Directions in which the regions around a corner are looked at.
const LOOKS: usize = 72;

impl Design {
    /// Meshes it. `coarser` multiplies every size: 1 is the usual mesh.
    ///
    /// # Errors
    /// [`DesignError::Mesh`] with the region that is to blame.
    pub fn mesh(&self, order: Order, coarser: f64) -> Result<Mesh, DesignError> {
        let mut curves = self.frame();
        for region in &self.regions {
            let shapes = region.shapes.iter().chain(&region.without);
            curves.extend(shapes.flat_map(super::shape::Shape::outline));
        }
        let mut curves = unlike(curves);
        if self.is_half() {
            // A shape on the axis draws a side along it, which the frame has already.
            curves.retain(|c| !matches!(c, Curve::Line(a, b) if a[0].abs() + b[0].abs() < 1e-12));
            curves.push(self.axis());
        }
        let grading = if order == Order::Third { CUBIC } else { LINEAR_AND_QUADRATIC };
        let corners = self.corners(&cut(&curves), &grading);
        let sizes: Vec<f64> = self.regions.iter().map(|region| coarser * region.side_mm()).collect();
        let longest = coarser * LONGEST * self.meshed_mm();
        let size = |p: [f64; 2]| {
            let mut least = longest;
            for (region, own) in self.regions.iter().zip(&sizes) {
                if *own < least {
                    let away = region.shapes.iter().map(|s| s.distance(p)).fold(f64::INFINITY, f64::min);
                    least = least.min(own + grading.growth * away);
                }
            }
            for (corner, own) in &corners {
                let away = (p[0] - corner[0]).hypot(p[1] - corner[1]);
                least = least.min(coarser * own + grading.from_corner * away);
            }
            least
        };
        let region = |p| self.is_inside(p).then(|| self.region_at(p));
        mesh(&curves, order, &size, &region).map_err(|source| self.blamed(source, &sizes))
    }

    /// A mesh that cannot be made, with the region at its place, or the one that asks for the smallest triangles.
    fn blamed(&self, source: MeshError, sizes: &[f64]) -> DesignError {
        let finest = sizes.iter().enumerate().min_by(|a, b| a.1.total_cmp(b.1)).map_or(0, |(i, _)| i + 1);
        let number = match &source {
            MeshError::Degenerate { at } => Some(self.region_at(*at)).filter(|number| *number > 0),
            _ => None,
        };
        let number = number.unwrap_or(finest);
        let size_mm = number.checked_sub(1).and_then(|i| sizes.get(i)).copied().unwrap_or(f64::NAN);
        DesignError::Mesh { region: self.name(number).to_owned(), size_mm, source }
    }

    /// Corners around which a permeability jumps, with the size of a side there.
    fn corners(&self, parts: &[Curve], grading: &Grading) -> Vec<([f64; 2], f64)> {
        let mut ends: Vec<[f64; 2]> = Vec::new();
        for end in parts.iter().flat_map(|part| [part.at(0.0), part.at(1.0)]) {
            if ends.iter().all(|own| (own[0] - end[0]).hypot(own[1] - end[1]) > 1e-6) {
                ends.push(end);
            }
        }
        ends.into_iter().filter_map(|end| Some((end, self.at_corner(end, grading)?))).collect()
    }

    /// The size of a side at a corner, by the smallest region there; `None` where the border between strong and weak
    /// materials is smooth.
    fn at_corner(&self, p: [f64; 2], grading: &Grading) -> Option<f64> {
        let around: Vec<usize> = (0..LOOKS)
            .map(|i| std::f64::consts::TAU * (i as f64 + 0.5) / LOOKS as f64)
            .map(|angle| [p[0] + 1e-4 * angle.cos(), p[1] + 1e-4 * angle.sin()])
            .filter(|at| !self.is_half() || at[0] > 0.0)
            .map(|at| self.region_at(at))
            .collect();
        let differ = |a: usize, b: usize| self.law(a) != self.law(b) || self.is_magnet(a) || self.is_magnet(b);
        let jumps: Vec<usize> = (0..around.len())
            .filter(|i| {
                let (a, b) = (around[*i], around[(i + 1) % around.len()]);
                a != b && differ(a, b)
            })
            .collect();
        let smooth = match jumps.as_slice() {
            [] => true,
            // Opposite each other: a straight border passes.
            [a, b] if around.len() == LOOKS => (b - a).abs_diff(LOOKS / 2) <= 1,
            // On axis and mirror the other half is the image: a border across it is smooth.
            [a] => (2 * (a + 1)).abs_diff(around.len()) <= 2,
            _ => false,
        };
        let regions = around.iter().filter_map(|number| self.regions.get(number.checked_sub(1)?));
        let least = regions.map(Region::side_mm).fold(f64::INFINITY, f64::min);
        let reluctivity = |number: &usize| self.law(*number).at(0.0).slope;
        let range = |(low, high): (f64, f64), value: f64| (low.min(value), high.max(value));
        let (low, high) = around.iter().map(reluctivity).fold((f64::INFINITY, 0.0), range);
        let part = grading.at_corner[usize::from(high < WEAK * low)];
        (!smooth && least.is_finite()).then_some(part * least)
    }

    fn is_magnet(&self, number: usize) -> bool {
        number > 0 && self.regions[number - 1].coercive != [0.0; 2]
    }
}

/// Curves without those that are there already.
fn unlike(curves: Vec<Curve>) -> Vec<Curve> {
    let mut kept: Vec<Curve> = Vec::new();
    for curve in curves {
        let turned = match curve {
            Curve::Line(a, b) => Curve::Line(b, a),
            arc @ Curve::Arc { .. } => arc,
        };
        if !kept.contains(&curve) && !kept.contains(&turned) {
            kept.push(curve);
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::panic)]
    use super::*;
    use crate::magnet::bh::Law;
    use crate::magnet::edge::Edge;
    use crate::magnet::field::Geometry;
    use crate::magnet::shape::Shape;

    fn block(name: &str, from: [f64; 2], to: [f64; 2], law: Law) -> Region {
        Region {
            name: name.into(),
            shapes: vec![Shape::Rectangle(from, to)],
            without: Vec::new(),
            law,
            coercive: [0.0; 2],
            coil: None,
            size_mm: None,
        }
    }

    #[test]
    fn only_corners_of_jumps_are_graded() {
        let iron = Law::Linear(1000.0);
        let design = Design {
            geometry: Geometry::Plane,
            depth_mm: 1.0,
            out_of_plane: None,
            mirror: None,
            edge: Edge::Round { radius: 50.0 },
            // Two blocks of iron side by side are one; the copper above them has corners of no account.
            regions: vec![
                block("left", [-6.0, 0.0], [0.0, 6.0], iron.clone()),
                block("right", [0.0, 0.0], [6.0, 6.0], iron),
                block("copper", [-3.0, 6.0], [3.0, 9.0], Law::Linear(1.0)),
            ],
            coils: Vec::new(),
        };
        let mut curves = design.frame();
        curves.extend(design.regions.iter().flat_map(|r| r.shapes[0].outline()));
        let mut corners: Vec<[f64; 2]> =
            design.corners(&cut(&unlike(curves)), &CUBIC).iter().map(|(p, _)| *p).collect();
        corners.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
        assert_eq!(corners, [[-6.0, 0.0], [-6.0, 6.0], [6.0, 0.0], [6.0, 6.0]]);
        let mesh = design.mesh(Order::Second, 1.0).unwrap_or_else(|e| panic!("{e}"));
        assert!(mesh.triangles.len() < 6000, "{}", mesh.triangles.len());
        let area = |number: usize| mesh.regions.iter().filter(|r| **r == number).count();
        assert!((1..=3).all(|number| area(number) > 20));
    }
}
