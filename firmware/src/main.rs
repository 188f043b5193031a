//! The display board (STM32F429ZI on a NUCLEO-F429ZI): embassy tasks around [`firmware::board::Board`].
//!
//! Pins, tasks, rates and flashing: `docs/board.md`. On the host this is a stub.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
#[embassy_executor::main]
async fn main(spawner: embassy_executor::Spawner) {
    firmware::image::board::run(spawner);
}

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("palpate-board runs on the board: build it with --target thumbv7em-none-eabihf");
    std::process::exit(2);
}
