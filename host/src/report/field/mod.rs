//! The deformed specimen under the ball, filled with its Mises stress, as SVG.

mod ramp;
mod sheet;

use std::fmt::Write;

use lut_gen::solid::field::{Field, PointState};

use super::bar::{self, share};
use super::escaped;
use super::figure::Axis;
use super::figure::open;
use super::number;
use super::scale::Scale;
pub(super) use ramp::ramp;

/// Size of the picture in pixels.
const WIDTH: f64 = 760.0;
/// Room around the drawing: left, top, right (the colour bar), bottom.
const MARGIN: (f64, f64, f64, f64) = (62.0, 40.0, 124.0, 56.0);
/// Tallest drawing, pixels.
const TALLEST: f64 = 400.0;
/// Half width shown, in ball radii, where the height allows.
const SHOWN: f64 = 3.2;
/// Bands of colour at most.
const BANDS: usize = 12;
/// Limits of bands within a decade.
const ROUND: [f64; 6] = [1.0, 1.5, 2.0, 3.0, 5.0, 7.0];
/// Share of the sheet's nodes that may exceed the last level: the singular edge of the contact
/// would otherwise take all colours.
const BEYOND: f64 = 0.004;

/// Where a drawing lies on the paper.
struct Frame {
    /// Pixels a millimetre.
    scale: f64,
    /// Half width shown, mm.
    half_mm: f64,
    /// Pixel of the axis.
    axis_px: f64,
    /// Pixel of the base.
    base_px: f64,
}

impl Frame {
    fn of(field: &Field) -> Self {
        let radius = field.ball.radius_mm;
        let widest = (0..field.nodes.len()).map(|n| field.position_mm(n)[0]).fold(0.0, f64::max);
        let top_mm = field.height_mm.max(field.centre_mm()) + 1.05 * radius;
        let room = WIDTH - MARGIN.0 - MARGIN.2;
        let scale = (0.5 * room / widest.min(SHOWN * radius)).min(TALLEST / top_mm);
        let half_mm = widest.min(0.5 * room / scale);
        Self { scale, half_mm, axis_px: MARGIN.0 + 0.5 * room, base_px: MARGIN.1 + scale * top_mm }
    }

    fn px(&self, [x, z]: [f64; 2]) -> [f64; 2] {
        [self.axis_px + self.scale * x, self.base_px - self.scale * z]
    }
}

/// The deformed mesh, mirrored at the axis, filled with bands of Mises stress, with the ball and a colour bar.
pub fn mises(title: &str, field: &Field) -> String {
    let frame = Frame::of(field);
    let mises: Vec<f64> = field.state.iter().map(PointState::mises_mpa).collect();
    let (unit, per_mpa) = if field.largest_mises_mpa() < 1.0 { ("kPa", 1000.0) } else { ("MPa", 1.0) };
    let levels = levels(field, &mises, per_mpa, frame.half_mm);
    let height = frame.base_px + MARGIN.3;
    let mut svg = open(WIDTH, height, title);
    let (left, width) = (frame.px([-frame.half_mm, 0.0])[0], 2.0 * frame.scale * frame.half_mm);
    // an inner svg clips without an id, so that several figures can share a page
    let _ = write!(
        svg,
        "<svg x=\"{left:.1}\" y=\"{0:.1}\" width=\"{width:.1}\" height=\"{1:.1}\" viewBox=\"{left:.1} {0:.1} {width:.1} {1:.1}\">",
        MARGIN.1,
        frame.base_px - MARGIN.1
    );
    let sheet = sheet::drawn(field, &mises, frame.half_mm);
    for (band, level) in levels.iter().enumerate() {
        let floor = if band == 0 { f64::NEG_INFINITY } else { level / per_mpa };
        let outlines = path(&sheet.region(floor), &frame);
        let _ = write!(svg, "<path d=\"{outlines}\" fill=\"{}\"/>", ramp(share(band, levels.len())));
    }
    mesh_lines(&mut svg, field, &frame);
    undeformed(&mut svg, field, &frame);
    ball(&mut svg, field, &frame);
    svg.push_str("</svg>");
    ground(&mut svg, field, &frame);
    colour_bar(&mut svg, &levels, unit, &frame);
    svg.push_str("</svg>\n");
    svg
}

