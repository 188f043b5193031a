//! The live view of a terminal.

use std::collections::VecDeque;
use std::io::{Stderr, stderr};
use std::time::{Duration, Instant};

use protocol::TICK_HZ;
use protocol::fault::Fault;
use protocol::message::Telemetry;
use ratatui::Terminal;
use ratatui::backend::CrosstermBackend;
use ratatui::crossterm::event::{self, KeyCode, KeyModifiers};
use ratatui::crossterm::execute;
use ratatui::crossterm::terminal::{EnterAlternateScreen, LeaveAlternateScreen, disable_raw_mode, enable_raw_mode};
use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::style::{Color, Style, Stylize};
use ratatui::symbols::Marker;
use ratatui::text::{Line, Span};
use ratatui::widgets::{Axis, Block, Chart, Dataset, GraphType, Paragraph};
use ratatui::{Frame, prelude::Alignment};

use super::{CurveNews, LiveView, estimate_text, verdict_text};
use crate::session::{Event, Traffic, fault_text, gap_text};

/// Ticks that the charts show: ten seconds.
const SHOWN: usize = 10 * TICK_HZ as usize;

/// Between two drawings.
const REFRESH: Duration = Duration::from_millis(100);

/// Force, shaft and coil over time, the newest values, and what happened.
pub struct Screen {
    terminal: Terminal<CrosstermBackend<Stderr>>,
    board: String,
    library: Vec<String>,
    curve: CurveNews,
    records: VecDeque<Telemetry>,
    traffic: Traffic,
    happened: VecDeque<Line<'static>>,
    drawn: Instant,
}

impl Screen {
    /// Takes over the terminal; dropping gives it back.
    ///
    /// # Errors
    /// When the terminal cannot be switched to raw mode.
    pub fn open(board: &str, library: Vec<String>) -> std::io::Result<Self> {
        enable_raw_mode()?;
        execute!(stderr(), EnterAlternateScreen)?;
        Ok(Screen {
            terminal: Terminal::new(CrosstermBackend::new(stderr()))?,
            board: board.to_owned(),
            library,
            curve: CurveNews::default(),
            records: VecDeque::with_capacity(SHOWN),
            traffic: Traffic::default(),
            happened: VecDeque::new(),
            drawn: Instant::now(),
        })
    }

    fn remember(&mut self, line: Line<'static>) {
        self.happened.push_front(line);
        self.happened.truncate(50);
    }

    fn draw(&mut self) {
        let (board, records, traffic, happened) = (&self.board, &self.records, &self.traffic, &self.happened);
        // A terminal that cannot be drawn on must not stop the log.
        let _ = self.terminal.draw(|frame| {
            let [head, charts, values, events] = Layout::vertical([
                Constraint::Length(1),
                Constraint::Min(9),
                Constraint::Length(4),
                Constraint::Length(7),
            ])
            .areas(frame.area());
            draw_head(frame, head, board, records.back());
            let [left, right] =
                Layout::horizontal([Constraint::Percentage(50), Constraint::Percentage(50)]).areas(charts);
            draw_chart(
                frame,
                left,
                "force, N",
                records,
                &[("load cell", Color::Cyan, |t| t.load_cell_n), ("FSR", Color::Magenta, |t| t.fsr_n)],
            );
            draw_chart(
                frame,
                right,
                "shaft, mm, and coil, A",
                records,
                &[
                    ("desired", Color::DarkGray, |t| t.shaft_target_mm),
                    ("shaft", Color::Yellow, |t| t.shaft_mm),
                    ("coil", Color::Green, |t| t.coil_a),
                ],
            );
            draw_values(frame, values, records.back(), traffic);
            let lines: Vec<Line<'static>> = happened.iter().cloned().collect();
            frame.render_widget(Paragraph::new(lines).block(Block::bordered().title(" verdicts and faults ")), events);
        });
    }
}

impl Drop for Screen {
    fn drop(&mut self) {
        // Nothing can be done about a terminal that does not come back.
        let _ = execute!(stderr(), LeaveAlternateScreen);
        let _ = disable_raw_mode();
    }
}

impl LiveView for Screen {
    fn event(&mut self, event: &Event, traffic: &Traffic) {
        self.traffic = *traffic;
        match event {
            Event::Telemetry(t) => {
                if self.records.len() == SHOWN {
                    self.records.pop_front();
                }
                self.records.push_back(t.clone());
            }
            Event::Halves(h) => {
                if let Some(text) = self.curve.of(h, &self.library) {
                    self.remember(text.into());
                }
            }
            Event::Estimate(e) => self.remember(estimate_text(e).into()),
            Event::Verdict(v) => self.remember(verdict_text(v, &self.library).into()),
            Event::Fault(f) => self.remember(Line::from(fault_text(f)).red()),
            Event::Gap(g) => {
                // The curves are over the board's time, which may have begun again.
                self.records.clear();
                self.remember(Line::from(gap_text(g)).yellow());
            }
        }
    }

