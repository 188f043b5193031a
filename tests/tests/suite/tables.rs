//! Tables of x and y: what is made by laws that the catalogue does not have, the two of the thesis, and
//! mistakes in files.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fmt::Write as _;
use std::path::Path;

use palpate::diagnose::Verdict;
use palpate::diagnose::table::{Diagnosis, answer, diagnose};
use palpate::experiment;
use palpate::extended::magnet::MagnetModel;
use rand::{Rng, SeedableRng};
use rand_distr::StandardNormal;
use rand_pcg::Pcg64;

/// Currents of a magnet, A: up and down three times.
fn loops() -> Vec<f64> {
    let up: Vec<f64> = (0..=10).map(|k| 0.25 * f64::from(k)).collect();
    let once: Vec<f64> = up.iter().chain(up.iter().rev().skip(1)).copied().collect();
    once.repeat(3)
}

/// Readings of a rig: x in order, the way it came, number of the reading.
fn read(seed: u64, sigma: f64, of: impl Fn(f64, f64, usize) -> f64) -> Diagnosis {
    let mut chance = Pcg64::seed_from_u64(seed);
    let mut csv = String::from("current_A,flux_T\n");
    let mut before = 0.0;
    for (k, x) in loops().into_iter().enumerate() {
        let way = if x == before { 0.0 } else { (x - before).signum() };
        before = x;
        let noise: f64 = chance.sample(StandardNormal);
        let _ = writeln!(csv, "{x},{:.6}", of(x, way, k) + sigma * noise);
    }
    of_csv(&csv, "x = \"current_A\"\ny = \"flux_T\"\n").unwrap().unwrap()
}

fn of_csv(csv: &str, columns: &str) -> Result<Option<Diagnosis>, String> {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.csv"), csv).unwrap();
    let toml = format!("[columns]\n{columns}\n[[run]]\nfile = \"a.csv\"\ntest = \"table\"\n");
    std::fs::write(folder.path().join("experiment.toml"), toml).unwrap();
    of_folder(folder.path())
}

fn of_folder(folder: &Path) -> Result<Option<Diagnosis>, String> {
    let experiment = experiment::read(folder).map_err(|cause| cause.to_string())?;
    diagnose(&experiment).map_err(|cause| cause.to_string())
}

fn codes(found: &Diagnosis) -> Vec<&'static str> {
    found.findings.iter().flat_map(|f| std::iter::once(f.effect.code).chain(f.ambiguous_with.iter().copied())).collect()
}

const SIGMA: f64 = 3e-4;

fn line(x: f64) -> f64 {
    0.02 + 0.03 * x
}

#[test]
fn a_line_with_noise_is_clean() {
    // a law that holds is doubted in a hundredth of the tables at most, and named in none of these
    let found: Vec<Diagnosis> = (0..40).map(|seed| read(seed, SIGMA, |x, _, _| line(x))).collect();
    let alarms = found.iter().filter(|f| f.verdict != Verdict::Clean).count();
    assert!(alarms <= 2, "{alarms} of 40");
    assert!(found.iter().all(|f| f.findings.is_empty()));
}

/// Laws of steel, sensors and rooms that are none of the catalogue's: in eight of ten tables the code is named or in
/// the set, and no other is named alone.
#[test]
fn what_is_hidden_is_named() {
    let langevin = |h: f64| if h.abs() < 1e-6 { h / 3.0 } else { 1.0 / h.tanh() - 1.0 / h };
    type Hidden<'a> = (&'static str, Box<dyn Fn(f64, f64, usize) -> f64 + 'a>);
    let hidden: [Hidden<'_>; 4] = [
        ("saturation", Box::new(move |x, _, _| 0.01 + 0.16 * langevin(1.1 * x))),
        // a loop that opens as the current leaves the point of return
        ("remanence", Box::new(|x, way, _| line(x) - 0.0012 * way * (1.0 - 0.15 * (x - 1.2).abs()))),
        ("drift", Box::new(|x, _, k| line(x) + 0.003 * (k as f64 / 62.0).powf(0.8))),
        ("sensor-nonlinearity", Box::new(|x, _, _| line(x) - 0.0045 * (std::f64::consts::PI * x / 2.5).sin())),
    ];
    for (code, of) in hidden {
        let found: Vec<Diagnosis> = (100..110).map(|seed| read(seed, SIGMA, &of)).collect();
        let right = found.iter().filter(|f| codes(f).contains(&code)).count();
        let wrong: Vec<_> = found.iter().map(codes).filter(|c| !c.is_empty() && !c.contains(&code)).collect();
        println!("{code}: {right} of 10 {wrong:?}");
        assert!(right >= 8 && wrong.is_empty(), "{code}: {right} of 10, wrong {wrong:?}");
    }
}

