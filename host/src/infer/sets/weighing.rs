//! A search in one noise from its sets to what is said of them.

use super::judged::Judged;
use super::search::led;
use super::shares::{Known, Misfits, Shares};
use super::verdict::Outcome;
use super::visible::is_visible;
use super::weigh::Weighed;
use super::{Fitted, Forward, Groups};
use crate::infer::evidence::amounts;

/// What a search in one noise came to.
#[derive(Debug)]
pub struct Weighing<T, N> {
    /// The base.
    pub base: Weighed<T>,
    /// Sets that were weighed, the base among them, the likeliest first.
    pub sets: Vec<Weighed<T>>,
    /// The likeliest set of what is named, one for each choice among twins, the likeliest first.
    pub held: Vec<Weighed<T>>,
    /// What is believed.
    pub judged: Judged<N>,
}

impl<T: Fitted, N: Copy + Eq + Send + Sync> Weighing<T, N> {
    /// Searches for what explains the data beside groups of discrepancies; none where nothing can be compared.
    /// `shared` parameters, the first of each set, are those that all sets have.
    #[must_use]
    pub fn of<F: Misfits<Fit = T, Name = N>>(of: &F, groups: &Groups, shared: usize) -> Option<Self> {
        let sets = led(of, &groups.discrepancy, &[], &mut Vec::new());
        let shares = Shares::new(of, groups, sets);
        let judged = Judged::of(&shares, shared)?;
        let Known { sets, .. } = shares.into_known();
        let base = sets.iter().find(|set| set.is_base()).cloned()?;
        Some(Self { base, held: judged.holding(&sets), sets, judged })
    }

    /// Takes names back that do not hold.
    pub fn keep_names(&mut self, hold: bool) {
        if !self.judged.findings.is_empty() && !hold {
            self.judged.withdraw();
        }
        if self.judged.findings.is_empty() {
            self.held.clear();
        }
    }

    /// Sets between which another run is to decide ([`Judged::rivals`]); beside likely ones the base, from which a single one
    /// is to be told as well.
    #[must_use]
    pub fn rivals(&self) -> Vec<&Weighed<T>> {
        let base = Some(&self.base).filter(|_| self.held.is_empty() && self.judged.outcome != Outcome::Clean);
        self.judged.rivals(&self.sets, &self.held).into_iter().chain(base).collect()
    }

    /// What the misfit of the base varies with, the largest first; nothing where nothing is wrong.
    #[must_use]
    pub fn shows_in(&self, groups: &Groups) -> Vec<&'static str> {
        if self.judged.outcome == Outcome::Clean {
            return Vec::new();
        }
        let told = amounts(&self.base.linearised(), &self.base.evidence, &groups.discrepancy);
        told.map_or_else(Vec::new, |amounts| groups.largest(&amounts))
    }

    /// Those of some names of which a plausible amount would not be seen in any form, each once.
    #[must_use]
    pub fn blind_to<F: Forward<Fit = T, Name = N>>(
        &self,
        of: &F,
        groups: &Groups,
        names: impl IntoIterator<Item = N>,
    ) -> Vec<N> {
        let mut blind: Vec<N> = Vec::new();
        for name in names {
            let mut forms = of.effects().iter().filter(|effect| of.name(effect) == name);
            if !blind.contains(&name) && !forms.any(|form| is_visible(of, &self.base, groups, form)) {
                blind.push(name);
            }
        }
        blind
    }
}
