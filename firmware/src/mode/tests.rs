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

fn approaching() -> Modes {
    let mut mode = Modes::new();
    mode.request(&ModeConfig::default(), PALPATE, LIMITS).unwrap();
    mode
}

/// Steps until the state changes; returns the number of steps.
fn steps_in_state(mode: &mut Modes, input: &ModeInput) -> u32 {
    let state = mode.state();
    (1..=10_000)
        .find(|_| {
            mode.step(&ModeConfig::default(), input);
            mode.state() != state
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
    assert_eq!((mode.state(), mode.palpating.ended()), (State::Retract, Outcome::NoContact));
    assert_eq!(steps_in_state(&mut mode, &lower), config.retract_ticks + 1);
    assert_eq!(mode.state(), State::Idle);

    let mut mode = approaching();
    let stuck = ModeInput { contact: true, depth_mm: 0.3, ..FREE };
    mode.step(&config, &stuck);
    assert_eq!(mode.state(), State::Contact);
    assert_eq!(steps_in_state(&mut mode, &stuck), config.contact_ticks + 1);
    assert_eq!((mode.state(), mode.palpating.ended()), (State::Retract, Outcome::TooShort));
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
    assert_eq!((mode.state(), mode.palpating.ended()), (State::Retract, Outcome::Identified));
    let back = ModeInput { contact: true, depth_mm: -1.5, ..FREE };
    for waiting in [ModeInput { depth_mm: 2.0, ..back }, ModeInput { analysed: false, ..back }] {
        assert_eq!(mode.step(&config, &waiting), ModeEvent::None);
    }
    assert_eq!(mode.step(&config, &back), ModeEvent::Ended(Outcome::Identified));
    assert_eq!((mode.state(), mode.commanded()), (State::Idle, Mode::Idle));
}

const BOTH: DisplayMode = DisplayMode::Material { parts: Parts::Both, material: 1 };
const WAITING: DisplayMode = DisplayMode::Follow { parts: Parts::Both, by: protocol::message::Rule::Nearest };

/// Both halves in all their states: outputs are on in approach and contact, and while a curve is displayed.
#[test]
fn each_half_has_its_own_outputs_whatever_the_other_does() {
    let stages = [Stage::Rest, Stage::Approach, Stage::Contact, Stage::Retract];
    let shown = [(DisplayMode::Idle, Curve::NONE), (WAITING, Curve::NONE), (BOTH, Curve::of(1))];
    let parts = [Parts::Both, Parts::Coil, Parts::Actuator].map(|parts| DisplayMode::Material { parts, material: 1 });
    let shown = shown.into_iter().chain(parts.map(|asked| (asked, Curve::of(1))));
    for (asked, curve) in shown {
        for stage in stages {
            let mut mode = Modes::new();
            if asked != DisplayMode::Idle {
                mode.display(asked, (curve, Origin::ASKED), LIMITS).unwrap();
            }
            mode.palpating.stage = stage;
            mode.palpating.press = Some(Press { rate_mm_s: 1.0, depth_mm: 4.0 });
            let on = curve != Curve::NONE;
            let wanted = Power {
                arm: matches!(stage, Stage::Approach | Stage::Contact),
                actuator: on && asked.parts().unwrap().actuator(),
                coil: on && asked.parts().unwrap().coil(),
            };
            assert_eq!(mode.power(), wanted, "{asked:?} {stage:?}");
            assert_eq!(mode.needs_host(), wanted.arm || asked != DisplayMode::Idle, "{asked:?} {stage:?}");
            mode.step(&ModeConfig::default(), &ModeInput { faulted: true, ..FREE });
            assert_eq!((mode.power(), mode.needs_host(), mode.state()), (Power::OFF, false, State::Fault));
        }
    }
}

/// What an old tool sees: palpation while it does anything, else display.
#[test]
fn both_halves_in_one_word() {
    let config = ModeConfig::default();
    let press = Press { rate_mm_s: 1.0, depth_mm: 4.0 };
    let mut mode = Modes::new();
    mode.display(BOTH, (Curve::of(1), Origin::ASKED), LIMITS).unwrap();
    assert_eq!((mode.state(), mode.commanded()), (State::Display, Mode::Display { material: 1 }));
    mode.press(&config, press, LIMITS).unwrap();
    assert_eq!((mode.state(), mode.commanded()), (State::Approach, PALPATE));
    assert_eq!((mode.palpation_state(), mode.display_state()), (State::Approach, DisplayState::On));
    mode.stop_palpation();
    assert_eq!((mode.state(), mode.commanded()), (State::Retract, Mode::Display { material: 1 }));
    mode.stop_display();
    assert_eq!((mode.state(), mode.is_resting()), (State::Retract, false));
    mode.display(WAITING, (Curve::NONE, Origin::ASKED), LIMITS).unwrap();
    assert_eq!(mode.display_state(), DisplayState::Waiting);
    mode.follow(Curve::of(2), Origin::ASKED);
    assert_eq!((mode.display_state(), mode.displaying.showing().to()), (DisplayState::On, Curve::of(2)));
    mode.stop();
    assert_eq!(mode.display_state(), DisplayState::Idle);
}

/// The requests of before still exclude each other, in every state of the other half.
#[test]
fn a_mode_for_the_whole_board_needs_the_other_half_at_rest() {
    let config = ModeConfig::default();
    let show = Mode::Display { material: 1 };
    let mut mode = approaching();
    assert_eq!(mode.request(&config, show, LIMITS), Err(Refusal::Busy));
    mode.request(&config, Mode::Idle, LIMITS).unwrap();
    assert_eq!((mode.state(), mode.request(&config, show, LIMITS)), (State::Retract, Err(Refusal::Busy)));
    let mut mode = Modes::new();
    mode.request(&config, show, LIMITS).unwrap();
    assert_eq!(mode.request(&config, PALPATE, LIMITS), Err(Refusal::Busy));
    mode.request(&config, Mode::Display { material: 2 }, LIMITS).unwrap();
    assert!(!mode.by_halves());
}

#[test]
fn other_parts_of_the_display_do_not_begin_in_the_middle() {
    let mut mode = Modes::new();
    let coil = DisplayMode::Material { parts: Parts::Coil, material: 1 };
    mode.display(coil, (Curve::of(1), Origin::ASKED), LIMITS).unwrap();
    assert_eq!(mode.display(BOTH, (Curve::of(1), Origin::ASKED), LIMITS), Err(Refusal::Busy));
    assert_eq!(mode.display(coil, (Curve::of(3), Origin::ASKED), LIMITS), Err(Refusal::OutOfRange));
    assert_eq!(mode.displaying.asked(), coil);
    mode.stop_display();
    mode.display(BOTH, (Curve::of(1), Origin::ASKED), LIMITS).unwrap();
}

/// In the air as in contact, whatever floor the press has.
#[test]
fn the_lowest_travel_and_the_force_of_the_end_lift_the_arm_at_once() {
    let config = ModeConfig::default();
    let ended = |contact: bool, input: ModeInput| {
        let mut mode = approaching();
        if contact {
            mode.step(&config, &ModeInput { contact, ..FREE });
            assert_eq!(mode.state(), State::Contact);
        }
        mode.step(&config, &ModeInput { contact, ..input });
        mode.state() == State::Retract
    };
    for contact in [false, true] {
        assert!(ended(contact, ModeInput { probe_mm: 1.0, ..FREE }), "{contact}");
        assert!(ended(contact, ModeInput { force_n: 7.5, ..FREE }), "{contact}");
        assert!(!ended(contact, ModeInput { probe_mm: 1.01, force_n: 7.4, ..FREE }), "{contact}");
    }
}
