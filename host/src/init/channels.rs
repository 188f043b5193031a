//! What a preamble says of channels, rates and sizes.

use std::ops::Range;

use crate::experiment::file::number::Digits;
use crate::experiment::file::table::{Row, Table};

/// Unit and factor of a column that the preamble states in a table of channels.
#[derive(Debug, Clone, Default)]
pub(super) struct Channel {
    pub unit: Option<String>,
    pub scale: Option<f64>,
}

/// For each name of a header what a table of channels above it says: a row with the same names, and rows "Units" and "Scale"
/// below that.
pub(super) fn channels(table: &Table, above: Range<usize>, header: Row<'_>, digits: Digits) -> Vec<Channel> {
    let mut found = vec![Channel::default(); header.len()];
    let shared = |row: Row<'_>| row.cells().filter(|c| !c.is_empty() && header.cells().any(|h| h == *c)).count();
    let Some(names) = above.clone().find(|at| shared(table.row(*at)) >= 2) else { return found };
    for at in names + 1..above.end.min(names + 8) {
        let row = table.row(at);
        let what = row.cell(0).to_lowercase();
        for (place, name) in table.row(names).cells().enumerate().skip(1) {
            let cell = row.cell(place);
            let Some(column) = header.cells().position(|h| h == name).filter(|_| !cell.is_empty()) else { continue };
            if what.starts_with("unit") || what.starts_with("einheit") {
                found[column].unit = Some(cell.to_owned());
            } else if what.starts_with("scale") || what.starts_with("faktor") {
                found[column].scale = digits.number(cell).ok();
            }
        }
    }
    found
}

/// Numbers that a preamble states.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Stated {
    /// From row to row, s.
    pub interval_s: Option<f64>,
    /// Speed of the machine, mm/s.
    pub speed_mm_per_s: Option<f64>,
    /// Height of the specimen, mm.
    pub height_mm: Option<f64>,
    /// Diameter of the specimen, mm.
    pub diameter_mm: Option<f64>,
    /// It says that a whole specimen was compressed.
    pub compression: bool,
}

/// Reads the rows above a block.
pub(super) fn stated(table: &Table, above: Range<usize>) -> Stated {
    let mut stated = Stated::default();
    for at in above {
        let line = table.row(at).cells().collect::<Vec<_>>().join(" ").to_lowercase();
        let Some(number) = first_number(&line) else {
            stated.compression |= ["compression test", "druckversuch"].iter().any(|words| line.contains(words));
            continue;
        };
        let has = |words: &[&str]| words.iter().any(|word| line.contains(word));
        let positive = (number > 0.0).then_some(number);
        if has(&["sampl", "abtast", "messrate", "data rate"]) && has(&["hz"]) {
            stated.interval_s = stated.interval_s.or(positive.map(|hz| 1.0 / hz));
        } else if has(&["interval", "intervall"]) {
            stated.interval_s = stated.interval_s.or(positive.map(|s| if has(&["ms"]) { 1e-3 * s } else { s }));
        } else if has(&["mm/min"]) {
            stated.speed_mm_per_s = stated.speed_mm_per_s.or(positive.map(|v| v / 60.0));
        } else if has(&["mm/s"]) {
            stated.speed_mm_per_s = stated.speed_mm_per_s.or(positive);
        } else if has(&["mm"]) && has(&["height", "höhe", "thickness", "dicke"]) {
            stated.height_mm = stated.height_mm.or(positive);
        } else if has(&["mm"])
            && has(&["cylinder diameter", "specimen diameter", "sample diameter", "probendurchmesser"])
        {
            stated.diameter_mm = stated.diameter_mm.or(positive);
        }
    }
    stated
}

/// The first number after a colon, an equals sign or a blank.
fn first_number(line: &str) -> Option<f64> {
    let tail = line.find([':', '=']).map_or(line, |at| &line[at + 1..]);
    let word = tail
        .split([' ', ';', '\t', '=', ':'])
        .find(|word| word.starts_with(|c: char| c.is_ascii_digit() || c == '.'))?;
    let end = word.find(|c: char| !c.is_ascii_digit() && c != '.' && c != ',').unwrap_or(word.len());
    word[..end].replace(',', ".").parse().ok()
}
