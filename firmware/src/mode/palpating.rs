//! The palpation half: at rest -> approach -> contact -> return -> at rest.

use super::{ModeConfig, ModeEvent, ModeInput, TableLimits};
use protocol::message::{Outcome, Refusal};

/// What the arm is doing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Stage {
    /// At home.
    #[default]
    Rest,
    /// On its way down, no contact yet.
    Approach,
    /// In contact.
    Contact,
    /// On its way home.
    Retract,
}

/// A press that was asked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Press {
    /// Rate of the probe, mm/s.
    pub rate_mm_s: f32,
    /// Depth after contact at which it ends, mm.
    pub depth_mm: f32,
}

/// State of the palpation half.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Palpating {
    pub(super) press: Option<Press>,
    pub(super) stage: Stage,
    ticks: u32,
    ended: Outcome,
    /// Height of the probe where it was lowest, mm.
    lowest_mm: f32,
    /// Height of the probe where the approach began, mm.
    began_mm: f32,
}

impl Default for Palpating {
    fn default() -> Self {
        Self::new()
    }
}

impl Palpating {
    /// At rest.
    pub const fn new() -> Self {
        Palpating {
            press: None,
            stage: Stage::Rest,
            ticks: 0,
            ended: Outcome::Aborted,
            lowest_mm: 0.0,
            began_mm: f32::NEG_INFINITY,
        }
    }

    fn enter(&mut self, stage: Stage) {
        self.stage = stage;
        self.ticks = 0;
    }

    fn retract(&mut self, ended: Outcome, probe_mm: f32) {
        self.ended = ended;
        self.lowest_mm = probe_mm;
        self.enter(Stage::Retract);
    }

    /// On its way down at a rate that no request can ask for.
    #[cfg(test)]
    pub fn pressing_at(rate_mm_s: f32) -> Self {
        let press = Some(Press { rate_mm_s, depth_mm: 3.5 });
        Palpating { press, stage: Stage::Approach, ..Palpating::new() }
    }

    /// The press whose arm goes down.
    pub const fn pressing(&self) -> Option<Press> {
        match self.stage {
            Stage::Approach | Stage::Contact => self.press,
            Stage::Rest | Stage::Retract => None,
        }
    }

    /// What the arm is doing.
    pub const fn stage(&self) -> Stage {
        self.stage
    }

    /// How the motion of the palpation that returns ended.
    pub const fn ended(&self) -> Outcome {
        self.ended
    }

    /// The arm goes home.
    pub(super) fn stop(&mut self) {
        if matches!(self.stage, Stage::Approach | Stage::Contact) {
            // The probe height is not known here; the next tick sets the lowest one.
            self.retract(Outcome::Aborted, f32::INFINITY);
        }
        self.press = None;
    }

    /// Begins a press.
    ///
    /// # Errors
    /// [`Refusal::Busy`] unless at rest, [`Refusal::NoTable`], [`Refusal::TooLarge`], [`Refusal::OutOfRange`].
    pub(super) fn begin(
        &mut self,
        config: &ModeConfig,
        press: Press,
        table: Option<TableLimits>,
    ) -> Result<(), Refusal> {
        if self.stage != Stage::Rest {
            return Err(Refusal::Busy);
        }
        let limits = table.ok_or(Refusal::NoTable)?;
        if !limits.searchable {
            return Err(Refusal::TooLarge);
        }
        let (slowest, fastest) = config.rate_mm_s;
        let rate_ok = press.rate_mm_s >= slowest && press.rate_mm_s <= fastest;
        let deepest_mm = limits.depth_max_mm * (1.0 + 1e-4);
        let depth_ok = press.depth_mm >= config.depth_min_mm && press.depth_mm <= deepest_mm;
        if !(rate_ok && depth_ok) {
            return Err(Refusal::OutOfRange);
        }
        self.press = Some(press);
        self.began_mm = f32::NEG_INFINITY;
        self.enter(Stage::Approach);
        Ok(())
    }

    /// A fault is latched: the arm goes home.
    pub(super) fn fault(&mut self) -> ModeEvent {
        self.press = None;
        if self.stage == Stage::Rest {
            return ModeEvent::None;
        }
        self.enter(Stage::Rest);
        ModeEvent::Ended(Outcome::Aborted)
    }

    /// One tick without fault.
    pub(super) fn step(&mut self, config: &ModeConfig, input: &ModeInput) -> ModeEvent {
        self.ticks = self.ticks.saturating_add(1);
        match self.stage {
            Stage::Approach => self.approach(config, input),
            Stage::Contact => self.contact(config, input),
            Stage::Retract => return self.returning(config, input),
            Stage::Rest => {}
        }
        ModeEvent::None
    }

    fn approach(&mut self, config: &ModeConfig, input: &ModeInput) {
        if self.ticks == 1 {
            self.began_mm = input.probe_mm;
        }
        if input.force_n >= config.force_end_n {
            // Something hard, before the contact was understood: back before the force limit makes it a fault.
            self.retract(Outcome::TooShort, input.probe_mm);
        } else if let Some(outcome) = input.no_slice {
            self.retract(outcome, input.probe_mm);
        } else if input.contact {
            self.enter(Stage::Contact);
        } else if input.probe_mm <= input.floor_mm.max(config.travel_min_mm) || self.ticks > config.approach_ticks {
            self.retract(Outcome::NoContact, input.probe_mm);
        }
    }

    fn contact(&mut self, config: &ModeConfig, input: &ModeInput) {
        let Some(Press { depth_mm, .. }) = self.press else {
            return self.retract(Outcome::Aborted, input.probe_mm);
        };
        let full = input.depth_mm >= depth_mm || input.record_full;
        let ended_early = input.probe_mm <= config.travel_min_mm
            || input.force_n >= config.force_end_n
            || self.ticks > config.contact_ticks;
        if full || ended_early {
            // Half the depth still tells materials apart; less does not.
            let enough = full || input.depth_mm >= 0.5 * depth_mm;
            let outcome = if enough { Outcome::Identified } else { Outcome::TooShort };
            self.retract(outcome, input.probe_mm);
        }
    }

    fn returning(&mut self, config: &ModeConfig, input: &ModeInput) -> ModeEvent {
        if input.probe_mm < self.lowest_mm {
            self.lowest_mm = input.probe_mm;
        }
        let clear = if input.contact {
            input.depth_mm <= -config.clearance_mm
        } else {
            input.probe_mm >= (self.lowest_mm + config.clearance_mm).min(self.began_mm - config.home_mm)
        };
        if (clear || self.ticks > config.retract_ticks) && input.analysed {
            self.press = None;
            self.enter(Stage::Rest);
            return ModeEvent::Ended(self.ended);
        }
        ModeEvent::None
    }
}
