//! The picture.

use protocol::TICK_HZ;
use protocol::fault::Fault;
use protocol::message::{Outcome, Recognition, State, Telemetry, Verdict};
use ratatui::Frame;
use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::style::Style;
use ratatui::text::{Line, Span};
use ratatui::widgets::{Block, Paragraph, Wrap};

use super::key::HELP;
use super::state::Weight;
use super::traces::{Trace, draw_traces};
use super::{Connection, Monitor, Palette};

/// Smallest terminal.
const LEAST: (u16, u16) = (80, 24);

/// Draws the dashboard over the whole frame.
pub fn draw(frame: &mut Frame<'_>, monitor: &Monitor, palette: Palette) {
    let area = frame.area();
    if area.width < LEAST.0 || area.height < LEAST.1 {
        let text = format!(
            "{} x {} characters; the monitor needs {} x {}. space: off, q: quit",
            area.width, area.height, LEAST.0, LEAST.1
        );
        frame.render_widget(Paragraph::new(text).wrap(Wrap { trim: true }), area);
        return;
    }
    // A tall terminal gives its lines to the traces first, and some to the journal.
    let journal = 6 + (area.height - LEAST.1) / 4;
    let [head, charts, now, below, keys] = Layout::vertical([
        Constraint::Length(1),
        Constraint::Min(8),
        Constraint::Length(3),
        Constraint::Length(journal),
        Constraint::Length(1),
    ])
    .areas(area);
    frame.render_widget(Paragraph::new(head_line(monitor, palette, area.width)), head);
    draw_charts(frame, charts, monitor, palette);
    frame.render_widget(Paragraph::new(now_lines(monitor, palette)), now);
    draw_journal(frame, below, monitor, palette);
    frame.render_widget(Paragraph::new(help_line(palette, area.width)), keys);
}

fn head_line(monitor: &Monitor, palette: Palette, width: u16) -> Line<'static> {
    let mut left = vec![Span::styled(" palpate monitor ", palette.strong().reversed()), Span::raw(" ")];
    left.push(Span::raw(monitor.board.clone()));
    match (&monitor.connection, monitor.records.back()) {
        (Connection::Opening(what), _) => left.push(Span::styled(format!("  {what} .."), palette.quiet())),
        (Connection::Lost { attempts, .. }, _) => {
            left.push(Span::styled(format!("  NO LINK, attempt {}", attempts + 1), palette.alarm()));
        }
        (Connection::Open, None) => left.push(Span::styled("  waiting for telemetry", palette.quiet())),
        (Connection::Open, Some(t)) => {
            left.push(Span::raw(format!("  {:.1} s  ", f64::from(t.tick) / f64::from(TICK_HZ))));
            let style =
                if t.state == State::Fault || !t.faults.is_empty() { palette.alarm() } else { palette.strong() };
            left.push(Span::styled(state_word(t), style));
            left.extend(t.shown.words().map(|word| Span::styled(format!(", {word}"), palette.armed())));
        }
    }
    let right = match (&monitor.upload, monitor.armed) {
        (Some((sent, length)), _) => {
            Span::styled(format!(" upload {} % ", u64::from(*sent) * 100 / u64::from(*length).max(1)), palette.armed())
        }
        (None, true) => Span::styled(" ARMED ", palette.armed()),
        (None, false) => Span::styled(" safe ", palette.good()),
    };
    let used: usize = left.iter().map(Span::width).sum::<usize>() + right.width();
    left.push(Span::raw(" ".repeat(usize::from(width).saturating_sub(used))));
    left.push(right);
    Line::from(left)
}

fn state_word(t: &Telemetry) -> &'static str {
    match t.state {
        State::Idle if t.faults.is_empty() => "idle",
        State::Idle | State::Fault => "FAULT, outputs off",
        State::Approach => "approaching",
        State::Contact => "in contact, searching",
        State::Retract => "returning",
        State::Display => "displaying",
    }
}

