//! What `palpate trial analyse` says.

use std::path::PathBuf;

use serde_json::{Value, json};

use super::analyse::Analysed;
use crate::report::number;
use crate::trial::confusion::{Confusion, Share};
use crate::trial::weber::{References, ratio_for};

/// Width of a cell.
const CELL: usize = 24;

fn percent(share: f64) -> String {
    format!("{:.1} %", 100.0 * share)
}

fn share(share: &Share) -> String {
    let (low, high) = share.interval95;
    format!("{} of {} ({:.0} to {:.0} %)", share.hits, share.trials, 100.0 * low, 100.0 * high)
}

/// The confusion table with its exact intervals.
pub(super) fn table(table: &Confusion) -> Vec<String> {
    let width = table.names.iter().map(|name| name.chars().count()).max().unwrap_or(0).max(5);
    let head: String = table.names.iter().map(|name| format!("  {name:CELL$}")).collect();
    let mut lines =
        vec![format!("{}: share answered with exact 95 % intervals", table.title), format!("{:width$}{head}", "shown")];
    for (name, row) in table.names.iter().zip(table.cells()) {
        let cells: String = row.iter().map(|cell| format!("  {:CELL$}", share(cell))).collect();
        lines.push(format!("{name:width$}{}", cells.trim_end()));
    }
    lines
}

/// Everything but the table, a sentence each; the answer first.
pub(super) fn lines(found: &Analysed) -> Vec<String> {
    let table = &found.table;
    let total = table.total();
    let (low, high) = total.interval95;
    let chance = 1.0 / table.names.len() as f64;
    let by_chance = table.by_chance();
    let better = if by_chance < 0.05 { "better than guessing" } else { "not shown to be better than guessing" };
    let p = if by_chance < 1e-4 { format!("{by_chance:.1e}") } else { format!("{by_chance:.4}") };
    let mut lines = vec![format!(
        "{} of {} right, {} (95 %: {} to {}): {better} ({}; as many by guessing: p = {p}).",
        total.hits,
        total.trials,
        percent(total.value()),
        percent(low),
        percent(high),
        percent(chance)
    )];
    lines.push(distance(table));
    lines.extend(pairs(found));
    let (counted, corrected, most) = table.bits();
    lines.push(format!(
        "Information: {counted:.2} of {most:.2} bits an answer, {corrected:.2} less the bias of counting."
    ));
    lines.extend(weber(found));
    lines.extend(sizes(found));
    lines.extend(table.remarks.iter().cloned());
    lines
}

fn distance(table: &Confusion) -> String {
    let (value, (low, high)) = table.distance();
    let choices = table.names.len();
    if value.is_infinite() {
        format!("d' of a choice among {choices}: above {low:.2} (95 %); no answer is wrong, so no upper end is known.")
    } else {
        let high = if high.is_finite() { format!("{high:.2}") } else { "any".to_owned() };
        format!("d' of an unbiased choice among {choices}: {value:.2} (95 %: {low:.2} to {high}).")
    }
}

fn pairs(found: &Analysed) -> Vec<String> {
    let table = &found.table;
    let each = table.pairs().into_iter().map(|(i, j, d)| {
        let (low, high) = d.interval95;
        let corrected = if d.corrected { ", half a count added to each cell" } else { "" };
        let line = format!(
            "{} against {}: d' {:.2} (95 %: {low:.2} to {high:.2}{corrected}), criterion {:.2}.",
            table.names[i], table.names[j], d.value, d.criterion
        );
        line
    });
    each.collect()
}

