//! Presses of somebody's own finger on a board: what is scored are the readings, for nobody knows the truth.

use std::sync::atomic::{AtomicBool, Ordering};

use protocol::TICK_HZ;
use protocol::message::{DisplayMode, Mode, Parts};

use super::{Display, Felt, Pace, Pressed, Sample, Unfelt};
use crate::control::ControlCurve;
use crate::link::Link;
use crate::session::{Event, Session};

/// A material of the board's library, and what it should feel like.
#[derive(Debug, Clone)]
pub struct OnBoard {
    /// Its number in the library.
    pub index: u8,
    /// Its curve.
    pub curve: ControlCurve,
}

/// Force (N) above which a finger presses, and longest waits for it and for its end (s).
const TOUCHED_N: f64 = 0.1;
const BEGINS_S: f64 = 20.0;
const ENDS_S: f64 = 30.0;
/// How long a finger must have lifted, s.
const LIFTED_S: f64 = 0.3;

/// Displays each material twice and records the finger that presses it; `ready` asks for each press, and ends it all by
/// an error. The outputs are off again whatever happens.
///
/// # Errors
/// [`Unfelt::Untouched`] where nobody presses, [`Unfelt::Ended`] on a signal, and what the board refuses.
pub fn on_board<L: Link>(
    session: &mut Session<L>,
    (materials, display): (&[OnBoard], Display),
    stop: &AtomicBool,
    ready: &mut dyn FnMut(&ControlCurve, Pace) -> Result<(), Unfelt>,
) -> Result<Vec<Felt>, Unfelt> {
    let mut all = Vec::new();
    for material in materials {
        let mut presses = Vec::new();
        for pace in Pace::ALL {
            ready(&material.curve, pace)?;
            let samples = pressed(session, (material, display), stop);
            session.set_mode(Mode::Idle)?;
            presses.push(Pressed { pace, samples: samples? });
        }
        all.push(Felt { curve: material.curve.clone(), display, presses, is_read: true });
    }
    Ok(all)
}

fn pressed<L: Link>(
    session: &mut Session<L>,
    (material, display): (&OnBoard, Display),
    stop: &AtomicBool,
) -> Result<Vec<Sample>, Unfelt> {
    let parts = if display == Display::Actuator { Parts::Actuator } else { Parts::CoilAtPlace };
    session.set_display(DisplayMode::Material { parts, material: material.index })?;
    let began_s = session.link().now_s();
    let mut is_free = false;
    let (mut samples, mut first_s, mut touched_s, mut lifted_s) = (Vec::new(), None, None, None);
    loop {
        let now_s = session.link().now_s();
        let until_s = touched_s.map_or(began_s + BEGINS_S, |at: f64| at + ENDS_S);
        if stop.load(Ordering::Relaxed) {
            return Err(Unfelt::Ended);
        }
        if now_s >= until_s {
            // a finger that does not lift has been felt all the same
            return if touched_s.is_some() { Ok(samples) } else { Err(untouched(&material.curve)) };
        }
        let Some(event) = session.poll(until_s.min(now_s + LIFTED_S))? else { continue };
        match event {
            Event::Fault(fault) => return Err(Unfelt::Fault(crate::session::fault_text(&fault))),
            Event::Telemetry(record) => {
                let (force_n, shaft_mm) = (f64::from(record.fsr_n), f64::from(record.shaft_mm));
                // a finger that lies there already has to lift first: a press begins with nothing
                is_free |= force_n <= TOUCHED_N;
                if !is_free {
                    continue;
                }
                let time_s = f64::from(record.tick) / f64::from(TICK_HZ);
                let first_s = *first_s.get_or_insert(time_s);
                if force_n > TOUCHED_N {
                    touched_s.get_or_insert(now_s);
                    lifted_s = None;
                } else if touched_s.is_some() && now_s - *lifted_s.get_or_insert(now_s) > LIFTED_S {
                    return Ok(samples);
                }
                samples.push(Sample {
                    time_s: time_s - first_s,
                    force_n,
                    bone_mm: shaft_mm,
                    shaft_mm,
                    yield_kpa: f64::NAN,
                    read_n: force_n,
                    read_mm: shaft_mm,
                    target_mm: f64::from(record.shaft_target_mm),
                    wanted_a: f64::from(record.coil_target_a),
                    unreachable: record.shown.unreachable,
                });
            }
            _ => {}
        }
    }
}

fn untouched(curve: &ControlCurve) -> Unfelt {
    Unfelt::Untouched { material: curve.material.clone(), waited_s: BEGINS_S }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::feel::table::table;
    use crate::link::{self, InProcess};
    use crate::plant::{Jitter, Touch};
    use crate::session::Patience;
    use crate::simulated_board::SimulatedBoard;

    fn opened(touch: Option<Touch>) -> (Session<InProcess>, Vec<OnBoard>) {
        let curve = ControlCurve::built_in("EVA").unwrap();
        let mut board = SimulatedBoard::new(3, Jitter::NONE);
        board.touch(touch);
        let link = InProcess::new(board, link::Pace::Free);
        let (mut session, _) = Session::open(link, Patience::default()).unwrap();
        session.upload(&table(std::slice::from_ref(&curve)).unwrap(), |_| {}).unwrap();
        (session, vec![OnBoard { index: 0, curve }])
    }

    /// A finger that presses the simulated board, of which nothing is known but its readings.
    #[test]
    fn a_finger_on_a_board_is_scored_by_its_readings() {
        let (mut session, materials) = opened(Some(Touch { peak_n: 3.0, period_s: 8.0 }));
        let mut asked = Vec::new();
        let felt = on_board(&mut session, (&materials, Display::Actuator), &AtomicBool::new(false), &mut |_, pace| {
            asked.push(pace);
            Ok(())
        })
        .unwrap();
        assert_eq!(asked, Pace::ALL);
        let slow = &felt[0].presses[0];
        let score = felt[0].actuator(slow).unwrap();
        assert!(score.scored > 50 && score.position < 0.08 && score.tracking < 0.1, "{score:?}");
        let peak_n = slow.samples.iter().map(|s| s.force_n).fold(0.0, f64::max);
        assert!((peak_n - 3.0).abs() < 0.6 && slow.samples[0].time_s == 0.0, "{peak_n}");
        assert_eq!(session.status().unwrap().mode, Mode::Idle);
    }

    #[test]
    fn a_board_that_nobody_presses_is_told_and_off() {
        let (mut session, materials) = opened(None);
        let felt = on_board(&mut session, (&materials, Display::Actuator), &AtomicBool::new(false), &mut |_, _| Ok(()));
        assert!(felt.unwrap_err().to_string().starts_with("nobody pressed EVA within 20 s"));
        assert_eq!(session.status().unwrap().mode, Mode::Idle);
        let stopped =
            on_board(&mut session, (&materials, Display::Actuator), &AtomicBool::new(true), &mut |_, _| Ok(()));
        assert!(matches!(stopped, Err(Unfelt::Ended)));
    }
}