fn draw_charts(frame: &mut Frame<'_>, area: Rect, monitor: &Monitor, palette: Palette) {
    let [left, right] = Layout::horizontal([Constraint::Percentage(50), Constraint::Percentage(50)]).areas(area);
    let [above, below] = Layout::vertical([Constraint::Percentage(50), Constraint::Percentage(50)]).areas(right);
    let line = |name, style, value| Trace { name, style, dotted: false, value };
    let dots = |name, value| Trace { name, style: palette.wanted(), dotted: true, value };
    let records = &monitor.records;
    let force: [Trace; 2] =
        [line("load cell", palette.measured(), |t| t.load_cell_n), line("finger", palette.second(), |t| t.fsr_n)];
    draw_traces(frame, left, "force, N", records, &force, 0.1, palette);
    // While something is palpated the depth is what moves; otherwise the shaft.
    let palpating = records.iter().rev().take(TICK_HZ as usize).any(|t| t.depth_mm > 0.0);
    let position: [Trace; 2] = if palpating {
        [line("depth", palette.measured(), |t| t.depth_mm), dots("shaft", |t| t.shaft_mm)]
    } else {
        [line("shaft", palette.measured(), |t| t.shaft_mm), dots("desired", |t| t.shaft_target_mm)]
    };
    draw_traces(frame, above, "position, mm", records, &position, 0.5, palette);
    let coil: [Trace; 2] = [line("coil", palette.measured(), |t| t.coil_a), dots("desired", |t| t.coil_target_a)];
    draw_traces(frame, below, "current, A", records, &coil, 0.1, palette);
}

/// Three lines of numbers.
fn now_lines(monitor: &Monitor, palette: Palette) -> Vec<Line<'static>> {
    let Some(t) = monitor.records.back() else {
        let why = match &monitor.connection {
            Connection::Lost { reason, .. } => reason.clone(),
            _ => "no record yet".into(),
        };
        return vec![Line::styled(why, palette.quiet())];
    };
    let number = |x: f32, width: usize, digits: usize| {
        // Rounded before it is written: no negative zero.
        let scale = 10f32.powi(digits as i32);
        let rounded = (x * scale).round() / scale + 0.0;
        let text = if x.is_finite() { format!("{rounded:width$.digits$}") } else { format!("{:>width$}", "?") };
        Span::styled(text, palette.strong())
    };
    let word = |text: &'static str| Span::raw(text);
    let forces = Line::from(vec![
        word(" load cell "),
        number(t.load_cell_n, 7, 3),
        word(" N   finger "),
        number(t.fsr_n, 6, 2),
        word(" N   probe "),
        number(t.probe_mm, 7, 2),
        word(" mm   depth "),
        number(t.depth_mm, 6, 3),
        word(" mm"),
    ]);
    let outputs = Line::from(vec![
        word(" shaft "),
        number(t.shaft_mm, 6, 2),
        word(" of "),
        number(t.shaft_target_mm, 5, 2),
        word(" mm   coil "),
        number(t.coil_a, 5, 2),
        word(" of "),
        number(t.coil_target_a, 4, 2),
        word(" A, "),
        number(t.coil_c, 3, 0),
        word(" °C   drive "),
        number(t.actuator_v, 5, 2),
        word(" V"),
    ]);
    let longest = monitor.records.iter().map(|t| t.tick_us).max().unwrap_or(0);
    let mean = monitor.records.iter().map(|t| f64::from(t.tick_us)).sum::<f64>() / monitor.records.len() as f64;
    let traffic = &monitor.traffic;
    let lost = format!(
        "lost {} of {}, damaged {}",
        traffic.telemetry_lost,
        traffic.telemetry_received + traffic.telemetry_lost,
        traffic.frames_damaged
    );
    let missed = monitor.status.as_ref().map_or(0, |s| s.deadlines_missed);
    let link = Line::from(vec![
        Span::raw(format!(" tick {mean:.0} us, longest {longest}, missed {missed}   ")),
        Span::styled(lost, if traffic.telemetry_lost > 0 { palette.alarm() } else { Style::new() }),
        Span::raw(monitor.status.as_ref().map_or(String::new(), |s| format!(", not sent {}", s.frames_dropped))),
    ]);
    vec![forces, outputs, link]
}

