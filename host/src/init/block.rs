//! Blocks of numbers in a table, with the rows above that name them.

use std::ops::Range;

use crate::experiment::file::number::Digits;
use crate::experiment::file::table::Table;

use super::written::{counts, is_value};
use crate::experiment::unit::unit;

/// Fewest rows that are a recording or a table.
const ROWS: usize = 5;

/// Rows of numbers and what stands above them; places of rows in the table.
#[derive(Debug, Clone)]
pub(super) struct Block {
    /// Row of names.
    pub header: Option<usize>,
    /// Row of units between names and numbers.
    pub units: Option<usize>,
    /// Numbers.
    pub rows: Range<usize>,
}

/// All blocks of a table.
pub(super) fn blocks(table: &Table, digits: Digits) -> Vec<Block> {
    let is_data = |at: usize| {
        let (values, filled) = counts(digits, table.row(at));
        values >= 2 && 2 * values >= filled
    };
    let mut found = Vec::new();
    let mut at = 0;
    while at < table.len() {
        let start = at;
        while at < table.len() && is_data(at) {
            at += 1;
        }
        if at - start >= ROWS {
            found.push(named(table, digits, start..at));
        }
        at = at.max(start + 1);
    }
    found
}

fn named(table: &Table, digits: Digits, rows: Range<usize>) -> Block {
    let names = |at: usize| {
        let row = table.row(at);
        let filled = row.cells().filter(|cell| !cell.is_empty()).count();
        // A row that reaches as far as the numbers do and holds words.
        let words = row.cells().filter(|cell| !cell.is_empty() && !is_value(digits, cell)).count();
        filled >= 2 && 2 * words >= filled && !row.cell(0).starts_with('#')
    };
    let units = |at: usize| {
        let row = table.row(at);
        let (filled, known) = row.cells().filter(|c| !c.is_empty()).fold((0, 0), |(filled, known), cell| {
            (filled + 1, known + usize::from(unit(cell).is_some() || matches!(cell, "-" | "(-)" | "[-]" | "%")))
        });
        known >= 1 && 2 * known >= filled
    };
    let above = rows.start.checked_sub(1).filter(|at| names(*at));
    match above {
        Some(at) if units(at) && at > 0 && names(at - 1) => Block { header: Some(at - 1), units: Some(at), rows },
        header => Block { header, units: None, rows },
    }
}
