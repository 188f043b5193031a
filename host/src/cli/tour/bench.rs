//! Who brings the specimens under the probe: the simulation, or somebody at a real board.

use std::sync::atomic::AtomicBool;

use miette::{IntoDiagnostic, miette};
use protocol::lut::Table;

use super::arguments::Arguments;
use crate::cli::answer::entered;
use crate::link::{Address, InProcess, Link, Pace};
use crate::plant::Jitter;
use crate::session::{Patience, Session, SessionError};
use crate::simulated_board::SimulatedBoard;
use crate::tour::{Pressed, Specimens, Stop, Surroundings, Tour, TourError, walk};

/// A board that has the table of the tour.
pub(super) enum Bench {
    /// The simulated one.
    Simulated(Box<Session<InProcess>>),
    /// One with somebody beside it.
    Real(Box<Session<Box<dyn Link>>>),
}

impl Bench {
    /// Opens the board that is asked for. The simulated one is sent the table; a real one must have it.
    ///
    /// # Errors
    /// A board that cannot be reached, refuses, or has another table.
    pub fn open(arguments: &Arguments, table: &Table<'_>, bytes: &[u8]) -> miette::Result<Self> {
        if arguments.board == Address::Simulated {
            let jitter = Jitter { force: arguments.noise, ..Jitter::default() };
            let link = InProcess::new(SimulatedBoard::new(arguments.seed, jitter), Pace::Free);
            let (mut session, _) = Session::open(link, Patience::default()).into_diagnostic()?;
            session.upload(bytes, |_| {}).into_diagnostic()?;
            session.tare_at_rest().into_diagnostic()?;
            return Ok(Self::Simulated(Box::new(session)));
        }
        let link = crate::link::open(&arguments.board).into_diagnostic()?;
        let (mut session, _) = Session::open(link, Patience::default()).into_diagnostic()?;
        if !session.has_table(&table.hash()).into_diagnostic()? {
            return Err(miette!(
                help = "write the table with `palpate lut --demo`, or name the board's own by --table",
                "the board has another table than that of the tour"
            ));
        }
        Ok(Self::Real(Box::new(session)))
    }

    /// Presses the stops in an order at a rate (mm/s) to a depth (mm); `told` hears of every press.
    ///
    /// # Errors
    /// [`TourError`]; presses that were made have been told.
    pub fn walk(
        &mut self,
        (tour, specimens): (&Tour, &Specimens),
        order: &[usize],
        way: (f64, f64),
        stop: &AtomicBool,
        told: &mut dyn FnMut(&Pressed) -> Result<(), TourError>,
    ) -> Result<(), TourError> {
        match self {
            Self::Simulated(session) => {
                walk(&mut **session, (tour, order), way, (&mut Simulated { tour, specimens }, stop), told)
            }
            Self::Real(session) => walk(&mut **session, (tour, order), way, (&mut Operator, stop), told),
        }
    }
}

/// The bench of the simulation.
struct Simulated<'a> {
    tour: &'a Tour,
    specimens: &'a Specimens,
}

impl Surroundings<InProcess> for Simulated<'_> {
    fn bring(
        &mut self,
        session: &mut Session<InProcess>,
        (at, stop): (usize, &Stop),
        of_stop: usize,
    ) -> Result<(), TourError> {
        let foam = self.specimens.foam(self.tour, at, of_stop);
        let foam = foam.ok_or_else(|| TourError::Forceless { stop: stop.name.clone() })?;
        session.link_mut().board_mut().place(foam);
        Ok(())
    }

    fn mend(&mut self, session: &mut Session<InProcess>, _: &[String]) -> Result<(), TourError> {
        Ok(session.clear_faults()?)
    }
}

/// Somebody who moves probe or cart.
struct Operator;

impl<L: Link> Surroundings<L> for Operator {
    fn bring(&mut self, _: &mut Session<L>, (_, stop): (usize, &Stop), of_stop: usize) -> Result<(), TourError> {
        let [x, y, z] = stop.at_mm;
        errln!("{} (its press {of_stop}): move the probe above ({x}, {y}, {z}) mm, then Enter; q ends", stop.name);
        goes_on()
    }

    /// A fault is cleared by whoever has seen to its cause.
    fn mend(&mut self, session: &mut Session<L>, why: &[String]) -> Result<(), TourError> {
        loop {
            errln!("aborted: {}; see to it, then Enter clears the fault; q ends", why.join("; "));
            goes_on()?;
            match session.clear_faults() {
                Ok(()) => return Ok(()),
                Err(error @ SessionError::Refused { .. }) => errln!("{error}"),
                Err(error) => return Err(error.into()),
            }
        }
    }
}

/// Goes on at Enter; `walk` says before which press it ended.
fn goes_on() -> Result<(), TourError> {
    if entered() { Ok(()) } else { Err(TourError::Ended { number: 0 }) }
}
