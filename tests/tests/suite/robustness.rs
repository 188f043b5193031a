//! Everything that comes from outside: what holds of any bytes (`tests::robustness`), from arbitrary ones, from valid ones that are changed, and from
//! valid ones cut short. More of the same by fuzzing: docs/robustness.md.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use firmware::link::LinkId;
use palpate::session::{Patience, Session};
use proptest::prelude::*;
use protocol::frame::{Decoder, MAX_FRAME, encode_report, encode_request};
use protocol::lut::Table;
use protocol::message::{Empty, FaultReport, Report, Request};
use rand::{Rng, RngCore, SeedableRng};
use rand_pcg::Pcg64;
use tests::robustness::{self, Held, Portrait, Recorded, blank_board, seeds};

/// Random bytes that each parser gets.
const MANY: usize = 10_000_000;

/// Garbage between two sound frames, bytes: several of the longest frames.
const GARBAGE: usize = 1000;

/// Random bytes, in pieces. Every second piece has a zero in ten bytes instead of one in 256, so that short runs are tried as often as long ones.
fn garbage(seed: u64) -> impl Iterator<Item = Vec<u8>> {
    let mut random = Pcg64::seed_from_u64(seed);
    (0..MANY / GARBAGE).map(move |piece| {
        let mut bytes = vec![0; GARBAGE];
        random.fill_bytes(&mut bytes);
        if piece % 2 == 1 {
            bytes.iter_mut().for_each(|byte| *byte = if random.random_ratio(1, 10) { 0 } else { *byte });
        }
        bytes
    })
}

/// Whatever the line brings, the board is as it was, and answers the first frame after the zero that ends the garbage.
#[test]
fn ten_million_random_bytes_leave_the_board_as_it_was() {
    let mut board = blank_board();
    let before = Portrait::of(&mut board).unwrap();
    for bytes in garbage(1) {
        board.receive(LinkId::Usb, &bytes);
        // `Portrait::of` sends a zero and then a request, and wants its answer.
        assert_eq!(Portrait::of(&mut board).unwrap(), before);
    }
}

/// Without a zero between, the garbage costs the one frame that it runs into.
#[test]
fn garbage_without_an_end_costs_one_frame() {
    let mut out = [0; MAX_FRAME];
    let request = encode_request(&Request::Status(Empty {}), 1, &mut out).unwrap().to_vec();
    for bytes in garbage(2).take(1000) {
        let mut decoder = Decoder::new();
        let mut accepted = 0;
        for byte in bytes.iter().chain(&request).chain(&request) {
            accepted += usize::from(matches!(decoder.push(*byte), Some(Ok(_))));
        }
        assert!(accepted >= 1, "neither of two frames after the garbage was accepted");
    }
}

/// The host takes nothing for a word of the board, and hears the first frame after a zero.
#[test]
fn ten_million_random_bytes_are_no_word_of_the_board() {
    let mut out = [0; MAX_FRAME];
    let known = Report::Fault(FaultReport { tick: 7, fault: 3, value: 1.5, limit: 1.0 });
    let frame = encode_report(&known, 9, &mut out).unwrap().to_vec();
    let line: Vec<u8> = garbage(3).flat_map(|bytes| bytes.into_iter().chain([0]).chain(frame.clone())).collect();
    let mut session = Session::unopened(Recorded::new(line), Patience::default());
    let mut heard = 0;
    while let Some(event) = session.poll(1.0).unwrap() {
        assert!(
            matches!(event, palpate::session::Event::Fault(ref fault) if Report::Fault(fault.clone()) == known),
            "{event:?}"
        );
        heard += 1;
    }
    assert_eq!(heard, MANY / GARBAGE);
    assert!(session.traffic().frames_damaged as usize > MANY / 256, "{:?}", session.traffic());
}

/// Each single-bit flip of each golden frame: the board that gets it does nothing, and says nothing.
#[test]
fn no_flipped_bit_of_a_golden_frame_reaches_the_board() {
    let mut flips = 0;
    for frame in seeds::frames().iter().filter(|frame| frame.len() <= MAX_FRAME) {
        let mut board = blank_board();
        let before = Portrait::of(&mut board).unwrap();
        for bit in 0..frame.len() * 8 {
            let mut broken = frame.clone();
            broken[bit / 8] ^= 1 << (bit % 8);
            broken.push(0);
            board.receive(LinkId::Usb, &broken);
            assert_eq!(board.take_transmit(LinkId::Usb, &mut [0; 512]), 0, "bit {bit} of {frame:02x?} was answered");
            assert_eq!(Portrait::of(&mut board).unwrap(), before, "bit {bit} of {frame:02x?}");
            flips += 1;
        }
    }
    // 24 frames of 10 to 70 bytes.
    assert!(flips > 4500, "{flips}");
}

/// Each single-bit flip of a table: refused, but for those in the eight unused bytes of the header, which its CRC covers as well.
#[test]
fn no_flipped_bit_of_a_table_is_accepted() {
    for table in seeds::tables() {
        assert!(Table::parse(&table).is_ok());
        for bit in 0..table.len() * 8 {
            let mut broken = table.clone();
            broken[bit / 8] ^= 1 << (bit % 8);
            assert!(Table::parse(&broken).is_err(), "bit {bit}");
        }
    }
}

