//! One file to the runs that it holds.

use std::path::Path;

use crate::experiment::Test;
use crate::experiment::file::content::Content;
use crate::experiment::file::number::Digits;
use crate::experiment::file::table::Table;
use crate::experiment::file::workbook::Workbook;

use super::block::{Block, blocks};
use super::channels::{Stated, channels, stated};
use super::draft::{Key, RunDraft, Table as Place, quoted};
use super::roles::{Column, Roles, ends, roles, values};
use super::written::written;

/// Where in a file a table is.
struct Sheet<'a> {
    path: &'a Path,
    table: Table,
    digits: Digits,
    /// Keys that its way of being written asks for.
    keys: Vec<Key>,
    /// Name of the sheet where there are several.
    name: Option<String>,
}

/// Runs of a file.
///
/// # Errors
/// Why it is none, in words for its reader.
pub(super) fn runs(path: &Path) -> Result<Vec<RunDraft>, String> {
    let bytes = std::fs::read(path).map_err(|cause| format!("cannot be read: {cause}"))?;
    let plain = |error: crate::experiment::ExperimentError| error.problem.to_string();
    let mut found = Vec::new();
    match Content::of(&bytes) {
        Content::Other => return Err("no text and no workbook".to_owned()),
        Content::Packed | Content::Compound => {
            let mut book = Workbook::open(path, &bytes).map_err(plain)?;
            let names = book.names();
            let mut sheets = Vec::new();
            for name in names {
                let table = book.table(&name, '.').map_err(plain)?;
                if table.len() > 0 {
                    sheets.push((name, table));
                }
            }
            let several = sheets.len() > 1;
            for (name, table) in sheets {
                let digits = Digits { decimal: '.', thousands: None };
                let sheet = Sheet { path, table, digits, keys: Vec::new(), name: several.then_some(name) };
                found.extend(of_sheet(&sheet));
            }
        }
        Content::Text => {
            let written = written(path, &bytes).map_err(plain)?;
            let keys = keys_of(&written);
            let sheet = Sheet { path, table: written.table, digits: written.digits, keys, name: None };
            found.extend(of_sheet(&sheet));
        }
    }
    // Sheets of results beside sheets of recordings are no runs.
    if found.iter().any(|run| run.test != Test::Table) {
        found.retain(|run| run.test != Test::Table);
    }
    if found.is_empty() { Err("no table of numbers in it".to_owned()) } else { Ok(found) }
}

fn keys_of(written: &super::written::Written) -> Vec<Key> {
    let mut keys = Vec::new();
    let mut key = |name: &str, value: String, why: &str| keys.push(Key::new(Place::Format, name, value, why));
    let delimiter = match written.delimiter {
        b',' => None,
        b' ' => Some("spaces".to_owned()),
        other => Some((other as char).to_string()),
    };
    if let Some(delimiter) = delimiter {
        key("delimiter", quoted(&delimiter), "cuts the rows into numbers");
    }
    if written.digits.decimal == ',' {
        key("decimal", quoted(","), "");
    }
    if let Some(mark) = written.digits.thousands {
        key("thousands", quoted(&mark.to_string()), "");
    }
    if let Some(encoding) = written.encoding {
        key("encoding", quoted(encoding), "GUESS: from the bytes of the file");
    }
    keys
}

