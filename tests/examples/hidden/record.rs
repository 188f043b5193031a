//! Scored cases as JSON.

use serde_json::{Value, json};
use tests::score::Scored;

/// One object a case.
pub fn records(scored: &[Scored]) -> Vec<Value> {
    scored.iter().map(record).collect()
}

fn record(s: &Scored) -> Value {
    let findings: Vec<Value> = s
        .answer
        .findings
        .iter()
        .map(|f| {
            let parameters: serde_json::Map<String, Value> = f
                .parameters
                .iter()
                .map(|(name, value, (low, high))| {
                    ((*name).to_owned(), json!({ "value": value, "interval95": [low, high] }))
                })
                .collect();
            json!({ "code": f.code, "form": f.form, "ambiguous_with": f.ambiguous_with, "parameters": parameters })
        })
        .collect();
    let hits: Vec<Value> = s
        .hits
        .iter()
        .map(|h| json!({ "parameter": h.name, "held": h.held, "right": h.right, "deviation": h.deviation }))
        .collect();
    json!({
        "design": s.design.name(),
        "seed": s.seed,
        "hidden": format!("{:?}", s.truth.what),
        "codes": s.truth.codes(),
        "noise": format!("{:?}", s.truth.noise),
        "mu_MPa": s.truth.foam.mu_mpa,
        "alpha": s.truth.foam.alpha,
        "effects": s.truth.effects.iter().map(palpate::simulate::Effect::to_toml).collect::<Vec<_>>(),
        "strength": s.strength,
        "strength_of_told_noise": s.told,
        "verdict": s.answer.verdict.word(),
        "reason": s.answer.reason,
        "findings": findings,
        "shows_in": s.answer.shows_in,
        "blind_to": s.answer.blind_to,
        "outcome": s.outcome.word(),
        "held_out": s.gain.map(|g| json!({ "rmse_N_before": g.before_n, "rmse_N_found": g.found_n, "rmse_N_oracle": g.oracle_n })),
        "intervals": hits,
        "seconds": s.answer.seconds,
    })
}
