//! Flux density over current that was read with a Gauss meter, in place of a drawing.

use std::path::Path;

use lut_gen::magnet::curve::{Built, FluxCurve};

use crate::experiment::{ExperimentError, text_of};

/// Table 6 of the thesis: what was measured at the centre of its fluid.
const TABLE_6: &str = include_str!("../../magnets/table-6.csv");

/// The name of the thesis' readings where a magnet is asked for.
pub const TABLE_6_NAME: &str = "table-6";

/// Columns that hold a flux density, and tesla in one of their units.
const FLUX: [(&str, f64); 3] = [("flux_T", 1.0), ("flux_mT", 1e-3), ("flux_G", 1e-4)];

/// Why readings are no magnet.
#[derive(Debug, thiserror::Error)]
pub enum Unmeasured {
    /// The operating system refused to read the file.
    #[error(transparent)]
    File(#[from] ExperimentError),
    /// A line that breaks a rule.
    #[error("{file}, line {line}: \"{value}\"; expected {expected}")]
    Line {
        /// The file.
        file: String,
        /// Line, from 1.
        line: usize,
        /// What stands there.
        value: String,
        /// What was expected.
        expected: &'static str,
    },
    /// The whole.
    #[error("{file}: {found}; expected {expected}")]
    Whole {
        /// The file.
        file: String,
        /// What was found.
        found: String,
        /// What was expected.
        expected: &'static str,
    },
}

/// Readings by the name of their file, or [`TABLE_6_NAME`]; `None` for what is neither a `.csv` file nor that.
///
/// # Errors
/// [`Unmeasured`].
pub fn located(asked: &str) -> Result<Option<FluxCurve>, Unmeasured> {
    let file = Path::new(asked);
    if file.extension().is_some_and(|end| end.eq_ignore_ascii_case("csv")) {
        return parse(asked, &text_of(file)?).map(Some);
    }
    if asked == TABLE_6_NAME && !file.exists() {
        return parse(asked, TABLE_6).map(Some);
    }
    Ok(None)
}

/// Columns `current_A` and `flux_T`, `flux_mT` or `flux_G`, one reading a line, of rising current. Without a reading at
/// no current none is assumed: no remanence.
///
/// # Errors
/// [`Unmeasured`]: the first mistake, with its line.
pub fn parse(file: &str, text: &str) -> Result<FluxCurve, Unmeasured> {
    let wrong = |line: usize, value: &str, expected| Unmeasured::Line {
        file: file.to_owned(),
        line,
        value: value.to_owned(),
        expected,
    };
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut lines = text.lines().enumerate().map(|(i, line)| (i + 1, line.trim()));
    let mut lines = lines.by_ref().filter(|(_, line)| !line.is_empty() && !line.starts_with('#'));
    let expected = "columns current_A and flux_T, flux_mT or flux_G";
    let empty = || Unmeasured::Whole { file: file.to_owned(), found: "nothing".to_owned(), expected };
    let (head_line, head) = lines.next().ok_or_else(empty)?;
    let names: Vec<&str> = head.split(',').map(str::trim).collect();
    let current = names.iter().position(|name| *name == "current_A");
    let flux = FLUX.iter().find_map(|(name, tesla)| Some((names.iter().position(|own| own == name)?, *tesla)));
    let (Some(current), Some((flux, tesla))) = (current, flux) else {
        return Err(wrong(head_line, head, expected));
    };
    let mut points = Vec::<(f64, f64)>::new();
    for (line, content) in lines {
        let cells: Vec<&str> = content.split(',').map(str::trim).collect();
        let number = |at: usize| cells.get(at).and_then(|cell| cell.parse::<f64>().ok()).filter(|n| n.is_finite());
        let read = number(current).zip(number(flux)).filter(|(a, b)| *a >= 0.0 && *b >= 0.0);
        let (ampere, read) = read.ok_or_else(|| wrong(line, content, "a current and a flux density, 0 or more"))?;
        let flux_t = tesla * read;
        if points.last().is_some_and(|last| ampere <= last.0 || flux_t <= last.1) {
            return Err(wrong(line, content, "current and flux density above those of the line before"));
        }
        points.push((ampere, flux_t));
    }
    let remanence_t = points.first().filter(|first| first.0 == 0.0).map_or(0.0, |first| first.1);
    points.iter_mut().for_each(|point| point.1 -= remanence_t);
    if points.first().is_some_and(|first| first.0 > 0.0) {
        points.insert(0, (0.0, 0.0));
    }
    let found = format!("{} readings", points.len());
    FluxCurve::new(&points, 0.0, Built { remanence_t, ..Built::default() }).map_err(|_| Unmeasured::Whole {
        file: file.to_owned(),
        found,
        expected: "one or more at rising current and flux density",
    })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn the_thesis_readings_are_a_curve() {
        let curve = located(TABLE_6_NAME).unwrap().unwrap();
        for (ampere, gauss) in [(0.0, 0.0), (1.5, 593.0), (2.0, 744.0), (2.5, 831.0)] {
            assert!((curve.flux_t(ampere) - 1e-4 * gauss).abs() < 1e-12, "{ampere} A");
        }
        assert_eq!(curve.most_a(), 2.5);
        // 629 G at 1.75 A lie below the curve of the others by 40 G: readings scatter
        assert!(curve.bound_t() > 2e-3, "{}", curve.bound_t());
        assert!(located("ring").unwrap().is_none());
    }

    #[test]
    fn units_and_remanence_are_read() {
        let curve = parse("m.csv", "flux_mT,current_A\n# a remark\n5,0\n25,1\n40,2\n").unwrap();
        assert!((curve.flux_t(0.0) - 5e-3).abs() < 1e-15 && (curve.flux_t(1.0) - 25e-3).abs() < 1e-15);
    }

    #[test]
    fn mistakes_are_told_with_their_line() {
        for (text, expected) in [
            ("", "m.csv: nothing; expected columns current_A and flux_T, flux_mT or flux_G"),
            ("I,B\n1,2\n", "m.csv, line 1: \"I,B\"; expected columns current_A and flux_T, flux_mT or flux_G"),
            ("current_A,flux_T\n1,x\n", "m.csv, line 2: \"1,x\"; expected a current and a flux density, 0 or more"),
            ("current_A,flux_T\n1\n", "m.csv, line 2: \"1\"; expected a current and a flux density, 0 or more"),
            (
                "current_A,flux_T\n1,0.1\n2,0.1\n",
                "m.csv, line 3: \"2,0.1\"; expected current and flux density above those of the line before",
            ),
            ("current_A,flux_T\n", "m.csv: 0 readings; expected one or more at rising current and flux density"),
        ] {
            assert_eq!(parse("m.csv", text).unwrap_err().to_string(), expected);
        }
    }
}
