//! What the chip's errata and manual ask of the image: caches, revision, clock, supply, debugger,
//! and what is left after an end that nobody wanted.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::collections::BTreeMap;

use emulator::board::{BANK_2, EmulatedBoard, Task};
use emulator::chip::Reset;
use emulator::core::Deed;
use emulator::debug::{Handle, lister};
use emulator::link::EmulatedUart;
use firmware::trace::{End, Last, Trace, WORDS};
use object::{Object, ObjectSymbol};
use palpate::flash::{BrownOut, CHIP};
use palpate::link::Link;
use palpate::plant::Touch;
use palpate::session::{Patience, Session, SessionError};
use protocol::fault::Fault;
use protocol::message::{Mode, ResetCause, State};

use crate::common;

/// Registers, by the memory map of RM0090 section 2.3.
const GPIOA_MODER: u32 = 0x4002_0000;
const GPIOA_PUPDR: u32 = 0x4002_000c;
const FLASH_ACR: u32 = 0x4002_3c00;
const OTG_GAHBCFG: u32 = 0x5000_0008;
const NVIC_ISER0: u32 = 0xe000_e100;
const NVIC_ISPR0: u32 = 0xe000_e200;
const DBGMCU_APB1_FZ: u32 = 0xe004_2008;
const DBGMCU_APB2_FZ: u32 = 0xe004_200c;

/// Bits of FLASH_ACR.
const PRFTEN: u32 = 1 << 8;
const ICEN: u32 = 1 << 9;
const DCEN: u32 = 1 << 10;

const DBG_IWDG_STOP: u32 = 1 << 12;

/// Nothing is there.
const NOWHERE: u32 = 0xf000_0000;

/// The slowest watchdog clock, 0.5 s set: 0.94 s, and a start of 0.1 s.
const RESET_WITHIN_S: f64 = 1.1;

type Talk<'a> = Session<EmulatedUart<&'a mut EmulatedBoard>>;

fn talk(board: &mut EmulatedBoard) -> Talk<'_> {
    Session::open(EmulatedUart::new(board), Patience { attempts: 20, ..Patience::default() }).unwrap().0
}

fn wait(session: &mut Talk<'_>, for_s: f64) {
    let until_s = session.link_mut().board().time_s() + for_s;
    while session.poll(until_s).unwrap().is_some() {}
}

fn register(board: &mut EmulatedBoard, address: u32) -> u32 {
    board.core().chip_mut().read(address)
}

/// Lets a board with a table display its first material to a pressing finger: coil and actuator are
/// on.
fn display(board: &mut EmulatedBoard) {
    let mut session = talk(board);
    session.clear_faults().unwrap();
    wait(&mut session, 0.1);
    session.set_mode(Mode::Display { material: 0 }).unwrap();
    session.link_mut().board().touch(Some(Touch { peak_n: 3.0, period_s: 3.0 }));
    wait(&mut session, 1.5);
    drop(session);
    let pins = board.pins();
    assert!(pins.coil > 0.1 && pins.forward + pins.reverse > 0.01, "{pins:?}");
}

fn with_table() -> EmulatedBoard {
    let mut board = common::board();
    board.core().set_flash(BANK_2, common::table()).unwrap();
    board
}

/// Addresses of the image's symbols by their name.
fn symbols() -> BTreeMap<String, u32> {
    let bytes = std::fs::read(common::image_path()).unwrap();
    let file = object::File::parse(&*bytes).unwrap();
    file.symbols().filter_map(|s| Some((s.name().ok()?.to_owned(), s.address() as u32))).collect()
}

/// Address of the only symbol whose name contains all `parts`.
fn symbol(parts: &[&str]) -> u32 {
    let found: Vec<_> =
        symbols().into_iter().filter(|(name, _)| parts.iter().all(|part| name.contains(part))).collect();
    assert_eq!(found.len(), 1, "{parts:?}: {found:?}");
    found[0].1
}

fn words(board: &mut EmulatedBoard, address: u32, count: usize) -> Vec<u32> {
    let bytes = board.core().peek(address, 4 * count).unwrap();
    bytes.as_chunks::<4>().0.iter().map(|word| u32::from_le_bytes(*word)).collect()
}

