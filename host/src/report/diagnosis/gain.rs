//! What the extension gains, and what it does to the parameters.

use lut_gen::effect::Spread;

use crate::diagnose::fit::Fit;
use crate::diagnose::{Diagnosis, Estimate, Evidence, Verdict};
use crate::experiment::Experiment;
use crate::report::{Page, number};

use super::words;

/// The sections.
pub(super) fn section(
    page: &mut Page,
    experiment: &Experiment,
    (found, evidence): (&Diagnosis, &Evidence),
    best: Option<&Fit>,
) {
    page.section("Before and after, on what no fit has seen");
    held_out(page, found, evidence);
    page.section("Parameters");
    base(page, evidence);
    let named = matches!(found.verdict, Verdict::Named | Verdict::Ambiguous);
    evidence.widened(named).for_each(|told| page.paragraph(&format!("{}{}.", told[..1].to_uppercase(), &told[1..])));
    match best {
        Some(fit) => effects(page, experiment, fit),
        None => page.paragraph("Nothing was added to the base."),
    }
    if best.is_some() && evidence.held.len() > 1 {
        page.paragraph("The intervals above cover every explanation that is still open. By explanation:");
        let rows: Vec<Vec<String>> = evidence
            .held
            .iter()
            .map(|e| {
                let [mu, alpha] = e.fit.base();
                vec![words::candidates(experiment, &e.fit.candidates), with_interval(mu), with_interval(alpha)]
            })
            .collect();
        page.table(&["explanation", "mu (MPa)", "alpha"], &rows);
    }
}

fn held_out(page: &mut Page, found: &Diagnosis, evidence: &Evidence) {
    let Some(held_out) = &evidence.held_out else {
        page.paragraph("No effect is named, or no condition could be left out.");
        return;
    };
    let change = |before: f64, after: f64| format!("{:+.0} %", 100.0 * (after / before - 1.0));
    let row = |name: &str, (before, after): (f64, f64)| {
        vec![name.to_owned(), number(before), number(after), change(before, after)]
    };
    let error_n = (held_out.rmse_before_n, held_out.rmse_after_n);
    let share = held_out.percent_of_peak();
    let weighed = (held_out.deviance_before, held_out.deviance_after);
    page.table(
        &["", "base", "extended", "change"],
        &[
            row("error, root mean square (N)", error_n),
            row("the same, % of the largest force", share),
            row("log score, times -2", weighed),
        ],
    );
    page.paragraph(&format!(
        "Each of these was left out in turn and predicted from the others: {}. \
         Errors are those of least-squares fits of mu, alpha and the contact points. \
         The log score also knows how spots scatter and how well the parameters are known; it decides.",
        held_out.conditions.join(", ")
    ));
    if found.verdict != Verdict::Unknown && error_n.1 >= error_n.0 {
        page.warning("The error in newton did not fall: the gain is smaller than the scatter between spots.");
    }
    if found.verdict == Verdict::Unknown && !held_out.gains() {
        page.warning(
            "The likeliest effects predict left-out runs no better than the base does, so they are not named.",
        );
    }
}

fn with_interval((value, (low, high)): Estimate) -> String {
    format!("{} ({} to {})", number(value), number(low), number(high))
}

fn base(page: &mut Page, evidence: &Evidence) {
    let (was, is) = (evidence.before.parameters, evidence.extended());
    let rows: Vec<Vec<String>> = ["mu (MPa)", "alpha"]
        .iter()
        .enumerate()
        .map(|(at, name)| {
            let now = is.map(|all| all[at]);
            let moved = now.map_or_else(String::new, |(value, _)| {
                let (low, high) = was[at].1;
                let outside = value < low || value > high;
                let change = 100.0 * (value / was[at].0 - 1.0);
                format!("{change:+.1} %, {} its old interval", if outside { "outside" } else { "inside" })
            });
            vec![(*name).to_owned(), with_interval(was[at]), now.map_or_else(|| "-".to_owned(), with_interval), moved]
        })
        .collect();
    page.table(&["parameter", "base (95 %)", "extended (95 %)", "moved by"], &rows);
}

fn effects(page: &mut Page, experiment: &Experiment, fit: &Fit) {
    let mut rows = Vec::new();
    for (at, candidate) in fit.candidates.iter().enumerate() {
        for (quantity, value, (low, high)) in fit.quantities(at) {
            let (word, unit) = words::quantity(quantity.name);
            // a shape parameter has no amount at which the effect is absent
            let null = if quantity.spread == Spread::Logarithmic { "-".to_owned() } else { number(quantity.null) };
            rows.push(vec![
                words::candidate(experiment, candidate),
                word,
                number(value),
                format!("{} to {}", number(low), number(high)),
                if unit.is_empty() { "-".to_owned() } else { unit.to_owned() },
                null,
                format!("{} to {}", number(quantity.low), number(quantity.high)),
            ]);
        }
    }
    page.table(&["effect", "parameter", "value", "95 % interval", "unit", "absent at", "bounds"], &rows);
}
