//! The deformed finger on what it is pressed on, with bands of Mises stress, as SVG (Fig. 55).

use std::collections::{BTreeMap, HashMap};
use std::fmt::Write;

use lut_gen::pad::body::section::Section;
use lut_gen::pad::state::State;

use crate::finger::press::Pressed;
use crate::report::bar::{self, share};
use crate::report::field::ramp;
use crate::report::figure::{Axis, open};
use crate::report::number;
use crate::report::scale::Scale;
use crate::report::sheet::{Node, Sheet};

const WIDTH: f64 = 760.0;
/// Room around the drawing: left, top, right (the colour bar), bottom.
const MARGIN: (f64, f64, f64, f64) = (62.0, 40.0, 130.0, 52.0);
/// Tallest drawing, pixels.
const TALLEST: f64 = 460.0;
/// Bands of colour.
const BANDS: usize = 12;
/// Part of the nodes that may exceed the last band.
const BEYOND: f64 = 0.004;
/// How far beside the finger a block is shown, in half widths of the finger.
const BESIDE: f64 = 1.6;
/// How deep a block is shown, in heights of the finger.
const DEEP: f64 = 1.5;

/// Where the drawing lies on the paper.
struct Frame {
    scale: f64,
    half_mm: f64,
    low_mm: f64,
    high_mm: f64,
}

impl Frame {
    fn of(pressed: &Pressed, state: &State) -> Self {
        let finger = &state.nodes[..pressed.lower];
        let most = |k: usize| finger.iter().map(|p| p[k]).fold(f64::MIN, f64::max);
        let lowest = finger.iter().map(|p| p[1]).fold(f64::MAX, f64::min);
        let (high_mm, tall) = (most(1) + 0.5, most(1) - lowest);
        let block = &state.nodes[pressed.lower..];
        let (half_mm, low_mm) = if block.is_empty() {
            (most(0) + 1.0, lowest - 1.0)
        } else {
            let base = block.iter().map(|p| p[1]).fold(f64::MAX, f64::min);
            let edge = block.iter().map(|p| p[0]).fold(f64::MIN, f64::max);
            ((BESIDE * most(0)).min(edge), base.max(lowest - DEEP * tall))
        };
        let room = WIDTH - MARGIN.0 - MARGIN.2;
        let scale = (0.5 * room / half_mm).min(TALLEST / (high_mm - low_mm));
        Frame { scale, half_mm, low_mm, high_mm }
    }

    fn px(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let middle = MARGIN.0 + 0.5 * (WIDTH - MARGIN.0 - MARGIN.2);
        [middle + self.scale * x, MARGIN.1 + self.scale * (self.high_mm - y)]
    }

    /// Left, top, width, height in pixels.
    fn size(&self) -> [f64; 4] {
        let [left, top] = self.px([-self.half_mm, self.high_mm]);
        [left, top, 2.0 * self.scale * self.half_mm, self.scale * (self.high_mm - self.low_mm)]
    }
}

/// The deformed mesh, mirrored at the axis: on a block with bands of the block's Mises stress, on a plate with the finger's.
pub fn map(title: &str, pressed: &Pressed, state: &State) -> String {
    let frame = Frame::of(pressed, state);
    let on_block = pressed.lower < pressed.nodes.len();
    let shown = |layer: usize| (layer == 2) == on_block;
    let unit = 1e3;
    let levels = levels(pressed, state, &frame, on_block);
    let [left, top, width, height] = frame.size();
    let mut svg = open(WIDTH, top + height + MARGIN.3, title);
    // an inner svg clips without an id, so that several figures can share a page
    let _ = write!(
        svg,
        "<svg x=\"{left:.1}\" y=\"{top:.1}\" width=\"{width:.1}\" height=\"{height:.1}\" viewBox=\"{left:.1} {top:.1} {width:.1} {height:.1}\">"
    );
    let filled = sheet(pressed, state, &shown);
    for (band, level) in levels.iter().enumerate() {
        let floor = if band == 0 { f64::NEG_INFINITY } else { level / unit };
        let _ =
            write!(svg, "<path d=\"{}\" fill=\"{}\"/>", path(&filled, floor, &frame), ramp(share(band, levels.len())));
    }
    if on_block {
        let finger = sheet(pressed, state, &|layer| layer < 2);
        let _ = write!(svg, "<path d=\"{}\" fill=\"#eef2f5\"/>", path(&finger, f64::NEG_INFINITY, &frame));
    }
    sides(&mut svg, pressed, state, &frame);
    svg.push_str("</svg>");
    scales(&mut svg, pressed.section, &frame);
    let tall = (height - 40.0).min(25.0 * levels.len() as f64);
    let corner = (left + width + 26.0, top + height);
    bar::draw(&mut svg, corner, tall / levels.len() as f64, &levels, &["Mises stress", "(kPa)"]);
    svg.push_str("</svg>\n");
    svg
}

/// The elements of some layers.
fn sheet(pressed: &Pressed, state: &State, shown: &dyn Fn(usize) -> bool) -> Sheet {
    let mut sheet = Sheet::default();
    let mut known = HashMap::new();
    for (element, _) in pressed.elements.iter().zip(&pressed.layer).filter(|(_, layer)| shown(**layer)) {
        let nodes = element.map(|n| Node { rest: pressed.nodes[n], now: state.nodes[n], value: state.mises_mpa[n] });
        for side in [1.0, -1.0] {
            sheet.add(&nodes, side, &mut known);
        }
    }
    sheet
}

