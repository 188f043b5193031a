//! `palpate press`: one palpation on any board, from the first word to the verdict.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use clap::Args;
use miette::{Context, IntoDiagnostic};
use protocol::lut::Table;
use protocol::message::{Mode, Outcome, Recognition};
use serde_json::{Value, json};

use super::mode::{Pressed, Unfinished, palpate, positive, positive_mm, pressed_text};
use super::monitor::depth;
use super::progress::Progress;
use crate::demo::{Stage, bench_foams, demo_table};
use crate::link::{Address, Link, Pace};
use crate::log::{About, Recorder, library_names};
use crate::monitor::Attended;
use crate::session::{Patience, Session};
use crate::signals;

/// Exit status of a press without a name for the material.
const NOT_IN_LIBRARY: u8 = 3;
/// Exit status of a press that gave no result.
const NO_RESULT: u8 = 4;
/// Exit status of a press that did not end by itself.
const UNFINISHED: u8 = 5;

/// Which board, how to press, and where to record.
#[derive(Debug, Args)]
#[command(
    after_help = "Exit status: 0 a material of the library was touched; 2 bad input, no board, or one that refuses; 3 the material is not \
in the library (its parameters are printed); 4 no result: no contact, too short, deeper than the table and so on; 5 aborted: Ctrl-C, a fault, \
the time is over, the board is lost or a file cannot be written.\n\
Ctrl-C switches the outputs off first and waits until the arm is home; one repeated after a second ends at once, and the board stops by itself."
)]
pub struct Arguments {
    /// The board: sim, auto (the one on USB), tcp:HOST:PORT or serial:PATH
    #[arg(long, default_value = "sim")]
    board: Address,
    /// Rate of the probe, mm/s
    #[arg(long, default_value_t = 2.0, value_name = "MM_PER_S")]
    rate: f32,
    /// Depth after contact, mm
    #[arg(long, default_value_t = 4.0, value_name = "MM", value_parser = depth)]
    depth: f32,
    /// Height of the specimen's surface above the base plate, mm: a press without contact ends a millimetre below it
    #[arg(long, value_name = "MM", value_parser = positive_mm)]
    surface: Option<f32>,
    /// Longest time until the arm is home again, s; then outputs go off
    #[arg(long, default_value_t = 180.0, value_name = "S", value_parser = positive)]
    timeout: f64,
    /// The board's table, for the names of its materials; the simulated board is sent it (without, the demo's: computed first)
    #[arg(long, value_name = "FILE")]
    table: Option<PathBuf>,
    /// Record a line a record to this file; if it exists, to the next free name: FILE-2, FILE-3
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Record telemetry, verdict, faults and truth to this file; numbered as the CSV
    #[arg(long, value_name = "FILE")]
    mcap: Option<PathBuf>,
    /// Print one JSON object on standard output
    #[arg(long)]
    json: bool,
}

