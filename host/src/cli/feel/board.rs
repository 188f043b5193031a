//! `palpate feel --board`: your own finger on a real display.

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use miette::{Context, IntoDiagnostic, miette};
use protocol::lut::Table;

use super::arguments::{Arguments, DisplayWord};
use super::materials;
use super::plant::Plant;
use crate::cli::answer::entered;
use crate::cli::tune;
use crate::control::ControlCurve;
use crate::feel::{Display, Felt, OnBoard, Pace, Unfelt, on_board};
use crate::log::library_names;
use crate::session::{Patience, Session};
use crate::signals;
use crate::tune::setting::Setting;

/// Asks for every press, and records it.
///
/// # Errors
/// An option that belongs to the simulation, a board with another table, one that refuses, a finger that does not press.
pub(super) fn felt(arguments: &Arguments) -> miette::Result<Vec<Felt>> {
    let display = match arguments.display {
        DisplayWord::All | DisplayWord::Actuator => Display::Actuator,
        DisplayWord::FluidAtPlace => Display::FluidAtPlace,
        DisplayWord::Fluid => {
            return Err(miette!(
                help = "--display fluid-at-place reads the finger's place, --display actuator the shaft's",
                "a fluid by force is scored by the finger's travel, which a board does not read"
            ));
        }
    };
    if let Some(option) = is_asked(arguments) {
        return Err(miette!(
            "{option} belongs to the simulation: a real board has its own; expected none beside --board"
        ));
    }
    let stop = Arc::new(AtomicBool::new(false));
    signals::stop_on_signals(&stop).into_diagnostic()?;
    let path = arguments.table.as_deref().ok_or_else(|| {
        miette!("--board needs --table: the names of the materials are in the board's table, FILE of `palpate lut`")
    })?;
    let bytes = read(path)?;
    let table = Table::parse(&bytes).into_diagnostic().wrap_err_with(|| path.display().to_string())?;
    let set = arguments.setting()?;
    let wanted = on_table(&table, materials::found(&arguments.materials)?)?;
    let link = crate::link::open(&arguments.board).into_diagnostic()?;
    let (mut session, _) = Session::open(link, Patience::default()).into_diagnostic()?;
    if !session.has_table(&table.hash()).into_diagnostic()? {
        return Err(miette!("the board has another table than {}", path.display()));
    }
    match set {
        (Some(gains), Some(actuator)) => {
            errln!("the board is set: {}", tune::set(&mut session, Setting { gains, actuator })?);
        }
        (Some(gains), None) => session.set_gains(gains).into_diagnostic()?,
        (None, _) => {}
    }
    let (felt, ended) = on_board(&mut session, (&wanted, display), &stop, &mut ready);
    match ended {
        Some(error) if felt.is_empty() => Err(error).into_diagnostic(),
        Some(error) => {
            errln!("{error}");
            Ok(felt)
        }
        None => Ok(felt),
    }
}

/// Options of the simulation, with what they have without being asked for.
fn is_asked(arguments: &Arguments) -> Option<&'static str> {
    let asked = [
        ("--plant", arguments.plant != Plant::Frozen),
        ("--magnet", arguments.magnet != "ring"),
        ("--model", arguments.model.is_some()),
        ("--seed", arguments.seed != 1),
    ];
    asked.into_iter().find(|(_, is)| *is).map(|(name, _)| name)
}

fn read(path: &Path) -> miette::Result<Vec<u8>> {
    std::fs::read(path).into_diagnostic().wrap_err_with(|| path.display().to_string())
}

/// The curves that the table displays, with their numbers there; all that are asked for must be among them.
fn on_table(table: &Table<'_>, curves: Vec<ControlCurve>) -> miette::Result<Vec<OnBoard>> {
    let names = library_names(table);
    let number = |curve: &ControlCurve| names.iter().position(|name| name.eq_ignore_ascii_case(&curve.material));
    let each = curves.into_iter().map(|curve| {
        let at = number(&curve).and_then(|at| u8::try_from(at).ok());
        let index = at.ok_or_else(|| miette!("the table has no {}; it has {}", curve.material, names.join(", ")))?;
        Ok(OnBoard { index, curve })
    });
    each.collect()
}

/// Waits for Enter.
fn ready(curve: &ControlCurve, pace: Pace) -> Result<(), Unfelt> {
    errln!(
        "{}, {}: down in about {} s to {:.1} N and up again. Enter, then press; q ends",
        curve.material,
        pace.name(),
        pace.way_s(),
        0.9 * curve.most_n()
    );
    if entered() { Ok(()) } else { Err(Unfelt::Ended) }
}