/// Round lower limits of the bands, kPa.
fn levels(pressed: &Pressed, state: &State, frame: &Frame, on_block: bool) -> Vec<f64> {
    let own = if on_block { pressed.lower..pressed.nodes.len() } else { 0..pressed.lower };
    let inside = |n: &usize| state.nodes[*n][0] <= frame.half_mm && state.nodes[*n][1] >= frame.low_mm;
    let mut values: Vec<f64> = own.filter(inside).map(|n| 1e3 * state.mises_mpa[n]).collect();
    values.sort_by(f64::total_cmp);
    let at = ((1.0 - BEYOND) * values.len() as f64) as usize;
    let most = values.get(at.min(values.len().saturating_sub(1))).copied().unwrap_or(1.0).max(1e-6);
    let rough = most / BANDS as f64;
    let decade = 10_f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 2.5, 5.0, 10.0].into_iter().map(|m| m * decade).find(|s| *s >= rough).unwrap_or(rough);
    (0..BANDS).map(|i| step * i as f64).take_while(|level| *level < most).collect()
}

/// Outlines of what is at least at a level, as one path.
fn path(sheet: &Sheet, level: f64, frame: &Frame) -> String {
    let mut d = String::new();
    for outline in sheet.region(level) {
        for (i, point) in outline.iter().enumerate() {
            let [x, y] = frame.px(*point);
            let _ = write!(d, "{}{x:.1} {y:.1}", if i == 0 { 'M' } else { 'L' });
        }
        d.push('Z');
    }
    d
}

/// Sides of the elements: thin, and thick where another layer or nothing lies across, the axis left out.
fn sides(svg: &mut String, pressed: &Pressed, state: &State, frame: &Frame) {
    let mut all: BTreeMap<usize, ([usize; 2], usize, bool)> = BTreeMap::new();
    for (e, layer) in pressed.elements.iter().zip(&pressed.layer) {
        for side in 0..4 {
            let (ends, middle) = ([e[side], e[(side + 1) % 4]], e[4 + side]);
            all.entry(middle).and_modify(|(_, other, border)| *border = other != layer).or_insert((
                ends,
                *layer,
                pressed.nodes[middle][0] > 0.0,
            ));
        }
    }
    let mut lines = [String::new(), String::new()];
    for (middle, (ends, _, border)) in &all {
        let [p, q, m] = [ends[0], ends[1], *middle].map(|n| state.nodes[n]);
        // a quadratic side is a Bezier curve with this control point
        let control = [0, 1].map(|k| 2.0 * m[k] - 0.5 * (p[k] + q[k]));
        for sign in [1.0, -1.0] {
            let [a, c, b] = [p, control, q].map(|x| frame.px([sign * x[0], x[1]]));
            let d = &mut lines[usize::from(*border)];
            let _ = write!(d, "M{:.1} {:.1}Q{:.1} {:.1} {:.1} {:.1}", a[0], a[1], c[0], c[1], b[0], b[1]);
        }
    }
    for (d, look) in lines.iter().zip(["stroke-width=\"0.4\" stroke-opacity=\"0.3\"", "stroke-width=\"1.4\""]) {
        let _ = write!(svg, "<path d=\"{d}\" fill=\"none\" stroke=\"#000\" {look}/>");
    }
    if pressed.lower == pressed.nodes.len() {
        // the plate's surface is where the finger's lowest point was before it moved
        let plate = pressed.nodes.iter().map(|p| p[1]).fold(f64::MAX, f64::min);
        let ([left, y], [right, _]) = (frame.px([-frame.half_mm, plate]), frame.px([frame.half_mm, plate]));
        let _ = write!(svg, "<path d=\"M{left:.1} {y:.1}H{right:.1}\" stroke=\"#15364f\" stroke-width=\"2.4\"/>");
    }
}

/// Scales in millimetres.
fn scales(svg: &mut String, section: Section, frame: &Frame) {
    let [left, top, width, height] = frame.size();
    let _ = write!(
        svg,
        "<rect x=\"{left:.1}\" y=\"{top:.1}\" width=\"{width:.1}\" height=\"{height:.1}\" fill=\"none\" stroke=\"#333\"/>"
    );
    let fitted =
        |low: f64, high: f64, px: (f64, f64)| Scale::fitting(&Axis::new("").over(low, high), std::iter::empty(), px);
    let across = fitted(-frame.half_mm, frame.half_mm, (left, left + width));
    for tick in across.ticks() {
        let (x, y, text) = (across.px(tick), top + height + 17.0, number(tick.abs()));
        let _ = write!(svg, "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"middle\">{text}</text>");
    }
    let up = fitted(frame.low_mm, frame.high_mm, (top + height, top));
    for tick in up.ticks() {
        let (x, y, text) = (left - 7.0, up.px(tick) + 4.0, number(tick));
        let _ = write!(svg, "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"end\">{text}</text>");
    }
    let name = if section == Section::Ring { "distance from the axis (mm)" } else { "distance from the middle (mm)" };
    let (x, y, middle) = (left + 0.5 * width, top + height + 38.0, top + 0.5 * height);
    let _ = write!(
        svg,
        "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"middle\">{name}</text><text transform=\"translate({:.1} {middle:.1}) rotate(-90)\" text-anchor=\"middle\">height (mm)</text>",
        left - 40.0
    );
}
