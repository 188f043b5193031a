//! The answer of `palpate diagnose` as JSON.

use serde_json::{Value, json};

use super::plan::On;
use super::sets::{Judged, Weighed};
use super::{Diagnosis, Estimate, Evidence};
use crate::infer::unseen::{self, Widening};

/// One material's answer; keys as in the contract, `material`, `faults`, `reason` and `messages` added.
#[must_use]
pub fn json(diagnosis: &Diagnosis, report: Option<&str>) -> Value {
    let effects: Vec<Value> = diagnosis
        .findings
        .iter()
        .map(|finding| {
            let parameters: serde_json::Map<String, Value> = finding
                .parameters
                .iter()
                .map(|(name, value, (low, high))| {
                    ((*name).to_owned(), json!({ "value": value, "interval95": [low, high] }))
                })
                .collect();
            json!({
                "code": finding.code, "form": finding.form, "of": finding.of, "parameters": parameters,
                "kind": finding.kind.words(), "probability": finding.probability, "explains": finding.explains,
            })
        })
        .collect();
    let ambiguous: Vec<&Vec<&str>> = diagnosis.findings.iter().map(|f| &f.ambiguous_with).collect();
    let evidence = diagnosis.evidence.as_deref();
    let held_out = diagnosis.held_out();
    let extended = diagnosis.extended();
    let proposals = proposals(diagnosis);
    let judged = evidence.map(|e| &e.judged);
    let faults: Vec<Value> =
        diagnosis.faults.iter().map(|f| json!({ "code": f.code(), "what": f.to_string() })).collect();
    json!({
        "material": diagnosis.material,
        "verdict": diagnosis.verdict.word(),
        "effects": effects,
        "ambiguous_with": ambiguous,
        "shows_in": diagnosis.shows_in,
        "blind_to": diagnosis.blind_to,
        "cannot_exclude": diagnosis.cancelling,
        "next_experiment": diagnosis.proposals.first().map(|p| json!({ "what": p.what, "decides": p.decides })),
        "proposals": proposals,
        "candidates": judged.map_or_else(Vec::new, candidates),
        "kinds": judged.map_or_else(Vec::new, kinds),
        "sets": evidence.map_or_else(Vec::new, sets),
        "partly": judged.map(|j| &j.partly),
        "explains": judged.and_then(|j| j.explains),
        "remainder": judged.map(remainder),
        "wider_priors": judged.map(Judged::sensitivity),
        "faults": faults,
        "reason": diagnosis.refusal.as_ref().map(ToString::to_string),
        "held_out": held_out.map(|h| json!({
            "rmse_N_before": h.rmse_before_n, "rmse_N_after": h.rmse_after_n,
            "percent_of_peak_before": h.percent_of_peak().0, "percent_of_peak_after": h.percent_of_peak().1,
            "conditions": h.conditions,
        })),
        "base": { "parameters": evidence.map(|e| parameters(e.before.parameters, e.before.of_noise, e.before.unseen.as_ref())) },
        "extended": { "parameters": evidence.zip(extended).and_then(|(e, all)| {
            Some(parameters(all, e.extended_of_noise()?, e.held.first()?.fit.unseen.as_ref()))
        }) },
        "messages": diagnosis.messages,
        "report": report,
        "seconds": diagnosis.seconds,
    })
}

/// What is worth doing next for one material, the best first; `distance` in standard deviations of all that is not known.
#[must_use]
pub fn plan(diagnosis: &Diagnosis) -> Value {
    json!({
        "material": diagnosis.material,
        "verdict": diagnosis.verdict.word(),
        "effects": diagnosis.findings.iter().map(|f| f.code).collect::<Vec<_>>(),
        "ambiguous_with": diagnosis.findings.iter().map(|f| &f.ambiguous_with).collect::<Vec<_>>(),
        "blind_to": diagnosis.blind_to,
        "cannot_exclude": diagnosis.cancelling,
        "proposals": proposals(diagnosis),
        "reason": diagnosis.refusal.as_ref().map(ToString::to_string),
        "seconds": diagnosis.seconds,
    })
}

fn proposals(diagnosis: &Diagnosis) -> Vec<Value> {
    let one = |p: &super::plan::Proposal| {
        let motion = json!({
            "rate_mm_per_s": p.motion.rate_mm_per_s, "depth_mm": p.motion.depth_mm, "hold_s": p.motion.hold_s,
            "unload": p.motion.unload, "cycles": p.motion.cycles,
            "times_height": p.motion.height, "times_radius": p.motion.radius,
            "on": on(p.motion.on),
        });
        json!({ "what": p.what, "decides": p.decides, "distance": p.distance, "motion": motion })
    };
    diagnosis.proposals.iter().map(one).collect()
}

/// What is pressed or loads the sensor, and how much of it where there is a choice.
fn on(on: On) -> Value {
    match on {
        On::Specimen => json!({ "test": "indentation" }),
        On::Block(load_n) => json!({ "test": "indentation", "base_law": "rigid", "load_N": load_n }),
        On::Mass(load_n) => json!({ "test": "mass", "load_N": load_n }),
        On::Air => json!({ "test": "air" }),
        On::Confined(diameter_mm) => json!({ "test": "confined", "diameter_mm": diameter_mm }),
    }
}

/// Every effect that was tried, the likeliest first.
fn candidates(judged: &Judged) -> Vec<Value> {
    let each = judged.beliefs.iter();
    each.map(|b| json!({ "code": b.name, "probability": b.probability, "explains": b.explains })).collect()
}

fn kinds(judged: &Judged) -> Vec<Value> {
    judged.kinds().iter().map(|(kind, p)| json!({ "kind": kind.words(), "probability": p })).collect()
}

/// The likeliest sets, each with its probability and the discrepancies beside it, percent of the force.
fn sets(evidence: &Evidence) -> Vec<Value> {
    const MOST: usize = 10;
    let judged = &evidence.judged;
    let one = |(set, probability): (&Weighed, &f64)| {
        let effects: Vec<Value> =
            set.fit.candidates.iter().map(|c| json!({ "code": c.effect.code, "form": c.effect.form })).collect();
        let beside = judged.beside(set).map(|(over, size)| json!({ "over": over, "percent": 100.0 * size }));
        let beside: Vec<Value> = beside.collect();
        json!({ "effects": effects, "probability": probability, "beside": beside })
    };
    evidence.sets.iter().zip(&judged.sets).take(MOST).map(one).collect()
}

/// What stays without a name, in percent of the force, and what it varies with.
fn remainder(judged: &Judged) -> Value {
    json!({ "percent": judged.remainder.map_or(0.0, |share| 100.0 * share), "shows_in": judged.shows_in })
}

/// Parameters with their intervals, those of noise alone, and what widened them in a fit.
fn parameters(all: [Estimate; 2], noise: [Estimate; 2], unseen: Option<&Widening>) -> Value {
    let one = |at: usize| {
        let ((value, (low, high)), (_, (least, most))) = (all[at], noise[at]);
        let by = unseen.map_or_else(|| json!([]), |widened| unseen::json(&widened.by[at]));
        json!({ "value": value, "interval95": [low, high], "interval95_noise": [least, most], "widened_by": by })
    };
    json!({ "mu_MPa": one(0), "alpha": one(1) })
}
