//! Nothing that was recorded is lost, and every gap is told: seeded trials of `palpate log` against `palpate board serve`.
//!
//! Ten by default. All hundred: `PALPATE_TRIALS=100 cargo test -p palpate --test log_trials -- --nocapture`.
#![cfg(unix)]
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod trials;

use std::collections::BTreeMap;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

/// Trials at the same time: they mostly wait.
const AT_ONCE: usize = 5;

#[test]
fn nothing_recorded_is_lost_and_every_gap_is_told() {
    let count = std::env::var("PALPATE_TRIALS").map_or(10, |text| text.parse().expect("PALPATE_TRIALS is a number"));
    let (next, told) = (AtomicU64::new(0), Mutex::new((BTreeMap::new(), 0, Vec::new())));
    std::thread::scope(|scope| {
        for _ in 0..AT_ONCE {
            scope.spawn(|| {
                loop {
                    let seed = next.fetch_add(1, Ordering::Relaxed);
                    if seed >= count {
                        return;
                    }
                    let found = trials::trial(seed);
                    let mut told = told.lock().unwrap();
                    match found {
                        Ok((end, gaps)) => {
                            *told.0.entry(end).or_insert(0) += 1;
                            told.1 += gaps;
                        }
                        Err(error) => told.2.push(format!("seed {seed}: {error}")),
                    }
                }
            });
        }
    });
    let (ends, gaps, failed) = told.into_inner().unwrap();
    println!("{} of {count} trials as they should be, {gaps} gaps; ends: {ends:?}", count - failed.len() as u64);
    assert!(failed.is_empty(), "{}", failed.join("\n\n"));
}
