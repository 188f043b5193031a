//! Line figures as SVG: axes with units, curves with labels at their ends.
//!
//! Curves differ by line style as well as by colour, so that a figure survives a black-and-white
//! printer. The output is one self-contained `<svg>` element without scripts or outside fonts.

use std::fmt::Write;

pub use super::axis::Axis;
use super::escaped;
use super::scale::{Scale, number};

/// How a series is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stroke {
    /// Unbroken line.
    Solid,
    /// Long dashes.
    Dashed,
    /// Dots.
    Dotted,
    /// Dashes and dots.
    DashDotted,
    /// Small open circles, for measured samples.
    Circles,
    /// Small open marks whose shape follows the colour, for measured samples of several runs.
    Marks,
    /// Filled dots, for few and important points.
    Dots,
    /// A thin light line, for many or unimportant curves.
    Faint,
}

impl Stroke {
    /// Line styles in the order in which curves of one figure should take them.
    pub const LINES: [Stroke; 4] = [Stroke::Solid, Stroke::Dashed, Stroke::DashDotted, Stroke::Dotted];

    fn dashes(self) -> &'static str {
        match self {
            Stroke::Dashed => " stroke-dasharray=\"7 4\"",
            Stroke::Dotted => " stroke-dasharray=\"1.5 3.5\"",
            Stroke::DashDotted => " stroke-dasharray=\"8 3.5 1.5 3.5\"",
            Stroke::Solid | Stroke::Circles | Stroke::Marks | Stroke::Dots | Stroke::Faint => "",
        }
    }
}

/// Colours with different lightness, dark enough for thin lines on white.
pub const COLOURS: [&str; 6] = ["#15364f", "#b4481e", "#2b7a4b", "#7a3e8e", "#8a6d00", "#4a4a4a"];

/// A curve.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Written at its end; empty for none.
    pub label: String,
    /// Points in the units of the axes; a point that is not finite breaks the line.
    pub points: Vec<(f64, f64)>,
    /// Line or circles.
    pub stroke: Stroke,
    /// Index into [`COLOURS`], wrapping around.
    pub colour: usize,
}

impl Series {
    /// A labelled curve.
    pub fn new(label: &str, points: Vec<(f64, f64)>, stroke: Stroke, colour: usize) -> Self {
        Self { label: label.to_owned(), points, stroke, colour }
    }
}

/// A figure of curves over common axes.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// Above the plot.
    pub title: String,
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// Curves, later ones on top.
    pub series: Vec<Series>,
    /// Size in pixels, width and height.
    pub size: (f64, f64),
}

/// Room around the plot: left, top, right, bottom.
const MARGIN: (f64, f64, f64, f64) = (62.0, 34.0, 20.0, 46.0);
const LINE_HEIGHT: f64 = 14.0;

impl Figure {
    /// An empty figure of the usual size.
    pub fn new(title: &str, x: Axis, y: Axis) -> Self {
        Self { title: title.to_owned(), x, y, series: Vec::new(), size: (640.0, 360.0) }
    }

    /// Adds a curve.
    #[must_use]
    pub fn with(mut self, series: Series) -> Self {
        self.series.push(series);
        self
    }

    /// The figure as an `<svg>` element.
    pub fn svg(&self) -> String {
        let points = || self.series.iter().flat_map(|series| series.points.iter());
        let longest = self.series.iter().map(|s| s.label.chars().count()).max().unwrap_or(0);
        let right = MARGIN.2 + 6.8 * longest as f64;
        let (width, height) = self.size;
        let x = Scale::fitting(&self.x, points().map(|p| p.0), (MARGIN.0, width - right));
        let y = Scale::fitting(&self.y, points().map(|p| p.1), (height - MARGIN.3, MARGIN.1));
        let mut svg = opened(width, height, &self.title, &self.alternative());
        frame(&mut svg, &x, &y, &self.x.label, &self.y.label);
        let _ = write!(
            svg,
            "<svg x=\"{:.1}\" y=\"{:.1}\" width=\"{:.1}\" height=\"{:.1}\" viewBox=\"{0:.1} {1:.1} {2:.1} {3:.1}\">",
            x.low_px - 3.0,
            y.high_px - 3.0,
            x.high_px - x.low_px + 6.0,
            y.low_px - y.high_px + 6.0
        );
        for series in &self.series {
            draw(&mut svg, series, &x, &y);
        }
        svg.push_str("</svg>");
        self.labels(&mut svg, &x, &y);
        svg.push_str("</svg>\n");
        svg
    }

