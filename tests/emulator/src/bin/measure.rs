//! `measure`: what the code for the board costs on the emulated processor, against its budgets, into `docs/performance.md`.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use ::tests::document::{replace_section, table};
use clap::Parser;
use emulator::bare::{self, Piece};
use emulator::board::{BANK_2, EmulatedBoard};
use emulator::link::EmulatedUart;
use lut_gen::solid::contact::Ball;
use lut_gen::solid::model::Specimen;
use lut_gen::table::{ForceGrid, Form, GridSpec, write};
use palpate::demo::{self, BALL_RADIUS_MM};
use palpate::plant::{Jitter, Touch};
use palpate::session::{Event, Patience, Session};
use protocol::lut::Table;
use protocol::message::{DisplayMode, DisplayState, Mode, PalpationMode, Parts, Rule, State, Telemetry};

/// Lets the image palpate the demo's four foams and display one, counts the methods of identification one by one, and prints what both cost. Exits 1
/// when a budget is exceeded.
#[derive(Debug, Parser)]
#[command(name = "measure")]
struct Arguments {
    /// The image, an ELF file; without, `PALPATE_IMAGE` or where cargo puts it.
    #[arg(long)]
    image: Option<PathBuf>,
    /// The identification alone (`firmware/src/bits.rs`), an ELF file; without, `PALPATE_BITS` or where cargo puts it.
    #[arg(long)]
    bits: Option<PathBuf>,
    /// Writes the result into `docs/performance.md`.
    #[arg(long)]
    write: bool,
}

/// Instructions a microsecond at 168 MHz and the 1.5 clocks an instruction that the emulator counts.
const PER_US: f64 = 112.0;

/// Share of a tick's 20 ms that the longest tick may take.
const TICK_SHARE: f64 = 0.10;

/// The hand at the display, and the shaft's travel that the display can follow, mm.
const TOUCH: Touch = Touch { peak_n: 3.0, period_s: 3.0 };
const STROKE_MM: f32 = 4.5;

/// Ticks that are counted: their name, state, and whether the display is on beside a palpation.
const TICKS: [(&str, State, bool); 8] = [
    ("Idle", State::Idle, false),
    ("Approach", State::Approach, false),
    ("Contact", State::Contact, false),
    ("Retract", State::Retract, false),
    ("Display", State::Display, false),
    ("Approach and display", State::Approach, true),
    ("Contact and display", State::Contact, true),
    ("Retract and display", State::Retract, true),
];

type Talk<'a> = Session<EmulatedUart<&'a mut EmulatedBoard>>;
type Failed = Box<dyn std::error::Error>;

/// A piece of the identification: slot of its table and number in `firmware/src/bits.rs`, what it is, and its budget in instructions.
const PIECES: [(u32, u32, &str, Option<f64>); 10] = [
    (1, 1, "variance search, one sample: 900 columns, mu as factor (the form that boards keep)", Some(5000.0)),
    (2, 1, "variance search, one sample: 900 columns stored one by one (the thesis' form)", None),
    (1, 2, "fast search (one row an exponent), one sample", Some(1000.0)),
    (1, 3, "Kalman filter, mu and alpha, bounded by projection, one sample", Some(8000.0)),
    (1, 4, "the same, bounded by constraints, linearised twice", Some(8000.0)),
    (1, 5, "Kalman filter with the contact offset, one sample", Some(8000.0)),
    (1, 6, "variance search, best and runner-up, once a palpation", None),
    (1, 7, "fast search, mu and alpha, once a palpation", None),
    (1, 8, "variance search, least error for telemetry, once a tick", None),
    (2, 8, "the same, columns stored one by one", None),
];

