//! Heat strips: one line of cells a run, dark where a value is large, with its sign.

use std::fmt::Write;

use crate::report::escaped;
use crate::report::field::ramp;
use crate::report::figure::open;

/// One line of cells.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    /// Written to its left; empty for the same as above.
    pub name: String,
    /// Parts with a gap between them, the same number in every line.
    pub parts: Vec<Vec<f64>>,
}

/// Lines of cells with common parts.
#[derive(Debug, Clone, PartialEq)]
pub struct Heat {
    /// Above all.
    pub title: String,
    /// Heads of the parts with their share of the width.
    pub parts: Vec<(String, f64)>,
    /// Lines, the first on top.
    pub lines: Vec<Line>,
    /// Values from this on are drawn darkest.
    pub most: f64,
    /// Name of the value.
    pub unit: String,
}

const WIDTH_PX: f64 = 860.0;
const LEFT_PX: f64 = 150.0;
const RIGHT_PX: f64 = 20.0;
const TOP_PX: f64 = 52.0;
const GAP_PX: f64 = 12.0;
/// Lines are this high, and lower where there are many of them.
const LINE_PX: (f64, f64) = (13.0, 6.0);
/// Signs are written from this share of the darkest value on.
const SIGNED: f64 = 0.4;
const STEPS: usize = 6;

impl Heat {
    /// The picture as an `<svg>` element.
    #[must_use]
    pub fn svg(&self) -> String {
        let line_px = (520.0 / self.lines.len().max(1) as f64).clamp(LINE_PX.1, LINE_PX.0);
        let floor = TOP_PX + line_px * self.lines.len() as f64;
        let mut svg = open(WIDTH_PX, floor + 48.0, &self.title);
        let room = WIDTH_PX - LEFT_PX - RIGHT_PX - GAP_PX * (self.parts.len().max(1) - 1) as f64;
        let whole: f64 = self.parts.iter().map(|p| p.1).sum::<f64>().max(f64::MIN_POSITIVE);
        let mut left = LEFT_PX;
        for (at, (name, share)) in self.parts.iter().enumerate() {
            let width = room * share / whole;
            let _ = write!(svg, "<text x=\"{left:.1}\" y=\"{:.1}\">{}</text>", TOP_PX - 7.0, escaped(name));
            for (row, line) in self.lines.iter().enumerate() {
                let cells = line.parts.get(at).map_or(&[][..], Vec::as_slice);
                self.cells(&mut svg, cells, (left, TOP_PX + line_px * row as f64), (width, line_px));
            }
            left += width + GAP_PX;
        }
        for (row, line) in self.lines.iter().enumerate().filter(|(_, line)| !line.name.is_empty()) {
            let y = TOP_PX + line_px * row as f64;
            let _ = write!(
                svg,
                "<path d=\"M{:.1} {y:.1}H{:.1}\" stroke=\"#999\" stroke-width=\"0.6\"/><text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>",
                LEFT_PX - 8.0,
                WIDTH_PX - RIGHT_PX,
                LEFT_PX - 10.0,
                y + 10.5,
                escaped(&line.name)
            );
        }
        self.legend(&mut svg, floor + 16.0);
        svg.push_str("</svg>\n");
        svg
    }

    fn cells(&self, svg: &mut String, cells: &[f64], (left, top): (f64, f64), (width, height): (f64, f64)) {
        let each = width / cells.len().max(1) as f64;
        for (at, value) in cells.iter().enumerate().filter(|(_, v)| v.is_finite()) {
            let share = (value.abs() / self.most).min(1.0);
            let x = left + each * at as f64;
            let _ = write!(
                svg,
                "<rect x=\"{x:.1}\" y=\"{top:.1}\" width=\"{:.1}\" height=\"{:.1}\" fill=\"{}\"/>",
                each + 0.2,
                height - 0.8,
                ramp(share)
            );
            if share >= SIGNED && height > 8.0 {
                sign(svg, *value, (x + 0.5 * each, top + 0.5 * height), share);
            }
        }
    }

    fn legend(&self, svg: &mut String, y: f64) {
        for step in 0..=STEPS {
            let value = self.most * step as f64 / STEPS as f64;
            let x = LEFT_PX + 44.0 * step as f64;
            let _ = write!(
                svg,
                "<rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"42\" height=\"11\" fill=\"{}\" stroke=\"#999\" stroke-width=\"0.4\"/><text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\" font-size=\"11\">{}</text>",
                ramp(value / self.most),
                x + 21.0,
                y + 23.0,
                if step == STEPS { format!("{value:.0}+") } else { format!("{value:.0}") }
            );
        }
        let _ = write!(
            svg,
            "<text x=\"{:.1}\" y=\"{:.1}\">{}</text>",
            LEFT_PX + 44.0 * (STEPS + 1) as f64 + 10.0,
            y + 10.0,
            escaped(&self.unit)
        );
    }
}

/// A plus or a minus of strokes, which stays sharp at any size.
fn sign(svg: &mut String, value: f64, (x, y): (f64, f64), share: f64) {
    let ink = if share > 0.55 { "#fff" } else { "#222" };
    let upright = if value > 0.0 { format!("M{x:.1} {:.1}v5", y - 2.9) } else { String::new() };
    let _ = write!(svg, "<path d=\"M{:.1} {:.1}h5{upright}\" stroke=\"{ink}\" stroke-width=\"1\"/>", x - 2.5, y - 0.4);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn large_values_carry_their_sign_and_odd_ones_are_left_out() {
        let line = Line { name: "r4".to_owned(), parts: vec![vec![5.0, -5.0, 0.1, f64::NAN], vec![]] };
        let parts = vec![("loading".to_owned(), 2.0), ("hold".to_owned(), 1.0)];
        let heat = Heat { title: "t".to_owned(), parts, lines: vec![line], most: 6.0, unit: "sigma".to_owned() };
        let svg = heat.svg();
        // a plus has a second stroke
        assert_eq!((svg.matches("h5M").count(), svg.matches("h5\"").count()), (1, 1));
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
    }
}
