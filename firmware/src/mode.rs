//! The mode state machine: Idle -> Approach -> Contact -> Retract -> Idle, Display, Fault.
//!
//! It decides which outputs may be on; nothing else does. Outputs are on in Approach, Contact and Display alone.

use protocol::message::{Mode, Outcome, Refusal, State};

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

/// State of the machine.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ModeState {
    /// What the host asked for.
    pub commanded: Mode,
    /// What the board is doing.
    pub state: State,
    ticks: u32,
    ended: Outcome,
    /// Height of the probe where it was lowest, mm.
    lowest_mm: f32,
    /// Height of the probe where the approach began, mm.
    began_mm: f32,
}

impl Default for ModeState {
    fn default() -> Self {
        Self::new()
    }
}

/// What the machine looks at in one tick.
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

impl ModeState {
    /// Idle.
    pub const fn new() -> Self {
        ModeState {
            commanded: Mode::Idle,
            state: State::Idle,
            ticks: 0,
            ended: Outcome::Aborted,
            lowest_mm: 0.0,
            began_mm: f32::NEG_INFINITY,
        }
    }

    fn enter(&mut self, state: State) {
        self.state = state;
        self.ticks = 0;
    }

    fn retract(&mut self, ended: Outcome, probe_mm: f32) {
        self.ended = ended;
        self.lowest_mm = probe_mm;
        self.enter(State::Retract);
    }

    /// True if any output is on in this state.
    pub const fn outputs_on(&self) -> bool {
        matches!(self.state, State::Approach | State::Contact | State::Display)
    }

    /// How the motion of the palpation in Retract ended.
    pub const fn ended(&self) -> Outcome {
        self.ended
    }

    /// Carries out a request.
    ///
    /// # Errors
    /// [`Refusal::Faulted`], [`Refusal::Busy`] unless idle (or displaying, for another display), [`Refusal::NoTable`], [`Refusal::OutOfRange`].
    pub fn request(&mut self, config: &ModeConfig, mode: Mode, table: Option<TableLimits>) -> Result<(), Refusal> {
        if mode == Mode::Idle {
            match self.state {
                // The probe height is not known here; the next tick sets the lowest one.
                State::Approach | State::Contact => self.retract(Outcome::Aborted, f32::INFINITY),
                State::Display => self.enter(State::Idle),
                State::Idle | State::Retract | State::Fault => {}
            }
            self.commanded = Mode::Idle;
            return Ok(());
        }
        match (self.state, mode) {
            (State::Fault, _) => return Err(Refusal::Faulted),
            (State::Idle, _) | (State::Display, Mode::Display { .. }) => {}
            _ => return Err(Refusal::Busy),
        }
        let limits = table.ok_or(Refusal::NoTable)?;
        let next = match mode {
            Mode::Palpate { rate_mm_s, depth_mm } => {
                if !limits.searchable {
                    return Err(Refusal::TooLarge);
                }
                let (slowest, fastest) = config.rate_mm_s;
                let rate_ok = rate_mm_s >= slowest && rate_mm_s <= fastest;
                let depth_ok = depth_mm >= config.depth_min_mm && depth_mm <= limits.depth_max_mm * (1.0 + 1e-4);
                if !(rate_ok && depth_ok) {
                    return Err(Refusal::OutOfRange);
                }
                State::Approach
            }
            Mode::Display { material } if usize::from(material) >= limits.materials => {
                return Err(Refusal::OutOfRange);
            }
            Mode::Display { .. } => State::Display,
            Mode::Idle => State::Idle,
        };
        self.commanded = mode;
        self.began_mm = f32::NEG_INFINITY;
        self.enter(next);
        Ok(())
    }

    /// One tick.
    pub fn step(&mut self, config: &ModeConfig, input: &ModeInput) -> ModeEvent {
        self.ticks = self.ticks.saturating_add(1);
        if input.faulted {
            return self.fault();
        }
        match self.state {
            State::Approach => self.approach(config, input),
            State::Contact => self.contact(config, input),
            State::Retract => return self.returning(config, input),
            State::Fault => self.enter(State::Idle),
            State::Idle | State::Display => {}
        }
        ModeEvent::None
    }

    fn fault(&mut self) -> ModeEvent {
        let palpating = matches!(self.state, State::Approach | State::Contact | State::Retract);
        if self.state != State::Fault {
            self.enter(State::Fault);
            self.commanded = Mode::Idle;
        }
        if palpating { ModeEvent::Ended(Outcome::Aborted) } else { ModeEvent::None }
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
            self.enter(State::Contact);
        } else if input.probe_mm <= input.floor_mm.max(config.travel_min_mm) || self.ticks > config.approach_ticks {
            self.retract(Outcome::NoContact, input.probe_mm);
        }
    }

    fn contact(&mut self, config: &ModeConfig, input: &ModeInput) {
        let Mode::Palpate { depth_mm, .. } = self.commanded else {
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
            self.commanded = Mode::Idle;
            self.enter(State::Idle);
            return ModeEvent::Ended(self.ended);
        }
        ModeEvent::None
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
