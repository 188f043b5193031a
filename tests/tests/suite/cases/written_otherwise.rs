//! More files of the same kinds: each is read after the key, and without it the message names the key.

use super::case::{agree, folder, message, read, recording};
use palpate::experiment::{motion, replicate};

/// A press of eleven rows at 1 mm/s, with what is between cells and the decimal sign.
fn rows(delimiter: &str, decimal: &str) -> String {
    (0..11)
        .map(|i| {
            let cells = [0.1 * f64::from(i), 0.1 * f64::from(i) - 0.2, 0.01 * f64::from(i * i)];
            let cells: Vec<String> = cells.iter().map(|x| format!("{x:.4}").replace('.', decimal)).collect();
            cells.join(delimiter) + "\n"
        })
        .collect()
}

fn plain() -> palpate::experiment::Recording {
    let file = format!("time_s,depth_mm,force_N\n{}", rows(",", "."));
    recording(&folder("a.csv", file.as_bytes(), "", ""))
}

const GERMAN: &str = "[columns]\ntime_s = \"Zeit\"\ndepth_mm = \"Weg\"\nforce_N = \"Kraft\"\n";

#[track_caller]
fn reads(data: &[u8], keys: &str, of_run: &str) {
    // Four decimals in the files.
    agree(&recording(&folder("a.csv", data, keys, of_run)), &plain(), 0.6e-4);
}

#[track_caller]
fn says(data: &[u8], keys: &str, of_run: &str, expected: &str) {
    let said = message(folder("a.csv", data, keys, of_run).path());
    assert!(said.contains(expected), "{said}\nlacks\n{expected}");
}

#[test]
fn rows_of_units() {
    let brackets = format!("Zeit;Weg;Kraft\n[s];[mm];[N]\n{}", rows(";", ","));
    let keys = format!("{GERMAN}[format]\ndelimiter = \";\"\ndecimal = \",\"\n");
    says(brackets.as_bytes(), &keys, "", "line 2 is a row of units: write units_row = true in [format]");
    reads(brackets.as_bytes(), &format!("{keys}units_row = true\n"), "");
    let bare = format!("\"time_s\"\t\"depth_mm\"\t\"force_N\"\n\"s\"\t\"mm\"\t\"N\"\n{}", rows("\t", "."));
    says(bare.as_bytes(), "[format]\ndelimiter = \"\\t\"\n", "", "units_row = true");
    reads(bare.as_bytes(), "[format]\ndelimiter = \"\\t\"\nunits_row = true\n", "");
}

#[test]
fn side_by_side_with_the_shorter_first() {
    let mut file = "t,d,f,t,d,f\n".to_owned();
    for (at, row) in rows(",", ".").lines().enumerate() {
        let short = if at < 6 { row } else { ",," };
        file.push_str(&format!("{short},{row}\n"));
    }
    let numbers = |from: u32| {
        format!(
            "[columns]\ntime_s = {from}\ndepth_mm = {}\nforce_N = {{ number = {}, scale = 1.0 }}\n",
            from + 1,
            from + 2
        )
    };
    let by_number = "[format]\ncolumns = \"by-number\"\n";
    reads(file.as_bytes(), &(numbers(4) + by_number), "");
    assert_eq!(recording(&folder("a.csv", file.as_bytes(), &(numbers(1) + by_number), "")).len(), 6);
    says(file.as_bytes(), &(numbers(5) + by_number), "", "`force_N` is column 7, and the rows have 6");
    // A hole inside is a mistake, an end is none.
    let hole = file.replacen("0.2000,0.0000,0.0400", ",,", 1);
    says(hole.as_bytes(), &(numbers(1) + by_number), "", "line 4, column 1 (t): the cell is empty; expected a number");
}

#[test]
fn no_header_at_all() {
    says(rows(",", ".").as_bytes(), "", "", "write columns = \"by-number\" in [format]");
    let keys = "[columns]\ntime_s = 1\ndepth_mm = 2\nforce_N = 3\n[format]\ncolumns = \"by-number\"\n";
    reads(rows(",", ".").as_bytes(), keys, "");
    says(rows(",", ".").as_bytes(), &keys.replace("time_s = 1\n", ""), "", "`time_s` has no column number");
    let blanks = format!("  {}", rows("   ", ".").replace('\n', "\n  "));
    reads(blanks.as_bytes(), &format!("{keys}delimiter = \"spaces\"\n"), "");
}