#[test]
fn what_no_catalogue_holds_has_no_name() {
    for seed in 200..206 {
        let found = read(seed, SIGMA, |x, _, _| line(x) + 0.0012 * (9.0 * x).sin());
        assert_eq!((found.verdict, codes(&found).len()), (Verdict::Unknown, 0));
    }
}

#[test]
fn the_answer_has_the_keys_of_the_contract() {
    let told = answer::json(&read(1, SIGMA, |x, way, _| line(x) - 0.0012 * way), None);
    for key in [
        "verdict",
        "effects",
        "ambiguous_with",
        "shows_in",
        "blind_to",
        "next_experiment",
        "held_out",
        "base",
        "extended",
        "report",
        "seconds",
        "lack_of_fit",
    ] {
        assert!(told.get(key).is_some(), "{key} is missing");
    }
    assert_eq!(told["effects"][0]["code"], "remanence", "{told}");
    let width = told["effects"][0]["parameters"]["half_width_share"]["value"].as_f64().unwrap();
    // of a span of 0.075 T
    assert!((width - 0.016).abs() < 0.003, "{width}");
    assert!(told["lack_of_fit"]["p"].as_f64().unwrap() < 1e-6);
}

#[test]
fn without_repeats_nothing_is_named_and_what_to_read_is_said() {
    let found = of_csv("x,y\n0,0\n1,1.1\n2,1.9\n3,3.3\n", "").unwrap().unwrap();
    assert_eq!(found.verdict, Verdict::TooFewData);
    let reason = found.too_few.as_ref().unwrap().to_string();
    assert!(reason.contains("no x is repeated"), "{reason}");
    assert!(found.proposals[0].what.contains("read all 4 x again"), "{}", found.proposals[0].what);
    let back = of_csv("x,y\n0,0\n1,1.1\n2,1.9\n3,3.3\n0,0.1\n", "").unwrap().unwrap();
    let reason = back.too_few.unwrap().to_string();
    assert!(reason.contains("what is read again comes from the other side"), "{reason}");
    let few = of_csv("x,y\n0,0\n1,1.1\n2,1.9\n3,3.3\n3,3.2\n", "").unwrap().unwrap();
    assert!(few.too_few.unwrap().to_string().contains("1 degrees of freedom, expected at least 3"));
}

#[test]
fn mistakes_are_told_with_their_place() {
    let told = |csv: &str, columns: &str| of_csv(csv, columns).unwrap_err();
    let missing = told("a,b\n0,0\n1,1\n", "x = \"a\"\n");
    assert!(missing.contains("a.csv: no column y; name it in [columns]") && missing.contains("b"), "{missing}");
    let cell = told("x,y\n0,0\n1,high\n", "");
    assert!(cell.contains("a.csv, line 3: column y holds no number"), "{cell}");
    let still = told("x,y\n1,0\n1,1\n", "");
    assert!(still.contains("x is 1 in all rows"), "{still}");
}

/// Times that are none are no times: the table is judged without them.
#[test]
fn a_time_that_is_no_number_is_left_out() {
    let mut csv = String::from("time_s,x,y\n");
    for k in 0..40 {
        let time = if k == 7 { "late".to_owned() } else { format!("{k}") };
        let _ = writeln!(csv, "{time},{},{}", k % 5, 2 * (k % 5) + (k * 7 % 3));
    }
    let found = of_csv(&csv, "").unwrap().unwrap();
    assert!(!found.table.has_time && found.evidence.is_some());
}

/// Tables 6 and 7 of the thesis: nothing repeats in either, so that nothing can be named. The difference of the
/// slopes of flux density is 50 G/A with p = 0.10 (an independent straight line).
#[test]
fn the_tables_of_the_thesis_are_too_few_data() {
    let Some(folder) = tests::shared_or_skipped("thesis/tables") else { return };
    let text = std::fs::read_to_string(folder.join("table6_B_vs_current.csv")).unwrap();
    let columns = "x = \"current_A\"\ny = \"measured_B_gauss\"\nsimulated = \"thesis_FEM_B_gauss\"\n";
    let found = of_csv(&text, columns).unwrap().unwrap();
    assert_eq!(found.verdict, Verdict::TooFewData);
    let line = found.line.as_ref().unwrap();
    assert!((line.coefficients[1].0 - 50.0).abs() < 1.0 && (line.probability(1, 0.0) - 0.10).abs() < 0.01);
    assert!(found.proposals[0].what.contains("with 3 passes"), "{}", found.proposals[0].what);
    let text = std::fs::read_to_string(folder.join("table7_fsr_conductance.csv")).unwrap();
    let found = of_csv(&text, "x = \"force_gram\"\ny = \"conductance_as_printed\"\n").unwrap().unwrap();
    assert_eq!((found.verdict, found.findings.len()), (Verdict::TooFewData, 0));
}

