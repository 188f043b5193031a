//! The objective over two parameters, mostly alpha and mu, with the paths of all simplex searches (as thesis Fig. 9).

use std::collections::BTreeMap;
use std::fmt::Write;

use crate::identify::multistart::{Search, Slice};

use super::figure::{Axis, frame, open};
use super::scale::{Scale, number};

/// Cells of the drawing between two grid points.
const FINER: usize = 3;
/// Lightness of the worst and of the best cell: black lines stay readable on both.
const LIGHT: (f64, f64, f64) = (252.0, 252.0, 250.0);
const DEEP: (f64, f64, f64) = (110.0, 158.0, 193.0);

/// What may lie over a map.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Overlay<'a> {
    /// Points that Gauss-Newton solved, `(alpha, mu in MPa)`, in order.
    pub newton: &'a [(f64, f64)],
    /// The truth behind simulated recordings, `(alpha, mu in MPa)`.
    pub truth: Option<(f64, f64)>,
}

/// Draws the map as an `<svg>` element. Deep cells are good; the scale is logarithmic.
pub fn svg(title: &str, search: &Search) -> String {
    svg_over(title, search, &Overlay::default())
}

/// As [`svg`], with more on top.
pub fn svg_over(title: &str, search: &Search, overlay: &Overlay<'_>) -> String {
    let map = &search.slice;
    let ends = |nodes: &[f64]| Some((*nodes.first()?, *nodes.last()?));
    let (Some(columns), Some(rows)) = (ends(&map.x), ends(&map.y)) else {
        return String::new();
    };
    let (width, height) = (640.0, 430.0);
    let none = || std::iter::empty();
    let axis = |at: usize, (low, high): (f64, f64)| {
        let unknown = &search.unknowns[at];
        let axis = Axis::new(&shown(&unknown.name)).over(unknown.value(low), unknown.value(high));
        if unknown.is_logarithmic() { axis.logarithmic() } else { axis }
    };
    let (x_axis, y_axis) = (axis(map.axes[0], columns), axis(map.axes[1], rows));
    let x = Scale::fitting(&x_axis, none(), (62.0, width - 150.0));
    let y = Scale::fitting(&y_axis, none(), (height - 46.0, 34.0));
    let mut svg = open(width, height, title);
    let place = |point: &[f64]| {
        let value = |at: usize| search.unknowns[at].value(point[at]);
        (x.px(value(map.axes[0])), y.px(value(map.axes[1])))
    };
    cells(&mut svg, map, &x, &y);
    frame(&mut svg, &x, &y, &x_axis.label, &y_axis.label);
    for (at, start) in search.starts.iter().enumerate().rev() {
        let points: Vec<(f64, f64)> = start.descent.path.iter().map(|point| place(point)).collect();
        path(&mut svg, &points, at == 0);
    }
    if let Some(best) = search.starts.first() {
        let (px, py) = place(&best.descent.point);
        let _ = write!(
            svg,
            "<path d=\"M{px:.1} {:.1}L{:.1} {py:.1}L{px:.1} {:.1}L{:.1} {py:.1}Z\" fill=\"#fff\" stroke=\"#000\" stroke-width=\"1.6\"/>",
            py - 6.0,
            px + 6.0,
            py + 6.0,
            px - 6.0
        );
    }
    newton(&mut svg, overlay.newton, &x, &y);
    if let Some((alpha, mu)) = overlay.truth {
        cross(&mut svg, x.px(alpha), y.px(mu));
    }
    legend(&mut svg, search, width - 138.0);
    overlay_legend(&mut svg, overlay, width - 138.0);
    svg.push_str("</svg>\n");
    svg
}

/// "mu (MPa)" for "mu_MPa".
fn shown(name: &str) -> String {
    name.strip_suffix("_MPa").map_or_else(|| name.to_owned(), |name| format!("{name} (MPa)"))
}

/// Colour of what Gauss-Newton did.
const NEWTON: &str = "#b4481e";

