//! `emulator --listen 127.0.0.1:4750`: the board's image, emulated, for `palpate --board tcp:127.0.0.1:4750`.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use emulator::board::{EmulatedBoard, LSI_HZ};
use emulator::elf::Image;
use emulator::jumpers::{AS_DRAWN, Jumpers};
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
    /// A bare NUCLEO with the three wires of the self test in place of the bench: with the image `selftest`
    #[arg(long)]
    jumpers: bool,
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
    let board = if arguments.jumpers {
        let jumpers = Jumpers::new(&AS_DRAWN);
        let mut board = EmulatedBoard::bare(Image::read(&arguments.image)?, jumpers, LSI_HZ)?;
        board.core().chip_mut().set_brown_out_3();
        board
    } else {
        let mut board = EmulatedBoard::open(&arguments.image, arguments.seed, Jitter::default())?;
        board.touch(Some(IDLE_TOUCH));
        board
    };
    let server = Server::listen(&arguments.listen, board)?;
    println!("{} runs at tcp:{}; end with Ctrl-C", arguments.image.display(), server.address());
    Ok(server.run(|| true)?)
}
