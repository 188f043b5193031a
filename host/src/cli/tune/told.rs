//! What `palpate tune` says.

use std::path::PathBuf;

use serde_json::{Value, json};

use crate::actuator::Actuator;
use crate::report::{number, tuning};
use crate::tune::limits::Rule;
use crate::tune::roots::Varied;
use crate::tune::step::Step;
use crate::tune::study::Study;
use crate::tune::{Gains, Judged, NoCertificate, Way};

fn gains_text(gains: &Gains) -> String {
    let Gains { kp, ki, kd, n } = gains;
    format!("kp {kp:.4} V/mm, ki {ki:.4} V/(mm s), kd {kd:.5} V s/mm, n {n:.3} rad/s")
}

fn step_text(step: &Step) -> String {
    format!(
        "error {:.5} mm s, overshoot {:.2} %, undershoot {:.2} %, command {:.3} V",
        step.cost,
        100.0 * step.overshoot,
        100.0 * step.undershoot,
        step.command
    )
}

/// Bandwidth and margins in a line.
fn loop_text(judged: &Judged) -> String {
    let m = &judged.margins;
    let or_none = |value: Option<f64>, unit: &str| value.map_or("none".to_owned(), |v| format!("{}{unit}", number(v)));
    let crossover = m.crossover_rad_s.map_or(String::new(), |w| format!(" at {} rad/s", number(w)));
    format!(
        "bandwidth {}, phase margin {}{crossover}, gain margin {}, delay margin {}, peak sensitivity {:.3}",
        or_none(m.bandwidth_hz, " Hz"),
        or_none(m.phase_margin_deg, " degrees"),
        m.gain_margin.map_or("unbounded".to_owned(), number),
        or_none(m.delay_margin_s.map(|s| 1e3 * s), " ms"),
        m.peak_sensitivity
    )
}

/// The loop in words.
pub(super) fn loop_name(study: &Study, name: &str) -> String {
    match study.asked.way {
        Way::Continuous => name.to_owned(),
        Way::Sampled(sampling) => format!("{name}, {} Hz", number(1.0 / sampling.tick_s)),
    }
}

/// The coefficients that vary, with their ranges.
pub(super) fn box_text(study: &Study) -> String {
    let bounds = &study.asked.uncertain.bounds;
    let one = |(which, low, high): &(crate::actuator::uncertain::Coefficient, f64, f64)| {
        format!("{} {} to {}", which.name(), number(*low), number(*high))
    };
    if bounds.is_empty() { "nothing varies".to_owned() } else { bounds.iter().map(one).collect::<Vec<_>>().join(", ") }
}

/// What is certain of the box, in sentences.
pub(super) fn worst_text(study: &Study) -> Vec<String> {
    let mut lines = Vec::new();
    match &study.worst {
        Ok(worst) if worst.stable => {
            lines.push(format!(
                "every plant of the box is stable, and at worst: {} (certified)",
                step_text(&worst.most)
            ));
            lines.push(format!("worst that was found: {}", step_text(&worst.found)));
        }
        Ok(worst) => {
            lines.push(format!(
                "no bound for the whole box after {} parts; worst that was found: {}",
                worst.boxes,
                step_text(&worst.found)
            ));
        }
        Err(reason) => lines.push(format!("not certified: {}", reason_text(*reason))),
    }
    if let Some((samples, step)) = &study.sampled {
        lines.push(format!("{samples} random plants: {}", step_text(step)));
    }
    if matches!(study.asked.way, Way::Sampled(_)) && study.worst.is_ok() {
        lines.push("overshoot and undershoot of the box are those at the ticks".to_owned());
    }
    lines
}

pub(super) const fn reason_text(reason: NoCertificate) -> &'static str {
    match reason {
        NoCertificate::DeadTime => {
            "a continuous loop with dead time has infinitely many poles; a sampled one is certified"
        }
        NoCertificate::NotLinear => {
            "speed limit, friction, backlash or a cut command make the loop nonlinear; --ideal without --cut is certified"
        }
        NoCertificate::TooMany => "more than six coefficients vary",
        NoCertificate::NoBox => "nothing varies",
    }
}

/// The search in a sentence.
pub(super) fn search_text(study: &Study) -> String {
    study.tuned.as_ref().map_or_else(
        || "the gains were given".to_owned(),
        |tuned| {
            let apart = match (tuned.ends.first(), tuned.ends.last()) {
                (Some(best), Some(last)) if tuned.ends.len() > 1 => {
                    format!(", {} ends within {:.2} %", tuned.ends.len(), 100.0 * (last / best - 1.0))
                }
                _ => String::new(),
            };
            format!("{} steps computed in {:.2} s{apart}", tuned.calls, tuned.seconds)
        },
    )
}