/// What the picture shows, with its numbers.
pub fn caption(field: &Field) -> String {
    let highest = field.pressure_mpa.iter().copied().fold(0.0, f64::max);
    format!(
        "Computed, not measured. Lines: the deformed mesh, mirrored at the axis; dotted: the top before contact. Ball of {} mm radius, {} mm \
         deep, {} N; Mises stress up to {} MPa, contact pressure up to {} MPa. The limits of the bands rise by a factor of about 1.5.",
        number(field.ball.radius_mm),
        number(field.step.depth_mm),
        number(field.step.force_n),
        number(field.largest_mises_mpa()),
        number(highest)
    )
}

/// Round lower limits of the bands, in the unit of the picture: 0, then rising by 1.3 to 1.7 each. Stress
/// falls steeply away from the ball; even steps would show its skin and nothing else.
fn levels(field: &Field, mises: &[f64], per_mpa: f64, half_mm: f64) -> Vec<f64> {
    let shown = |n: &usize| field.position_mm(*n)[0] <= half_mm;
    let mut values: Vec<f64> = (0..mises.len()).filter(shown).map(|n| per_mpa * mises[n]).collect();
    values.sort_by(f64::total_cmp);
    let at = ((1.0 - BEYOND) * values.len() as f64) as usize;
    let most = values.get(at.min(values.len().saturating_sub(1))).copied().unwrap_or(0.0).max(1e-6);
    let decade = most.log10().floor() as i32;
    let round = (decade - 2..=decade).flat_map(|power| ROUND.map(|m| m * 10_f64.powi(power)));
    let mut levels: Vec<f64> = round.filter(|level| *level < most).collect();
    let surplus = levels.len().saturating_sub(BANDS - 1);
    levels.drain(..surplus);
    levels.insert(0, 0.0);
    levels
}

/// Closed outlines as one path, to a tenth of a pixel and relative, which is short.
fn path(outlines: &[Vec<[f64; 2]>], frame: &Frame) -> String {
    let mut d = String::new();
    for outline in outlines {
        let mut last = [0_i64; 2];
        for (i, point) in outline.iter().enumerate() {
            let here = frame.px(*point).map(|c| (10.0 * c).round() as i64);
            let step = [here[0] - last[0], here[1] - last[1]];
            if i > 0 && step == [0, 0] {
                continue;
            }
            let _ = write!(d, "{}{} {}", if i == 0 { 'M' } else { 'l' }, tenth(step[0]), tenth(step[1]));
            last = here;
        }
        d.push('Z');
    }
    d
}

fn tenth(value: i64) -> String {
    let text = format!("{:.1}", value as f64 / 10.0);
    text.strip_suffix(".0").map(str::to_owned).unwrap_or(text)
}

/// Sides of the elements. A quadratic side is a Bezier curve with the control point `2 m - (a + b) / 2`.
fn mesh_lines(svg: &mut String, field: &Field, frame: &Frame) {
    let mut drawn = std::collections::BTreeSet::new();
    let mut d = String::new();
    for element in &field.elements {
        if element.iter().all(|n| field.position_mm(*n)[0] > frame.half_mm) {
            continue;
        }
        for side in 0..4 {
            let (a, b, middle) = (element[side], element[(side + 1) % 4], element[4 + side]);
            if !drawn.insert(middle) {
                continue;
            }
            let [p, q, m] = [a, b, middle].map(|n| field.position_mm(n));
            for sign in [1.0, -1.0] {
                let at = |x: [f64; 2]| frame.px([sign * x[0], x[1]]);
                let (p, q) = (at(p), at(q));
                let m = at(m);
                let control = [2.0 * m[0] - 0.5 * (p[0] + q[0]), 2.0 * m[1] - 0.5 * (p[1] + q[1])];
                let straight = (0.5 * (p[0] + q[0]) - m[0]).hypot(0.5 * (p[1] + q[1]) - m[1]) < 0.05;
                let _ = write!(d, "M{:.1} {:.1}", p[0], p[1]);
                if straight {
                    let _ = write!(d, "L{:.1} {:.1}", q[0], q[1]);
                } else {
                    let _ = write!(d, "Q{:.1} {:.1} {:.1} {:.1}", control[0], control[1], q[0], q[1]);
                }
            }
        }
    }
    let _ = write!(svg, "<path d=\"{d}\" fill=\"none\" stroke=\"#000\" stroke-width=\"0.5\" stroke-opacity=\"0.28\"/>");
}

