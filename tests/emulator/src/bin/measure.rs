//! `measure`: what the image costs on the emulated chip, as a Markdown table for `docs/performance.md`.

use std::path::PathBuf;

use clap::Parser;
use emulator::board::EmulatedBoard;
use emulator::link::EmulatedUart;
use palpate::demo;
use palpate::plant::{Jitter, Touch};
use palpate::session::{Event, Patience, Session};
use protocol::lut::Table;
use protocol::message::{Mode, State, Telemetry};

/// Lets the image palpate the demo's four foams and display one, and prints what its ticks, its idle time and its stack cost.
#[derive(Debug, Parser)]
#[command(name = "measure")]
struct Arguments {
    /// The image, an ELF file.
    #[arg(long, default_value = "target/thumbv7em-none-eabihf/board/palpate-board")]
    image: PathBuf,
}

/// Offset of bank 2 in the flash.
const BANK_2: usize = 0x10_0000;

/// Instructions a microsecond at 168 MHz and the 1.5 clocks an instruction that the emulator counts.
const PER_US: f64 = 112.0;

/// The hand at the display, and the shaft's travel that the display can follow, mm.
const TOUCH: Touch = Touch { peak_n: 3.0, period_s: 3.0 };
const STROKE_MM: f32 = 4.5;

const STATES: [State; 5] = [State::Idle, State::Approach, State::Contact, State::Retract, State::Display];

type Talk<'a> = Session<EmulatedUart<&'a mut EmulatedBoard>>;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments = Arguments::parse();
    let table = demo::demo_table(&|_| {})?;
    let parsed = Table::parse(&table)?;
    let shown = parsed.materials().position(|m| m.displacement_mm(TOUCH.peak_n as f32) <= STROKE_MM).unwrap_or(0);
    let mut board = EmulatedBoard::open(&arguments.image, 1, Jitter::default())?;
    board.core().set_flash(BANK_2, &table)?;
    board.run_to_tick(5.0)?;
    let start_ms = 1e3 * board.time_s() - 20.0;
    board.run_s(0.5)?;
    let before = board.core().instructions();
    board.run_s(1.0)?;
    let idle = board.core().instructions() - before;

    let mut records = Vec::new();
    let (mut session, _) = Session::open(EmulatedUart::new(&mut board), Patience::default())?;
    for foam in demo::bench_foams(4.0, &|_| {})? {
        session.link_mut().board().place(foam);
        session.set_mode(Mode::Palpate { rate_mm_s: 4.0, depth_mm: 4.0 })?;
        listen(&mut session, 8.0, &mut records)?;
    }
    session.set_mode(Mode::Display { material: shown as u8 })?;
    session.link_mut().board().touch(Some(TOUCH));
    listen(&mut session, 6.0, &mut records)?;
    drop(session);

    println!("| tick in state | ticks | instructions, mean | longest | longest, ms |\n|---|---|---|---|---|");
    for state in STATES {
        // A record tells the duration of the tick before it.
        let pairs = records.windows(2).filter(|w| w[0].state == state && w[1].tick == w[0].tick + 1);
        let us: Vec<f64> = pairs.map(|w| f64::from(w[1].tick_us)).collect();
        let longest = us.iter().copied().fold(0.0, f64::max);
        let mean = us.iter().sum::<f64>() / us.len().max(1) as f64;
        let (mean, most) = (mean * PER_US, longest * PER_US);
        println!("| {state:?} | {} | {mean:.0} | {most:.0} | {:.2} |", us.len(), longest * 1e-3);
    }
    let (used, all) = board.core().stack()?;
    let load = 100.0 * idle as f64 / (1e6 * PER_US);
    println!(
        "\nStart to first tick {start_ms:.0} ms; idle load {load:.1} % ({idle} instructions a second, with the fast loop at 1 kHz);"
    );
    println!("most stack used {used} of {all} bytes.");
    Ok(())
}

/// Collects records for a while.
fn listen(session: &mut Talk<'_>, for_s: f64, records: &mut Vec<Telemetry>) -> Result<(), Box<dyn std::error::Error>> {
    let until_s = session.link_mut().board().time_s() + for_s;
    while let Some(event) = session.poll(until_s)? {
        if let Event::Telemetry(record) = event {
            records.push(record);
        }
    }
    Ok(())
}
