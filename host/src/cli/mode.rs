//! `palpate board mode`: the link is held for as long as outputs are on, because the board switches them off a second after
//! the last word of its host.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use clap::Subcommand;
use miette::IntoDiagnostic;
use protocol::message::{Estimate, FaultReport, Mode, State, Verdict};
use serde_json::{Value, json};

use super::answer::Answer;
use super::together::{self, Together};
use crate::control::ShownTicks;
use crate::link::Link;
use crate::log::{LogError, Recorder, estimate_text, verdict_text};
use crate::session::{Event, Gap, Session, SessionError, fault_text, gap_text};
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
    /// Press and display at once: what is identified is displayed from its verdict on
    Together(Together),
}

pub(super) fn positive_mm(text: &str) -> Result<f32, String> {
    positive(text).map(|mm| mm as f32).map_err(|_| format!("{text} is not a height above 0 mm"))
}

pub(super) fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(seconds) if seconds.is_finite() && seconds > 0.0 => Ok(seconds),
        _ => Err(format!("{text} is not a number of seconds above 0")),
    }
}

/// Longest wait for a word of the board before signals are looked at, s.
const TURN_S: f64 = 0.1;

/// Longest way of the arm to its home, s: the board gives it 30.
const HOME_S: f64 = 40.0;

/// What was begun did not end as it should; outputs are off.
#[derive(Debug, thiserror::Error)]
pub(super) enum Unfinished {
    /// The board did not begin.
    #[error(transparent)]
    Refused(SessionError),
    /// It latched a fault.
    #[error("{}", fault_text(.0))]
    Fault(FaultReport),
    /// It has restarted.
    #[error("outputs are off: {}", gap_text(.0))]
    Gap(Gap),
    /// The way to it is gone: it has switched off by itself.
    #[error(transparent)]
    Lost(SessionError),
    /// A signal.
    #[error("stopped before the verdict: outputs are off, and the arm went home")]
    Stopped,
    /// It took too long.
    #[error(
        "no verdict within {timeout_s} s (state {state}): outputs are off, and the arm went home; --timeout SECONDS waits longer"
    )]
    Late {
        /// What it was given.
        timeout_s: f64,
        /// What the board was doing.
        state: String,
    },
    /// The recording cannot go on.
    #[error(transparent)]
    Log(#[from] LogError),
}

/// What a palpation gave: verdict and, where there is one, the filter's estimate.
#[derive(Debug)]
pub(super) struct Pressed {
    pub(super) verdict: Verdict,
    pub(super) estimate: Option<Estimate>,
}

/// Switches the outputs off however it ends, and holds the link until the arm is home: a board without a host latches a fault on
/// the way. A lost link switches off by itself. What the board says is recorded, if it is to be.
pub(super) struct Outputs<'a, L: Link> {
    session: &'a mut Session<L>,
    recorder: Option<&'a mut Recorder>,
}

impl<L: Link> Drop for Outputs<'_, L> {
    fn drop(&mut self) {
        if self.session.set_mode(Mode::Idle).is_err() {
            return;
        }
        let until_s = self.session.link().now_s() + HOME_S;
        while let Ok(Some(event)) = self.session.poll(until_s) {
            // The way home matters more than its recording; an error of the file is told when it is finished.
            let _ = self.keep(&event);
            if matches!(event, Event::Telemetry(record) if matches!(record.state, State::Idle | State::Fault)) {
                return;
            }
        }
    }
}

impl<'a, L: Link> Outputs<'a, L> {
    /// Of what has been switched on over this session.
    pub(super) fn of(session: &'a mut Session<L>) -> Self {
        Outputs { session, recorder: None }
    }

    pub(super) fn session(&mut self) -> &mut Session<L> {
        self.session
    }

    /// Why a press that was waited for did not end.
    pub(super) fn unfinished(&self, timeout_s: f64, stop: &AtomicBool) -> Unfinished {
        if stop.load(Ordering::Relaxed) {
            return Unfinished::Stopped;
        }
        let state = self.session.latest_status().map(|status| format!("{:?}", status.state).to_lowercase());
        Unfinished::Late { timeout_s, state: state.unwrap_or_else(|| "unknown".to_owned()) }
    }

    fn keep(&mut self, event: &Event) -> Result<(), LogError> {
        let Some(recorder) = &mut self.recorder else { return Ok(()) };
        for truth in self.session.link_mut().take_truth() {
            recorder.truth(truth)?;
        }
        recorder.event(event, &self.session.traffic())
    }

