//! The second edition of the verdict, in shadow beside the first: every explanation that was tried,
//! compared by its evidence, a discrepancy of unknown size in each of them, the base included
//! (`docs/decisions/0005-one-model.md`).

mod discrepancy;
mod search;
mod weigh;

use lut_gen::effect::Kind;
use serde_json::{Value, json};

use super::coordinate::Candidate;
use super::finding::Verdict;
use super::fit::{explained, freedom};
use super::search::{Explanation, Search};
use crate::infer::compare::{Beliefs, Set};
use crate::infer::evidence::{Discrepancy, Sizes};
use weigh::Weighed;

/// Size of a discrepancy, as a share of the force: as often above as below, and a factor of 2.7 to
/// either side. Simulations of soft solids agree with tests to about a percent.
const SIZE: (f64, f64) = (0.005, 1.0);
/// Probability from which the first effect has its name, and each further one; below which an
/// effect is of no account.
const NAMED: f64 = 0.99;
const NAMED_TOO: f64 = 0.999;
const NO_ACCOUNT: f64 = 0.5;
/// Share of the misfit that what is named must explain, and what each further name must add:
/// evidence alone is not importance.
const EXPLAINS: f64 = 0.7;
const ADDS: f64 = 0.05;
/// Names that may stand for one cause.
const MOST_TWINS: usize = 3;

/// What is believed of one effect.
#[derive(Debug, Clone, PartialEq)]
pub struct Belief {
    /// Its code.
    pub code: &'static str,
    /// Probability that it is there.
    pub probability: f64,
    /// Share of the misfit that it explains alone, where it was tried alone and there is a misfit.
    pub explains: Option<f64>,
}

