//! A finger's file with other moduli and measures.

use std::path::Path;

use toml::{Table, Value};

use crate::experiment::{ExperimentError, Problem};

/// What a finger's numbers are multiplied by, each more than 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scale {
    /// Moduli of skin and tissue.
    pub stiffness: f64,
    /// All lengths of the finger.
    pub size: f64,
    /// Moduli of the skin, beside the stiffness.
    pub skin: f64,
}

impl Scale {
    /// Nothing changes.
    pub const NONE: Scale = Scale { stiffness: 1.0, size: 1.0, skin: 1.0 };
}

/// Keys that hold lengths, with the section that they stand in.
const LENGTHS: [(Option<&str>, &str); 7] = [
    (None, "width_mm"),
    (None, "height_mm"),
    (None, "skin_mm"),
    (None, "element_mm"),
    (Some("bone"), "width_mm"),
    (Some("bone"), "height_mm"),
    (Some("bone"), "above_mm"),
];

/// The text of a finger's file with its numbers multiplied; remarks of the file are lost. `file` is what errors call it.
///
/// # Errors
/// A text that is no TOML.
pub fn scaled(file: &Path, text: &str, scale: Scale) -> Result<String, ExperimentError> {
    let wrong =
        |error: toml::de::Error| ExperimentError::of_file(file, Problem::Contradiction(error.message().to_owned()));
    let mut table: Table = text.parse().map_err(wrong)?;
    for (section, key) in LENGTHS {
        let place = match section {
            None => Some(&mut table),
            Some(name) => table.get_mut(name).and_then(Value::as_table_mut),
        };
        place.into_iter().for_each(|place| multiply(place, key, scale.size));
    }
    for (layer, factor) in [("skin", scale.stiffness * scale.skin), ("tissue", scale.stiffness)] {
        let Some(layer) = table.get_mut(layer).and_then(Value::as_table_mut) else { continue };
        multiply(layer, "mu_MPa", factor);
        multiply(layer, "bulk_MPa", factor);
        let terms = layer.get_mut("ogden").and_then(Value::as_array_mut).into_iter().flatten();
        terms.filter_map(Value::as_table_mut).for_each(|term| multiply(term, "mu_MPa", factor));
    }
    Ok(table.to_string())
}

fn multiply(table: &mut Table, key: &str, factor: f64) {
    let number = match table.get(key) {
        Some(Value::Float(number)) => *number,
        Some(Value::Integer(number)) => *number as f64,
        _ => return,
    };
    table.insert(key.to_owned(), Value::Float(factor * number));
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::finger::{BUILT_IN, parse};

    #[test]
    fn moduli_and_lengths_of_every_finger_are_multiplied() {
        for finger in BUILT_IN {
            let file = Path::new(finger.name);
            let (was, scale) = (parse(file, finger.text).unwrap(), Scale { stiffness: 3.0, size: 2.0, skin: 0.5 });
            let is = parse(file, &scaled(file, finger.text, scale).unwrap()).unwrap();
            let (a, b) = (&was.finger, &is.finger);
            assert!((b.skin.shear_mpa() / a.skin.shear_mpa() - 1.5).abs() < 1e-12, "{}", finger.name);
            assert!((b.tissue.shear_mpa() / a.tissue.shear_mpa() - 3.0).abs() < 1e-12, "{}", finger.name);
            assert_eq!(
                (b.half_width_mm, b.height_mm, b.skin_mm),
                (2.0 * a.half_width_mm, 2.0 * a.height_mm, 2.0 * a.skin_mm)
            );
            assert_eq!(
                (b.bone_half_width_mm, b.edge_mm, b.nail_deg),
                (2.0 * a.bone_half_width_mm, 2.0 * a.edge_mm, a.nail_deg)
            );
            assert_eq!(is.title, was.title);
        }
    }
}
