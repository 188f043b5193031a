use super::*;

/// A fluid that bears too little gets more current, in proportion and up to a bound, while the finger goes down.
#[test]
fn at_a_place_the_force_that_is_read_trims_the_current() {
    let config = DisplayConfig::default();
    let current = Some(Current { a: 1.0, unreachable: false });
    let at = |bears_n| Wanted { current, bears_n, is_settled: true, ..Wanted::default() };
    let read = |force_n| DisplayInput { shaft_mm: 1.0, force_n, least_n: 0.2, coil_c: 20.0 };
    let mut display = Display::default();
    let mut trimmed = |wanted: &Wanted, force_n, allowed_a| {
        display.trimmed(&config, wanted, &read(force_n), allowed_a).map_or(0.0, |c| c.a)
    };
    // not without a place, not at rest, not during a transition, not from a force that the sensor does not tell
    assert_eq!(trimmed(&at(None), 0.5, 2.5), 1.0);
    assert_eq!(trimmed(&at(Some(0.5 * config.coil_standby_n)), 0.5, 2.5), 1.0);
    assert_eq!(trimmed(&Wanted { is_settled: false, ..at(Some(2.0)) }, 1.0, 2.5), 1.0);
    for nothing in [0.0, 0.2, f32::NAN] {
        assert_eq!(trimmed(&at(Some(2.0)), nothing, 2.5), 1.0);
    }
    // a tenth is missing: a quarter of a second makes up for a tenth
    let after = (0..13).map(|_| trimmed(&at(Some(2.0)), 1.8, 2.5)).last().unwrap_or(0.0);
    assert!((after - 1.104).abs() < 1e-3, "{after}");
    // on the way up and at rest it stays
    assert_eq!((trimmed(&at(Some(1.0)), 0.5, 2.5), trimmed(&at(Some(0.05)), 0.5, 2.5)), (after, after));
    // against a limit nothing winds up, and beyond its bounds it does not go
    assert_eq!((0..200).map(|_| trimmed(&at(Some(3.0)), 0.3, 1.0)).last(), Some(after));
    let most = (0..200).map(|_| trimmed(&at(Some(3.0)), 0.3, 2.5)).last().unwrap_or(0.0);
    assert!((most - 1.0 - config.trim.1).abs() < 1e-6, "{most}");
    let least = (0..200).map(|_| trimmed(&at(Some(3.0)), 9.0, 2.5)).last().unwrap_or(0.0);
    assert!((least - 1.0 - config.trim.0).abs() < 1e-6, "{least}");
}

#[test]
fn an_actuator_within_the_boards_limits_is_taken_and_its_feed_forward_holds_a_finger() {
    let own = Actuator { reach_mm: 18.0, rate_mm_s: 150.0, holds_v_per_n: 0.1 };
    let taken = DisplayConfig::default().with(&own).unwrap_or_default();
    assert_eq!((taken.target_max_mm, taken.target_rate_mm_s, taken.holds_v_per_n), (18.0, 150.0, 0.1));
    for other in [
        Actuator { reach_mm: 19.5, ..own.clone() },
        Actuator { rate_mm_s: f32::NAN, ..own.clone() },
        Actuator { holds_v_per_n: -0.1, ..own.clone() },
    ] {
        assert_eq!(DisplayConfig::default().with(&other), None, "{other:?}");
    }
    let pid = Pid::build(&crate::pid::DEFAULT_GAINS, protocol::TICK_S, crate::pid::U_MAX_V);
    let at = DisplayInput { shaft_mm: 5.0, force_n: 4.0, least_n: 0.2, coil_c: 20.0 };
    let wanted = Wanted { shaft_mm: 5.0, ..Wanted::default() };
    let step = |config: &DisplayConfig| {
        Display::at(5.0).step(config, &ThermalConfig::default(), &pid, &wanted, &at).actuator_v
    };
    assert_eq!((step(&taken), step(&DisplayConfig { target_max_mm: 18.0, ..DisplayConfig::default() })), (-0.4, 0.0));
    // a force that no finger makes is held as the largest that one does
    let wrong = DisplayInput { force_n: 50.0, ..at };
    let held = Display::at(5.0).step(&taken, &ThermalConfig::default(), &pid, &wanted, &wrong);
    assert!((held.actuator_v + 0.6).abs() < 1e-6, "{}", held.actuator_v);
}

/// The thesis' loop stays 1 / 9.6 of a second behind, a softer one more, and no lag is made up for that nobody knows.
#[test]
fn a_lag_is_that_of_gains_and_reach_where_these_tell_it() {
    let lag = |config: &DisplayConfig, ki: f32| {
        let gains = protocol::message::Gains { ki, ..crate::pid::DEFAULT_GAINS };
        config.lag_s(&Pid::build(&gains, protocol::TICK_S, crate::pid::U_MAX_V))
    };
    let thesis = DisplayConfig::default();
    assert!((lag(&thesis, 9.6).unwrap_or(0.0) - 1.0 / 9.6).abs() < 1e-6);
    // twice the way a volt, half the lag
    let longer = DisplayConfig { target_max_mm: 9.0, ..thesis };
    assert!((lag(&longer, 9.6).unwrap_or(0.0) - 0.5 / 9.6).abs() < 1e-6);
    assert_eq!((lag(&thesis, 0.1), lag(&thesis, 0.0)), (Some(LAG_MAX_S), None));
    assert_eq!(lag(&DisplayConfig { holds_v_per_n: 0.1, ..thesis }, 9.6), None);
    assert_eq!(lag(&DisplayConfig { target_max_mm: REACH_MM.1, ..thesis }, 9.6), None);
}

