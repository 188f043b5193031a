//! The answer of `palpate diagnose` about a material that is compressed only, as JSON.

use serde_json::{Map, Value, json};

use super::Diagnosis;
use crate::diagnose::finding::Finding;
use crate::diagnose::sets::{Judged, Weighed};

/// The keys of the contract.
#[must_use]
pub fn json(found: &Diagnosis, report: Option<&str>) -> Value {
    let evidence = found.evidence.as_deref();
    let judged = evidence.map(|e| &e.judged);
    json!({
        "material": found.material,
        "verdict": found.verdict.word(),
        "reason": found.refusal.as_ref().map(ToString::to_string),
        "effects": found.findings.iter().map(effect).collect::<Vec<_>>(),
        "ambiguous_with": found.findings.iter().map(|f| &f.ambiguous_with).collect::<Vec<_>>(),
        "shows_in": found.shows_in,
        "blind_to": found.blind_to,
        "next_experiment": Value::Null,
        "held_out": evidence.and_then(|e| e.held_out.as_ref()).filter(|_| !found.findings.is_empty()).map(|h| json!({
            "rmse_N_before": h.before_n, "rmse_N_after": h.after_n, "conditions": h.left_out,
        })),
        "kinds": judged.map_or_else(Vec::new, |judged| judged.kinds().iter().map(|(kind, p)| json!({ "kind": kind.words(), "probability": p })).collect()),
        "candidates": judged.map_or_else(Vec::new, |judged| judged.beliefs.iter().map(|b| json!({ "code": b.name, "probability": b.probability, "explains": b.explains })).collect()),
        "partly": judged.map(|judged| &judged.partly),
        "explains": judged.and_then(|judged| judged.explains),
        "remainder": judged.map(|judged| json!({ "percent": judged.remainder.map_or(0.0, |share| 100.0 * share), "shows_in": judged.shows_in })),
        "wider_priors": judged.map(Judged::sensitivity),
        "sets": evidence.map_or_else(Vec::new, |e| sets(&e.sets, &e.judged)),
        "base": { "parameters": evidence.map(|e| elastic(&e.base)) },
        "extended": { "parameters": evidence.and_then(|e| e.held.first()).map(elastic) },
        "messages": found.messages,
        "report": report,
        "seconds": found.seconds,
    })
}

fn sets(all: &[Weighed], judged: &Judged) -> Vec<Value> {
    const MOST: usize = 6;
    let each = all.iter().zip(&judged.members).zip(&judged.sets).take(MOST);
    each.map(|((set, codes), probability)| {
        let beside = judged.beside(set).map(|(over, size)| json!({ "over": over, "percent": 100.0 * size }));
        json!({ "effects": codes, "probability": probability, "beside": beside.collect::<Vec<_>>() })
    })
    .collect()
}

/// `mu` and `alpha` of a set, with what noise and discrepancy leave open.
fn elastic(set: &Weighed) -> Value {
    let one = |at: usize| {
        let (x, half) = (set.evidence.x[at], crate::infer::covariance::Z95 * set.evidence.deviations[at]);
        json!({ "value": x.exp(), "interval95": [(x - half).exp(), (x + half).exp()] })
    };
    json!({ "mu_MPa": one(0), "alpha": one(1) })
}

fn effect(finding: &Finding) -> Value {
    let one = |(name, value, (low, high)): &(&'static str, f64, (f64, f64))| {
        ((*name).to_owned(), json!({ "value": value, "interval95": [low, high] }))
    };
    json!({
        "code": finding.code, "form": finding.form, "kind": finding.kind.words(),
        "probability": finding.probability, "explains": finding.explains,
        "parameters": finding.parameters.iter().map(one).collect::<Map<String, Value>>(),
    })
}
