//! Experiment folders: a description and a data file.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    if let Err(what) = tests::robustness::experiment(bytes) {
        panic!("{what}");
    }
});