/// The record that lies in RAM now.
fn record(board: &mut EmulatedBoard) -> Option<Last> {
    let kept = words(board, symbol(&["image6record4KEPT"]), WORDS);
    Trace::from_words(kept.try_into().unwrap()).begin()
}

/// Ends the run of a board that displays: outputs off within 1 ms, the end and the states before it
/// are on record, and a reset by the watchdog follows that is told.
fn ended(board: &mut EmulatedBoard, strike: impl Fn(&mut EmulatedBoard)) -> End {
    display(board);
    let resets = board.resets().len();
    strike(board);
    let struck_s = board.time_s();
    while !board.pins().off() {
        // A deed waits for the next tick.
        assert!(board.time_s() < struck_s + 0.022, "{:?}", board.pins());
        board.step().unwrap();
    }
    board.run_s(0.001).unwrap();
    assert!(board.core().chip().pin_is_high('B', 14), "the red lamp is off");
    let last = record(board).expect("no record");
    let states: Vec<State> = last.changes.iter().map(|change| change.state).collect();
    assert_eq!(states.last(), Some(&State::Display), "{states:?}");
    board.core().chip_mut().set_supply_low(false);
    while board.resets().len() == resets {
        assert!(board.time_s() < struck_s + RESET_WITHIN_S, "no reset");
        assert!(board.pins().off());
        board.step().unwrap();
    }
    board.core().set_trap(None).unwrap();
    let (mut session, hello) =
        Session::open(EmulatedUart::new(&mut *board), Patience { attempts: 20, ..Patience::default() }).unwrap();
    assert_eq!(hello.reset_cause, ResetCause::Watchdog);
    assert!(session.status().unwrap().faults.contains(Fault::WatchdogReset));
    drop(session);
    // A new record has begun.
    assert_eq!(record(board).unwrap().end, None);
    last.end.expect("no end")
}

/// A calibration that differs from the one in flash: an unchanged one is not written.
fn move_zero<L: Link>(session: &mut Session<L>) -> Result<(), SessionError> {
    let mut calibration = session.calibration()?;
    calibration.load_cell.zero_ratio += 1e-3;
    session.set_calibration(calibration)
}

#[test]
fn flash_is_written_with_the_data_cache_off_and_the_register_comes_back() {
    let mut board = common::board();
    let mut session = talk(&mut board);
    // Fast instructions: as the image leaves it, and as another start might.
    for caches in [PRFTEN | ICEN, PRFTEN | ICEN | DCEN] {
        let chip = session.link_mut().board().core().chip_mut();
        let before = chip.read(FLASH_ACR) & !DCEN | caches;
        chip.write(FLASH_ACR, before);
        let operations = chip.flash_operations();
        move_zero(&mut session).unwrap();
        move_zero(&mut session).unwrap();
        session.upload(&common::small_table(&format!("with {caches:#x}")), |_| {}).unwrap();
        let chip = session.link_mut().board().core().chip_mut();
        assert_eq!(chip.flash_violations(), 0);
        assert_eq!(chip.read(FLASH_ACR), before);
        assert!(chip.flash_operations() > operations);
        // A write and an erase that fail.
        chip.set_flash_broken(true);
        move_zero(&mut session).unwrap_err();
        session.upload(&common::small_table(&format!("in vain with {caches:#x}")), |_| {}).unwrap_err();
        let chip = session.link_mut().board().core().chip_mut();
        chip.set_flash_broken(false);
        assert_eq!((chip.read(FLASH_ACR), chip.flash_violations()), (before, 0));
    }
}

#[test]
fn the_brown_out_level_is_set_through_a_probe_after_a_yes() {
    let board =
        Handle::start(|| EmulatedBoard::new(common::image(), 1, palpate::plant::Jitter::NONE, emulator::board::LSI_HZ))
            .unwrap();
    let options = || board.with(|target| target.board().core().chip().options()).unwrap();
    let factory = options();
    let set_up = |yes: bool| palpate::flash::set_up(&lister(board.clone()), None, CHIP, |_| yes).unwrap();
    assert_eq!((set_up(false), options()), (BrownOut::Declined, factory));
    // Bits 3 and 2 are the level; nothing else changes, the read protection least of all.
    assert_eq!((set_up(true), options() ^ factory), (BrownOut::Written, 0b1100));
    assert_eq!(set_up(true), BrownOut::Already);
    // The board starts again.
    let uptime = board.with(|target| talk(target.board()).status().unwrap().uptime_ms).unwrap();
    assert!(uptime > 0);
}

