//! Power cuts at every write of flash that the real image makes: what it finds when the power comes back.
//!
//! What a cut leaves is the flash as it is then, and nothing else survives. So an upload (or a save) runs once, every change of the flash is noted, and a board is started
//! from the flash as it was after each of them, and in the middle of each: a word of which some bits are programmed, a sector whose bits are erased at random.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use emulator::board::{BANK_2, EmulatedBoard};
use emulator::chip::{Change, Reset};
use emulator::link::EmulatedUart;
use firmware::flash::{Setup, journal};
use firmware::sensor::ALL_FITTED;
use palpate::session::{Patience, Session};
use protocol::fault::Fault;
use protocol::frame::{self, Decoder, MAX_FRAME};
use protocol::lut::Table;
use protocol::message::{Calibration, CalibrationState, Empty, Report, Request};

use crate::common;

/// The two journals, as offsets in the flash.
const JOURNALS: [usize; 2] = [0xc_0000, 0xe_0000];

/// Records of a journal, and free places below which it is emptied at the next start (`docs/board.md`).
const RECORDS: usize = 2048;
const PLACES_LOW: usize = 64;

/// Bits that are anything: the same every time.
fn noise(at: usize) -> u32 {
    let mut x = at as u32 ^ 0x9e37_79b9;
    for _ in 0..3 {
        x = (x ^ x >> 15).wrapping_mul(0x2c1b_3c6d) ^ x << 7;
    }
    x
}

fn word(flash: &[u8], at: usize) -> u32 {
    u32::from_le_bytes(flash[at..at + 4].try_into().unwrap())
}

/// Carries a change out, whole or half.
fn apply(flash: &mut [u8], change: Change, whole: bool) {
    match change {
        Change::Word(at, new) => {
            let kept = if whole { 0 } else { word(flash, at) & noise(at) };
            flash[at..at + 4].copy_from_slice(&(new | kept).to_le_bytes());
        }
        Change::Erase(at, length) if whole => flash[at..at + length].fill(0xff),
        Change::Erase(at, length) => {
            for at in (at..at + length).step_by(4) {
                let erased = word(flash, at) | noise(at);
                flash[at..at + 4].copy_from_slice(&erased.to_le_bytes());
            }
        }
    }
}

/// A board whose flash is what a cut has left.
struct Revived {
    board: EmulatedBoard,
    flash: Vec<u8>,
}

impl Revived {
    fn new() -> Self {
        let board = common::board();
        let flash = board.flash().unwrap();
        Revived { board, flash }
    }

    /// Gives the board power with this content of its flash, and asks it one thing; it must answer within a second.
    fn ask(&mut self, flash: &[u8], request: &Request) -> Report {
        const PAGE: usize = 4096;
        for (i, (new, old)) in flash.chunks(PAGE).zip(self.flash.chunks(PAGE)).enumerate() {
            if new != old {
                self.board.core().set_flash(i * PAGE, new).unwrap();
            }
        }
        self.board.power_cycle(Reset::Power).unwrap();
        let report = self.answer(request);
        // What the start has tidied up is gone before the next one.
        self.flash = self.board.flash().unwrap();
        report
    }

    fn answer(&mut self, request: &Request) -> Report {
        let mut buffer = [0; MAX_FRAME];
        let bytes = frame::encode_request(request, 7, &mut buffer).unwrap().to_vec();
        let mut decoder = Decoder::new();
        self.board.take_transmit();
        // An erase at start may take a second before the first request is heard.
        for ms in 0..4000 {
            if ms % 50 == 0 {
                self.board.receive(&bytes);
            }
            self.board.step().unwrap();
            for byte in self.board.take_transmit() {
                if let Some(Ok(frame)) = decoder.push(byte)
                    && let Ok(report @ (Report::Status(_) | Report::Calibration(_))) =
                        Report::decode(frame.kind, frame.body)
                {
                    return report;
                }
            }
        }
        panic!("no answer within 4 s of power: {:?}", self.board.resets());
    }

    fn table_hash(&mut self, flash: &[u8]) -> [u8; 16] {
        match self.ask(flash, &Request::Status(Empty {})) {
            Report::Status(status) => status.table_hash,
            other => panic!("{other:?}"),
        }
    }

    fn calibration(&mut self, flash: &[u8]) -> Calibration {
        match self.ask(flash, &Request::GetCalibration(Empty {})) {
            Report::Calibration(calibration) => calibration,
            other => panic!("{other:?}"),
        }
    }
}

/// Every flash that a cut can leave: after each change, and in the middle of each.
fn cuts(before: &[u8], changes: &[Change], mut look: impl FnMut(usize, &[u8])) {
    let mut flash = before.to_vec();
    look(0, &flash);
    for (i, change) in changes.iter().enumerate() {
        let mut torn = flash.clone();
        apply(&mut torn, *change, false);
        look(i, &torn);
        apply(&mut flash, *change, true);
        look(i + 1, &flash);
    }
}