/// With a finger on it, for two seconds: the command ends at its limit, which is what tells a stall.
#[test]
fn a_blocked_shaft_is_driven_at_the_limit_with_feed_forward_as_well() {
    let own = Actuator { reach_mm: 18.0, rate_mm_s: 150.0, holds_v_per_n: 0.3 };
    let config = DisplayConfig::default().with(&own).unwrap_or_default();
    let gains = protocol::message::Gains { kp: 0.02, ki: 4.0, kd: 0.0, n: 50.0 };
    let pid = Pid::build(&gains, protocol::TICK_S, crate::pid::U_MAX_V);
    let wanted = Wanted { shaft_mm: 3.0, ..Wanted::default() };
    let blocked = DisplayInput { shaft_mm: 1.0, force_n: 3.0, least_n: 0.2, coil_c: 20.0 };
    let mut display = Display::at(1.0);
    let mut last = 0.0;
    for _ in 0..100 {
        last = display.step(&config, &ThermalConfig::default(), &pid, &wanted, &blocked).actuator_v;
    }
    assert_eq!(last, crate::pid::U_MAX_V);
}

/// At its stop a coil that a finger pushes is held there, and no chatter begins; a spindle gets no command into it.
#[test]
fn at_the_stop_a_finger_is_held_by_feed_forward_and_integral() {
    let own = Actuator { reach_mm: 18.0, rate_mm_s: 150.0, holds_v_per_n: 0.0875 };
    let coil = DisplayConfig::default().with(&own).unwrap_or_default();
    let gains = protocol::message::Gains { kp: 0.02, ki: 4.9, kd: 0.0, n: 50.0 };
    let pid = Pid::build(&gains, protocol::TICK_S, crate::pid::U_MAX_V);
    let wanted = Wanted::default();
    let mut display = Display::default();
    // 4 mm/V, driven back by 0.5 mm/N, at rest within a tick
    let mut shaft_mm = 0.0;
    let mut place = [0.0; 100];
    for at in &mut place {
        let input = DisplayInput { shaft_mm, force_n: 5.0, least_n: 0.2, coil_c: 20.0 };
        let v = display.step(&coil, &ThermalConfig::default(), &pid, &wanted, &input).actuator_v;
        shaft_mm = limit(4.0 * v + 2.5, 0.0, 20.0);
        *at = shaft_mm;
    }
    assert!(place[50..].iter().all(|mm| *mm < 0.05), "{:?}", &place[90..]);
}

/// From far out the way home is slow whatever the reach, and fast once it is home.
#[test]
fn a_far_shaft_comes_home_slowly_with_the_whole_stroke_as_well() {
    let own = Actuator { reach_mm: 19.0, rate_mm_s: 200.0, holds_v_per_n: 0.0 };
    let config = DisplayConfig::default().with(&own).unwrap_or_default();
    let pid = Pid::build(&crate::pid::DEFAULT_GAINS, protocol::TICK_S, crate::pid::U_MAX_V);
    let input = DisplayInput { shaft_mm: 15.0, force_n: 0.0, least_n: 0.2, coil_c: 20.0 };
    let mut display = Display::at(15.0);
    let mut target = |mm| {
        let wanted = Wanted { shaft_mm: mm, ..Wanted::default() };
        display.step(&config, &ThermalConfig::default(), &pid, &wanted, &input).target_mm
    };
    assert!((target(14.8) - 14.9).abs() < 1e-6 && (target(14.8) - 14.8).abs() < 1e-6);
    assert!((target(10.0) - 10.8).abs() < 1e-5, "home: 200 mm/s");
}

#[test]
fn a_current_that_is_cut_is_told_and_no_other() {
    let wanted = |a, unreachable| Some(Current { a, unreachable });
    let shown = |unreachable, coil_limited, actuator_only| Shown {
        unreachable,
        coil_limited,
        shaft_limited: false,
        actuator_only,
    };
    assert_eq!(coil(wanted(1.0, false), 2.5), (1.0, shown(false, false, false)));
    assert_eq!(coil(wanted(2.5, false), 2.5), (2.5, shown(false, false, false)));
    assert_eq!(coil(wanted(2.0, true), 2.5), (2.0, shown(true, false, false)));
    assert_eq!(coil(wanted(2.0, false), 1.25), (1.25, shown(false, true, false)));
    assert_eq!(coil(wanted(2.0, true), 0.0), (0.0, shown(true, true, false)));
    assert_eq!(coil(wanted(f32::NAN, false), 2.5), (0.0, shown(false, true, false)));
    assert_eq!(coil(None, 2.5), (0.0, shown(false, false, true)));
}
