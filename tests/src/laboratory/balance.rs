//! Amounts with which what should dominate does.

use nalgebra::DVector;
use palpate::simulate::{Effect, Rest, SimulatedExperiment, Spec};
use rand::Rng;
use rand_pcg::Pcg64;

use super::DOMINATES;
use super::ingredient::{Scales, scaled};
use super::rests::TOTAL;
use crate::hidden::even;
use crate::score::ScoreError;
use crate::score::share::{Misfits, Yardstick};

/// Share that amounts are scaled for: forces are not linear in them.
const WANTED: f64 = 0.78;
/// Times that amounts are scaled and weighed again.
const TRIES: usize = 4;
/// Halvings of the logarithm of a scale, which then is known within a hundredth.
const HALVINGS: usize = 9;
/// Least scale of all but what dominates that is looked at.
const LEAST: f64 = 0.02;
/// Ratio of the misfits of two effects that are comparable.
const COMPARABLE: f64 = 4.0;
/// Forces below this part of a run's largest say nothing of shares of the force.
const SHALLOW: f64 = 0.1;

/// What a world is made of.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Parts {
    pub dominating: Vec<Effect>,
    pub minors: Vec<Effect>,
    pub rests: Vec<Rest>,
}

/// The same with amounts that do what they should.
pub(super) struct Balanced {
    pub parts: Parts,
    /// Share of the squared misfit of each that dominates, and of all of them.
    pub shares: Vec<f64>,
    pub share: f64,
    pub rests_rms: f64,
}

/// What amounts are weighed with.
pub(super) struct Balance<'a> {
    pub yardstick: &'a Yardstick<'a>,
    pub base: &'a Spec,
    pub bare: &'a SimulatedExperiment,
    pub misfits: &'a Misfits,
    pub scales: &'a Scales,
}

