//! `[format]` and `[columns]`, of all runs or of one.

use std::collections::BTreeMap;

use toml::de::DeValue;

use super::error::{ExperimentError, Problem};
use super::format::{Format, Mapping, Pace, Part, Source};
use super::section::Section;

/// Most columns that a file can be meant to have.
const COLUMNS: std::ops::RangeInclusive<i64> = 1..=16_384;

/// The mappings of a section, over those of a wider one.
pub(super) fn columns(
    root: &Section<'_>,
    mut mappings: BTreeMap<String, Mapping>,
) -> Result<BTreeMap<String, Mapping>, ExperimentError> {
    let Some(section) = root.section("columns", "[columns]".to_owned())? else {
        return Ok(mappings);
    };
    for key in section.keys() {
        let wanted = key.get_ref().as_ref();
        let Some(value) = section.value(wanted) else {
            continue;
        };
        let mapping = match value.get_ref() {
            DeValue::String(name) => Mapping::named(name),
            DeValue::Integer(_) => {
                let number = section.integer(wanted, COLUMNS, "the number of a column, from 1")?;
                Mapping::numbered(number.and_then(|n| usize::try_from(n).ok()).unwrap_or(1))
            }
            DeValue::Table(table) => {
                let name = format!("columns.{wanted}");
                column(&Section::new(section.document, name, value.span(), table))?
            }
            _ => {
                let expected = "a column name, its number, or { name = \"...\", scale = 1.0, sign = 1 }";
                return Err(section.bad(wanted, value, expected));
            }
        };
        mappings.insert(wanted.to_owned(), mapping);
    }
    Ok(mappings)
}

fn column(section: &Section<'_>) -> Result<Mapping, ExperimentError> {
    section.only(&["name", "nth", "number", "scale", "sign"])?;
    let scale = section.number("scale", f64::MIN_POSITIVE..=1e12, "a number above 0 (turn directions with sign)")?;
    let sign = section.number("sign", -1.0..=1.0, "1 or -1")?.unwrap_or(1.0);
    if let Some(value) = section.value("sign")
        && sign.abs() != 1.0
    {
        return Err(section.bad("sign", value, "1 or -1"));
    }
    Ok(Mapping { source: source(section)?, scale, sign })
}

fn source(section: &Section<'_>) -> Result<Source, ExperimentError> {
    let expected = "the column's name in the header";
    let nth = section.integer("nth", COLUMNS, "which of the columns of that name, from 1")?;
    let number = section.integer("number", COLUMNS, "the number of a column, from 1")?;
    match (section.text("name", expected)?, number) {
        (Some(name), None) => {
            Ok(Source::Name { name: name.to_owned(), nth: nth.and_then(|nth| usize::try_from(nth).ok()) })
        }
        (None, Some(number)) if nth.is_none() => Ok(Source::Number(usize::try_from(number).unwrap_or(1))),
        (None, None) => Err(section.missing("name", expected)),
        _ => {
            let problem = "a column is chosen by `name` (and `nth`), or by `number`; state one of them".to_owned();
            Err(section.document.error(section.span.clone(), Problem::Contradiction(problem)))
        }
    }
}

