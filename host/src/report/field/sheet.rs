//! The deformed specimen as a sheet, with its mirror image.

use std::collections::HashMap;

use lut_gen::solid::field::Field;

use crate::report::sheet::{Node, Sheet};

/// The elements with a node within `reach_mm` of the axis, with nodal values; `[x, z]` in mm, the axis at x = 0.
pub fn drawn(field: &Field, nodal: &[f64], reach_mm: f64) -> Sheet {
    let mut sheet = Sheet::default();
    let mut known = HashMap::new();
    for element in &field.elements {
        if element.iter().all(|n| field.position_mm(*n)[0] > reach_mm) {
            continue;
        }
        let nodes = element.map(|n| Node { rest: field.nodes[n], now: field.position_mm(n), value: nodal[n] });
        for side in [1.0, -1.0] {
            sheet.add(&nodes, side, &mut known);
        }
    }
    sheet
}