    /// What the figure shows, in words: title, axes, and the names of its curves.
    fn alternative(&self) -> String {
        let title = if self.title.is_empty() { String::new() } else { format!("{}: ", self.title) };
        let names: Vec<&str> = self.series.iter().map(|s| s.label.as_str()).filter(|name| !name.is_empty()).collect();
        let curves = if names.is_empty() { String::new() } else { format!("; curves: {}", names.join(", ")) };
        format!("{title}{} over {}{curves}", self.y.label, self.x.label)
    }

    /// Labels beside the ends of the curves, moved apart where they would overlap.
    fn labels(&self, svg: &mut String, x: &Scale, y: &Scale) {
        let mut labels: Vec<(f64, &Series)> = self
            .series
            .iter()
            .filter(|series| !series.label.is_empty())
            .filter_map(|series| {
                let end = series.points.iter().rev().find(|p| p.0.is_finite() && p.1.is_finite())?;
                Some((y.px(end.1).clamp(y.high_px, y.low_px), series))
            })
            .collect();
        labels.sort_by(|a, b| a.0.total_cmp(&b.0));
        for i in 1..labels.len() {
            labels[i].0 = labels[i].0.max(labels[i - 1].0 + LINE_HEIGHT);
        }
        let mut floor = y.low_px + 4.0;
        for label in labels.iter_mut().rev() {
            label.0 = label.0.min(floor);
            floor = label.0 - LINE_HEIGHT;
        }
        for (at, series) in labels {
            let colour = COLOURS[series.colour % COLOURS.len()];
            let _ = write!(
                svg,
                "<text x=\"{:.1}\" y=\"{:.1}\" fill=\"{colour}\">{}</text>",
                x.high_px + 7.0,
                at + 4.0,
                escaped(&series.label)
            );
        }
    }
}

/// Opens an `<svg>` element with a title line, which is also its text for those who do not see it.
pub(super) fn open(width: f64, height: f64, title: &str) -> String {
    opened(width, height, title, title)
}

/// Opens an `<svg>` element with a title line and a text of its own for those who do not see it.
fn opened(width: f64, height: f64, title: &str, alternative: &str) -> String {
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" role=\"img\" aria-label=\"{0}\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\" font-family=\"Helvetica, Arial, sans-serif\" font-size=\"12\" fill=\"#222\"><title>{0}</title>",
        escaped(alternative)
    );
    let _ = write!(
        svg,
        "<rect width=\"{width}\" height=\"{height}\" fill=\"#fff\"/><text x=\"{}\" y=\"20\" font-size=\"14\" font-weight=\"600\">{}</text>",
        MARGIN.0,
        escaped(title)
    );
    svg
}

/// Axes, ticks, grid and axis labels.
pub(super) fn frame(svg: &mut String, x: &Scale, y: &Scale, x_label: &str, y_label: &str) {
    for tick in x.ticks() {
        let at = x.px(tick);
        let _ = write!(
            svg,
            "<path d=\"M{at:.1} {:.1}V{:.1}\" stroke=\"#e4e4e4\"/><text x=\"{at:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>",
            y.low_px,
            y.high_px,
            y.low_px + 17.0,
            number(tick)
        );
    }
    for tick in y.ticks() {
        let at = y.px(tick);
        let _ = write!(
            svg,
            "<path d=\"M{:.1} {at:.1}H{:.1}\" stroke=\"#e4e4e4\"/><text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>",
            x.low_px,
            x.high_px,
            x.low_px - 7.0,
            at + 4.0,
            number(tick)
        );
    }
    let (middle_x, middle_y) = (0.5 * (x.low_px + x.high_px), 0.5 * (y.low_px + y.high_px));
    let _ = write!(
        svg,
        "<path d=\"M{:.1} {:.1}V{:.1}H{:.1}\" fill=\"none\" stroke=\"#333\"/><text x=\"{middle_x:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text><text transform=\"translate(16 {middle_y:.1}) rotate(-90)\" text-anchor=\"middle\">{}</text>",
        x.low_px,
        y.high_px,
        y.low_px,
        x.high_px,
        y.low_px + 36.0,
        escaped(x_label),
        escaped(y_label)
    );
}

