//! What guards a press, and what the board is set up for.

use super::Inputs;
use super::machine::Machine;
use super::requests::Answer;
use crate::config::BoardConfig;
use crate::flash::{CalibrationStore, Loaded, Setup, TableStore};
use crate::link::LinkId;
use crate::mode::Press;
use crate::plausible::{Contradiction, Plausible, Reading};
use crate::sensor::{ALL_FITTED, calibration_is_usable};
use protocol::lut::{Table, axis_name};
use protocol::message::{CalibrationState, Fitted, Parts, Refusal, Surface};

/// Setup of a board at start: what is stored, or the firmware's own calibration and everything fitted.
pub(super) fn setup_at_start(config: &BoardConfig, store: &mut impl CalibrationStore) -> (Setup, CalibrationState) {
    let own = || Setup { calibration: config.calibration.clone(), fitted: ALL_FITTED };
    match store.load_setup() {
        Loaded::Stored(setup) if calibration_is_usable(&setup.calibration) => (setup, CalibrationState::Stored),
        Loaded::Nothing => (own(), CalibrationState::Default),
        // Out of the limits of this firmware is as bad as torn.
        Loaded::Stored(_) | Loaded::Unreadable => (own(), CalibrationState::Unreadable),
    }
}

impl<S: TableStore + CalibrationStore> Machine<S> {
    /// Begins to watch a press, and says how low it may go without contact: what was stated can end it earlier than the
    /// table's lowest surface does, never later.
    pub(super) fn watch_press(&mut self, stated_mm: Option<f32>) {
        self.plausible = Plausible::default();
        let mode = &self.config.mode;
        let lowest_mm = self.table().and_then(|t| lowest_mm(&t)).map_or(0.0, |low_mm| low_mm - mode.below_table_mm);
        self.floor_mm = stated_mm.map_or(lowest_mm, |stated_mm| lowest_mm.max(stated_mm - mode.blind_mm));
    }

    /// Takes what a link states for its next mode.
    pub(super) fn take_expected(&mut self, link: LinkId) -> Option<f32> {
        self.expected.take().filter(|(from, _)| *from == link).map(|(_, height_mm)| height_mm)
    }

    pub(super) fn expect_surface(&mut self, link: LinkId, surface: &Surface) -> Result<Answer, Refusal> {
        self.outputs_must_be_off()?;
        if !self.is_surface(surface.height_mm) {
            return Err(Refusal::OutOfRange);
        }
        self.expected = Some((link, surface.height_mm));
        Ok(Answer::Accepted)
    }

    /// True for a height at which there can be a surface.
    pub(super) fn is_surface(&self, height_mm: f32) -> bool {
        height_mm > self.config.mode.travel_min_mm && height_mm < self.config.mode.travel_max_mm
    }

    pub(super) fn set_fitted(&mut self, fitted: &Fitted) -> Result<Answer, Refusal> {
        if self.calibration_state == CalibrationState::Unreadable {
            return Err(Refusal::CalibrationLost);
        }
        self.store_setup(Setup { calibration: self.calibration.clone(), fitted: fitted.clone() })
    }

    /// Stores and takes on a setup; one that is stored already is not written again.
    pub(super) fn store_setup(&mut self, setup: Setup) -> Result<Answer, Refusal> {
        self.outputs_must_be_off()?;
        if self.upload.is_erasing() {
            return Err(Refusal::Busy);
        }
        let same = setup.calibration == self.calibration && setup.fitted == self.fitted;
        if !(same && self.calibration_state == CalibrationState::Stored) {
            self.store.save_setup(&setup).map_err(|_| Refusal::FlashFailed)?;
        }
        (self.calibration, self.fitted) = (setup.calibration, setup.fitted);
        self.calibration_state = CalibrationState::Stored;
        Ok(Answer::Accepted)
    }

    /// Refuses a press without a palpator.
    pub(super) fn must_have_palpator(&self) -> Result<(), Refusal> {
        if self.fitted.palpator { Ok(()) } else { Err(Refusal::NoPalpator) }
    }

    /// Refuses a display none of whose parts is fitted, and a finger's place without its potentiometer: that is the
    /// actuator's.
    pub(super) fn must_have(&self, parts: Parts) -> Result<(), Refusal> {
        let driven = shown_with(&self.fitted, parts);
        let is_read = self.fitted.actuator || !parts.at_place();
        if (driven.actuator || driven.coil) && is_read { Ok(()) } else { Err(Refusal::NoDisplay) }
    }

    /// What this tick's readings contradict, while the arm presses.
    pub(super) fn contradiction(&mut self, inputs: &Inputs) -> Contradiction {
        match self.mode.palpating.pressing() {
            Some(Press { rate_mm_s, .. }) if inputs.fresh => {
                let reading = Reading {
                    probe_mm: self.measured.probe_mm,
                    force_n: self.measured.load_cell_n,
                    rate_mm_s,
                    contact_noise_n: self.palpation.contact_noise_n(),
                };
                self.plausible.step(&self.config.plausible, &reading)
            }
            _ => Contradiction::default(),
        }
    }
}

/// What is fitted, of the display only what is asked for.
pub(super) fn shown_with(fitted: &Fitted, parts: Parts) -> Fitted {
    Fitted {
        actuator: fitted.actuator && parts.actuator(),
        coil: fitted.coil && parts.coil(),
        palpator: fitted.palpator,
    }
}

/// Height of the lowest specimen that a table knows, mm.
fn lowest_mm(table: &Table<'_>) -> Option<f32> {
    table.axis(axis_name::HEIGHT).map(|axis| axis.value(0))
}
