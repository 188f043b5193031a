#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
use super::*;
use crate::flash::{BANK_LEN, PowerCut, RamFlash, find_active};
use crate::testbed::factored_table;
use protocol::frame::CRC32;
use protocol::lut::{AxisSpec, Role, Scale, TableSpec};
use protocol::message::CHUNK_LEN;

type Flash = RamFlash<Vec<u8>>;

fn blank() -> Flash {
    RamFlash::new(vec![0xff; BANK_LEN])
}

fn chunks(bytes: &[u8]) -> impl Iterator<Item = TableChunk> + '_ {
    bytes
        .chunks(CHUNK_LEN)
        .enumerate()
        .map(|(i, data)| TableChunk { offset: (i * CHUNK_LEN) as u32, data: heapless::Vec::from_slice(data).unwrap() })
}

/// Uploads to the end or to the first refusal.
fn upload(flash: &mut Flash, active: &mut Option<ActiveTable>, bytes: &[u8], crc: u32) -> Result<(), Refusal> {
    let mut upload = Upload::new();
    upload.begin(flash, active, &TableBegin { length: bytes.len() as u32, crc })?;
    while upload.is_erasing() {
        upload.poll(flash).unwrap_or(Ok(()))?;
    }
    for chunk in chunks(bytes) {
        upload.chunk(flash, &chunk)?;
    }
    upload.commit(flash, active)
}

fn good(flash: &mut Flash, active: &mut Option<ActiveTable>, bytes: &[u8]) -> Result<(), Refusal> {
    upload(flash, active, bytes, CRC32.checksum(bytes))
}

/// A table of three columns and two rows, with forces and provenance as given.
fn table_of(scale: f64, provenance: String) -> Vec<u8> {
    let axis = |name: &str, unit: &str, role, values: Vec<f64>| AxisSpec::new(name, unit, role, Scale::Listed, values);
    let spec = TableSpec {
        axes: vec![
            axis("depth", "mm", Role::Row, vec![1.0, 2.0]),
            axis("alpha", "", Role::Column, vec![1.0, 2.0, 3.0]),
        ],
        columns: vec![vec![scale, 2.0 * scale]; 3],
        library: vec![],
        discretisation: 0.0,
        interpolation: 0.0,
        provenance,
    };
    spec.to_bytes().unwrap()
}

fn small(scale: f64) -> Vec<u8> {
    table_of(scale, "small".into())
}

fn hash_at_start(flash: &Flash) -> Option<[u8; 16]> {
    find_active(flash.bytes()).0.map(|a| a.checked.hash())
}

fn hash_of(bytes: &[u8]) -> [u8; 16] {
    Table::parse(bytes).unwrap().hash()
}

#[test]
fn tables_alternate_between_slots_and_survive_a_restart() {
    let (mut flash, mut active) = (blank(), None);
    let (one, two) = (factored_table(), small(1.0));
    for (bytes, slot) in [(&one, Slot::A), (&two, Slot::B), (&one, Slot::A)] {
        good(&mut flash, &mut active, bytes).unwrap();
        assert_eq!(active.unwrap().slot, slot);
        let (found, broken) = find_active(flash.bytes());
        assert_eq!(found, active);
        assert!(!broken);
    }
    assert_eq!(flash.rule_violations(), 0);
}

/// The board goes on with the table that a restart would find, whichever write was the one that failed: also the one that retires the old
/// table, after which both slots hold a good one.
#[test]
fn after_a_write_that_failed_the_table_in_use_is_the_one_of_a_restart() {
    let mut first = (blank(), None);
    good(&mut first.0, &mut first.1, &small(1.0)).unwrap();
    let mut second = first.clone();
    good(&mut second.0, &mut second.1, &small(7.0)).unwrap();
    for (flash, active) in [first, second] {
        let (mut whole, before) = (flash.clone(), flash.operations());
        good(&mut whole, &mut active.clone(), &small(3.0)).unwrap();
        for cut in 0..whole.operations() - before {
            let (mut flash, mut active) = (flash.clone(), active);
            flash.set_power(PowerCut::After(cut));
            assert!(good(&mut flash, &mut active, &small(3.0)).is_err());
            assert_eq!(active, find_active(flash.bytes()).0, "cut after {cut}");
        }
    }
}

#[test]
fn a_power_cut_at_any_write_leaves_the_old_table_or_the_new_one() {
    let (old, new) = (small(1.0), small(7.0));
    let (mut flash, mut active) = (blank(), None);
    good(&mut flash, &mut active, &old).unwrap();
    let before = flash.operations();
    let mut whole = flash.clone();
    good(&mut whole, &mut active.clone(), &new).unwrap();
    let operations = whole.operations() - before;
    assert!(operations > 20);
    let mut seen = [0; 2];
    for cut in 0..=operations {
        let mut cut_flash = flash.clone();
        cut_flash.set_power(PowerCut::After(cut));
        let _ = good(&mut cut_flash, &mut active.clone(), &new);
        let hash = hash_at_start(&cut_flash).unwrap_or_else(|| panic!("no table after a cut at {cut}"));
        let which = [hash_of(&old), hash_of(&new)].iter().position(|h| *h == hash).unwrap();
        seen[which] += 1;
        assert_eq!(cut_flash.rule_violations(), 0, "cut at {cut}");
    }
    assert!(seen[0] > 0 && seen[1] > 0, "{seen:?}");
}

