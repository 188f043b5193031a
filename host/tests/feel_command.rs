//! `palpate feel`: the goals of slow presses, on the frozen display and on one drawn from a seed.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::process::Command;

use serde_json::Value;

fn felt(display: &str, plant: &str) -> Vec<Value> {
    let out = tempfile::tempdir().unwrap();
    let run = Command::new(env!("CARGO_BIN_EXE_palpate"))
        .args(["feel", "--display", display, "--plant", plant, "--json", "--out"])
        .arg(out.path().join("felt"))
        .output()
        .unwrap();
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let told: Value = serde_json::from_slice(&run.stdout).unwrap();
    told["felt"].as_array().unwrap().clone()
}

/// A measure of the slow press.
fn slow(felt: &Value, display: &str, measure: &str) -> f64 {
    felt["presses"][0][display][measure].as_f64().unwrap()
}

/// Position 8 %, force 4 %, tracking 8 % (thesis 16, 8.7 and 16.6 %); ICF asks for less than its sensor tells, and
/// misses the force by a tenth.
#[test]
fn an_actuator_is_where_the_material_wants_it() {
    for plant in ["frozen", "drawn:20261129"] {
        for felt in felt("actuator", plant) {
            let [position, force, tracking] = ["position", "force", "tracking"].map(|m| slow(&felt, "actuator", m));
            let is_soft = felt["material"] == "ICF";
            assert!(position <= 0.08 && tracking <= 0.08, "{plant} {}: {position} {tracking}", felt["material"]);
            assert!(is_soft || force <= 0.04, "{plant} {}: {force}", felt["material"]);
        }
    }
}

/// 92 % (thesis 84 %); the curve of A2 gives force away for area.
#[test]
fn a_fluid_at_the_fingers_place_bears_what_the_material_does() {
    for plant in ["frozen", "drawn:20261129"] {
        for felt in felt("fluid-at-place", plant) {
            let agreement = slow(&felt, "fluid", "agreement");
            let least = if felt["material"] == "A2" { 0.9 } else { 0.92 };
            assert!(agreement >= least, "{plant} {}: {agreement}", felt["material"]);
        }
    }
}