/// What is chosen, what was found, what is wrong, and what happened.
fn draw_journal(frame: &mut Frame<'_>, area: Rect, monitor: &Monitor, palette: Palette) {
    let faults: Vec<Fault> = monitor.faults().iter().collect();
    let alarm = !faults.is_empty() || matches!(monitor.connection, Connection::Lost { .. });
    let mut lines = vec![choice_line(monitor, palette)];
    if let Connection::Lost { reason, .. } = &monitor.connection {
        lines.push(Line::styled(format!(" {reason}"), palette.alarm()));
        lines.push(Line::raw(" tried again every second; the board switches off by itself after one without a word"));
    }
    for fault in &faults {
        lines.push(Line::from(vec![
            Span::styled(format!(" ■ {}", fault.describe()), palette.alarm()),
            Span::raw(format!("; {}", fault.advice())),
        ]));
    }
    if let Some(verdict) = &monitor.verdict {
        lines.push(verdict_line(monitor, verdict, palette));
    }
    for (weight, text) in &monitor.journal {
        lines.push(match weight {
            Weight::Remark => Line::styled(format!(" {text}"), palette.quiet()),
            Weight::Verdict => Line::raw(format!(" {text}")),
            Weight::Alarm => Line::styled(format!(" {text}"), palette.alarm()),
        });
    }
    let title = match faults.len() {
        0 => Line::styled(" board ", palette.strong()),
        1 => Line::styled(" 1 fault latched ", palette.alarm()),
        n => Line::styled(format!(" {n} faults latched "), palette.alarm()),
    };
    let recording = monitor.recording.as_ref().map(|path| {
        Line::from(vec![Span::styled(" ● recording ", palette.alarm()), Span::raw(format!("{} ", path.display()))])
    });
    let border = if alarm { palette.alarm() } else { palette.quiet() };
    let block =
        Block::bordered().border_style(border).title(title).title(recording.unwrap_or_default().right_aligned());
    frame.render_widget(Paragraph::new(lines).block(block), area);
}

fn choice_line(monitor: &Monitor, palette: Palette) -> Line<'static> {
    let name = match monitor.name_of(monitor.material) {
        Some(name) => format!("{} {name}", monitor.material),
        None => monitor.material.to_string(),
    };
    let mut spans = vec![
        Span::raw(" material "),
        Span::styled(name, palette.strong()),
        Span::raw("   rate "),
        Span::styled(format!("{:.1} mm/s", monitor.rate_mm_s), palette.strong()),
    ];
    match &monitor.status {
        Some(status) if status.table_hash == [0; 16] => {
            let hint = if monitor.other_table() { ": u uploads" } else { "" };
            spans.push(Span::styled(format!("   no table{hint}"), palette.alarm()));
        }
        Some(status) => {
            let [a, b, c, ..] = status.table_hash;
            spans.push(Span::raw(format!("   table {a:02x}{b:02x}{c:02x}")));
            if monitor.other_table() {
                spans.push(Span::styled(" (not the one given: u uploads)", palette.alarm()));
            }
        }
        None => {}
    }
    Line::from(spans)
}

/// The last palpation's material, large in words.
fn verdict_line(monitor: &Monitor, verdict: &Verdict, palette: Palette) -> Line<'static> {
    let found = match (verdict.outcome, verdict.material.index) {
        (Outcome::Identified | Outcome::GridEdge, Recognition::NONE) => "not in the library".into(),
        (Outcome::Identified | Outcome::GridEdge, index) => {
            monitor.name_of(index).map_or(format!("material {index}"), str::to_owned)
        }
        _ => return Line::styled(" » no material: the palpation did not end with one", palette.strong()),
    };
    let mut spans = vec![Span::styled(format!(" » {found}"), palette.good())];
    if verdict.outcome == Outcome::Identified {
        let (mu, alpha) = match &monitor.estimate {
            Some(e) => {
                (format!("{:.4} ±{:.4}", e.mu_mpa, e.mu_error_mpa), format!("{:.2} ±{:.2}", e.alpha, e.alpha_error))
            }
            None => (format!("{:.4}", verdict.mu_mpa), format!("{:.2}", verdict.alpha)),
        };
        spans.push(Span::raw(format!("   mu {mu} MPa   alpha {alpha}   margin {:.2}", verdict.material.margin)));
    }
    Line::from(spans)
}

/// The keys, as many as fit.
fn help_line(palette: Palette, width: u16) -> Line<'static> {
    let mut spans = Vec::new();
    let mut used = 0;
    for (key, word) in HELP {
        let pair =
            [Span::styled(format!(" {key}"), palette.strong()), Span::styled(format!(" {word}"), palette.quiet())];
        used += pair.iter().map(Span::width).sum::<usize>();
        if used > usize::from(width) {
            break;
        }
        spans.extend(pair);
    }
    Line::from(spans)
}