/// The ball, and its shank where the block reaches above the equator.
fn ball(svg: &mut String, field: &Field, frame: &Frame) {
    let [x, y] = frame.px([0.0, field.centre_mm()]);
    let r = frame.scale * field.ball.radius_mm;
    let _ = write!(
        svg,
        "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{r:.1}\" fill=\"#e9edf0\" stroke=\"#15364f\" stroke-width=\"1.6\"/>"
    );
    if field.centre_mm() < field.height_mm {
        let _ = write!(
            svg,
            "<path d=\"M{:.1} {y:.1}V{:.1}H{:.1}V{y:.1}\" fill=\"#e9edf0\" stroke=\"#15364f\" stroke-width=\"1.6\"/>",
            x - r,
            MARGIN.1 - 2.0,
            x + r
        );
    }
    let text = [format!("{} N", number(field.step.force_n)), format!("{} mm deep", number(field.step.depth_mm))];
    for (line, text) in text.iter().enumerate() {
        let _ = write!(
            svg,
            "<text x=\"{x:.1}\" y=\"{:.1}\" text-anchor=\"middle\" fill=\"#15364f\">{}</text>",
            y + 16.0 * line as f64 - 0.45 * r,
            escaped(text)
        );
    }
}

/// Where the top was.
fn undeformed(svg: &mut String, field: &Field, frame: &Frame) {
    let ([left, top], [right, _]) =
        (frame.px([-frame.half_mm, field.height_mm]), frame.px([frame.half_mm, field.height_mm]));
    let _ = write!(
        svg,
        "<path d=\"M{left:.1} {top:.1}H{right:.1}\" stroke=\"#15364f\" stroke-width=\"0.9\" stroke-dasharray=\"2 4\"/>"
    );
}

/// The base and scales in millimetres.
fn ground(svg: &mut String, field: &Field, frame: &Frame) {
    let ([left, base], [right, top]) = (frame.px([-frame.half_mm, 0.0]), frame.px([frame.half_mm, field.height_mm]));
    let mut hatch = String::new();
    let mut x = left + 6.0;
    while x <= right {
        let _ = write!(hatch, "M{x:.1} {base:.1}l-6 6");
        x += 8.0;
    }
    let _ = write!(
        svg,
        "<path d=\"{hatch}\" stroke=\"#888\" stroke-width=\"0.8\"/><path d=\"M{left:.1} {base:.1}H{right:.1}\" stroke=\"#333\" stroke-width=\"1.4\"/>"
    );
    let across = Axis::new("").over(-frame.half_mm, frame.half_mm);
    let across = Scale::fitting(&across, std::iter::empty(), (left, right));
    for tick in across.ticks() {
        let _ = write!(
            svg,
            "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>",
            across.px(tick),
            base + 21.0,
            number(tick.abs())
        );
    }
    let up = Axis::new("").over(0.0, field.height_mm);
    let up = Scale::fitting(&up, std::iter::empty(), (base, top));
    for tick in up.ticks() {
        let y = up.px(tick);
        let _ = write!(
            svg,
            "<path d=\"M{left:.1} {y:.1}h-4\" stroke=\"#333\"/><text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>",
            left - 7.0,
            y + 4.0,
            number(tick)
        );
    }
    let _ = write!(
        svg,
        "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">distance from the axis (mm)</text><text transform=\"translate({:.1} {:.1}) rotate(-90)\" text-anchor=\"middle\">height (mm)</text>",
        0.5 * (left + right),
        base + 41.0,
        left - 38.0,
        0.5 * (base + top)
    );
}

fn colour_bar(svg: &mut String, levels: &[f64], unit: &str, frame: &Frame) {
    let tall = (frame.base_px - MARGIN.1 - 30.0).min(25.0 * levels.len() as f64);
    let corner = (WIDTH - MARGIN.2 + 34.0, frame.base_px);
    bar::draw(svg, corner, tall / levels.len() as f64, levels, &["Mises stress", &format!("({unit})")]);
}