fn of_sheet(sheet: &Sheet<'_>) -> Vec<RunDraft> {
    let blocks = blocks(&sheet.table, sheet.digits);
    let mut title = 0;
    let mut found: Vec<(Block, Stated, Vec<Roles>)> = Vec::new();
    for block in &blocks {
        let above = title..block.header.unwrap_or(block.rows.start);
        let channels = block.header.map(|h| channels(&sheet.table, 0..h, sheet.table.row(h), sheet.digits));
        let roles = roles(&sheet.table, block, sheet.digits, &channels.unwrap_or_default());
        found.push((block.clone(), stated(&sheet.table, above), roles));
        title = block.rows.end;
    }
    let recordings: Vec<_> = found.iter().filter(|(_, _, roles)| !roles.is_empty()).collect();
    let Some((first, said, _)) = recordings.first() else {
        let longest = blocks.iter().max_by_key(|block| block.rows.len());
        return longest.map(|block| x_over_y(sheet, block)).into_iter().collect();
    };
    let start = first.header.unwrap_or(first.rows.start);
    let end = recordings.last().map_or(first.rows.end, |(block, ..)| block.rows.end);
    let said = found.first().map_or(*said, |(_, said, _)| *said);
    let parted = recordings.len() > 1 && recordings.iter().all(|(block, ..)| block.header.is_some());
    let mut runs = Vec::new();
    for (nth, (block, _, roles)) in recordings.iter().take(if parted { usize::MAX } else { 1 }).enumerate() {
        for (beside, one) in roles.iter().enumerate() {
            let by_number = block.header.is_none() || repeats(sheet, block, one);
            let mut run = RunDraft::new(sheet.path, Test::Indentation, said);
            let end = if parted { end } else { block.rows.end };
            run.keys = common(sheet, block, start, end, by_number);
            if parted {
                let number = segment(sheet, start, block, one);
                run.keys.push(Key::new(Place::RunFormat, "segment", number.to_string(), "its place in the file"));
                run.label.push_str(&format!(" segment {}", nth + 1));
            }
            if roles.len() > 1 {
                run.label.push_str(&format!(" specimen {}", beside + 1));
            }
            run.keys.extend(columns(one, by_number));
            times(sheet, block, one, said, &mut run);
            runs.push(run);
        }
    }
    runs
}

/// Keys that all runs of a sheet share.
fn common(sheet: &Sheet<'_>, block: &Block, start: usize, end: usize, by_number: bool) -> Vec<Key> {
    let mut keys = sheet.keys.clone();
    let mut key = |name: &str, value: String, why: &str| keys.push(Key::new(Place::Format, name, value, why));
    let lines = sheet.table.row(start).line.saturating_sub(1);
    if start > 0 {
        key("skip_lines", lines.to_string(), "lines above the names of the columns");
    }
    if block.units.is_some() {
        key("units_row", "true".to_owned(), "");
    }
    if by_number {
        key("columns", quoted("by-number"), "the names repeat, or there are none");
    }
    if sheet.table.len() > end {
        key("footer_lines", (sheet.table.len() - end).to_string(), "lines under the numbers");
    }
    if let Some(name) = &sheet.name {
        keys.push(Key::new(Place::RunFormat, "sheet", quoted(name), ""));
    }
    keys
}

/// The names of the columns stand more than once in the header.
fn repeats(sheet: &Sheet<'_>, block: &Block, roles: &Roles) -> bool {
    let Some(header) = block.header else { return true };
    let count = |column: &Column| {
        let name = column.name.as_deref().unwrap_or_default();
        sheet.table.row(header).cells().filter(|cell| *cell == name).count()
    };
    [Some(&roles.depth), Some(&roles.force), roles.time.as_ref()].into_iter().flatten().any(|column| count(column) > 1)
}

/// Number of a segment as the reader counts: rows that have all names.
fn segment(sheet: &Sheet<'_>, start: usize, block: &Block, roles: &Roles) -> usize {
    let names: Vec<&str> = [Some(&roles.depth), Some(&roles.force), roles.time.as_ref()]
        .into_iter()
        .flatten()
        .filter_map(|column| column.name.as_deref())
        .collect();
    let header = block.header.unwrap_or(start);
    let is_header = |at: &usize| {
        let row = sheet.table.row(*at);
        names.iter().all(|name| row.cells().any(|cell| cell == *name))
    };
    (start..=header).filter(is_header).count().max(1)
}

