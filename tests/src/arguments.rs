//! Values of command lines.

/// The number behind a word.
///
/// # Errors
/// Text that is none, told with the word.
pub fn number<T: std::str::FromStr>(word: &str, value: &str) -> Result<T, String> {
    value.parse().map_err(|_| format!("{word} {value}: expected a whole number"))
}

/// Number of cases and the first seed: `--cases` and `--seed`, those given unless stated.
///
/// # Errors
/// Another word, or a value that is no number.
pub fn cases_and_seed(mut words: impl Iterator<Item = String>, unless: (usize, u64)) -> Result<(usize, u64), String> {
    let (mut cases, mut first) = unless;
    while let Some(word) = words.next() {
        let mut value = || words.next().ok_or_else(|| format!("{word} needs a value"));
        match word.as_str() {
            "--cases" => cases = number(&word, &value()?)?,
            "--seed" => first = number(&word, &value()?)?,
            _ => return Err(format!("{word}: expected --cases or --seed")),
        }
    }
    Ok((cases, first))
}
