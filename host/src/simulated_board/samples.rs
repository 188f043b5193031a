//! A small table and its foam, for tests.

use protocol::lut::{AxisSpec, DisplaySpec, MaterialSpec, Role, Scale, TableSpec, axis_name};

use crate::plant::{Curve, Foam};

const HEIGHT_MM: f64 = 12.7;
const DEPTHS: u32 = 200;
const STEP_MM: f64 = 0.02;

/// Force of `alpha` at a depth, N at 1 MPa: Hertz, stiffer with depth.
fn force_n(alpha: f64, depth_mm: f64) -> f64 {
    depth_mm.powf(1.5) * (1.0 + 0.01 * alpha * depth_mm)
}

/// A table of 4 mm with one material, `foam`: 0.1 MPa, exponent 6.
pub(crate) fn press_table() -> TableSpec {
    let axis = |name: &str, unit: &str, role, values: &[f64]| AxisSpec::new(name, unit, role, Scale::Listed, values);
    let depths: Vec<f64> = (1..=DEPTHS).map(|i| STEP_MM * f64::from(i)).collect();
    let alphas: Vec<f64> = (1..=12).map(f64::from).collect();
    let foam = foam();
    TableSpec {
        columns: alphas.iter().map(|a| depths.iter().map(|d| force_n(*a, *d)).collect()).collect(),
        axes: vec![
            axis(axis_name::DEPTH, "mm", Role::Row, &depths),
            axis(axis_name::ALPHA, "", Role::Column, &alphas),
            axis(axis_name::MU, "MPa", Role::Factor, &[0.01, 0.1, 0.3]),
        ],
        library: vec![MaterialSpec {
            force_n: depths.iter().map(|d| foam.curve.force_n(*d)).collect(),
            name: foam.name,
            mu_mpa: foam.mu_mpa,
            alpha: foam.alpha,
            height_mm: foam.height_mm,
            acceptance: 0.036,
            rate_mm_s: 0.0,
            display: DisplaySpec::even(1.0, &[2.0, 3.0, 3.5]),
        }],
        discretisation: 0.001,
        interpolation: 0.001,
        provenance: "for tests of the host".into(),
    }
}

/// The material of [`press_table`], to be laid under the probe.
pub(crate) fn foam() -> Foam {
    stiffer_foam(1.0)
}

/// The foam of the table with its force times `factor`.
pub(crate) fn stiffer_foam(factor: f64) -> Foam {
    let (mu_mpa, alpha) = (0.1 * factor, 6.0);
    // The arm overshoots the depth of a press.
    let force: Vec<f64> = (1..=DEPTHS + 20).map(|i| mu_mpa * force_n(alpha, STEP_MM * f64::from(i))).collect();
    let curve = Curve::new(STEP_MM, &force).unwrap_or_else(|| unreachable!("forces are finite and positive"));
    Foam { name: "foam".into(), mu_mpa, alpha, height_mm: HEIGHT_MM, curve }
}
