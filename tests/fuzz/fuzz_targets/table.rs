//! Look-up tables, with their CRCs made right.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    if let Err(what) = tests::robustness::table(bytes) {
        panic!("{what}");
    }
});
