//! Lamps and button of the NUCLEO.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use emulator::board::{BANK_2, EmulatedBoard};
use emulator::link::EmulatedUart;
use palpate::session::{Patience, Session};
use protocol::message::{Mode, Refusal, RunEnd, State};

use crate::common;

/// Lit lamps: LD1 alive, LD2 outputs on, LD3 fault.
fn lamps(board: &mut EmulatedBoard) -> [bool; 3] {
    [0, 7, 14].map(|pin| board.core().chip().pin_is_high('B', pin))
}

#[test]
fn the_lamps_tell_life_outputs_and_faults_and_the_button_stops() {
    let mut board = common::board();
    board.core().set_flash(BANK_2, common::table()).unwrap();
    let display = Mode::Display { material: 0 };
    let (mut session, _) = Session::open(EmulatedUart::new(&mut board), Patience::default()).unwrap();
    assert_eq!(session.last_run().unwrap().end, RunEnd::Unknown);
    session.set_mode(display).unwrap();
    let until_s = session.link_mut().board().time_s() + 0.1;
    while session.poll(until_s).unwrap().is_some() {}
    let board = session.link_mut().board();
    assert!(matches!(lamps(board), [_, true, false]) && !board.pins().off());
    board.core().chip_mut().press_button(true);
    board.run_s(0.05).unwrap();
    assert!(matches!(lamps(board), [_, false, false]) && board.pins().off());
    let refused = session.set_mode(display).unwrap_err().to_string();
    assert!(refused.contains(Refusal::Stopped.describe()), "{refused}");
    session.link_mut().board().core().chip_mut().press_button(false);
    session.link_mut().board().run_s(0.05).unwrap();
    session.set_mode(display).unwrap();
    // The host falls silent: a fault.
    let board = session.link_mut().board();
    board.run_s(1.2).unwrap();
    assert!(matches!(lamps(board), [_, false, true]));
    assert_eq!(session.status().unwrap().state, State::Fault);
    // Alive: the green lamp changes every half second.
    let board = session.link_mut().board();
    let blinks: Vec<bool> = (0..4)
        .map(|_| {
            board.run_s(0.5).unwrap();
            lamps(board)[0]
        })
        .collect();
    assert!(blinks.windows(2).all(|pair| pair[0] != pair[1]), "{blinks:?}");
}
