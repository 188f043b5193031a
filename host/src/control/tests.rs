#![allow(clippy::unwrap_used)]
use std::path::Path;

use protocol::lut::{DisplaySpec, MaterialSpec};

use super::{ControlCurve, Curves, Row, actuator_only};

const SAMPLE: &str = "\
# A remark.
# material = ICF
# magnet = ring
# finger = index
# fluid = MRF-122
# bound_A = 0.05
# reachable_N = 0.1, 1.8
# provenance = made up, current = 2 force
force_N,travel_mm,area_mm2,shaft_mm,yield_kPa,flux_T,current_A,loop_gain
0,0,0,0,0,0,0,0
1,1.5,60,1.25,2,0.05,1.25,0.4
2,2.5,70,2.25,4,0.1,2.5,-0.5
";

fn parse(text: &str) -> Result<ControlCurve, String> {
    ControlCurve::parse(Path::new("icf.csv"), text).map_err(|error| error.to_string())
}

/// The error of the sample with one text in another's place.
fn error(from: &str, to: &str) -> String {
    assert!(SAMPLE.contains(from), "{from}");
    parse(&SAMPLE.replacen(from, to, 1)).unwrap_err()
}

#[test]
fn a_curve_is_read() {
    let curve = parse(SAMPLE).unwrap();
    assert_eq!((curve.material.as_str(), curve.magnet.as_str()), ("ICF", "ring"));
    assert_eq!((curve.finger.as_str(), curve.fluid.as_str()), ("index", "MRF-122"));
    assert_eq!((curve.bound_a, curve.reachable_n, curve.most_n()), (0.05, (0.1, 1.8), 2.0));
    assert_eq!(curve.provenance, "made up, current = 2 force");
    let row = Row {
        force_n: 1.0,
        travel_mm: 1.5,
        area_mm2: 60.0,
        shaft_mm: 1.25,
        yield_kpa: 2.0,
        flux_t: 0.05,
        current_a: 1.25,
        loop_gain: 0.4,
    };
    assert_eq!(curve.rows[1], row);
    assert_eq!(curve.rows.len(), 3);
    let windows = format!("\u{feff}{}", SAMPLE.replace('\n', "\r\n"));
    assert_eq!(parse(&windows).unwrap(), curve);
}

#[test]
fn what_is_written_is_read_back() {
    let curve = parse(SAMPLE).unwrap();
    assert_eq!(parse(&curve.to_csv().unwrap()).unwrap(), curve);
    let told = ControlCurve { felt_error: Some((0.0625, 0.125)), ..curve };
    assert_eq!(parse(&told.to_csv().unwrap()).unwrap(), told);
}

#[test]
fn a_curve_that_would_not_be_read_is_not_written() {
    let refusal = |change: fn(&mut ControlCurve)| {
        let mut curve = parse(SAMPLE).unwrap();
        change(&mut curve);
        curve.to_csv().unwrap_err().to_string()
    };
    assert_eq!(
        refusal(|c| c.provenance = "two\nlines".to_owned()),
        "control curve, line 7, key provenance: \"two\\nlines\"; expected how the curve was made, in one line without \
         spaces at its ends"
    );
    assert_eq!(
        refusal(|c| c.rows[2].current_a = f64::NAN),
        "control curve, line 11, column 7 (current_A): \"NaN\"; expected a current of 0 to 2.5 A"
    );
    assert_eq!(
        refusal(|c| c.material = String::new()),
        "control curve, line 1, key material: \"\"; expected the name of the material that is displayed"
    );
}

#[test]
fn errors_of_keys_name_line_value_and_expectation() {
    assert_eq!(
        error("# magnet = ring\n", ""),
        "icf.csv: the line `# magnet = ...` is missing; expected the name of the magnet that the current is for"
    );
    assert_eq!(
        error("bound_A = 0.05", "bound_A = -1"),
        "icf.csv, line 6, key bound_A: \"-1\"; expected the largest error of the current, 0 to 2.5 A"
    );
    let forces = "expected two forces, FROM, TO, N, with 0 <= FROM <= TO <= the last force of the curve";
    for wrong in ["0.1", "1.8, 0.1", "0.1, 2.5", "-1, 1", "nan, 1"] {
        assert_eq!(error("0.1, 1.8", wrong), format!("icf.csv, line 7, key reachable_N: \"{wrong}\"; {forces}"));
    }
    assert_eq!(
        error("# fluid", "# liquid"),
        "icf.csv, line 5, key liquid: \"MRF-122\"; expected one of the keys material, magnet, finger, fluid, bound_A, \
         reachable_N, provenance, felt_error"
    );
    let parts = "expected two parts, FORCE, AREA, 0 or more: root mean squares over those of the material";
    for wrong in ["0.1", "-0.1, 0.2", "0.1, nan"] {
        let text = error("# provenance", &format!("# felt_error = {wrong}\n# provenance"));
        assert_eq!(text, format!("icf.csv, line 8, key felt_error: \"{wrong}\"; {parts}"));
    }
    assert_eq!(
        error("# fluid = MRF-122", "# fluid = a\n# fluid = b"),
        "icf.csv, line 6, key fluid: \"b\"; expected each key once, and it stands in line 5 already"
    );
}

