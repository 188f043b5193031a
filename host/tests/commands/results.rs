//! Results that are kept: the folder of a call, tables of many, laws, and a material's way onto the board.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use palpate::results::provenance::sha256;
use serde_json::Value;

/// Height (mm) and radius (mm) of the compressed pieces.
const HEIGHT_MM: f64 = 20.0;
const RADIUS_MM: f64 = 25.0;

/// A foam of known constants, compressed twice: `P = 2 mu / a (l^a - 1) / l` for `nu = 0`, with a little noise.
fn coupon(folder: &Path, mu_mpa: f64, alpha: f64) {
    fs::create_dir_all(folder).unwrap();
    let mut description = format!(
        "name = \"Foam, compressed\"\n[specimen.eva]\nheight_mm = {HEIGHT_MM}\nradius_mm = {RADIUS_MM}\n[sensor]\nnoise_N = 0.05\n"
    );
    for (at, file) in ["a.csv", "b.csv"].iter().enumerate() {
        description += &format!("[[run]]\nfile = \"{file}\"\nspecimen = \"eva\"\ntest = \"uniaxial\"\n");
        let mut csv = "time_s,depth_mm,force_N\n".to_owned();
        for i in 0..160 {
            let depth = 0.05 * f64::from(i) - 0.5;
            let l = 1.0 - depth.max(0.0) / HEIGHT_MM;
            let stress = 2.0 * mu_mpa / alpha * (1.0 - l.powf(alpha)) / l;
            let noise = 0.05 * (f64::from((i * 37 + 11 * at as i32) % 23) - 11.0) / 6.6;
            let force = stress * std::f64::consts::PI * RADIUS_MM * RADIUS_MM + noise;
            csv += &format!("{:.2},{depth:.3},{force:.4}\n", 0.05 * f64::from(i));
        }
        fs::write(folder.join(file), csv).unwrap();
    }
    fs::write(folder.join("experiment.toml"), description).unwrap();
}