/// Presses, and tells the exit status.
///
/// # Errors
/// A board that cannot be reached or refuses, a table that cannot be read, or a file that cannot be made.
pub fn run(arguments: &Arguments) -> miette::Result<u8> {
    let stop = Arc::new(AtomicBool::new(false));
    signals::stop_on_signals(&stop).into_diagnostic()?;
    signals::outlive_file_limits().into_diagnostic()?;
    let table = match &arguments.table {
        Some(path) => Some(std::fs::read(path).into_diagnostic().wrap_err_with(|| path.display().to_string())?),
        None => None,
    };
    let (link, table) = open(arguments, table)?;
    let (mut session, hello) = Session::open(link, Patience::default()).into_diagnostic()?;
    if let Some(table) = table.as_ref().filter(|_| arguments.board == Address::Simulated) {
        session.upload(table, |_| {}).into_diagnostic()?;
    }
    let library = names(&mut session, table.as_deref())?;
    let about = About::of(&mut session, &hello).into_diagnostic()?;
    // Only now: a board that does not answer must not leave an empty file behind.
    let mut recorder = Recorder::create_new(arguments.csv.as_deref(), arguments.mcap.as_deref()).into_diagnostic()?;
    recorder.about(&about).into_diagnostic()?;
    let [csv, mcap] = [recorder.csv_path(), recorder.mcap_path()].map(|path| path.map(Path::to_path_buf));
    if let Some(height_mm) = arguments.surface {
        session.expect_surface(height_mm).into_diagnostic()?;
    }
    let mode = Mode::Palpate { rate_mm_s: arguments.rate, depth_mm: arguments.depth };
    let ended = palpate(&mut session, mode, arguments.timeout, &stop, Some(&mut recorder));
    // Whatever has happened: what was said until then is the recording.
    let finished = recorder.finish();
    let ended = ended.and_then(|pressed| Ok(finished.map(|()| pressed)?));
    if let Err(Unfinished::Refused(error)) = ended {
        return Err(error).into_diagnostic();
    }
    let (status, mut value, text) = told(&ended, &library);
    (value["csv"], value["mcap"]) = (json!(csv), json!(mcap));
    if arguments.json {
        outln!("{value}");
    } else if ended.is_ok() {
        outln!("{text}");
    } else {
        errln!("{text}");
    }
    for file in [csv, mcap].iter().flatten() {
        errln!("recorded   {}", file.display());
    }
    Ok(status)
}

/// A link, and the table to take names from.
type Opened = (Box<dyn Link>, Option<Vec<u8>>);

/// Opens the link; the simulated board has foams under its probe and gets a table.
fn open(arguments: &Arguments, table: Option<Vec<u8>>) -> miette::Result<Opened> {
    if arguments.board != Address::Simulated {
        return Ok((crate::link::open(&arguments.board).into_diagnostic()?, table));
    }
    let progress = Progress::new();
    let watch = |stage: Stage<'_>| {
        if let Stage::Solving { what, done, total } = stage {
            progress.set(what, done, total);
        }
    };
    let table = match table {
        Some(table) => table,
        None => demo_table(&watch)?,
    };
    let foams = bench_foams(f64::from(arguments.depth), &watch)?;
    progress.end();
    Ok((Box::new(Attended::new(foams, Pace::Free)), Some(table)))
}

/// Names of the materials, if the table is the board's.
fn names<L: Link>(session: &mut Session<L>, table: Option<&[u8]>) -> miette::Result<Vec<String>> {
    let Some(bytes) = table else { return Ok(Vec::new()) };
    let table = Table::parse(bytes).into_diagnostic().wrap_err("table")?;
    if session.has_table(&table.hash()).into_diagnostic()? {
        return Ok(library_names(&table));
    }
    errln!("the board has another table than that of --table: its materials are told by number");
    Ok(Vec::new())
}

