//! Presses of the simulated hand on the simulated board.

use firmware::sensor::fsr_conductance_ms;
use protocol::message::{Mode, ResistiveSensor};

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
/// Forces that the display's sensor is calibrated with, in units of 100 gf: those of the thesis' Table 7; of a load cell
/// smaller ones before them.
const WEIGHTS: [f64; 12] = [0.1, 0.2, 0.5, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0];
/// 100 gf, N.
const UNIT_N: f64 = 0.980_665;
/// How long a weight lies before it is read, s.
const WEIGHED_S: f64 = 1.0;

/// Feels all materials on a display, slowly and fast; `told` hears of every press done.
///
/// # Errors
/// [`Unfelt`].
pub fn run(asked: &Asked, display: Display, told: &mut dyn FnMut(usize)) -> Result<Vec<Felt>, Unfelt> {
    let mut session = opened(asked, display)?;
    let mut done = 0;
    let mut all = Vec::new();
    for (index, curve) in asked.curves.iter().enumerate() {
        let mut presses = Vec::new();
        for pace in Pace::ALL {
            let samples = pressed(&mut session, asked, (index, curve), pace)?;
            presses.push(Pressed { pace, samples });
            done += 1;
            told(done);
        }
        all.push(Felt { curve: curve.clone(), display, presses });
    }
    Ok(all)
}

/// A board with the table, its force sensor calibrated.
fn opened(asked: &Asked, display: Display) -> Result<Board, Unfelt> {
    let constants = &asked.constants;
    let under = match display {
        Display::Actuator => Under::Cap,
        Display::Fluid => Under::Fluid(Box::new(Dented::new(fluid_force()?))),
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
    calibrate(&mut session, display)?;
    Ok(session)
}

/// Fits the force sensor's line to known weights, as a laboratory does.
fn calibrate(session: &mut Board, display: Display) -> Result<(), Unfelt> {
    let mut calibration = session.calibration()?;
    let weights = if display == Display::Fluid { &WEIGHTS[..] } else { &WEIGHTS[3..] };
    let mut points = Vec::new();
    for weight in weights {
        session.link_mut().board_mut().bench_mut().weigh(Some(weight * UNIT_N));
        wait(session, WEIGHED_S)?;
        let law = calibration.fsr.clone();
        let read =
            records(session, WEIGHED_S, |_, raw| f64::from(fsr_conductance_ms(f32::from(raw) / 65_535.0, &law)))?;
        points.push((*weight, read.iter().sum::<f64>() / read.len().max(1) as f64));
    }
    session.link_mut().board_mut().bench_mut().weigh(None);
    let count = points.len() as f64;
    let mean = |of: fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / count;
    let (x, y) = (mean(|p| p.0), mean(|p| p.1));
    let slope = points.iter().map(|p| (p.0 - x) * (p.1 - y)).sum::<f64>()
        / points.iter().map(|p| (p.0 - x).powi(2)).sum::<f64>();
    if !(slope > 0.0 && slope.is_finite()) {
        return Err(Unfelt::Calibration { found: format!("{slope} mS over 100 gf") });
    }
    let (slope, offset) = (slope as f32, (y - slope * x) as f32);
    calibration.fsr = ResistiveSensor { slope, offset, ..calibration.fsr };
    session.set_calibration(calibration)?;
    Ok(())
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
    (index, curve): (usize, &ControlCurve),
    pace: Pace,
) -> Result<Vec<Sample>, SessionError> {
    session.set_mode(Mode::Display { material: u8::try_from(index).unwrap_or(u8::MAX) })?;
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
            read_n: f64::from(record.fsr_n),
            read_mm: f64::from(record.shaft_mm),
            target_mm: f64::from(record.shaft_target_mm),
            wanted_a: f64::from(record.coil_target_a),
            unreachable: record.shown.unreachable,
        });
    }
    session.set_mode(Mode::Idle)?;
    wait(session, BEFORE_S)?;
    Ok(samples)
}
