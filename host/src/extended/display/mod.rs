//! The extended model of a display: the laws of its channels with the effects that a diagnosis named.
//!
//! It is a file with a section a channel. [`DisplayModel::gain`] predicts other recordings with it.

mod gain;
mod text;

use lut_gen::magnet::bh::LawError;
use lut_gen::magnet::curve::{Built, FluxCurve};
use lut_gen::magnet::fluid::Fluid;
use nalgebra::DVector;

use crate::diagnose::display::channel::Channel;
use crate::diagnose::display::design::{Design, Explained, Series, Unusable};
use crate::diagnose::display::effect::Effect;
use crate::diagnose::display::fit::Problem;
use crate::diagnose::display::law::{Law, Setting};
use crate::diagnose::display::{ChannelDiagnosis, Diagnosis, answered};
use crate::experiment::Experiment;
use crate::finger::round;
pub(crate) use gain::looseness;
pub use gain::{CLOSELY, Gain, Missed};

/// A number with its 95 % interval where that is known.
type Known = (f64, Option<(f64, f64)>);

/// An effect of a channel.
#[derive(Debug, Clone, PartialEq)]
pub struct Added {
    /// The effect.
    pub effect: &'static Effect,
    /// One value a quantity of the effect.
    pub values: Vec<Known>,
    /// Codes of other effects that the diagnosis could not tell from it.
    pub ambiguous_with: Vec<String>,
}

/// The law of one channel.
#[derive(Debug, Clone, PartialEq)]
pub struct ChannelModel {
    /// The channel.
    pub channel: Channel,
    /// Parameters of its base law, in the order of [`Channel::base`].
    pub base: Vec<Known>,
    /// The same of the base law alone, a plain fit without effects; empty where the file does not tell.
    pub alone: Vec<Known>,
    /// What was added.
    pub effects: Vec<Added>,
}

/// The channels of a display of which something was named.
#[derive(Debug, Clone, PartialEq)]
pub struct DisplayModel {
    /// Each by itself, in physical order.
    pub channels: Vec<ChannelModel>,
}

impl DisplayModel {
    /// Of a diagnosis; none where nothing was named.
    #[must_use]
    pub fn of(found: &Diagnosis) -> Option<Self> {
        let channels: Vec<ChannelModel> = found.channels.iter().filter_map(of_channel).collect();
        (!channels.is_empty()).then_some(Self { channels })
    }

    /// Flux density over current of its magnet, from none up to `most_a` (A), without the sensor's zero: what control
    /// curves are made for. `None` where nothing was found of the flux.
    ///
    /// # Errors
    /// A law that does not rise with the current.
    pub fn flux_curve(&self, most_a: f64) -> Option<Result<FluxCurve, LawError>> {
        const POINTS: usize = 60;
        /// Time of the whole ramp, s: a fluid answers in milliseconds.
        const RAMP_S: f64 = 60.0;
        let law = self.channels.iter().find(|one| one.channel == Channel::Flux)?.law();
        let part = |k: usize| k as f64 / POINTS as f64;
        let current_a: Vec<f64> = (0..=POINTS).map(|k| most_a * part(k)).collect();
        let ramp = Series {
            file: String::new(),
            channel: Channel::Flux,
            time_s: (0..=POINTS).map(|k| RAMP_S * part(k)).collect(),
            output: vec![0.0; current_a.len()],
            compared: vec![true; current_a.len()],
            input: current_a.clone(),
            yield_kpa: Vec::new(),
            is_answered: false,
            left: [Vec::new(), Vec::new()],
            gap_ratio: 1.0,
            gap_mm: 0.0,
            condition: 0,
            hold_out: false,
        };
        let points: Vec<(f64, f64)> = current_a.into_iter().zip(law.happens(&ramp)).collect();
        Some(FluxCurve::new(&points, 0.0, Built::default()))
    }

    /// Yield stress over flux density of its fluid, with the magnetic law of another. `None` where nothing was found of the fluid.
    ///
    /// # Errors
    /// A yield stress that does not rise with the flux density.
    pub fn fluid(&self, law: &Fluid) -> Option<Result<Fluid, LawError>> {
        /// Field strengths, kA/m: at the last a fluid of Carlson's law has 99.9 % of its largest stress.
        const MOST_KA_M: f64 = 600.0;
        const POINTS: usize = 120;
        let own = self.channels.iter().find(|one| one.channel == Channel::Fluid)?.law();
        // it was found beside the law that the diagnosis takes for granted, whatever the fluid
        let pascal = |ka_m: f64| 1e3 * own.yields_kpa(round::yield_kpa(law.flux_at_strength(ka_m)));
        let strength = (1..=POINTS).map(|k| MOST_KA_M * (k as f64 / POINTS as f64).powi(2));
        let points = strength.map(|ka_m| (1e3 * ka_m, pascal(ka_m)));
        // what is borne without a field begins within an ampere a metre
        let rest = Some((1.0, pascal(0.0))).filter(|(_, rest)| *rest > 0.0);
        let points: Vec<(f64, f64)> = std::iter::once((0.0, 0.0)).chain(rest).chain(points).collect();
        Some(Fluid::measured(law.law().clone(), &points))
    }

