//! Sets of effects, compared by their evidence: a discrepancy of unknown size is in each of them, the
//! base included (`docs/decisions/0005-one-model.md`).

mod discrepancy;
mod found;
mod search;
mod share;
mod solve;
mod verdict;
mod weigh;

use lut_gen::effect::Kind;
use rayon::prelude::*;

use super::coordinate::Candidate;
use super::finding::Verdict;
use super::search::Search;
use crate::infer::compare::{Beliefs, Set};
use crate::infer::evidence::{Discrepancy, Sizes, of_unknown_sizes};
use crate::infer::mixture::{Part, quantile};
use share::Shares;
use verdict::{Conclusion, concluded};

pub(super) use found::{Found, found};
pub use weigh::Weighed;

/// Size of a discrepancy, as a share of the force: as often above as below, and a factor of 2.7 to
/// either side. Simulations of soft solids agree with tests to about a percent.
const SIZE: (f64, f64) = (0.005, 1.0);
/// Logarithm of the odds, a hundred, from which on something is wrong for certain: an effect or a discrepancy.
const SURE: f64 = 4.6;
/// Probability of an effect from which on it is told what it explains alone.
const OF_NOTE: f64 = 0.01;

/// What is believed of one effect.
#[derive(Debug, Clone, PartialEq)]
pub struct Belief {
    /// Its code.
    pub code: &'static str,
    /// Probability that it is there.
    pub probability: f64,
    /// Share of the misfit that it explains alone, where it is of note and there is a misfit.
    pub explains: Option<f64>,
}

/// What is believed of the data.
#[derive(Debug, Clone, PartialEq)]
pub struct Judged {
    /// The verdict.
    pub verdict: Verdict,
    /// Names that hold, the most important first, each with the twins that may stand in its place.
    pub findings: Vec<Vec<&'static str>>,
    /// Effects that were tried, the likeliest first.
    pub beliefs: Vec<Belief>,
    /// Kinds of effects with the probability that one of them is there, the likeliest first.
    pub kinds: Vec<(Kind, f64)>,
    /// Names of what is there and explains too little, each with its twins.
    pub partly: Vec<Vec<&'static str>>,
    /// Share of the misfit that the names or these explain.
    pub explains: Option<f64>,
    /// Root mean square of what the names explain, N; none where they show in no force.
    pub explained_n: Option<f64>,
    /// 95 % intervals of `mu` (MPa) and `alpha`, over all sets that were weighed.
    pub intervals: [(f64, f64); 2],
    /// What stays without a name beside the likeliest set: root mean square as a share of the force, `mu` and
    /// `alpha` fitted again; none where nothing stays.
    pub remainder: Option<f64>,
    /// What that varies with, the largest first; what spots differ by among it.
    pub shows_in: Vec<&'static str>,
    /// What each group of discrepancies varies with, in the order of the sizes of a set's evidence.
    pub groups: Vec<&'static str>,
    /// Probability of every set that was weighed, the likeliest first.
    pub sets: Vec<f64>,
}

fn of_groups(search: &Search<'_>, groups: &[discrepancy::Group]) -> Discrepancy {
    let rows = search.problem.whitening.residuals();
    let columns = groups.iter().map(|group| &group.columns);
    Discrepancy::new(rows, columns, Sizes::about(SIZE.0, SIZE.1))
}

impl Judged {
    /// Of sets that were weighed; none where there is none.
    fn of(search: &Search<'_>, groups: &[discrepancy::Group], shares: &Shares<'_>) -> Option<Self> {
        let compared = shares.sets();
        if compared.is_empty() {
            return None;
        }
        let codes = codes(&search.candidates);
        let number = |c: &Candidate| codes.iter().position(|code| *code == c.effect.code).unwrap_or(codes.len());
        let members = |set: &Weighed| set.fit.candidates.iter().map(number).collect();
        let sets: Vec<Set> = compared.iter().map(|set| Set { members: members(set), log: set.log }).collect();
        let beliefs = Beliefs::of(&sets, codes.len());
        let mut told: Vec<Belief> = codes
            .iter()
            .zip(&beliefs.members)
            .map(|(code, probability)| Belief {
                code,
                probability: *probability,
                explains: (*probability > OF_NOTE).then(|| shares.of(&[*code])).flatten(),
            })
            .collect();
        told.sort_by(|a, b| b.probability.total_cmp(&a.probability));
        let is_sure = nothing_wrong(compared, &beliefs.sets) < (-SURE).exp();
        let any = |of: &[&'static str]| {
            let numbers: Vec<usize> =
                codes.iter().enumerate().filter(|(_, c)| of.contains(c)).map(|(at, _)| at).collect();
            beliefs.any(&sets, &numbers)
        };
        let Conclusion { verdict, findings, partly, explains } = concluded(&told, is_sure, |of| shares.of(of), any);
        let explained_n = shares.explained_n(&findings.concat());
        let kinds = kinds(&search.candidates, any);
        Some(Self {
            verdict,
            findings,
            beliefs: told,
            kinds,
            partly,
            explains,
            explained_n,
            intervals: intervals(compared, shares.discrepancy()),
            remainder: shares.left_share(),
            shows_in: shares.left_over(groups),
            groups: groups.iter().map(|group| group.over).collect(),
            sets: beliefs.sets,
        })
    }

