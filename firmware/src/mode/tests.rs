#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
use super::*;

const LIMITS: Option<TableLimits> = Some(TableLimits { depth_max_mm: 4.0, materials: 3, searchable: true });
const PALPATE: Mode = Mode::Palpate { rate_mm_s: 1.0, depth_mm: 4.0 };
const FREE: ModeInput = ModeInput {
    probe_mm: 20.0,
    depth_mm: 0.0,
    force_n: 0.0,
    contact: false,
    no_slice: None,
    floor_mm: 0.0,
    record_full: false,
    analysed: true,
    faulted: false,
};

fn approaching() -> ModeState {
    let mut mode = ModeState::new();
    mode.request(&ModeConfig::default(), PALPATE, LIMITS).unwrap();
    mode
}

/// Steps until the state changes; returns the number of steps.
fn steps_in_state(mode: &mut ModeState, input: &ModeInput) -> u32 {
    let state = mode.state;
    (1..=10_000)
        .find(|_| {
            mode.step(&ModeConfig::default(), input);
            mode.state != state
        })
        .expect("the state ends")
}

#[test]
fn an_arm_that_does_not_move_ends_every_state_of_motion() {
    let config = ModeConfig::default();
    let mut mode = approaching();
    mode.step(&config, &FREE);
    let lower = ModeInput { probe_mm: 15.0, ..FREE };
    assert_eq!(steps_in_state(&mut mode, &lower), config.approach_ticks);
    assert_eq!((mode.state, mode.ended()), (State::Retract, Outcome::NoContact));
    assert_eq!(steps_in_state(&mut mode, &lower), config.retract_ticks + 1);
    assert_eq!(mode.state, State::Idle);

    let mut mode = approaching();
    let stuck = ModeInput { contact: true, depth_mm: 0.3, ..FREE };
    mode.step(&config, &stuck);
    assert_eq!(mode.state, State::Contact);
    assert_eq!(steps_in_state(&mut mode, &stuck), config.contact_ticks + 1);
    assert_eq!((mode.state, mode.ended()), (State::Retract, Outcome::TooShort));
}

#[test]
fn a_press_that_is_stopped_where_it_begins_has_returned_when_it_is_there_again() {
    let config = ModeConfig::default();
    let mut mode = approaching();
    for probe_mm in [20.0, 19.7, 19.4] {
        mode.step(&config, &ModeInput { probe_mm, ..FREE });
    }
    mode.request(&config, Mode::Idle, LIMITS).unwrap();
    let rising = [19.3, 19.5, 19.85].map(|probe_mm| mode.step(&config, &ModeInput { probe_mm, ..FREE }));
    assert_eq!(rising, [ModeEvent::None; 3]);
    let home = ModeInput { probe_mm: 19.92, ..FREE };
    assert_eq!(mode.step(&config, &home), ModeEvent::Ended(Outcome::Aborted));
}

#[test]
fn the_verdict_waits_for_the_probe_and_for_the_analysis() {
    let config = ModeConfig::default();
    let mut mode = approaching();
    mode.step(&config, &ModeInput { contact: true, ..FREE });
    mode.step(&config, &ModeInput { contact: true, depth_mm: 4.0, ..FREE });
    assert_eq!((mode.state, mode.ended()), (State::Retract, Outcome::Identified));
    let back = ModeInput { contact: true, depth_mm: -1.5, ..FREE };
    for waiting in [ModeInput { depth_mm: 2.0, ..back }, ModeInput { analysed: false, ..back }] {
        assert_eq!(mode.step(&config, &waiting), ModeEvent::None);
    }
    assert_eq!(mode.step(&config, &back), ModeEvent::Ended(Outcome::Identified));
    assert_eq!((mode.state, mode.commanded), (State::Idle, Mode::Idle));
}

#[test]
fn outputs_are_on_in_three_states_only() {
    for state in [State::Idle, State::Approach, State::Contact, State::Retract, State::Display, State::Fault] {
        let mode = ModeState { state, ..ModeState::new() };
        let expected = matches!(state, State::Approach | State::Contact | State::Display);
        assert_eq!(mode.outputs_on(), expected, "{state:?}");
    }
}

/// In the air as in contact, whatever floor the press has.
#[test]
fn the_lowest_travel_and_the_force_of_the_end_lift_the_arm_at_once() {
    let config = ModeConfig::default();
    let ended = |contact: bool, input: ModeInput| {
        let mut mode = approaching();
        if contact {
            mode.step(&config, &ModeInput { contact, ..FREE });
            assert_eq!(mode.state, State::Contact);
        }
        mode.step(&config, &ModeInput { contact, ..input });
        mode.state == State::Retract
    };
    for contact in [false, true] {
        assert!(ended(contact, ModeInput { probe_mm: 1.0, ..FREE }), "{contact}");
        assert!(ended(contact, ModeInput { force_n: 7.5, ..FREE }), "{contact}");
        assert!(!ended(contact, ModeInput { probe_mm: 1.01, force_n: 7.4, ..FREE }), "{contact}");
    }
}
