//! The answer of `palpate diagnose` about a display as JSON.

use serde_json::{Map, Value, json};

use super::channel::Channel;
use super::fit::Estimate;
use super::plan::Proposal;
use super::{ChannelDiagnosis, Diagnosis, Evidence, Finding, Judged};
use crate::diagnose::Verdict;

/// The keys of the contract over all channels, and every channel by itself under `channels`.
#[must_use]
pub fn json(diagnosis: &Diagnosis, report: Option<&str>) -> Value {
    let all = || diagnosis.channels.iter();
    let findings: Vec<&Finding> = all().flat_map(|c| &c.findings).collect();
    let of = |words: fn(&ChannelDiagnosis) -> &Vec<&'static str>| all().flat_map(words).copied().collect::<Vec<_>>();
    let mut shows_in = of(|c| &c.shows_in);
    shows_in.sort_unstable();
    shows_in.dedup();
    let mut proposals: Vec<_> = all().flat_map(|c| c.proposals.iter().map(move |p| (c.channel, p))).collect();
    proposals.sort_by(|a, b| b.1.distance.total_cmp(&a.1.distance));
    // where names compete or none is sure, only a run that separates them is the next one
    let is_open = |c: &&ChannelDiagnosis| matches!(c.verdict, Verdict::Ambiguous | Verdict::Unknown);
    let open: Vec<_> = all().filter(is_open).filter(|c| !c.proposals.is_empty()).map(|c| c.channel).collect();
    let next = proposals.iter().find(|(channel, _)| open.is_empty() || open.contains(channel));
    let told = |(channel, p): &(Channel, &Proposal)| proposal(*channel, p);
    let judged = all().find(|c| !c.findings.is_empty()).or(diagnosis.channels.first());
    let evidence = judged.and_then(|c| c.evidence.as_deref().map(|e| (c, e)));
    json!({
        "verdict": diagnosis.verdict.word(),
        "effects": findings.iter().map(|f| effect(f)).collect::<Vec<_>>(),
        "ambiguous_with": findings.iter().map(|f| &f.ambiguous_with).collect::<Vec<_>>(),
        "shows_in": shows_in,
        "blind_to": of(|c| &c.blind_to),
        "next_experiment": next.map(told),
        "proposals": proposals.iter().map(told).collect::<Vec<_>>(),
        "held_out": evidence.and_then(|(c, e)| held_out(c, e)),
        "base": { "parameters": evidence.map(|(_, e)| parameters(&e.base.estimates(None))) },
        "extended": { "parameters": evidence.and_then(|(_, e)| e.held.first()).map(|e| parameters(&e.estimates(None))) },
        "channels": all().map(channel).collect::<Vec<_>>(),
        "report": report,
        "seconds": diagnosis.seconds,
    })
}

fn proposal(channel: Channel, proposal: &Proposal) -> Value {
    let Proposal { what, decides, distance, command } = proposal;
    let mut numbers = json!({ "values": command.values, "hold_s": command.hold_s, "ramp_s": command.ramp_s });
    if channel == Channel::Fluid {
        numbers["yield_parts"] = json!(command.yield_parts);
    }
    if let Some(gap_mm) = command.gap_mm {
        numbers["gap_mm"] = json!(gap_mm);
    }
    json!({ "channel": channel.word(), "what": what, "decides": decides, "distance": distance, "command": numbers })
}

fn effect(finding: &Finding) -> Value {
    json!({
        "code": finding.code, "form": finding.form, "probability": finding.probability, "explains": finding.explains,
        "parameters": parameters(&finding.parameters),
    })
}

fn parameters(list: &[Estimate]) -> Map<String, Value> {
    let one = |(name, value, (low, high)): &Estimate| {
        ((*name).to_owned(), json!({ "value": value, "interval95": [low, high] }))
    };
    list.iter().map(one).collect()
}

/// Errors on left-out commands; their keys carry the channel's unit.
fn held_out(channel: &ChannelDiagnosis, evidence: &Evidence) -> Option<Value> {
    let held_out = evidence.held_out.as_ref()?;
    let unit = channel.channel.unit();
    Some(json!({
        "channel": channel.channel.word(),
        format!("rmse_{unit}_before"): held_out.rmse_before,
        format!("rmse_{unit}_after"): held_out.rmse_after,
        // of the law alone: without what a run's own gain, zero and time make of it
        "of_law": {
            format!("rmse_{unit}_before"): held_out.of_law.0,
            format!("rmse_{unit}_after"): held_out.of_law.1,
        },
        "conditions": held_out.conditions,
        "repeated": held_out.gain.map(|gain| json!({
            format!("rmse_{unit}_before"): gain.before,
            format!("rmse_{unit}_after"): gain.after,
            "gain": gain.part(),
            "gain_interval95": [gain.part95.0.is_finite().then_some(gain.part95.0), Some(gain.part95.1)],
        })),
    }))
}

fn channel(one: &ChannelDiagnosis) -> Value {
    let evidence = one.evidence.as_deref();
    json!({
        "channel": one.channel.word(),
        "verdict": one.verdict.word(),
        "reason": one.refusal.as_ref().map(ToString::to_string),
        "effects": one.findings.iter().map(effect).collect::<Vec<_>>(),
        "ambiguous_with": one.findings.iter().map(|f| &f.ambiguous_with).collect::<Vec<_>>(),
        "shows_in": one.shows_in,
        "blind_to": one.blind_to,
        "noise": evidence.map(|e| json!({
            "sigma": e.noise.sensor.sigma, "white": e.noise.sensor.white, "correlation_s": e.noise.sensor.correlation_s,
            "relative": e.noise.sensor.relative, "gain_jitter": e.noise.jitter.gain, "zero_jitter": e.noise.jitter.zero,
            "slide_jitter": e.noise.jitter.slide, "unit": one.channel.unit(),
        })),
        "candidates": evidence.map_or_else(Vec::new, |e| candidates(&e.judged)),
        "sets": evidence.map_or_else(Vec::new, sets),
        "partly": evidence.map(|e| &e.judged.partly),
        "explains": evidence.and_then(|e| e.judged.explains),
        "nothing_wrong": evidence.map(|e| e.judged.nothing),
        "remainder": evidence.map(|e| remainder(&e.judged)),
        "wider_priors": evidence.map(|e| e.judged.sensitivity()),
        "held_out": evidence.and_then(|e| held_out(one, e)),
        "base": { "parameters": evidence.map(|e| parameters(&e.base.estimates(None))) },
        "extended": { "parameters": evidence.and_then(|e| e.held.first()).map(|e| parameters(&e.estimates(None))) },
        "messages": one.messages,
    })
}

/// Every effect with its probability, the likeliest first.
fn candidates(judged: &Judged) -> Vec<Value> {
    let each = judged.beliefs.iter();
    each.map(|b| json!({ "code": b.name, "probability": b.probability, "explains": b.explains })).collect()
}

/// The likeliest sets: their effects, and the discrepancies beside them.
fn sets(evidence: &Evidence) -> Vec<Value> {
    const MOST: usize = 6;
    let judged = &evidence.judged;
    let each = evidence.sets.iter().zip(&judged.members).zip(&judged.sets).take(MOST);
    each.map(|((set, codes), probability)| {
        let beside = judged.beside(set).map(|(over, size)| json!({ "over": over, "percent": 100.0 * size }));
        json!({ "effects": codes, "probability": probability, "beside": beside.collect::<Vec<_>>() })
    })
    .collect()
}

fn remainder(judged: &Judged) -> Value {
    json!({ "percent": judged.remainder.map_or(0.0, |share| 100.0 * share), "shows_in": judged.shows_in })
}