/// What was found about a ring that was built with another gap.
fn built_with(set: (&str, f64), seed: u64) -> Diagnosis {
    let folder = tempfile::tempdir().unwrap();
    built_at(folder.path(), set, seed);
    of_folder(folder.path()).unwrap().unwrap()
}

/// Readings of a ring that was built with another gap, three times up and down, with noise.
fn built_at(folder: &Path, set: (&str, f64), seed: u64) {
    let ring = palpate::magnet::BUILT_IN.iter().find(|m| m.name == "ring-probe").unwrap();
    let name = Path::new("ring.toml");
    let magnet = palpate::magnet::parse(name, ring.text, &[(set.0.to_owned(), set.1)].into()).unwrap();
    let up: Vec<f64> = (1..=6).map(|k| 0.6 * f64::from(k)).collect();
    let wanted = lut_gen::magnet::study::Wanted { coarser: 1.2, is_single: true, ..magnet.wanted() };
    let states = magnet.design.study(&wanted, &up, &mut |_| {}).unwrap().states;
    let once: Vec<usize> = (0..6).chain((0..5).rev()).collect();
    let mut chance = Pcg64::seed_from_u64(seed);
    let mut csv = String::from("current_A,flux_T\n");
    for k in once.repeat(3) {
        let noise: f64 = chance.sample(StandardNormal);
        let flux = magnet.built.flux * states[k].probes[0].size_t();
        let _ = writeln!(csv, "{},{:.6}", up[k], flux + SIGMA * noise);
    }
    let columns = "x = \"current_A\"\ny = \"flux_T\"\n";
    std::fs::write(folder.join("a.csv"), csv).unwrap();
    let toml = format!("[columns]\n{columns}\n[[run]]\nfile = \"a.csv\"\ntest = \"table\"\nmagnet = \"ring-probe\"\n");
    std::fs::write(folder.join("experiment.toml"), toml).unwrap();
}

/// Flux density of the ring with other gaps by another solver (`bench/versus-ngsolve/gap.py`): gap, current, T.
const OTHER_GAPS: &str = include_str!("../../../bench/versus-ngsolve/gap.csv");

/// Readings of a ring with this gap, three times up and down, with noise, beside a magnet of 10 mm of which only the gap is
/// in doubt.
fn read_at(folder: &Path, gap_mm: f64, seed: u64) {
    let rows: Vec<Vec<f64>> = tests::magnets::rows(OTHER_GAPS).into_iter().filter(|row| row[0] == gap_mm).collect();
    let mut chance = Pcg64::seed_from_u64(seed);
    let mut csv = String::from("current_A,flux_T\n");
    for row in rows.iter().chain(rows.iter().rev().skip(1)).cycle().take(3 * (2 * rows.len() - 1)) {
        let noise: f64 = chance.sample(StandardNormal);
        let _ = writeln!(csv, "{},{:.6}", row[1], row[2] + SIGMA * noise);
    }
    std::fs::write(folder.join("a.csv"), csv).unwrap();
    let columns = "x = \"current_A\"\ny = \"flux_T\"\n";
    let toml = format!("[columns]\n{columns}\n[[run]]\nfile = \"a.csv\"\ntest = \"table\"\nmagnet = \"own.toml\"\n");
    std::fs::write(folder.join("experiment.toml"), toml).unwrap();
    let ring = palpate::magnet::BUILT_IN.iter().find(|m| m.name == "ring-probe").unwrap();
    let own = ring.text[..ring.text.find("[[uncertain]]").unwrap()]
        .replace("control = \"probe\"", "control = \"centre\"")
        // The other solver's plane is infinitely deep and ends at 150 mm; its steel has straight lines between the table's
        // points.
        .replace("boundary = \"open\"", "boundary = { radius_mm = 150 }")
        .replace("[out_of_plane]", "#")
        .replace("mean_radius_mm", "#")
        .replace("width_mm", "#")
        .replace("gap_mm", "#")
        .replace("like = \"1018 steel\"", "like = \"1018 steel\"\nbetween = \"straight\"");
    let own = format!("{own}[[uncertain]]\npart = \"gap\"\nparameter = \"gap\"\nby = 0.5\n");
    std::fs::write(folder.join("own.toml"), own).unwrap();
}

