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

/// What was felt, and why it is not all.
pub type FeltSoFar = (Vec<Felt>, Option<Unfelt>);

/// Displays each material twice and records the finger that presses it; `ready` asks for each press, and ends it all by
/// an error. What was felt until then is kept, and the outputs are off again whatever happens.
pub fn on_board<L: Link>(
    session: &mut Session<L>,
    (materials, display): (&[OnBoard], Display),
    stop: &AtomicBool,
    ready: &mut dyn FnMut(&ControlCurve, Pace) -> Result<(), Unfelt>,
) -> FeltSoFar {
    let mut all = Vec::new();
    for material in materials {
        let mut presses = Vec::new();
        let mut ended = None;
        for pace in Pace::ALL {
            let felt = ready(&material.curve, pace).and_then(|()| {
                let samples = pressed(session, (material, display), stop);
                session.set_mode(Mode::Idle)?;
                samples
            });
            match felt {
                Ok(samples) => presses.push(Pressed { pace, samples }),
                Err(error) => ended = Some(error),
            }
            if ended.is_some() {
                break;
            }
        }
        if !presses.is_empty() {
            all.push(Felt { curve: material.curve.clone(), display, presses, is_read: true });
        }
        if ended.is_some() {
            return (all, ended);
        }
    }
    (all, None)
}

fn pressed<L: Link>(
    session: &mut Session<L>,
    (material, display): (&OnBoard, Display),
    stop: &AtomicBool,
) -> Result<Vec<Sample>, Unfelt> {
    if stop.load(Ordering::Relaxed) {
        return Err(Unfelt::Ended);
    }
    let parts = if display == Display::Actuator { Parts::Actuator } else { Parts::CoilAtPlace };
    session.set_display(DisplayMode::Material { parts, material: material.index })?;
    // what was said while somebody was asked to press still waits to be read
    let from_tick = session.status()?.uptime_ms / (1000 / TICK_HZ);
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
            return if touched_s.is_some() { Ok(samples) } else { Err(untouched(&material.curve, is_free)) };
        }
        let Some(event) = session.poll(until_s.min(now_s + LIFTED_S))? else { continue };
        match event {
            Event::Fault(fault) => return Err(Unfelt::Fault(crate::session::fault_text(&fault))),
            Event::Gap(gap) => return Err(Unfelt::Fault(crate::session::gap_text(&gap))),
            Event::Telemetry(record) if record.tick >= from_tick => {
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
                    flux_t: f64::NAN,
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

fn untouched(curve: &ControlCurve, is_free: bool) -> Unfelt {
    let material = curve.material.clone();
    if is_free {
        Unfelt::Untouched { material, waited_s: BEGINS_S }
    } else {
        Unfelt::Loaded { material, waited_s: BEGINS_S }
    }
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
        });
        let (felt, ended) = felt;
        assert!(ended.is_none());
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
        let run = |session: &mut Session<InProcess>, stop: bool| {
            on_board(session, (&materials, Display::Actuator), &AtomicBool::new(stop), &mut |_, _| Ok(()))
        };
        let (felt, ended) = run(&mut session, false);
        assert!(felt.is_empty());
        assert!(ended.unwrap().to_string().starts_with("nobody pressed EVA within 20 s"));
        assert_eq!(session.status().unwrap().mode, Mode::Idle);
        assert!(matches!(run(&mut session, true).1, Some(Unfelt::Ended)));
    }

    /// Whoever ends after the first press keeps it.
    #[test]
    fn what_was_felt_is_kept() {
        let (mut session, materials) = opened(Some(Touch { peak_n: 3.0, period_s: 8.0 }));
        let mut left = 1;
        let (felt, ended) =
            on_board(&mut session, (&materials, Display::Actuator), &AtomicBool::new(false), &mut |_, _| {
                left -= 1;
                if left < 0 { Err(Unfelt::Ended) } else { Ok(()) }
            });
        assert!(felt.len() == 1 && felt[0].presses.len() == 1 && matches!(ended, Some(Unfelt::Ended)));
    }
}