fn palpate(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_palpate")).current_dir(folder).args(arguments).output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// Standard error in one line: the terminal's width may break a message anywhere.
fn said(output: &Output) -> String {
    text(&output.stderr).split_whitespace().filter(|w| *w != "│").collect::<Vec<_>>().join(" ")
}

fn json(file: &Path) -> Value {
    serde_json::from_str(&fs::read_to_string(file).unwrap()).unwrap()
}

fn folders(below: &Path) -> Vec<PathBuf> {
    let all = fs::read_dir(below).unwrap().map(|entry| entry.unwrap().path());
    let mut all: Vec<PathBuf> = all.filter(|path| path.is_dir()).collect();
    all.sort();
    all
}

#[test]
fn a_call_has_a_folder_with_all_that_it_found() {
    let home = tempfile::tempdir().unwrap();
    coupon(&home.path().join("foam"), 0.1, 8.0);
    let output = palpate(home.path(), &["identify", "foam"]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let below = home.path().join("out/identify");
    let kept = folders(&below).pop().unwrap();
    assert!(kept.file_name().unwrap().to_str().unwrap().starts_with("foam-compressed-20"), "{kept:?}");
    assert!(text(&output.stdout).contains(kept.file_name().unwrap().to_str().unwrap()));

    let result = json(&kept.join("result.json"));
    assert_eq!(result["outcome"], "fitted");
    let mu = result["parameters"]["mu_MPa"]["value"].as_f64().unwrap();
    assert!((mu / 0.1 - 1.0).abs() < 0.02, "{mu}");
    let curves = result["curves"].as_array().unwrap();
    assert_eq!(curves.len(), 2);
    let length = |key: &str| curves[0][key].as_array().unwrap().len();
    assert!(length("measured_N") > 50 && length("measured_N") == length("fitted_N"));
    assert_eq!(length("depth_mm"), length("time_s"));

    let provenance = json(&kept.join("provenance.json"));
    assert_eq!(provenance, result["provenance"]);
    assert_eq!(provenance["version"], env!("CARGO_PKG_VERSION"));
    assert_eq!(provenance["command"][1], "identify");
    let inputs = provenance["inputs"].as_array().unwrap();
    assert_eq!(inputs.len(), 3, "{inputs:?}");
    for input in inputs {
        let file = home.path().join(input["path"].as_str().unwrap());
        assert_eq!(input["sha256"].as_str().unwrap(), sha256(&file).unwrap());
    }

    let csv = fs::read_to_string(kept.join("parameters.csv")).unwrap();
    assert!(csv.starts_with("experiment,material,parameter,unit,value,low95,high95,standing,at_bound\n"), "{csv}");
    assert!(csv.contains("\"Foam, compressed\",specimen,mu_MPa,MPa,0.") && csv.contains(",identified,false"), "{csv}");
    let page = fs::read_to_string(kept.join("report.html")).unwrap();
    assert!(page.contains("The specimen is a hyperfoam material: mu = ") && page.contains("Where this comes from"));
    assert!(page.find("The specimen is a").unwrap() < page.find("<h2>Fit</h2>").unwrap(), "the answer comes first");
    assert!(fs::read_dir(kept.join("figures")).unwrap().count() >= 3);
    assert!(fs::read_to_string(kept.join("material.inp")).unwrap().contains("*HYPERFOAM, N=2"));
    assert!(fs::read_to_string(kept.join("material.feb")).unwrap().contains("Ogden unconstrained"));

    palpate(home.path(), &["identify", "foam"]);
    assert_eq!(folders(&below).len(), 2, "a call replaces no other");
    assert!(below.join("report.html").exists());
}

#[test]
fn a_folder_that_cannot_be_written_loses_nothing_that_was_found() {
    let home = tempfile::tempdir().unwrap();
    coupon(&home.path().join("foam"), 0.1, 8.0);
    fs::write(home.path().join("file"), "").unwrap();
    for command in ["identify", "diagnose"] {
        let output = palpate(home.path(), &[command, "foam", "--report", "file/results"]);
        assert_eq!(output.status.code(), Some(2), "{output:?}");
        assert!(said(&output).contains("file/results") && said(&output).contains("--report DIR"), "{output:?}");
        let told = text(&output.stdout);
        assert!(told.contains(if command == "identify" { "mu_MPa" } else { "verdict" }), "{told}");
        let output = palpate(home.path(), &[command, "foam", "--json", "--report", "file/results"]);
        assert_eq!(output.status.code(), Some(2), "{output:?}");
        let answer: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert!(answer["report"].is_null() && answer["seconds"].is_number(), "{answer}");
    }
    let report = home.path().join("mine");
    fs::create_dir_all(&report).unwrap();
    fs::write(report.join("report.html"), "my own page").unwrap();
    let output = palpate(home.path(), &["identify", "foam", "--report", "mine"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(said(&output).contains("was not written by palpate"), "{output:?}");
    assert_eq!(fs::read_to_string(report.join("report.html")).unwrap(), "my own page");
}

#[test]
fn one_of_many_may_fail() {
    let home = tempfile::tempdir().unwrap();
    coupon(&home.path().join("one"), 0.1, 8.0);
    coupon(&home.path().join("two"), 0.05, 12.0);
    fs::create_dir_all(home.path().join("bad")).unwrap();
    fs::write(home.path().join("bad/experiment.toml"), "[specimen.a]\nheight_mm = \"tall\"\n").unwrap();
    let output = palpate(home.path(), &["identify", "one", "bad", "two", "--report", "table"]);
    assert_eq!(output.status.code(), Some(2), "{output:?}");
    let told = text(&output.stdout);
    let lines: Vec<&str> = told.lines().collect();
    assert!(lines[0].starts_with("experiment") && lines[0].contains("mu_MPa"), "{told}");
    assert!(lines[1].contains("fitted") && lines[2].contains("failed") && lines[3].contains("fitted"), "{told}");
    assert!(said(&output).contains("bad: failed"), "{output:?}");
    let table = fs::read_to_string(home.path().join("table/table.csv")).unwrap();
    assert_eq!(table.lines().count(), 4, "{table}");
    assert_eq!(folders(&home.path().join("table")).len(), 2, "a folder for each that was fitted");
    let output = palpate(home.path(), &["identify", "one", "bad", "--json"]);
    let answer: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(answer["experiments"][0]["outcome"], "fitted");
    assert!(answer["experiments"][1]["error"].as_str().unwrap().contains("height_mm"), "{answer}");
    assert!(!home.path().join("out").exists(), "scripts say where they want files");
}

#[test]
fn a_material_goes_from_recordings_onto_the_board() {
    let home = tempfile::tempdir().unwrap();
    coupon(&home.path().join("foam"), 0.35, 8.0);
    let save =
        |more: &[&str]| palpate(home.path(), &[&["identify", "foam", "--json", "--save", "eva.toml"], more].concat());
    assert_eq!(save(&[]).status.code(), Some(0));
    let refused = save(&[]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(said(&refused).contains("eva.toml exists and is kept") && !refused.stdout.is_empty(), "{refused:?}");
    assert_eq!(save(&["--force"]).status.code(), Some(0));
    let output = palpate(home.path(), &["lut", "--material", "eva.toml", "--json"]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let table: Value = serde_json::from_slice(&output.stdout).unwrap();
    let materials = table["materials"].as_array().unwrap();
    assert_eq!(materials.len(), 1, "the thesis' foams are not there");
    assert_eq!(materials[0]["name"], "eva");
    // stored as f32
    assert!((materials[0]["mu_MPa"].as_f64().unwrap() / 0.35 - 1.0).abs() < 0.03, "{materials:?}");
    assert_eq!(materials[0]["height_mm"], HEIGHT_MM);
    assert_eq!(materials[0]["display"]["actuator_only"], true);
    assert!(said(&output).contains("without control curve, displayed by the actuator alone: eva"), "{output:?}");
    // A control curve of its name, which --explain tells again from the table.
    let keys = ["material = eva", "magnet = m", "finger = f", "fluid = l", "bound_A = 0.0625", "reachable_N = 0.5, 2"];
    let head: String = keys.iter().map(|key| format!("# {key}\n")).collect();
    let columns = palpate::control::COLUMNS.join(",");
    let curve = format!("{head}# provenance = by hand\n{columns}\n0,0,0,0,0,0,0,0\n4,5,40,3,8,0.1,2,0.5\n");
    fs::write(home.path().join("eva.csv"), &curve).unwrap();
    let output = palpate(home.path(), &["lut", "--material", "eva.toml", "--control", "eva.csv", "--out", "own.bin"]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    assert!(!said(&output).contains("without control curve"), "{output:?}");
    let explained = palpate(home.path(), &["lut", "--explain", "own.bin", "--json"]);
    let table: Value = serde_json::from_slice(&explained.stdout).unwrap();
    let display = &table["materials"][0]["display"];
    assert_eq!(display["reachable_N"], serde_json::json!([0.5, 2.0]));
    assert!((display["force_max_N"].as_f64().unwrap() - 4.0).abs() < 1e-5, "{display}");
    // Rounding to counts is half of 2 A in 65,535.
    let bound_a = display["current_bound_A"].as_f64().unwrap();
    assert!((0.0625..0.0625 + 1.6e-5).contains(&bound_a), "{bound_a}");
    fs::write(home.path().join("gel.csv"), curve.replace("= eva", "= gel")).unwrap();
    let stranger = palpate(home.path(), &["lut", "--material", "eva.toml", "--control", "gel.csv", "--out", "no.bin"]);
    assert_eq!(stranger.status.code(), Some(2), "{stranger:?}");
    assert!(said(&stranger).contains("material \"gel\" is not in the library; expected one of eva"), "{stranger:?}");
    assert!(!home.path().join("no.bin").exists());
    let twice = palpate(home.path(), &["lut", "--material", "eva.toml", "eva.toml"]);
    assert!(said(&twice).contains("two materials are named \"eva\""), "{twice:?}");
}
