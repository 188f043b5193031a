#![allow(clippy::unwrap_used)]
use std::path::Path;

use super::table::Displacement;
use super::*;
use crate::experiment::Recording;

/// A press to 30 % strain and back, of a law that is 100 kPa stiff down and 80 kPa up.
fn pressed(noise: f64) -> Run {
    let samples = 600;
    let depth = |i: usize| {
        let at = i as f64 / samples as f64;
        0.2 + if at < 0.5 { -0.5 + 8.0 * at } else { 3.5 - 8.0 * (at - 0.5) }
    };
    let force = |i: usize| {
        let strain = ((depth(i) - 0.2) / 10.0).max(0.0);
        let kpa = if 2 * i < samples { 100.0 } else { 80.0 };
        0.05 + 1e-3 * kpa * strain * 400.0 + noise * (0.7 * i as f64).sin()
    };
    let time: Vec<f64> = (0..=samples).map(|i| 0.02 * i as f64).collect();
    let recording =
        Recording::from_samples(time, (0..=samples).map(depth).collect(), (0..=samples).map(force).collect());
    Run { test: Test::Uniaxial, ..Run::indentation("press.csv".into(), 0, 0, recording) }
}

const CAP: Cap = Cap { area_mm2: 200.0, thickness_mm: None, most_n: 10.0, thesis_pulp: false };

#[test]
fn a_line_is_a_line_under_the_cap_on_both_ways() {
    let tables = of(&pressed(0.0), "foam", (10.0, 400.0), &CAP).unwrap();
    assert!((tables.modulus_kpa - 100.0).abs() < 1.0, "{}", tables.modulus_kpa);
    // half of the specimen's area: 2 N at a tenth of 10 mm; the contact is found within a hundredth of a millimetre or so
    for (force_n, shaft_mm) in tables.loading.rows {
        assert!((shaft_mm - 0.5 * force_n).abs() < 0.05, "{force_n} N: {shaft_mm} mm");
    }
    for (force_n, shaft_mm) in tables.unloading.unwrap().rows.into_iter().skip(1) {
        assert!((shaft_mm - 0.625 * force_n).abs() < 0.05, "{force_n} N: {shaft_mm} mm");
    }
}

#[test]
fn noise_makes_no_way_back_and_thickness_scales_the_shaft() {
    let cap = Cap { thickness_mm: Some(20.0), ..CAP };
    let tables = of(&pressed(0.05), "foam", (10.0, 400.0), &cap).unwrap();
    let rows = &tables.loading.rows;
    assert!(rows.windows(2).all(|w| w[1].0 > w[0].0 && w[1].1 > w[0].1));
    let (force_n, shaft_mm) = *rows.last().unwrap();
    assert!((shaft_mm - force_n).abs() < 0.2, "{force_n} N: {shaft_mm} mm");
}

#[test]
fn what_is_no_compression_is_refused() {
    let mut flat = pressed(0.0);
    flat.recording.force_n.iter_mut().for_each(|force| *force = 0.0);
    let text = of(&flat, "foam", (10.0, 400.0), &CAP).unwrap_err().to_string();
    assert!(text.starts_with("press.csv: no force rises above its noise; expected a compression"), "{text}");
    let text = of(&pressed(0.0), "foam", (100.0, 400.0), &CAP).unwrap_err().to_string();
    assert!(text.contains("the strain ends at 3"), "{text}");
}

#[test]
fn a_table_is_read_back_and_mistakes_are_told_with_their_place() {
    let table = of(&pressed(0.0), "foam", (10.0, 400.0), &CAP).unwrap().loading;
    let text = table.to_csv();
    let file = Path::new("foam.csv");
    assert_eq!(Displacement::parse(file, &text).unwrap(), table);
    let error = |from: &str, to: &str| Displacement::parse(file, &text.replacen(from, to, 1)).unwrap_err().to_string();
    assert!(error("cap_mm2 = 200", "cap_mm2 = wide").contains("line 3, key cap_mm2: \"wide\"; expected the area"));
    assert!(error("# material = foam\n", "").contains("`# material = ...` is missing"));
    assert!(error("force_N,", "F,").contains("line 6, column 1 (force_N): \"F\"; expected the columns"));
    assert!(error("0,0\n", "0.1,0\n").contains("line 7, column 1 (force_N): \"0.1\"; expected a first row without"));
    assert!(error("0,0\n", "0,x\n").contains("line 7, column 2 (shaft_mm): \"x\"; expected a number"));
}
