//! Small multiples: rows of plots with one axis a row, curves over bands.

use std::fmt::Write;

use crate::report::escaped;
use crate::report::figure::{Axis, Series, Stroke, draw, open};
use crate::report::scale::{Scale, number};

/// A region between two curves.
#[derive(Debug, Clone, PartialEq)]
pub struct Band {
    /// x, low, high.
    pub points: Vec<(f64, f64, f64)>,
    /// Index into the greys, light first.
    pub shade: usize,
}

/// One plot.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Panel {
    /// Above it; empty for none.
    pub title: String,
    /// Behind the curves, the first at the back.
    pub bands: Vec<Band>,
    /// Curves; their labels are not drawn.
    pub series: Vec<Series>,
}

/// Plots beside each other with a common vertical axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// Quantity and unit.
    pub label: String,
    /// Height of the plots, pixels.
    pub height_px: f64,
    /// The plots.
    pub panels: Vec<Panel>,
}

/// One entry of the legend.
#[derive(Debug, Clone, PartialEq)]
pub enum Key {
    /// A curve: text, stroke, colour.
    Curve(String, Stroke, usize),
    /// A band: text, shade.
    Band(String, usize),
}

/// Rows of plots with a common horizontal axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    /// Above all.
    pub title: String,
    /// Quantity and unit.
    pub across: String,
    /// Rows, the first on top.
    pub rows: Vec<Row>,
    /// What the curves are.
    pub keys: Vec<Key>,
}

/// Greys that a curve stays visible on.
const SHADES: [&str; 2] = ["#e9e9e9", "#cdd5dc"];
const WIDTH_PX: f64 = 940.0;
const LEFT_PX: f64 = 62.0;
const GAP_PX: f64 = 20.0;
const TOP_PX: f64 = 58.0;
const TITLE_PX: f64 = 20.0;
/// Room under a row that carries the labels of the horizontal axis, and under one that does not.
const UNDER_PX: (f64, f64) = (44.0, 10.0);
const LETTER_PX: f64 = 6.4;
/// Least distance of ticks on the upright axes: the plots are low.
const TICK_PX: f64 = 24.0;

impl Grid {
    /// The picture as an `<svg>` element.
    #[must_use]
    pub fn svg(&self) -> String {
        let columns = self.rows.iter().map(|row| row.panels.len()).max().unwrap_or(0).max(1);
        let width = ((WIDTH_PX - LEFT_PX - 10.0) / columns as f64 - GAP_PX).min(420.0);
        let titled = |row: &Row| if row.panels.iter().any(|p| !p.title.is_empty()) { TITLE_PX } else { 0.0 };
        let under = |at: usize| if at + 1 == self.rows.len() { UNDER_PX.0 } else { UNDER_PX.1 };
        let tall: f64 = self.rows.iter().enumerate().map(|(at, row)| titled(row) + row.height_px + under(at)).sum();
        let mut svg = open(WIDTH_PX, TOP_PX + tall, &self.title);
        self.legend(&mut svg);
        let across = extent(self.rows.iter().flat_map(|row| &row.panels).flat_map(|p| &p.series).map(|s| &s.points));
        let mut y = TOP_PX;
        for (at, row) in self.rows.iter().enumerate() {
            y += titled(row);
            let last = at + 1 == self.rows.len();
            for (column, panel) in row.panels.iter().enumerate() {
                let left = LEFT_PX + column as f64 * (width + GAP_PX);
                let x = Scale::fitting(&across, std::iter::empty(), (left, left + width));
                let up = Scale::fitting(&Axis::new(""), row.values(), (y + row.height_px, y));
                plot(
                    &mut svg,
                    panel,
                    (&x, &up),
                    (column == 0).then_some(row.label.as_str()),
                    last.then_some(self.across.as_str()),
                );
            }
            y += row.height_px + under(at);
        }
        svg.push_str("</svg>\n");
        svg
    }

    fn legend(&self, svg: &mut String) {
        let mut x = LEFT_PX;
        let y = 38.0;
        for key in &self.keys {
            let text = match key {
                Key::Curve(text, stroke, colour) => {
                    let ends = match stroke {
                        Stroke::Circles | Stroke::Marks | Stroke::Dots => {
                            vec![(x + 6.0, y), (x + 15.0, y), (x + 24.0, y)]
                        }
                        _ => vec![(x, y), (x + 30.0, y)],
                    };
                    sample(svg, &Series::new("", ends, *stroke, *colour));
                    text
                }
                Key::Band(text, shade) => {
                    let _ = write!(
                        svg,
                        "<rect x=\"{x:.1}\" y=\"{:.1}\" width=\"30\" height=\"12\" fill=\"{}\" stroke=\"#999\" stroke-width=\"0.5\"/>",
                        y - 6.0,
                        SHADES[shade % SHADES.len()]
                    );
                    text
                }
            };
            let _ = write!(svg, "<text x=\"{:.1}\" y=\"{:.1}\">{}</text>", x + 36.0, y + 4.0, escaped(text));
            x += 36.0 + LETTER_PX * text.chars().count() as f64 + 18.0;
        }
    }
}

