//! Modes, for the board and for each of its halves: who may ask, what follows, and what is told.

use super::lease::LEASE_MS;
use super::machine::Machine;
use super::press::shown_with;
use super::requests::Answer;
use crate::display::{Display, DisplayInput, DisplayOutput};
use crate::flash::{CalibrationStore, TableStore};
use crate::link::LinkId;
use crate::mode::Press;
use crate::neighbours::{self, Parameters, Placed};
use crate::sensor::least_n;
use crate::showing::{Felt, Origin};
use protocol::lut::Table;
use protocol::message::{
    Curve, DisplayMode, DisplayRequest, DisplayState, Fitted, Halves, Mode, ModeRequest, Outcome, PalpationMode,
    PalpationRequest, Parts, Recognition, Refusal, Rule, Verdict,
};

/// What the latest palpation that said anything said.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Identified {
    palpation: u32,
    /// Entry of the library that it named.
    named: Option<u8>,
    /// mu and alpha, where it has them.
    parameters: Option<Parameters>,
}

impl Identified {
    /// `None` of a verdict that names no material and has no parameters.
    pub fn of(verdict: &Verdict) -> Option<Self> {
        let named = Some(verdict.material.index).filter(|index| *index != Recognition::NONE);
        let parameters = (verdict.outcome == Outcome::Identified).then_some(Parameters {
            mu_mpa: verdict.mu_mpa,
            alpha: verdict.alpha,
            height_mm: verdict.height_mm,
            rate_mm_s: verdict.rate_mm_s,
        });
        (named.is_some() || parameters.is_some()).then_some(Identified {
            palpation: verdict.palpation,
            named,
            parameters,
        })
    }

    /// The curve by a rule; `None` if the rule finds none.
    fn placed(&self, table: &Table<'_>, by: Rule) -> Option<Placed> {
        match by {
            Rule::Between => neighbours::between(table, &self.parameters?),
            Rule::Nearest => {
                let index = self.named?;
                let placed = self.parameters.and_then(|at| neighbours::entry(table, index, &at));
                Some(placed.unwrap_or(of_entry(index)))
            }
        }
    }
}

/// An entry that was asked for by itself.
const fn of_entry(index: u8) -> Placed {
    Placed { curve: Curve::of(index), departs: 0.0, outside: false }
}

/// What a display is asked to show of a place.
const fn shown(placed: &Placed, of_palpation: u32) -> (Curve, Origin) {
    (placed.curve, Origin { of_palpation, departs: placed.departs, outside: placed.outside })
}

impl<S: TableStore + CalibrationStore> Machine<S> {
    /// Who may ask for outputs, and when; the same for the board and for each half.
    fn may_begin(&self, link: LinkId, lease_ms: u16) -> Result<(), Refusal> {
        self.must_not_be_held_from(link)?;
        if self.stop_pressed {
            return Err(Refusal::Stopped);
        }
        let (shortest_ms, longest_ms) = LEASE_MS;
        if (shortest_ms..=longest_ms).contains(&lease_ms) { Ok(()) } else { Err(Refusal::OutOfRange) }
    }

    fn must_be_sound(&self) -> Result<(), Refusal> {
        if self.upload.is_erasing() {
            Err(Refusal::Busy)
        } else if !self.safety.latched().is_empty() {
            Err(Refusal::Faulted)
        } else {
            Ok(())
        }
    }