    /// What it gains on the display's runs of an experiment, channel by channel; a channel that was not
    /// recorded is left out.
    ///
    /// # Errors
    /// A channel whose runs cannot be used.
    pub fn gain(&self, experiment: &Experiment) -> Result<Vec<Gain>, Unusable> {
        let mut found = Vec::new();
        for one in &self.channels {
            let design = match Design::of(experiment, one.channel, &self.explained(experiment, one.channel)) {
                Err(Unusable::Absent) => continue,
                other => other?,
            };
            found.push(one.gain(&design));
        }
        Ok(found)
    }

    /// What the flux of an experiment is compared at: the current as this model, or the base, explains it.
    #[must_use]
    pub fn explained(&self, experiment: &Experiment, of: Channel) -> Explained {
        if of != Channel::Flux {
            return Explained::new();
        }
        let current = self.channels.iter().find(|one| one.channel == Channel::Current).map(ChannelModel::law);
        answered(experiment, current.as_ref())
    }
}

impl ChannelModel {
    /// The law that predicts a run.
    #[must_use]
    pub fn law(&self) -> Law {
        let setting = |added: &Added| Setting { effect: added.effect, values: values(&added.values) };
        Law { channel: self.channel, base: values(&self.base), settings: self.effects.iter().map(setting).collect() }
    }

    /// The base law alone, as a plain fit to the diagnosed runs; `None` where the file does not tell.
    #[must_use]
    pub fn law_alone(&self) -> Option<Law> {
        let base = values(&self.alone);
        (!base.is_empty()).then_some(Law { channel: self.channel, base, settings: Vec::new() })
    }

    /// What it gains on the runs of its channel.
    fn gain(&self, design: &Design) -> Gain {
        let plain = Problem::unweighted(design);
        let law = self.law();
        let fitted = Problem::plain_base(design, plain.used.clone(), &law);
        let alone = self.law_alone();
        let is_as_diagnosed = alone.is_some();
        let base = alone.as_ref().unwrap_or(&fitted);
        let [here, before, after] = [&fitted, base, &law].map(|law| plain.plain(law));
        let run = |s: usize| {
            let series = &design.series[s];
            let square = |missed: &DVector<f64>| missed.rows(design.first(s), series.time_s.len()).norm_squared();
            Missed {
                file: series.file.clone(),
                command: series.condition,
                samples: series.count(),
                before: square(&before),
                after: square(&after),
                fitted: square(&here),
            }
        };
        let runs = (0..design.series.len()).map(run).collect();
        Gain::new(self.channel, is_as_diagnosed, runs)
    }
}

fn values(known: &[Known]) -> Vec<f64> {
    known.iter().map(|(value, _)| *value).collect()
}

/// With the values of the fit, which is what predicts and what the printed gain is of. An evidence allows for discrepancies that
/// a prediction has not; its intervals hold the fit's values here.
fn of_channel(found: &ChannelDiagnosis) -> Option<ChannelModel> {
    let evidence = found.evidence.as_deref()?;
    let best = evidence.held.first()?;
    let used = evidence.design.series.iter().map(|series| !series.hold_out).collect();
    let alone = Problem::plain_base(&evidence.design, used, &evidence.base.fit.law).base;
    let alone = alone.into_iter().map(|value| (value, None)).collect();
    let known = |effect: Option<usize>| -> Vec<Known> {
        let fitted = effect.map_or(&best.fit.law.base, |at| &best.fit.law.settings[at].values);
        let each = best.estimates(effect).into_iter().zip(fitted);
        each.map(|((_, _, (low, high)), value)| (*value, Some((low.min(*value), high.max(*value))))).collect()
    };
    let added = best.fit.effects.iter().enumerate().map(|(at, effect)| {
        let finding = found.findings.iter().find(|finding| finding.code == effect.code);
        let twins = finding.map_or(&[][..], |finding| &finding.ambiguous_with);
        Added { effect, values: known(Some(at)), ambiguous_with: twins.iter().map(|code| (*code).to_owned()).collect() }
    });
    let effects: Vec<Added> = added.collect();
    (!found.findings.is_empty()).then(|| ChannelModel { channel: found.channel, base: known(None), alone, effects })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::diagnose::display::effect::{fluid_rest, yield_law};
    use lut_gen::magnet::fluid::Oil;

    #[test]
    fn a_fluid_is_that_of_its_law() {
        let law = Fluid::carlson(0.22, Oil::Hydrocarbon).unwrap();
        assert!(DisplayModel { channels: Vec::new() }.fluid(&law).is_none());
        let base = [0.8, 1.1, 1.0, 0.0, 0.0].map(|value| (value, None)).to_vec();
        let added = |effect, value: f64| Added { effect, values: vec![(value, None)], ambiguous_with: Vec::new() };
        let effects = vec![added(&yield_law::POWER, 1.1), added(&fluid_rest::EFFECT, 0.2)];
        let own =
            DisplayModel { channels: vec![ChannelModel { channel: Channel::Fluid, base, alone: Vec::new(), effects }] };
        let found = own.fluid(&law).unwrap().unwrap();
        for flux_t in [0.05, 0.1, 0.2, 0.4] {
            let exact = 0.2 + 0.8 * law.yield_at_flux(flux_t).powf(1.1);
            // of cubics between 120 points
            assert!((found.yield_at_flux(flux_t) / exact - 1.0).abs() < 2e-3, "{flux_t} T: {exact}");
        }
        assert!(found.flux_for_yield(0.1).unwrap() < 1e-4);
    }
}