impl Row {
    /// Everything that must fit into its vertical axis.
    fn values(&self) -> impl Iterator<Item = f64> + '_ {
        let curves = self.panels.iter().flat_map(|p| &p.series).flat_map(|s| s.points.iter().map(|p| p.1));
        let bands = self.panels.iter().flat_map(|p| &p.bands).flat_map(|b| b.points.iter().flat_map(|p| [p.1, p.2]));
        curves.chain(bands)
    }
}

/// A legend's piece of a curve, in pixels.
fn sample(svg: &mut String, series: &Series) {
    let pixels = Axis::new("").over(0.0, WIDTH_PX);
    let same = Scale::fitting(&pixels, std::iter::empty(), (0.0, WIDTH_PX));
    draw(svg, series, &same, &same);
}

/// Common range of some curves, with its ends exactly at theirs.
fn extent<'a>(curves: impl Iterator<Item = &'a Vec<(f64, f64)>>) -> Axis {
    let values = curves.flatten().map(|p| p.0).filter(|v| v.is_finite());
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
    if low < high { Axis::new("").over(low, high + 0.02 * (high - low)) } else { Axis::new("") }
}

fn plot(svg: &mut String, panel: &Panel, (x, y): (&Scale, &Scale), up: Option<&str>, across: Option<&str>) {
    let _ = write!(
        svg,
        "<text x=\"{:.1}\" y=\"{:.1}\" font-weight=\"600\">{}</text>",
        x.low_px,
        y.high_px - 6.0,
        escaped(&panel.title)
    );
    for tick in x.ticks() {
        let at = x.px(tick);
        let _ = write!(svg, "<path d=\"M{at:.1} {:.1}V{:.1}\" stroke=\"#e4e4e4\"/>", y.low_px, y.high_px);
        if across.is_some() {
            let _ = write!(
                svg,
                "<text x=\"{at:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>",
                y.low_px + 16.0,
                number(tick)
            );
        }
    }
    for band in &panel.bands {
        region(svg, band, x, y);
    }
    for tick in y.ticks_every(TICK_PX) {
        let at = y.px(tick);
        let colour = if tick == 0.0 { "#888" } else { "#e4e4e4" };
        let _ = write!(svg, "<path d=\"M{:.1} {at:.1}H{:.1}\" stroke=\"{colour}\"/>", x.low_px, x.high_px);
        if up.is_some() {
            let _ = write!(
                svg,
                "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>",
                x.low_px - 6.0,
                at + 4.0,
                number(tick)
            );
        }
    }
    for series in &panel.series {
        draw(svg, series, x, y);
    }
    let _ = write!(
        svg,
        "<path d=\"M{:.1} {:.1}V{:.1}H{:.1}\" fill=\"none\" stroke=\"#333\"/>",
        x.low_px, y.high_px, y.low_px, x.high_px
    );
    labels(svg, (x, y), up, across);
}

/// Names of the axes, where they are wanted.
fn labels(svg: &mut String, (x, y): (&Scale, &Scale), up: Option<&str>, across: Option<&str>) {
    if let Some(label) = across {
        let middle = 0.5 * (x.low_px + x.high_px);
        let _ = write!(
            svg,
            "<text x=\"{middle:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>",
            y.low_px + 34.0,
            escaped(label)
        );
    }
    if let Some(label) = up {
        let middle = 0.5 * (y.low_px + y.high_px);
        let _ = write!(
            svg,
            "<text transform=\"translate(14 {middle:.1}) rotate(-90)\" text-anchor=\"middle\">{}</text>",
            escaped(label)
        );
    }
}

fn region(svg: &mut String, band: &Band, x: &Scale, y: &Scale) {
    let usable = |p: &&(f64, f64, f64)| p.0.is_finite() && p.1.is_finite() && p.2.is_finite();
    let there = band.points.iter().filter(usable).map(|p| (p.0, p.2));
    let back = band.points.iter().rev().filter(usable).map(|p| (p.0, p.1));
    let corners: Vec<String> = there.chain(back).map(|(a, b)| format!("{:.1} {:.1}", x.px(a), y.px(b))).collect();
    if !corners.is_empty() {
        let shade = SHADES[band.shade % SHADES.len()];
        let _ = write!(svg, "<path d=\"M{}Z\" fill=\"{shade}\"/>", corners.join("L"));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_grid_is_one_closed_element_whatever_is_in_it() {
        let band = Band { points: vec![(0.0, -1.0, 1.0), (f64::NAN, 0.0, 0.0), (1.0, -1.0, 1.0)], shade: 1 };
        let curve = Series::new("", vec![(0.0, 0.0), (1.0, f64::INFINITY)], Stroke::Dashed, 1);
        let full = Panel { title: "r4 < r6".to_owned(), bands: vec![band], series: vec![curve] };
        let row = |panels| Row { label: "force (N)".to_owned(), height_px: 100.0, panels };
        let keys = vec![Key::Curve("base".to_owned(), Stroke::Solid, 0), Key::Band("noise".to_owned(), 0)];
        let rows = vec![row(vec![full, Panel::default()]), row(vec![])];
        let svg = Grid { title: "t".to_owned(), across: "depth (mm)".to_owned(), rows, keys }.svg();
        assert_eq!(svg.matches("<svg").count(), svg.matches("</svg>").count());
        assert!(svg.contains("r4 &lt; r6") && !svg.contains("NaN") && !svg.contains("inf"), "{svg}");
    }
}