/// Squares joined in the order of their solves; the last one filled.
fn newton(svg: &mut String, points: &[(f64, f64)], x: &Scale, y: &Scale) {
    let mut line = String::new();
    for (at, (alpha, mu)) in points.iter().enumerate() {
        let _ = write!(line, "{}{:.1} {:.1}", if at == 0 { 'M' } else { 'L' }, x.px(*alpha), y.px(*mu));
    }
    if !line.is_empty() {
        let _ = write!(svg, "<path d=\"{line}\" fill=\"none\" stroke=\"{NEWTON}\" stroke-width=\"2\"/>");
    }
    for (at, (alpha, mu)) in points.iter().enumerate() {
        let fill = if at + 1 == points.len() { NEWTON } else { "#fff" };
        let _ = write!(
            svg,
            "<rect x=\"{:.1}\" y=\"{:.1}\" width=\"7\" height=\"7\" fill=\"{fill}\" stroke=\"{NEWTON}\" stroke-width=\"1.6\"/>",
            x.px(*alpha) - 3.5,
            y.px(*mu) - 3.5
        );
    }
}

fn cross(svg: &mut String, px: f64, py: f64) {
    let _ = write!(
        svg,
        "<path d=\"M{:.1} {py:.1}h18M{px:.1} {:.1}v18\" stroke=\"#fff\" stroke-width=\"4\"/><path d=\"M{:.1} {py:.1}h18M{px:.1} {:.1}v18\" stroke=\"#000\" stroke-width=\"1.6\"/>",
        px - 9.0,
        py - 9.0,
        px - 9.0,
        py - 9.0
    );
}

fn overlay_legend(svg: &mut String, overlay: &Overlay<'_>, x: f64) {
    let text = x + 14.0;
    if !overlay.newton.is_empty() {
        let _ = write!(
            svg,
            "<rect x=\"{:.1}\" y=\"196\" width=\"7\" height=\"7\" fill=\"#fff\" stroke=\"{NEWTON}\" stroke-width=\"1.6\"/><text font-size=\"11\" x=\"{text:.1}\" y=\"204\">Gauss-Newton, solved</text><rect x=\"{:.1}\" y=\"214\" width=\"7\" height=\"7\" fill=\"{NEWTON}\" stroke=\"{NEWTON}\"/><text font-size=\"11\" x=\"{text:.1}\" y=\"222\">its last solve</text>",
            x - 3.5,
            x - 3.5
        );
    }
    if overlay.truth.is_some() {
        cross(svg, x, 239.0);
        let _ = write!(svg, "<text font-size=\"11\" x=\"{text:.1}\" y=\"243\">truth</text>");
    }
}

/// Colour of a share of the range: 0 the best, 1 the worst.
pub(super) fn shade_of(share: f64) -> String {
    let mix = |light: f64, deep: f64| (deep + share * (light - deep)).round() as u8;
    format!("#{:02x}{:02x}{:02x}", mix(LIGHT.0, DEEP.0), mix(LIGHT.1, DEEP.1), mix(LIGHT.2, DEEP.2))
}

fn extent(value: &[Vec<f64>]) -> (f64, f64) {
    let finite = value.iter().flatten().copied().filter(|v| v.is_finite() && *v > 0.0);
    finite.fold((f64::INFINITY, 0.0_f64), |(low, high), v| (low.min(v), high.max(v)))
}

