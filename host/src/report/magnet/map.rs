//! The map of |B| with lines of flux, as SVG.

use std::fmt::Write;

use lut_gen::fem::drawing::Curve;
use lut_gen::magnet::design::Design;
use lut_gen::magnet::field::Geometry;
use lut_gen::magnet::map::Map;

use crate::report::bar::{self, share};
use crate::report::field::ramp;
use crate::report::figure::open;
use crate::report::number;
use crate::report::sheet::Sheet;

/// Width of the drawing, pixels, and its largest height.
const ROOM: (f64, f64) = (560.0, 560.0);
/// Room around the drawing: left, top, right (the colour bar), bottom.
const MARGIN: (f64, f64, f64, f64) = (56.0, 40.0, 110.0, 48.0);
/// Bands of colour.
const BANDS: usize = 12;
/// Part of the area shown that may lie above the last band: corners would otherwise take all colours.
const BEYOND: f64 = 0.002;
/// Lines of flux.
const LINES: usize = 24;
/// How much of the drawing's size is shown around it.
const AROUND: f64 = 0.12;

/// Where the drawing lies on the paper.
struct Frame {
    low: [f64; 2],
    high: [f64; 2],
    scale: f64,
}

impl Frame {
    fn of(design: &Design) -> Self {
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for curve in outlines(design) {
            for i in 0..=32 {
                let p = curve.at(f64::from(i) / 32.0);
                for k in 0..2 {
                    low[k] = low[k].min(p[k]);
                    high[k] = high[k].max(p[k]);
                }
            }
        }
        let more = AROUND * (high[0] - low[0]).max(high[1] - low[1]);
        let (mut low, high) = (low.map(|v| v - more), high.map(|v| v + more));
        if design.geometry == Geometry::Axisymmetric {
            low[0] = 0.0;
        }
        let scale = (ROOM.0 / (high[0] - low[0])).min(ROOM.1 / (high[1] - low[1]));
        Frame { low, high, scale }
    }

    fn px(&self, p: [f64; 2]) -> [f64; 2] {
        [MARGIN.0 + self.scale * (p[0] - self.low[0]), MARGIN.1 + self.scale * (self.high[1] - p[1])]
    }

    fn size(&self) -> (f64, f64) {
        (self.scale * (self.high[0] - self.low[0]), self.scale * (self.high[1] - self.low[1]))
    }

    fn shows(&self, p: [f64; 2]) -> bool {
        (0..2).all(|k| (self.low[k]..=self.high[k]).contains(&p[k]))
    }
}

fn outlines(design: &Design) -> Vec<Curve> {
    design.regions.iter().flat_map(|region| region.shapes.iter().flat_map(|shape| shape.outline())).collect()
}

/// Bands of |B|, lines of flux, the outlines of the regions, and a colour bar.
pub fn map(title: &str, design: &Design, map: &Map) -> String {
    let frame = Frame::of(design);
    let (width, height) = frame.size();
    let mut svg = open(MARGIN.0 + width + MARGIN.2, MARGIN.1 + height + MARGIN.3, title);
    let sizes = map.sizes_t();
    let levels = levels(map, &sizes, &frame);
    // An inner svg clips without an id, so that several figures can share a page.
    let _ = write!(
        svg,
        "<svg x=\"{0:.1}\" y=\"{1:.1}\" width=\"{width:.1}\" height=\"{height:.1}\" viewBox=\"{0:.1} {1:.1} {width:.1} {height:.1}\">",
        MARGIN.0, MARGIN.1
    );
    bands(&mut svg, map, &sizes, &levels, &frame);
    flux_lines(&mut svg, map, &frame);
    borders(&mut svg, map, &frame);
    svg.push_str("</svg>");
    scales(&mut svg, design, &frame);
    colour_bar(&mut svg, &levels, &frame);
    svg.push_str("</svg>\n");
    svg
}

