//! Bodies that touch: what they are made of, where they are held, and the side that may touch.
//!
//! | file | holds |
//! |---|---|
//! | [`finger`] | the finger's cross-section: skin and tissue around the bone, below the nail |
//! | [`block`] | a block on a smooth or rough base |
//! | [`section`] | plane or ring: what a node does to the deformation gradient |

pub mod block;
pub mod finger;
pub mod section;

use super::law::material::Material;

/// A meshed body of eight-node elements, its half with x >= 0; x = 0 is its axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    /// Positions of the nodes (mm).
    pub nodes: Vec<[f64; 2]>,
    /// Nodes of the elements: corners counter-clockwise, then the middles of their sides.
    pub elements: Vec<[usize; 8]>,
    /// Material of every element, a place in `materials`.
    pub of: Vec<usize>,
    /// The materials.
    pub materials: Vec<Material>,
    /// Degrees of freedom of the nodes that move with the body's frame only.
    pub held: Vec<[bool; 2]>,
    /// Edges that may touch, from the axis outward: first, middle and last node.
    pub surface: Vec<[usize; 3]>,
}

impl Body {
    /// The same body upside down: mirrored at y = 0.
    #[must_use]
    pub fn upside_down(mut self) -> Self {
        for node in &mut self.nodes {
            node[1] = -node[1];
        }
        for e in &mut self.elements {
            // the other way round, so that areas stay positive
            *e = [e[0], e[3], e[2], e[1], e[7], e[6], e[5], e[4]];
        }
        self
    }
}
