//! The self-test program of a bare NUCLEO-F429ZI; `palpate selftest` talks to it. On the host this is a stub.
//!
//! Wires, steps and limits: `docs/selftest.md`.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
#[embassy_executor::main]
async fn main(spawner: embassy_executor::Spawner) {
    firmware::image::selftest::run(spawner);
}

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("selftest runs on the board: build it with --target thumbv7em-none-eabihf");
    std::process::exit(2);
}