/// One curve, without its label.
pub(super) fn draw(svg: &mut String, series: &Series, x: &Scale, y: &Scale) {
    let colour = COLOURS[series.colour % COLOURS.len()];
    if matches!(series.stroke, Stroke::Circles | Stroke::Dots) {
        let look = match series.stroke {
            Stroke::Dots => format!("r=\"3.6\" fill=\"{colour}\" fill-opacity=\"0.75\""),
            _ => format!("r=\"2.2\" fill=\"none\" stroke=\"{colour}\" stroke-opacity=\"0.55\""),
        };
        for (px, py) in series.points.iter().filter(|p| p.0.is_finite() && p.1.is_finite()) {
            let _ = write!(svg, "<circle cx=\"{:.1}\" cy=\"{:.1}\" {look}/>", x.px(*px), y.px(*py));
        }
        return;
    }
    if series.stroke == Stroke::Marks {
        for (px, py) in series.points.iter().filter(|p| p.0.is_finite() && p.1.is_finite()) {
            let shape = mark(series.colour, x.px(*px), y.px(*py));
            let _ = write!(svg, "<path d=\"{shape}\" fill=\"none\" stroke=\"{colour}\" stroke-opacity=\"0.6\"/>");
        }
        return;
    }
    let mut path = String::new();
    let mut pen_down = false;
    for (px, py) in &series.points {
        if !(px.is_finite() && py.is_finite()) {
            pen_down = false;
            continue;
        }
        let letter = if pen_down { 'L' } else { 'M' };
        let _ = write!(path, "{letter}{:.1} {:.1}", x.px(*px), y.px(*py));
        pen_down = true;
    }
    let (width, opacity) = if series.stroke == Stroke::Faint { (0.8, 0.6) } else { (1.7, 1.0) };
    let _ = write!(
        svg,
        "<path d=\"{path}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"{width}\" stroke-opacity=\"{opacity}\" stroke-linejoin=\"round\"{}/>",
        series.stroke.dashes()
    );
}

/// Outline of an open mark: circle, square, triangle, diamond, cross, triangle on its tip.
fn mark(colour: usize, x: f64, y: f64) -> String {
    match colour % 6 {
        0 => format!("M{:.1} {y:.1}a2.4 2.4 0 1 0 4.8 0a2.4 2.4 0 1 0 -4.8 0", x - 2.4),
        1 => format!("M{:.1} {:.1}h4.6v4.6h-4.6z", x - 2.3, y - 2.3),
        2 => format!("M{x:.1} {:.1}l2.8 5h-5.6z", y - 3.2),
        3 => format!("M{x:.1} {:.1}l3.1 3.1l-3.1 3.1l-3.1 -3.1z", y - 3.1),
        4 => format!("M{:.1} {:.1}l5 5m0 -5l-5 5", x - 2.5, y - 2.5),
        _ => format!("M{x:.1} {:.1}l2.8 -5h-5.6z", y + 3.2),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_figure_is_one_closed_element_whatever_is_in_it() {
        let figure = Figure::new("a < b & c", Axis::new("depth (mm)"), Axis::new("force (N)"));
        assert!(figure.svg().contains("a &lt; b &amp; c"));
        let odd = figure
            .with(Series::new("one", vec![(0.0, 1.0)], Stroke::Solid, 0))
            .with(Series::new("gap", vec![(0.0, f64::NAN), (1.0, 2.0)], Stroke::Dotted, 7))
            .with(Series::new("", vec![], Stroke::Circles, 2))
            .with(Series::new("", (0..7).map(|i| (f64::from(i), 1.0)).collect(), Stroke::Marks, 3))
            .svg();
        assert!(odd.contains("role=\"img\"") && odd.contains("curves: one, gap"), "{odd}");
        assert_eq!(odd.matches("<svg").count(), odd.matches("</svg>").count());
        assert!(!odd.contains("NaN") && !odd.contains("inf"), "{odd}");
    }
}
