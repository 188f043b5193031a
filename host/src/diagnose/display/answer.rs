//! The answer of `palpate diagnose` about a display as JSON.

use serde_json::{Map, Value, json};

use super::fit::Estimate;
use super::search::Explanation;
use super::{ChannelDiagnosis, Diagnosis, Evidence, Finding};
use crate::diagnose::Verdict;
use crate::infer::covariance::Z95;

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
    // where names compete, only a run that separates them is the next one
    let open: Vec<_> = all().filter(|c| c.verdict == Verdict::Ambiguous).map(|c| c.channel).collect();
    let next = proposals.iter().find(|(channel, _)| open.is_empty() || open.contains(channel));
    let told = |(channel, p): &(super::channel::Channel, &super::plan::Proposal)| json!({ "channel": channel.word(), "what": p.what, "decides": p.decides, "distance": p.distance });
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
        "base": { "parameters": evidence.map(|(_, e)| parameters(&e.base.estimates(None, Z95))) },
        "extended": { "parameters": evidence.and_then(|(c, e)| extended(c, e)).map(|e| parameters(&e.fit.estimates(None, Z95))) },
        "channels": all().map(channel).collect::<Vec<_>>(),
        "report": report,
        "seconds": diagnosis.seconds,
    })
}

fn effect(finding: &Finding) -> Value {
    json!({ "code": finding.code, "form": finding.form, "parameters": parameters(&finding.parameters) })
}

fn parameters(list: &[Estimate]) -> Map<String, Value> {
    let one = |(name, value, (low, high)): &Estimate| {
        ((*name).to_owned(), json!({ "value": value, "interval95": [low, high] }))
    };
    list.iter().map(one).collect()
}

fn extended<'a>(channel: &ChannelDiagnosis, evidence: &'a Evidence) -> Option<&'a Explanation> {
    let named = matches!(channel.verdict, Verdict::Named | Verdict::Ambiguous);
    evidence.held.first().filter(|_| named)
}

/// Errors on left-out commands; their keys carry the channel's unit.
fn held_out(channel: &ChannelDiagnosis, evidence: &Evidence) -> Option<Value> {
    let held_out = evidence.held_out.as_ref()?;
    let unit = channel.channel.unit();
    Some(json!({
        "channel": channel.channel.word(),
        format!("rmse_{unit}_before"): held_out.rmse_before,
        format!("rmse_{unit}_after"): held_out.rmse_after,
        "conditions": held_out.conditions,
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
        "candidates": evidence.map_or_else(Vec::new, |e| e.singles.iter().map(|s| candidate(e, s)).collect()),
        "held_out": evidence.and_then(|e| held_out(one, e)),
        "base": { "parameters": evidence.map(|e| parameters(&e.base.estimates(None, Z95))) },
        "extended": { "parameters": evidence.and_then(|e| extended(one, e)).map(|e| parameters(&e.fit.estimates(None, Z95))) },
        "messages": one.messages,
    })
}

/// What one effect alone explains, and which demands it meets. `leaves` is the largest margin over its threshold.
fn candidate(evidence: &Evidence, single: &Explanation) -> Value {
    let effects = single.fit.effects();
    let effect = effects.first();
    let excess = evidence.base.square - evidence.base.residual.len() as f64;
    json!({
        "code": effect.map(|e| e.code),
        "form": effect.map(|e| e.form),
        "explains": (evidence.base.square - single.fit.square) / excess.max(1.0),
        "score": single.score(),
        "leaves": single.adequacy.worst(),
        "beats_noise": single.beats_noise,
        "predicts": single.predicts,
        "beats_placebo": single.beats_placebo,
        "in_bounds": !single.fit.at_bound,
    })
}
