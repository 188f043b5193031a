//! What `palpate diagnose` says about a material that is compressed only: a summary for the terminal, and
//! sections of a page.

use std::fmt::Write;

use crate::diagnose::Verdict;
use crate::diagnose::compression::{Curve, Diagnosis, Evidence};
use crate::experiment::Experiment;

use super::diagnosis::{percent, probability};
use super::figure::{Axis, Figure, Series, Stroke};
use super::{Page, believed, number};

/// Curves that are drawn.
const DRAWN: usize = 8;

/// The verdict in a sentence.
#[must_use]
pub fn sentence(found: &Diagnosis) -> String {
    let what = &found.material;
    match found.verdict {
        Verdict::Clean => format!("{what} is as simulated, within the noise of these compressions."),
        Verdict::Named => format!("{what} differs from its simulation by {}.", named(found)),
        Verdict::Ambiguous => {
            format!("{what} differs from its simulation by {}; these compressions cannot tell which.", named(found))
        }
        Verdict::Unknown => format!("{what} differs from its simulation, and {}.", unnamed(found)),
        Verdict::TooFewData | Verdict::Refused => format!("{what} is not judged."),
    }
}

fn named(found: &Diagnosis) -> String {
    let told = |f: &crate::diagnose::Finding| believed::twins(f.code, &f.ambiguous_with);
    found.findings.iter().map(told).collect::<Vec<_>>().join(", and ")
}

fn unnamed(found: &Diagnosis) -> String {
    let judged = found.evidence.as_deref().map(|e| &e.judged);
    let kind = judged.and_then(|judged| judged.kinds().into_iter().next());
    believed::unnamed(judged, kind.map(|(kind, p)| (kind.words(), p)))
}

/// All that is worth a line.
#[must_use]
pub fn summary(found: &Diagnosis) -> String {
    let mut out = String::new();
    let _ = writeln!(out, "material         {}", found.material);
    let _ = writeln!(out, "verdict          {} in {:.1} s", found.verdict.word(), found.seconds);
    let _ = writeln!(out, "                 {}", sentence(found));
    if let Some(refusal) = &found.refusal {
        let _ = writeln!(out, "because          {refusal}");
    }
    for finding in &found.findings {
        let _ = writeln!(out, "effect           {} ({})", finding.code, finding.form);
        let _ = writeln!(out, "  {:14} {:>10}", "probability", probability(finding.probability));
        if let Some(share) = finding.explains {
            let _ = writeln!(out, "  {:14} {:>10} of the misfit", "explains", percent(share));
        }
        for (name, value, (low, high)) in &finding.parameters {
            let _ = writeln!(out, "  {name:14} {:>10}  95 %: {} to {}", number(*value), number(*low), number(*high));
        }
    }
    if let Some(evidence) = found.evidence.as_deref() {
        if let Some(told) = believed::remainder(&evidence.judged, "force").filter(|_| found.verdict != Verdict::Clean) {
            let _ = writeln!(out, "remainder        {told}");
        }
        if let Some(held_out) = evidence.held_out.as_ref().filter(|_| !found.findings.is_empty()) {
            let (was, is) = (number(held_out.before_n), number(held_out.after_n));
            let _ = writeln!(out, "held out, N      {was:>10} -> {is}  rms ({})", held_out.left_out);
        }
    }
    for message in &found.messages {
        let _ = writeln!(out, "note             {message}");
    }
    if !found.blind_to.is_empty() {
        let _ = writeln!(out, "blind to         {}", found.blind_to.join(", "));
    }
    out
}

/// Builds the page of all materials.
#[must_use]
pub fn page(experiment: &Experiment, all: &[Diagnosis]) -> Page {
    let mut page = Page::new(&format!("Diagnosis: {}", experiment.name), "");
    page.section("Verdict");
    page.verdict(&all.iter().map(sentence).collect::<Vec<_>>().join(" "));
    for found in all {
        page.section(&found.material);
        if let Some(refusal) = &found.refusal {
            page.warning(&format!("{refusal}."));
        }
        for message in &found.messages {
            page.warning(message);
        }
        if let Some(evidence) = found.evidence.as_deref() {
            evidence.curves.iter().take(DRAWN).for_each(|curve| drawn(&mut page, curve));
            rests_on(&mut page, found, evidence);
        }
    }
    page
}

/// Force over shortening, and what is left.
fn drawn(page: &mut Page, curve: &Curve) {
    let over = |of: &[f64]| curve.depth_mm.iter().copied().zip(of.iter().copied()).collect::<Vec<_>>();
    let left = |of: &[f64]| over(&curve.measured_n.iter().zip(of).map(|(m, p)| m - p).collect::<Vec<_>>());
    let mut whole = Figure::new(&curve.name, Axis::new("shortening (mm)"), Axis::new("force (N)"))
        .with(Series::new("measured", over(&curve.measured_n), Stroke::Circles, 5))
        .with(Series::new("base", over(&curve.base_n), Stroke::Solid, 0));
    let mut rest = Figure::new(
        "Measured minus simulated",
        Axis::new("shortening (mm)"),
        Axis::new("measured minus simulated (N)"),
    )
    .with(Series::new("base", left(&curve.base_n), Stroke::Solid, 0));
    if let Some(extended_n) = &curve.extended_n {
        whole = whole.with(Series::new("extended", over(extended_n), Stroke::Dashed, 1));
        rest = rest.with(Series::new("extended", left(extended_n), Stroke::Dashed, 1));
    }
    (whole.size, rest.size) = ((860.0, 260.0), (860.0, 200.0));
    page.figure(&whole.svg(), "");
    page.figure(&rest.svg(), "");
}

/// Effects with what is believed of them, and the likeliest sets.
fn rests_on(page: &mut Page, found: &Diagnosis, evidence: &Evidence) {
    let interval = |(low, high): (f64, f64)| format!("{} to {}", number(low), number(high));
    let mut rows = Vec::new();
    for finding in &found.findings {
        for (name, value, bounds) in &finding.parameters {
            rows.push(vec![format!("{}: {name}", finding.code), number(*value), interval(*bounds)]);
        }
    }
    if !rows.is_empty() {
        page.table(&["parameter", "value", "95 %"], &rows);
    }
    believed::tables(page, &evidence.judged, &evidence.sets, "force");
}
