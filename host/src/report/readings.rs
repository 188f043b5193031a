//! What `palpate diagnose` says about a table: a summary for the terminal, and a page with figures.

use std::fmt::Write;

use crate::diagnose::Verdict;
use crate::diagnose::table::{Diagnosis, Evidence, Finding, Law};
use crate::experiment::Experiment;

use super::diagnosis::{percent, probability};
use super::figure::{Axis, Figure, Series, Stroke};
use super::{Page, believed, number};

/// Plausible differences beyond which the first order of a magnet's change says little.
const FIRST_ORDER: f64 = 6.0;

/// The verdict in a sentence.
#[must_use]
pub fn sentence(found: &Diagnosis) -> String {
    let base = if found.table.is_simulated { "the simulation" } else { "a line" };
    match found.verdict {
        Verdict::Clean => format!("The table is what {base} says, within what its readings scatter by."),
        Verdict::Named => format!("The table differs from {base} by {}.", named(found)),
        Verdict::Ambiguous => {
            format!("The table differs from {base} by {}; these readings cannot tell which.", named(found))
        }
        Verdict::Unknown => format!(
            "The table differs from {base}, and {}.",
            believed::unnamed(found.evidence.as_ref().map(|e| &e.judged), None)
        ),
        Verdict::TooFewData | Verdict::Refused => {
            format!("Whether {base} describes the table cannot be said from these readings.")
        }
    }
}

fn named(found: &Diagnosis) -> String {
    let told = |f: &Finding| believed::twins(&format!("{} ({})", f.effect.code, f.effect.form), &f.ambiguous_with);
    found.findings.iter().map(told).collect::<Vec<_>>().join(", and ")
}

/// Lines about the test, the straight line, and the scatter of repeats.
fn facts(found: &Diagnosis) -> Vec<(&'static str, String)> {
    let mut out = Vec::new();
    if let Some(cause) = &found.too_few {
        out.push(("because", cause.to_string()));
    }
    if let Some(test) = &found.lack_of_fit {
        let (a, b) = test.freedom;
        out.push(("lack of fit", format!("F({a}, {b}) = {:.2}, p = {:.2e}", test.f, test.probability)));
        out.push(("repeats", format!("differ by {} (standard deviation)", number(test.repeats))));
    }
    let of = if found.table.is_simulated { "y less simulated" } else { "y" };
    if let Some(line) = &found.line {
        let told = |power: usize| {
            let (low, high) = line.interval95(power);
            format!("{}, 95 %: {} to {}", number(line.coefficients[power].0), number(low), number(high))
        };
        out.push(("slope", format!("{} ({of} over x; none with p = {:.2})", told(1), line.probability(1, 0.0))));
    }
    if let Some(parabola) = &found.parabola {
        let chance = parabola.probability(2, 0.0);
        out.push((
            "curvature",
            format!("{} ({of} over x2; none with p = {chance:.2})", number(parabola.coefficients[2].0)),
        ));
    }
    out
}

/// Beside a magnet: what each part would have to differ by, and what these readings carry.
fn alone_lines(found: &Diagnosis) -> Vec<String> {
    let Some(all) = &found.alone else { return Vec::new() };
    let mut out = vec![format!("measured less simulated: {} (root mean square)", number(all.without))];
    for part in &all.parts {
        let amount = if part.code == "remanence" {
            format!("{} more at all currents", number(part.amount))
        } else if part.amount.abs() > FIRST_ORDER {
            format!("{} times what is plausible, beyond what a first order says", number(part.amount))
        } else {
            format!("{} times what is plausible", number(part.amount))
        };
        out.push(format!("{:16} {amount}; leaves {}", part.code, number(part.left)));
    }
    out.push(format!("these readings could tell {} combination(s) of the parts", all.combinations));
    out.extend(
        all.alike.iter().map(|(a, b)| format!("{a} and {b} change all readings alike: no repeat tells them apart")),
    );
    out
}

/// All that is worth a line.
#[must_use]
pub fn summary(found: &Diagnosis) -> String {
    let mut out = String::new();
    let _ = writeln!(out, "table            {} in {:.1} s", found.verdict.word(), found.seconds);
    let _ = writeln!(out, "                 {}", sentence(found));
    for (what, told) in facts(found) {
        let _ = writeln!(out, "{what:16} {told}");
    }
    for line in alone_lines(found) {
        let _ = writeln!(out, "alone            {line}");
    }
    for finding in &found.findings {
        let _ = writeln!(out, "effect           {} ({})", finding.effect.code, finding.effect.form);
        let _ = writeln!(out, "  {:16} {:>10}", "probability", probability(finding.probability));
        if let Some(share) = finding.explains {
            let _ = writeln!(out, "  {:16} {:>10} of the misfit", "explains", percent(share));
        }
        for (name, value, (low, high)) in &finding.parameters {
            let _ = writeln!(out, "  {name:16} {:>10}  95 %: {} to {}", number(*value), number(*low), number(*high));
        }
        if !finding.ambiguous_with.is_empty() {
            let _ = writeln!(out, "  decided by     {}", finding.effect.separated_by);
        }
    }
    if let Some(told) = found
        .evidence
        .as_ref()
        .and_then(|e| believed::remainder(&e.judged, "span"))
        .filter(|_| found.verdict != Verdict::Clean)
    {
        let _ = writeln!(out, "remainder        {told}");
    }
    let held_out = found.evidence.as_ref().and_then(|e| e.held_out).filter(|_| !found.findings.is_empty());
    if let Some(held_out) = held_out {
        let _ = writeln!(out, "held out, y      {:>10} -> {}  rms", number(held_out.before), number(held_out.after));
    }
    if !found.blind_to.is_empty() {
        let _ = writeln!(out, "blind to         {}", found.blind_to.join(", "));
    }
    if let Some(next) = found.proposals.first() {
        let _ = writeln!(out, "next readings    {}", next.what);
        let _ = writeln!(out, "  would tell     {}", next.decides.join(", "));
    }
    out
}