#[test]
fn instruction_cache_and_prefetch_are_on_after_the_start_and_the_data_cache_is_off() {
    let mut board = common::board();
    board.run_s(0.2).unwrap();
    assert_eq!(register(&mut board, FLASH_ACR) & (PRFTEN | ICEN | DCEN), PRFTEN | ICEN);
}

#[test]
fn a_start_overruns_no_converter_at_one_and_a_half_to_four_clocks_an_instruction() {
    for half_clocks in [3, 4, 6, 8] {
        let mut board = common::board();
        board.core().assume_half_clocks(Some(half_clocks));
        board.power_cycle(Reset::Power).unwrap();
        while board.ticks() == 0 {
            board.step().unwrap();
            assert!(board.time_s() < 1.0);
        }
        let (began_s, halves) = (board.time_s(), board.halves());
        board.run_s(0.1).unwrap();
        assert_eq!(board.core().chip().converter_overruns(), 0, "{half_clocks} half clocks");
        // One every millisecond: none was lost to a restart of the converter.
        let expected = ((board.time_s() - began_s) * 1e3).round() as u64;
        let found = board.halves() - halves;
        assert!(found.abs_diff(expected) <= 1, "{half_clocks} half clocks: {found} halves of {expected}");
    }
}

#[test]
fn usb_is_off_on_a_chip_before_revision_3_and_on_from_it() {
    for (revision, old) in [(0x1007, true), (0x2001, false)] {
        let mut board = with_table();
        board.core().chip_mut().set_revision(revision);
        board.power_cycle(Reset::Power).unwrap();
        let mut session = talk(&mut board);
        assert_eq!(session.status().unwrap().faults.contains(Fault::UsbOff), old, "revision {revision:#x}");
        drop(session);
        // The driver's first deed is to set up its core; PA12 (mode of bits 24 and 25) is an
        // output, or USB's.
        assert_eq!(register(&mut board, OTG_GAHBCFG) == 0, old);
        assert_eq!(register(&mut board, GPIOA_MODER) >> 24 & 3, if old { 1 } else { 2 });
        assert_eq!(register(&mut board, GPIOA_PUPDR) >> 24 & 3 == 2, old);
        // The tables work either way, and so does the display: nobody waits for a link that is not
        // there.
        display(&mut board);
        let resets = board.resets().len();
        let mut session = talk(&mut board);
        wait(&mut session, 1.0);
        assert_eq!(session.status().unwrap().state, State::Display);
        drop(session);
        assert_eq!(board.resets().len(), resets);
    }
}

#[test]
fn without_the_8_mhz_clock_the_board_starts_from_the_internal_one_and_tells() {
    let mut board = with_table();
    board.core().chip_mut().set_external_clock_dead(true);
    board.power_cycle(Reset::Power).unwrap();
    let mut session = talk(&mut board);
    let status = session.status().unwrap();
    assert!(status.faults.contains(Fault::UsbOff), "{status:?}");
    drop(session);
    assert!(board.core().chip().pin_is_high('B', 14), "the red lamp is off");
    assert_eq!((register(&mut board, OTG_GAHBCFG), board.core().chip().core_hz()), (0, 168_000_000));
    display(&mut board);
}

#[test]
fn the_clock_that_stops_switches_off() {
    let mut board = with_table();
    let end = ended(&mut board, |board| board.core().chip_mut().set_external_clock_dead(true));
    assert_eq!(end, End::ClockLost);
    // It is still dead after the reset.
    assert!(talk(&mut board).status().unwrap().faults.contains(Fault::UsbOff));
}

#[test]
fn the_supply_that_sags_switches_off() {
    let mut board = with_table();
    let end = ended(&mut board, |board| board.core().chip_mut().set_supply_low(true));
    assert_eq!(end, End::SupplyLow);
    // One that is low at the start ends the start, again and again, until it is there.
    board.core().chip_mut().set_supply_low(true);
    board.power_cycle(Reset::Power).unwrap();
    let resets = board.resets().len();
    board.run_s(RESET_WITHIN_S).unwrap();
    assert!(board.resets().len() > resets && board.pins().off());
    board.core().chip_mut().set_supply_low(false);
    assert!(talk(&mut board).status().unwrap().faults.contains(Fault::WatchdogReset));
}

