//! Quantities over the last ten seconds.

use std::collections::VecDeque;

use protocol::TICK_HZ;
use protocol::message::Telemetry;
use ratatui::Frame;
use ratatui::layout::Rect;
use ratatui::style::Style;
use ratatui::symbols::Marker;
use ratatui::text::{Line, Span};
use ratatui::widgets::{Axis, Block, Chart, Dataset, GraphType};

use super::{Palette, SHOWN_TICKS};

/// Length of the time axis, s.
const SHOWN_S: f64 = SHOWN_TICKS as f64 / TICK_HZ as f64;

/// Height from which a chart has a labelled time axis, lines.
const LABELLED: u16 = 9;

/// One quantity.
pub(super) struct Trace {
    /// Name in the chart's title.
    pub name: &'static str,
    /// Colour, if there are colours.
    pub style: Style,
    /// Drawn as separate dots, so that it is told from a line without colour too.
    pub dotted: bool,
    /// Its value in a record.
    pub value: fn(&Telemetry) -> f32,
}

/// Draws a chart. Its scale holds at least `least` above zero, so that noise does not fill the picture.
pub(super) fn draw_traces(
    frame: &mut Frame<'_>,
    area: Rect,
    title: &str,
    records: &VecDeque<Telemetry>,
    traces: &[Trace],
    least: f64,
    palette: Palette,
) {
    let newest_tick = records.back().map_or(0, |t| t.tick);
    // Time before now: the axis stands still, and a restarted board begins at its right end.
    let points: Vec<Vec<(f64, f64)>> = traces.iter().map(|trace| of(trace, records, newest_tick)).collect();
    let (low, high) = scale(points.iter().flatten().map(|p| p.1), least);
    let datasets = traces.iter().zip(&points).map(|(trace, data)| {
        let (marker, kind) =
            if trace.dotted { (Marker::Dot, GraphType::Scatter) } else { (Marker::Braille, GraphType::Line) };
        Dataset::default().marker(marker).graph_type(kind).style(trace.style).data(data)
    });
    let mut heading = vec![Span::styled(format!(" {title} "), palette.strong())];
    for trace in traces {
        let sign = if trace.dotted { "•" } else { "─" };
        heading.push(Span::styled(format!("{sign} {} ", trace.name), trace.style));
    }
    let quiet = palette.quiet();
    // A low chart is all trace: its neighbour shows the same time.
    let time = [Span::styled(format!("-{SHOWN_S:.0} s"), quiet), Span::styled("now", quiet)];
    let values = [Span::styled(number(low), quiet), Span::styled(number(high), quiet)];
    let chart = Chart::new(datasets.collect())
        .block(Block::bordered().border_style(quiet).title(Line::from(heading)))
        .legend_position(None)
        .x_axis(
            Axis::default()
                .style(quiet)
                .bounds([-SHOWN_S, 0.0])
                .labels(time.into_iter().filter(|_| area.height >= LABELLED)),
        )
        .y_axis(Axis::default().style(quiet).bounds([low, high]).labels(values));
    frame.render_widget(chart, area);
}

/// Finite values of a trace over seconds before the newest tick.
fn of(trace: &Trace, records: &VecDeque<Telemetry>, newest_tick: u32) -> Vec<(f64, f64)> {
    // A dot a tick would be a line again.
    let every = if trace.dotted { TICK_HZ / 5 } else { 1 };
    records
        .iter()
        .filter(|t| t.tick % every == 0)
        .map(|t| {
            let age = f64::from(newest_tick.saturating_sub(t.tick));
            (-age / f64::from(TICK_HZ), f64::from((trace.value)(t)))
        })
        .filter(|(_, y)| y.is_finite())
        .collect()
}

/// Bounds that hold all values and zero, rounded outward to one or two digits so that they rarely change.
pub(super) fn scale(values: impl Iterator<Item = f64>, least: f64) -> (f64, f64) {
    let (low, high) = values.fold((0.0, least), |(low, high): (f64, f64), y| (low.min(y), high.max(y)));
    let step = 10f64.powf((high - low).log10().floor()) / 2.0;
    let outward = |x: f64, step: f64| (x / step).ceil() * step;
    // A hair below zero is the sensor's noise, and shown as zero; little below zero needs little room.
    let low = if low > -0.02 * high { 0.0 } else { -outward(-low, step / 5.0) };
    (low, outward(high, step))
}

/// At most five characters.
fn number(x: f64) -> String {
    let text = if x.abs() < 1.0 { format!("{x:.2}") } else { format!("{x:.1}") };
    format!("{:>5}", text.strip_suffix(".0").unwrap_or(&text))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scales_hold_everything_and_are_round() {
        let cases: [(&[f64], f64, (f64, f64)); 5] = [
            (&[], 0.1, (0.0, 0.1)),
            (&[0.0, 0.73], 0.1, (0.0, 0.75)),
            (&[-0.001, 2.3], 0.1, (0.0, 2.5)),
            (&[-0.07, 2.3], 0.1, (-0.1, 2.5)),
            (&[12.7, 16.7], 1.0, (0.0, 20.0)),
        ];
        for (values, least, expected) in cases {
            let (low, high) = scale(values.iter().copied(), least);
            assert!(
                (low - expected.0).abs() < 1e-12 && (high - expected.1).abs() < 1e-12,
                "{values:?}: {low} to {high}"
            );
        }
    }
}
