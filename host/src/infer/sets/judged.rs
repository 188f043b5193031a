//! From the evidence of sets to what is believed of effects.

use rayon::prelude::*;

use super::shares::{Misfits, Shares};
use super::verdict::{Conclusion, Outcome, concluded};
use super::weigh::Weighed;
use super::{Fitted, Forward, Kind};
use crate::infer::evidence::{Discrepancy, evidence, of_unknown_sizes};
use crate::infer::mixture::{Part, quantile};

/// Logarithm of the odds, a hundred, from which on something is wrong for certain: an effect or a discrepancy.
const SURE: f64 = 4.6;
/// Probability of an effect from which on it is told what it explains alone.
const OF_NOTE: f64 = 0.01;
/// Share of a distribution beyond either end of a 95 % interval.
const TAIL: f64 = 0.025;

/// What is believed of one effect.
#[derive(Debug, Clone, PartialEq)]
pub struct Belief<N> {
    /// Its name.
    pub name: N,
    /// Probability that it is there.
    pub probability: f64,
    /// Share of the misfit that it explains alone, where it is of note and there is a misfit.
    pub explains: Option<f64>,
}

/// How much wider priors are made to see what rests on them.
const WIDER: f64 = 2.0;

/// What would be said with priors of amounts and sizes of discrepancies twice as wide.
#[derive(Debug, Clone, PartialEq)]
pub struct Wider<N> {
    /// What would be said.
    pub outcome: Outcome,
    /// Names that would hold.
    pub findings: Vec<Vec<N>>,
    /// It is the same.
    pub is_same: bool,
}

/// What is believed of the data.
#[derive(Debug, Clone, PartialEq)]
pub struct Judged<N> {
    /// What is said.
    pub outcome: Outcome,
    /// Names that hold, the most important first, each with the twins that may stand in its place.
    pub findings: Vec<Vec<N>>,
    /// Effects that were tried, the likeliest first.
    pub beliefs: Vec<Belief<N>>,
    /// Names of what is there and explains too little, each with its twins.
    pub partly: Vec<Vec<N>>,
    /// Share of the misfit that the names or these explain.
    pub explains: Option<f64>,
    /// Root mean square of what the names explain, in the unit of the readings; none where they show in none.
    pub explained: Option<f64>,
    /// 95 % intervals of the parameters that all sets have, as they are searched, over all sets that were
    /// weighed.
    pub intervals: Vec<(f64, f64)>,
    /// What stays without a name beside the likeliest set: root mean square as a share of the readings, the
    /// base fitted again; none where nothing stays.
    pub remainder: Option<f64>,
    /// What that varies with, the largest first; scatter among it.
    pub shows_in: Vec<&'static str>,
    /// What each group of discrepancies varies with, in the order of the sizes of a set's evidence; none of noise.
    pub groups: Vec<Option<&'static str>>,
    /// Probability that nothing is wrong: no effect and no discrepancy.
    pub nothing: f64,
    /// Probability of every set that was weighed, the likeliest first.
    pub sets: Vec<f64>,
    /// Names of every set.
    pub members: Vec<Vec<N>>,
    /// What would be said with wider priors.
    pub wider: Wider<N>,
}

/// What is told of a name that holds.
#[derive(Debug, Clone, PartialEq)]
pub struct Told<N> {
    /// Probability that it is there.
    pub probability: f64,
    /// Share of the misfit that it explains alone, where there is one.
    pub explains: Option<f64>,
    /// Names that may stand in its place.
    pub twins: Vec<N>,
}

impl<N: Copy + Eq + Send + Sync> Judged<N> {
    /// What is told of a name that holds.
    #[must_use]
    pub fn told(&self, name: N) -> Told<N> {
        let belief = self.belief(name);
        let own = self.findings.iter().find(|set| set.contains(&name)).map_or(&[][..], |set| set);
        Told {
            probability: belief.map_or(0.0, |belief| belief.probability),
            explains: belief.and_then(|belief| belief.explains),
            twins: own.iter().filter(|other| **other != name).copied().collect(),
        }
    }