fn weber(found: &Analysed) -> Vec<String> {
    let table = &found.table;
    let mut lines = Vec::new();
    let Some(predicted) = &found.predicted else {
        let unknown: Vec<&str> = table
            .names
            .iter()
            .zip(&found.stiffness)
            .filter(|(_, known)| known.is_none())
            .map(|(name, _)| name.as_str())
            .collect();
        lines.push(format!(
            "The stiffness of {} is not known, so no Weber fraction follows from the answers: --stiffness NAME=VALUE.",
            unknown.join(", ")
        ));
        if table.names.len() == 2 {
            let share = table.total();
            let ratio = |right: f64| percent(ratio_for(right, found.weber, found.references) - 1.0);
            lines.push(format!(
                "A subject with a Weber fraction of {} is right this often where one is {} stiffer than the other (95 %: {} to {}).",
                percent(found.weber),
                ratio(share.value()),
                ratio(share.interval95.0),
                ratio(share.interval95.1)
            ));
        }
        return lines;
    };
    let known = table.names.iter().zip(&found.stiffness).filter_map(|(name, known)| Some((name, known.as_ref()?)));
    let known: Vec<String> =
        known.map(|(name, known)| format!("{name} {} ({})", number(known.value), known.source)).collect();
    lines.push(format!("Stiffness: {}.", known.join(", ")));
    let right: Vec<String> =
        table.names.iter().enumerate().map(|(i, name)| format!("{name} {}", percent(predicted[i][i]))).collect();
    lines.push(format!(
        "A subject with a Weber fraction of {} that {} would be right in: {}.",
        percent(found.weber),
        if found.references == References::Touched { "touches the real ones as well" } else { "knows the real ones" },
        right.join(", ")
    ));
    if let Some(estimate) = &found.estimate {
        let (low, high) = estimate.interval95;
        let high = if high.is_finite() { percent(high) } else { "any".to_owned() };
        lines.push(if estimate.value == 0.0 {
            format!("The answers bound the Weber fraction from above only: at most {high} (95 %).")
        } else if estimate.value.is_infinite() {
            format!(
                "The answers do not depend on the stiffness: the Weber fraction is at least {} (95 %).",
                percent(low)
            )
        } else {
            format!("Weber fraction of these answers: {} (95 %: {} to {high}).", percent(estimate.value), percent(low))
        });
    }
    lines
}

fn sizes(found: &Analysed) -> Vec<String> {
    let sizes = &found.sizes;
    let right = percent(sizes.right);
    let mut lines = Vec::new();
    lines.push(match sizes.for_width {
        Some(n) => format!(
            "Sample size: {n} trials for a share of {right} within +-{} (95 %, exact).",
            percent(sizes.half_width)
        ),
        None => {
            format!("Sample size: more than 5000 trials for a share of {right} within +-{}.", percent(sizes.half_width))
        }
    });
    lines.push(match sizes.to_beat_chance {
        Some(n) => format!(
            "{n} trials find a share of {right} better than guessing (one-sided 5 %) in {} of all tests.",
            percent(sizes.power)
        ),
        None => format!(
            "No 5000 trials find a share of {right} better than guessing in {} of all tests.",
            percent(sizes.power)
        ),
    });
    lines
}

fn finite(value: f64) -> Value {
    if value.is_finite() { json!(value) } else { Value::Null }
}

fn ends((low, high): (f64, f64)) -> Value {
    json!([finite(low), finite(high)])
}

fn share_json(share: &Share) -> Value {
    json!({ "hits": share.hits, "trials": share.trials, "share": share.value(), "interval95": ends(share.interval95) })
}

/// The answer for programs; what is infinite is null.
pub(super) fn json(found: &Analysed, files: &[PathBuf]) -> Value {
    let table = &found.table;
    let cells: Vec<Vec<Value>> = table.cells().iter().map(|row| row.iter().map(share_json).collect()).collect();
    let (distance, interval) = table.distance();
    let pairs: Vec<Value> = table
        .pairs()
        .into_iter()
        .map(|(i, j, d)| {
            json!({ "materials": [table.names[i], table.names[j]], "d_prime": d.value, "interval95": ends(d.interval95),
                    "criterion": d.criterion, "log_linear": d.corrected })
        })
        .collect();
    let (counted, corrected, most) = table.bits();
    let stiffness: Vec<Value> = found
        .stiffness
        .iter()
        .map(|one| one.as_ref().map_or(Value::Null, |one| json!({ "value": one.value, "source": one.source })))
        .collect();
    let estimate = found.estimate.map(|e| json!({ "value": finite(e.value), "interval95": ends(e.interval95) }));
    json!({
        "title": table.title, "materials": table.names, "subjects": table.subjects, "cells": cells,
        "total": share_json(&table.total()), "p_by_chance": table.by_chance(),
        "d_prime": { "value": finite(distance), "interval95": ends(interval), "pairs": pairs },
        "bits": { "counted": counted, "corrected": corrected, "most": most },
        "stiffness": stiffness,
        "weber": { "compared": found.weber, "references_touched": found.references == References::Touched,
                   "predicted": found.predicted, "estimate": estimate },
        "sample_size": { "share": found.sizes.right, "half_width": found.sizes.half_width, "for_half_width": found.sizes.for_width,
                         "power": found.sizes.power, "to_beat_chance": found.sizes.to_beat_chance },
        "remarks": table.remarks,
        "files": files.iter().map(|file| file.display().to_string()).collect::<Vec<_>>(),
    })
}