#[test]
fn errors_of_cells_name_line_column_value_and_expectation() {
    assert_eq!(
        error("1,1.5,60", "1,soft,60"),
        "icf.csv, line 11, column 2 (travel_mm): \"soft\"; expected a number, 0 or more"
    );
    assert_eq!(
        error("1,1.5,60", "1,-1.5,60"),
        "icf.csv, line 11, column 2 (travel_mm): \"-1.5\"; expected a number, 0 or more"
    );
    assert_eq!(
        error("0.1,2.5,-0.5", "0.1,2.6,-0.5"),
        "icf.csv, line 12, column 7 (current_A): \"2.6\"; expected a current of 0 to 2.5 A"
    );
    assert_eq!(error(",-0.5", ",inf"), "icf.csv, line 12, column 8 (loop_gain): \"inf\"; expected a number");
    assert_eq!(error(",-0.5", ""), "icf.csv, line 12, column 8 (loop_gain): \"\"; expected a number");
    assert_eq!(
        error(",-0.5", ",-0.5,7"),
        "icf.csv, line 12, column 8 (loop_gain): \"7\"; expected no cell after this column"
    );
    assert_eq!(
        error("2,2.5,70", "1,2.5,70"),
        "icf.csv, line 12, column 1 (force_N): \"1\"; expected a force above the 1 N of the row before"
    );
    assert_eq!(
        error("0,0,0,0,0,0,0,0", "0.5,0,0,0,0,0,0,0"),
        "icf.csv, line 10, column 1 (force_N): \"0.5\"; expected a first row without force, 0"
    );
    assert_eq!(
        error("area_mm2", "area_mm"),
        "icf.csv, line 9, column 3 (area_mm2): \"area_mm\"; expected the columns \
         force_N,travel_mm,area_mm2,shaft_mm,yield_kPa,flux_T,current_A,loop_gain"
    );
}

#[test]
fn a_curve_has_two_rows_at_least_and_as_many_as_a_table_has_nodes_at_most() {
    let (head, _) = SAMPLE.split_once("1,1.5").unwrap();
    assert_eq!(
        parse(head).unwrap_err(),
        "icf.csv: 1 rows; expected 2 to 256, below a line \
         force_N,travel_mm,area_mm2,shaft_mm,yield_kPa,flux_T,current_A,loop_gain"
    );
    let many = |rows: usize| (1..rows).map(|i| format!("{i},0,0,0,0,0,0,0\n")).collect::<String>();
    assert!(parse(&format!("{head}{}", many(257))).unwrap_err().starts_with("icf.csv: 257 rows"));
    assert_eq!(parse(&format!("{head}{}", many(256))).unwrap().rows.len(), 256);
}

#[test]
fn a_file_that_is_not_there_is_named() {
    let text = ControlCurve::read(Path::new("no/such.csv")).unwrap_err().to_string();
    assert!(text.starts_with("no/such.csv: cannot be read: "), "{text}");
}

/// Every file that comes with the program is read, and found by its material's name in either case.
#[test]
fn curves_that_come_with_the_program_are_found_by_name() {
    assert_eq!(ControlCurve::all_built_in().count(), super::curve::built_in_files());
    for curve in ControlCurve::all_built_in() {
        assert_eq!(ControlCurve::built_in(&curve.material.to_lowercase()), Some(curve));
    }
    assert_eq!(ControlCurve::built_in("granite"), None);
}

fn material(name: &str) -> MaterialSpec {
    MaterialSpec {
        name: name.to_owned(),
        mu_mpa: 0.1,
        alpha: 5.0,
        height_mm: 20.0,
        acceptance: 0.03,
        rate_mm_s: 0.0,
        force_n: vec![1.0, 2.0],
        display: DisplaySpec::even(1.0, &[1.0, 2.0]),
    }
}

/// Files of the sample with some texts in others' places.
fn files(folder: &Path, changes: &[&[(&str, &str)]]) -> Vec<std::path::PathBuf> {
    let write = |(number, changes): (usize, &&[(&str, &str)])| {
        let text = changes.iter().fold(SAMPLE.to_owned(), |text, (from, to)| text.replace(from, to));
        let file = folder.join(format!("{number}.csv"));
        std::fs::write(&file, text).unwrap();
        file
    };
    changes.iter().enumerate().map(write).collect()
}

#[test]
fn materials_have_the_curves_of_their_names_and_the_others_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let curves = Curves::read(&files(folder.path(), &[&[], &[("= ICF", "= gel")]])).unwrap();
    let mut library = ["ICF", "granite", "gel", "wood", "gel", "granite"].map(material);
    curves.give(&mut library).unwrap();
    assert_eq!(actuator_only(&library), ["granite", "wood"]);
    assert_eq!(library[1].display, DisplaySpec::even(1.0, &[1.0, 2.0]), "as it was");
    let display = &library[4].display;
    assert_eq!((&display.force_n, &display.shaft_mm), (&vec![0.0, 1.0, 2.0], &vec![0.0, 1.25, 2.25]));
    let coil = display.coil.as_ref().unwrap();
    assert_eq!((&coil.current_a, coil.reachable_n, coil.bound_a), (&vec![0.0, 1.25, 2.5], (0.1, 1.8), 0.05));
}

#[test]
fn curves_that_do_not_fit_together_or_into_the_library_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let refusal = |changes: &[&[(&str, &str)]]| {
        let files = files(folder.path(), changes);
        let text = Curves::read(&files).unwrap_err().to_string();
        text.replace(&folder.path().display().to_string(), "")
    };
    assert_eq!(
        refusal(&[&[], &[]]),
        "/1.csv: material \"ICF\" has a curve already, /0.csv; expected one file a material"
    );
    assert_eq!(
        refusal(&[&[], &[("= ICF", "= gel"), ("= ring", "= pot")]]),
        "/1.csv: for magnet pot with fluid MRF-122; expected magnet ring with fluid MRF-122, as /0.csv: a display has \
         one magnet and one fluid"
    );
    let curves = Curves::read(&files(folder.path(), &[&[]])).unwrap();
    let text = curves.give(&mut [material("EVA"), material("gel")]).unwrap_err().to_string();
    assert!(text.ends_with("0.csv: material \"ICF\" is not in the library; expected one of EVA, gel"), "{text}");
}
