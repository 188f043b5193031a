//! Presses of a tour on a board.

use std::sync::atomic::{AtomicBool, Ordering};

use lut_gen::solid::solve::SolveError;
use protocol::message::{Estimate, Mode, Outcome, Recognition, State, Verdict};

use super::stops::{Stop, Tour};
use crate::link::Link;
use crate::session::{Event, Session, SessionError, fault_text, gap_text};

/// One press and what came of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Pressed {
    /// Number of the press in the tour, from 1.
    pub number: usize,
    /// Which stop.
    pub stop: usize,
    /// Number of the press of this stop, from 1.
    pub of_stop: usize,
    /// The board's verdict: the variance search.
    pub verdict: Verdict,
    /// The board's own filter, where it has said something.
    pub estimate: Option<Estimate>,
    /// Depth (mm) and force (N) in contact, as the board believes them.
    pub samples: Vec<(f64, f64)>,
}

impl Pressed {
    /// The library's material that the search names.
    #[must_use]
    pub fn named(&self) -> Option<usize> {
        let index = self.verdict.material.index;
        (index != Recognition::NONE).then_some(usize::from(index))
    }

    /// Modulus (MPa) and exponent of the search, where it has them.
    #[must_use]
    pub fn identified(&self) -> Option<(f64, f64)> {
        let own = (f64::from(self.verdict.mu_mpa), f64::from(self.verdict.alpha));
        (self.verdict.outcome == Outcome::Identified).then_some(own)
    }
}

/// Brings a specimen under the probe: the bench of the simulation, or an operator.
pub trait Surroundings<L: Link> {
    /// Before press `of_stop` (from 1) of a stop.
    ///
    /// # Errors
    /// Why it cannot be pressed.
    fn bring(&mut self, session: &mut Session<L>, stop: (usize, &Stop), of_stop: usize) -> Result<(), TourError>;

    /// After a press that a fault has ended: `why` it did. The fault is to be cleared before the next one.
    ///
    /// # Errors
    /// Why the tour cannot go on.
    fn mend(&mut self, session: &mut Session<L>, why: &[String]) -> Result<(), TourError>;
}

/// Why a tour ends.
#[derive(Debug, thiserror::Error)]
pub enum TourError {
    /// The board.
    #[error(transparent)]
    Session(#[from] SessionError),
    /// Finite elements of a specimen.
    #[error("stop \"{stop}\" cannot be pressed so far: {source}")]
    Solve {
        /// Its name.
        stop: String,
        /// Why.
        source: Box<SolveError>,
    },
    /// A press without an end.
    #[error("press {number} has no verdict after {waited_s} s; the outputs are off")]
    Endless {
        /// Its number.
        number: usize,
        /// How long was waited, s.
        waited_s: f64,
    },
    /// The operator, or a signal.
    #[error("the tour was ended before press {number}; what was pressed until then is kept")]
    Ended {
        /// The press that was not made.
        number: usize,
    },
    /// A stop without a force.
    #[error("stop \"{stop}\" has no force over depth")]
    Forceless {
        /// Its name.
        stop: String,
    },
    /// What a press leaves behind cannot be written.
    #[error("{0}")]
    Unwritten(String),
}

/// Longest press beside its way, s: the board gives an approach 90 s and a return 30 s; the analysis has the rest.
const BESIDE_S: f64 = 130.0;

/// Presses all stops of an order at a rate (mm/s) to a depth (mm); `told` hears of every press.
///
/// # Errors
/// [`TourError`]; presses that were made have been told.
pub fn walk<L: Link>(
    session: &mut Session<L>,
    (tour, order): (&Tour, &[usize]),
    (rate_mm_s, depth_mm): (f64, f64),
    (surroundings, stopped): (&mut dyn Surroundings<L>, &AtomicBool),
    told: &mut dyn FnMut(&Pressed) -> Result<(), TourError>,
) -> Result<(), TourError> {
    let mut counts = vec![0; tour.stops.len()];
    for (at, stop) in order.iter().enumerate() {
        counts[*stop] += 1;
        let ended = || TourError::Ended { number: at + 1 };
        surroundings.bring(session, (*stop, &tour.stops[*stop]), counts[*stop]).map_err(|error| match error {
            TourError::Ended { .. } => ended(),
            other => other,
        })?;
        if stopped.load(Ordering::Relaxed) {
            return Err(ended());
        }
        session.set_mode(Mode::Palpate { rate_mm_s: rate_mm_s as f32, depth_mm: depth_mm as f32 })?;
        let longest_s = BESIDE_S + 4.0 * depth_mm / rate_mm_s;
        let Told { verdict, estimate, samples, why } = one(session, (at + 1, longest_s), stopped)?;
        let aborted = verdict.outcome == Outcome::Aborted;
        told(&Pressed { number: at + 1, stop: *stop, of_stop: counts[*stop], verdict, estimate, samples })?;
        if aborted {
            surroundings.mend(session, &why)?;
        }
    }
    Ok(())
}

/// A verdict with what came before it.
struct Told {
    verdict: Verdict,
    estimate: Option<Estimate>,
    samples: Vec<(f64, f64)>,
    /// Faults and gaps.
    why: Vec<String>,
}

/// How long a word of the board is waited for before signals are looked at, s.
const TURN_S: f64 = 0.1;

fn one<L: Link>(
    session: &mut Session<L>,
    (number, longest_s): (usize, f64),
    stopped: &AtomicBool,
) -> Result<Told, TourError> {
    let until_s = session.link().now_s() + longest_s;
    let (mut samples, mut estimate, mut why) = (Vec::new(), None, Vec::new());
    while session.link().now_s() < until_s {
        if stopped.load(Ordering::Relaxed) {
            session.set_mode(Mode::Idle)?;
            return Err(TourError::Ended { number });
        }
        let turn_s = session.link().now_s() + TURN_S;
        let Some(event) = session.poll(turn_s.min(until_s))? else { continue };
        match event {
            Event::Telemetry(record) if record.state == State::Contact => {
                samples.push((f64::from(record.depth_mm), f64::from(record.load_cell_n)));
            }
            Event::Estimate(told) => estimate = Some(told),
            Event::Verdict(verdict) => {
                let estimate = estimate.filter(|e: &Estimate| e.palpation == verdict.palpation);
                return Ok(Told { verdict, estimate, samples, why });
            }
            Event::Fault(fault) => why.push(fault_text(&fault)),
            Event::Gap(gap) => why.push(gap_text(&gap)),
            _ => {}
        }
    }
    session.set_mode(Mode::Idle)?;
    Err(TourError::Endless { number, waited_s: longest_s })
}
