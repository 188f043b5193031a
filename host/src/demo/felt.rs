//! What a hand feels of a material on both displays: presses of a simulated hand, on a board of its own.

use serde_json::{Value, json};

use super::DemoError;
use crate::control::Curves;
use crate::control::compose::Links;
use crate::feel::{self, Asked, Display, Felt, Pace};
use crate::plant::Constants;

/// Presses a material slowly and fast on actuator and fluid; `None` without a control curve for this magnet.
pub(super) fn felt(material: &str, curves: &Curves, links: &Links, seed: u64) -> Result<Option<Vec<Felt>>, DemoError> {
    let curve = curves.of(material).and_then(|curve| curve.for_magnet(links).ok());
    let Some(curve) = curve else { return Ok(None) };
    let asked = Asked {
        curves: vec![curve],
        flux: links.flux.clone(),
        law: links.law.clone(),
        constants: Constants::frozen()?,
        gains: None,
        actuator: None,
        seed,
    };
    let mut felt = Vec::new();
    for display in [Display::Actuator, Display::FluidAtPlace] {
        felt.extend(feel::run(&asked, display, &mut |_| {})?);
    }
    Ok(Some(felt))
}

/// One sentence a press.
pub(super) fn sentences(felt: &[Felt]) -> Vec<String> {
    let percent = |part: f64| format!("{:.1} %", 100.0 * part);
    let one = |felt: &Felt, press: &feel::Pressed| {
        let (of, pace) = (&felt.curve, press.pace.name());
        match felt.display {
            Display::Actuator => felt.actuator(press).map(|score| {
                format!(
                    "{} on the actuator, {pace}: position off by {}, force by {}, tracking by at most {}",
                    of.material,
                    percent(score.position),
                    percent(score.force),
                    percent(score.tracking)
                )
            }),
            Display::Fluid | Display::FluidAtPlace => felt.fluid(press).map(|score| {
                format!("{} on the fluid, {pace}: force agrees by {}", of.material, percent(score.agreement))
            }),
        }
    };
    felt.iter().flat_map(|felt| felt.presses.iter().filter_map(move |press| one(felt, press))).collect()
}

/// The slow presses' measures.
pub(super) fn json(felt: &[Felt]) -> Value {
    let slow = |felt: &Felt| {
        let press = felt.presses.iter().find(|press| press.pace == Pace::Slow)?;
        Some(match felt.display {
            Display::Actuator => {
                let score = felt.actuator(press)?;
                json!({"display": "actuator", "position": score.position, "force": score.force, "tracking": score.tracking})
            }
            Display::Fluid | Display::FluidAtPlace => {
                json!({"display": "fluid", "agreement": felt.fluid(press)?.agreement})
            }
        })
    };
    felt.iter().filter_map(slow).collect()
}