fn columns(roles: &Roles, by_number: bool) -> Vec<Key> {
    let mut keys = Vec::new();
    let wanted = [
        ("time_s", roles.time.as_ref(), 1.0),
        ("depth_mm", Some(&roles.depth), roles.depth_sign),
        ("force_N", Some(&roles.force), roles.force_sign),
    ];
    for (wanted, column, sign) in wanted {
        let Some(column) = column else { continue };
        let source =
            if by_number { (column.index + 1).to_string() } else { quoted(column.name.as_deref().unwrap_or("")) };
        let mut why = column.why.clone();
        if sign < 0.0 {
            let turned = if wanted == "depth_mm" { "it falls where force grows" } else { "pressing is negative" };
            why = if why.is_empty() { turned.to_owned() } else { format!("{why}; {turned}") };
        }
        if column.scale == 1.0 && sign > 0.0 {
            if by_number || column.name.as_deref() != Some(wanted) {
                keys.push(Key::new(Place::Columns, wanted, source, &why));
            }
            continue;
        }
        let mut value = format!("{{ {} = {source}", if by_number { "number" } else { "name" });
        if column.scale != 1.0 {
            value.push_str(&format!(", scale = {:?}", column.scale));
        }
        if sign < 0.0 {
            value.push_str(", sign = -1");
        }
        keys.push(Key::new(Place::Columns, wanted, value + " }", &why));
    }
    keys
}

/// What is known of time, and rows before the sensors were ready.
fn times(sheet: &Sheet<'_>, block: &Block, roles: &Roles, said: Stated, run: &mut RunDraft) {
    let values = |index| values(&sheet.table, block, sheet.digits, index);
    let Some(time) = &roles.time else {
        let (key, value, why) = match (said.interval_s, said.speed_mm_per_s) {
            (Some(interval_s), _) => {
                ("interval_s", interval_s, "stated above the numbers; the file has no time".to_owned())
            }
            (None, Some(speed)) => {
                ("rate_mm_per_s", speed, "stated above the numbers; the file has no time".to_owned())
            }
            (None, None) => {
                run.notes.push("the file has no time: 1 mm/s is assumed; write your speed in rate_mm_per_s".to_owned());
                ("rate_mm_per_s", 1.0, "GUESS: the file has no time; write the speed of your machine".to_owned())
            }
        };
        run.keys.push(Key::new(Place::Run, key, format!("{value:?}"), &why));
        return;
    };
    let (time_s, depth, force) = (values(time.index), values(roles.depth.index), values(roles.force.index));
    let good = |at: &usize| [&time_s, &depth, &force].iter().all(|column| column[*at].is_finite());
    match (0..time_s.len()).find(good) {
        Some(first) if first > 0 && time_s[first].is_finite() => {
            let from_s = time_s[first] * time.scale;
            run.keys.push(Key::new(Place::Run, "from_s", format!("{from_s:?}"), "the rows before hold no number"));
        }
        _ => {}
    }
    let (low, high) = ends(&depth);
    let travel = (high - low) * roles.depth.scale;
    if travel < 0.05 && roles.depth.why.starts_with("GUESS") {
        run.notes.push(format!("depth goes over {travel} mm only: is it in m? Then set its scale to 1000.0"));
    }
}

/// A table that is no recording.
fn x_over_y(sheet: &Sheet<'_>, block: &Block) -> RunDraft {
    let mut run = RunDraft::new(sheet.path, Test::Table, Stated::default());
    run.keys = common(sheet, block, block.header.unwrap_or(block.rows.start), block.rows.end, true);
    let has = |index: usize| values(&sheet.table, block, sheet.digits, index).iter().any(|value| value.is_finite());
    let width = sheet.table.row(block.rows.start).len();
    for (wanted, index) in ["x", "y"].into_iter().zip((0..width).filter(|index| has(*index))) {
        run.keys.push(Key::new(Place::Columns, wanted, (index + 1).to_string(), "GUESS: the first columns of numbers"));
    }
    run.notes
        .push("no columns of depth and force in it: it is a table, and `palpate identify` does not use it".to_owned());
    run
}