/// The second edition's answer.
#[derive(Debug, Clone, PartialEq)]
pub struct Second {
    /// The verdict.
    pub verdict: Verdict,
    /// Names of the verdict: those that hold, or the twins that share one cause.
    pub names: Vec<&'static str>,
    /// Effects that were tried, the likeliest first.
    pub beliefs: Vec<Belief>,
    /// Kinds of effects with the probability that one of them is there, the likeliest first.
    pub kinds: Vec<(Kind, f64)>,
    /// Effects that are there and explain too little to be the name.
    pub partly: Vec<&'static str>,
    /// Share of the misfit that the names, the twins or these explain.
    pub explains: Option<f64>,
    /// Discrepancies beside it, as a share of the force, by what they vary with; the largest first.
    pub remainder: Vec<(&'static str, f64)>,
}

/// Judges what was tried and what the evidence leads to; none where nothing can be compared.
#[must_use]
pub fn judged(search: &Search<'_>, tried: &[&Explanation]) -> Option<Second> {
    let groups = discrepancy::groups(&search.problem, &search.curves);
    let (over, columns): (Vec<_>, Vec<_>) = groups.into_iter().map(|group| (group.over, group.columns)).unzip();
    let rows = search.problem.whitening.residuals();
    let discrepancy = Discrepancy::new(rows, &columns, Sizes::about(SIZE.0, SIZE.1));
    let compared = search::led(search, tried, &discrepancy);
    let codes = codes(&search.candidates);
    let number = |c: &Candidate| codes.iter().position(|code| *code == c.effect.code).unwrap_or(codes.len());
    let members = |set: &Weighed| set.fit.candidates.iter().map(number).collect();
    let sets: Vec<Set> = compared.iter().map(|set| Set { members: members(set), log: set.log }).collect();
    let beliefs = Beliefs::of(&sets, codes.len());
    let best = compared.iter().max_by(|a, b| a.log.total_cmp(&b.log))?;
    let base_square = compared.iter().find(|set| set.fit.candidates.is_empty())?.fit.square;
    let expected = freedom(&search.problem.used, &search.base);
    let share = |set: &Weighed| explained(base_square, expected, set.fit.square);
    let alone = |code: &str| {
        let own = compared.iter().filter(|set| set.fit.candidates.len() == 1 && set.fit.codes().eq([code]));
        own.filter_map(share).max_by(f64::total_cmp)
    };
    let mut told: Vec<Belief> = codes
        .iter()
        .zip(&beliefs.members)
        .map(|(code, probability)| Belief { code, probability: *probability, explains: alone(code) })
        .collect();
    told.sort_by(|a, b| b.probability.total_cmp(&a.probability));
    let mut remainder: Vec<(&'static str, f64)> =
        over.into_iter().zip(best.evidence.sizes.iter().copied()).filter(|(_, a)| *a > 0.0).collect();
    remainder.sort_by(|a, b| b.1.total_cmp(&a.1));
    let within = |of: &[&'static str]| {
        let is_own = |set: &&Weighed| !set.fit.candidates.is_empty() && set.fit.codes().all(|c| of.contains(&c));
        compared.iter().filter(is_own).filter_map(share).max_by(f64::total_cmp)
    };
    let any = |of: &[&'static str]| {
        let numbers: Vec<usize> = codes.iter().enumerate().filter(|(_, c)| of.contains(c)).map(|(at, _)| at).collect();
        beliefs.any(&sets, &numbers)
    };
    let Conclusion { verdict, names, partly, explains } = concluded(&told, !remainder.is_empty(), within, any);
    let kinds = kinds(&search.candidates, any);
    Some(Second { verdict, names, beliefs: told, kinds, partly, explains, remainder })
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

/// What is said of what is believed.
#[derive(Debug, PartialEq)]
struct Conclusion {
    verdict: Verdict,
    names: Vec<&'static str>,
    partly: Vec<&'static str>,
    explains: Option<f64>,
}

/// The verdict of what is believed. `share` is what the best set of some effects explains of the
/// misfit, `any` the probability that one of them is there.
fn concluded(
    told: &[Belief],
    has_remainder: bool,
    share: impl Fn(&[&'static str]) -> Option<f64>,
    any: impl Fn(&[&'static str]) -> f64,
) -> Conclusion {
    let mut certain: Vec<&'static str> = Vec::new();
    let mut believed: Vec<&Belief> = told.iter().filter(|b| b.probability > NAMED).collect();
    believed.sort_by(|a, b| b.explains.unwrap_or(0.0).total_cmp(&a.explains.unwrap_or(0.0)));
    for belief in believed {
        let with: Vec<&'static str> = certain.iter().copied().chain([belief.code]).collect();
        let adds = share(&with).unwrap_or(0.0) - share(&certain).unwrap_or(0.0);
        if certain.is_empty() || (belief.probability > NAMED_TOO && adds > ADDS) {
            certain = with;
        }
    }
    let explains = share(&certain);
    let is_enough = |explains: Option<f64>| explains.is_some_and(|share| share >= EXPLAINS);
    if !certain.is_empty() {
        let named = is_enough(explains);
        let (names, partly) = if named { (certain, Vec::new()) } else { (Vec::new(), certain) };
        return Conclusion { verdict: if named { Verdict::Named } else { Verdict::Unknown }, names, partly, explains };
    }
    let twins: Vec<&'static str> = told.iter().take(MOST_TWINS).map(|b| b.code).collect();
    let fewest = (2..=twins.len()).map(|count| twins[..count].to_vec()).find(|few| any(few) > NAMED);
    if let Some(few) = fewest.filter(|few| is_enough(share(few))) {
        let explains = share(&few);
        return Conclusion { verdict: Verdict::Ambiguous, names: few, partly: Vec::new(), explains };
    }
    let likely = told.first().is_some_and(|b| b.probability > NO_ACCOUNT);
    let verdict = if likely || has_remainder { Verdict::Unknown } else { Verdict::Clean };
    Conclusion { verdict, names: Vec::new(), partly: Vec::new(), explains: None }
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

/// The answer as JSON.
#[must_use]
pub fn json(second: &Second) -> Value {
    let effects: Vec<Value> = second
        .beliefs
        .iter()
        .map(|b| json!({ "code": b.code, "probability": b.probability, "explains": b.explains }))
        .collect();
    let kinds: Vec<Value> =
        second.kinds.iter().map(|(kind, p)| json!({ "kind": kind.words(), "probability": p })).collect();
    let remainder: Vec<Value> =
        second.remainder.iter().map(|(over, size)| json!({ "shows_in": over, "percent": 100.0 * size })).collect();
    json!({
        "verdict": second.verdict.word(),
        "names": second.names,
        "partly": second.partly,
        "effects": effects,
        "kinds": kinds,
        "explains": second.explains,
        "remainder": remainder,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn belief(code: &'static str, probability: f64) -> Belief {
        Belief { code, probability, explains: None }
    }

    #[test]
    fn names_need_belief_and_a_share() {
        let lag = [belief("lag", 0.999), belief("drift", 0.1)];
        let all = |_: &[&'static str]| 0.999;
        let said = |told: &[Belief], share: f64, any: f64| {
            let found = concluded(told, false, |of| (!of.is_empty()).then_some(share), |_| any);
            (found.verdict, found.names, found.partly)
        };
        assert_eq!(said(&lag, 0.9, 1.0), (Verdict::Named, vec!["lag"], vec![]));
        assert_eq!(said(&lag, 0.5, 1.0), (Verdict::Unknown, vec![], vec!["lag"]));
        let twins = [belief("lag", 0.6), belief("drift", 0.395), belief("radius", 0.001)];
        assert_eq!(said(&twins, 0.9, 0.999), (Verdict::Ambiguous, vec!["lag", "drift"], vec![]));
        assert_eq!(said(&twins, 0.9, 0.98).0, Verdict::Unknown);
        // a second name that adds nothing is none
        let two = [belief("lag", 0.9999), belief("drift", 0.9999)];
        let one = concluded(&two, false, |of| Some(if of.contains(&"lag") { 0.9 } else { 0.0 }), all);
        assert_eq!(one.names, ["lag"]);
        let both = concluded(&two, false, |of| Some(0.45 * of.len() as f64), all);
        assert_eq!(both.names.len(), 2);
    }

    #[test]
    fn without_a_likely_effect_the_remainder_decides() {
        let none = [belief("lag", 0.2)];
        let said = |told: &[Belief], has_remainder| concluded(told, has_remainder, |_| None, |_| 0.0).verdict;
        assert_eq!(said(&none, false), Verdict::Clean);
        assert_eq!(said(&none, true), Verdict::Unknown);
        assert_eq!(said(&[], false), Verdict::Clean);
    }
}