#[test]
fn an_interrupt_without_a_handler_switches_off() {
    // Number 0, the window watchdog.
    let end = ended(&mut with_table(), |board| {
        board.core().chip_mut().write(NVIC_ISER0, 1);
        board.core().chip_mut().write(NVIC_ISPR0, 1);
    });
    assert_eq!(end, End::Interrupt { number: 0 });
}

#[test]
fn a_hard_fault_is_on_record_with_its_place_and_known_after_the_reset() {
    let mut board = with_table();
    let jump = Deed::Jump(NOWHERE, [0; 3]);
    let end = ended(&mut board, |board| assert!(board.inject(Task::Control, jump).unwrap()));
    let End::HardFault { pc, lr, cfsr } = end else { panic!("{end:?}") };
    // A bus fault of the fetch; the link register is that of the code that was left.
    assert_eq!((pc, cfsr), (NOWHERE, 1 << 8));
    assert!((0x0800_0000..0x080c_0000).contains(&lr), "{lr:#x}");
    let kept = words(&mut board, symbol(&["image6record4LAST"]), 64);
    for number in [pc, lr, cfsr] {
        assert!(kept.contains(&number), "{number:#x} is not in {kept:x?}");
    }
}

#[test]
fn a_panic_is_on_record_with_its_file_and_line() {
    // A `core::panic::Location` (pointer and length of the file's name, line, column) at the unused
    // end of the stack.
    const PLACE: u32 = 0x2000_0000;
    const NAME: &str = "firmware/src/made_up.rs";
    let location = [PLACE + 16, NAME.len() as u32, 321, 9];
    let bytes: Vec<u8> = location.iter().flat_map(|w| w.to_le_bytes()).chain(NAME.bytes()).collect();
    let unwrap = symbol(&["core", "option", "unwrap_failed"]);
    let end = ended(&mut with_table(), |board| {
        board.core().poke(PLACE, &bytes).unwrap();
        assert!(board.inject(Task::Control, Deed::Jump(unwrap, [PLACE, 0, 0])).unwrap());
    });
    assert_eq!(end, End::panic(NAME, 321));
}

#[test]
fn a_debugger_cannot_stop_the_watchdog_while_outputs_are_on() {
    let mut board = with_table();
    board.run_s(0.2).unwrap();
    // As OpenOCD does when it attaches. While outputs are off it may.
    board.core().chip_mut().write(DBGMCU_APB1_FZ, DBG_IWDG_STOP);
    board.run_s(0.1).unwrap();
    assert_eq!(register(&mut board, DBGMCU_APB1_FZ), DBG_IWDG_STOP);
    display(&mut board);
    assert_eq!(register(&mut board, DBGMCU_APB1_FZ), 0);
    board.core().chip_mut().write(DBGMCU_APB1_FZ, DBG_IWDG_STOP);
    board.run_s(0.02).unwrap();
    assert_eq!(register(&mut board, DBGMCU_APB1_FZ), 0);
    assert_eq!(register(&mut board, DBGMCU_APB2_FZ), 0b11);
}

#[test]
fn the_log_holds_the_start_and_never_blocks() {
    let messages = symbols();
    for wanted in ["start: reset cause", "board started", "UART does not send", "last run: panic at"] {
        assert!(messages.keys().any(|name| name.contains(wanted)), "the image has no message {wanted:?}");
    }
    // Mode 2 is "block if full", which probe-rs sets and leaves behind; the mode is the last word
    // of the first channel.
    let mode = symbol(&["_SEGGER_RTT"]) + 16 + 8 + 5 * 4;
    let mut board = common::board();
    board.run_s(0.2).unwrap();
    assert_eq!(words(&mut board, mode, 1), [1]);
    board.core().poke(mode, &2_u32.to_le_bytes()).unwrap();
    let resets = board.resets().len();
    // A silent converter logs every 5 ms: the buffer of 1 KiB is full in half a second.
    board.set_adc_dead(true);
    board.run_s(3.0).unwrap();
    assert_eq!(board.resets().len(), resets);
    assert!(talk(&mut board).status().unwrap().uptime_ms > 3000);
}
