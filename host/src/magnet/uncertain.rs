//! `[[uncertain]]`: what a built magnet may differ by from its drawing.

use super::expression::Parameters;
use crate::experiment::section::Section;
use crate::experiment::{ExperimentError, Problem};

/// Parts in which a built magnet may differ, by their codes.
pub const PARTS: [&str; 6] = ["gap", "leakage", "turns", "probe-position", "saturation", "fluid"];

/// One of them: a parameter, and by how much it may plausibly differ (one standard deviation).
#[derive(Debug, Clone, PartialEq)]
pub struct Uncertain {
    /// Place of its part in [`PARTS`].
    pub part: usize,
    /// The parameter.
    pub parameter: String,
    /// One standard deviation, in the parameter's unit.
    pub by: f64,
}

pub(super) fn read(root: &Section<'_>, parameters: &Parameters) -> Result<Vec<Uncertain>, ExperimentError> {
    let mut list: Vec<Uncertain> = Vec::new();
    for section in root.array("uncertain")? {
        section.only(&["part", "parameter", "by"])?;
        let parts: Vec<(&str, usize)> = PARTS.into_iter().enumerate().map(|(i, name)| (name, i)).collect();
        let expected = PARTS.map(|name| format!("\"{name}\"")).join(", ");
        let part = section.word("part", &parts)?.ok_or_else(|| section.missing("part", &expected))?;
        let known: Vec<&str> = parameters.0.keys().map(String::as_str).collect();
        let expected = format!("the name of a parameter: {}", known.join(", "));
        let parameter = section.text("parameter", &expected)?.ok_or_else(|| section.missing("parameter", &expected))?;
        if let Some(value) = section.value("parameter").filter(|_| !parameters.0.contains_key(parameter)) {
            return Err(section.bad("parameter", value, &expected));
        }
        let expected = "what a built one may differ by, in the parameter's unit, more than 0";
        let by = section.number("by", f64::MIN_POSITIVE..=1e6, expected)?;
        let by = by.ok_or_else(|| section.missing("by", expected))?;
        if list.iter().any(|own| own.part == part) {
            let text = format!("the part \"{}\" is told twice", PARTS[part]);
            return Err(section.document.error(section.span.clone(), Problem::Contradiction(text)));
        }
        list.push(Uncertain { part, parameter: parameter.to_owned(), by });
    }
    Ok(list)
}