#[test]
fn a_corrupt_truncated_or_wrong_version_table_is_refused_and_the_old_one_stays() {
    let (mut flash, mut active) = (blank(), None);
    let old = small(1.0);
    good(&mut flash, &mut active, &old).unwrap();
    let new = factored_table();
    let mut corrupt = new.clone();
    corrupt[5000] ^= 1;
    let mut wrong_version = new.clone();
    wrong_version[8] = 9;
    let truncated = new[..new.len() - 100].to_vec();
    let no_table = vec![0x55; 4000];
    for bytes in [&corrupt, &wrong_version, &truncated, &no_table] {
        // The announced CRC is that of what was sent, so that the table's own checks must find it.
        assert_eq!(good(&mut flash, &mut active, bytes), Err(Refusal::TableRejected));
        assert_eq!(hash_at_start(&flash), Some(hash_of(&old)));
        assert_eq!(active.unwrap().checked.hash(), hash_of(&old));
    }
    // Changed on the way: the announced CRC finds it.
    assert_eq!(upload(&mut flash, &mut active, &corrupt, CRC32.checksum(&new)), Err(Refusal::TableRejected));
    // Sound, but not the one that was announced.
    assert_eq!(upload(&mut flash, &mut active, &small(5.0), CRC32.checksum(&new)), Err(Refusal::TableRejected));
    assert_eq!((hash_at_start(&flash), active.unwrap().checked.hash()), (Some(hash_of(&old)), hash_of(&old)));
    assert_eq!(flash.rule_violations(), 0);
    good(&mut flash, &mut active, &new).unwrap();
    assert_eq!(hash_at_start(&flash), Some(hash_of(&new)));
}

/// What lies in the other slot and is not in use must not come back when the new table goes bad.
#[test]
fn a_table_that_was_not_in_use_is_retired_too() {
    let mut flash = blank();
    let mut forgotten = Some(ActiveTable { slot: Slot::A, checked: Table::parse(&small(1.0)).unwrap().checked() });
    good(&mut flash, &mut forgotten, &small(1.0)).unwrap();
    assert_eq!(forgotten.unwrap().slot, Slot::B);
    good(&mut flash, &mut None, &small(7.0)).unwrap();
    flash.write(0, &[0; MAGIC.len()]).unwrap();
    assert_eq!(find_active(flash.bytes()), (None, false));
}

#[test]
fn a_table_above_half_a_bank_takes_the_whole_and_gives_it_back() {
    let (mut flash, mut active) = (blank(), None);
    let small = small(1.0);
    good(&mut flash, &mut active, &small).unwrap();
    let large = table_of(1.0, "x".repeat(SLOT_LEN));
    assert!(large.len() > SLOT_LEN);
    good(&mut flash, &mut active, &large).unwrap();
    assert_eq!(active.unwrap().slot, Slot::Whole);
    assert_eq!(hash_at_start(&flash), Some(hash_of(&large)));
    good(&mut flash, &mut active, &small).unwrap();
    assert_eq!(active.unwrap().slot, Slot::A);
    assert_eq!(hash_at_start(&flash), Some(hash_of(&small)));
    assert_eq!(flash.rule_violations(), 0);
}

#[test]
fn pieces_come_in_order_repeated_ones_are_fine_and_others_are_refused() {
    let (mut flash, mut active) = (blank(), None);
    let bytes = factored_table();
    let mut upload = Upload::new();
    let all: Vec<_> = chunks(&bytes).collect();
    assert_eq!(upload.chunk(&mut flash, &all[0]), Err(Refusal::OutOfOrder));
    assert_eq!(upload.commit(&mut flash, &mut active), Err(Refusal::OutOfOrder));
    let begin = TableBegin { length: bytes.len() as u32, crc: CRC32.checksum(&bytes) };
    upload.begin(&mut flash, &mut active, &begin).unwrap();
    assert_eq!(upload.chunk(&mut flash, &all[0]), Err(Refusal::Busy));
    assert_eq!(upload.begin(&mut flash, &mut active, &begin), Err(Refusal::Busy));
    while upload.is_erasing() {
        upload.poll(&mut flash);
    }
    upload.chunk(&mut flash, &all[0]).unwrap();
    upload.chunk(&mut flash, &all[1]).unwrap();
    upload.chunk(&mut flash, &all[0]).unwrap();
    assert_eq!(upload.next_offset() as usize, 2 * CHUNK_LEN);
    assert_eq!(upload.chunk(&mut flash, &all[3]), Err(Refusal::OutOfOrder));
    let beyond = TableChunk { offset: u32::MAX, data: heapless::Vec::from_slice(&[1; 10]).unwrap() };
    assert_eq!(upload.chunk(&mut flash, &beyond), Err(Refusal::OutOfRange));
    assert_eq!(upload.commit(&mut flash, &mut active), Err(Refusal::OutOfOrder));
    for chunk in &all[2..] {
        upload.chunk(&mut flash, chunk).unwrap();
    }
    upload.commit(&mut flash, &mut active).unwrap();
    // The answer was lost and the host asks again.
    let operations = flash.operations();
    upload.commit(&mut flash, &mut active).unwrap();
    assert_eq!(flash.operations(), operations);
    assert_eq!(active.unwrap().checked.hash(), hash_of(&bytes));
}

#[test]
fn lengths_that_cannot_be_are_refused() {
    let (mut flash, mut active) = (blank(), None);
    let mut upload = Upload::new();
    for (length, reason) in
        [(10, Refusal::OutOfRange), (BANK_LEN as u32 + 1, Refusal::TooLarge), (u32::MAX, Refusal::TooLarge)]
    {
        let begin = TableBegin { length, crc: 0 };
        assert_eq!(upload.begin(&mut flash, &mut active, &begin), Err(reason));
    }
    assert_eq!(flash.operations(), 0);
}
