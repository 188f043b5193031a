//! Horizontal bars about zero with a band that they should stay in.

use std::fmt::Write;

use crate::report::escaped;
use crate::report::figure::{Axis, open};
use crate::report::scale::{Scale, number};

/// One bar.
#[derive(Debug, Clone, PartialEq)]
pub struct Bar {
    /// Written to its left.
    pub name: String,
    /// Its end.
    pub value: f64,
    /// A second value, drawn as a mark.
    pub mark: Option<f64>,
}

/// Bars under a heading.
#[derive(Debug, Clone, PartialEq)]
pub struct Group {
    /// Its heading.
    pub name: String,
    /// Its bars.
    pub bars: Vec<Bar>,
}

/// Groups of bars over one axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Bars {
    /// Above all.
    pub title: String,
    /// Quantity and unit.
    pub axis: String,
    /// What the mark is, if any bar has one.
    pub mark: Option<String>,
    /// Half width of the band about zero.
    pub threshold: f64,
    /// Groups, the first on top.
    pub groups: Vec<Group>,
}

const WIDTH_PX: f64 = 860.0;
const LEFT_PX: f64 = 230.0;
const RIGHT_PX: f64 = 80.0;
const TOP_PX: f64 = 56.0;
const BAR_PX: f64 = 17.0;
const HEAD_PX: f64 = 22.0;
/// The axis ends at most this many thresholds from zero, so that the band stays visible; longer bars are cut and say so.
const MOST: f64 = 12.0;

impl Bars {
    /// The picture as an `<svg>` element.
    #[must_use]
    pub fn svg(&self) -> String {
        let rows: usize = self.groups.iter().map(|g| g.bars.len()).sum();
        let floor = TOP_PX + HEAD_PX * self.groups.len() as f64 + BAR_PX * rows as f64 + 6.0;
        let mut svg = open(WIDTH_PX, floor + 46.0, &self.title);
        let values = self.groups.iter().flat_map(|g| &g.bars).flat_map(|b| [Some(b.value), b.mark]).flatten();
        let largest = values.filter(|v| v.is_finite()).map(f64::abs).fold(1.4 * self.threshold, f64::max);
        let reach = largest.min(MOST * self.threshold);
        let axis = Axis::new("").over(-1.05 * reach, 1.05 * reach);
        let x = Scale::fitting(&axis, std::iter::empty(), (LEFT_PX, WIDTH_PX - RIGHT_PX));
        self.ground(&mut svg, &x, floor);
        let mut y = TOP_PX;
        for group in &self.groups {
            let _ = write!(
                svg,
                "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\" font-weight=\"600\">{}</text>",
                LEFT_PX - 10.0,
                y + 16.0,
                escaped(&group.name)
            );
            y += HEAD_PX;
            for bar in &group.bars {
                self.bar(&mut svg, bar, &x, y, reach);
                y += BAR_PX;
            }
        }
        svg.push_str("</svg>\n");
        svg
    }

    /// Grid, the band, the axis, the legend.
    fn ground(&self, svg: &mut String, x: &Scale, floor: f64) {
        let (low, high) = (x.px(-self.threshold), x.px(self.threshold));
        let _ = write!(
            svg,
            "<rect x=\"{low:.1}\" y=\"{TOP_PX}\" width=\"{:.1}\" height=\"{:.1}\" fill=\"#ececec\"/>",
            high - low,
            floor - TOP_PX
        );
        for tick in x.ticks() {
            let at = x.px(tick);
            let colour = if tick == 0.0 { "#555" } else { "#dcdcdc" };
            let _ = write!(
                svg,
                "<path d=\"M{at:.1} {TOP_PX}V{floor:.1}\" stroke=\"{colour}\"/><text x=\"{at:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>",
                floor + 17.0,
                number(tick)
            );
        }
        for at in [low, high] {
            let _ = write!(
                svg,
                "<path d=\"M{at:.1} {TOP_PX}V{floor:.1}\" stroke=\"#15364f\" stroke-dasharray=\"5 3\"/>"
            );
        }
        let _ = write!(
            svg,
            "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\" fill=\"#15364f\">threshold {}</text><text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>",
            0.5 * (low + high),
            TOP_PX - 6.0,
            number((100.0 * self.threshold).round() / 100.0),
            0.5 * (x.low_px + x.high_px),
            floor + 36.0,
            escaped(&self.axis)
        );
        if let Some(mark) = &self.mark {
            let at = WIDTH_PX - 14.0 - 6.4 * mark.chars().count() as f64;
            diamond(svg, at - 10.0, 16.0);
            let _ = write!(svg, "<text x=\"{at:.1}\" y=\"20\">{}</text>", escaped(mark));
        }
    }

    fn bar(&self, svg: &mut String, bar: &Bar, x: &Scale, y: f64, reach: f64) {
        let middle = y + 0.5 * BAR_PX;
        let beyond = bar.value.abs() > self.threshold;
        let _ = write!(
            svg,
            "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>",
            LEFT_PX - 10.0,
            middle + 4.0,
            escaped(&bar.name)
        );
        if bar.value.is_finite() {
            let cut = bar.value.clamp(-reach, reach);
            let (from, to) = (x.px(0.0).min(x.px(cut)), x.px(0.0).max(x.px(cut)));
            let fill = if beyond { "#b4481e" } else { "#9fb0bc" };
            let _ = write!(
                svg,
                "<rect x=\"{from:.1}\" y=\"{:.1}\" width=\"{:.1}\" height=\"{:.1}\" fill=\"{fill}\"/>",
                y + 3.0,
                to - from,
                BAR_PX - 6.0
            );
            if cut != bar.value {
                // two white strokes where the bar is cut
                let end = x.px(cut) - 12.0 * cut.signum();
                for shift in [0.0, 5.0] {
                    let at = end - shift * cut.signum();
                    let _ = write!(svg, "<path d=\"M{:.1} {:.1}l-4 {BAR_PX}\" stroke=\"#fff\" stroke-width=\"2\"/>", at + 2.0, y);
                }
            }
        }
        let weight = if beyond { " font-weight=\"600\"" } else { "" };
        let _ = write!(
            svg,
            "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\"{weight}>{:+.1}</text>",
            WIDTH_PX - 20.0,
            middle + 4.0,
            if bar.value.is_finite() { bar.value } else { 0.0 }
        );
        if let Some(mark) = bar.mark.filter(|mark| mark.is_finite()) {
            diamond(svg, x.px(mark.clamp(-reach, reach)), middle);
        }
    }
}

fn diamond(svg: &mut String, x: f64, y: f64) {
    let _ = write!(
        svg,
        "<path d=\"M{x:.1} {:.1}l4.5 5l-4.5 5l-4.5 -5Z\" fill=\"#fff\" stroke=\"#15364f\" stroke-width=\"1.6\"/>",
        y - 5.0
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bars_far_beyond_the_band_are_cut_and_keep_their_number() {
        let bar = |value, mark| Bar { name: "a < b".to_owned(), value, mark };
        let bars = vec![bar(500.0, Some(1.0)), bar(f64::NAN, Some(f64::INFINITY)), bar(-1.0, None)];
        let groups = vec![Group { name: "depth".to_owned(), bars }, Group { name: "rate".to_owned(), bars: vec![] }];
        let mark = Some("after".to_owned());
        let svg = Bars { title: "t".to_owned(), axis: "x".to_owned(), mark, threshold: 3.5, groups }.svg();
        assert!(svg.contains("+500.0") && svg.contains("threshold 3.5") && svg.contains("a &lt; b"), "{svg}");
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
    }
}
