//! `palpate monitor`.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use clap::Args;
use miette::{Context, IntoDiagnostic};
use protocol::lut::Table;

use super::progress::Progress;
use crate::demo::{Stage, bench_foams, demo_table};
use crate::link::{Address, Pace};
use crate::log::library_names;
use crate::monitor::{self, Attended, Library, Opener, Settings};

/// Which board, and where recordings go.
#[derive(Debug, Args)]
pub struct Arguments {
    /// The board: sim, auto (the one on USB), tcp:HOST:PORT or serial:PATH
    #[arg(long, default_value = "sim")]
    board: Address,
    /// The board's table, for the names of its materials and for the key that uploads it; the simulated board gets the demo's
    /// (computed first, some seconds) without
    #[arg(long, value_name = "FILE")]
    table: Option<PathBuf>,
    /// Depth of palpations after contact, mm
    #[arg(long, default_value_t = 4.0, value_name = "MM", value_parser = depth)]
    depth: f32,
    /// Folder of recordings
    #[arg(long, default_value = "out/recordings", value_name = "DIR")]
    record_to: PathBuf,
}

pub(super) fn depth(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(depth) if (0.5..=50.0).contains(&depth) => Ok(depth),
        _ => Err(format!("{text} is not a depth of 0.5 to 50 mm")),
    }
}

/// Between two attempts to open a lost link.
const RETRY: Duration = Duration::from_secs(1);

/// Shows the board until told to stop.
///
/// # Errors
/// No terminal, or a table that cannot be read.
pub fn run(arguments: &Arguments) -> miette::Result<()> {
    // Before anything is computed for a picture that cannot be shown.
    monitor::check_terminal().into_diagnostic()?;
    let simulated = arguments.board == Address::Simulated;
    let progress = Progress::new();
    let watch = |stage: Stage<'_>| {
        if let Stage::Solving { what, done, total } = stage {
            progress.set(what, done, total);
        }
    };
    let table = match &arguments.table {
        Some(path) => Some(std::fs::read(path).into_diagnostic().wrap_err_with(|| path.display().to_string())?),
        None if simulated => Some(demo_table(&watch)?),
        None => None,
    };
    let library = match &table {
        Some(bytes) => {
            let table = Table::parse(bytes).into_diagnostic().wrap_err("table")?;
            Some(Library { hash: table.hash(), names: library_names(&table) })
        }
        None => None,
    };
    let opener: Opener = if simulated {
        // A little deeper than the press: the arm overshoots.
        let foams = bench_foams(f64::from(arguments.depth), &watch)?;
        Box::new(move || Ok(Box::new(Attended::new(foams.clone(), Pace::RealTime))))
    } else {
        let board = arguments.board.clone();
        Box::new(move || crate::link::open(&board))
    };
    progress.end();
    let settings = Settings {
        table,
        upload_at_start: simulated,
        folder: arguments.record_to.clone(),
        retry: RETRY,
        stop: Arc::default(),
    };
    monitor::run(&arguments.board.to_string(), opener, library, settings, arguments.depth).into_diagnostic()
}