    pub(super) fn set_mode(&mut self, link: LinkId, asked: &ModeRequest) -> Result<Answer, Refusal> {
        let mode = asked.mode;
        if mode != Mode::Idle {
            self.may_begin(link, asked.lease_ms)?;
        }
        // Asked again for what is under way: the answer to the first request was lost.
        if mode == self.mode.commanded() && self.mode.palpating.pressing().is_some() {
            return Ok(Answer::Accepted);
        }
        let stated_mm = self.take_expected(link);
        if mode != Mode::Idle {
            self.must_be_sound()?;
        }
        match mode {
            Mode::Palpate { .. } => self.must_have_palpator()?,
            Mode::Display { .. } => self.must_have(Parts::Both)?,
            Mode::Idle => {}
        }
        let began = self.mode.display_state();
        self.mode.request(&self.config.mode, mode, self.table_limits())?;
        match mode {
            Mode::Palpate { rate_mm_s, .. } => self.begin_press(rate_mm_s, stated_mm),
            Mode::Display { .. } => self.begin_display(began),
            Mode::Idle => {}
        }
        if mode != Mode::Idle {
            self.lease.grant(link, asked.lease_ms);
        }
        Ok(Answer::Accepted)
    }

    pub(super) fn set_palpation(&mut self, link: LinkId, asked: &PalpationRequest) -> Result<Answer, Refusal> {
        let PalpationMode::Press { rate_mm_s, depth_mm, surface_mm } = asked.palpation else {
            self.mode.stop_palpation();
            return Ok(Answer::Accepted);
        };
        self.may_begin(link, asked.lease_ms)?;
        let press = Press { rate_mm_s, depth_mm };
        if self.mode.palpating.pressing() == Some(press) {
            return Ok(Answer::Accepted);
        }
        self.must_be_sound()?;
        self.must_have_palpator()?;
        if surface_mm.is_some_and(|height_mm| !self.is_surface(height_mm)) {
            return Err(Refusal::OutOfRange);
        }
        let beside = self.mode.displaying.parts().is_some();
        self.mode.press(&self.config.mode, press, self.table_limits())?;
        let stated_mm = self.take_expected(link);
        self.begin_press(rate_mm_s, surface_mm.or(stated_mm));
        self.grant(link, asked.lease_ms, beside);
        Ok(Answer::Accepted)
    }

    pub(super) fn set_display(&mut self, link: LinkId, asked: &DisplayRequest) -> Result<Answer, Refusal> {
        let Some(parts) = asked.display.parts() else {
            self.mode.stop_display();
            return Ok(Answer::Accepted);
        };
        self.may_begin(link, asked.lease_ms)?;
        self.must_be_sound()?;
        self.must_have(parts)?;
        let curve = self.asked_curve(asked.display)?;
        let beside = !self.mode.palpation_rests();
        let began = self.mode.display_state();
        self.mode.display(asked.display, curve, self.table_limits())?;
        self.begin_display(began);
        self.grant(link, asked.lease_ms, beside);
        Ok(Answer::Accepted)
    }

    fn grant(&mut self, link: LinkId, lease_ms: u16, beside: bool) {
        if beside {
            self.lease.grant_beside(link, lease_ms);
        } else {
            self.lease.grant(link, lease_ms);
        }
    }

    /// The curve that a display is asked for, now; none for one that waits for a verdict.
    fn asked_curve(&self, asked: DisplayMode) -> Result<(Curve, Origin), Refusal> {
        let table = self.table().ok_or(Refusal::NoTable)?;
        let must_have_neighbours = || {
            if neighbours::has_neighbours(&table) { Ok(()) } else { Err(Refusal::NotBetween) }
        };
        match asked {
            DisplayMode::Idle => Ok((Curve::NONE, Origin::ASKED)),
            DisplayMode::Material { material, .. } => Ok((Curve::of(material), Origin::ASKED)),
            DisplayMode::Between { mu_mpa, alpha, height_mm, rate_mm_s, .. } => {
                must_have_neighbours()?;
                let at = Parameters { mu_mpa, alpha, height_mm, rate_mm_s };
                let placed = neighbours::between(&table, &at).ok_or(Refusal::OutOfRange)?;
                Ok(shown(&placed, 0))
            }
            DisplayMode::Follow { by, .. } => {
                if by == Rule::Between {
                    must_have_neighbours()?;
                }
                let followed = self.identified.and_then(|i| Some(shown(&i.placed(&table, by)?, i.palpation)));
                Ok(followed.unwrap_or((Curve::NONE, Origin::ASKED)))
            }
        }
    }

