//! The finger's cross-section.

use super::Body;
use crate::fem::block::BlockMesh;
use crate::fem::grading::graded;
use crate::pad::error::{PadError, demand};
use crate::pad::law::material::Material;
use crate::pad::law::ogden::{BULK_OF_0475, Ogden};

/// Cross-section of a fingertip: an ellipse of skin over tissue around an elliptic bone, below the
/// nail.
///
/// ```text
///        y
///        |____________       the nail's ray at `nail_deg` above the horizontal
///   bone | )   tissue )
///        |/  _______ / skin
///        +--         x
/// ```
///
/// Its centre is (0, 0), its lowest point (0, -height). Of the right half the part below the nail's
/// ray is meshed; the ray belongs to the nail, the inner ellipse to the bone. Both are rigid and
/// move together.
#[derive(Debug, Clone, PartialEq)]
pub struct Finger {
    /// Half width (mm).
    pub half_width_mm: f64,
    /// From the centre to the lowest point (mm).
    pub height_mm: f64,
    /// Thickness of the skin (mm).
    pub skin_mm: f64,
    /// Half width of the bone (mm).
    pub bone_half_width_mm: f64,
    /// Half height of the bone (mm).
    pub bone_half_height_mm: f64,
    /// Centre of the bone above that of the finger (mm).
    pub bone_above_mm: f64,
    /// Where the nail begins, degrees above the horizontal, 0 to 80.
    pub nail_deg: f64,
    /// Skin.
    pub skin: Material,
    /// Tissue.
    pub tissue: Material,
    /// Length of the elements in the pad (mm).
    pub edge_mm: f64,
    /// How far round from the lowest point elements are that short (degrees): a finger pressed by a
    /// quarter of its height touches up to 45.
    pub pad_deg: f64,
}

/// Length of elements beyond the pad over their distance from it, and of those towards the bone.
const GROWTH: f64 = 0.2;

impl Finger {
    /// A round finger of radius 8 mm with 0.8 mm of skin around a bone of radius 3 mm, neo-Hookean
    /// with Poisson's ratio 0.475: skin 0.08 MPa, tissue 0.012 MPa (orders of Wu et al. 2006,
    /// doi:10.1016/j.medengphy.2005.02.007).
    ///
    /// # Errors
    /// [`PadError`].
    pub fn round() -> Result<Self, PadError> {
        let neo = |mu: f64| Ogden::neo_hooke(mu, BULK_OF_0475 * mu).map(Material::Ogden);
        Ok(Self {
            half_width_mm: 8.0,
            height_mm: 8.0,
            skin_mm: 0.8,
            bone_half_width_mm: 3.0,
            bone_half_height_mm: 3.0,
            bone_above_mm: 0.0,
            nail_deg: 0.0,
            skin: neo(0.08)?,
            tissue: neo(0.012)?,
            edge_mm: 0.15,
            pad_deg: 45.0,
        })
    }

    /// The same finger stretched along x, its bone with it; skin stays as thick (thesis section
    /// 4.1.2: how much force a print with two radii adds).
    #[must_use]
    pub fn stretched(&self, ratio: f64) -> Self {
        Self {
            half_width_mm: ratio * self.half_width_mm,
            bone_half_width_mm: ratio * self.bone_half_width_mm,
            ..self.clone()
        }
    }

    fn checked(&self) -> Result<(), PadError> {
        let positive = |value: f64| value > 0.0 && value.is_finite();
        for (name, value) in [
            ("the finger's half width (mm)", self.half_width_mm),
            ("the finger's height (mm)", self.height_mm),
            ("the skin's thickness (mm)", self.skin_mm),
            ("the bone's half width (mm)", self.bone_half_width_mm),
            ("the bone's half height (mm)", self.bone_half_height_mm),
            ("the finger's element length (mm)", self.edge_mm),
        ] {
            demand(positive(value), name, value, "more than 0")?;
        }
        let fine = self.height_mm.min(self.half_width_mm) / self.edge_mm;
        demand(fine <= 4000.0, "the finger's size over its element length", fine, "at most 4000")?;
        demand((0.0..=90.0).contains(&self.pad_deg), "the pad's angle (degrees)", self.pad_deg, "0 to 90")?;
        let nail = self.nail_deg;
        demand((0.0..=80.0).contains(&nail), "the nail's angle (degrees)", nail, "0 to 80")?;
        let beside = self.half_width_mm - self.skin_mm - self.bone_half_width_mm;
        demand(beside > 0.0, "the tissue beside the bone (mm)", beside, "more than 0")?;
        let below = self.height_mm - self.skin_mm - self.bone_half_height_mm + self.bone_above_mm;
        demand(below > 0.0, "the tissue below the bone (mm)", below, "more than 0")?;
        let above = self.height_mm - self.skin_mm - self.bone_half_height_mm - self.bone_above_mm;
        demand(nail == 0.0 || above > 0.0, "the tissue above the bone (mm)", above, "more than 0")
    }

