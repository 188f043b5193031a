//! What a person sees while a board is listened to.

mod curve;
mod plain;
mod screen;

use std::io::IsTerminal;

use protocol::lut::Table;
use protocol::message::{Estimate, Outcome, Recognition, Verdict};

pub use curve::CurveNews;
pub use plain::Plain;
pub use screen::Screen;

use crate::session::{Event, Traffic};

/// A view of a running conversation, on standard error.
pub trait LiveView {
    /// Shows something the board said.
    fn event(&mut self, event: &Event, traffic: &Traffic);

    /// Shows a remark.
    fn note(&mut self, text: &str);

    /// Redraws if it is time to; true when the person wants to stop.
    fn refresh(&mut self) -> bool;
}

/// A [`Screen`] on a terminal, [`Plain`] lines elsewhere.
pub fn live_view(board: &str, library: Vec<String>) -> Box<dyn LiveView> {
    if std::io::stderr().is_terminal()
        && let Ok(screen) = Screen::open(board, library.clone())
    {
        return Box::new(screen);
    }
    Box::new(Plain::new(library))
}

/// Names of the materials of a table.
pub fn library_names(table: &Table<'_>) -> Vec<String> {
    table.materials().map(|m| m.name.to_owned()).collect()
}

/// An estimate in one line, with one standard error of each.
pub fn estimate_text(e: &Estimate) -> String {
    format!(
        "palpation {}: estimate mu {:.4} +- {:.4} MPa, alpha {:.2} +- {:.2}, height {:.3} +- {:.3} mm",
        e.palpation, e.mu_mpa, e.mu_error_mpa, e.alpha, e.alpha_error, e.height_mm, e.height_error_mm
    )
}

/// A verdict in one line; the library gives names to indices.
pub fn verdict_text(verdict: &Verdict, library: &[String]) -> String {
    let head = format!("palpation {}", verdict.palpation);
    match verdict.outcome {
        Outcome::Identified | Outcome::GridEdge => {
            let material = match library.get(usize::from(verdict.material.index)) {
                Some(name) => name.clone(),
                None if verdict.material.index == Recognition::NONE => "not in the library".into(),
                None => format!("material {}", verdict.material.index),
            };
            let parameters = if verdict.outcome == Outcome::GridEdge {
                "outside the table's grid or on its edge, no parameters".into()
            } else {
                format!("mu {:.4} MPa, alpha {:.2}", verdict.mu_mpa, verdict.alpha)
            };
            format!(
                "{head}: {material}, {parameters}, margin {:.2}, {} samples, height {:.2} mm",
                verdict.material.margin, verdict.samples, verdict.height_mm,
            )
        }
        Outcome::NoContact => format!("{head}: no contact before the end of the travel"),
        Outcome::TooShort => format!("{head}: too few samples ({})", verdict.samples),
        Outcome::NoSuchHeight => {
            format!("{head}: no slice of the table is near the specimen's height of {:.2} mm", verdict.height_mm)
        }
        Outcome::Aborted => format!("{head}: stopped"),
        Outcome::NoSuchRate => {
            format!("{head}: no slice of the table is near the rate of {:.2} mm/s", verdict.rate_mm_s)
        }
        Outcome::DeeperThanTable => format!("{head}: the ball went deeper than the table reaches"),
        Outcome::BadReadings => format!("{head}: more than a tenth of the readings were no numbers"),
        Outcome::Saturated => format!("{head}: the load cell reached its end and read no further"),
    }
}
