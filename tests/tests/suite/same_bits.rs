//! The identification gives the same bits on every machine: hashes of all intermediate results over a fixed series. `tests/emulator` runs
//! the code that is compiled for the board over the same series and compares with the same file.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use firmware::fingerprint::fingerprint;
use protocol::lut::{AxisSpec, Role, Scale, Table, TableSpec, axis_name};
use tests::golden;

/// Twelve exponents, 50 depths, 30 moduli: a made-up foam with the curvature of a real one.
fn table() -> Vec<u8> {
    let axis = |name: &str, unit: &str, role, values: Vec<f64>| AxisSpec::new(name, unit, role, Scale::Listed, values);
    let depths: Vec<f64> = (1..=50).map(|i| 0.08 * f64::from(i)).collect();
    let alphas: Vec<f64> = (0..12).map(|i| 1.0 + 2.0 * f64::from(i) + 0.05 * f64::from(i * i)).collect();
    // Only +, *, / and sqrt: the table's own bytes are the same on every machine, too.
    let force =
        |alpha: f64, d: f64| 5.3 * d * d.sqrt() / (0.5 + 0.45 / (1.0 + 1.3 * d) + 0.09 * alpha * d / (d + 0.45));
    TableSpec {
        columns: alphas.iter().map(|a| depths.iter().map(|d| force(*a, *d)).collect()).collect(),
        axes: vec![
            axis(axis_name::DEPTH, "mm", Role::Row, depths),
            axis(axis_name::ALPHA, "", Role::Column, alphas),
            axis(axis_name::MU, "MPa", Role::Factor, (1..=30).map(|i| 0.01 * f64::from(i)).collect()),
        ],
        library: vec![],
        discretisation: 0.001,
        interpolation: 0.001,
        provenance: "made up for fingerprints".into(),
    }
    .to_bytes()
    .unwrap()
}

#[test]
fn every_intermediate_result_keeps_its_bits() {
    let bytes = table();
    let path = golden::path("fingerprint.lut");
    if std::env::var_os("PALPATE_BLESS").is_some() {
        std::fs::write(&path, &bytes).unwrap();
    }
    assert!(std::fs::read(&path).unwrap() == bytes, "fingerprint.lut is not the table of this test");
    let found = fingerprint(&Table::parse(&bytes).unwrap()).unwrap();
    let text = format!(
        "search {:016x}\nprofile {:016x}\nfilter {:016x}\noffset filter {:016x}\n",
        found.search, found.profile, found.filter, found.offset_filter
    );
    golden::compare("fingerprint-v1.txt", &text).unwrap();
}
