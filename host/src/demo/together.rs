//! Palpate here, feel there: foams are pressed one after another while a finger feels what the board makes of them
//! (thesis Figs. 59 and 62).

use protocol::lut::Table;
use protocol::message::{DisplayMode, Halves, PalpationMode, Parts, Rule, Telemetry};

use super::listening::Listening;
use super::palpation::LONGEST_S;
use super::{DemoError, Options};
use crate::plant::{Foam, Touch, Truth};
use crate::session::Event;

/// What the hand does meanwhile: a light touch, again and again.
const TOUCH: Touch = Touch { peak_n: 1.0, period_s: 2.0 };

/// How long the finger goes on after a verdict, s: the display goes over to another curve in one.
const AFTER_S: f64 = 3.0;

/// One control tick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tick {
    /// Time since the display began, s.
    pub time_s: f64,
    /// True force of the probe on the foam, N.
    pub probe_n: f64,
    /// True force of the finger on the display, N.
    pub finger_n: f64,
    /// True shaft, mm.
    pub shaft_mm: f64,
    /// Where the board wants the shaft, mm.
    pub target_mm: f64,
}

/// What was displayed of a foam that was pressed.
#[derive(Debug, Clone, PartialEq)]
pub struct ShownFoam {
    /// The foam under the probe.
    pub truth: String,
    /// Material of the library whose curve the display shows after the verdict; empty for none.
    pub shown: String,
    /// When the verdict came, s.
    pub verdict_s: f64,
}

/// Both halves in the same ticks.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Together {
    /// The foams in the order in which they were pressed.
    pub foams: Vec<ShownFoam>,
    /// Tick by tick.
    pub ticks: Vec<Tick>,
}

impl Together {
    /// How many of the foams were shown as themselves.
    pub fn right(&self) -> usize {
        self.foams.iter().filter(|foam| foam.truth == foam.shown).count()
    }

    /// What was shown, in a sentence.
    pub(super) fn sentence(&self) -> String {
        let each = self.foams.iter().map(|foam| {
            let shown = if foam.shown.is_empty() { "nothing" } else { &foam.shown };
            if foam.truth == foam.shown { shown.to_owned() } else { format!("{shown} for {}", foam.truth) }
        });
        format!(
            "{} of {} foams felt under the finger as they were pressed: {}",
            self.right(),
            self.foams.len(),
            each.collect::<Vec<_>>().join(", ")
        )
    }
}

/// Presses every foam once, with a finger on the display that follows the verdicts.
pub(super) fn together(
    listening: &mut Listening,
    foams: &[Foam],
    table: &Table<'_>,
    options: &Options,
) -> Result<Together, DemoError> {
    let mut together = Together::default();
    let began_s = listening.now_s();
    listening.session().set_display(DisplayMode::Follow { parts: Parts::Both, by: Rule::Nearest })?;
    listening.board().touch(Some(TOUCH));
    for foam in foams {
        listening.board().place(foam.clone());
        let press = PalpationMode::Press {
            rate_mm_s: options.rate_mm_s as f32,
            depth_mm: options.depth_mm as f32,
            surface_mm: None,
        };
        listening.session().set_palpation(press)?;
        let deadline_s = listening.now_s() + LONGEST_S;
        let ended = until(listening, deadline_s, began_s, &mut together.ticks, true)?;
        let verdict_s = listening.now_s() - began_s;
        if ended {
            until(listening, began_s + verdict_s + AFTER_S, began_s, &mut together.ticks, false)?;
        }
        let halves = listening.session().halves()?;
        together.foams.push(ShownFoam { truth: foam.name.clone(), shown: name(&halves, table), verdict_s });
    }
    listening.board().touch(None);
    listening.session().set_display(DisplayMode::Idle)?;
    listening.session().set_palpation(PalpationMode::Idle)?;
    Ok(together)
}

/// Listens until a verdict, if that is awaited, or the deadline; true if a verdict came.
fn until(
    listening: &mut Listening,
    deadline_s: f64,
    began_s: f64,
    ticks: &mut Vec<Tick>,
    awaited: bool,
) -> Result<bool, DemoError> {
    while let Some((event, truth)) = listening.next(deadline_s)? {
        match (event, truth) {
            (Event::Verdict(_), _) if awaited => return Ok(true),
            (Event::Telemetry(record), Some(truth)) => ticks.push(tick(&record, &truth, began_s)),
            _ => {}
        }
    }
    Ok(false)
}

fn tick(record: &Telemetry, truth: &Truth, began_s: f64) -> Tick {
    Tick {
        time_s: truth.time_s - began_s,
        probe_n: truth.force_n,
        finger_n: truth.finger_n,
        shaft_mm: truth.shaft_mm,
        target_mm: f64::from(record.shaft_target_mm),
    }
}

/// Name of the library's material whose curve is shown.
fn name(halves: &Halves, table: &Table<'_>) -> String {
    table.material(usize::from(halves.curve.low)).map_or_else(String::new, |material| material.name.to_owned())
}
