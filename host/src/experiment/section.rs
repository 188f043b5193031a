//! Typed reading of one table of `experiment.toml`, with the place of every value.

use std::ops::Range;
use std::path::Path;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::error::{ExperimentError, Problem};
use super::keys;

/// The text being read and where it came from.
#[derive(Clone, Copy)]
pub(crate) struct Document<'a> {
    pub file: &'a Path,
    pub text: &'a str,
}

impl<'a> Document<'a> {
    /// The whole file as a table; what is no TOML is an error at its place.
    pub fn table(&self) -> Result<Spanned<DeTable<'a>>, ExperimentError> {
        DeTable::parse(self.text).map_err(|cause| {
            let problem = Problem::Syntax(cause.message().to_owned());
            self.error(cause.span().unwrap_or(0..0), problem)
        })
    }

    pub fn error(&self, span: Range<usize>, problem: Problem) -> ExperimentError {
        ExperimentError::of_text(self.file, self.text, span, problem)
    }
}

/// One table: `[format]`, `[specimen.eva]`, a `[[run]]`.
#[derive(Clone)]
pub(crate) struct Section<'a> {
    pub document: Document<'a>,
    /// Its name for messages, as it is written in the file.
    pub name: String,
    pub span: Range<usize>,
    table: &'a DeTable<'a>,
}

/// A value as a message shows it.
fn shown(value: &DeValue<'_>) -> String {
    match value {
        DeValue::String(text) => format!("\"{text}\""),
        DeValue::Integer(number) => number.to_string(),
        DeValue::Float(number) => number.to_string(),
        DeValue::Boolean(value) => value.to_string(),
        DeValue::Datetime(value) => value.to_string(),
        DeValue::Array(_) => "an array".to_owned(),
        DeValue::Table(_) => "a table".to_owned(),
    }
}

fn number(value: &DeValue<'_>) -> Option<f64> {
    let text = match value {
        DeValue::Integer(number) if number.radix() == 10 => number.as_str(),
        DeValue::Float(number) => number.as_str(),
        _ => return None,
    };
    text.replace('_', "").parse().ok()
}

impl<'a> Section<'a> {
    pub fn new(document: Document<'a>, name: String, span: Range<usize>, table: &'a DeTable<'a>) -> Self {
        Self { document, name, span, table }
    }

    /// Refuses keys that nobody reads.
    pub fn only(&self, known: &[&str]) -> Result<(), ExperimentError> {
        for key in self.table.keys() {
            if !known.contains(&key.get_ref().as_ref()) {
                let problem = Problem::UnknownKey {
                    key: key.get_ref().to_string(),
                    table: self.name.clone(),
                    nearest: keys::nearest(key.get_ref(), known).map(str::to_owned),
                    known: known.iter().map(|&k| k.to_owned()).collect(),
                };
                return Err(self.document.error(key.span(), problem));
            }
        }
        Ok(())
    }

    pub fn value(&self, key: &str) -> Option<&'a Spanned<DeValue<'a>>> {
        self.table.get(key)
    }

    pub fn keys(&self) -> impl Iterator<Item = &'a Spanned<std::borrow::Cow<'a, str>>> {
        self.table.keys()
    }

    pub fn missing(&self, key: &str, expected: &str) -> ExperimentError {
        let problem =
            Problem::MissingKey { key: key.to_owned(), table: self.name.clone(), expected: expected.to_owned() };
        self.document.error(self.span.clone(), problem)
    }

    pub fn bad(&self, key: &str, value: &Spanned<DeValue<'a>>, expected: &str) -> ExperimentError {
        let problem =
            Problem::BadValue { key: key.to_owned(), found: shown(value.get_ref()), expected: expected.to_owned() };
        self.document.error(value.span(), problem)
    }

