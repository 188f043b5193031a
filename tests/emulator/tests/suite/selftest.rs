//! The self test of a bare NUCLEO on the emulated one: everything passes as drawn, and each fault is found where it is.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use emulator::board::{EmulatedBoard, LSI_HZ};
use emulator::elf::Image;
use emulator::jumpers::{AS_DRAWN, From, Jumper, Jumpers};
use emulator::link::EmulatedUart;
use palpate::link::{Link, LinkError};
use palpate::selftest::{self, Check, Outcome, SelftestError, Step, Talk, Usb};
use palpate::session::{Patience, Session};

use crate::common;

/// A NUCLEO with the self-test program, its brown-out level set.
fn nucleo(wires: &[Jumper], lsi_hz: u64) -> EmulatedBoard {
    let path = common::selftest_path();
    let image = Image::read(&path)
        .unwrap_or_else(|error| panic!("{error}; build it as the board's image, or name it in PALPATE_SELFTEST"));
    let mut board = EmulatedBoard::bare(image, Jumpers::new(wires), lsi_hz).unwrap();
    board.core().chip_mut().set_brown_out_3();
    board
}

fn tested(board: &mut EmulatedBoard) -> Vec<Check> {
    over(EmulatedUart::new(board)).unwrap()
}

fn over(link: impl Link) -> Result<Vec<Check>, SelftestError> {
    selftest::run(&mut Talk::new(link), Usb::<Box<dyn Link>>::NotAsked, None, |_| {})
}

fn failed(checks: &[Check]) -> Vec<String> {
    checks.iter().filter(|check| check.outcome == Outcome::Failed).map(Check::line).collect()
}

#[test]
fn every_check_passes_as_drawn_and_every_step_is_made() {
    for lsi_hz in [17_000, LSI_HZ, 47_000] {
        let checks = tested(&mut nucleo(&AS_DRAWN, lsi_hz));
        assert_eq!(failed(&checks), [""; 0], "{lsi_hz}");
        let steps = [
            Step::Chip,
            Step::Converter,
            Step::Wires,
            Step::Pins,
            Step::Arithmetic,
            Step::Flash,
            Step::Links,
            Step::Interlock,
            Step::Ends,
        ];
        for step in steps {
            assert!(checks.iter().any(|c| c.step == step && c.outcome == Outcome::Passed), "{step:?}");
        }
        let left: Vec<&str> = checks.iter().filter(|c| c.outcome == Outcome::NotTested).map(|c| &*c.what).collect();
        assert!(left.len() == 3 && left[0].starts_with("program of commit"), "{left:?}");
        assert_eq!(left[1..], ["PA3 and PC0", "USB"]);
    }
}

#[test]
fn a_missing_a_swapped_and_a_wrongly_filtered_wire_are_found() {
    let [coil, forward, arm] = AS_DRAWN;
    let lines = failed(&tested(&mut nucleo(&[coil, arm], LSI_HZ)));
    assert!(lines[0].contains("PE9") && lines[0].contains("no input follows"), "{lines:?}");
    let lines = failed(&tested(&mut nucleo(
        &[Jumper { to: forward.to, ..coil }, Jumper { to: coil.to, ..forward }, arm],
        LSI_HZ,
    )));
    assert!(lines[0].contains("PC6") && lines[0].contains("PC3 (A2) follows instead"), "{lines:?}");
    assert!(lines[1].contains("PE9") && lines[1].contains("PB1 (A6) follows instead"), "{lines:?}");
    // Ten times the resistor and the capacitor: not there yet after 60 ms.
    let lines = failed(&tested(&mut nucleo(&[coil, forward, Jumper { tau_ms: 100.0, ..arm }], LSI_HZ)));
    assert!(lines[0].contains("PD15"), "{lines:?}");
    assert_eq!(arm.from, From::ArmRate);
}

/// A fault, and what the first failed line must hold.
type Broken = (&'static str, fn(&mut EmulatedBoard), &'static str);

#[test]
fn what_is_broken_on_the_chip_is_found() {
    let broken: [Broken; 5] = [
        ("old chip", |board| board.core().chip_mut().set_revision(0x1007), "revision: 0x1007"),
        ("no 8 MHz", |board| board.core().chip_mut().set_external_clock_dead(true), "clock source: internal"),
        (
            "flash",
            |board| board.core().chip_mut().set_flash_broken(true),
            "erase of 128 KiB: failed, expected at most 2000 ms",
        ),
        ("converter", |board| board.core().chip_mut().set_adc_dead(true), "the converter does not convert"),
        ("slow flash", |board| board.core().assume_half_clocks(Some(8)), "time of the identification"),
    ];
    for (name, break_it, expected) in broken {
        let mut board = nucleo(&AS_DRAWN, LSI_HZ);
        break_it(&mut board);
        let lines = failed(&tested(&mut board));
        assert!(lines.iter().any(|line| line.contains(expected)), "{name}: {lines:#?}");
    }
}

#[test]
fn a_tool_for_boards_is_told_that_the_self_test_runs() {
    let mut board = nucleo(&AS_DRAWN, LSI_HZ);
    let error = match Session::open(EmulatedUart::new(&mut board), Patience::default()) {
        Ok(_) => panic!("it is no display board"),
        Err(error) => error.to_string(),
    };
    assert!(error.contains("runs the self-test program") && error.contains("palpate flash"), "{error}");
}

#[test]
fn the_display_boards_firmware_is_told_and_nothing_is_driven() {
    let mut board = common::board();
    board.run_s(0.2).unwrap();
    let error = over(EmulatedUart::new(&mut board)).unwrap_err();
    assert!(error.to_string().contains("the firmware of the display board runs there"), "{error}");
    assert!(board.pins().off());
}

/// A line that is cut after so many answers, and mended or not.
struct Cut<L> {
    link: L,
    left: usize,
    cut_for: usize,
}

impl<L: Link> Link for Cut<L> {
    fn name(&self) -> &str {
        self.link.name()
    }
    fn now_s(&self) -> f64 {
        self.link.now_s()
    }
    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        self.left = self.left.saturating_sub(1);
        if self.left > 0 || self.cut_for == 0 {
            return self.link.send(bytes);
        }
        self.cut_for -= 1;
        Ok(())
    }
    fn receive(&mut self, into: &mut Vec<u8>, deadline_s: f64) -> Result<(), LinkError> {
        self.link.receive(into, deadline_s)
    }
}

#[test]
fn a_program_that_falls_silent_is_a_failed_check_and_what_was_found_is_kept() {
    for (cut_for, ends) in [(3, false), (usize::MAX, true)] {
        let mut board = nucleo(&AS_DRAWN, LSI_HZ);
        let checks = over(Cut { link: EmulatedUart::new(&mut board), left: 10, cut_for }).unwrap();
        let lines = failed(&checks);
        assert!(lines[0].contains("answer: none to Measure within"), "{lines:?}");
        assert_eq!(checks.iter().any(|check| check.step == Step::Ends), !ends, "{lines:?}");
        assert!(checks.iter().any(|check| check.step == Step::Converter && check.outcome == Outcome::Passed));
    }
}
