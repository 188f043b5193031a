//! The deformed specimen as a sheet, with its mirror image.

use std::collections::HashMap;

use lut_gen::fem::shape::quad8;
use lut_gen::solid::field::Field;

use crate::report::sheet::Sheet;

/// Triangles a side of an element is divided into.
const FINER: usize = 3;

/// The elements with a node within `reach_mm` of the axis, with nodal values; `[x, z]` in mm, the axis at x = 0.
pub fn drawn(field: &Field, nodal: &[f64], reach_mm: f64) -> Sheet {
    let mut sheet = Sheet::default();
    let mut known = HashMap::new();
    for element in &field.elements {
        if element.iter().all(|n| field.position_mm(*n)[0] > reach_mm) {
            continue;
        }
        for side in [1.0, -1.0] {
            add(&mut sheet, field, nodal, element, side, &mut known);
        }
    }
    sheet
}

fn add(
    sheet: &mut Sheet,
    field: &Field,
    nodal: &[f64],
    element: &[usize; 8],
    side: f64,
    known: &mut HashMap<[i64; 2], usize>,
) {
    let mut grid = Vec::with_capacity((FINER + 1) * (FINER + 1));
    for i in 0..=FINER {
        for j in 0..=FINER {
            let at = |k: usize| 2.0 * k as f64 / FINER as f64 - 1.0;
            let (shape, _) = quad8(at(i), at(j));
            let (mut reference, mut x, mut value) = ([0.0; 2], [0.0; 2], 0.0);
            for (n, &node) in shape.iter().zip(element) {
                let p = field.position_mm(node);
                for k in 0..2 {
                    reference[k] += n * field.nodes[node][k];
                    x[k] += n * p[k];
                }
                value += n * nodal[node];
            }
            // neighbours find their common points by reference position, to a millionth of a millimetre
            let key = [side * reference[0], reference[1]].map(|c| (1e6 * c).round() as i64);
            grid.push(*known.entry(key).or_insert_with(|| {
                sheet.points.push([side * x[0], x[1]]);
                sheet.values.push(value);
                sheet.points.len() - 1
            }));
        }
    }
    for i in 0..FINER {
        for j in 0..FINER {
            let at = |di: usize, dj: usize| grid[(i + di) * (FINER + 1) + j + dj];
            for [a, b, c] in [[at(0, 0), at(1, 0), at(1, 1)], [at(0, 0), at(1, 1), at(0, 1)]] {
                // the mirror image runs the other way round
                sheet.triangles.push(if side > 0.0 { [a, b, c] } else { [a, c, b] });
            }
        }
    }
}