/// Exit status, answer for programs, answer for people.
fn told(ended: &Result<Pressed, Unfinished>, library: &[String]) -> (u8, Value, String) {
    let pressed = match ended {
        Ok(pressed) => pressed,
        Err(error) => {
            let code = match error {
                Unfinished::Stopped => "stopped",
                Unfinished::Late { .. } => "late",
                Unfinished::Fault(_) => "fault",
                Unfinished::Gap(_) | Unfinished::Lost(_) | Unfinished::Refused(_) => "lost",
                Unfinished::Log(_) => "not-recorded",
            };
            return (UNFINISHED, json!({ "outcome": code, "reason": error.to_string() }), error.to_string());
        }
    };
    let index = pressed.verdict.material.index;
    let (status, code) = match pressed.verdict.outcome {
        Outcome::Identified | Outcome::GridEdge if index == Recognition::NONE => (NOT_IN_LIBRARY, "not-in-library"),
        Outcome::Identified | Outcome::GridEdge => (0, "material"),
        Outcome::Aborted => (UNFINISHED, "aborted"),
        _ => (NO_RESULT, "no-result"),
    };
    let material = (status == 0).then(|| library.get(usize::from(index)).map_or(json!(index), |name| json!(name)));
    let text = pressed_text(pressed, library);
    let value = json!({
        "outcome": code, "material": material, "verdict": pressed.verdict, "estimate": pressed.estimate, "text": text,
    });
    (status, value, text)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::link::InProcess;
    use crate::plant::{Broken, Foam, Input, Jitter};
    use crate::simulated_board::{SimulatedBoard, foam, press_table, stiffer_foam};

    struct Press {
        folder: tempfile::TempDir,
        session: Session<InProcess>,
    }

    /// A board with the table, and `foam` under its probe.
    fn with(foam: Option<Foam>) -> Press {
        let mut board = SimulatedBoard::new(1, Jitter::NONE);
        if let Some(foam) = foam {
            board.place(foam);
        }
        let (mut session, _) = Session::open(InProcess::new(board, Pace::Free), Patience::default()).unwrap();
        session.upload(&press_table().to_bytes().unwrap(), |_| {}).unwrap();
        Press { folder: tempfile::tempdir().unwrap(), session }
    }

    impl Press {
        fn told(&mut self, stop: bool) -> (u8, Value, String) {
            let mode = Mode::Palpate { rate_mm_s: 4.0, depth_mm: 3.5 };
            let mut recorder = Recorder::create_new(Some(&self.folder.path().join("press.csv")), None).unwrap();
            let ended = palpate(&mut self.session, mode, 60.0, &AtomicBool::new(stop), Some(&mut recorder));
            recorder.finish().unwrap();
            told(&ended, &["foam".into()])
        }

        fn is_at_rest(&mut self) -> bool {
            self.session.status().unwrap().mode == Mode::Idle
        }
    }

    #[test]
    fn a_material_of_the_library_is_named_with_errors_and_recorded() {
        let mut press = with(Some(foam()));
        let (status, value, text) = press.told(false);
        assert_eq!((status, &value["outcome"], &value["material"]), (0, &json!("material"), &json!("foam")), "{text}");
        assert!(text.starts_with("palpation 1: foam, mu ") && text.contains("\npalpation 1: estimate mu "), "{text}");
        let recorded = std::fs::read_to_string(press.folder.path().join("press.csv")).unwrap();
        for part in [",Approach,", ",Contact,", ",Retract,", "verdict 1 Identified"] {
            assert!(recorded.contains(part), "{part}");
        }
        assert!(press.is_at_rest());
    }

    #[test]
    fn another_material_and_none_at_all_have_exit_states_of_their_own() {
        let (status, value, text) = with(Some(stiffer_foam(2.0))).told(false);
        assert_eq!((status, &value["material"]), (NOT_IN_LIBRARY, &Value::Null), "{text}");
        assert!(text.contains("not in the library, mu "), "{text}");
        let (status, value, text) = with(None).told(false);
        assert_eq!((status, &value["outcome"]), (NO_RESULT, &json!("no-result")));
        assert_eq!(text, "palpation 1: no contact before the end of the travel");
    }

    #[test]
    fn a_signal_and_a_fault_end_it_with_the_arm_at_rest() {
        let mut press = with(Some(foam()));
        let (status, value, _) = press.told(true);
        assert_eq!((status, &value["outcome"]), (UNFINISHED, &json!("stopped")));
        assert!(press.is_at_rest());
        let mut press = with(Some(foam()));
        press.session.link_mut().board_mut().set_broken(Input::LoadCell, Some(Broken::Low));
        let (status, value, text) = press.told(false);
        assert_eq!((status, &value["outcome"]), (UNFINISHED, &json!("fault")), "{text}");
        assert!(text.starts_with("fault load-cell-open at tick "), "{text}");
        let recorded = std::fs::read_to_string(press.folder.path().join("press.csv")).unwrap();
        assert!(recorded.contains("fault load-cell-open"));
    }
}