    /// Takes the names back: they stay as what is there in part.
    pub fn withdraw(&mut self) {
        self.verdict = Verdict::Unknown;
        self.partly = std::mem::take(&mut self.findings);
    }

    /// The discrepancies beside a set: what each varies with, and its size as a share of the force.
    pub fn beside<'s>(&'s self, set: &'s Weighed) -> impl Iterator<Item = (&'static str, f64)> + 's {
        let sizes = self.groups.iter().copied().zip(set.evidence.sizes.iter().copied());
        sizes.filter(|(_, size)| *size > 0.0)
    }

    /// Probability of a code, and the share of the misfit that it explains alone.
    #[must_use]
    pub fn belief(&self, code: &str) -> Option<&Belief> {
        self.beliefs.iter().find(|belief| belief.code == code)
    }
}

/// Probability that nothing is wrong, over that of all sets: of the base without a discrepancy.
fn nothing_wrong(compared: &[Weighed], probabilities: &[f64]) -> f64 {
    let base = compared.iter().zip(probabilities).find(|(set, _)| set.fit.candidates.is_empty());
    base.map_or(0.0, |(base, probability)| probability * (base.evidence.alone - base.log).exp())
}

/// 95 % intervals of `mu` (MPa) and `alpha`: of the mixture of all sets, discrepancies allowed for, those
/// of sizes that do not show among them.
fn intervals(compared: &[Weighed], discrepancy: &Discrepancy) -> [(f64, f64); 2] {
    const TAIL: f64 = 0.025;
    /// How far (logarithm) behind the likeliest a set may lie to count.
    const COUNTS: f64 = 7.0;
    let likely: Vec<&Weighed> = compared.iter().filter(|set| set.log > compared[0].log - COUNTS).collect();
    let more: Vec<Vec<f64>> =
        likely.par_iter().map(|set| of_unknown_sizes(&set.linearised(), discrepancy, &set.evidence)).collect();
    std::array::from_fn(|at| {
        let part = |(set, more): (&&Weighed, &Vec<f64>)| {
            let (mean, deviation) = (set.evidence.x[at], set.evidence.deviations[at].hypot(more[at].sqrt()));
            let part = Part { weight: set.log, mean, deviation: deviation.max(f64::MIN_POSITIVE) };
            [part.weight, part.mean, part.deviation].iter().all(|v| v.is_finite()).then_some(part)
        };
        let parts: Vec<Part> = likely.iter().zip(&more).filter_map(part).collect();
        let coordinate = &compared[0].fit.coordinates[at];
        let (low, high) = coordinate.bounds();
        let end = |share: f64| coordinate.value(quantile(&parts, share).clamp(low, high));
        (end(TAIL), end(1.0 - TAIL))
    })
}

/// Probability that something of each kind is there, the likeliest first.
fn kinds(candidates: &[Candidate], any: impl Fn(&[&'static str]) -> f64) -> Vec<(Kind, f64)> {
    let mut kinds: Vec<Kind> = Vec::new();
    for candidate in candidates {
        if !kinds.contains(&candidate.effect.kind) {
            kinds.push(candidate.effect.kind);
        }
    }
    let of = |kind: Kind| -> Vec<&'static str> {
        candidates.iter().filter(|c| c.effect.kind == kind).map(|c| c.effect.code).collect()
    };
    let mut told: Vec<(Kind, f64)> = kinds.into_iter().map(|kind| (kind, any(&of(kind)))).collect();
    told.sort_by(|a, b| b.1.total_cmp(&a.1));
    told
}

/// Codes of all candidates, each once.
fn codes(candidates: &[Candidate]) -> Vec<&'static str> {
    let mut codes: Vec<&'static str> = Vec::new();
    for candidate in candidates {
        if !codes.contains(&candidate.effect.code) {
            codes.push(candidate.effect.code);
        }
    }
    codes
}