/// Runs something in a conversation with a board and returns the flash before and the changes.
fn changes(
    mut board: EmulatedBoard,
    act: impl FnOnce(&mut Session<EmulatedUart<&mut EmulatedBoard>>),
) -> (Vec<u8>, Vec<Change>) {
    let (mut session, _) = Session::open(EmulatedUart::new(&mut board), Patience::default()).unwrap();
    let before = session.link_mut().board().flash().unwrap();
    session.link_mut().board().core().log_flash(true);
    act(&mut session);
    let changes = session.link_mut().board().core().log_flash(false);
    drop(session);
    // What was noted is all there is.
    let mut after = before.clone();
    changes.iter().for_each(|change| apply(&mut after, *change, true));
    assert!(after == board.flash().unwrap());
    (before, changes)
}

#[test]
fn a_cut_at_any_write_of_an_upload_leaves_the_old_table_or_the_new() {
    let [old, new] = ["the first", "the second"].map(common::small_table);
    let [old_hash, new_hash] = [&old, &new].map(|bytes| Table::parse(bytes).unwrap().hash());

    let mut board = common::board();
    board.core().set_flash(BANK_2, &old).unwrap();
    let (before, changes) = changes(board, |session| {
        session.upload(&new, |_| {}).unwrap();
    });
    assert!(changes.len() > new.len() / 4, "{} changes for {} bytes", changes.len(), new.len());
    let mut revived = Revived::new();
    let mut found = [0, 0];
    cuts(&before, &changes, |at, flash| match revived.table_hash(flash) {
        hash if hash == old_hash => {
            found[0] += 1;
            assert_eq!(found[1], 0, "the old table came back after write {at} of {}", changes.len());
        }
        hash if hash == new_hash => found[1] += 1,
        hash => panic!("table {hash:02x?} after write {at} of {}", changes.len()),
    });
    println!("{} writes: {} cuts left the old table, {} the new one", changes.len(), found[0], found[1]);
    assert!(found[0] > changes.len() && found[1] > 0);
}

/// A calibration that differs in its number.
fn calibration(revived: &mut Revived, n: f32) -> Calibration {
    let flash = revived.flash.clone();
    let mut calibration = revived.calibration(&flash);
    calibration.load_cell.zero_ratio = 0.1 + 1e-4 * n;
    calibration
}

fn record(calibration: &Calibration) -> [u8; journal::RECORD_LEN] {
    journal::record(&Setup { calibration: calibration.clone(), fitted: ALL_FITTED }).unwrap()
}

#[test]
fn a_cut_at_any_write_of_a_calibration_leaves_the_old_one_or_the_new() {
    let mut revived = Revived::new();
    let [old, new] = [1.0, 2.0].map(|n| calibration(&mut revived, n));
    let mut board = common::board();
    board.core().set_flash(JOURNALS[0], &record(&old)).unwrap();
    let (before, changes) = changes(board, |session| session.set_calibration(new.clone()).unwrap());
    assert_eq!(changes.len(), journal::RECORD_LEN / 4);
    let mut newer = 0;
    cuts(&before, &changes, |at, flash| {
        let found = revived.calibration(flash);
        assert!(found == old || found == new, "{found:?} after write {at}");
        newer += u32::from(found == new);
    });
    // Only the whole record counts; a torn last word may happen to be whole.
    assert!((1..=2).contains(&newer), "{newer}");
}

#[test]
fn a_cut_while_a_full_journal_is_moved_loses_nothing() {
    let mut revived = Revived::new();
    let latest = calibration(&mut revived, 3.0);
    let older = record(&calibration(&mut revived, 4.0));
    let mut board = common::board();
    let records = RECORDS - PLACES_LOW + 1;
    let mut full = older.repeat(records - 1);
    full.extend(record(&latest));
    board.core().set_flash(JOURNALS[0], &full).unwrap();
    let before = board.flash().unwrap();
    board.core().log_flash(true);
    board.power_cycle(Reset::Power).unwrap();
    // The move erases a sector of the bank that the code runs from: 1 s.
    board.run_s(3.0).unwrap();
    let changes = board.core().log_flash(false);
    assert!(matches!(changes.last(), Some(Change::Erase(at, _)) if *at == JOURNALS[0]), "{:?}", changes.last());
    cuts(&before, &changes, |at, flash| {
        let found = revived.calibration(flash);
        assert!(found == latest, "{found:?} after write {at} of {}", changes.len());
    });
}

#[test]
fn a_journal_that_cannot_be_read_is_told_and_nothing_of_it_is_erased() {
    let mut board = common::board();
    // As another version of the firmware would have left it: not blank, no record of this one.
    for journal in JOURNALS {
        board.core().set_flash(journal, &[0x5a; 3 * journal::RECORD_LEN]).unwrap();
    }
    let before = board.flash().unwrap();
    board.core().log_flash(true);
    board.power_cycle(Reset::Power).unwrap();
    board.run_s(3.0).unwrap();
    assert_eq!(board.core().log_flash(false), []);
    assert!(board.flash().unwrap() == before);
    let (mut session, _) = Session::open(EmulatedUart::new(&mut board), Patience::default()).unwrap();
    let status = session.status().unwrap();
    assert_eq!(status.calibration, CalibrationState::Unreadable);
    assert!(status.faults.contains(Fault::CalibrationLost), "{:?}", status.faults);
}