    pub fn text(&self, key: &str, expected: &str) -> Result<Option<&'a str>, ExperimentError> {
        match self.value(key) {
            None => Ok(None),
            Some(value) => match value.get_ref() {
                DeValue::String(text) => Ok(Some(text)),
                _ => Err(self.bad(key, value, expected)),
            },
        }
    }

    /// One of a few words.
    pub fn word<T: Copy>(&self, key: &str, words: &[(&str, T)]) -> Result<Option<T>, ExperimentError> {
        let Some(value) = self.value(key) else {
            return Ok(None);
        };
        if let DeValue::String(text) = value.get_ref()
            && let Some((_, meaning)) = words.iter().find(|(word, _)| word == text)
        {
            return Ok(Some(*meaning));
        }
        let names: Vec<String> = words.iter().map(|(word, _)| format!("\"{word}\"")).collect();
        Err(self.bad(key, value, &format!("one of {}", names.join(", "))))
    }

    /// A finite number inside a closed range, described by `expected`.
    pub fn number(
        &self,
        key: &str,
        range: std::ops::RangeInclusive<f64>,
        expected: &str,
    ) -> Result<Option<f64>, ExperimentError> {
        let Some(value) = self.value(key) else {
            return Ok(None);
        };
        match number(value.get_ref()) {
            Some(found) if range.contains(&found) => Ok(Some(found)),
            _ => Err(self.bad(key, value, expected)),
        }
    }

    /// The finite number that a value is.
    pub fn finite(value: &Spanned<DeValue<'_>>) -> Option<f64> {
        number(value.get_ref()).filter(|found| found.is_finite())
    }

    /// A list of finite numbers.
    pub fn numbers(&self, key: &str, expected: &str) -> Result<Option<Vec<f64>>, ExperimentError> {
        let Some(value) = self.value(key) else {
            return Ok(None);
        };
        let DeValue::Array(items) = value.get_ref() else {
            return Err(self.bad(key, value, expected));
        };
        let found = |item: &Spanned<DeValue<'a>>| Self::finite(item).ok_or_else(|| self.bad(key, item, expected));
        items.iter().map(found).collect::<Result<Vec<f64>, _>>().map(Some)
    }

    pub fn integer(
        &self,
        key: &str,
        range: std::ops::RangeInclusive<i64>,
        expected: &str,
    ) -> Result<Option<i64>, ExperimentError> {
        let Some(value) = self.value(key) else {
            return Ok(None);
        };
        let found = match value.get_ref() {
            DeValue::Integer(number) if number.radix() == 10 => number.as_str().replace('_', "").parse::<i64>().ok(),
            _ => None,
        };
        match found {
            Some(found) if range.contains(&found) => Ok(Some(found)),
            _ => Err(self.bad(key, value, expected)),
        }
    }

    pub fn flag(&self, key: &str) -> Result<Option<bool>, ExperimentError> {
        match self.value(key) {
            None => Ok(None),
            Some(value) => match value.get_ref() {
                DeValue::Boolean(flag) => Ok(Some(*flag)),
                _ => Err(self.bad(key, value, "true or false")),
            },
        }
    }

    /// The table under `key`, if there is one.
    pub fn section(&self, key: &str, name: String) -> Result<Option<Section<'a>>, ExperimentError> {
        match self.value(key) {
            None => Ok(None),
            Some(value) => match value.get_ref() {
                DeValue::Table(table) => Ok(Some(Section::new(self.document, name, value.span(), table))),
                _ => Err(self.bad(key, value, "a table")),
            },
        }
    }

    /// The named tables under `key`: `[specimen.eva]`, `[specimen.b1]`.
    pub fn named(&self, key: &str) -> Result<Vec<(String, Section<'a>)>, ExperimentError> {
        let Some(all) = self.section(key, format!("[{key}]"))? else {
            return Ok(Vec::new());
        };
        let mut sections = Vec::new();
        for name in all.keys() {
            let name = name.get_ref().as_ref();
            if let Some(section) = all.section(name, format!("[{key}.{name}]"))? {
                sections.push((name.to_owned(), section));
            }
        }
        Ok(sections)
    }

    /// The tables of an array of tables: every `[[run]]`.
    pub fn array(&self, key: &str) -> Result<Vec<Section<'a>>, ExperimentError> {
        let Some(value) = self.value(key) else {
            return Ok(Vec::new());
        };
        let DeValue::Array(items) = value.get_ref() else {
            return Err(self.bad(key, value, &format!("an array of tables [[{key}]]")));
        };
        let mut sections = Vec::new();
        for item in items.iter() {
            let DeValue::Table(table) = item.get_ref() else {
                return Err(self.bad(key, item, &format!("a table [[{key}]]")));
            };
            sections.push(Section::new(self.document, format!("[[{key}]]"), item.span(), table));
        }
        Ok(sections)
    }
}