/// The checks accept what is valid: without this the tests below could pass by refusing everything.
#[test]
fn every_seed_is_accepted() {
    for (frame, plain) in seeds::frames().iter().zip(seeds::messages()) {
        let mut decoder = Decoder::new();
        assert!(frame.iter().any(|byte| matches!(decoder.push(*byte), Some(Ok(_)))));
        let (kind, body) = (plain[0], &plain[2..2 + usize::from(plain[1])]);
        assert!(kind == 0 || Request::decode(kind, body).is_ok() || Report::decode(kind, body).is_ok(), "{plain:02x?}");
    }
    assert_eq!(seeds::tables().len(), 4);
    for table in seeds::tables() {
        assert!(Table::parse(&robustness::sealed(&table)).is_ok());
    }
    for seed in seeds::experiments() {
        let text = String::from_utf8(seed).unwrap();
        let (description, data) = text.split_once("\n%%\n").unwrap();
        let folder = tempfile::TempDir::new().unwrap();
        std::fs::write(folder.path().join("experiment.toml"), description).unwrap();
        std::fs::write(folder.path().join("a.csv"), data).unwrap();
        assert!(!palpate::experiment::read(folder.path()).unwrap().runs.is_empty(), "{description}");
    }
}

/// Found by fuzzing: scales that are finite, but not so the forces of their largest counts.
#[test]
fn a_table_whose_forces_would_be_infinite_is_refused() {
    let whole = seeds::small_table();
    let offset = |at: usize| u32::from_le_bytes([whole[at], whole[at + 1], whole[at + 2], whole[at + 3]]) as usize;
    let (scales, library) = (offset(68), offset(76));
    // Of column 3; of the first material's forces, display points and displacements.
    for (at, expected) in [
        (scales + 12, "table column 3: scale is not a number above zero, or so large that forces are not finite"),
        (library + 28, "table library material 0: a scale is so large that forces or displacements are not finite"),
        (library + 32, "table library material 0: a scale is so large that forces or displacements are not finite"),
        (library + 36, "table library material 0: a scale is so large that forces or displacements are not finite"),
    ] {
        let mut table = whole.clone();
        table[at..at + 4].copy_from_slice(&1e36f32.to_le_bytes());
        assert_eq!(Table::parse(&robustness::sealed(&table)).unwrap_err().to_string(), expected);
        table[at..at + 4].copy_from_slice(&1e30f32.to_le_bytes());
        assert!(Table::parse(&robustness::sealed(&table)).is_ok());
    }
}

/// A change of one seed: bytes replaced, put in, taken out or repeated, and the end cut off.
#[derive(Debug, Clone)]
struct Change {
    seed: prop::sample::Index,
    edits: Vec<(prop::sample::Index, u8, u8)>,
    keep: Option<prop::sample::Index>,
}

fn change() -> impl Strategy<Value = Change> {
    let edits = prop::collection::vec((any::<prop::sample::Index>(), 0u8..4, any::<u8>()), 0..6);
    (any::<prop::sample::Index>(), edits, prop::option::of(any::<prop::sample::Index>()))
        .prop_map(|(seed, edits, keep)| Change { seed, edits, keep })
}

impl Change {
    fn of(&self, seeds: &[Vec<u8>]) -> Vec<u8> {
        let mut bytes = self.seed.get(seeds).clone();
        for (at, how, byte) in &self.edits {
            if bytes.is_empty() {
                break;
            }
            let at = at.index(bytes.len());
            match how {
                0 => bytes[at] = *byte,
                1 => bytes.insert(at, *byte),
                2 => drop(bytes.remove(at)),
                _ => {
                    let until = (at + usize::from(*byte) % 16).min(bytes.len());
                    let piece = bytes[at..until].to_vec();
                    bytes.splice(at..at, piece);
                }
            }
        }
        if let Some(keep) = &self.keep {
            bytes.truncate(keep.index(bytes.len() + 1));
        }
        bytes
    }
}

fn holds(held: Held) -> Result<(), TestCaseError> {
    held.map_err(TestCaseError::fail)
}

proptest! {
    #[test]
    fn frames_of_any_bytes(bytes in prop::collection::vec(any::<u8>(), 0..1500)) {
        holds(robustness::frames(&bytes))?;
    }

    #[test]
    fn frames_of_changed_ones(change in change()) {
        holds(robustness::frames(&change.of(&seeds::frames())))?;
    }

    #[test]
    fn messages_of_any_bytes(bytes in prop::collection::vec(any::<u8>(), 0..600)) {
        holds(robustness::messages(&bytes))?;
    }

    #[test]
    fn messages_of_changed_ones(changes in prop::collection::vec(change(), 1..8)) {
        let seeds = seeds::messages();
        let bytes: Vec<u8> = changes.iter().flat_map(|change| change.of(&seeds)).collect();
        holds(robustness::messages(&bytes))?;
    }

    #[test]
    fn tables_of_any_bytes(bytes in prop::collection::vec(any::<u8>(), 0..1500)) {
        holds(robustness::table(&bytes))?;
    }

    #[test]
    fn tables_of_changed_ones(change in change()) {
        holds(robustness::table(&change.of(&seeds::tables())))?;
    }

    #[test]
    fn experiments_of_any_bytes(bytes in prop::collection::vec(any::<u8>(), 0..600)) {
        holds(robustness::experiment(&bytes))?;
    }

    #[test]
    fn experiments_of_changed_ones(change in change()) {
        holds(robustness::experiment(&change.of(&seeds::experiments())))?;
    }
}
