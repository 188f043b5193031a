//! A sampled objective over two parameters, with the ways down it (as thesis Fig. 10).

use std::fmt::Write;

use super::figure::{Axis, COLOURS, frame, open};
use super::map::shade_of;
use super::scale::{Scale, number};

/// Points with a value each, and paths over them.
#[derive(Debug, Clone, PartialEq)]
pub struct Cloud {
    /// Heading.
    pub title: String,
    /// Axis along x, with its range.
    pub x: Axis,
    /// Axis along y, with its range.
    pub y: Axis,
    /// What the value is, with its unit.
    pub value: String,
    /// Sampled points and their values, all positive.
    pub points: Vec<(f64, f64, f64)>,
    /// Ways from start to end, the best first.
    pub paths: Vec<Vec<(f64, f64)>>,
    /// The truth behind simulated recordings.
    pub truth: Option<(f64, f64)>,
}

impl Cloud {
    /// The picture as an `<svg>` element. Deep dots are good; shades go by the logarithm of the value. What lies beyond an axis is drawn on its end.
    #[must_use]
    pub fn svg(&self) -> String {
        let (width, height) = (640.0, 430.0);
        let none = || std::iter::empty();
        let x = Scale::fitting(&self.x, none(), (62.0, width - 150.0));
        let y = Scale::fitting(&self.y, none(), (height - 46.0, 34.0));
        let mut svg = open(width, height, &self.title);
        frame(&mut svg, &x, &y, &self.x.label, &self.y.label);
        let within = |axis: &Axis, value: f64| axis.range.map_or(value, |(low, high)| value.clamp(low, high));
        let place = |a: f64, b: f64| (x.px(within(&self.x, a)), y.px(within(&self.y, b)));
        let values = || self.points.iter().map(|p| p.2).filter(|v| v.is_finite() && *v > 0.0);
        let (low, high) = values().fold((f64::INFINITY, 0.0_f64), |(a, b), v| (a.min(v), b.max(v)));
        let span = (high / low).ln().max(1e-9);
        let mut worst_first: Vec<&(f64, f64, f64)> = self.points.iter().collect();
        worst_first.sort_by(|a, b| b.2.total_cmp(&a.2));
        for (a, b, value) in worst_first {
            let ((px, py), share) = (place(*a, *b), ((value / low).ln() / span).clamp(0.0, 1.0));
            let _ = write!(
                svg,
                "<circle cx=\"{px:.1}\" cy=\"{py:.1}\" r=\"{:.1}\" fill=\"{}\" stroke=\"#9ab\" stroke-width=\"0.4\"/>",
                2.4 + 2.6 * (1.0 - share),
                shade_of(share)
            );
        }
        for (at, path) in self.paths.iter().enumerate().rev() {
            way(&mut svg, &path.iter().map(|(a, b)| place(*a, *b)).collect::<Vec<_>>(), at);
        }
        if let Some((px, py)) = self.truth.map(|(a, b)| place(a, b)) {
            let _ = write!(
                svg,
                "<path d=\"M{:.1} {py:.1}h18M{px:.1} {:.1}v18\" stroke=\"#000\" stroke-width=\"1.8\"/>",
                px - 9.0,
                py - 9.0
            );
        }
        self.legend(&mut svg, width - 138.0, (low, high));
        svg.push_str("</svg>\n");
        svg
    }

    fn legend(&self, svg: &mut String, x: f64, (low, high): (f64, f64)) {
        let t = x + 14.0;
        let _ = write!(
            svg,
            "<g font-size=\"11\"><circle cx=\"{x:.1}\" cy=\"50\" r=\"3.8\" fill=\"#fff\" stroke=\"#111\" stroke-width=\"1.4\"/><text x=\"{t:.1}\" y=\"54\">start</text>\
             <path d=\"M{:.1} 64l8 8m0 -8l-8 8\" stroke=\"#111\" stroke-width=\"1.6\"/><text x=\"{t:.1}\" y=\"72\">end</text>\
             <circle cx=\"{x:.1}\" cy=\"92\" r=\"5\" fill=\"{}\" stroke=\"#9ab\" stroke-width=\"0.4\"/><text x=\"{t:.1}\" y=\"96\">{}</text>\
             <circle cx=\"{x:.1}\" cy=\"110\" r=\"2.4\" fill=\"{}\" stroke=\"#9ab\" stroke-width=\"0.4\"/><text x=\"{t:.1}\" y=\"114\">{}</text>\
             <text x=\"{:.1}\" y=\"134\">{}</text>",
            x - 4.0,
            shade_of(0.0),
            number(low),
            shade_of(1.0),
            number(high),
            x - 4.0,
            self.value
        );
        if self.truth.is_some() {
            let _ = write!(
                svg,
                "<path d=\"M{:.1} 152h18m-9 -9v18\" stroke=\"#000\" stroke-width=\"1.8\"/><text x=\"{t:.1}\" y=\"156\">truth</text>",
                x - 9.0
            );
        }
        svg.push_str("</g>");
    }
}

/// A way down: start open, end crossed; the best one is the widest.
fn way(svg: &mut String, points: &[(f64, f64)], at: usize) {
    let (Some(&(sx, sy)), Some(&(ex, ey))) = (points.first(), points.last()) else { return };
    let colour = COLOURS[at % COLOURS.len()];
    let mut line = String::new();
    for (i, (px, py)) in points.iter().enumerate() {
        let _ = write!(line, "{}{px:.1} {py:.1}", if i == 0 { 'M' } else { 'L' });
    }
    let width = if at == 0 { 2.2 } else { 1.2 };
    let _ = write!(
        svg,
        "<path d=\"{line}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"{width}\"/><circle cx=\"{sx:.1}\" cy=\"{sy:.1}\" r=\"3.8\" fill=\"#fff\" stroke=\"{colour}\" stroke-width=\"1.4\"/><path d=\"M{:.1} {:.1}l8 8m0 -8l-8 8\" stroke=\"{colour}\" stroke-width=\"1.8\"/>",
        ex - 4.0,
        ey - 4.0
    );
}
