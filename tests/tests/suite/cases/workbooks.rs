//! Workbooks: sheets by name and number, times, text above and below.

use rust_xlsxwriter::{Format, Workbook};

use super::case::{folder, message, recording};

/// A workbook with these sheets of rows; cells that are numbers are numbers.
fn book(sheets: &[(&str, &[&[&str]])]) -> Vec<u8> {
    let mut book = Workbook::new();
    for (name, rows) in sheets {
        let sheet = book.add_worksheet().set_name(*name).unwrap();
        for (row, cells) in rows.iter().enumerate() {
            for (column, cell) in cells.iter().enumerate() {
                let (row, column) = (row as u32, column as u16);
                match cell.parse::<f64>() {
                    Ok(number) => sheet.write_number(row, column, number).unwrap(),
                    Err(_) => sheet.write_string(row, column, *cell).unwrap(),
                };
            }
        }
    }
    book.save_to_buffer().unwrap()
}

const RUN: &[&[&str]] = &[
    &["Laboratory 3"],
    &[],
    &["time_s", "depth_mm", "force_N", "note"],
    &["0", "0", "0.5"],
    &["0.1", "0.25", "0.75", "contact"],
    &["0.2", "0.5", "1.5"],
];

#[test]
fn a_sheet_is_read_by_name_and_number() {
    let two = book(&[("Results", &[&["mean", "1.2"]]), ("Test 3", RUN), ("empty", &[])]);
    let read = |keys: &str| recording(&folder("a.xlsx", &two, keys, ""));
    for sheet in ["\"Test 3\"", "2"] {
        let found = read(&format!("[format]\nskip_lines = 2\nsheet = {sheet}\n"));
        assert_eq!((found.force_n, found.line), (vec![0.5, 0.75, 1.5], vec![4, 5, 6]));
    }
    let said = |keys: &str| message(folder("a.xlsx", &two, keys, "").path());
    assert_eq!(
        said(""),
        "a.xlsx: a workbook with several sheets: \"Results\", \"Test 3\"; write sheet = \"Results\" in [format], of all or of the run"
    );
    assert_eq!(
        said("[format]\nsheet = \"Test 4\"\n"),
        "a.xlsx: no sheet \"Test 4\", or more than one; the file has: Results, Test 3, empty"
    );
    assert!(said("[format]\nsheet = 2\n").ends_with("line 3 has it: write skip_lines = 2 in [format]"));
}

#[test]
fn one_sheet_needs_no_name_and_commas_in_numbers_do_not_matter() {
    let one = book(&[("Tabelle1", RUN)]);
    for keys in ["skip_lines = 2", "skip_lines = 2\ndelimiter = \";\"\ndecimal = \",\""] {
        let found = recording(&folder("a.xlsx", &one, &format!("[format]\n{keys}\n"), ""));
        assert_eq!(found.depth_mm, [0.0, 0.25, 0.5]);
    }
    let bad = book(&[("Tabelle1", &[&["time_s", "depth_mm", "force_N"], &["0", "1", "-"], &["1", "2", "3"]])]);
    assert!(
        message(folder("a.xlsx", &bad, "", "").path()).starts_with("a.xlsx, line 2, column 3 (force_N): \"-\" is not")
    );
}

/// Cells that are dates or times are times.
#[test]
fn times_of_day_in_cells() {
    for (style, start) in
        [("yyyy-mm-dd hh:mm:ss.000", 45_413.585_7), ("hh:mm:ss.000", 0.585_7), ("[h]:mm:ss.000", 1.25)]
    {
        let style = Format::new().set_num_format(style);
        let mut book = Workbook::new();
        let sheet = book.add_worksheet();
        for (column, name) in ["time_s", "depth_mm", "force_N"].iter().enumerate() {
            sheet.write_string(0, column as u16, *name).unwrap();
        }
        for row in 1..5_u32 {
            // A tenth of a second from row to row.
            let days = start + f64::from(row) * 0.1 / 86_400.0;
            sheet.write_number_with_format(row, 0, days, &style).unwrap();
            sheet.write_number(row, 1, row).unwrap();
            sheet.write_number(row, 2, row).unwrap();
        }
        let found = recording(&folder("a.xlsx", &book.save_to_buffer().unwrap(), "", ""));
        for (found, expected) in found.time_s.iter().zip([0.0, 0.1, 0.2, 0.3]) {
            // Days since 1900 in 53 bits leave a microsecond.
            assert!((found - expected).abs() < 3e-6, "{found}, expected {expected}");
        }
    }
}

#[test]
fn what_only_looks_like_a_workbook() {
    let damaged = &book(&[("Tabelle1", RUN)])[..600];
    let said = message(folder("a.xlsx", damaged, "", "").path());
    assert!(said.contains("workbook (begins with PK) that cannot be read"), "{said}");
    let old = [&[0xd0, 0xcf, 0x11, 0xe0, 0xa1, 0xb1, 0x1a, 0xe1][..], &[0; 600]].concat();
    let said = message(folder("a.xls", &old, "", "").path());
    assert!(said.contains("an old Excel workbook, or one with a password (begins with D0CF11E0)"), "{said}");
}
