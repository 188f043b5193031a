//! Presses of the simulated hand on the simulated board.

use firmware::sensor::fsr_conductance_ms;
use protocol::message::{DisplayMode, Mode, Parts, ResistiveSensor};

use super::table::table;
use super::{Asked, Display, Felt, Pace, Pressed, Sample, Unfelt, fluid_force};
use crate::control::ControlCurve;
use crate::link::{self, InProcess};
use crate::plant::{Bench, Built, Dented, Jitter, Press, Under};
use crate::session::{Event, Patience, Session, SessionError};
use crate::simulated_board::SimulatedBoard;

type Board = Session<InProcess>;

/// Force at the end of a press over the last of the curve, and the largest that a hand gives, N.
const PART: f64 = 0.9;
const HAND_N: f64 = 5.0;
/// Time at the farthest place, and before a press, s.
const HOLD_S: f64 = 0.5;
const BEFORE_S: f64 = 0.5;
/// Forces that the display's sensor is calibrated with, in units of 100 gf: those of the thesis' Table 7, and smaller ones,
/// because soft foams ask for them. An FSR reads nothing of the first two.
const WEIGHTS: [f64; 13] = [0.1, 0.2, 0.3, 0.5, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0];
const UNREAD: usize = 2;
/// 100 gf, N.
const UNIT_N: f64 = 0.980_665;
/// How long a weight lies before it is read, and then the sensor rests from it, s.
const WEIGHED_S: f64 = 1.0;

/// Feels all materials on a display, slowly and fast; `told` hears of every press done.
///
/// # Errors
/// [`Unfelt`].
pub fn run(asked: &Asked, display: Display, told: &mut dyn FnMut(usize)) -> Result<Vec<Felt>, Unfelt> {
    run_at(asked, display, &Pace::ALL, told)
}

/// The same with these presses of each material, one after the other.
pub(super) fn run_at(
    asked: &Asked,
    display: Display,
    paces: &[Pace],
    told: &mut dyn FnMut(usize),
) -> Result<Vec<Felt>, Unfelt> {
    let mut session = opened(asked, display)?;
    let mut done = 0;
    let mut all = Vec::new();
    for (index, curve) in asked.curves.iter().enumerate() {
        let mut presses = Vec::new();
        for &pace in paces {
            let samples = pressed(&mut session, asked, (index, curve, display == Display::FluidAtPlace), pace)?;
            presses.push(Pressed { pace, samples });
            done += 1;
            told(done);
        }
        all.push(Felt { curve: curve.clone(), display, presses, is_read: false });
    }
    Ok(all)
}

/// A board with the table, its force sensor calibrated.
fn opened(asked: &Asked, display: Display) -> Result<Board, Unfelt> {
    let constants = &asked.constants;
    let under = match display {
        Display::Actuator => Under::Cap,
        Display::Fluid | Display::FluidAtPlace => Under::Fluid(Box::new(Dented::new(fluid_force()?))),
    };
    let built = Built {
        flux: asked.flux.clone(),
        law: asked.law.clone(),
        factor: constants.flux,
        remanence_t: constants.remanence_t,
        yields: constants.yields,
        response_s: constants.response_s,
        rest_kpa: constants.rest_kpa,
    };
    let bench = Bench::new(asked.seed, Jitter::NONE).with(constants, under, Some(built));
    let board = SimulatedBoard::new(asked.seed, Jitter::NONE).on(bench);
    let (mut session, _) = Session::open(InProcess::new(board, link::Pace::Free), Patience::default())?;
    session.upload(&table(&asked.curves)?, |_| {})?;
    if let Some(gains) = asked.gains.clone() {
        session.set_gains(gains)?;
    }
    if let Some(actuator) = asked.actuator.clone() {
        session.set_actuator(actuator)?;
    }
    calibrate(&mut session, display)?;
    Ok(session)
}

/// Fits the force sensor's line to known weights, each laid on by itself, as a laboratory does.
fn calibrate(session: &mut Board, display: Display) -> Result<(), Unfelt> {
    let mut calibration = session.calibration()?;
    let weights = if display.is_fluid() { &WEIGHTS[..] } else { &WEIGHTS[UNREAD..] };
    let mut points = Vec::new();
    for weight in weights {
        session.link_mut().board_mut().bench_mut().weigh(Some(weight * UNIT_N));
        wait(session, WEIGHED_S)?;
        let law = calibration.fsr.clone();
        let read =
            records(session, WEIGHED_S, |_, raw| f64::from(fsr_conductance_ms(f32::from(raw) / 65_535.0, &law)))?;
        points.push((*weight, read.iter().sum::<f64>() / read.len().max(1) as f64));
        session.link_mut().board_mut().bench_mut().weigh(Some(0.0));
        wait(session, WEIGHED_S)?;
    }
    session.link_mut().board_mut().bench_mut().weigh(None);
    let Some((slope, offset)) = line(&points) else {
        let told = points.iter().map(|(weight, ms)| format!("{ms:.4} mS of {weight}")).collect::<Vec<_>>();
        return Err(Unfelt::Calibration { found: told.join(", ") });
    };
    calibration.fsr = ResistiveSensor { slope: slope as f32, offset: offset as f32, ..calibration.fsr };
    session.set_calibration(calibration)?;
    Ok(())
}

