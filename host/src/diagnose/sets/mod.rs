//! Sets of effects of specimen and rig, compared by their evidence: a discrepancy of unknown size is in
//! each of them, the base included (`docs/decisions/0005-one-model.md`).

mod discrepancy;
mod forward;
mod found;
mod misfit;
mod solve;

use lut_gen::effect::{CATALOGUE, Kind};

use super::coordinate::Coordinate;
use super::finding::{Finding, Verdict};
use super::fit::Fit;
use crate::infer::sets::{Outcome, Told};

pub use crate::infer::sets::Belief;
pub(super) use found::{Found, found};

/// A set of effects, fitted, with its evidence.
pub type Weighed = crate::infer::sets::Weighed<Fit>;

/// What is believed of the data; effects by their codes.
pub type Judged = crate::infer::sets::Judged<&'static str>;

impl From<Outcome> for Verdict {
    fn from(outcome: Outcome) -> Self {
        match outcome {
            Outcome::Clean => Self::Clean,
            Outcome::Named => Self::Named,
            Outcome::Ambiguous => Self::Ambiguous,
            Outcome::Unknown => Self::Unknown,
        }
    }
}

impl Judged {
    /// Kinds of effects with the probability that one of them is there, the likeliest first.
    #[must_use]
    pub fn kinds(&self) -> Vec<(Kind, f64)> {
        let mut kinds: Vec<(Kind, Vec<&'static str>)> = Vec::new();
        for effect in CATALOGUE.iter().filter(|effect| self.belief(effect.code).is_some()) {
            match kinds.iter_mut().find(|(kind, _)| *kind == effect.kind) {
                Some((_, codes)) => codes.push(effect.code),
                None => kinds.push((effect.kind, vec![effect.code])),
            }
        }
        let mut told: Vec<(Kind, f64)> = kinds.into_iter().map(|(kind, codes)| (kind, self.any(&codes))).collect();
        told.sort_by(|a, b| b.1.total_cmp(&a.1));
        told
    }

    /// What priors twice as wide would say, as JSON.
    #[must_use]
    pub fn sensitivity(&self) -> serde_json::Value {
        let wider = &self.wider;
        let verdict = Verdict::from(wider.outcome).word();
        serde_json::json!({ "verdict": verdict, "effects": wider.findings, "same": wider.is_same })
    }

    /// The same in a sentence.
    #[must_use]
    pub fn sensitivity_told(&self) -> String {
        let wider = &self.wider;
        if wider.is_same {
            return "Priors and sizes of discrepancies twice as wide would say the same.".to_owned();
        }
        let each: Vec<String> = wider.findings.iter().map(|twins| twins.join(" or ")).collect();
        let names = if each.is_empty() { String::new() } else { format!(", {}", each.join(" and ")) };
        let verdict = Verdict::from(wider.outcome).word();
        format!("Priors and sizes of discrepancies twice as wide would say {verdict}{names}: the answer rests on them.")
    }

    /// 95 % intervals of `mu` (MPa) and `alpha`.
    pub(super) fn elastic(&self) -> [(f64, f64); 2] {
        let own = [Coordinate::LnMu, Coordinate::LnAlpha];
        std::array::from_fn(|at| {
            let (low, high) = self.intervals[at];
            (own[at].value(low), own[at].value(high))
        })
    }
}

/// What is named, of the likeliest set, each with what may stand in its place; `of` names what the effect at a place belongs to.
pub(super) fn findings(judged: &Judged, best: &Weighed, of: impl Fn(usize) -> Vec<String>) -> Vec<Finding> {
    let each = best.fit.candidates.iter().enumerate().map(|(at, candidate)| {
        let Told { probability, explains, twins } = judged.told(candidate.effect.code);
        Finding {
            code: candidate.effect.code,
            form: candidate.effect.form,
            kind: candidate.effect.kind,
            owner: candidate.owner,
            of: of(at),
            parameters: best.fit.quantities(at).into_iter().map(|(q, value, i)| (q.name, value, i)).collect(),
            ambiguous_with: twins,
            probability,
            explains,
        }
    });
    each.collect()
}