#[test]
fn segments_by_name_and_number() {
    let header = "time_s,depth_mm,force_N";
    let back = "0,5,1\n0.1,4,0.5\n0.2,3,0\n";
    let named = format!("Machine 7\n\nSegment,approach\n{header}\n{}Segment,return\n{header}\n{back}", rows(",", "."));
    reads(named.as_bytes(), "[format]\nsegment = \"Approach\"\n", "");
    reads(named.as_bytes(), "[format]\nsegment = 1\n", "");
    let two = recording(&folder("a.csv", named.as_bytes(), "[format]\nsegment = \"return\"\n", ""));
    assert_eq!((two.depth_mm, two.line), (vec![5.0, 4.0, 3.0], vec![18, 19, 20]));
    says(named.as_bytes(), "[format]\nsegment = 3\n", "", "no segment 3, or more than one; the file has: 1 \"");
    says(named.as_bytes(), "", "", "line 4 has it: write skip_lines = 3 in [format]");
    let units = format!("{header}\ns,mm,N\n{}{header}\ns,mm,N\n{back}", rows(",", "."));
    says(units.as_bytes(), "[format]\nunits_row = true\n", "", "the header stands again in line 14");
    reads(units.as_bytes(), "[format]\nunits_row = true\nsegment = 1\n", "");
    reads(units.as_bytes(), "[format]\nunits_row = true\n", "to_s = 1.0");
}

#[test]
fn what_is_outside_need_not_parse_and_what_is_inside_must() {
    let header = "time_s,depth_mm,force_N\n";
    let footer = format!("{header}{}Mean,,0.3\nMax,,1.0\n", rows(",", "."));
    says(footer.as_bytes(), "", "", "write footer_lines = 2 in [format], or end the run with to_s");
    reads(footer.as_bytes(), "[format]\nfooter_lines = 2\n", "");
    reads(footer.as_bytes(), "", "to_s = 5");
    let late = format!("{header}warming up\n-2,x,y\n-1,-0.2,nan\n{}", rows(",", "."));
    reads(late.as_bytes(), "", "from_s = 0");
    let inside = format!("{header}{}", rows(",", ".")).replace("0.3000,0.1000,0.0900", "0.3000,oops,0.0900");
    says(inside.as_bytes(), "", "from_s = 0.1\nto_s = 0.9", "line 5, column 2 (depth_mm): \"oops\" is not a number");
    let inside = inside.replace("0.3000,oops,0.0900", "pause");
    says(inside.as_bytes(), "", "from_s = 0.1\nto_s = 0.9", "line 5: the row has 1 cells where the header has 3");
    says(
        inside.as_bytes(),
        "",
        "from_s = 7",
        "no sample lies between `from_s` and `to_s`; the recording has times from 0 to 1 s",
    );
}

#[test]
fn no_time() {
    let file: String = rows(",", ".").lines().map(|row| row.split_once(',').unwrap().1.to_owned() + "\n").collect();
    let file = format!("depth_mm,force_N\n{file}");
    reads(file.as_bytes(), "", "rate_mm_per_s = 1.0");
    reads(file.as_bytes(), "", "interval_s = 0.1");
    says(file.as_bytes(), "", "interval_s = 0.1\nrate_mm_per_s = 1.0", "state one of them");
    says(file.as_bytes(), "", "rate_mm_per_s = 0", "`rate_mm_per_s` is 0; expected the indenter's speed, above 0 mm/s");
}

#[test]
fn wide_characters() {
    let text = format!("Zeit;Weg;Kraft\n{}", rows(";", ","));
    let keys = format!("{GERMAN}[format]\ndelimiter = \";\"\ndecimal = \",\"\n");
    let big: Vec<u8> = text.encode_utf16().flat_map(u16::to_be_bytes).collect();
    says(&big, &keys, "", "looks like UTF-16: write encoding = \"utf-16be\" in [format]");
    reads(&big, &format!("{keys}encoding = \"utf-16be\"\n"), "");
    let marked: Vec<u8> = [0xff, 0xfe].into_iter().chain(text.encode_utf16().flat_map(u16::to_le_bytes)).collect();
    reads(&marked, &keys, "");
    let utf8_mark = [&[0xef, 0xbb, 0xbf], text.as_bytes()].concat();
    reads(&utf8_mark, &keys, "");
    says(b"\0\x01\x02\0\0\xff\0\x07binary", &keys, "", "no text and no workbook");
}