/// Slope and offset of the line through points `(x, y)` whose errors are in proportion to `y`, as creep and scatter of such
/// sensors are; `None` unless it rises.
fn line(points: &[(f64, f64)]) -> Option<(f64, f64)> {
    let weighed = || points.iter().filter(|(_, y)| *y > 0.0).map(|(x, y)| (1.0 / (y * y), *x, *y));
    let sum = |of: &dyn Fn(f64, f64) -> f64| weighed().map(|(w, x, y)| w * of(x, y)).sum::<f64>();
    let count = sum(&|_, _| 1.0);
    let (mean_x, mean_y) = (sum(&|x, _| x) / count, sum(&|_, y| y) / count);
    let slope = sum(&|x, y| (x - mean_x) * (y - mean_y)) / sum(&|x, _| (x - mean_x).powi(2));
    (slope > 0.0 && slope.is_finite()).then_some((slope, mean_y - slope * mean_x))
}

/// Lets time pass.
fn wait(session: &mut Board, for_s: f64) -> Result<(), SessionError> {
    let until_s = session.link().board().time_s() + for_s;
    while session.poll(until_s)?.is_some() {}
    Ok(())
}

/// What a reading of every tick makes of the FSR's reading as it comes.
fn records<T>(session: &mut Board, for_s: f64, mut of: impl FnMut(&Board, u16) -> T) -> Result<Vec<T>, SessionError> {
    let until_s = session.link().board().time_s() + for_s;
    let mut all = Vec::new();
    while let Some(event) = session.poll(until_s)? {
        if let Event::Telemetry(record) = event {
            all.push(of(session, record.raw.fsr));
        }
    }
    Ok(all)
}

fn pressed(
    session: &mut Board,
    asked: &Asked,
    (index, curve, by_place): (usize, &ControlCurve, bool),
    pace: Pace,
) -> Result<Vec<Sample>, SessionError> {
    let material = u8::try_from(index).unwrap_or(u8::MAX);
    if by_place {
        session.link_mut().board_mut().bench_mut().ride(true);
        session.set_display(DisplayMode::Material { parts: Parts::CoilAtPlace, material })?;
    } else {
        session.set_mode(Mode::Display { material })?;
    }
    wait(session, BEFORE_S)?;
    // The hand's own spring gives way as well.
    let force_n = (PART * curve.most_n()).min(HAND_N);
    let peak_mm = curve.travel_at(force_n) + force_n / asked.constants.hand.stiffness_n_mm;
    let press = Press { peak_mm, way_s: pace.way_s(), hold_s: HOLD_S };
    let began_s = session.link().board().time_s();
    session.link_mut().board_mut().bench_mut().press(press);
    let mut samples = Vec::new();
    while let Some(event) = session.poll(began_s + press.lasts_s())? {
        let Event::Telemetry(record) = event else { continue };
        let board = session.link().board();
        let truth = board.bench().truth(record.tick, board.time_s());
        samples.push(Sample {
            time_s: truth.time_s - began_s,
            force_n: truth.finger_n,
            bone_mm: board.bench().bone_mm(),
            shaft_mm: truth.shaft_mm,
            yield_kpa: truth.yield_kpa,
            flux_t: truth.flux_t,
            read_n: f64::from(record.fsr_n),
            read_mm: f64::from(record.shaft_mm),
            target_mm: f64::from(record.shaft_target_mm),
            wanted_a: f64::from(record.coil_target_a),
            unreachable: record.shown.unreachable,
        });
    }
    session.set_mode(Mode::Idle)?;
    session.link_mut().board_mut().bench_mut().ride(false);
    wait(session, BEFORE_S)?;
    Ok(samples)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_found_and_what_does_not_rise_is_none() {
        let points: Vec<(f64, f64)> = WEIGHTS.iter().map(|x| (*x, 0.02 + 0.08 * x)).collect();
        let (slope, offset) = line(&points).unwrap_or_default();
        assert!((slope - 0.08).abs() < 1e-12 && (offset - 0.02).abs() < 1e-12);
        assert_eq!(line(&[(1.0, 0.2), (2.0, 0.1)]), None);
        assert_eq!(line(&[(1.0, 0.0), (2.0, 0.0)]), None);
    }
}
