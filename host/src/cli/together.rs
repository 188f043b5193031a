//! `palpate board mode together`: palpation and display in the same ticks (thesis Figs. 59 and 62).

use std::sync::atomic::AtomicBool;

use clap::{Args, ValueEnum};
use protocol::message::{DisplayMode, Estimate, Halves, PalpationMode, Parts, Rule, State, Verdict};
use serde_json::json;

use super::answer::Answer;
use super::mode::{Outputs, Pressed, Unfinished, positive, positive_mm, pressed_text};
use crate::link::Link;
use crate::log::CurveNews;
use crate::session::{Event, Session};

/// What is pressed, and what is displayed meanwhile.
#[derive(Debug, Clone, PartialEq, Args)]
pub struct Together {
    /// Rate of the probe, mm/s
    #[arg(long, default_value_t = 2.0)]
    pub rate: f32,
    /// Depth after contact, mm
    #[arg(long, default_value_t = 4.0)]
    pub depth: f32,
    /// Height of the specimen's surface above the base plate, mm: a press without contact ends a millimetre below it
    #[arg(long, value_name = "MM", value_parser = positive_mm)]
    pub surface: Option<f32>,
    /// What is displayed: "between" (the place of the identified mu and alpha between library materials), "nearest" (the library
    /// material that is named), or the number of a library material, from 0
    #[arg(long, default_value = "between", value_name = "WHAT", value_parser = show)]
    pub show: Show,
    /// With which parts of the display
    #[arg(long, value_enum, default_value_t = With::Both)]
    pub with: With,
    /// Number of presses, one after another
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
    pub presses: u32,
    /// Longest time for one press, s; then outputs go off
    #[arg(long, default_value_t = 180.0, value_name = "S", value_parser = positive)]
    pub timeout: f64,
    /// End so many seconds after the last verdict; without, Ctrl-C does
    #[arg(long, value_name = "S", value_parser = positive)]
    pub seconds: Option<f64>,
}

/// What is displayed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Show {
    /// What is identified.
    Identified(Following),
    /// A material of the library.
    Material(u8),
}

/// How what is identified gives a curve.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Following {
    /// The library material that is named.
    Nearest,
    /// The place of mu and alpha between library materials.
    Between,
}

/// Parts of the display.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum With {
    /// Actuator and coil, or the one of both that is fitted
    Both,
    /// Coil only
    Coil,
    /// Actuator only
    Actuator,
    /// Coil only, by the finger's place, which the display's potentiometer reads
    CoilAtPlace,
}

fn show(text: &str) -> Result<Show, String> {
    match text {
        "between" => Ok(Show::Identified(Following::Between)),
        "nearest" => Ok(Show::Identified(Following::Nearest)),
        number => number
            .parse()
            .map(Show::Material)
            .map_err(|_| format!("{number} is neither between nor nearest, nor the number of a material, 0 to 255")),
    }
}

impl Together {
    fn display(&self) -> DisplayMode {
        let parts = match self.with {
            With::Both => Parts::Both,
            With::Coil => Parts::Coil,
            With::Actuator => Parts::Actuator,
            With::CoilAtPlace => Parts::CoilAtPlace,
        };
        match self.show {
            Show::Material(material) => DisplayMode::Material { parts, material },
            Show::Identified(Following::Nearest) => DisplayMode::Follow { parts, by: Rule::Nearest },
            Show::Identified(Following::Between) => DisplayMode::Follow { parts, by: Rule::Between },
        }
    }

    fn press(&self) -> PalpationMode {
        PalpationMode::Press { rate_mm_s: self.rate, depth_mm: self.depth, surface_mm: self.surface }
    }
}

/// What was heard.
#[derive(Default)]
struct Heard {
    pressed: Vec<Pressed>,
    estimate: Option<Estimate>,
    halves: Option<Halves>,
    curves: Vec<String>,
    news: CurveNews,
    /// Ticks in which the display was on, and of these those in which the arm pressed.
    displayed: usize,
    both: usize,
}

impl Heard {
    /// True at the end of the press whose verdict is the last one: the arm is home.
    fn take(&mut self, event: Event) -> bool {
        match event {
            Event::Estimate(estimate) => self.estimate = Some(estimate),
            Event::Verdict(verdict) => self.verdict(verdict),
            Event::Halves(halves) => {
                let on = halves.display == protocol::message::DisplayState::On;
                self.displayed += usize::from(on);
                self.both += usize::from(on && matches!(halves.palpation, State::Approach | State::Contact));
                if let Some(text) = self.news.of(&halves, &[]) {
                    errln!("{text}");
                    self.curves.push(text);
                }
                self.halves = Some(halves);
            }
            Event::Telemetry(record) => return matches!(record.state, State::Idle | State::Display),
            Event::Fault(_) | Event::Gap(_) => {}
        }
        false
    }