    /// The next event, or `None` at the end of the time or when told to stop.
    ///
    /// # Errors
    /// A lost board, and a fault or a restart, which have switched the outputs off.
    pub(super) fn next(&mut self, until_s: f64, stop: &AtomicBool) -> Result<Option<Event>, Unfinished> {
        loop {
            let now_s = self.session.link().now_s();
            if stop.load(Ordering::Relaxed) || now_s >= until_s {
                return Ok(None);
            }
            let event = self.session.poll(until_s.min(now_s + TURN_S)).map_err(Unfinished::Lost)?;
            if let Some(event) = &event {
                self.keep(event)?;
            }
            match event {
                Some(Event::Fault(fault)) => return Err(Unfinished::Fault(fault)),
                Some(Event::Gap(gap)) => return Err(Unfinished::Gap(gap)),
                Some(event) => return Ok(Some(event)),
                None => {}
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
            let mode = Mode::Palpate { rate_mm_s: rate, depth_mm: depth };
            let pressed = palpate(session, mode, timeout, &stop, None).into_diagnostic()?;
            let value = json!({ "mode": mode, "verdict": pressed.verdict, "estimate": pressed.estimate });
            Ok((value, pressed_text(&pressed, &[])))
        }
        ModeChoice::Display { material, seconds } => {
            signals::stop_on_signals(&stop).into_diagnostic()?;
            display(session, Mode::Display { material }, seconds, &stop).into_diagnostic()
        }
        ModeChoice::Together(ref together) => {
            signals::stop_on_signals(&stop).into_diagnostic()?;
            together::run(session, together, &stop).into_diagnostic()
        }
    }
}

/// Verdict and estimate in one line each; the library gives names to indices.
pub(super) fn pressed_text(pressed: &Pressed, library: &[String]) -> String {
    let verdict = verdict_text(&pressed.verdict, library);
    match &pressed.estimate {
        Some(estimate) => format!("{verdict}\n{}", estimate_text(estimate)),
        None => verdict,
    }
}

/// One palpation, until the arm is home again.
pub(super) fn palpate<L: Link>(
    session: &mut Session<L>,
    mode: Mode,
    timeout_s: f64,
    stop: &AtomicBool,
    recorder: Option<&mut Recorder>,
) -> Result<Pressed, Unfinished> {
    let until_s = session.link().now_s() + timeout_s;
    session.set_mode(mode).map_err(Unfinished::Refused)?;
    let mut outputs = Outputs { session, recorder };
    let (mut estimate, mut verdict): (Option<Estimate>, Option<Verdict>) = (None, None);
    while let Some(event) = outputs.next(until_s, stop)? {
        match event {
            Event::Estimate(one) => estimate = Some(one),
            Event::Verdict(one) => verdict = Some(one),
            Event::Telemetry(record) if record.state == State::Idle && verdict.is_some() => break,
            _ => {}
        }
    }
    match verdict {
        Some(verdict) => Ok(Pressed { verdict, estimate }),
        None => Err(outputs.unfinished(timeout_s, stop)),
    }
}

/// Displays until told to stop.
fn display<L: Link>(
    session: &mut Session<L>,
    mode: Mode,
    seconds: Option<f64>,
    stop: &AtomicBool,
) -> Result<Answer, Unfinished> {
    let began_s = session.link().now_s();
    session.set_mode(mode).map_err(Unfinished::Refused)?;
    let mut outputs = Outputs::of(session);
    if let Mode::Display { material } = mode {
        errln!("displaying material {material}; Ctrl-C switches the outputs off");
    }
    let mut ticks = ShownTicks::default();
    while let Some(event) = outputs.next(began_s + seconds.unwrap_or(f64::INFINITY), stop)? {
        if let Event::Telemetry(record) = event {
            ticks.add(&record);
        }
    }
    let displayed_s = outputs.session.link().now_s() - began_s;
    drop(outputs);
    let answer: Value = json!({ "mode": mode, "seconds": displayed_s, "ticks": ticks.json() });
    Ok((answer, format!("displayed for {displayed_s:.1} s, outputs off; {ticks}")))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use protocol::message::Outcome;

    use super::*;
    use crate::link::{InProcess, Pace};
    use crate::plant::Jitter;
    use crate::session::Patience;
    use crate::simulated_board::{SimulatedBoard, press_table};

    /// A board with a table, and nothing under its probe.
    fn session() -> Session<InProcess> {
        let link = InProcess::new(SimulatedBoard::new(1, Jitter::NONE), Pace::Free);
        let (mut session, _) = Session::open(link, Patience::default()).unwrap();
        session.upload(&press_table().to_bytes().unwrap(), |_| {}).unwrap();
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
