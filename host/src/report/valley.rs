//! The objective around a minimum that Gauss-Newton found, with the points that were solved.

use std::fmt::Write;

use crate::identify::newton::fit::Newton;
use crate::identify::newton::valley::Valley;

use super::figure::{Axis, frame, open};
use super::scale::{Scale, number};

/// Shades of the 95 % region, of up to two and four times its radius, and of the rest.
const SHADES: [&str; 4] = ["#6e9ec1", "#a9c5da", "#d9e5ee", "#fbfbf9"];
/// Cells of the drawing between two grid points.
const FINER: usize = 4;

/// Draws the valley as an `<svg>` element.
pub fn svg(title: &str, newton: &Newton, valley: &Valley) -> String {
    let (width, height) = (640.0, 430.0);
    let axis = |of: usize, coordinates: &[f64]| {
        let unknown = &newton.solved.unknowns[valley.axes[of]];
        let end = |x: Option<&f64>| unknown.value(x.copied().unwrap_or(0.0));
        let axis = Axis::new(&unknown.name).over(end(coordinates.first()), end(coordinates.last()));
        if unknown.is_logarithmic() { axis.logarithmic() } else { axis }
    };
    let (x_axis, y_axis) = (axis(0, &valley.x), axis(1, &valley.y));
    let x = Scale::fitting(&x_axis, std::iter::empty(), (70.0, width - 170.0));
    let y = Scale::fitting(&y_axis, std::iter::empty(), (height - 46.0, 34.0));
    let mut svg = open(width, height, title);
    cells(&mut svg, valley, &x, &y);
    frame(&mut svg, &x, &y, &x_axis.label, &y_axis.label);
    path(&mut svg, newton, valley, &x, &y);
    legend(&mut svg, width - 156.0, outside(newton, valley));
    svg.push_str("</svg>\n");
    svg
}

/// Number of a rise's shade.
fn band(rise: f64, edge: f64) -> usize {
    [1.0, 4.0, 16.0].iter().position(|times| rise <= times * edge).unwrap_or(SHADES.len() - 1)
}

fn cells(svg: &mut String, valley: &Valley, x: &Scale, y: &Scale) {
    let (columns, rows) = ((valley.x.len() - 1) * FINER, (valley.y.len() - 1) * FINER);
    let (wide, high) = ((x.high_px - x.low_px) / columns as f64, (y.low_px - y.high_px) / rows as f64);
    for row in 0..rows {
        let bands: Vec<usize> = (0..columns).map(|column| band(between(valley, column, row), valley.edge)).collect();
        let mut from = 0;
        // Cells of one shade beside each other are one rectangle.
        for column in 1..=columns {
            if column < columns && bands[column] == bands[from] {
                continue;
            }
            let _ = write!(
                svg,
                "<rect x=\"{:.1}\" y=\"{:.1}\" width=\"{:.1}\" height=\"{:.1}\" fill=\"{}\"/>",
                x.low_px + from as f64 * wide,
                y.low_px - (row + 1) as f64 * high,
                (column - from) as f64 * wide + 0.4,
                high + 0.4,
                SHADES[bands[from]]
            );
            from = column;
        }
    }
}

/// Bilinear between the nodes, in the middle of a cell; of the square root, which is what grows evenly.
fn between(valley: &Valley, column: usize, row: usize) -> f64 {
    let (i, j) = (column / FINER, row / FINER);
    let share = |cell: usize| ((cell % FINER) as f64 + 0.5) / FINER as f64;
    let (u, v) = (share(column), share(row));
    let at = |dj: usize, di: usize| valley.rise[j + dj][i + di].sqrt();
    let root = (1.0 - v) * ((1.0 - u) * at(0, 0) + u * at(0, 1)) + v * ((1.0 - u) * at(1, 0) + u * at(1, 1));
    root * root
}

fn inside(valley: &Valley, point: &[f64]) -> bool {
    let within = |axis: usize, nodes: &[f64]| {
        let value = point[valley.axes[axis]];
        nodes.first().is_some_and(|low| *low <= value) && nodes.last().is_some_and(|high| value <= *high)
    };
    within(0, &valley.x) && within(1, &valley.y)
}

/// Solved points that lie beyond the drawing.
fn outside(newton: &Newton, valley: &Valley) -> usize {
    newton.path.iter().filter(|visit| !inside(valley, &visit.point)).count()
}

fn path(svg: &mut String, newton: &Newton, valley: &Valley, x: &Scale, y: &Scale) {
    let place = |point: &[f64]| {
        let value = |of: usize| newton.solved.unknowns[valley.axes[of]].value(point[valley.axes[of]]);
        (x.px(value(0)), y.px(value(1)))
    };
    for visit in newton.path.iter().filter(|visit| inside(valley, &visit.point)) {
        let (px, py) = place(&visit.point);
        let _ = write!(svg, "<circle cx=\"{px:.1}\" cy=\"{py:.1}\" r=\"3.4\" fill=\"#fff\" stroke=\"#111\"/>");
    }
    let (px, py) = place(&newton.minimum.x);
    let _ = write!(
        svg,
        "<path d=\"M{:.1} {py:.1}h14M{px:.1} {:.1}v14\" stroke=\"#000\" stroke-width=\"2\" fill=\"none\"/>",
        px - 7.0,
        py - 7.0
    );
}

fn legend(svg: &mut String, x: f64, beyond: usize) {
    let words = ["95 % region", "twice as far", "four times as far", "farther"];
    let _ = write!(
        svg,
        "<g font-size=\"11\"><path d=\"M{x:.1} 50h14M{m:.1} 43v14\" stroke=\"#000\" stroke-width=\"2\"/><text x=\"{t:.1}\" y=\"54\">minimum</text>\
         <circle cx=\"{m:.1}\" cy=\"70\" r=\"3.4\" fill=\"#fff\" stroke=\"#111\"/><text x=\"{t:.1}\" y=\"74\">solved</text>",
        m = x + 7.0,
        t = x + 20.0
    );
    if beyond > 0 {
        let _ = write!(svg, "<text x=\"{:.1}\" y=\"88\">({beyond} beyond the edges)</text>", x + 20.0);
    }
    for (at, (shade, word)) in SHADES.iter().zip(words).enumerate() {
        let top = 104.0 + 18.0 * at as f64;
        let _ = write!(
            svg,
            "<rect x=\"{x:.1}\" y=\"{top:.1}\" width=\"14\" height=\"12\" fill=\"{shade}\" stroke=\"#bbb\"/><text x=\"{:.1}\" y=\"{:.1}\">{word}</text>",
            x + 20.0,
            top + 10.0
        );
    }
    svg.push_str("</g>");
}

/// What the drawing shows, in words.
pub fn caption(newton: &Newton, valley: &Valley) -> String {
    let name = |of: usize| newton.solved.unknowns[valley.axes[of]].name.as_str();
    let others = newton.solved.unknowns.len() - 2;
    let follow = if others > 0 { ", all other parameters at their best" } else { "" };
    let correlation = newton.correlation.as_ref().map_or_else(String::new, |c| {
        format!("; correlation of the two {}", number(c[(valley.axes[0], valley.axes[1])]))
    });
    format!(
        "Objective over {} and {}, the pair that makes up for each other most{follow}, contact points at their best{correlation}.",
        name(0),
        name(1)
    )
}
