//! What a board is set to for an actuator: gains of its position loop, farthest and fastest target, feed-forward of the force.

use firmware::display::{DisplayConfig, HELD, HOLDS_V_PER_N, RATE_MM_S, REACH_MM};
use protocol::message::{Actuator as Sent, Gains as SentGains};

use super::limits::{Limits, Rule};
use super::sampled::Sampling;
use super::{Asked, TuneError, Way, tune};
use crate::actuator::Actuator;

/// Part of a force that feed-forward holds: a force that is read too large would otherwise push the finger back.
const FED: f64 = 0.7;
/// Largest peak sensitivity: a finger on the cap is part of the loop that nobody knows.
const SENSITIVITY: f64 = 1.6;
/// Limit of the command in the search, part of the largest.
const COMMAND: f64 = 0.92;

/// Largest command, V: the driver's, or the board's if that is less.
fn most_v(actuator: &Actuator) -> f64 {
    actuator.command_limit_v.min(f64::from(firmware::pid::U_MAX_V))
}

/// Gains and actuator as a board takes them.
#[derive(Debug, Clone, PartialEq)]
pub struct Setting {
    /// Of the position loop.
    pub gains: SentGains,
    /// Farthest and fastest target, and feed-forward.
    pub actuator: Sent,
}

/// Why a board cannot be set for an actuator.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum Unsettable {
    /// No gains.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Gains(#[from] TuneError),
    /// It moves too little.
    #[error(
        "the largest command of {command_v} V holds the shaft at {reach_mm:.2} mm; expected {least_mm} mm or more, which a board takes",
        least_mm = REACH_MM.0
    )]
    Short {
        /// Where 90 % of the largest command hold the shaft, mm.
        reach_mm: f64,
        /// That command, V.
        command_v: f64,
    },
}

impl Setting {
    /// For an actuator, with gains that are searched unless they are given.
    ///
    /// # Errors
    /// As [`tune`], and an actuator whose reach is below what a board takes.
    pub fn of(actuator: &Actuator, gains: Option<SentGains>) -> Result<Self, Unsettable> {
        let own = sent(actuator);
        if own.reach_mm < REACH_MM.0 {
            return Err(Unsettable::Short { reach_mm: own.reach_mm.into(), command_v: most_v(actuator) });
        }
        let gains = match gains {
            Some(gains) => gains,
            None => tune(&asked(actuator))?.gains.sent(),
        };
        Ok(Self { gains, actuator: own })
    }
}

/// The loop that runs on the board: 50 Hz, a held command, one tick of delay.
fn asked(actuator: &Actuator) -> Asked {
    Asked {
        uncertain: actuator.uncertain(0.1),
        flaws: actuator.flaws(),
        way: Way::Sampled(Sampling::board(1)),
        limits: Limits { command_v: COMMAND * most_v(actuator), sensitivity: Some(SENSITIVITY), ..Limits::default() },
        rule: Rule::Text,
        robust: false,
    }
}

/// What the actuator can do, within what a board takes.
fn sent(actuator: &Actuator) -> Sent {
    let plant = actuator.plant();
    // a plant with a pole at 0 goes on as long as its command lasts
    let at_rest = plant.numerator.at(0) / plant.denominator.at(0);
    let reach_mm = (f64::from(HELD) * most_v(actuator) * at_rest.abs()).min(f64::from(REACH_MM.1));
    let usual = f64::from(DisplayConfig::default().target_rate_mm_s);
    let rate_mm_s = actuator.rate_limit_mm_per_s.map_or(usual, |known| known.value);
    let back_v_n = if at_rest.is_finite() && at_rest > 0.0 { actuator.back_mm_per_n.value / at_rest } else { 0.0 };
    Sent {
        reach_mm: reach_mm as f32,
        rate_mm_s: (rate_mm_s as f32).clamp(RATE_MM_S.0, RATE_MM_S.1),
        holds_v_per_n: ((FED * back_v_n) as f32).min(HOLDS_V_PER_N.1),
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::actuator::{Form, Known};

    #[test]
    fn the_thesis_actuator_reaches_as_far_as_a_board_that_nobody_told() {
        let usual = DisplayConfig::default();
        let thesis = sent(&Actuator::thesis());
        assert_eq!(usual.with(&thesis), Some(usual));
    }

    #[test]
    fn a_voice_coil_has_the_whole_stroke_and_a_board_takes_it() {
        let coil = Actuator::voice_coil().unwrap();
        let own = sent(&coil);
        assert_eq!((own.reach_mm, own.rate_mm_s), (18.0, 200.0));
        assert!((own.holds_v_per_n - 0.0875).abs() < 1e-6, "{}", own.holds_v_per_n);
        let setting = Setting::of(&coil, None).unwrap();
        assert!(DisplayConfig::default().with(&setting.actuator).is_some());
        assert!(firmware::pid::gains_are_usable(&setting.gains), "{:?}", setting.gains);
    }

    #[test]
    fn an_actuator_that_hardly_moves_is_told() {
        let exact = |list: &[f64]| list.iter().map(|value| Known::exactly(*value)).collect();
        let form = Form::Coefficients { numerator: exact(&[8.6]), denominator: exact(&[1.0, 23.4, 86.0]) };
        let weak = Actuator { form, ..Actuator::thesis() };
        let told = Setting::of(&weak, Some(firmware::pid::DEFAULT_GAINS)).unwrap_err().to_string();
        assert!(told.contains("5 V holds the shaft at 0.45 mm; expected 0.5 mm or more"), "{told}");
    }

    #[test]
    fn a_board_gives_no_more_than_its_own_largest_command() {
        let strong = Actuator { command_limit_v: 24.0, ..Actuator::thesis() };
        assert_eq!(sent(&strong), sent(&Actuator::thesis()));
    }

    #[test]
    fn what_integrates_has_the_whole_stroke_and_no_feed_forward() {
        let poles = vec![crate::actuator::Pole::Real(Known::exactly(0.0))];
        let form = Form::Poles { gain: Known::exactly(5.0), poles };
        let own = sent(&Actuator { form, back_mm_per_n: Known::exactly(0.5), ..Actuator::thesis() });
        assert_eq!((own.reach_mm, own.holds_v_per_n), (19.0, 0.0));
    }
}
