//! A track as pictures: the still frame (Fig. 60b), the tip's height over time (Fig. 63), its uncertainty.

use std::fmt::Write;

use super::escaped;
use super::figure::{Axis, Figure, Series, Stroke, open};
use crate::track::{Frame, Measure, Position, Roi, Tip};

/// Widest still, pixels of the page.
const WIDEST: f64 = 720.0;
/// Room above it for its title, pixels.
const HEAD: f64 = 34.0;

/// Seconds, or frames where there is no rate.
fn time(positions: &[Position]) -> (&'static str, impl Fn(&Position) -> f64) {
    let timed = positions.iter().all(|position| position.time_s.is_some());
    let at = move |position: &Position| match position.time_s {
        Some(time) if timed => time,
        _ => position.frame as f64,
    };
    (if timed { "time (s)" } else { "frame" }, at)
}

/// A quantity of the tip over time; lost frames break the line.
fn over_time(positions: &[Position], of: impl Fn(&Tip) -> f64) -> Vec<(f64, f64)> {
    let (_, at) = time(positions);
    positions.iter().map(|p| (at(p), p.tip.as_ref().map_or(f64::NAN, &of))).collect()
}

/// Height over the surface, or over the first place, with an encoder's beside it (time, height in mm).
pub fn height(measure: &Measure, positions: &[Position], encoder: Option<&[[f64; 2]]>) -> Figure {
    let (axis, at) = time(positions);
    let Some(first) = positions.iter().find_map(|position| position.tip) else {
        return Figure::new("Height of the tip", Axis::new(axis), Axis::new("height"));
    };
    let unit = measure.unit();
    let over = if measure.surface_px.is_some() { "over the surface" } else { "over its first place" };
    let label = format!("height {over} ({unit})");
    let points = over_time(positions, |tip| measure.height(&first, tip));
    let ends = [positions.first(), positions.last()].map(|position| position.map_or(0.0, &at));
    let mut figure = Figure::new("Height of the tip", Axis::new(axis), Axis::new(&label));
    if let Some(encoder) = encoder {
        let rows = encoder.iter().filter(|row| row[0] >= ends[0] && row[0] <= ends[1]);
        figure = figure.with(Series::new("encoder", rows.map(|row| (row[0], row[1])).collect(), Stroke::Dashed, 1));
    }
    if measure.surface_px.is_some() {
        let level = ends.map(|end| (end, 0.0)).to_vec();
        figure = figure.with(Series::new("surface", level, Stroke::Dotted, 3));
    }
    figure.with(Series::new("camera", points, Stroke::Solid, 0))
}

/// Place across the frame over time.
pub fn across(measure: &Measure, positions: &[Position]) -> Figure {
    let scale = measure.scale.map_or(1.0, |scale| scale.mm_per_px);
    let label = format!("across ({})", measure.unit());
    let points = over_time(positions, |tip| scale * tip.place_px[0]);
    let title = "Place of the tip across the frame";
    Figure::new(title, Axis::new(time(positions).0), Axis::new(&label)).with(Series::new("", points, Stroke::Solid, 0))
}

/// Standard deviations over time, without the first frame's.
pub fn uncertainty(positions: &[Position]) -> Figure {
    let rest = positions.get(1..).unwrap_or(&[]);
    let axis = Axis::new("standard deviation (px)");
    let mut figure = Figure::new("Uncertainty of the place", Axis::new(time(positions).0), axis);
    for (axis, (name, stroke)) in [("across", Stroke::Solid), ("up, down", Stroke::Dashed)].into_iter().enumerate() {
        let points = over_time(rest, |tip| tip.sigma_px[axis]);
        figure = figure.with(Series::new(name, points, stroke, axis));
    }
    figure
}

/// Correlation and what is seen, over time.
pub fn likeness(positions: &[Position]) -> Figure {
    let axis = Axis::new("part of 1").over(0.0, 1.05);
    Figure::new("Likeness with the first frame", Axis::new(time(positions).0), axis)
        .with(Series::new("correlation", over_time(positions, |tip| tip.correlation), Stroke::Solid, 0))
        .with(Series::new("seen", over_time(positions, |tip| tip.seen), Stroke::Dashed, 1))
}