/// The answer for people, a line each.
pub(super) fn lines(actuator: &Actuator, name: &str, study: &Study) -> Vec<String> {
    let judged = &study.judged;
    let mut lines =
        vec![format!("gains       {}", gains_text(&judged.gains)), format!("step        {}", step_text(&judged.step))];
    if let Some(ticks) = &judged.at_ticks {
        lines.push(format!(
            "            at the ticks alone overshoot {:.2} %, undershoot {:.2} %",
            100.0 * ticks.overshoot,
            100.0 * ticks.undershoot
        ));
    }
    lines.push(format!("loop        {}", loop_text(judged)));
    lines.push(format!("for         {}; {}", actuator.title, loop_name(study, name)));
    if study.asked.robust
        && let Some(tuned) = &study.tuned
    {
        lines.push(format!("robust      error of the worst corner {:.5} mm s", tuned.cost));
    }
    lines.push(format!("box         {}", box_text(study)));
    lines.extend(worst_text(study).into_iter().map(|line| format!("            {line}")));
    for spread in &study.spreads {
        let varied = if spread.varied == Varied::Plant { "the plant varies" } else { "Eq. 56 varies" };
        lines.push(format!("roots       {varied}: {} 1/s", tuning::ranges(spread)));
    }
    for (other, judged) in &study.others {
        lines.push(format!("{other}: {}", step_text(&judged.step)));
    }
    lines.push(format!("search      {}", search_text(study)));
    lines
}

fn judged_value(judged: &Judged) -> Value {
    let poles: Vec<[f64; 2]> = judged.poles.iter().map(|pole| [pole.re, pole.im]).collect();
    json!({
        "gains": judged.gains, "step": judged.step, "at_ticks": judged.at_ticks, "margins": judged.margins, "poles": poles,
    })
}

/// The answer for programs.
pub(super) fn summary(actuator: &Actuator, name: &str, study: &Study, files: &[PathBuf], sent: Option<&str>) -> Value {
    let asked = &study.asked;
    let bounds: Vec<Value> = asked
        .uncertain
        .bounds
        .iter()
        .map(|(which, low, high)| json!({"name": which.name(), "low": low, "high": high}))
        .collect();
    let worst = match &study.worst {
        Ok(worst) => json!({
            "stable": worst.stable, "certified": worst.stable.then_some(&worst.most), "found": worst.found, "at": worst.at,
            "boxes": worst.boxes,
        }),
        Err(reason) => json!({ "not_certified": reason }),
    };
    let mut own = judged_value(&study.judged);
    let spreads: Vec<Value> =
        study.spreads.iter().map(|s| json!({"varied": s.varied, "groups": s.groups, "samples": s.samples})).collect();
    let others: Vec<Value> = study
        .others
        .iter()
        .map(|(name, judged)| {
            let mut value = judged_value(judged);
            value["name"] = json!(name);
            value
        })
        .collect();
    let search =
        study.tuned.as_ref().map(|t| json!({"cost": t.cost, "ends": t.ends, "steps": t.calls, "seconds": t.seconds}));
    let plant = &asked.uncertain.plant;
    let list = |polynomial: &crate::actuator::polynomial::Polynomial| {
        polynomial.coefficients().iter().rev().copied().collect::<Vec<f64>>()
    };
    own["actuator"] = json!(actuator.title);
    own["plant"] =
        json!({"numerator": list(&plant.numerator), "denominator": list(&plant.denominator), "delay_s": plant.delay_s});
    own["loop"] = json!(name);
    own["tick_s"] = json!(match asked.way {
        Way::Continuous => None,
        Way::Sampled(sampling) => Some(sampling.tick_s),
    });
    own["limits"] = json!(asked.limits);
    own["rule"] = json!(asked.rule);
    own["robust"] = json!(asked.robust);
    own["search"] = json!(search);
    own["box"] = json!(bounds);
    own["worst"] = worst;
    own["samples"] = json!(study.sampled.map(|(count, step)| json!({"count": count, "worst": step})));
    own["roots"] = json!(spreads);
    own["others"] = json!(others);
    if asked.rule == Rule::AppendixE || study.tuned.is_none() {
        let sampled = crate::tune::appendix::evaluate(plant, &study.judged.gains);
        own["appendix_e"] = json!({"sum": sampled.sum, "step": sampled.step});
    }
    own["files"] = json!(files.iter().map(|file| file.display().to_string()).collect::<Vec<_>>());
    own["sent"] = json!(sent);
    own
}

/// Cells of a table of gains: name, gains, step, margins.
pub(super) fn row(name: &str, judged: &Judged) -> Vec<String> {
    let Gains { kp, ki, kd, n } = judged.gains;
    let mut row = vec![name.to_owned()];
    row.extend([kp, ki, kd, n].map(number));
    let step = &judged.step;
    row.extend([
        format!("{:.5}", step.cost),
        number(100.0 * step.overshoot),
        number(100.0 * step.undershoot),
        number(step.command),
    ]);
    row.push(judged.margins.phase_margin_deg.map_or("none".to_owned(), number));
    row.push(number(judged.margins.peak_sensitivity));
    row
}

/// Heads of [`row`].
pub(super) const HEAD: [&str; 11] = [
    "",
    "kp",
    "ki",
    "kd",
    "n",
    "error (mm s)",
    "overshoot (%)",
    "undershoot (%)",
    "command (V)",
    "phase margin (deg)",
    "peak sensitivity",
];