/// Round lower limits of the bands, T.
fn levels(map: &Map, sizes: &[f64], frame: &Frame) -> Vec<f64> {
    let mut shown: Vec<(f64, f64)> = map
        .corners()
        .filter(|(_, t)| t.iter().all(|n| frame.shows(map.points[*n])))
        .map(|(_, [a, b, c])| {
            let [p, q, r] = [a, b, c].map(|n| map.points[n]);
            let area = 0.5 * ((q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])).abs();
            (sizes[a].max(sizes[b]).max(sizes[c]), area)
        })
        .collect();
    shown.sort_by(|a, b| a.0.total_cmp(&b.0));
    let all: f64 = shown.iter().map(|(_, area)| area).sum();
    let mut sum = 0.0;
    let most = shown.iter().find(|(_, area)| {
        sum += area;
        sum >= (1.0 - BEYOND) * all
    });
    let most = most.map_or(1.0, |(size, _)| *size).max(1e-9);
    let rough = most / BANDS as f64;
    let decade = 10_f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 2.5, 5.0, 10.0].into_iter().map(|m| m * decade).find(|s| *s >= rough).unwrap_or(rough);
    (0..BANDS).map(|i| step * i as f64).take_while(|level| *level < most).collect()
}

/// Every region by itself, for |B| jumps between them.
fn bands(svg: &mut String, map: &Map, sizes: &[f64], levels: &[f64], frame: &Frame) {
    let regions = map.regions.iter().copied().max().unwrap_or(0);
    for region in 0..=regions {
        let triangles: Vec<[usize; 3]> = map
            .corners()
            .filter(|(own, t)| *own == region && t.iter().any(|n| frame.shows(map.points[*n])))
            .map(|(_, t)| t)
            .collect();
        let sheet = Sheet { points: map.points.clone(), values: sizes.to_vec(), triangles };
        for (band, level) in levels.iter().enumerate() {
            let floor = if band == 0 { f64::NEG_INFINITY } else { *level };
            let d = path(&sheet.region(floor), frame);
            if !d.is_empty() {
                let colour = ramp(share(band, levels.len()));
                // A hair of its own colour closes the seams between regions.
                let _ = write!(svg, "<path d=\"{d}\" fill=\"{colour}\" stroke=\"{colour}\" stroke-width=\"0.4\"/>");
            }
        }
    }
}

/// Closed outlines as one path, to a tenth of a pixel.
fn path(outlines: &[Vec<[f64; 2]>], frame: &Frame) -> String {
    let mut d = String::new();
    for outline in outlines {
        let mut last = [i64::MIN; 2];
        for (i, point) in outline.iter().enumerate() {
            let here = frame.px(*point).map(|c| (10.0 * c).round() as i64);
            if i > 0 && here == last {
                continue;
            }
            let [x, y] = here.map(|c| c as f64 / 10.0);
            let _ = write!(d, "{}{x} {y}", if i == 0 { 'M' } else { 'L' });
            last = here;
        }
        d.push('Z');
    }
    d
}

/// Lines along which the potential is constant, in even steps of what is shown.
fn flux_lines(svg: &mut String, map: &Map, frame: &Frame) {
    let shown = (0..map.points.len()).filter(|n| frame.shows(map.points[*n])).map(|n| map.stream[n]);
    let (low, high) = shown.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
    let step = (high - low) / LINES as f64;
    let mut d = String::new();
    for (_, triangle) in map.corners().filter(|(_, t)| t.iter().any(|n| frame.shows(map.points[*n]))) {
        let values = triangle.map(|n| map.stream[n]);
        let (least, most) = values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(*v), h.max(*v)));
        let first = ((least - low) / step).ceil().max(1.0) as usize;
        for line in first..LINES {
            let level = low + step * line as f64;
            if level > most {
                break;
            }
            let cuts: Vec<[f64; 2]> = (0..3)
                .filter_map(|i| {
                    let (a, b) = (triangle[i], triangle[(i + 1) % 3]);
                    let (u, v) = (map.stream[a] - level, map.stream[b] - level);
                    let place = u / (u - v);
                    let (p, q) = (map.points[a], map.points[b]);
                    ((u < 0.0) != (v < 0.0)).then(|| [p[0] + place * (q[0] - p[0]), p[1] + place * (q[1] - p[1])])
                })
                .collect();
            if let [p, q] = cuts.as_slice() {
                let ([x0, y0], [x1, y1]) = (frame.px(*p), frame.px(*q));
                let _ = write!(d, "M{x0:.1} {y0:.1}L{x1:.1} {y1:.1}");
            }
        }
    }
    let _ =
        write!(svg, "<path d=\"{d}\" fill=\"none\" stroke=\"#15364f\" stroke-width=\"0.8\" stroke-opacity=\"0.7\"/>");
}