    /// Of sets that were weighed; none where there is none. `shared` parameters, the first of each, are
    /// those that all sets have.
    #[must_use]
    pub fn of<F: Misfits<Name = N>>(shares: &Shares<'_, F>, shared: usize) -> Option<Self> {
        let (of, compared) = (shares.forward(), shares.sets());
        if compared.is_empty() {
            return None;
        }
        let members: Vec<Vec<N>> =
            compared.iter().map(|set| set.fit.effects().iter().map(|effect| of.name(effect)).collect()).collect();
        let sets = probabilities(&compared.iter().map(|set| set.log).collect::<Vec<_>>());
        let any = |of: &[N]| any(&members, &sets, of);
        let conclusion_of = |sets: &[f64], told: &[Belief<N>], alone: f64| {
            concluded(
                told,
                alone < (-SURE).exp(),
                |of: &[N]| shares.share(of),
                |of: &[N]| self::any(&members, sets, of),
            )
        };
        let told = |name: N| {
            let probability = any(&[name]);
            let explains = (probability > OF_NOTE).then(|| shares.share(&[name])).flatten();
            Belief { name, probability, explains }
        };
        let mut told: Vec<Belief<N>> = names(of).into_iter().map(told).collect();
        told.sort_by(|a, b| b.probability.total_cmp(&a.probability));
        let nothing = nothing_wrong(compared, &sets);
        let Conclusion { outcome, findings, partly, explains } = conclusion_of(&sets, &told, nothing);
        let wider = {
            let (sets, alone) = wider(compared, &shares.groups().discrepancy);
            let mut told: Vec<Belief<N>> = told.clone();
            told.iter_mut().for_each(|b| b.probability = self::any(&members, &sets, &[b.name]));
            told.sort_by(|a, b| b.probability.total_cmp(&a.probability));
            let Conclusion { outcome: its, findings: names, .. } = conclusion_of(&sets, &told, alone);
            Wider { outcome: its, is_same: its == outcome && is_same(&names, &findings), findings: names }
        };
        Some(Self {
            outcome,
            explained: shares.explained(&findings.concat()),
            findings,
            beliefs: told,
            partly,
            explains,
            intervals: intervals(shares, shared),
            remainder: shares.left_share(),
            shows_in: shares.left_over(),
            groups: shares
                .groups()
                .each
                .iter()
                .map(|group| (group.kind != Kind::Noise).then_some(group.over))
                .collect(),
            nothing,
            sets,
            wider,
            members,
        })
    }

    /// Takes the names back: they stay as what is there in part.
    pub fn withdraw(&mut self) {
        self.outcome = Outcome::Unknown;
        self.partly = std::mem::take(&mut self.findings);
    }