    fn begin_press(&mut self, rate_mm_s: f32, stated_mm: Option<f32>) {
        self.palpation.start(rate_mm_s);
        self.watch_press(stated_mm);
        self.palpations = self.palpations.wrapping_add(1);
        self.palpation_rate_mm_s = rate_mm_s;
        self.contact_ticks = (0, 0, 0);
    }

    /// A curve is shown that was not: the shaft begins where it is.
    fn begin_display(&mut self, before: DisplayState) {
        if before != DisplayState::On && self.mode.display_state() == DisplayState::On {
            self.display = Display::at(self.measured.shaft_mm);
        }
    }

    /// Takes a verdict to memory. It is shown in the next tick: this one has had the end of the analysis.
    pub(super) fn remember(&mut self, verdict: &Verdict) {
        if let Some(identified) = Identified::of(verdict) {
            self.identified = Some(identified);
            self.follow_due = true;
        }
    }

    /// Shows what the tick before has identified, if that is asked for.
    pub(super) fn follow(&mut self) {
        let due = core::mem::take(&mut self.follow_due);
        let Some(identified) = self.identified.filter(|_| due) else {
            return;
        };
        let placed = self.mode.displaying.follows().and_then(|by| identified.placed(&self.table()?, by));
        if let Some(placed) = placed {
            let before = self.mode.display_state();
            let (curve, origin) = shown(&placed, identified.palpation);
            self.mode.follow(curve, origin);
            self.begin_display(before);
        }
    }

    /// What is fitted and asked for of the display.
    fn shown_with(&self) -> Option<Fitted> {
        self.mode.displaying.parts().map(|parts| shown_with(&self.fitted, parts))
    }

    /// One tick of the display, if it shows anything.
    pub(super) fn show(&mut self) -> Option<DisplayOutput> {
        if self.mode.display_state() != DisplayState::On {
            return None;
        }
        let driven = self.shown_with()?;
        let mut display = self.display;
        let (force_n, shaft_mm) = (self.measured.fsr_n, self.measured.shaft_mm);
        let showing = self.mode.displaying.showing();
        let least_n = least_n(&self.calibration.fsr);
        let felt = Felt::new(&self.config.display, force_n, least_n);
        let is_at_place = self.mode.displaying.parts().is_some_and(Parts::at_place);
        let input = DisplayInput { shaft_mm, force_n, least_n, coil_c: self.coil_c };
        let felt = if is_at_place {
            felt.at_place(&self.config.display, shaft_mm)
        } else {
            Felt { ahead_mm: display.ahead_mm(&self.config.display, &self.pid, &input), ..felt }
        };
        let wanted = self.table().and_then(|table| showing.at(&table, felt, display.still_mm()));
        self.bound_a = wanted.map_or(0.0, |wanted| wanted.bound_a);
        let output = wanted.map(|wanted| {
            display.step(&self.config.display, &self.config.thermal, &self.pid, &wanted, &input).fitted(&driven)
        });
        self.display = display;
        Some(output.unwrap_or_default())
    }

    /// What both halves do.
    pub(super) fn halves(&self) -> Halves {
        let displaying = &self.mode.displaying;
        let (showing, on) = (displaying.showing(), displaying.state() == DisplayState::On);
        let origin = if on { showing.origin() } else { Origin::ASKED };
        Halves {
            tick: self.tick,
            palpation: self.mode.palpation_state(),
            display: self.mode.display_state(),
            parts: displaying.parts().unwrap_or(Parts::Both),
            curve: showing.to(),
            share: if on { showing.share() } else { 0.0 },
            of_palpation: origin.of_palpation,
            departs: origin.departs,
            outside: origin.outside,
            bound_a: if on { self.bound_a } else { 0.0 },
        }
    }
}
