//! Messages in sound frames: does the board stay within its limits?
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    if let Err(what) = tests::robustness::messages(bytes) {
        panic!("{what}");
    }
});
