//! Files as laboratories have them: each case reads as the control does, after the key that its message names.

use palpate::experiment::Recording;

use super::case::{agree, changed, input, message, read};

/// Five decimals in the files of the cases.
const ROUNDING: f64 = 0.6e-5;

/// The two recordings of the control, of which all cases are made.
fn control() -> Option<[Recording; 2]> {
    let mut runs = read(&input("00-control")?).runs.into_iter().map(|run| run.recording);
    Some([runs.next()?, runs.next()?])
}

/// A case with changes of its description reads as the control.
fn as_control(name: &str, changes: &[(&str, &str)]) {
    let (Some(control), Some(folder)) = (control(), changed(name, changes)) else { return };
    let found = read(folder.path());
    for (run, expected) in found.runs.iter().zip(&control) {
        agree(&run.recording, expected, ROUNDING);
    }
}

fn refused(name: &str, changes: &[(&str, &str)], expected: &str) {
    let Some(folder) = changed(name, changes) else { return };
    assert_eq!(message(folder.path()), expected);
}

#[test]
fn units_row_below_header() {
    let case = "08a-units-row-below-header";
    refused(
        case,
        &[],
        "r8.csv, line 5, column 1 (Time): \"(s)\" is not a number; line 5 is a row of units: write units_row = true in [format]",
    );
    as_control(case, &[("skip_lines = 3", "skip_lines = 3\nunits_row = true")]);
    // The same with the names of the columns not yet found, and with the units taken for them.
    let Some(folder) = changed(case, &[("skip_lines = 3", "skip_lines = 0")]) else { return };
    assert!(
        message(folder.path()).ends_with("line 4 has it: write skip_lines = 3 in [format]"),
        "{}",
        message(folder.path())
    );
    let Some(folder) =
        changed(case, &[("skip_lines = 3", "skip_lines = 4"), ("\"Compressive extension\"", "\"(mm)\"")])
    else {
        return;
    };
    assert!(message(folder.path()).contains("no column `Time`"), "{}", message(folder.path()));
}

