//! When ticks come, measured from start to start by the board itself.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use emulator::link::EmulatedUart;
use palpate::session::{Patience, Session};

use crate::common;

/// A tick that comes 2 ms late is still far from the 30 ms that are a fault.
const PUNCTUAL_US: u32 = 22_000;

#[test]
fn a_tare_and_a_saved_calibration_block_no_tick() {
    let mut board = common::board();
    let (mut session, _) = Session::open(EmulatedUart::new(&mut board), Patience::default()).unwrap();
    let mut calibration = session.calibration().unwrap();
    // Ten records: the journal is read and written with all of them there.
    for _ in 0..10 {
        calibration.load_cell.zero_ratio += 1e-3;
        session.set_calibration(calibration.clone()).unwrap();
        session.tare().unwrap();
    }
    let status = session.status().unwrap();
    println!("longest time from tick to tick {} us, {} late", status.period_max_us, status.ticks_late);
    assert!(status.period_max_us > 0 && status.period_max_us < PUNCTUAL_US, "{status:?}");
    assert_eq!(status.ticks_late, 0);
}
