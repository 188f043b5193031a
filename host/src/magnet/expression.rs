//! Numbers of `magnet.toml` that depend on its parameters: `"gap / 2"`.

use std::collections::BTreeMap;
use std::ops::RangeInclusive;

use exmex::Express;
use toml::Spanned;
use toml::de::DeValue;

use crate::experiment::section::Section;
use crate::experiment::{ExperimentError, Problem};

/// Parameters of a magnet by their names.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Parameters(pub BTreeMap<String, f64>);

impl Parameters {
    /// The value of a formula of parameters and numbers.
    ///
    /// # Errors
    /// What is wrong with it, in a sentence.
    pub fn evaluate(&self, text: &str) -> Result<f64, String> {
        let formula = exmex::parse::<f64>(text).map_err(|cause| format!("no formula: {}", cause.msg()))?;
        let mut values = Vec::new();
        for name in formula.var_names() {
            let known = || {
                let known: Vec<&str> = self.0.keys().map(String::as_str).collect();
                let known = if known.is_empty() { "none".to_owned() } else { known.join(", ") };
                format!("a formula of `{name}`, which is no parameter (known: {known})")
            };
            values.push(*self.0.get(name).ok_or_else(known)?);
        }
        let value = formula.eval(&values).map_err(|cause| format!("no formula: {}", cause.msg()))?;
        if value.is_finite() { Ok(value) } else { Err(format!("a formula whose value is {value}")) }
    }

    fn of(
        &self,
        section: &Section<'_>,
        key: &str,
        value: &Spanned<DeValue<'_>>,
    ) -> Result<Option<f64>, ExperimentError> {
        let DeValue::String(text) = value.get_ref() else { return Ok(None) };
        self.evaluate(text).map(Some).map_err(|cause| {
            let text = format!("`{key}` is \"{text}\", {cause}");
            section.document.error(value.span(), Problem::Contradiction(text))
        })
    }

    /// A number in a closed range, or a formula for one.
    ///
    /// # Errors
    /// A value that is neither, or out of the range.
    pub(crate) fn number(
        &self,
        section: &Section<'_>,
        key: &str,
        range: RangeInclusive<f64>,
        expected: &str,
    ) -> Result<Option<f64>, ExperimentError> {
        let Some(value) = section.value(key) else { return Ok(None) };
        match self.of(section, key, value)? {
            None => section.number(key, range, expected),
            Some(number) if range.contains(&number) => Ok(Some(number)),
            Some(number) => {
                let text = format!("`{key}` is {number} by its formula; expected {expected}");
                Err(section.document.error(value.span(), Problem::Contradiction(text)))
            }
        }
    }

    /// A list of numbers and formulas.
    ///
    /// # Errors
    /// A value that is neither.
    pub(crate) fn numbers(
        &self,
        section: &Section<'_>,
        key: &str,
        expected: &str,
    ) -> Result<Option<Vec<f64>>, ExperimentError> {
        let Some(value) = section.value(key) else { return Ok(None) };
        let DeValue::Array(items) = value.get_ref() else { return Err(section.bad(key, value, expected)) };
        let mut list = Vec::new();
        for item in items.iter() {
            list.push(match self.of(section, key, item)? {
                Some(number) => number,
                None => Section::finite(item).ok_or_else(|| section.bad(key, item, expected))?,
            });
        }
        Ok(Some(list))
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn formulas_are_evaluated_or_refused_in_a_sentence() {
        let parameters = Parameters([("gap".to_owned(), 10.0), ("wall".to_owned(), 2.0)].into());
        assert_eq!(parameters.evaluate("-gap / 2 - wall"), Ok(-7.0));
        assert_eq!(parameters.evaluate("3.5"), Ok(3.5));
        assert!(parameters.evaluate("gapp/2").unwrap_err().contains("no parameter (known: gap, wall)"));
        assert!(parameters.evaluate("gap +").unwrap_err().starts_with("no formula"));
        assert!(parameters.evaluate("gap / (wall - 2)").unwrap_err().contains("whose value is inf"));
    }
}
