//! What is said of a track: in the terminal, and as JSON.

use std::path::Path;

use serde_json::{Value, json};

use super::tracked::Tracked;
use crate::report::number;
use crate::track::{Position, Tip, stretches};

/// Stretches that are named one by one; more are counted.
const NAMED: usize = 4;
/// A marker that is shorter by this part one way is seen obliquely.
const TILTED: f64 = 1.03;

fn tips(tracked: &Tracked) -> Vec<Tip> {
    tracked.positions.iter().filter_map(|position| position.tip).collect()
}

/// The middle one of some values.
fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}

/// Median uncertainty along both axes, px.
fn sigma(tips: &[Tip], of: fn(&Tip) -> [f64; 2]) -> [Option<f64>; 2] {
    // The first frame's is not that of a measurement.
    let rest = if tips.len() > 1 { &tips[1..] } else { tips };
    [0, 1].map(|axis| median(rest.iter().map(|tip| of(tip)[axis]).collect()))
}

fn lost(tracked: &Tracked) -> Vec<[usize; 2]> {
    stretches(&tracked.positions, |position| position.tip.is_none())
}

fn below(tracked: &Tracked) -> Vec<[usize; 2]> {
    let is_below = |position: &Position| position.tip.is_some_and(|tip| tracked.measure.is_below(&tip));
    stretches(&tracked.positions, is_below)
}

fn named(stretches: &[[usize; 2]]) -> String {
    let told = |[from, to]: &[usize; 2]| if from == to { from.to_string() } else { format!("{from} to {to}") };
    let first: Vec<String> = stretches.iter().take(NAMED).map(told).collect();
    let more = stretches.len().saturating_sub(NAMED);
    if more > 0 { format!("{} and {more} more times", first.join(", ")) } else { first.join(", ") }
}

/// Lowest and highest place along both axes, px.
fn range(tips: &[Tip], axis: usize) -> [f64; 2] {
    let places = tips.iter().map(|tip| tip.place_px[axis]);
    places.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], at| [low.min(at), high.max(at)])
}

/// Lines for people, the answer first.
pub(super) fn lines(tracked: &Tracked, out: Option<&Path>, page: Option<&Path>) -> Vec<String> {
    let (tips, lost) = (tips(tracked), lost(tracked));
    let all = tracked.positions.len();
    let mut lines = Vec::new();
    let missing = match lost.as_slice() {
        [] => "never lost".to_owned(),
        stretches => format!("lost in {} (frame {})", all - tips.len(), named(stretches)),
    };
    lines.push(format!("tip        found in {} of {all} frames, {missing}", tips.len()));
    let [x, y] = [0, 1].map(|axis| range(&tips, axis)).map(|[low, high]| high - low);
    let scale = tracked.measure.scale;
    let in_mm = |px: f64| scale.map_or_else(String::new, |scale| format!(" ({} mm)", number(px * scale.mm_per_px)));
    lines.push(format!("travel     {} px{} across, {} px{} up and down", number(x), in_mm(x), number(y), in_mm(y)));
    let [total, own] = [sigma(&tips, |tip| tip.sigma_px), sigma(&tips, |tip| tip.own_sigma_px)];
    if let ([Some(x), Some(y)], [Some(own_x), Some(own_y)]) = (total, own) {
        let (x, y, own_x, own_y) = (number(x), number(y), number(own_x), number(own_y));
        lines.push(format!(
            "uncertain  {x} px across, {y} px up and down (1 sd, median; {own_x} and {own_y} from frame to frame)"
        ));
    }
    if let Some(scale) = scale {
        let sd = if scale.relative_sd > 0.0 {
            format!(" +- {} %", number(100.0 * scale.relative_sd))
        } else {
            String::new()
        };
        lines.push(format!("scale      {} mm a pixel{sd}", number(scale.mm_per_px)));
        if scale.tilt > TILTED {
            let tilt = number(100.0 * (scale.tilt - 1.0));
            lines.push(format!("           the marker is {tilt} % longer one way: it is seen obliquely, and lengths depend on their direction"));
        }
    }
    if let Some(surface) = tracked.measure.surface_px {
        let told = match below(tracked).as_slice() {
            [] => "never below it".to_owned(),
            stretches => format!("below it in frame {}", named(stretches)),
        };
        lines.push(format!("surface    row {}, tip {told}", number(surface)));
    }
    if let Some(encoder) = &tracked.encoder {
        let told = encoder.apart_mm.map_or_else(
            || "no time in common with the frames".to_owned(),
            |mm| format!("{} mm rms apart in {} frames, median difference taken out", number(mm), encoder.compared),
        );
        lines.push(format!("encoder    {}: {told}", encoder.name()));
    }
    if tracked.rate_hz.is_none() {
        lines.push("time       unknown: the frames have no rate, and none was told by --fps".to_owned());
    }
    if tracked.seconds > 0.0 && all > 1 {
        lines.push(format!("speed      {:.0} frames a second, reading included", all as f64 / tracked.seconds));
    }
    for (what, file) in [("written", out), ("report", page)] {
        if let Some(file) = file {
            lines.push(format!("{what:10} {}", file.display()));
        }
    }
    lines
}

/// The same for programs, with every position.
pub(super) fn json(tracked: &Tracked, out: Option<&Path>, page: Option<&Path>) -> Value {
    let tips = tips(tracked);
    let finite = |value: f64| if value.is_finite() { json!(value) } else { Value::Null };
    let row = |position: &Position| {
        json!({
            "frame": position.frame, "time_s": position.time_s, "lost": position.tip.is_none(),
            "x_px": position.tip.map(|t| t.place_px[0]), "y_px": position.tip.map(|t| t.place_px[1]),
            "sigma_x_px": position.tip.map(|t| finite(t.sigma_px[0])), "sigma_y_px": position.tip.map(|t| finite(t.sigma_px[1])),
            "own_sigma_x_px": position.tip.map(|t| finite(t.own_sigma_px[0])),
            "own_sigma_y_px": position.tip.map(|t| finite(t.own_sigma_px[1])),
            "correlation": position.tip.map(|t| t.correlation), "seen": position.tip.map(|t| t.seen),
            "gain": position.tip.map(|t| t.gain),
        })
    };
    let [total, own] = [sigma(&tips, |tip| tip.sigma_px), sigma(&tips, |tip| tip.own_sigma_px)];
    let measure = &tracked.measure;
    json!({
        "frames": tracked.positions.len(), "found": tips.len(), "lost": lost(tracked), "rate_hz": tracked.rate_hz,
        "width_px": tracked.first.width, "height_px": tracked.first.height, "roi": tracked.roi.to_string(),
        "range_x_px": range(&tips, 0), "range_y_px": range(&tips, 1),
        "median_sigma_px": total, "median_own_sigma_px": own,
        "mm_per_px": measure.scale.map(|scale| scale.mm_per_px),
        "scale_relative_sd": measure.scale.map(|scale| scale.relative_sd),
        "marker_tilt": measure.scale.map(|scale| scale.tilt),
        "surface_px": measure.surface_px, "below_surface": measure.surface_px.map(|_| below(tracked)),
        "encoder_rms_mm": tracked.encoder.as_ref().and_then(|encoder| encoder.apart_mm),
        "positions": tracked.positions.iter().map(row).collect::<Vec<_>>(),
        "seconds": tracked.seconds, "csv": out.map(|file| file.display().to_string()),
        "report": page.map(|file| file.display().to_string()),
    })
}