fn main() -> Result<ExitCode, Failed> {
    let arguments = Arguments::parse();
    let image = arguments.image.unwrap_or_else(|| built("PALPATE_IMAGE", "palpate-board"));
    let bits = arguments.bits.unwrap_or_else(|| built("PALPATE_BITS", "bits"));
    let demo_table = demo::demo_table(&|_| {})?;
    let (pieces, mut exceeded) = pieces(&bare::count(&bits, &demo_table, &stored()?)?);
    let (ticks, late) = ticks(&image, &demo_table)?;
    exceeded.extend(late);
    let section = format!("{pieces}\n{ticks}");
    println!("{section}");
    if arguments.write {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/performance.md");
        let document = std::fs::read_to_string(&path)?;
        std::fs::write(&path, replace_section(&document, "on the board", &section)?)?;
    }
    for what in &exceeded {
        eprintln!("over budget: {what}");
    }
    Ok(if exceeded.is_empty() { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

/// A program for the board: what the environment names, or where cargo puts it.
fn built(variable: &str, name: &str) -> PathBuf {
    let target = || {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        let folder = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root.join("target"), PathBuf::from);
        folder.join("thumbv7em-none-eabihf/board").join(name)
    };
    std::env::var_os(variable).map_or_else(target, PathBuf::from)
}

/// The thesis' grid for EVA's height with its 900 columns stored one by one.
fn stored() -> Result<Vec<u8>, Failed> {
    let spec = GridSpec::thesis(Specimen::of_height(12.7), Ball { radius_mm: BALL_RADIUS_MM });
    Ok(write(&[ForceGrid::build(&spec, &|_, _| {})?], Form::Expanded, Vec::new())?)
}

/// The table of the pieces, and those over their budgets.
fn pieces(counted: &[Piece]) -> (String, Vec<String>) {
    let mut exceeded = Vec::new();
    let rows: Vec<Vec<String>> = PIECES
        .iter()
        .map(|(slot, number, name, budget)| {
            let found = counted.iter().find(|p| (p.slot, p.number) == (*slot, *number)).map(|p| p.instructions);
            let limit = budget.unwrap_or(f64::INFINITY);
            if found.is_none_or(|found| found > limit) {
                exceeded.push(format!("{name}: {found:?} instructions, budget {budget:?}"));
            }
            vec![
                (*name).to_owned(),
                found.map_or("none".into(), |n| format!("{n:.0}")),
                budget.map_or(String::new(), |n| format!("{n:.0}")),
                found.map_or(String::new(), |n| format!("{:.2} %", share(n))),
            ]
        })
        .collect();
    (table(&["method", "instructions", "budget", "of a tick's 20 ms"], &rows), exceeded)
}

/// Percent of a tick.
fn share(instructions: f64) -> f64 {
    100.0 * instructions / PER_US / 20_000.0
}

/// The table of the image's ticks, and those over their budget.
fn ticks(image: &Path, demo_table: &[u8]) -> Result<(String, Vec<String>), Failed> {
    let parsed = Table::parse(demo_table)?;
    let shown = parsed.materials().position(|m| m.shaft_mm(TOUCH.peak_n as f32) <= STROKE_MM).unwrap_or(0);
    let mut board = EmulatedBoard::open(image, 1, Jitter::default())?;
    board.core().set_flash(BANK_2, demo_table)?;
    board.run_to_tick(5.0)?;
    let start_ms = 1e3 * board.time_s() - 20.0;
    board.run_s(0.5)?;
    let before = board.core().instructions();
    board.run_s(1.0)?;
    let idle = board.core().instructions() - before;
    let records = session(&mut board, shown as u8)?;

    let mut exceeded = Vec::new();
    let mut rows = Vec::new();
    for (name, state, both) in TICKS {
        // A record tells the duration of the tick before it.
        let is_it = |(record, shown): &(Telemetry, bool)| record.state == state && *shown == both;
        let pairs = records.windows(2).filter(|w| is_it(&w[0]) && w[1].0.tick == w[0].0.tick + 1);
        let us: Vec<f64> = pairs.map(|w| f64::from(w[1].0.tick_us)).collect();
        let longest = us.iter().copied().fold(0.0, f64::max);
        let mean = us.iter().sum::<f64>() / us.len().max(1) as f64;
        if us.is_empty() || share(longest * PER_US) > 100.0 * TICK_SHARE {
            exceeded.push(format!(
                "tick in {name}: {longest} us of {} ticks, budget {:.0} us",
                us.len(),
                20_000.0 * TICK_SHARE
            ));
        }
        rows.push(vec![
            name.to_owned(),
            us.len().to_string(),
            format!("{:.0}", mean * PER_US),
            format!("{:.0}", longest * PER_US),
            format!("{:.2}", longest * 1e-3),
            format!("{:.1} %", share(longest * PER_US)),
        ]);
    }
    let head = ["tick in state", "ticks", "instructions, mean", "longest", "longest, ms", "of 20 ms (budget 10 %)"];
    let (used, all) = board.core().stack()?;
    let load = 100.0 * idle as f64 / (1e6 * PER_US);
    let rest = format!(
        "\nStart to first tick {start_ms:.0} ms; idle load {load:.1} % ({idle} instructions a second, with the fast loop at 1 kHz);\n\
         most stack used {used} of {all} bytes.\n"
    );
    Ok((table(&head, &rows) + &rest, exceeded))
}

/// Records of four palpations and a display, and of four palpations beside a display that follows them; with each whether a display
/// was on beside a palpation.
fn session(board: &mut EmulatedBoard, shown: u8) -> Result<Vec<(Telemetry, bool)>, Failed> {
    let mut records = Vec::new();
    let (mut session, _) = Session::open(EmulatedUart::new(board), Patience::default())?;
    for foam in demo::bench_foams(4.0, &|_| {})? {
        session.link_mut().board().place(foam);
        session.set_mode(Mode::Palpate { rate_mm_s: 4.0, depth_mm: 4.0 })?;
        listen(&mut session, 8.0, &mut records)?;
    }
    session.set_mode(Mode::Display { material: shown })?;
    session.link_mut().board().touch(Some(TOUCH));
    listen(&mut session, 6.0, &mut records)?;
    session.set_mode(Mode::Idle)?;
    session.set_display(DisplayMode::Follow { parts: Parts::Both, by: Rule::Between })?;
    for foam in demo::bench_foams(4.0, &|_| {})? {
        session.link_mut().board().place(foam);
        session.set_palpation(PalpationMode::Press { rate_mm_s: 4.0, depth_mm: 4.0, surface_mm: None })?;
        listen(&mut session, 8.0, &mut records)?;
    }
    Ok(records)
}

/// Collects records for a while.
fn listen(session: &mut Talk<'_>, for_s: f64, records: &mut Vec<(Telemetry, bool)>) -> Result<(), Failed> {
    let until_s = session.link_mut().board().time_s() + for_s;
    while let Some(event) = session.poll(until_s)? {
        match event {
            Event::Telemetry(record) => records.push((record, false)),
            // Comes right after the record of the same tick.
            Event::Halves(halves) => {
                if let Some((record, both)) = records.last_mut() {
                    *both = record.tick == halves.tick
                        && halves.display == DisplayState::On
                        && record.state != State::Display;
                }
            }
            _ => {}
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_piece_over_its_budget_or_not_counted_is_told_and_one_within_is_not() {
        let count = |instructions: f64| PIECES.map(|(slot, number, ..)| Piece { slot, number, instructions });
        assert_eq!(pieces(&count(1000.0)).1, Vec::<String>::new());
        let over = pieces(&count(1001.0)).1;
        assert_eq!(
            over,
            ["fast search (one row an exponent), one sample: Some(1001.0) instructions, budget Some(1000.0)"]
        );
        assert_eq!(pieces(&[]).1.len(), PIECES.len());
    }
}
