//! The supervisor of the board's two halves, palpation and display, and the states of each.
//!
//! | half | states |
//! |---|---|
//! | [palpation](Palpating) | rest -> approach -> contact -> retract -> rest |
//! | [display](Displaying) | rest, waiting for a verdict, on |
//!
//! It decides which outputs may be on; nothing else does: the arm in approach and contact, actuator and coil
//! while the display is on and asks for them. Neither half looks at the other, but for a display that follows
//! verdicts. A latched fault, whatever its cause, ends both (`docs/decisions/0021-one-tick.md`).

mod displaying;
mod palpating;

pub use displaying::Displaying;
pub use palpating::{Palpating, Press, Stage};

use crate::interlock::Power;
use crate::showing::Origin;
use protocol::message::{Curve, DisplayMode, DisplayState, Mode, Outcome, Parts, Refusal, State};

/// Limits of motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ModeConfig {
    /// Slowest and fastest palpation, mm/s.
    pub rate_mm_s: (f32, f32),
    /// Shallowest palpation, mm.
    pub depth_min_mm: f32,
    /// The probe never goes below this height above the base plate, mm.
    pub travel_min_mm: f32,
    /// How far below the expected surface a press without contact ends, mm: the reach of the table's heights.
    pub blind_mm: f32,
    /// How far below the lowest surface that the table serves a press ends without contact, mm.
    pub below_table_mm: f32,
    /// Highest place of the probe above the base plate, mm.
    pub travel_max_mm: f32,
    /// Force that ends a palpation, N; below the fault limit of the load cell.
    pub force_end_n: f32,
    /// The probe has returned when it is this far above the specimen (without contact: above its lowest point), mm.
    pub clearance_mm: f32,
    /// It has returned, too, when it is so far below the place where its approach began, mm: a press that is stopped there
    /// cannot rise by the clearance.
    pub home_mm: f32,
    /// Longest approach, ticks.
    pub approach_ticks: u32,
    /// Longest contact, ticks.
    pub contact_ticks: u32,
    /// Longest return, ticks.
    pub retract_ticks: u32,
}

impl Default for ModeConfig {
    fn default() -> Self {
        ModeConfig {
            rate_mm_s: (1.0, 4.0),
            depth_min_mm: 0.5,
            travel_min_mm: 1.0,
            travel_max_mm: 90.0,
            blind_mm: 1.0,
            below_table_mm: 2.0,
            force_end_n: 7.5,
            clearance_mm: 1.0,
            // Four codes of the converter.
            home_mm: 0.1,
            // 90 mm of travel at 1 mm/s and 50 Hz; 8 mm likewise; 90 mm at 4 mm/s and some.
            approach_ticks: 4_500,
            contact_ticks: 400,
            retract_ticks: 1_500,
        }
    }
}

/// What the palpation half looks at in one tick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ModeInput {
    /// Height of the probe, mm.
    pub probe_mm: f32,
    /// Depth after contact, mm; negative above the surface.
    pub depth_mm: f32,
    /// Force on the probe, N.
    pub force_n: f32,
    /// Contact was found in this tick or earlier.
    pub contact: bool,
    /// Contact was found, but no slice of the table serves specimen or rate: how the palpation ends.
    pub no_slice: Option<Outcome>,
    /// Without contact the probe does not go below this height, mm.
    pub floor_mm: f32,
    /// No more samples can be taken.
    pub record_full: bool,
    /// The analysis of the record has ended.
    pub analysed: bool,
    /// A fault is latched.
    pub faulted: bool,
}

/// What follows from the state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ModeEvent {
    /// Nothing to report.
    None,
    /// A palpation has ended so: send its verdict.
    Ended(Outcome),
}

/// Both halves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Modes {
    /// Palpation.
    pub palpating: Palpating,
    /// Display.
    pub displaying: Displaying,
    faulted: bool,
    by_halves: bool,
}

impl Default for Modes {
    fn default() -> Self {
        Self::new()
    }
}

impl Modes {
    /// Both at rest.
    pub const fn new() -> Self {
        Modes { palpating: Palpating::new(), displaying: Displaying::new(), faulted: false, by_halves: false }
    }

    /// Both in one word: palpation while it does anything, else display.
    pub const fn state(&self) -> State {
        match self.palpation_state() {
            State::Idle if !matches!(self.displaying.state(), DisplayState::Idle) => State::Display,
            state => state,
        }
    }

    /// What the palpation half is doing.
    pub const fn palpation_state(&self) -> State {
        match self.palpating.stage {
            _ if self.faulted => State::Fault,
            Stage::Rest => State::Idle,
            Stage::Approach => State::Approach,
            Stage::Contact => State::Contact,
            Stage::Retract => State::Retract,
        }
    }

    /// What the display half is doing.
    pub const fn display_state(&self) -> DisplayState {
        if self.faulted { DisplayState::Fault } else { self.displaying.state() }
    }

