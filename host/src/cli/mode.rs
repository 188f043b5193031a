//! `palpate board mode`: the link is held for as long as outputs are on, because the board switches them off a second after
//! the last word of its host.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use clap::Subcommand;
use miette::{IntoDiagnostic, miette};
use protocol::message::{Estimate, Mode, State, Verdict};
use serde_json::{Value, json};

use super::board::Answer;
use crate::link::Link;
use crate::log::{estimate_text, verdict_text};
use crate::session::{Event, Session, fault_text, gap_text};
use crate::signals;

#[derive(Debug, Subcommand)]
pub enum ModeChoice {
    /// Outputs off
    Idle,
    /// Press the probe into a specimen, identify it, and print the verdict when the arm is home again
    Palpate {
        /// Rate of the probe, mm/s
        #[arg(long, default_value_t = 2.0)]
        rate: f32,
        /// Depth after contact, mm
        #[arg(long, default_value_t = 4.0)]
        depth: f32,
        /// Height of the specimen's surface above the base plate, mm: a press without contact ends a millimetre below it
        #[arg(long, value_name = "MM", value_parser = positive_mm)]
        surface: Option<f32>,
        /// Longest time until the arm is home again, s; then outputs go off
        #[arg(long, default_value_t = 180.0, value_name = "S", value_parser = positive)]
        timeout: f64,
    },
    /// Display a material of the table's library until Ctrl-C
    Display {
        /// Its number, from 0
        material: u8,
        /// End after this many seconds
        #[arg(long, value_name = "S", value_parser = positive)]
        seconds: Option<f64>,
    },
}

fn positive_mm(text: &str) -> Result<f32, String> {
    positive(text).map(|mm| mm as f32).map_err(|_| format!("{text} is not a height above 0 mm"))
}

fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(seconds) if seconds.is_finite() && seconds > 0.0 => Ok(seconds),
        _ => Err(format!("{text} is not a number of seconds above 0")),
    }
}

/// Longest wait for a word of the board before signals are looked at, s.
const TURN_S: f64 = 0.1;

/// Longest way of the arm to its home, s: the board gives it 30.
const HOME_S: f64 = 40.0;

/// Switches the outputs off however it ends, and holds the link until the arm is home: a board without a host latches a fault on
/// the way. A lost link switches off by itself.
struct Outputs<'a, L: Link>(&'a mut Session<L>);

impl<L: Link> Drop for Outputs<'_, L> {
    fn drop(&mut self) {
        if self.0.set_mode(Mode::Idle).is_err() {
            return;
        }
        let until_s = self.0.link().now_s() + HOME_S;
        while let Ok(Some(event)) = self.0.poll(until_s) {
            if matches!(event, Event::Telemetry(record) if matches!(record.state, State::Idle | State::Fault)) {
                return;
            }
        }
    }
}

/// Sets the mode, and stays until what it began has ended.
///
/// # Errors
/// A board that refuses, is lost, faults or does not end in time.
pub fn run<L: Link>(session: &mut Session<L>, choice: &ModeChoice) -> miette::Result<Answer> {
    let stop = Arc::new(AtomicBool::new(false));
    match *choice {
        ModeChoice::Idle => {
            session.set_mode(Mode::Idle).into_diagnostic()?;
            Ok((json!({ "mode": Mode::Idle }), "outputs off".to_owned()))
        }
        ModeChoice::Palpate { rate, depth, surface, timeout } => {
            signals::stop_on_signals(&stop).into_diagnostic()?;
            if let Some(height_mm) = surface {
                session.expect_surface(height_mm).into_diagnostic()?;
            }
            palpate(session, Mode::Palpate { rate_mm_s: rate, depth_mm: depth }, timeout, &stop)
        }
        ModeChoice::Display { material, seconds } => {
            signals::stop_on_signals(&stop).into_diagnostic()?;
            display(session, Mode::Display { material }, seconds, &stop)
        }
    }
}

/// One palpation: verdict and, where there is one, the filter's estimate.
fn palpate<L: Link>(session: &mut Session<L>, mode: Mode, timeout_s: f64, stop: &AtomicBool) -> miette::Result<Answer> {
    let until_s = session.link().now_s() + timeout_s;
    session.set_mode(mode).into_diagnostic()?;
    let outputs = Outputs(session);
    let (mut estimate, mut verdict): (Option<Estimate>, Option<Verdict>) = (None, None);
    while let Some(event) = next(outputs.0, until_s, stop)? {
        match event {
            Event::Estimate(one) => estimate = Some(one),
            Event::Verdict(one) => verdict = Some(one),
            Event::Telemetry(record) if record.state == State::Idle && verdict.is_some() => break,
            _ => {}
        }
    }
    let state = outputs.0.latest_status().map(|status| format!("{:?}", status.state).to_lowercase());
    let Some(verdict) = verdict else {
        if stop.load(Ordering::Relaxed) {
            return Err(miette!("stopped before the verdict: outputs are off, and the arm went home"));
        }
        let state = state.unwrap_or_else(|| "unknown".to_owned());
        return Err(miette!(
            "no verdict within {timeout_s} s (state {state}): outputs are off, and the arm went home; --timeout SECONDS waits longer"
        ));
    };
    let mut text = verdict_text(&verdict, &[]);
    if let Some(estimate) = &estimate {
        text = format!("{text}\n{}", estimate_text(estimate));
    }
    Ok((json!({ "mode": mode, "verdict": verdict, "estimate": estimate }), text))
}

