//! A block below the finger.

use super::Body;
use crate::fem::block::BlockMesh;
use crate::fem::grading::graded;
use crate::pad::error::{PadError, demand};
use crate::pad::law::material::Material;

/// A block with its upper side at y = `top_mm`; its outer side is free.
#[derive(Debug, Clone, PartialEq)]
pub struct Block {
    /// Height (mm).
    pub height_mm: f64,
    /// Radius, in the plane half width (mm).
    pub radius_mm: f64,
    /// Where its upper side is (mm).
    pub top_mm: f64,
    /// The base is bonded, otherwise it slides.
    pub bonded: bool,
    /// What it is made of.
    pub material: Material,
    /// Length of the elements below the contact (mm).
    pub edge_mm: f64,
    /// How far from the axis they are that short (mm).
    pub fine_mm: f64,
}

/// How much longer elements are with their distance from where they are short.
const GROWTH: f64 = 0.25;

impl Block {
    /// Meshes it.
    ///
    /// # Errors
    /// [`PadError::Value`] for a measure that makes no block.
    pub fn body(&self) -> Result<Body, PadError> {
        for (name, value) in [
            ("the block's height (mm)", self.height_mm),
            ("the block's radius (mm)", self.radius_mm),
            ("the block's element length (mm)", self.edge_mm),
        ] {
            demand(value > 0.0 && value.is_finite(), name, value, "more than 0")?;
        }
        let fine = self.height_mm.min(self.radius_mm) / self.edge_mm;
        demand(fine <= 2000.0, "the block's size over its element length", fine, "at most 2000")?;
        demand(self.fine_mm >= 0.0, "the width of the block's short elements (mm)", self.fine_mm, "0 or more")?;
        demand(self.top_mm.is_finite(), "the block's upper side (mm)", self.top_mm, "a number")?;
        let x = graded(self.radius_mm, 1.0, |x| self.edge_mm + GROWTH * (x - self.fine_mm).max(0.0));
        let depth = graded(self.height_mm, 1.0, |s| self.edge_mm + GROWTH * s);
        let y: Vec<f64> = depth.iter().rev().map(|s| self.height_mm - s).collect();
        let mesh = BlockMesh::from_lines(&x, &y);
        let held = mesh.nodes.iter().map(|[x, y]| {
            let base = *y <= 0.0;
            [*x <= 0.0 || (base && self.bonded), base]
        });
        Ok(Body {
            held: held.collect(),
            of: vec![0; mesh.elements.len()],
            materials: vec![self.material.clone()],
            nodes: mesh.nodes.iter().map(|[x, y]| [*x, y - self.height_mm + self.top_mm]).collect(),
            surface: mesh.top,
            elements: mesh.elements,
        })
    }
}