/// Builds the page.
#[must_use]
pub fn page(experiment: &Experiment, found: &Diagnosis) -> Page {
    let mut page = Page::new(&format!("Diagnosis: {}", experiment.name), "");
    page.section("Verdict");
    page.verdict(&sentence(found));
    curves(&mut page, found);
    page.section("What it rests on");
    let rows: Vec<Vec<String>> = facts(found).into_iter().map(|(what, told)| vec![what.to_owned(), told]).collect();
    page.table(&["asked", "answer"], &rows);
    let alone = alone_lines(found);
    if !alone.is_empty() {
        page.section("Each part of the magnet as the only cause");
        page.list(&alone);
    }
    if let Some(evidence) = &found.evidence {
        beliefs(&mut page, found, evidence);
    }
    if !found.proposals.is_empty() {
        page.section("Next readings");
        let told = found.proposals.iter().map(|p| match p.distance {
            Some(far) => format!("{}: would tell {} ({far:.0} standard deviations)", p.what, p.decides.join(", ")),
            None => format!("{}: would tell {}", p.what, p.decides.join(", ")),
        });
        page.list(&told.collect::<Vec<_>>());
    }
    page
}

/// What is believed of each effect, with parameters of what is named.
fn beliefs(page: &mut Page, found: &Diagnosis, evidence: &Evidence) {
    let interval = |(low, high): (f64, f64)| format!("{} to {}", number(low), number(high));
    let mut rows = Vec::new();
    for (name, value, bounds) in evidence.base.told(None) {
        rows.push(vec![format!("base: {name}"), number(value), interval(bounds)]);
    }
    for finding in &found.findings {
        for (name, value, bounds) in &finding.parameters {
            rows.push(vec![format!("{}: {name}", finding.effect.code), number(*value), interval(*bounds)]);
        }
    }
    page.table(&["parameter", "value", "95 %"], &rows);
    believed::tables(page, &evidence.judged, &evidence.sets, "span");
    if !found.blind_to.is_empty() {
        page.paragraph(&format!("A plausible amount of these would not be seen here: {}.", found.blind_to.join(", ")));
    }
}

/// Readings, base and what was found, and what these leave.
fn curves(page: &mut Page, found: &Diagnosis) {
    let table = &found.table;
    let over = |law: &Law| -> Vec<(f64, f64)> {
        let mut points: Vec<(f64, f64)> = table.readings.iter().map(|r| (r.x, law.predict(table, r))).collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        points
    };
    let left =
        |law: &Law| -> Vec<(f64, f64)> { table.readings.iter().map(|r| (r.x, r.y - law.predict(table, r))).collect() };
    let measured: Vec<(f64, f64)> = table.readings.iter().map(|r| (r.x, r.y)).collect();
    let mut whole = Figure::new("Readings", Axis::new("x"), Axis::new("y"));
    let mut rest = Figure::new("Measured minus predicted", Axis::new("x"), Axis::new("measured minus predicted, y"));
    let base = found.evidence.as_ref().map(|e| &e.base.fit.law);
    if let Some(base) = base {
        whole = whole.with(Series::new("base", over(base), Stroke::Solid, 0));
        rest = rest.with(Series::new("base", left(base), Stroke::Circles, 0));
    }
    if let Some(best) = found.evidence.as_ref().and_then(|e| e.held.first()) {
        whole = whole.with(Series::new("extended", over(&best.fit.law), Stroke::Dashed, 1));
        rest = rest.with(Series::new("extended", left(&best.fit.law), Stroke::Dots, 1));
    }
    if base.is_none() && table.is_simulated {
        let mut points: Vec<(f64, f64)> = table.readings.iter().filter_map(|r| Some((r.x, r.simulated?))).collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        whole = whole.with(Series::new("simulated", points, Stroke::Solid, 0));
    }
    whole = whole.with(Series::new("measured", measured, Stroke::Circles, 5));
    (whole.size, rest.size) = ((860.0, 300.0), (860.0, 220.0));
    page.figure(&whole.svg(), "");
    if base.is_some() {
        page.figure(&rest.svg(), "");
    }
}