#[test]
fn specimens_side_by_side() {
    let case = "09a-specimens-side-by-side";
    refused(
        case,
        &[],
        "r8.csv, line 1: the column `Time` appears twice in the header; choose with { name = \"Time\", nth = 2 } or by number \
         ({ number = 3 }) in [columns]",
    );
    let by_number = |numbers: [u32; 3]| {
        [
            ("[columns]", "[format]\ncolumns = \"by-number\"\n[columns]".to_owned()),
            ("\"Time\"", numbers[0].to_string()),
            ("\"Disp\"", numbers[1].to_string()),
            ("\"Load\"", numbers[2].to_string()),
        ]
    };
    let borrowed = |changes: &[(&'static str, String)]| {
        let changes: Vec<(&str, &str)> = changes.iter().map(|(from, to)| (*from, to.as_str())).collect();
        changed(case, &changes)
    };
    let (Some(control), Some(first), Some(second)) =
        (control(), borrowed(&by_number([1, 2, 3])), borrowed(&by_number([4, 5, 6])))
    else {
        return;
    };
    let (first, second) = (read(first.path()), read(second.path()));
    agree(&first.runs[0].recording, &control[0], ROUNDING);
    agree(&first.runs[1].recording, &control[1], ROUNDING);
    // The second ends before the first, with hundredth parts more force.
    let shorter = &second.runs[0].recording;
    assert!(shorter.len() < control[0].len() && shorter.len() > 50);
    assert!((shorter.force_n[100] / control[0].force_n[100] - 1.01).abs() < 1e-4);
    let nth = |name: &str| format!("{{ name = \"{name}\", nth = 2 }}");
    let changes = [("\"Time\"", nth("Time")), ("\"Disp\"", nth("Disp")), ("\"Load\"", nth("Load"))];
    let by_name = borrowed(&changes).unwrap();
    agree(&read(by_name.path()).runs[0].recording, shorter, 0.0);
}

#[test]
fn segments_with_headers() {
    let case = "10a-segments-with-headers";
    as_control(case, &[]);
    as_control(case, &[("to_s = 7.0", "format.segment = 1")]);
    let Some(folder) = changed(case, &[("to_s = 7.0", "")]) else { return };
    let said = message(folder.path());
    assert!(said.starts_with("r8.csv, line 120: the row has 2 cells where the header has 3"), "{said}");
    assert!(said.contains("the header stands again in line 121") && said.contains("segment = 1"), "{said}");
    let back = changed(case, &[("to_s = 7.0", "format.segment = \"Segment 2\"")]).unwrap();
    let back = read(back.path()).runs.remove(0).recording;
    assert_eq!((back.time_s[0], back.depth_mm[0], back.line[0]), (0.0, 4.0, 122));
    let none = changed(case, &[("to_s = 7.0", "format.segment = \"hold\"")]).unwrap();
    assert_eq!(
        message(none.path()),
        "r8.csv: no segment \"hold\", or more than one; the file has: 1, 2 \"Data Acquisition,segment 2\""
    );
}

#[test]
fn summary_line_at_the_end() {
    let case = "10b-summary-line-at-the-end";
    as_control(case, &[]);
    as_control(case, &[("to_s = 7.0", "format.footer_lines = 1")]);
    refused(
        case,
        &[("to_s = 7.0", "")],
        "r8.csv, line 119, column 1 (time_s): \"Maximum\" is not a number; no line from here on holds data: write \
         footer_lines = 1 in [format], or end the run with to_s",
    );
}

#[test]
fn sensor_not_ready_at_start() {
    let case = "10c-sensor-not-ready-at-start";
    let (Some(control), Some(folder)) = (control(), changed(case, &[])) else { return };
    let found = read(folder.path()).runs.remove(0).recording;
    let left_out = control[0].len() - found.len();
    assert_eq!(found.force_n, control[0].force_n[left_out..]);
    assert!(found.time_s[0] >= 0.5 && control[0].time_s[left_out - 1] < 0.5);
    refused(
        case,
        &[("from_s = 0.5", "")],
        "r8.csv, line 2, column 3 (force_N): \"NaN\" is NaN; expected a finite number; the first number stands in line 4: \
         write from_s = 0.12 in [[run]]",
    );
}

#[test]
fn no_time_column() {
    let case = "11a-no-time-column";
    as_control(
        case,
        &[
            ("indenter = \"r8\"\n", "indenter = \"r8\"\nrate_mm_per_s = 1.0\n"),
            ("indenter = \"r5\"", "indenter = \"r5\"\ninterval_s = 0.06"),
        ],
    );
    refused(
        case,
        &[],
        "r8.csv, line 1: no column `time_s` (every run needs time); the header has: depth_mm, force_N. Map it in [columns] of \
         experiment.toml; if the file has no time, state interval_s (from row to row) or rate_mm_per_s (the indenter's speed) \
         in [[run]]",
    );
}

#[test]
fn utf16_without_mark() {
    let case = "12a-utf16-without-mark";
    refused(case, &[], "r8.csv: looks like UTF-16: write encoding = \"utf-16le\" in [format]");
    as_control(case, &[("decimal = \",\"", "decimal = \",\"\nencoding = \"utf-16le\"")]);
}

#[test]
fn excel_file() {
    let Some(folder) = changed("12b-excel-file", &[]) else { return };
    let said = message(folder.path());
    assert!(
        said.starts_with("r8.csv: an Excel or OpenDocument workbook (begins with PK) that cannot be read: "),
        "{said}"
    );
    assert!(said.ends_with("open it, save it again without a password, or export its sheet as CSV"), "{said}");
}

/// The case as a whole: after the stated speed the parameters of the generator come out.
#[test]
fn a_file_without_time_is_fitted() {
    let case = "11a-no-time-column";
    let Some(folder) = changed(case, &[("specimen = \"foam\"", "specimen = \"foam\"\nrate_mm_per_s = 1.0")]) else {
        return;
    };
    let spec = palpate::identify::spec::FitSpec::default();
    let found = palpate::identify::identify(&read(folder.path()), &spec, &|_, _, _| {}).unwrap();
    let fit = found[0].fit.as_ref().unwrap();
    let value = |name: &str| fit.parameters.iter().find(|p| p.name == name).unwrap().value;
    // The noise of 3 mN leaves a few hundredths.
    assert!((value("mu_MPa") / 0.050 - 1.0).abs() < 0.05 && (value("alpha") / 8.0 - 1.0).abs() < 0.05);
}
