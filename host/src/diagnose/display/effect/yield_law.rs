//! A fluid whose yield stress grows otherwise with the flux density.

use super::{Effect, Quantity, Stage};
use crate::diagnose::display::channel::Channel;

/// A power of what Carlson's law says: models that were fitted to the same data differ by 13 to 24 % (Xie, Liu and Cai 2020).
pub const POWER: Effect = Effect {
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
        starts: &[0.8, 0.95, 1.05, 1.25],
        logarithmic: true,
    }],
};

/// Iron that saturates sooner: the stress bends towards a largest one, as Froehlich's and Kennelly's curve does.
pub const SATURATING: Effect = Effect {
    form: "saturating",
    quantities: &[Quantity::amount("bend_per_kPa", (0.0, 1.0), 0.05, &[0.05, 0.3])],
    ..POWER
};

/// Yield stress of the power, kPa; 1 kPa is kept.
#[must_use]
pub fn powered(kpa: f64, exponent: f64) -> f64 {
    KEPT_KPA * (kpa / KEPT_KPA).powf(exponent)
}

/// Yield stress of iron that saturates sooner, kPa; 1 kPa is kept.
#[must_use]
pub fn saturating(kpa: f64, bend_per_kpa: f64) -> f64 {
    kpa * (1.0 + bend_per_kpa * KEPT_KPA) / (1.0 + bend_per_kpa * kpa)
}

/// The number beside it makes any other: 1 kPa is in the middle of what displays use.
const KEPT_KPA: f64 = 1.0;
