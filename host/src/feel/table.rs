//! A board's table that displays and recognises nothing: the materials of some control curves.

use protocol::lut::{AxisSpec, MaterialSpec, Role, Scale, TableSpec, axis_name};

use super::Unfelt;
use crate::control::ControlCurve;

/// Letters of a material's name on the board.
const LETTERS: usize = 16;

/// The table's bytes; materials in the order of the curves.
pub(super) fn table(curves: &[ControlCurve]) -> Result<Vec<u8>, Unfelt> {
    let axis = |name: &str, unit: &str, role, values: &[f64]| AxisSpec::new(name, unit, role, Scale::Linear, values);
    let material = |curve: &ControlCurve| MaterialSpec {
        name: curve.material.chars().filter(char::is_ascii).take(LETTERS).collect(),
        mu_mpa: 0.1,
        alpha: 2.0,
        height_mm: 20.0,
        acceptance: 0.01,
        rate_mm_s: 0.0,
        force_n: vec![1.0, 2.0],
        display: curve.display(),
    };
    let spec = TableSpec {
        axes: vec![
            axis(axis_name::DEPTH, "mm", Role::Row, &[1.0, 2.0]),
            axis(axis_name::ALPHA, "", Role::Column, &[2.0]),
            axis(axis_name::MU, "MPa", Role::Factor, &[0.1, 0.2]),
        ],
        columns: vec![vec![10.0, 20.0]],
        library: curves.iter().map(material).collect(),
        discretisation: 0.0,
        interpolation: 0.0,
        provenance: "palpate feel: displays, and recognises nothing".to_owned(),
    };
    spec.to_bytes().map_err(|error| Unfelt::Table(error.to_string()))
}
