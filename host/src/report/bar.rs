//! A bar of the bands of a picture.

use std::fmt::Write;

use super::field::ramp;
use super::number;

/// Width of the bar, pixels.
const WIDTH: f64 = 18.0;

/// Place of a band on the colour ramp.
pub fn share(band: usize, bands: usize) -> f64 {
    band as f64 / (bands - 1).max(1) as f64
}

/// Draws the bands from the lower left `corner` up, `step` pixels each, with their lower limits; `heading` stands above, line
/// by line.
pub fn draw(svg: &mut String, (x, bottom): (f64, f64), step: f64, levels: &[f64], heading: &[&str]) {
    for (band, level) in levels.iter().enumerate() {
        let y = bottom - step * (band + 1) as f64;
        let colour = ramp(share(band, levels.len()));
        let _ = write!(
            svg,
            "<rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"{WIDTH}\" height=\"{step:.1}\" fill=\"{colour}\" stroke=\"#333\" stroke-width=\"0.5\"/><text x=\"{:.1}\" y=\"{:.1}\">{}</text>",
            x + WIDTH + 7.0,
            y + step + 4.0,
            number(*level)
        );
    }
    let top = bottom - step * levels.len() as f64;
    for (line, text) in heading.iter().rev().enumerate() {
        let _ = write!(svg, "<text x=\"{x:.1}\" y=\"{:.1}\">{text}</text>", top - 9.0 - 15.0 * line as f64);
    }
}