impl Balance<'_> {
    /// Parts with amounts that do; `None` where a few tries find none.
    pub fn of(&self, mut parts: Parts, chance: &mut Pcg64) -> Result<Option<Balanced>, ScoreError> {
        let total = parts.rests.iter().map(|rest| rest.amplitude.powi(2)).sum::<f64>().sqrt();
        let found = self.rms(&parts.rests)?;
        scale_rests(&mut parts.rests, total / found);
        let mut rests_rms = total;
        if parts.dominating.is_empty() {
            return Ok(Some(Balanced { parts, shares: Vec::new(), share: 0.0, rests_rms }));
        }
        if !self.comparable(&mut parts, chance)? {
            return Ok(None);
        }
        // part of what is missing that makes the dominating larger, the rest makes the others
        // smaller
        let larger: f64 = chance.random();
        for attempt in 0..TRIES {
            let others = self.shift(&[], &parts)?;
            let all = self.shift(&parts.dominating, &parts)?;
            let whole = self.misfits.left(&all);
            let share = 1.0 - self.misfits.left(&others) / whole.max(f64::MIN_POSITIVE);
            if share >= DOMINATES {
                let shares = self.shares(&parts, whole)?;
                return Ok(Some(Balanced { parts, shares, share, rests_rms }));
            }
            if attempt + 1 == TRIES {
                break;
            }
            let Some(scale) = self.scale(&(&all - &others), &others) else { break };
            let mut by = scale.powf(-larger);
            while by > 1.01 && !parts.dominating.iter().all(|one| scaled(one, by, self.scales).is_some()) {
                by = by.sqrt();
            }
            if by > 1.01 {
                parts.dominating = parts.dominating.iter().filter_map(|one| scaled(one, by, self.scales)).collect();
            }
            let smaller = scale * by;
            parts.minors = parts.minors.iter().filter_map(|one| scaled(one, smaller, self.scales)).collect();
            let least = (TOTAL.0 / rests_rms).min(1.0).max(smaller);
            scale_rests(&mut parts.rests, least);
            rests_rms *= least;
        }
        Ok(None)
    }

    /// Of two effects makes one larger until they are comparable; true if they are, and of one.
    fn comparable(&self, parts: &mut Parts, chance: &mut Pcg64) -> Result<bool, ScoreError> {
        let alone = |effect: &Effect| -> Result<f64, ScoreError> {
            let none = Parts { dominating: Vec::new(), minors: Vec::new(), rests: Vec::new() };
            Ok(self.misfits.left(&self.shift(std::slice::from_ref(effect), &none)?))
        };
        if parts.dominating.len() < 2 {
            return Ok(true);
        }
        let wanted = even(chance, 0.5, 2.0);
        for _ in 0..TRIES {
            let ratio = alone(&parts.dominating[0])? / alone(&parts.dominating[1])?.max(f64::MIN_POSITIVE);
            if (1.0 / COMPARABLE..=COMPARABLE).contains(&ratio) {
                return Ok(true);
            }
            // the larger becomes smaller, which always can be
            let by = (ratio / wanted).sqrt();
            let (at, by) = if by > 1.0 { (0, 1.0 / by) } else { (1, by) };
            let Some(other) = scaled(&parts.dominating[at], by, self.scales) else { break };
            parts.dominating[at] = other;
        }
        Ok(false)
    }

    /// Share of the squared misfit `whole` that goes when one of those that dominate is taken out.
    fn shares(&self, parts: &Parts, whole: f64) -> Result<Vec<f64>, ScoreError> {
        let one = |at: usize| {
            let mut rest = parts.dominating.clone();
            rest.remove(at);
            Ok(1.0 - self.misfits.left(&self.shift(&rest, parts)?) / whole)
        };
        (0..parts.dominating.len()).map(one).collect()
    }

    /// How much smaller all but what dominates must be, as if forces were linear in amounts; none
    /// where the dominating has no misfit of its own.
    fn scale(&self, own: &DVector<f64>, others: &DVector<f64>) -> Option<f64> {
        let dominates = |scale: f64| {
            let scaled = others * scale;
            1.0 - self.misfits.left(&scaled) / self.misfits.left(&(own + &scaled)).max(f64::MIN_POSITIVE) >= WANTED
        };
        if !dominates(LEAST) {
            return None;
        }
        let (mut low, mut high) = (LEAST.ln(), 0.0);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if dominates(middle.exp()) { low = middle } else { high = middle }
        }
        Some(low.exp())
    }

    /// What effects beside minors and rests make of exact forces, N.
    fn shift(&self, dominating: &[Effect], parts: &Parts) -> Result<DVector<f64>, ScoreError> {
        Ok(self.misfits.shift(&self.made(dominating, &parts.minors, &parts.rests)?))
    }

    fn made(
        &self,
        dominating: &[Effect],
        minors: &[Effect],
        rests: &[Rest],
    ) -> Result<SimulatedExperiment, ScoreError> {
        self.yardstick.made(&Spec { effects: effects(dominating, minors, rests), ..self.base.clone() })
    }

    /// Root mean square of rests together as a share of the force of the bare experiment.
    pub fn rms(&self, rests: &[Rest]) -> Result<f64, ScoreError> {
        let made = self.made(&[], &[], rests)?;
        let (mut square, mut count) = (0.0, 0.0_f64);
        for (run, bare) in made.runs.iter().zip(&self.bare.runs) {
            let largest = bare.exact_n.iter().copied().fold(0.0, f64::max);
            for (with, without) in run.exact_n.iter().zip(&bare.exact_n).filter(|(_, f)| **f > SHALLOW * largest) {
                square += ((with - without) / without).powi(2);
                count += 1.0;
            }
        }
        Ok((square / count.max(1.0)).sqrt().max(1e-6))
    }
}

/// All that is in an experiment, what dominates first.
pub(super) fn effects(dominating: &[Effect], minors: &[Effect], rests: &[Rest]) -> Vec<Effect> {
    dominating.iter().chain(minors).cloned().chain(rests.iter().copied().map(Effect::Rest)).collect()
}

fn scale_rests(rests: &mut [Rest], by: f64) {
    // an amplitude beyond that is refused
    rests.iter_mut().for_each(|rest| rest.amplitude = (by * rest.amplitude).min(1.0));
}