/// The first frame with the region, the path of the tip and the surface.
pub fn still(frame: &Frame, roi: Roi, measure: &Measure, positions: &[Position]) -> String {
    let (width, height) = (frame.width as f64, frame.height as f64);
    let zoom = (WIDEST / width).min(WIDEST / height).min(4.0);
    let title = "The first frame, its region and the tip's path";
    let mut svg = open(width * zoom, height * zoom + HEAD, title);
    let picture = png(frame).map_or_else(String::new, |bytes| {
        format!("<image width=\"{width}\" height=\"{height}\" href=\"data:image/png;base64,{}\"/>", base64(&bytes))
    });
    // A pixel's middle has whole coordinates, its picture begins half a pixel before.
    let _ = write!(
        svg,
        "<svg y=\"{HEAD}\" width=\"{:.1}\" height=\"{:.1}\" viewBox=\"0 0 {width} {height}\">{picture}<g transform=\"translate(0.5 0.5)\" fill=\"none\">",
        width * zoom,
        height * zoom
    );
    let line = 1.6 / zoom;
    if let Some(surface) = measure.surface_px {
        let _ = write!(
            svg,
            "<path d=\"M0 {surface:.2}H{width}\" stroke=\"#2f6fde\" stroke-width=\"{line:.3}\" stroke-dasharray=\"{line:.3} {:.3}\"/>",
            2.0 * line
        );
    }
    let mut path = String::new();
    let mut pen_down = false;
    for tip in positions.iter().map(|position| position.tip) {
        match tip {
            Some(tip) => {
                let letter = if pen_down { 'L' } else { 'M' };
                let _ = write!(path, "{letter}{:.2} {:.2}", tip.place_px[0], tip.place_px[1]);
                pen_down = true;
            }
            None => pen_down = false,
        }
    }
    let _ = write!(svg, "<path d=\"{path}\" stroke=\"#e0591b\" stroke-width=\"{line:.3}\"/>");
    let _ = write!(
        svg,
        "<rect x=\"{:.1}\" y=\"{:.1}\" width=\"{}\" height=\"{}\" stroke=\"#16a34a\" stroke-width=\"{:.3}\"/>",
        roi.x as f64 - 0.5,
        roi.y as f64 - 0.5,
        roi.width,
        roi.height,
        1.5 * line
    );
    if let Some(tip) = positions.first().and_then(|position| position.tip) {
        let ([x, y], arm) = (tip.place_px, 5.0 / zoom);
        let _ = write!(
            svg,
            "<path d=\"M{:.2} {y:.2}h{:.2}M{x:.2} {:.2}v{:.2}\" stroke=\"#16a34a\" stroke-width=\"{line:.3}\"/>",
            x - arm,
            2.0 * arm,
            y - arm,
            2.0 * arm
        );
    }
    let _ = write!(svg, "</g><desc>{}</desc></svg></svg>", escaped(&format!("region {roi}")));
    svg.push('\n');
    svg
}

/// A frame as a PNG file of 8 bits.
fn png(frame: &Frame) -> Option<Vec<u8>> {
    let mut bytes = Vec::new();
    let (width, height) = (u32::try_from(frame.width).ok()?, u32::try_from(frame.height).ok()?);
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(png::BitDepth::Eight);
    let grey: Vec<u8> = frame.pixels.iter().map(|value| (255.0 * value).round().clamp(0.0, 255.0) as u8).collect();
    let mut writer = encoder.write_header().ok()?;
    writer.write_image_data(&grey).ok()?;
    writer.finish().ok()?;
    Some(bytes)
}

/// RFC 4648, section 4.
fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for three in bytes.chunks(3) {
        let word = three.iter().fold(0_u32, |word, byte| word << 8 | u32::from(*byte)) << (8 * (3 - three.len()));
        for place in 0..4 {
            let letter = LETTERS[(word >> (18 - 6 * place) & 63) as usize];
            text.push(if place <= three.len() { char::from(letter) } else { '=' });
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_is_that_of_the_standard() {
        // RFC 4648, section 10
        let cases = [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foobar", "Zm9vYmFy")];
        for (plain, coded) in cases {
            assert_eq!(base64(plain.as_bytes()), coded);
        }
    }
}
