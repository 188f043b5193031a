//! The identification as compiled for the board gives the host's bits: the hashes of `tests/tests/suite/same_bits.rs`, computed by an emulated Cortex-M4F.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use crate::common;

#[test]
fn the_code_for_the_board_gives_the_same_bits_as_that_for_the_host() {
    let golden = std::fs::read_to_string(tests::golden::path("fingerprint-v1.txt")).unwrap();
    let hashes = emulator::bare::fingerprint(&common::bits_path()).unwrap();
    let names = ["search", "profile", "filter", "offset filter"];
    let found: String = names.iter().zip(hashes).map(|(name, hash)| format!("{name} {hash:016x}\n")).collect();
    assert_eq!(found, golden);
}
