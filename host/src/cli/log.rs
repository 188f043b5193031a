//! `palpate log`.

use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use clap::Args;
use miette::IntoDiagnostic;
use serde_json::json;

use crate::link::{Address, Link};
use crate::log::{About, Freeze, Listening, Recorder, Terms, live_view};
use crate::session::{Gap, Patience, Session, Traffic, gap_text};
use crate::signals;

/// Where the second before a fault goes when nothing is recorded; otherwise it goes beside the recording.
const FAULTS: &str = "out/recordings";

/// Which board, and where to write.
#[derive(Debug, Args)]
#[command(
    after_help = "Times: time_s (CSV) and publish_time (MCAP) are the board's, since its start; utc (CSV) and log_time (MCAP) the wall \
clock's. Neither goes back when the board restarts.\n\
Board, firmware, table and calibration stand in the note of the first row (CSV) and in the metadata record `palpate` (MCAP)."
)]
pub struct Arguments {
    /// The board: sim, auto (the one on USB), tcp:HOST:PORT or serial:PATH
    #[arg(long, default_value = "sim")]
    board: Address,
    /// Write a line a record to this file; if it exists, to the next free name: FILE-2, FILE-3
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Write telemetry, verdicts, faults, gaps and truth to this file; numbered as the CSV
    #[arg(long, value_name = "FILE")]
    mcap: Option<PathBuf>,
    /// Stop after this many seconds; without, on q, Ctrl-C or SIGTERM
    #[arg(long, value_name = "S", value_parser = seconds)]
    seconds: Option<f64>,
    /// Try a board that was lost again for this many seconds; 0: do not
    #[arg(long, default_value_t = 60.0, value_name = "S", value_parser = seconds)]
    retry: f64,
    /// Telemetry every n-th control tick only
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u8).range(1..), value_name = "N")]
    every: u8,
    /// Print one JSON object on standard output at the end
    #[arg(long)]
    json: bool,
}

fn seconds(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(seconds) if seconds.is_finite() && seconds >= 0.0 => Ok(seconds),
        _ => Err(format!("{text} is not a number of seconds, 0 or more")),
    }
}

/// Listens, shows and logs until told to stop.
///
/// # Errors
/// A board that cannot be reached or is lost for too long, or a file that cannot be written.
pub fn run(arguments: &Arguments) -> miette::Result<()> {
    let stop = Arc::new(AtomicBool::new(false));
    signals::stop_on_signals(&stop).into_diagnostic()?;
    signals::outlive_file_limits().into_diagnostic()?;
    let mut opener = || crate::link::open(&arguments.board);
    let (mut session, hello) = Session::open(opener().into_diagnostic()?, Patience::default()).into_diagnostic()?;
    session.set_telemetry(arguments.every).into_diagnostic()?;
    let about = About::of(&mut session, &hello).into_diagnostic()?;
    // Only now: a board that does not answer must not leave an empty file behind.
    let mut recorder = Recorder::create_new(arguments.csv.as_deref(), arguments.mcap.as_deref()).into_diagnostic()?;
    recorder.about(&about).into_diagnostic()?;
    let files = recorder.paths();
    let [csv, mcap] = [recorder.csv_path(), recorder.mcap_path()].map(|path| path.map(Path::to_path_buf));
    let mut view = live_view(session.link().name(), Vec::new());
    let simulated = if hello.simulated { ", simulated surroundings" } else { "" };
    view.note(&format!("listening to {}{simulated}", session.link().name()));
    let wanted = arguments.csv.iter().chain(&arguments.mcap);
    for (wanted, file) in wanted.zip(&files) {
        view.note(&file_text(wanted, file));
    }
    let terms = Terms { seconds: arguments.seconds, retry_s: arguments.retry, stop: &stop, opener: &mut opener };
    let beside = files.first().and_then(|file| file.parent()).map_or(Path::new(FAULTS), |folder| folder);
    let mut listening = Listening::new(session, recorder, Freeze::new(beside), view, terms);
    let outcome = listening.run();
    let seconds = listening.seconds();
    let Listening { session, recorder, freeze, view, gaps, .. } = listening;
    // Gives the terminal back before anything is printed.
    drop(view);
    let display = recorder.shown();
    let finished = recorder.finish();
    let traffic = session.traffic();
    if arguments.json {
        outln!(
            "{}",
            json!({ "telemetry": traffic, "seconds": seconds, "csv": csv, "mcap": mcap, "gaps": gaps, "faults": freeze.files(), "display_ticks": display.json() })
        );
    } else {
        tell(&traffic, &gaps, &[&files, freeze.files()].concat());
        if display.all > 0 {
            errln!("display    {display}");
        }
    }
    outcome.into_diagnostic()?;
    finished.into_diagnostic()
}

/// Where it is recorded, and why not where it was wanted.
fn file_text(wanted: &Path, file: &Path) -> String {
    if wanted == file {
        format!("recording to {}", file.display())
    } else {
        format!("recording to {}: {} or its companion exists, and is kept", file.display(), wanted.display())
    }
}

fn tell(traffic: &Traffic, gaps: &[Gap], files: &[PathBuf]) {
    // Lines are still there; what the screen showed is gone with it.
    if std::io::stderr().is_terminal() {
        gaps.iter().for_each(|gap| errln!("{}", gap_text(gap)));
    }
    for file in files {
        errln!("recorded   {}", file.display());
    }
    errln!(
        "telemetry  {} of {} records lost, {} of {} frames lost, {} damaged, gaps: {}",
        traffic.telemetry_lost,
        traffic.telemetry_received + traffic.telemetry_lost,
        traffic.frames_lost,
        traffic.frames_received + traffic.frames_lost,
        traffic.frames_damaged,
        gaps.len()
    );
}
