//! Values of command lines.

/// The number behind a word.
///
/// # Errors
/// Text that is none, told with the word.
pub fn number<T: std::str::FromStr>(word: &str, value: &str) -> Result<T, String> {
    value.parse().map_err(|_| format!("{word} {value}: expected a whole number"))
}