    /// The discrepancies beside a set: what each varies with, and its size as a share of the readings.
    pub fn beside<'s, T>(&'s self, set: &'s Weighed<T>) -> impl Iterator<Item = (&'static str, f64)> + 's {
        let sizes = self.groups.iter().copied().zip(set.evidence.sizes.iter().copied());
        sizes.filter_map(|(over, size)| over.filter(|_| size > 0.0).map(|over| (over, size)))
    }

    /// What is believed of a name.
    #[must_use]
    pub fn belief(&self, name: N) -> Option<&Belief<N>> {
        self.beliefs.iter().find(|belief| belief.name == name)
    }

    /// Probability that at least one of some effects is there.
    #[must_use]
    pub fn any(&self, of: &[N]) -> f64 {
        any(&self.members, &self.sets, of)
    }

    /// The likeliest sets of what is named, one for each choice among twins, the likeliest first.
    #[must_use]
    pub fn holding<T: Fitted>(&self, sets: &[Weighed<T>]) -> Vec<Weighed<T>> {
        if self.findings.is_empty() {
            return Vec::new();
        }
        let is_that = |own: &[N], names: &[N]| {
            own.iter().all(|name| names.contains(name)) && names.iter().all(|name| own.contains(name))
        };
        let likeliest = |names: Vec<N>| {
            sets.iter().zip(&self.members).find(|(_, own)| is_that(own, &names)).map(|(set, _)| set.clone())
        };
        let mut held: Vec<Weighed<T>> = choices(&self.findings).into_iter().filter_map(likeliest).collect();
        held.sort_by(|a, b| b.log.total_cmp(&a.log));
        held
    }

    /// Sets between which another run is to decide: those that are held, or, where something is wrong and none is held, the
    /// likely ones that have a name.
    #[must_use]
    pub fn rivals<'s, T: Fitted>(&self, sets: &'s [Weighed<T>], held: &'s [Weighed<T>]) -> Vec<&'s Weighed<T>> {
        /// Probability from which a set is a rival.
        const LIKELY: f64 = 0.05;
        if !held.is_empty() || self.outcome == Outcome::Clean {
            return held.iter().collect();
        }
        let likely = sets.iter().zip(&self.sets).filter(|(set, probability)| **probability > LIKELY && !set.is_base());
        likely.map(|(set, _)| set).collect()
    }
}

/// Probability of each set, from the logarithm of its evidence and odds; none of what is no number.
fn probabilities(logs: &[f64]) -> Vec<f64> {
    let largest = logs.iter().copied().filter(|log| log.is_finite()).fold(f64::NEG_INFINITY, f64::max);
    let weights: Vec<f64> = logs.iter().map(|log| if log.is_finite() { (log - largest).exp() } else { 0.0 }).collect();
    let whole: f64 = weights.iter().sum::<f64>().max(f64::MIN_POSITIVE);
    weights.iter().map(|weight| weight / whole).collect()
}

/// Probability that at least one of some names is in a set.
fn any<N: Eq>(members: &[Vec<N>], probabilities: &[f64], of: &[N]) -> f64 {
    let holds = |names: &[N]| names.iter().any(|name| of.contains(name));
    members.iter().zip(probabilities).filter(|(names, _)| holds(names)).map(|(_, p)| p).fold(0.0, |sum, p| sum + p)
}

/// Every choice of one name of each finding.
fn choices<N: Copy>(findings: &[Vec<N>]) -> Vec<Vec<N>> {
    findings.iter().fold(vec![Vec::new()], |heads, twins| {
        let with = |head: &Vec<N>| {
            let head = head.clone();
            twins.iter().map(move |name| head.iter().copied().chain([*name]).collect::<Vec<_>>()).collect::<Vec<_>>()
        };
        heads.iter().flat_map(with).collect()
    })
}

/// Probability that nothing is wrong, over that of all sets: of the base without a discrepancy.
fn nothing_wrong<T: Fitted>(compared: &[Weighed<T>], probabilities: &[f64]) -> f64 {
    let base = compared.iter().zip(probabilities).find(|(set, _)| set.is_base());
    base.map_or(0.0, |(base, probability)| probability * (base.evidence.alone - base.log).exp())
}

/// Probabilities of sets, and that nothing is wrong, with wider priors.
fn wider<T: Fitted>(compared: &[Weighed<T>], discrepancy: &Discrepancy) -> (Vec<f64>, f64) {
    /// Sets this far behind (logarithm) stay there.
    const NEAR: f64 = 20.0;
    let discrepancy = discrepancy.wider(WIDER);
    let again = |set: &Weighed<T>| {
        if set.log < compared[0].log - NEAR {
            return (set.log, set.evidence.alone - set.log);
        }
        let mut model = set.linearised();
        model.parameters.iter_mut().for_each(|own| own.prior = own.prior.wider(WIDER));
        // the sizes are those of the same groups
        let sizes: Vec<f64> = set.evidence.sizes.iter().take(discrepancy.groups()).map(|size| WIDER * size).collect();
        let found = evidence(&model, &discrepancy, &sizes);
        found.map_or((f64::NAN, 0.0), |found| (found.log + set.log - set.evidence.log, found.alone - found.log))
    };
    let told: Vec<(f64, f64)> = compared.par_iter().map(again).collect();
    let sets = probabilities(&told.iter().map(|(log, _)| *log).collect::<Vec<_>>());
    let base = compared.iter().position(|set| set.is_base());
    let alone = base.map_or(0.0, |at| sets[at] * told[at].1.exp());
    (sets, alone)
}

