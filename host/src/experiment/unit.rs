//! Units as laboratories write them, to mm, N and s.

/// Quantities that a run is made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Quantity {
    Time,
    Depth,
    Force,
}

/// What a unit measures, and its factor to mm, N or s.
pub(crate) fn unit(text: &str) -> Option<(Quantity, f64)> {
    const GRAVITY: f64 = 9.806_65e-3;
    let plain = text.trim().trim_matches(['(', ')', '[', ']', '<', '>']).trim().replace(['μ', 'µ'], "u");
    let lower = plain.to_lowercase();
    let length = |mm| Some((Quantity::Depth, mm));
    let force = |newton| Some((Quantity::Force, newton));
    let time = |s| Some((Quantity::Time, s));
    match lower.as_str() {
        // mN and MN differ by nine orders.
        "mn" => force(if plain.starts_with('M') { 1e6 } else { 1e-3 }),
        "n" | "newton" => force(1.0),
        "un" => force(1e-6),
        "kn" => force(1e3),
        "gf" | "g" | "gram" | "grams" => force(GRAVITY),
        "kgf" | "kg" | "kp" => force(1e3 * GRAVITY),
        "lbf" | "lb" | "lbs" => force(4.448_221_615),
        "cn" => force(1e-2),
        "mm" | "millimeter" | "millimetre" => length(1.0),
        "um" | "micron" | "microns" => length(1e-3),
        // Nm is a moment.
        "nm" if plain.starts_with('n') => length(1e-6),
        "m" => length(1e3),
        "cm" => length(10.0),
        "in" | "inch" => length(25.4),
        "mil" => length(0.0254),
        "s" | "sec" | "secs" | "second" | "seconds" | "sek" | "sekunden" => time(1.0),
        "ms" | "msec" => time(1e-3),
        "us" => time(1e-6),
        "min" => time(60.0),
        "h" | "hr" => time(3600.0),
        _ => None,
    }
}

/// A unit, in brackets or one that laboratories use.
pub(crate) fn is_unit(cell: &str) -> bool {
    const UNITS: [&str; 24] = [
        "s", "sec", "ms", "min", "h", "mm", "um", "µm", "μm", "cm", "m", "in", "n", "mn", "kn", "gf", "g", "kgf",
        "lbf", "%", "mpa", "kpa", "-", "v",
    ];
    let bare = cell.strip_prefix(['(', '[']).and_then(|inner| inner.strip_suffix([')', ']']));
    bare.is_some_and(|inner| inner.len() <= 12 && !inner.is_empty()) || UNITS.contains(&cell.to_lowercase().as_str())
}

/// The name of a column without its unit, and the unit: `Weg [mm]`, "Kraft / N", "Force (mN)", "extension_mm", "Zeit in s".
pub(crate) fn parted(name: &str) -> (String, Option<String>) {
    let name = name.trim();
    for (open, close) in [('(', ')'), ('[', ']'), ('<', '>')] {
        if let Some(at) = name.rfind(open)
            && let Some(length) = name[at + 1..].find(close)
        {
            return (name[..at].trim().to_owned(), Some(name[at + 1..at + 1 + length].trim().to_owned()));
        }
    }
    for mark in ["/", " in ", ",", "_", " "] {
        if let Some((bare, tail)) = name.rsplit_once(mark)
            && !bare.trim().is_empty()
            && unit(tail).is_some()
        {
            return (bare.trim().to_owned(), Some(tail.trim().to_owned()));
        }
    }
    (name.to_owned(), None)
}

/// What a column of this bare name measures, and how surely: 0 is the contract's own name, 3 a guess.
pub(crate) fn named(name: &str, bare: &str) -> Option<(Quantity, u8)> {
    match name.trim() {
        "time_s" => return Some((Quantity::Time, 0)),
        "depth_mm" => return Some((Quantity::Depth, 0)),
        "force_N" => return Some((Quantity::Force, 0)),
        _ => {}
    }
    let lower = bare.to_lowercase();
    let words: Vec<&str> = lower.split(|c: char| !c.is_alphanumeric()).filter(|w| !w.is_empty()).collect();
    let has = |list: &[&str]| list.iter().any(|part| lower.contains(part));
    let is = |list: &[&str]| words.iter().any(|word| list.contains(word));
    let other = [
        "strain",
        "stress",
        "dehnung",
        "spannung",
        "speed",
        "veloc",
        "geschwind",
        "torque",
        "moment",
        "temperat",
        "volt",
        "energy",
        "arbeit",
        "cycle",
        "zyklus",
        "pressure",
        "strom",
        "current",
    ];
    if has(&other) {
        return None;
    }
    if has(&["force", "kraft"]) {
        return Some((Quantity::Force, 1));
    }
    if is(&["load", "last", "fz", "fn", "loadcell", "weight", "gewicht"]) || lower == "f" {
        return Some((Quantity::Force, 2));
    }
    if has(&["time", "zeit", "elapsed", "sekunde"]) && !has(&["timeout"]) {
        return Some((Quantity::Time, 1));
    }
    if is(&["t", "seconds", "clock"]) {
        return Some((Quantity::Time, 2));
    }
    if has(&["depth", "tiefe", "eindring", "indentation", "penetration"]) {
        return Some((Quantity::Depth, 1));
    }
    if has(&[
        "displacement",
        "extension",
        "verschiebung",
        "stauchung",
        "deflection",
        "compression",
        "travel",
        "crosshead",
    ]) || has(&["traverse", "position", "verformung"])
        || is(&["weg", "disp", "pos", "stroke", "hub", "distance"])
    {
        return Some((Quantity::Depth, 2));
    }
    if has(&["weg", "gap", "spalt"]) || is(&["z", "x", "height"]) {
        return Some((Quantity::Depth, 3));
    }
    None
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn names_and_units_are_parted() {
        for (text, bare, found) in [
            ("Weg [mm]", "Weg", "mm"),
            ("Standardkraft / N", "Standardkraft", "N"),
            ("Normal force (N)", "Normal force", "N"),
            ("extension_mm", "extension", "mm"),
            ("Zeit in s", "Zeit", "s"),
            ("Gap (um)", "Gap", "um"),
        ] {
            assert_eq!(parted(text), (bare.to_owned(), Some(found.to_owned())), "{text}");
        }
        assert_eq!(parted("Load"), ("Load".to_owned(), None));
    }

    #[test]
    fn units_have_factors() {
        assert_eq!(unit("µm"), Some((Quantity::Depth, 1e-3)));
        assert_eq!(unit("(mN)"), Some((Quantity::Force, 1e-3)));
        assert_eq!(unit("MN"), Some((Quantity::Force, 1e6)));
        assert_eq!((unit("nm"), unit("Nm")), (Some((Quantity::Depth, 1e-6)), None));
        assert_eq!(unit("furlong"), None);
    }

    #[test]
    fn names_in_two_languages() {
        for (name, quantity) in [
            ("Zeit", Quantity::Time),
            ("Elapsed", Quantity::Time),
            ("Traversenweg", Quantity::Depth),
            ("Eindringtiefe", Quantity::Depth),
            ("Standardkraft", Quantity::Force),
            ("Fz", Quantity::Force),
            ("Load", Quantity::Force),
        ] {
            assert_eq!(named(name, name).unwrap().0, quantity, "{name}");
        }
        assert_eq!(named("Engineering Stress", "Engineering Stress"), None);
    }
}
