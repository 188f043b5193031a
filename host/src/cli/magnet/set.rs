//! Parameters of a magnet's file with other values: `--set gap=8`.

use std::collections::BTreeMap;

use miette::miette;

/// `gap=8`, by names.
pub(super) fn set(list: &[String]) -> miette::Result<BTreeMap<String, f64>> {
    let one = |text: &String| {
        let pair = text.split_once('=').and_then(|(name, value)| Some((name, value.trim().parse::<f64>().ok()?)));
        let (name, value) = pair
            .filter(|(_, value)| value.is_finite())
            .ok_or_else(|| miette!("--set is {text}; expected a parameter and a number, such as gap=8"))?;
        Ok((name.trim().to_owned(), value))
    };
    list.iter().map(one).collect()
}
