//! What the tests of the emulated board share.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, dead_code)]

use std::path::PathBuf;
use std::sync::OnceLock;

use emulator::board::{EmulatedBoard, LSI_HZ};
use emulator::elf::Image;
use palpate::demo;
use palpate::plant::{Foam, Jitter};
use protocol::lut::{AxisSpec, Role, Scale, TableSpec, axis_name};

/// The image of the board, as it is flashed.
pub fn image() -> Image {
    let path = image_path();
    Image::read(&path).unwrap_or_else(|error| {
        panic!(
            "{error}; build it with `cargo build --profile board --target thumbv7em-none-eabihf -p firmware --features board`, \
             or name it in PALPATE_IMAGE"
        )
    })
}

/// Where the image is.
pub fn image_path() -> PathBuf {
    std::env::var_os("PALPATE_IMAGE").map_or_else(|| built("palpate-board"), PathBuf::from)
}

/// Where the self-test program is.
pub fn selftest_path() -> PathBuf {
    std::env::var_os("PALPATE_SELFTEST").map_or_else(|| built("selftest"), PathBuf::from)
}

/// Where the identification alone is.
pub fn bits_path() -> PathBuf {
    std::env::var_os("PALPATE_BITS").map_or_else(|| built("bits"), PathBuf::from)
}

/// A program for the board, where cargo puts it.
fn built(name: &str) -> PathBuf {
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../..");
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root.join("target"), PathBuf::from);
    target.join("thumbv7em-none-eabihf/board").join(name)
}

/// An emulated board on an empty bench without jitter.
pub fn board() -> EmulatedBoard {
    EmulatedBoard::new(image(), 1, Jitter::NONE, LSI_HZ).unwrap()
}

/// A table of three columns and two depths, with a provenance of its own.
pub fn small_table(provenance: &str) -> Vec<u8> {
    let axis = |name: &str, unit: &str, role, values: &[f64]| AxisSpec::new(name, unit, role, Scale::Listed, values);
    let spec = TableSpec {
        axes: vec![
            axis(axis_name::DEPTH, "mm", Role::Row, &[1.0, 2.0]),
            axis(axis_name::ALPHA, "", Role::Column, &[1.0, 2.0, 3.0]),
        ],
        columns: [1.0, 2.0, 3.0].map(|n| vec![n, 2.0 * n]).to_vec(),
        library: vec![],
        discretisation: 0.0,
        interpolation: 0.0,
        provenance: provenance.into(),
    };
    spec.to_bytes().unwrap()
}

/// The demo's table, computed once.
pub fn table() -> &'static [u8] {
    static TABLE: OnceLock<Vec<u8>> = OnceLock::new();
    TABLE.get_or_init(|| demo::demo_table(&|_| {}).unwrap())
}

/// The four foams of the bench.
pub fn foams() -> &'static [Foam] {
    static FOAMS: OnceLock<Vec<Foam>> = OnceLock::new();
    FOAMS.get_or_init(|| demo::bench_foams(4.0, &|_| {}).unwrap())
}
