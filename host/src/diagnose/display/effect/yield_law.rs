//! A fluid whose yield stress grows otherwise with the flux density.

use super::{Effect, Quantity, Stage};
use crate::diagnose::display::channel::Channel;

/// A power of what Carlson's law says: models that were fitted to the same data differ by 13 to 24 % (Xie, Liu and Cai 2020).
pub const EFFECT: Effect = Effect {
    code: "yield-law",
    form: "power",
    channel: Channel::Fluid,
    stage: Stage::Fluid,
    assumption: "the yield stress over flux density is that of Carlson's law for MRF-122, times a number",
    signature: "a function of the flux density: forces are off by another part at small currents than at large ones",
    twins: &["fluid-rest"],
    separated_by: "presses at currents from small to the largest",
    quantities: &[Quantity {
        name: "exponent",
        null: Some(1.0),
        bounds: (0.4, 2.5),
        plausible: 1.1,
        starts: &[0.8, 1.25],
        logarithmic: true,
    }],
};

/// Yield stress, kPa; 1 kPa is kept.
#[must_use]
pub fn bent(kpa: f64, exponent: f64) -> f64 {
    KEPT_KPA * (kpa / KEPT_KPA).powf(exponent)
}

/// The number beside it makes any other: 1 kPa is in the middle of what displays use.
const KEPT_KPA: f64 = 1.0;