    fn verdict(&mut self, verdict: Verdict) {
        let estimate = self.estimate.take().filter(|estimate| estimate.palpation == verdict.palpation);
        let pressed = Pressed { verdict, estimate };
        errln!("{}", pressed_text(&pressed, &[]));
        self.pressed.push(pressed);
    }
}

/// Presses as often as wanted with the display on, and displays on until told to stop.
///
/// # Errors
/// A board that refuses, is lost, faults or does not end a press in time.
pub(super) fn run<L: Link>(
    session: &mut Session<L>,
    choice: &Together,
    stop: &AtomicBool,
) -> Result<Answer, Unfinished> {
    session.set_display(choice.display()).map_err(Unfinished::Refused)?;
    let mut outputs = Outputs::of(session);
    let mut heard = Heard::default();
    errln!("Ctrl-C switches the outputs off");
    for number in 1..=choice.presses {
        outputs.session().set_palpation(choice.press()).map_err(Unfinished::Refused)?;
        let until_s = outputs.session().link().now_s() + choice.timeout;
        loop {
            let Some(event) = outputs.next(until_s, stop)? else {
                return Err(outputs.unfinished(choice.timeout, stop));
            };
            if heard.take(event) && heard.pressed.len() == number as usize {
                break;
            }
        }
    }
    let until_s = outputs.session().link().now_s() + choice.seconds.unwrap_or(f64::INFINITY);
    while let Some(event) = outputs.next(until_s, stop)? {
        heard.take(event);
    }
    drop(outputs);
    let palpations: Vec<_> =
        heard.pressed.iter().map(|p| json!({ "verdict": p.verdict, "estimate": p.estimate })).collect();
    let value = json!({
        "display": choice.display(), "palpations": palpations, "halves": heard.halves,
        "ticks": { "displayed": heard.displayed, "both": heard.both },
    });
    let mut lines: Vec<String> = heard.pressed.iter().map(|pressed| pressed_text(pressed, &[])).collect();
    lines.extend(heard.curves);
    lines.push(format!(
        "display on for {} ticks, {} of them while the arm pressed; outputs off",
        heard.displayed, heard.both
    ));
    Ok((value, lines.join("\n")))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use protocol::message::Outcome;

    use super::*;
    use crate::link::{InProcess, Pace};
    use crate::plant::{Jitter, Touch};
    use crate::session::Patience;
    use crate::simulated_board::{SimulatedBoard, foam, press_table};

    fn choice(show: Show) -> Together {
        Together {
            rate: 4.0,
            depth: 4.0,
            surface: None,
            show,
            with: With::Both,
            presses: 2,
            timeout: 60.0,
            seconds: Some(2.0),
        }
    }

    fn session() -> Session<InProcess> {
        let mut board = SimulatedBoard::new(1, Jitter::NONE);
        board.place(foam());
        board.touch(Some(Touch { peak_n: 2.0, period_s: 3.0 }));
        let (mut session, _) = Session::open(InProcess::new(board, Pace::Free), Patience::default()).unwrap();
        session.upload(&press_table().to_bytes().unwrap(), |_| {}).unwrap();
        session
    }

    /// The second press goes on under the display of what the first one found.
    #[test]
    fn what_the_first_press_finds_is_displayed_during_the_second() {
        let mut session = session();
        let (value, text) =
            run(&mut session, &choice(Show::Identified(Following::Nearest)), &AtomicBool::new(false)).unwrap();
        assert_eq!(value["palpations"].as_array().unwrap().len(), 2);
        assert_eq!(value["palpations"][0]["verdict"]["outcome"], json!(Outcome::Identified));
        assert_eq!(value["halves"]["of_palpation"], 2);
        assert!(value["ticks"]["both"].as_u64().unwrap() > 50, "{value}");
        assert!(text.contains("displaying material 0 for palpation 1"), "{text}");
        let status = session.status().unwrap();
        assert_eq!((status.state, status.faults.is_empty()), (State::Idle, true));
    }

    #[test]
    fn a_material_that_is_asked_for_is_displayed_from_the_beginning() {
        let mut session = session();
        let (value, text) = run(&mut session, &choice(Show::Material(0)), &AtomicBool::new(false)).unwrap();
        assert_eq!(value["halves"]["of_palpation"], 0);
        assert!(text.contains("\ndisplaying material 0\n"), "{text}");
        let error = run(&mut session, &choice(Show::Material(9)), &AtomicBool::new(false)).unwrap_err().to_string();
        assert_eq!(error, "the simulated board refused SetDisplay: a value is outside the board's own limits");
    }

    #[test]
    fn what_is_to_be_shown_is_a_word_or_a_number() {
        assert_eq!(show("between"), Ok(Show::Identified(Following::Between)));
        assert_eq!(show("3"), Ok(Show::Material(3)));
        assert_eq!(show("x").unwrap_err(), "x is neither between nor nearest, nor the number of a material, 0 to 255");
    }
}
