//! `emulator --listen 127.0.0.1:4750`: the board's image, emulated, for `palpate --board tcp:127.0.0.1:4750`.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use emulator::board::EmulatedBoard;
use emulator::server::Server;
use palpate::link::IDLE_TOUCH;
use palpate::plant::Jitter;

/// Runs the board's image on an emulated STM32F429ZI in real time, with a finger on the display and nothing under the probe.
#[derive(Debug, Parser)]
#[command(name = "emulator")]
struct Arguments {
    /// Where to listen, HOST:PORT.
    #[arg(long, default_value = "127.0.0.1:4750")]
    listen: String,
    /// The image: an ELF file made by `cargo build --profile board --target thumbv7em-none-eabihf -p firmware --features board`.
    #[arg(long, default_value = "target/thumbv7em-none-eabihf/board/palpate-board")]
    image: PathBuf,
    /// Seed of the bench's noise.
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    match serve(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("emulator: {error}");
            ExitCode::FAILURE
        }
    }
}

fn serve(arguments: &Arguments) -> Result<(), Box<dyn std::error::Error>> {
    let mut board = EmulatedBoard::open(&arguments.image, arguments.seed, Jitter::default())?;
    board.touch(Some(IDLE_TOUCH));
    let server = Server::listen(&arguments.listen, board)?;
    println!("{} runs at tcp:{}; end with Ctrl-C", arguments.image.display(), server.address());
    Ok(server.run(|| true)?)
}
