//! Horizontal bars about zero with a band that they should stay in.

use std::fmt::Write;

use crate::report::escaped;
use crate::report::figure::open;
use crate::report::number;

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
/// Where a bar reaches further than this many thresholds, the axis goes with the root, so that the band stays visible.
const EVEN: f64 = 8.0;
/// Least distance of the axis' numbers.
const TICK_PX: f64 = 34.0;

/// From values to pixels, evenly or with the root of the value.
struct Across {
    zero_px: f64,
    half_px: f64,
    reach: f64,
    root: bool,
}

impl Across {
    fn new(reach: f64, threshold: f64) -> Self {
        let half_px = 0.5 * (WIDTH_PX - RIGHT_PX - LEFT_PX);
        Self { zero_px: LEFT_PX + half_px, half_px, reach: 1.05 * reach, root: reach > EVEN * threshold }
    }

    fn px(&self, value: f64) -> f64 {
        let share = (value.abs() / self.reach).min(1.0);
        self.zero_px + self.half_px * value.signum() * if self.root { share.sqrt() } else { share }
    }

    /// Round values that are not too close to each other, zero first.
    fn ticks(&self) -> Vec<f64> {
        let mut ticks = vec![0.0];
        let mut last_px = self.zero_px;
        let round = (-3..7).flat_map(|power| [1.0, 2.0, 5.0].map(|m| m * 10_f64.powi(power)));
        let all: Vec<f64> = match self.root {
            true => round.collect(),
            false => {
                let least = self.reach * TICK_PX / self.half_px;
                let step = round.into_iter().find(|step| *step >= least).unwrap_or(self.reach);
                (1..40).map(|k| step * f64::from(k)).collect()
            }
        };
        for value in all.into_iter().filter(|value| *value <= self.reach) {
            if self.px(value) - last_px >= TICK_PX {
                last_px = self.px(value);
                ticks.extend([value, -value]);
            }
        }
        ticks
    }
}

impl Bars {
    /// The picture as an `<svg>` element.
    #[must_use]
    pub fn svg(&self) -> String {
        let rows: usize = self.groups.iter().map(|g| g.bars.len()).sum();
        let floor = TOP_PX + HEAD_PX * self.groups.len() as f64 + BAR_PX * rows as f64 + 6.0;
        let mut svg = open(WIDTH_PX, floor + 46.0, &self.title);
        let values = self.groups.iter().flat_map(|g| &g.bars).flat_map(|b| [Some(b.value), b.mark]).flatten();
        let reach = values.filter(|v| v.is_finite()).map(f64::abs).fold(1.4 * self.threshold, f64::max);
        let x = Across::new(reach, self.threshold);
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
                self.bar(&mut svg, bar, &x, y);
                y += BAR_PX;
            }
        }
        svg.push_str("</svg>\n");
        svg
    }

    /// Grid, the band, the axis, the legend.
    fn ground(&self, svg: &mut String, x: &Across, floor: f64) {
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
            let _ =
                write!(svg, "<path d=\"M{at:.1} {TOP_PX}V{floor:.1}\" stroke=\"#15364f\" stroke-dasharray=\"5 3\"/>");
        }
        let _ = write!(
            svg,
            "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\" fill=\"#15364f\">threshold {}</text><text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>",
            0.5 * (low + high),
            TOP_PX - 6.0,
            number((100.0 * self.threshold).round() / 100.0),
            x.zero_px,
            floor + 36.0,
            escaped(&if x.root { format!("{}, on a root scale", self.axis) } else { self.axis.clone() })
        );
        if let Some(mark) = &self.mark {
            let at = WIDTH_PX - 14.0 - 6.4 * mark.chars().count() as f64;
            diamond(svg, at - 10.0, 16.0);
            let _ = write!(svg, "<text x=\"{at:.1}\" y=\"20\">{}</text>", escaped(mark));
        }
    }

    fn bar(&self, svg: &mut String, bar: &Bar, x: &Across, y: f64) {
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
            let (from, to) = (x.px(0.0).min(x.px(bar.value)), x.px(0.0).max(x.px(bar.value)));
            let fill = if beyond { "#b4481e" } else { "#9fb0bc" };
            let _ = write!(
                svg,
                "<rect x=\"{from:.1}\" y=\"{:.1}\" width=\"{:.1}\" height=\"{:.1}\" fill=\"{fill}\"/>",
                y + 3.0,
                to - from,
                BAR_PX - 6.0
            );
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
            diamond(svg, x.px(mark), middle);
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
    fn bars_far_beyond_the_band_leave_it_visible() {
        let bar = |value, mark| Bar { name: "a < b".to_owned(), value, mark };
        let bars = vec![bar(500.0, Some(1.0)), bar(f64::NAN, Some(f64::INFINITY)), bar(-1.0, None)];
        let groups = vec![Group { name: "depth".to_owned(), bars }, Group { name: "rate".to_owned(), bars: vec![] }];
        let mark = Some("after".to_owned());
        let svg = Bars { title: "t".to_owned(), axis: "x".to_owned(), mark, threshold: 3.5, groups }.svg();
        assert!(svg.contains("+500.0") && svg.contains("threshold 3.5") && svg.contains("a &lt; b"), "{svg}");
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
        // on an even axis the band would be 2 of 275 pixels wide
        let across = Across::new(500.0, 3.5);
        assert!(across.root && across.px(3.5) - across.zero_px > 20.0);
        let ticks = across.ticks();
        assert!(ticks.len() > 5 && ticks.iter().all(|t| t.abs() <= 525.0), "{ticks:?}");
    }
}