    /// The point at an angle from the lowest point (radians) and a part of the way inward: 0 on the
    /// outside, 1 between skin and tissue, 2 on the bone.
    fn at(&self, angle: f64, inward: f64) -> [f64; 2] {
        let ellipse = |a: f64, b: f64, y: f64| [a * angle.sin(), y - b * angle.cos()];
        let outer = ellipse(self.half_width_mm, self.height_mm, 0.0);
        let middle = ellipse(self.half_width_mm - self.skin_mm, self.height_mm - self.skin_mm, 0.0);
        let bone = ellipse(self.bone_half_width_mm, self.bone_half_height_mm, self.bone_above_mm);
        let (from, to, part) = if inward <= 1.0 { (outer, middle, inward) } else { (middle, bone, inward - 1.0) };
        [0, 1].map(|i| from[i] + part * (to[i] - from[i]))
    }

    /// Meshes it: elements of the asked length in the pad, longer ones beside it and towards the
    /// bone.
    ///
    /// # Errors
    /// [`PadError::Value`] for a measure that makes no finger.
    pub fn body(&self) -> Result<Body, PadError> {
        self.checked()?;
        let radius = 0.5 * (self.half_width_mm + self.height_mm);
        let end = std::f64::consts::FRAC_PI_2 + self.nail_deg.to_radians();
        let pad = self.pad_deg.to_radians();
        let angles = graded(end, 1.0, |a| self.edge_mm / radius + GROWTH * (a - pad).max(0.0));
        let skin = graded(self.skin_mm, 1.0, |_| self.edge_mm.max(self.skin_mm / 3.0).min(self.skin_mm / 2.0));
        let thickness = self.height_mm - self.skin_mm - self.bone_half_height_mm + self.bone_above_mm;
        let tissue = graded(thickness, 1.0, |s| 1.5 * self.edge_mm + 0.5 * GROWTH * s);
        let inward: Vec<f64> =
            skin.iter().map(|s| s / self.skin_mm).chain(tissue[1..].iter().map(|s| 1.0 + s / thickness)).collect();
        let mesh = BlockMesh::from_lines(&angles, &inward);
        let surface = mesh.elements.iter().filter(|e| mesh.nodes[e[0]][1] == 0.0).map(|e| [e[0], e[4], e[1]]).collect();
        let held = mesh.nodes.iter().map(|[a, s]| match () {
            () if *s >= 2.0 || *a >= end => [true; 2],
            () => [*a <= 0.0, false],
        });
        let is_tissue = |e: &[usize; 8]| usize::from(mesh.nodes[e[7]][1] > 1.0);
        Ok(Body {
            held: held.collect(),
            of: mesh.elements.iter().map(is_tissue).collect(),
            materials: vec![self.skin.clone(), self.tissue.clone()],
            nodes: mesh.nodes.iter().map(|[a, s]| self.at(*a, *s)).collect(),
            surface,
            elements: mesh.elements,
        })
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::super::section::{Rule, Section};
    use super::*;
    use std::f64::consts::PI;

    fn volume(body: &Body, section: Section, material: usize) -> f64 {
        let of = |(e, m): (&[usize; 8], &usize)| {
            let element = section.element(Rule::Full, *e, &e.map(|n| body.nodes[n])).unwrap();
            if *m == material { element.volumes().sum::<f64>() } else { 0.0 }
        };
        body.elements.iter().zip(&body.of).map(of).sum()
    }

    /// Half discs and half balls. Quadratic sides leave 1e-6 of a circle of 0.15 mm sides.
    #[test]
    fn layers_have_their_volumes() {
        let body = Finger::round().unwrap().body().unwrap();
        let half_disc = |r: f64| 0.5 * PI * r * r;
        let half_ball = |r: f64| 2.0 / 3.0 * PI * r * r * r;
        for (material, outer, inner) in [(0, 8.0, 7.2), (1, 7.2, 3.0)] {
            for (section, of) in [(Section::Plane, &half_disc as &dyn Fn(f64) -> f64), (Section::Ring, &half_ball)] {
                let part = volume(&body, section, material) / (of(outer) - of(inner)) - 1.0;
                assert!(part.abs() < 1e-5, "{section:?} {material}: {part:e}");
            }
        }
    }

    #[test]
    fn the_outside_runs_outward_from_the_lowest_point() {
        let finger = Finger { nail_deg: 40.0, half_width_mm: 9.0, ..Finger::round().unwrap() };
        let body = finger.body().unwrap();
        assert_eq!(body.nodes[body.surface[0][0]], [0.0, -8.0]);
        for e in &body.surface {
            for n in e {
                let [x, y] = body.nodes[*n];
                assert!(((x / 9.0).powi(2) + (y / 8.0).powi(2) - 1.0).abs() < 1e-12);
            }
        }
        assert!(body.surface.windows(2).all(|w| w[0][2] == w[1][0]));
        let held = |n: usize| body.held[n] == [true; 2];
        assert!(held(body.surface.last().unwrap()[2]) && !held(body.surface[0][0]));
    }

    #[test]
    fn measures_that_make_no_finger_are_named() {
        let finger = Finger { bone_half_width_mm: 7.5, ..Finger::round().unwrap() };
        let text = finger.body().unwrap_err().to_string();
        assert!(text.starts_with("the tissue beside the bone (mm) is -0.2999"), "{text}");
        let finger = Finger { skin_mm: f64::NAN, ..Finger::round().unwrap() };
        assert_eq!(finger.body().unwrap_err().to_string(), "the skin's thickness (mm) is NaN: expected more than 0");
        let finger = Finger { nail_deg: 85.0, ..Finger::round().unwrap() };
        assert!(finger.body().is_err());
    }
}