/// Displays until told to stop.
fn display<L: Link>(
    session: &mut Session<L>,
    mode: Mode,
    seconds: Option<f64>,
    stop: &AtomicBool,
) -> miette::Result<Answer> {
    let began_s = session.link().now_s();
    session.set_mode(mode).into_diagnostic()?;
    let outputs = Outputs(session);
    if let Mode::Display { material } = mode {
        errln!("displaying material {material}; Ctrl-C switches the outputs off");
    }
    while next(outputs.0, began_s + seconds.unwrap_or(f64::INFINITY), stop)?.is_some() {}
    let displayed_s = outputs.0.link().now_s() - began_s;
    drop(outputs);
    let answer: Value = json!({ "mode": mode, "seconds": displayed_s });
    Ok((answer, format!("displayed for {displayed_s:.1} s, outputs off")))
}

/// The next event, or `None` at the end of the time or when told to stop.
///
/// # Errors
/// A lost board, and a fault or a restart, which have switched the outputs off.
fn next<L: Link>(session: &mut Session<L>, until_s: f64, stop: &AtomicBool) -> miette::Result<Option<Event>> {
    loop {
        let now_s = session.link().now_s();
        if stop.load(Ordering::Relaxed) || now_s >= until_s {
            return Ok(None);
        }
        match session.poll(until_s.min(now_s + TURN_S)).into_diagnostic()? {
            Some(Event::Fault(fault)) => return Err(miette!("{}", fault_text(&fault))),
            Some(Event::Gap(gap)) => return Err(miette!("outputs are off: {}", gap_text(&gap))),
            Some(event) => return Ok(Some(event)),
            None => {}
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use protocol::lut::{AxisSpec, Role, Scale, TableSpec, axis_name};
    use protocol::message::Outcome;

    use super::*;
    use crate::link::{InProcess, Pace};
    use crate::plant::Jitter;
    use crate::session::Patience;
    use crate::simulated_board::SimulatedBoard;

    /// A board with a table, and nothing under its probe.
    fn session() -> Session<InProcess> {
        let axis =
            |name: &str, unit: &str, role, values: &[f64]| AxisSpec::new(name, unit, role, Scale::Listed, values);
        let depths: Vec<f64> = (1..=200).map(|i| 4.0 * f64::from(i) / 200.0).collect();
        let alphas: Vec<f64> = (1..=12).map(f64::from).collect();
        let force = |alpha: f64, depth: f64| depth.powf(1.5) * (1.0 + 0.01 * alpha * depth);
        let table = TableSpec {
            columns: alphas.iter().map(|a| depths.iter().map(|d| force(*a, *d)).collect()).collect(),
            axes: vec![
                axis(axis_name::DEPTH, "mm", Role::Row, &depths),
                axis(axis_name::ALPHA, "", Role::Column, &alphas),
                axis(axis_name::MU, "MPa", Role::Factor, &[0.01, 0.1, 0.3]),
            ],
            library: vec![],
            discretisation: 0.001,
            interpolation: 0.001,
            provenance: "for a test of board mode".into(),
        };
        let link = InProcess::new(SimulatedBoard::new(1, Jitter::NONE), Pace::Free);
        let (mut session, _) = Session::open(link, Patience::default()).unwrap();
        session.upload(&table.to_bytes().unwrap(), |_| {}).unwrap();
        session
    }

    fn press(timeout: f64) -> ModeChoice {
        ModeChoice::Palpate { rate: 4.0, depth: 4.0, surface: None, timeout }
    }

    fn is_idle(session: &mut Session<InProcess>) -> bool {
        let status = session.status().unwrap();
        status.state == State::Idle && status.faults.is_empty()
    }

    #[test]
    fn a_press_is_waited_for_and_its_verdict_told() {
        let mut session = session();
        let (value, text) = run(&mut session, &press(180.0)).unwrap();
        assert_eq!(value["verdict"]["outcome"], json!(Outcome::NoContact));
        assert_eq!(text, "palpation 1: no contact before the end of the travel");
        assert!(is_idle(&mut session));
    }

    /// Home is at 30 mm: the arm turns a millimetre below the stated surface instead of above the plate.
    #[test]
    fn a_press_without_contact_ends_below_the_stated_surface() {
        let mut session = session();
        let choice = ModeChoice::Palpate { rate: 4.0, depth: 4.0, surface: Some(25.0), timeout: 180.0 };
        run(&mut session, &choice).unwrap();
        let lowest_mm = session.link_mut().board_mut().take_truth().iter().map(|t| t.probe_mm).fold(30.0, f64::min);
        // A tick of 0.08 mm, and the way in which the arm stops.
        assert!((23.5..24.1).contains(&lowest_mm), "{lowest_mm} mm");
    }

    #[test]
    fn a_press_that_takes_too_long_is_ended_and_the_arm_brought_home() {
        let mut session = session();
        let error = run(&mut session, &press(0.5)).unwrap_err().to_string();
        assert!(error.starts_with("no verdict within 0.5 s (state "), "{error}");
        assert!(error.ends_with("outputs are off, and the arm went home; --timeout SECONDS waits longer"), "{error}");
        assert!(is_idle(&mut session));
    }

    #[test]
    fn a_refused_mode_says_why() {
        let mut session = session();
        let choice = ModeChoice::Palpate { rate: 9.0, depth: 4.0, surface: None, timeout: 10.0 };
        let error = run(&mut session, &choice).unwrap_err().to_string();
        assert_eq!(error, "the simulated board refused SetMode: a value is outside the board's own limits");
        let (value, text) = run(&mut session, &ModeChoice::Idle).unwrap();
        assert_eq!((value["mode"].as_str(), text.as_str()), (Some("Idle"), "outputs off"));
    }
}