#[test]
fn other_signs_between_and_in_numbers() {
    let semicolons = format!("time_s;depth_mm;force_N\n{}", rows(";", ","));
    says(
        semicolons.as_bytes(),
        "",
        "",
        "the header has one column `time_s;depth_mm;force_N`: write delimiter = \";\" in [format]",
    );
    says(semicolons.as_bytes(), "[format]\ndelimiter = \";\"\n", "", "Write decimal = \",\" in [format]");
    let commas = format!("time_s,depth_mm,force_N\n{}", rows(",", ","));
    says(commas.as_bytes(), "", "", "are these decimal commas?");
    let thousands = "time_s;depth_mm;force_N\n0,0;0,1;0,5\n0,1;0,2;1.234,5\n";
    let keys = "[format]\ndelimiter = \";\"\ndecimal = \",\"\n";
    says(
        thousands.as_bytes(),
        keys,
        "",
        "\"1.234,5\" is not a number; are these thousands? Write thousands = \".\" in [format]",
    );
    let read =
        recording(&folder("a.csv", thousands.as_bytes(), &format!("{keys}thousands = \".\"\n"), "test = \"air\""));
    assert_eq!(read.force_n, [0.5, 1234.5]);
    says(thousands.as_bytes(), "[format]\ndecimal = \",\"\n", "", "two different characters");
}

#[test]
fn clock_times_count_from_the_first_row() {
    let cells = ["14:03:22.5", "14:03:22.75", "14:03:23.0", "14:03:23.25", "14:03:23.5"];
    for (before, after) in [("", ""), ("2024-05-01 ", ""), ("2024-05-01T", "Z"), ("01.05.2024 ", "")] {
        let rows: String = cells.iter().enumerate().map(|(i, t)| format!("{before}{t}{after},{i},{i}\n")).collect();
        let read = recording(&folder("a.csv", format!("time_s,depth_mm,force_N\n{rows}").as_bytes(), "", "to_s = 0.8"));
        assert_eq!(read.time_s, [0.0, 0.25, 0.5, 0.75], "{before}");
    }
    says(b"time_s,depth_mm,force_N\n14:03,0,0\n14:04,1,1\n", "", "", "a time of day is written as 14:03:22.5");
    says(b"time_s,depth_mm,force_N\n14:03:10,0,0\n14:03:09,1,1\n", "", "", "time goes backwards: -1 s after 0 s");
}

#[test]
fn columns_are_chosen_once() {
    let file = format!("time_s,depth_mm,force_N\n{}", rows(",", "."));
    let keys = |choice: &str| format!("[columns]\ndepth_mm = {choice}\n");
    says(file.as_bytes(), &keys("{ name = \"depth_mm\", number = 2 }"), "", "state one of them");
    says(file.as_bytes(), &keys("{ scale = 2.0 }"), "", "lacks the key `name`");
    says(file.as_bytes(), &keys("0"), "", "`depth_mm` is 0; expected the number of a column, from 1");
    says(file.as_bytes(), &keys("{ name = \"depth_mm\", nth = 2 }"), "", "no column `depth_mm (2)`");
    reads(file.as_bytes(), &keys("2"), "");
}

/// Runs of one label repeat each other, whatever their speeds; others of the same motion do not join them.
#[test]
fn repeats_by_declaration() {
    let run = "[[run]]\nfile = \"a.csv\"\nspecimen = \"foam\"\nindenter = \"ball\"\n";
    let file = format!("time_s,depth_mm,force_N\n{}", rows(",", "."));
    let others = format!("repeats = \"A\"\n{run}interval_s = 0.2\nrepeats = \"A\"\n{run}repeats = \"B\"\n{run}{run}");
    let made = folder("a.csv", file.as_bytes(), "", &others);
    let read = read(made.path());
    let motions: Vec<_> = read.runs.iter().map(|run| motion::of(&run.recording)).collect();
    assert_eq!(replicate::groups(&read, &motions), [vec![0, 1], vec![2], vec![3, 4]]);
    let differ = format!("repeats = \"A\"\n{run}test = \"uniaxial\"\nrepeats = \"A\"\n");
    says(file.as_bytes(), "", &differ, "runs that repeat \"A\" differ in test, specimen or indenter: a.csv and a.csv");
}
