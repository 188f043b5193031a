//! `palpate log`.

use std::path::PathBuf;

use clap::Args;
use miette::IntoDiagnostic;
use serde_json::json;

use crate::link::{Address, Link};
use crate::log::{Recorder, live_view};
use crate::session::{Patience, Session};

/// Which board, and where to write.
#[derive(Debug, Args)]
pub struct Arguments {
    /// The board: sim, tcp:HOST:PORT or serial:PATH
    #[arg(long, default_value = "sim")]
    board: Address,
    /// Write a line a record to this file
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Write telemetry, verdicts, faults and truth to this file
    #[arg(long, value_name = "FILE")]
    mcap: Option<PathBuf>,
    /// Stop after this many seconds; without, on q or Ctrl-C
    #[arg(long, value_name = "S")]
    seconds: Option<f64>,
    /// Telemetry every n-th control tick only
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u8).range(1..), value_name = "N")]
    every: u8,
    /// Print one JSON object on standard output at the end
    #[arg(long)]
    json: bool,
}

/// Longest wait between two drawings, s.
const REFRESH_S: f64 = 0.1;

/// Listens, shows and logs until told to stop.
///
/// # Errors
/// A board that cannot be reached or falls silent, or a file that cannot be written.
pub fn run(arguments: &Arguments) -> miette::Result<()> {
    let mut recorder = Recorder::create(arguments.csv.as_deref(), arguments.mcap.as_deref()).into_diagnostic()?;
    let link = crate::link::open(&arguments.board).into_diagnostic()?;
    let (mut session, hello) = Session::open(link, Patience::default()).into_diagnostic()?;
    session.set_telemetry(arguments.every).into_diagnostic()?;
    let mut view = live_view(session.link().name(), Vec::new());
    let simulated = if hello.simulated { ", simulated surroundings" } else { "" };
    view.note(&format!("listening to {}{simulated}", session.link().name()));
    let started_s = session.link().now_s();
    let mut heard_s = started_s;
    let outcome = loop {
        let now_s = session.link().now_s();
        if arguments.seconds.is_some_and(|s| now_s - started_s >= s) || view.refresh() {
            break Ok(());
        }
        match session.poll(now_s + REFRESH_S) {
            Err(error) => break Err(error),
            Ok(event) => {
                for truth in session.link_mut().take_truth() {
                    recorder.truth(truth).into_diagnostic()?;
                }
                if let Some(event) = event {
                    heard_s = now_s;
                    recorder.event(&event, &session.traffic()).into_diagnostic()?;
                    view.event(&event, &session.traffic());
                }
                recorder.keep_if_due().into_diagnostic()?;
            }
        }
        // Telemetry may be rare; a status request tells a slow board from a silent one.
        if session.link().now_s() - heard_s > SILENCE_S {
            match session.status() {
                Ok(_) => heard_s = session.link().now_s(),
                Err(error) => break Err(error),
            }
        }
    };
    drop(view);
    recorder.finish().into_diagnostic()?;
    let traffic = session.traffic();
    if arguments.json {
        outln!("{}", json!({ "telemetry": traffic, "seconds": session.link().now_s() - started_s }));
    } else {
        errln!(
            "telemetry  {} of {} records lost, {} of {} frames lost, {} damaged",
            traffic.telemetry_lost,
            traffic.telemetry_received + traffic.telemetry_lost,
            traffic.frames_lost,
            traffic.frames_received + traffic.frames_lost,
            traffic.frames_damaged
        );
    }
    outcome.into_diagnostic()
}

/// Silence after which the board is asked whether it is still there, s.
const SILENCE_S: f64 = 1.0;
