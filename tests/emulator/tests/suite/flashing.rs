//! `palpate flash` end to end: probe-rs' own flash algorithm for the STM32F4, executed by the emulated core.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::path::Path;

use emulator::board::LSI_HZ;
use emulator::chip::{FLASH_LEN, Reset};
use emulator::debug::{Handle, lister};
use emulator::link::EmulatedUart;
use palpate::flash::{CHIP, Expected, Firmware, FlashingError, Greeted, Job, Step, TableImage, greet, write};
use palpate::link::{Link, LinkError};
use protocol::lut::Table;

use crate::common;

/// Greets over a link that is open already.
fn greet_once(link: impl Link, expected: &Expected) -> Result<Greeted, FlashingError> {
    let mut link = Some(link);
    greet(|| link.take().ok_or_else(|| LinkError::Closed { link: "the emulated board".into() }), expected)
}

#[test]
fn image_and_table_get_into_a_blank_chip_which_then_runs_them() {
    let board = Handle::start(|| {
        let mut board = emulator::board::EmulatedBoard::new(common::image(), 1, palpate::plant::Jitter::NONE, LSI_HZ)?;
        // As it comes from the factory.
        board.core().set_flash(0, &vec![0xff; FLASH_LEN])?;
        board.power_cycle(Reset::Power)?;
        Ok(board)
    })
    .unwrap();
    let elf = common::image_path();
    let table = common::table().to_vec();
    let job = Job {
        probe: None,
        chip: CHIP.into(),
        firmware: Some(Firmware::read(&elf).unwrap()),
        table: Some(TableImage::from_bytes(Path::new("demo.lut"), table.clone()).unwrap()),
    };
    let mut verified = 0;
    let raw = job.firmware.as_ref().unwrap().raw().unwrap();
    let written = write(&lister(board.clone()), &job, |progress| {
        if progress.step == Step::Verify {
            verified = progress.done;
        }
    })
    .unwrap();
    assert_eq!(written.table_bytes, table.len() as u64);
    assert!(written.firmware_bytes > 50_000 && verified >= written.firmware_bytes, "{written:?}, {verified} verified");

    // The board that starts says that it is what was written, and that it is not what was not.
    let hash = Table::parse(&table).unwrap().hash();
    let crc = job.firmware.as_ref().unwrap().crc().unwrap();
    let (greeted, other_table, other_image) = board
        .with(move |target| {
            // The raw image is what the probe has written.
            assert!(target.board().flash().is_ok_and(|flash| flash.starts_with(&raw)));
            let mut greet = |crc, hash| {
                let expected = Expected { image_crc: Some(crc), table_hash: Some(hash) };
                greet_once(EmulatedUart::new(target.board()), &expected)
            };
            (greet(crc, hash), greet(crc, [1; 16]), greet(!crc, hash))
        })
        .unwrap();
    let greeted = greeted.unwrap();
    let as_written = (firmware::board::FIRMWARE_VERSION, crc, hash);
    assert_eq!((greeted.firmware_version, greeted.image_crc, greeted.table_hash), as_written);
    assert!(other_table.unwrap_err().to_string().starts_with("the board has started, but its table is "));
    assert!(other_image.unwrap_err().to_string().starts_with("the board has started, but its image's CRC is "));
}
