//! Units as they stand in a row under the header.

/// A unit, in brackets or one that laboratories use.
pub(crate) fn is_unit(cell: &str) -> bool {
    const UNITS: [&str; 24] = [
        "s", "sec", "ms", "min", "h", "mm", "um", "µm", "μm", "cm", "m", "in", "n", "mn", "kn", "gf", "g", "kgf",
        "lbf", "%", "mpa", "kpa", "-", "v",
    ];
    let bare = cell.strip_prefix(['(', '[']).and_then(|inner| inner.strip_suffix([')', ']']));
    bare.is_some_and(|inner| inner.len() <= 12 && !inner.is_empty()) || UNITS.contains(&cell.to_lowercase().as_str())
}