/// Sides between triangles of two regions.
fn borders(svg: &mut String, map: &Map, frame: &Frame) {
    let key = |p: [f64; 2]| p.map(|c| (1e6 * c).round() as i64);
    let mut sides = std::collections::BTreeMap::new();
    let mut d = String::new();
    for (region, triangle) in map.corners() {
        for i in 0..3 {
            let (p, q) = (map.points[triangle[i]], map.points[triangle[(i + 1) % 3]]);
            let side = if key(p) < key(q) { (key(p), key(q)) } else { (key(q), key(p)) };
            if sides.insert(side, region).is_some_and(|other| other != region) {
                let ([x0, y0], [x1, y1]) = (frame.px(p), frame.px(q));
                let _ = write!(d, "M{x0:.1} {y0:.1}L{x1:.1} {y1:.1}");
            }
        }
    }
    let _ =
        write!(svg, "<path d=\"{d}\" fill=\"none\" stroke=\"#000\" stroke-width=\"1.4\" stroke-linecap=\"round\"/>");
}

/// Frame and scales in millimetres.
fn scales(svg: &mut String, design: &Design, frame: &Frame) {
    let (width, height) = frame.size();
    let _ = write!(
        svg,
        "<rect x=\"{}\" y=\"{}\" width=\"{width:.1}\" height=\"{height:.1}\" fill=\"none\" stroke=\"#333\"/>",
        MARGIN.0, MARGIN.1
    );
    let span = (frame.high[0] - frame.low[0]).max(frame.high[1] - frame.low[1]);
    let decade = 10_f64.powf((span / 8.0).log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].into_iter().map(|m| m * decade).find(|s| *s >= span / 8.0).unwrap_or(span);
    for k in 0..2 {
        let mut tick = (frame.low[k] / step).ceil() * step;
        while tick <= frame.high[k] {
            let text = number(if tick.abs() < 1e-9 * step { 0.0 } else { tick });
            if k == 0 {
                let [x, y] = frame.px([tick, frame.low[1]]);
                let _ = write!(svg, "<path d=\"M{x:.1} {y:.1}v4\" stroke=\"#333\"/>");
                let _ = write!(svg, "<text x=\"{x:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{text}</text>", y + 17.0);
            } else {
                let [x, y] = frame.px([frame.low[0], tick]);
                let _ = write!(svg, "<path d=\"M{x:.1} {y:.1}h-4\" stroke=\"#333\"/>");
                let _ =
                    write!(svg, "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{text}</text>", x - 7.0, y + 4.0);
            }
            tick += step;
        }
    }
    let names = if design.geometry == Geometry::Plane { ["x (mm)", "y (mm)"] } else { ["radius (mm)", "height (mm)"] };
    let (x, y) = (MARGIN.0 + 0.5 * width, MARGIN.1 + height + 36.0);
    let _ = write!(svg, "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"middle\">{}</text>", names[0]);
    let y = MARGIN.1 + 0.5 * height;
    let _ =
        write!(svg, "<text transform=\"translate(16 {y:.1}) rotate(-90)\" text-anchor=\"middle\">{}</text>", names[1]);
}

fn colour_bar(svg: &mut String, levels: &[f64], frame: &Frame) {
    let (width, height) = frame.size();
    let step = ((height - 30.0) / levels.len() as f64).min(25.0);
    bar::draw(svg, (MARGIN.0 + width + 26.0, MARGIN.1 + height), step, levels, &["|B| (T)"]);
}