/// The gap is named (or a gain of the sensor, which looks alike), the model holds it in mm, and other readings of the same
/// magnet are predicted to their scatter.
#[test]
fn a_named_gap_becomes_a_model_that_predicts_other_readings() {
    let (gap_mm, seed) = (10.8, 21);
    let (first, second) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    read_at(first.path(), gap_mm, seed);
    read_at(second.path(), gap_mm, seed + 1);
    let experiment = palpate::experiment::read(first.path()).unwrap();
    let found = of_folder(first.path()).unwrap().unwrap();
    assert!(codes(&found).contains(&"gap"), "{:?} {:?}", codes(&found), found.alone);
    let model = MagnetModel::of(&experiment, &found).expect("the gap has a name");
    let [gap] = model.changed.as_slice() else { panic!("{model:?}") };
    // The diagnosis works to first order; a difference of 0.8 mm bends the flux density by a tenth of that.
    assert!((gap.value - gap_mm).abs() < 0.1, "{gap:?}");
    let model = model.clone().fitted(&experiment).unwrap();
    let (low, high) = model.changed[0].interval;
    assert!((low..high).contains(&gap_mm) && high - low < 0.2, "{model:?}");
    let model = MagnetModel::parse(Path::new("model.toml"), &model.to_toml()).unwrap();
    let gain = model.gain(&palpate::experiment::read(second.path()).unwrap()).unwrap();
    println!("{gap_mm} mm: {gap:?} {gain:?}");
    assert!(gain.model_t < 1.4 * SIGMA && gain.fitted_base_t > 5.0 * gain.model_t, "{gain:?}");
    let clean = tempfile::tempdir().unwrap();
    read_at(clean.path(), 10.0, 25);
    let found = of_folder(clean.path()).unwrap().unwrap();
    assert!(found.findings.is_empty(), "the drawing itself is named {:?}", codes(&found));
}

/// A wider gap, less iron and a leak change the flux density nearly alike: what is named holds the truth, and the part that
/// leaves least when it stands alone is the truth.
#[test]
fn a_magnet_that_differs_from_its_drawing_is_not_named_wrong() {
    for (set, code) in [(("gap", 11.0), "gap"), (("steel", 0.9), "saturation")] {
        let found = built_with(set, 7);
        let named = codes(&found);
        println!("{set:?}: {} {named:?} {:?}", found.verdict.word(), found.alone);
        assert!(named.contains(&code) || found.findings.is_empty(), "{set:?} is named {named:?}");
        let alone = found.alone.as_ref().unwrap();
        assert_eq!(alone.parts[0].code, code, "{alone:?}");
        assert!(alone.parts[0].left < 1.2 * SIGMA && alone.without > 20.0 * SIGMA, "{alone:?}");
    }
    let found = built_with(("gap", 10.0), 8);
    assert!(found.findings.is_empty(), "the drawing itself is named {:?}", codes(&found));
}

/// Table 6 beside the drawn ring: the drawing gives several times the printed flux density, and five readings that nothing
/// repeats name nothing. Signs and sizes are told.
#[test]
fn table_6_beside_a_magnet_is_bounded_and_not_named() {
    let Some(folder) = tests::shared_or_skipped("thesis/tables") else { return };
    let text = std::fs::read_to_string(folder.join("table6_B_vs_current.csv")).unwrap();
    let copy = tempfile::tempdir().unwrap();
    std::fs::write(copy.path().join("a.csv"), text).unwrap();
    let toml = "[columns]\nx = \"current_A\"\ny = \"measured_B_gauss\"\n\n[[run]]\nfile = \"a.csv\"\ntest = \"table\"\n\
                magnet = \"ring-probe\"\nflux_unit = \"G\"\n";
    std::fs::write(copy.path().join("experiment.toml"), toml).unwrap();
    let found = of_folder(copy.path()).unwrap().unwrap();
    assert_eq!((found.verdict, found.findings.len()), (Verdict::TooFewData, 0));
    let alone = found.alone.as_ref().unwrap();
    // The drawing has 0.19 to 0.23 T where 0.06 to 0.08 T were read.
    assert!((1000.0..2000.0).contains(&alone.without), "{alone:?}");
    let of = |code: &str| alone.parts.iter().find(|part| part.code == code).unwrap().amount;
    assert!(of("gap") > 6.0 && of("leakage") < -6.0 && of("turns") < -6.0, "{alone:?}");
    assert!(answer::json(&found, None)["alone"]["parts"].as_array().unwrap().len() >= 6);
}

#[test]
fn magnets_that_cannot_stand_beside_a_table_are_told() {
    let csv = "current_A,flux_T\n0,0\n1,0.2\n2,0.3\n";
    let with = |more: &str| {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("a.csv"), csv).unwrap();
        let toml = format!("[columns]\nx = \"current_A\"\ny = \"flux_T\"\n\n[[run]]\nfile = \"a.csv\"\n{more}\n");
        std::fs::write(folder.path().join("experiment.toml"), toml).unwrap();
        of_folder(folder.path()).unwrap_err()
    };
    assert!(with("test = \"table\"\nmagnet = \"rong\"").contains("no magnet of this name; known are"));
    assert!(
        with("test = \"table\"\nmagnet = \"ring\"\nflux_unit = \"oersted\"").contains("one of \"T\", \"mT\", \"G\"")
    );
}