    /// What is asked for in one word: palpation if there is a press, else display, with the first of the
    /// library's entries that it shows.
    pub const fn commanded(&self) -> Mode {
        match (self.palpating.press, self.displaying.asked()) {
            (Some(Press { rate_mm_s, depth_mm }), _) => Mode::Palpate { rate_mm_s, depth_mm },
            (None, DisplayMode::Idle) => Mode::Idle,
            (None, DisplayMode::Material { material, .. }) => Mode::Display { material },
            (None, _) => Mode::Display { material: self.displaying.showing.to().low },
        }
    }

    /// Both halves are at rest, or held off by a fault.
    pub const fn is_resting(&self) -> bool {
        matches!(self.state(), State::Idle | State::Fault)
    }

    /// True while a host must be there: an output is on, or will be as soon as a verdict comes.
    pub const fn needs_host(&self) -> bool {
        self.palpating.pressing().is_some() || !matches!(self.display_state(), DisplayState::Idle | DisplayState::Fault)
    }

    /// Outputs that may be on.
    pub fn power(&self) -> Power {
        let shown = self.displaying.parts().filter(|_| self.displaying.state() == DisplayState::On);
        Power {
            arm: self.palpating.pressing().is_some(),
            actuator: shown.is_some_and(Parts::actuator),
            coil: shown.is_some_and(Parts::coil),
        }
    }

    /// The arm is at home, and no fault is latched.
    pub const fn palpation_rests(&self) -> bool {
        matches!(self.palpating.stage, Stage::Rest)
    }

    /// A half is on that was asked for by itself.
    pub const fn by_halves(&self) -> bool {
        self.by_halves
    }

    /// Both halves end, the arm goes home.
    pub fn stop(&mut self) {
        self.stop_palpation();
        self.stop_display();
    }

    /// The palpation half ends.
    pub fn stop_palpation(&mut self) {
        self.palpating.stop();
    }

    /// The display half ends.
    pub fn stop_display(&mut self) {
        self.displaying.stop();
    }

    /// Carries out a request for one half with the other at rest.
    ///
    /// # Errors
    /// [`Refusal::Faulted`], [`Refusal::Busy`] unless idle (or displaying, for another display), and those of the half.
    pub fn request(&mut self, config: &ModeConfig, mode: Mode, table: Option<TableLimits>) -> Result<(), Refusal> {
        self.must_be_sound(mode == Mode::Idle)?;
        let displays = self.displaying.parts().is_some();
        let palpates = self.palpating.stage != Stage::Rest;
        match mode {
            Mode::Idle => self.stop(),
            Mode::Palpate { .. } if displays => return Err(Refusal::Busy),
            Mode::Display { .. } if palpates => return Err(Refusal::Busy),
            Mode::Palpate { rate_mm_s, depth_mm } => {
                self.palpating.begin(config, Press { rate_mm_s, depth_mm }, table)?;
                self.by_halves = false;
            }
            Mode::Display { material } => {
                let asked = DisplayMode::Material { parts: Parts::Both, material };
                self.displaying.begin(asked, (Curve::of(material), Origin::ASKED), table)?;
                self.by_halves = false;
            }
        }
        Ok(())
    }

    /// Begins a press, whatever the display does.
    ///
    /// # Errors
    /// [`Refusal::Faulted`], and those of [`Palpating`].
    pub fn press(&mut self, config: &ModeConfig, press: Press, table: Option<TableLimits>) -> Result<(), Refusal> {
        self.must_be_sound(false)?;
        self.palpating.begin(config, press, table)?;
        self.by_halves = true;
        Ok(())
    }

    /// Begins a display, or goes over to another curve, whatever palpation does.
    ///
    /// # Errors
    /// [`Refusal::Faulted`], and those of [`Displaying`].
    pub fn display(
        &mut self,
        asked: DisplayMode,
        curve: (Curve, Origin),
        table: Option<TableLimits>,
    ) -> Result<(), Refusal> {
        self.must_be_sound(false)?;
        self.displaying.begin(asked, curve, table)?;
        self.by_halves = true;
        Ok(())
    }

    /// A verdict says what a display that follows is to show.
    pub fn follow(&mut self, curve: Curve, origin: Origin) {
        self.displaying.follow(curve, origin);
    }

    const fn must_be_sound(&self, stops: bool) -> Result<(), Refusal> {
        if self.faulted && !stops { Err(Refusal::Faulted) } else { Ok(()) }
    }

    /// One tick. With a latched fault both halves end at once.
    pub fn step(&mut self, config: &ModeConfig, input: &ModeInput) -> ModeEvent {
        self.faulted = input.faulted;
        let event = if self.faulted {
            self.displaying.stop();
            self.palpating.fault()
        } else {
            self.displaying.showing.step();
            self.palpating.step(config, input)
        };
        if self.is_resting() {
            self.by_halves = false;
        }
        event
    }
}

/// What a mode needs to know about the table in use.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TableLimits {
    /// Depth of the last row, mm.
    pub depth_max_mm: f32,
    /// Library materials.
    pub materials: usize,
    /// The table has no more columns than this build searches.
    pub searchable: bool,
}

#[cfg(test)]
mod tests;
