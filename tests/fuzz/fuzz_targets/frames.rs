//! Bytes on the line, at the board and at the host.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    if let Err(what) = tests::robustness::frames(bytes) {
        panic!("{what}");
    }
});
