//! What `palpate actuator identify` says.

use std::path::PathBuf;

use serde_json::{Value, json};

use crate::report::number;
use crate::report::response::interval;
use crate::response::identified::Identified;
use crate::response::law::Parameter;
use crate::response::push::PushFit;

/// Width of a parameter's name on the terminal.
const NAME: usize = 24;

fn shown(parameter: Parameter) -> bool {
    !matches!(parameter, Parameter::Start | Parameter::StartShare)
}

/// Parameters and remarks of an actuator with a command.
pub(super) fn commanded(found: &Identified) -> Vec<String> {
    let structure = found.law().structure;
    let sign = if found.inverted { -1.0 } else { 1.0 };
    let mut lines = Vec::new();
    for known in found.known.parameters.iter().filter(|known| shown(known.parameter)) {
        let name = known.parameter.name(structure);
        let of_command =
            known.parameter == Parameter::Gain || (known.parameter == Parameter::Offset && structure.integrates());
        let mut known = *known;
        if of_command && sign < 0.0 {
            known.value = -known.value;
            known.interval95 = (-known.interval95.1, -known.interval95.0);
        }
        lines.push(format!("{name:NAME$} {:>10}   95 %: {}", number(known.value), interval(&known)));
    }
    if let Some(least) = found.least_rate_mm_s {
        lines.push(format!("{:NAME$} {:>10}   95 %: at least {}", "rate_limit_mm_per_s", "none", number(least)));
    }
    lines.extend(found.remarks());
    lines
}

/// Parts and remarks of a pushed actuator.
pub(super) fn pushed(fit: &PushFit) -> Vec<String> {
    let row = |name: &str, value: f64, (low, high): (f64, f64)| {
        format!("{name:NAME$} {:>10}   95 %: {} to {}", number(value), number(low), number(high))
    };
    let parts = fit.parts.iter().map(|(part, value, interval)| row(part.name(), *value, *interval));
    let turning = row("turning_mm", fit.turning_mm.0, fit.turning_mm.1);
    parts.chain([turning]).chain(fit.remarks()).collect()
}

fn ends((low, high): (f64, f64)) -> Value {
    let end = |end: f64| if end.is_finite() { json!(end) } else { Value::Null };
    json!([end(low), end(high)])
}

/// The answer for programs.
pub(super) fn commanded_json(found: &Identified, log: &str, column: &str, files: &[PathBuf]) -> Value {
    let law = found.law();
    let parameters: serde_json::Map<String, Value> = found
        .known
        .parameters
        .iter()
        .filter(|known| shown(known.parameter))
        .map(|known| {
            let value = json!({ "value": known.value, "interval95": ends(known.interval95) });
            (known.parameter.name(law.structure).to_owned(), value)
        })
        .collect();
    let least = found.tried.iter().map(|tried| tried.bic).fold(f64::INFINITY, f64::min);
    let tried: Vec<Value> = found
        .tried
        .iter()
        .map(|tried| {
            let structure = tried.fitted.law.structure;
            json!({ "law": structure.code(), "order": structure.order(), "bic_above_least": tried.bic - least,
                    "rate_limit": tried.is_limited() })
        })
        .collect();
    json!({
        "log": log, "command_column": column, "law": law.structure.code(), "order": law.structure.order(),
        "inverted": found.inverted, "parameters": parameters, "rate_limit_at_least_mm_per_s": found.least_rate_mm_s,
        "samples": found.record.time_s.len(),
        "residual": {
            "sd_mm": (found.best().fitted.residual_mm.iter().map(|r| r * r).sum::<f64>()
                / found.record.time_s.len() as f64).sqrt(),
            "autocorrelation": found.correlation(),
            "whiteness": { "ljung_box_per_degree": found.known.whiteness.0, "white_99": found.known.whiteness.1 },
            "noise_coefficients": found.best().fitted.noise.coefficients,
        },
        "tried": tried, "remarks": found.remarks(), "files": crate::cli::file::names(files),
    })
}

/// The answer for programs, of a pushed actuator.
pub(super) fn pushed_json(fit: &PushFit, log: &str, files: &[PathBuf]) -> Value {
    let parts: serde_json::Map<String, Value> = fit
        .parts
        .iter()
        .map(|(part, value, interval)| {
            (part.name().to_owned(), json!({ "value": value, "interval95": ends(*interval) }))
        })
        .collect();
    json!({
        "log": log, "law": Value::Null, "parts": parts,
        "turning_mm": { "value": fit.turning_mm.0, "interval95": ends(fit.turning_mm.1) },
        "run_in_mm": fit.run_in_mm, "samples": fit.residual_n.len(),
        "residual": { "sd_N": fit.sd_n, "explained": fit.explained, "repeated": fit.repeated, "count_N": fit.count_n,
            "whiteness": { "ljung_box_per_degree": fit.whiteness.0, "white_99": fit.whiteness.1 } },
        "remarks": fit.remarks(), "files": crate::cli::file::names(files),
    })
}
