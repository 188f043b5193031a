//! Options that are numbers.

use std::ops::RangeInclusive;

use miette::miette;

/// Refuses an option outside its range; `unit` is that of the range, empty for none.
pub(super) fn within(option: &str, value: f64, range: RangeInclusive<f64>, unit: &str) -> miette::Result<()> {
    if range.contains(&value) {
        return Ok(());
    }
    let (least, most) = (range.start(), range.end());
    let expected = format!("{least} to {most} {unit}");
    Err(miette!("{option} is {value}; expected {}", expected.trim_end()))
}