/// True for the same names, in any order.
fn is_same<N: Eq>(one: &[Vec<N>], other: &[Vec<N>]) -> bool {
    let within = |few: &[Vec<N>], all: &[Vec<N>]| {
        few.iter().all(|names| all.iter().any(|its| its.len() == names.len() && its.iter().all(|n| names.contains(n))))
    };
    within(one, other) && within(other, one)
}

/// 95 % intervals of the first parameters: of the mixture of all sets, discrepancies allowed for, those
/// of sizes that do not show among them.
fn intervals<F: Misfits>(shares: &Shares<'_, F>, shared: usize) -> Vec<(f64, f64)> {
    /// How far (logarithm) behind the likeliest a set may lie to count.
    const COUNTS: f64 = 7.0;
    let (compared, discrepancy) = (shares.sets(), &shares.groups().discrepancy);
    let likely: Vec<_> = compared.iter().filter(|set| set.log > compared[0].log - COUNTS).collect();
    let more: Vec<Vec<f64>> =
        likely.par_iter().map(|set| of_unknown_sizes(&set.linearised(), discrepancy, &set.evidence)).collect();
    let bounds: Vec<(f64, f64)> = compared[0].linearised().parameters.iter().map(|own| own.bounds).collect();
    let interval = |at: usize| {
        let part = |(set, more): (&&Weighed<F::Fit>, &Vec<f64>)| {
            let (mean, deviation) = (set.evidence.x[at], set.evidence.deviations[at].hypot(more[at].sqrt()));
            let part = Part { weight: set.log, mean, deviation: deviation.max(f64::MIN_POSITIVE) };
            [part.weight, part.mean, part.deviation].iter().all(|v| v.is_finite()).then_some(part)
        };
        let parts: Vec<Part> = likely.iter().zip(&more).filter_map(part).collect();
        let end = |share: f64| quantile(&parts, share).clamp(bounds[at].0, bounds[at].1);
        (end(TAIL), end(1.0 - TAIL))
    };
    (0..shared).map(interval).collect()
}

/// Names of all effects, each once.
fn names<F: Forward>(of: &F) -> Vec<F::Name> {
    let mut names: Vec<F::Name> = Vec::new();
    for name in of.effects().iter().map(|effect| of.name(effect)) {
        if !names.contains(&name) {
            names.push(name);
        }
    }
    names
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn probabilities_add_up_over_sets() {
        let members = [vec![], vec!["a"], vec!["b"], vec!["a", "b"], vec!["c"]];
        let logs = [1.0_f64, 2.0, 3.0, 4.0, f64::NAN].map(|odds| odds.ln() - 700.0);
        let sets = probabilities(&logs);
        assert!(
            (any(&members, &sets, &["a"]) - 0.6).abs() < 1e-12 && (any(&members, &sets, &["b"]) - 0.7).abs() < 1e-12
        );
        assert_eq!(any(&members, &sets, &["c"]), 0.0);
        assert!((any(&members, &sets, &["a", "b"]) - 0.9).abs() < 1e-12);
    }

    #[test]
    fn every_choice_among_twins_is_one() {
        assert_eq!(choices(&[vec!["a", "b"], vec!["c"]]), [["a", "c"], ["b", "c"]]);
        assert_eq!(choices::<&str>(&[]), [Vec::<&str>::new()]);
    }
}