/// Bilinear shades of ln(objective), drawn cell by cell.
fn cells(svg: &mut String, map: &Slice, x: &Scale, y: &Scale) {
    let (low, high) = extent(&map.objective_n);
    let span = (high / low).ln().max(1e-9);
    let shade = |value: f64| ((value / low).ln() / span).clamp(0.0, 1.0);
    let (columns, rows) = (map.x.len() - 1, map.y.len() - 1);
    let cell_w = (x.high_px - x.low_px) / (columns * FINER) as f64;
    let cell_h = (y.low_px - y.high_px) / (rows * FINER) as f64;
    // A little overlap hides the seams. One path a shade: a third of the text of one rectangle a cell.
    let (width, height) = (cell_w + 0.4, cell_h + 0.4);
    let mut shades: BTreeMap<String, String> = BTreeMap::new();
    for r in 0..rows * FINER {
        for c in 0..columns * FINER {
            let (i, j) = (c / FINER, r / FINER);
            let u = ((c % FINER) as f64 + 0.5) / FINER as f64;
            let v = ((r % FINER) as f64 + 0.5) / FINER as f64;
            let at = |dj: usize, di: usize| shade(map.objective_n[j + dj][i + di]);
            let s = (1.0 - v) * ((1.0 - u) * at(0, 0) + u * at(0, 1)) + v * ((1.0 - u) * at(1, 0) + u * at(1, 1));
            let _ = write!(
                shades.entry(shade_of(s)).or_default(),
                "M{:.1} {:.1}h{width:.1}v{height:.1}h-{width:.1}z",
                x.low_px + c as f64 * cell_w,
                y.low_px - (r + 1) as f64 * cell_h
            );
        }
    }
    for (colour, cells) in shades {
        let _ = write!(svg, "<path fill=\"{colour}\" d=\"{cells}\"/>");
    }
}

fn path(svg: &mut String, points: &[(f64, f64)], best: bool) {
    let (Some(&(sx, sy)), Some(&(ex, ey))) = (points.first(), points.last()) else { return };
    let mut line = String::new();
    for (i, (px, py)) in points.iter().enumerate() {
        let _ = write!(line, "{}{px:.1} {py:.1}", if i == 0 { 'M' } else { 'L' });
    }
    let (dashes, width) = if best { ("", 1.6) } else { (" stroke-dasharray=\"4 3\"", 1.0) };
    let _ = write!(
        svg,
        "<path d=\"{line}\" fill=\"none\" stroke=\"#111\" stroke-width=\"{width}\"{dashes}/><circle cx=\"{sx:.1}\" cy=\"{sy:.1}\" r=\"3.6\" fill=\"#fff\" stroke=\"#111\"/><path d=\"M{:.1} {:.1}l8 8m0 -8l-8 8\" stroke=\"#111\" stroke-width=\"1.4\"/>",
        ex - 4.0,
        ey - 4.0
    );
}

fn legend(svg: &mut String, search: &Search, x: f64) {
    let (low, high) = extent(&search.slice.objective_n);
    let rgb = |c: (f64, f64, f64)| format!("rgb({},{},{})", c.0, c.1, c.2);
    let _ = write!(
        svg,
        "<g font-size=\"11\"><circle cx=\"{x:.1}\" cy=\"50\" r=\"3.6\" fill=\"#fff\" stroke=\"#111\"/><text x=\"{t:.1}\" y=\"54\">start</text>\
         <path d=\"M{e:.1} 64l8 8m0 -8l-8 8\" stroke=\"#111\" stroke-width=\"1.4\"/><text x=\"{t:.1}\" y=\"72\">end</text>\
         <path d=\"M{x:.1} 81l6 6l-6 6l-6 -6Z\" fill=\"#fff\" stroke=\"#000\" stroke-width=\"1.6\"/><text x=\"{t:.1}\" y=\"91\">best end</text>\
         <rect x=\"{e:.1}\" y=\"112\" width=\"12\" height=\"12\" fill=\"{deep}\"/><text x=\"{t:.1}\" y=\"122\">{low} N</text>\
         <rect x=\"{e:.1}\" y=\"130\" width=\"12\" height=\"12\" fill=\"{light}\" stroke=\"#bbb\"/><text x=\"{t:.1}\" y=\"140\">{high} N</text>\
         <text x=\"{e:.1}\" y=\"160\">objective, Eq. 14</text><text x=\"{e:.1}\" y=\"174\">starts below {th} N</text></g>",
        t = x + 14.0,
        e = x - 4.0,
        deep = rgb(DEEP),
        light = rgb(LIGHT),
        low = number(low),
        high = number(high),
        th = number(search.threshold_n)
    );
}