    fn note(&mut self, text: &str) {
        self.remember(Line::from(text.to_owned()).dim());
    }

    fn refresh(&mut self) -> bool {
        if self.drawn.elapsed() >= REFRESH {
            self.drawn = Instant::now();
            self.draw();
        }
        while event::poll(Duration::ZERO).unwrap_or(false) {
            if let Ok(event::Event::Key(key)) = event::read() {
                let control_c = key.code == KeyCode::Char('c') && key.modifiers.contains(KeyModifiers::CONTROL);
                if control_c || matches!(key.code, KeyCode::Char('q') | KeyCode::Esc) {
                    return true;
                }
            }
        }
        false
    }
}

fn draw_head(frame: &mut Frame<'_>, area: Rect, board: &str, newest: Option<&Telemetry>) {
    let [left, right] = Layout::horizontal([Constraint::Min(20), Constraint::Length(16)]).areas(area);
    let mut spans = vec![Span::from(" palpate ").bold().reversed(), Span::from(format!("  {board}  "))];
    match newest {
        None => spans.push(Span::from("waiting for telemetry").dim()),
        Some(t) => {
            let time_s = f64::from(t.tick) / f64::from(TICK_HZ);
            spans.push(Span::from(format!("{time_s:.1} s  ")));
            spans.push(Span::from(format!("{:?}", t.state).to_lowercase()).bold());
            spans.extend(t.shown.words().map(|word| Span::from(format!(", {word}")).yellow()));
            let faults: Vec<&str> = t.faults.iter().map(Fault::code).collect();
            if !faults.is_empty() {
                spans.push(Span::from(format!("  {}", faults.join(", "))).red().bold());
            }
        }
    }
    frame.render_widget(Paragraph::new(Line::from(spans)), left);
    frame.render_widget(Paragraph::new("q: stop ").alignment(Alignment::Right).dim(), right);
}

fn draw_values(frame: &mut Frame<'_>, area: Rect, newest: Option<&Telemetry>, traffic: &Traffic) {
    let mut lines = Vec::new();
    if let Some(t) = newest {
        lines.push(Line::from(format!(
            "probe {:8.3} mm   depth {:6.3} mm   load cell {:7.4} N   FSR {:6.3} N   shaft {:6.3} of {:6.3} mm   {:6.3} V",
            t.probe_mm, t.depth_mm, t.load_cell_n, t.fsr_n, t.shaft_mm, t.shaft_target_mm, t.actuator_v,
        )));
        lines.push(Line::from(format!(
            "coil {:5.3} of {:5.3} A, {:4.1} C   search {:.5} N   tick {} us   telemetry lost {} of {}, frames lost {}, damaged {}",
            t.coil_a,
            t.coil_target_a,
            t.coil_c,
            t.search_error_n,
            t.tick_us,
            traffic.telemetry_lost,
            traffic.telemetry_received + traffic.telemetry_lost,
            traffic.frames_lost,
            traffic.frames_damaged,
        )));
    }
    frame.render_widget(Paragraph::new(lines).block(Block::bordered().title(" now ")), area);
}

/// A curve: name, colour, and which value of a record it shows.
type Curve = (&'static str, Color, fn(&Telemetry) -> f32);

fn draw_chart(frame: &mut Frame<'_>, area: Rect, title: &'static str, records: &VecDeque<Telemetry>, curves: &[Curve]) {
    let last_s = records.back().map_or(0.0, |t| f64::from(t.tick) / f64::from(TICK_HZ));
    let first_s = last_s - SHOWN as f64 / f64::from(TICK_HZ);
    let points: Vec<Vec<(f64, f64)>> = curves
        .iter()
        .map(|(_, _, value)| {
            records
                .iter()
                .map(|t| (f64::from(t.tick) / f64::from(TICK_HZ), f64::from(value(t))))
                .filter(|(_, y)| y.is_finite())
                .collect()
        })
        .collect();
    let all = points.iter().flatten().map(|p| p.1);
    let low = all.clone().fold(0.0, f64::min);
    let high = all.fold(0.1, f64::max) * 1.05;
    let datasets = curves
        .iter()
        .zip(&points)
        .map(|((name, colour, _), data)| {
            Dataset::default()
                .name(*name)
                .marker(Marker::Braille)
                .graph_type(GraphType::Line)
                .style(Style::default().fg(*colour))
                .data(data)
        })
        .collect();
    let chart = Chart::new(datasets)
        .block(Block::bordered().title(format!(" {title} ")))
        .x_axis(
            Axis::default()
                .bounds([first_s, last_s])
                .labels([format!("{:.0} s", first_s.max(0.0)), format!("{last_s:.0} s")]),
        )
        .y_axis(Axis::default().bounds([low, high]).labels([format!("{low:.2}"), format!("{high:.2}")]));
    frame.render_widget(chart, area);
}
