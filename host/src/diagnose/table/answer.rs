//! The answer of `palpate diagnose` about a table as JSON.

use serde_json::{Map, Value, json};

use super::{AllAlone, Alone, Diagnosis, Estimate, Finding, Judged, Proposal, Weighed};

/// The keys of the contract, with the test of lack of fit beside them.
#[must_use]
pub fn json(found: &Diagnosis, report: Option<&str>) -> Value {
    let evidence = found.evidence.as_ref();
    let judged = evidence.map(|e| &e.judged);
    json!({
        "verdict": found.verdict.word(),
        "reason": found.too_few.as_ref().map(ToString::to_string),
        "effects": found.findings.iter().map(effect).collect::<Vec<_>>(),
        "ambiguous_with": found.findings.iter().map(|f| &f.ambiguous_with).collect::<Vec<_>>(),
        "shows_in": found.shows_in,
        "blind_to": found.blind_to,
        "next_experiment": found.proposals.first().map(proposal),
        "proposals": found.proposals.iter().map(proposal).collect::<Vec<_>>(),
        "held_out": evidence.and_then(|e| e.held_out).map(|h| json!({ "rmse_y_before": h.before, "rmse_y_after": h.after, "conditions": "every x" })),
        "lack_of_fit": found.lack_of_fit.map(|test| json!({ "F": test.f, "freedom": [test.freedom.0, test.freedom.1], "p": test.probability, "repeats_y": test.repeats })),
        "line": found.line.as_ref().map(|line| json!({ "of": if found.table.is_simulated { "y less simulated" } else { "y" }, "zero": coefficient(line, 0), "slope": coefficient(line, 1) })),
        "noise_y": evidence.map(|e| e.sigma.0),
        "candidates": judged.map_or_else(Vec::new, |judged| judged.beliefs.iter().map(|b| json!({ "code": b.name, "probability": b.probability, "explains": b.explains })).collect()),
        "partly": judged.map(|judged| &judged.partly),
        "explains": judged.and_then(|judged| judged.explains),
        "remainder": judged.map(|judged| json!({ "percent": judged.remainder.map_or(0.0, |share| 100.0 * share), "shows_in": judged.shows_in })),
        "wider_priors": judged.map(Judged::sensitivity),
        "base": { "parameters": evidence.map(|e| parameters(&e.base.told(None))) },
        "extended": { "parameters": evidence.and_then(|e| e.held.first()).map(|best: &Weighed| parameters(&best.told(None))) },
        "alone": found.alone.as_ref().map(alone),
        "report": report,
        "seconds": found.seconds,
    })
}

fn alone(all: &AllAlone) -> Value {
    let part = |one: &Alone| json!({ "code": one.code, "amount": one.amount, "rmse_y_left": one.left });
    json!({
        "rmse_y_without": all.without, "parts": all.parts.iter().map(part).collect::<Vec<_>>(),
        "combinations": all.combinations, "alike": all.alike,
    })
}

fn coefficient(of: &crate::calibration::polynomial::Polynomial, power: usize) -> Value {
    let (low, high) = of.interval95(power);
    json!({ "value": of.coefficients[power].0, "interval95": [low, high], "p_none": of.probability(power, 0.0) })
}

fn effect(finding: &Finding) -> Value {
    json!({
        "code": finding.effect.code, "form": finding.effect.form,
        "probability": finding.probability, "explains": finding.explains, "parameters": parameters(&finding.parameters),
    })
}

fn proposal(one: &Proposal) -> Value {
    json!({ "what": one.what, "decides": one.decides, "distance": one.distance })
}

fn parameters(list: &[Estimate]) -> Map<String, Value> {
    let one = |(name, value, (low, high)): &Estimate| {
        ((*name).to_owned(), json!({ "value": value, "interval95": [low, high] }))
    };
    list.iter().map(one).collect()
}
