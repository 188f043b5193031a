//! What may be the cause of a mistake in a header, and the key that would help.

use super::super::error::Problem;
use super::super::format::Source;
use super::super::unit::is_unit;
use super::number::Digits;
use super::segment::Plan;
use super::table::{Row, Table};

/// Rows in which the header is looked for.
const PREAMBLE: usize = 200;

/// A header that does not have what is wanted.
pub(super) fn of_header(plan: &Plan<'_>, table: &Table, problem: Problem) -> Problem {
    let first = table.row(0);
    let hint = one_column(first)
        .or_else(|| header_below(plan, table))
        .or_else(|| nameless(plan, first))
        .or_else(|| twice(plan, first, &problem))
        .or_else(|| no_time(plan, &problem));
    problem.with(hint)
}

/// The whole header is one cell with another character inside.
fn one_column(first: Row<'_>) -> Option<String> {
    let cell = first.cell(0);
    let marks = [(';', ";"), ('\t', "\\t"), ('|', "|"), (',', ",")];
    let (_, key) = marks.iter().find(|(mark, _)| cell.contains(*mark)).filter(|_| first.len() == 1)?;
    Some(format!("the header has one column `{}`: write delimiter = \"{key}\" in [format]", cell.replace('\t', "\\t")))
}

/// The names stand in a row further down.
fn header_below(plan: &Plan<'_>, table: &Table) -> Option<String> {
    let at = (1..table.len().min(PREAMBLE)).find(|at| plan.below(table, *at).is_some())?;
    let lines = table.row(at).line - 1;
    Some(format!("line {} has it: write skip_lines = {lines} in [format]", lines + 1))
}

/// The first row holds numbers.
fn nameless(plan: &Plan<'_>, first: Row<'_>) -> Option<String> {
    let digits = Digits::of(plan.format);
    let numbers = first.cells().filter(|cell| digits.are(cell)).count();
    (numbers >= 2 && 2 * numbers > first.len()).then(|| {
        "the first row holds numbers and no names: write columns = \"by-number\" in [format], and in [columns] numbers such \
         as depth_mm = 2"
            .to_owned()
    })
}

/// The same name twice: specimens side by side, or a row of units that is taken for the header.
fn twice(plan: &Plan<'_>, first: Row<'_>, problem: &Problem) -> Option<String> {
    let Problem::DuplicateColumn(name) = problem else { return None };
    if is_unit(name) && first.cells().filter(|cell| is_unit(cell)).count() * 2 > first.len() {
        let lines = plan.format.skip_lines.saturating_sub(1);
        return Some(format!("this is a row of units: write skip_lines = {lines} and units_row = true in [format]"));
    }
    Some(format!("choose with {{ name = \"{name}\", nth = 2 }} or by number ({{ number = 3 }}) in [columns]"))
}

/// The file has no time.
fn no_time(plan: &Plan<'_>, problem: &Problem) -> Option<String> {
    let missing = match problem {
        Problem::MissingColumn { .. } => {
            plan.columns.get("time_s").is_none_or(|mapping| matches!(&mapping.source, Source::Name { .. }))
                && matches!(problem, Problem::MissingColumn { why, .. } if why.contains("time"))
        }
        Problem::NoNumber { wanted, .. } => wanted == "time_s",
        _ => false,
    };
    missing.then(|| {
        "if the file has no time, state interval_s (from row to row) or rate_mm_per_s (the indenter's speed) in [[run]]"
            .to_owned()
    })
}
