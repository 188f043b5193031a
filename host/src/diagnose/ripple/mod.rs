//! Ripples: a wave in the force, over time (hum of the mains, a motor) or over depth (stick and slip, a screw).
//!
//! Means over windows and replicates take a ripple for noise, and no effect of the catalogue makes one. What two repeats of a condition differ by
//! holds it, whatever the model: a fast one as a line in a spectrum (`spectrum.rs`), a slow one as noise that is likelier with it (`slow.rs`).

mod found;
mod slow;
mod spectrum;

use crate::experiment::Experiment;

use super::design::Design;
use super::noise::{Curve, SensorNoise};
pub use found::{Over, Ripple, SPOILS};

/// The ripple that shows, if any does. `curves` is what a model predicts: repeats differ by a gain and by a shift, whose kinks are no
/// ripple. Where it is `adequate`, what it leaves of all repeats together is looked at as well.
#[must_use]
pub fn of(
    experiment: &Experiment,
    design: &Design,
    curves: &[Curve],
    sensor: &SensorNoise,
    adequate: bool,
) -> Option<Ripple> {
    spectrum::of(experiment, design, curves).or_else(|| slow::of(design, curves, sensor, adequate))
}