/// The format of a section; what it leaves out is as in a wider one.
pub(super) fn format(root: &Section<'_>, mut format: Format) -> Result<Format, ExperimentError> {
    let Some(section) = root.section("format", "[format]".to_owned())? else {
        return Ok(format);
    };
    section.only(&[
        "delimiter",
        "skip_lines",
        "decimal",
        "thousands",
        "encoding",
        "units_row",
        "columns",
        "sheet",
        "segment",
        "footer_lines",
    ])?;
    if let Some(delimiter) = delimiter(&section)? {
        format.delimiter = delimiter;
    }
    let lines = |key| section.integer(key, 0..=100_000, "a whole number from 0");
    if let Some(lines) = lines("skip_lines")? {
        format.skip_lines = usize::try_from(lines).unwrap_or(0);
    }
    if let Some(lines) = lines("footer_lines")? {
        format.footer_lines = usize::try_from(lines).unwrap_or(0);
    }
    if let Some(sign) = section.word("decimal", &[(".", '.'), (",", ',')])? {
        format.decimal = sign;
    }
    if let Some(mark) = section.word("thousands", &[(".", '.'), (",", ','), ("'", '\''), (" ", ' ')])? {
        format.thousands = Some(mark);
    }
    if let Some(label) = encoding(&section)? {
        format.encoding = label;
    }
    if let Some(units_row) = section.flag("units_row")? {
        format.units_row = units_row;
    }
    if let Some(by_number) = section.word("columns", &[("by-number", true), ("by-name", false)])? {
        format.by_number = by_number;
    }
    format.sheet = part(&section, "sheet")?.or(format.sheet);
    format.segment = part(&section, "segment")?.or(format.segment);
    for (key, mark) in [("delimiter", Some(format.delimiter as char)), ("thousands", format.thousands)] {
        if mark == Some(format.decimal) {
            let problem = Problem::BadValue {
                key: "decimal".to_owned(),
                found: format!("\"{}\", as is {}", format.decimal, said(key)),
                expected: "two different characters, such as delimiter = \";\"".to_owned(),
            };
            return Err(section.document.error(section.span.clone(), problem));
        }
    }
    Ok(format)
}

fn said(key: &str) -> &'static str {
    if key == "delimiter" { "the delimiter" } else { "the mark between thousands" }
}

fn delimiter(section: &Section<'_>) -> Result<Option<u8>, ExperimentError> {
    let Some(value) = section.value("delimiter") else { return Ok(None) };
    match value.get_ref().as_str().map(str::as_bytes) {
        Some(b"spaces") => Ok(Some(b' ')),
        Some(&[byte]) if byte.is_ascii() && !byte.is_ascii_alphanumeric() && !b"\"\r\n".contains(&byte) => {
            Ok(Some(byte))
        }
        _ => Err(section.bad("delimiter", value, "one character such as \",\" or \"\\t\", or \"spaces\"")),
    }
}

fn encoding(section: &Section<'_>) -> Result<Option<String>, ExperimentError> {
    let Some(label) = section.text("encoding", "a label such as \"utf-8\" or \"latin1\"")? else { return Ok(None) };
    if encoding_rs::Encoding::for_label(label.as_bytes()).is_none() {
        let span = section.value("encoding").map_or(0..0, toml::Spanned::span);
        return Err(section.document.error(span, Problem::UnknownEncoding(label.to_owned())));
    }
    Ok(Some(label.to_owned()))
}

fn part(section: &Section<'_>, key: &str) -> Result<Option<Part>, ExperimentError> {
    let Some(value) = section.value(key) else { return Ok(None) };
    let expected = format!("the name of a {key}, or its number from 1");
    match value.get_ref() {
        DeValue::String(name) if !name.trim().is_empty() => Ok(Some(Part::Name(name.trim().to_owned()))),
        DeValue::Integer(_) => {
            let number = section.integer(key, 1..=1_000_000, &expected)?;
            Ok(number.and_then(|number| usize::try_from(number).ok()).map(Part::Number))
        }
        _ => Err(section.bad(key, value, &expected)),
    }
}

/// What a run states instead of a time column.
pub(super) fn pace(section: &Section<'_>) -> Result<Option<Pace>, ExperimentError> {
    let interval = section.number("interval_s", 1e-9..=1e6, "the time from row to row, above 0 s")?;
    let speed = section.number("rate_mm_per_s", 1e-9..=1e6, "the indenter's speed, above 0 mm/s")?;
    match (interval, speed) {
        (Some(interval_s), None) => Ok(Some(Pace::Interval(interval_s))),
        (None, Some(mm_per_s)) => Ok(Some(Pace::Speed(mm_per_s))),
        (None, None) => Ok(None),
        (Some(_), Some(_)) => {
            let span = section.value("rate_mm_per_s").map_or(0..0, toml::Spanned::span);
            let problem = "`interval_s` and `rate_mm_per_s` both say when a row was recorded; state one of them";
            Err(section.document.error(span, Problem::Contradiction(problem.to_owned())))
        }
    }
}
