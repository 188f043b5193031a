//! Who shows a material, and who answers.

use std::io::BufRead;
use std::path::Path;
use std::sync::mpsc::{Receiver, RecvTimeoutError, TryRecvError, channel};
use std::time::Duration;

use miette::{IntoDiagnostic, WrapErr, miette};
use protocol::lut::Table;
use protocol::message::Mode;

use crate::cli::progress::Progress;
use crate::demo::{Stage, demo_table};
use crate::link::{Address, Link};
use crate::log::library_names;
use crate::session::{Event, Patience, Session, fault_text, gap_text};

/// Longest wait for a word of the board before the keys are looked at, s.
const TURN_S: f64 = 0.05;

/// Lines from the keyboard, or from whatever standard input is.
pub(super) struct Keys(Receiver<String>);

impl Keys {
    /// Begins to read.
    pub(super) fn new() -> Self {
        let (send, receive) = channel();
        std::thread::spawn(move || {
            for line in std::io::stdin().lock().lines() {
                let Ok(line) = line else { return };
                if send.send(line).is_err() {
                    return;
                }
            }
        });
        Self(receive)
    }

    /// The next line if one is there; `Err` at the end of the input.
    fn now(&self) -> Result<Option<String>, ()> {
        match self.0.try_recv() {
            Ok(line) => Ok(Some(line)),
            Err(TryRecvError::Empty) => Ok(None),
            Err(TryRecvError::Disconnected) => Err(()),
        }
    }

    /// The next line within a turn; `Err` at the end of the input.
    fn soon(&self) -> Result<Option<String>, ()> {
        match self.0.recv_timeout(Duration::from_secs_f64(TURN_S)) {
            Ok(line) => Ok(Some(line)),
            Err(RecvTimeoutError::Timeout) => Ok(None),
            Err(RecvTimeoutError::Disconnected) => Err(()),
        }
    }
}

/// What shows the materials.
pub(super) enum Presenter {
    /// Nothing: a dry run, or an experimenter who lays them down.
    Nobody,
    /// A board, with the library entries of the materials.
    Board(Box<Session<Box<dyn Link>>>, Vec<u8>),
}

impl Presenter {
    /// A board whose library has the materials.
    pub(super) fn open(
        address: &Address,
        table: Option<&Path>,
        materials: &[(String, Option<u8>)],
    ) -> miette::Result<Self> {
        let read = |path: &Path| std::fs::read(path).into_diagnostic().wrap_err_with(|| path.display().to_string());
        let mut bytes = table.map(read).transpose()?;
        if bytes.is_none() && *address == Address::Simulated {
            let progress = Progress::new();
            let made = demo_table(&|stage: Stage<'_>| {
                if let Stage::Solving { what, done, total } = stage {
                    progress.set(what, done, total);
                }
            });
            progress.end();
            bytes = Some(made?);
        }
        let names = match &bytes {
            Some(bytes) => library_names(&Table::parse(bytes).into_diagnostic()?),
            None => Vec::new(),
        };
        let entries = entries(materials, &names)?;
        let link = crate::link::open(address).into_diagnostic()?;
        let (mut session, _) = Session::open(link, Patience::default()).into_diagnostic()?;
        if let Some(bytes) = bytes.as_ref().filter(|_| *address == Address::Simulated) {
            session.upload(bytes, |_| {}).into_diagnostic()?;
        }
        Ok(Self::Board(Box::new(session), entries))
    }

    /// Shows a material.
    pub(super) fn show(&mut self, material: usize) -> miette::Result<()> {
        let Self::Board(session, entries) = self else { return Ok(()) };
        session.set_mode(Mode::Display { material: entries[material] }).into_diagnostic()
    }

    /// Shows nothing.
    pub(super) fn hide(&mut self) -> miette::Result<()> {
        let Self::Board(session, _) = self else { return Ok(()) };
        session.set_mode(Mode::Idle).into_diagnostic()
    }

    /// Waits a turn, keeps the board showing, and returns a line if one came; `None` at the end of the input.
    pub(super) fn turn(&mut self, keys: &Keys) -> miette::Result<Option<Option<String>>> {
        let Self::Board(session, _) = self else { return Ok(keys.soon().ok()) };
        let until_s = session.link().now_s() + TURN_S;
        match session.poll(until_s).into_diagnostic()? {
            Some(Event::Fault(fault)) => Err(miette!("{}; outputs are off", fault_text(&fault))),
            Some(Event::Gap(gap)) => Err(miette!("outputs are off: {}", gap_text(&gap))),
            _ => Ok(keys.now().ok()),
        }
    }
}

impl Drop for Presenter {
    /// A board that is left shows nothing.
    fn drop(&mut self) {
        if let Self::Board(session, _) = self {
            let _ = session.set_mode(Mode::Idle);
        }
    }
}

/// Library entries of the materials: as given, or by the names of the library.
fn entries(materials: &[(String, Option<u8>)], names: &[String]) -> miette::Result<Vec<u8>> {
    let entry = |(name, given): &(String, Option<u8>)| {
        let known =
            names.iter().position(|known| known.eq_ignore_ascii_case(name)).and_then(|at| u8::try_from(at).ok());
        given.or(known).ok_or_else(|| {
            let library = if names.is_empty() {
                "is not known: --table FILE tells its names".to_owned()
            } else {
                format!("has {}", names.join(", "))
            };
            miette!("--materials {name}: the board's library {library}; expected one of its names, or {name}=ENTRY")
        })
    };
    materials.iter().map(entry).collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn entries_are_numbers_or_names_of_the_library() {
        let names = ["EVA", "B1", "ICF"].map(str::to_owned);
        let asked = |name: &str, entry| [(name.to_owned(), entry)];
        assert_eq!(entries(&asked("icf", None), &names).unwrap(), [2]);
        assert_eq!(entries(&asked("mine", Some(7)), &names).unwrap(), [7]);
        let error = entries(&asked("A2", None), &names).unwrap_err().to_string();
        assert_eq!(
            error,
            "--materials A2: the board's library has EVA, B1, ICF; expected one of its names, or A2=ENTRY"
        );
        assert!(entries(&asked("A2", None), &[]).unwrap_err().to_string().contains("--table FILE"));
    }
}
