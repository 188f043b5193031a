//! What `palpate diagnose` says about a display: a summary for the terminal, and a page with figures.

pub mod gain;

use std::fmt::Write;

use crate::diagnose::Verdict;
use crate::diagnose::display::design::Series as Run;
use crate::diagnose::display::gain::Gain;
use crate::diagnose::display::{ChannelDiagnosis, Diagnosis, Evidence, Finding, effect};
use crate::experiment::Experiment;
use crate::extended::display::looseness;

use super::diagnosis::{percent, probability};
use super::figure::{Axis, Figure, Series, Stroke};
use super::{Page, believed, number};
use gain::gained;

/// The verdict on a channel in a sentence.
#[must_use]
pub fn sentence(channel: &ChannelDiagnosis) -> String {
    let what = channel.channel.word();
    let named = || {
        let told = |f: &Finding| believed::twins(f.code, &f.ambiguous_with);
        channel.findings.iter().map(told).collect::<Vec<_>>().join(", and ")
    };
    match channel.verdict {
        Verdict::Clean => format!("The {what} is as simulated, within the noise of these runs."),
        Verdict::Named => format!("The {what} differs from its simulation by {}.", named()),
        Verdict::Ambiguous => {
            format!("The {what} differs from its simulation by {}; these runs cannot tell which.", named())
        }
        Verdict::Unknown => {
            let seen = match channel.shows_in.as_slice() {
                [] => String::new(),
                variables => format!("; it shows in {}", variables.join(", ")),
            };
            format!(
                "The {what} differs from its simulation, and {}{seen}.",
                believed::unnamed(channel.evidence.as_deref().map(|e| &e.judged), None)
            )
        }
        Verdict::TooFewData | Verdict::Refused => format!("The {what} is not judged."),
    }
}

/// All that is worth a line.
#[must_use]
pub fn summary(found: &Diagnosis) -> String {
    let mut out = String::new();
    let _ = writeln!(out, "display          {} in {:.1} s", found.verdict.word(), found.seconds);
    for channel in &found.channels {
        let _ = writeln!(out, "{:16} {}", channel.channel.word(), channel.verdict.word());
        let _ = writeln!(out, "                 {}", sentence(channel));
        lines(&mut out, channel);
    }
    out
}

fn lines(out: &mut String, channel: &ChannelDiagnosis) {
    if let Some(refusal) = &channel.refusal {
        let _ = writeln!(out, "  because        {refusal}");
    }
    for message in &channel.messages {
        let _ = writeln!(out, "  note           {message}");
    }
    for finding in &channel.findings {
        let _ = writeln!(out, "  effect         {} ({})", finding.code, finding.form);
        let _ = writeln!(out, "    {:16} {:>10}", "probability", probability(finding.probability));
        if let Some(share) = finding.explains {
            let _ = writeln!(out, "    {:16} {:>10} of the misfit", "explains", percent(share));
        }
        for (name, value, (low, high)) in &finding.parameters {
            let _ = writeln!(out, "    {name:16} {:>10}  95 %: {} to {}", number(*value), number(*low), number(*high));
        }
    }
    let Some(evidence) = channel.evidence.as_deref() else { return };
    if let Some(held_out) = evidence.held_out.as_ref().filter(|_| !channel.findings.is_empty()) {
        let unit = channel.channel.unit();
        if let Some(gain) = &held_out.gain {
            let (was, is) = (number(gain.before), number(gain.after));
            let _ = writeln!(out, "  repeats, {unit:5} {was:>10} -> {is}  rms, none seen by the fit");
            let _ = writeln!(out, "  gain           {}", repeats(gain));
        }
        let (was, is) = (held_out.rmse_before, held_out.rmse_after);
        let _ = writeln!(
            out,
            "  held out, {unit:4} {:>10} -> {}  rms, of commands that the fit has not seen",
            number(was),
            number(is)
        );
    }
    if let Some(told) = believed::remainder(&evidence.judged, "span").filter(|_| channel.verdict != Verdict::Clean) {
        let _ = writeln!(out, "  remainder      {told}");
    }
    if !channel.blind_to.is_empty() {
        let _ = writeln!(out, "  blind to       {}", channel.blind_to.join(", "));
    }
    if let Some(next) = channel.proposals.first() {
        let _ = writeln!(out, "  next run       {}", next.what);
        let _ = writeln!(out, "    would tell   {}", next.decides.join(", "));
    }
}

/// What repeats tell of the gain, and where more is to be had.
fn repeats(gain: &Gain) -> String {
    let told = gained(gain.part(), Some(gain.part95).filter(|(low, _)| low.is_finite()));
    if looseness(gain.part(), gain.part95) <= 1.0 {
        told
    } else {
        format!("{told} More runs tell it closer: `palpate gain` with the model.")
    }
}

/// Builds the page.
#[must_use]
pub fn page(experiment: &Experiment, found: &Diagnosis) -> Page {
    let mut page = Page::new(&format!("Diagnosis: {}", experiment.name), "");
    page.section("Verdict");
    page.verdict(&found.channels.iter().map(sentence).collect::<Vec<_>>().join(" "));
    for channel in &found.channels {
        section(&mut page, channel);
    }
    page.section("What this could be wrong about");
    page.list(&DOUBTS.map(str::to_owned));
    page.paragraph(&format!("{:.1} s. Units: mm, N, A, T, s.", found.seconds));
    page
}

const DOUBTS: [&str; 6] = [
    "What is told is taken as told: the actuator's command holds from its time stamp to the next, loads and currents are what their columns say.",
    "Every run begins at rest where its first command holds it, with a cold winding and an untouched sensor.",
    "Channels are judged one by one: an error that two share (a clock, a supply) is seen in each by itself.",
    "The base laws are the thesis' (plant 86/(s² + 23.4 s + 86) with stiffness and damping free, the line of the FSR, Ohm's law, the line of Table 6); they may be wrong by 0.1 % of the span and 2 ms of time before that counts.",
    "A finger is the round one of the control curves with a stiffness of its own, a fluid has Carlson's yield stress times a number; a fluid is compared where it yields, on the way down.",
    "An effect's own law may be wrong by 5 % of what it adds; what is smaller than that beside a large effect is not seen.",
];

fn section(page: &mut Page, channel: &ChannelDiagnosis) {
    page.section(&format!("Channel: {}", channel.channel.word()));
    page.paragraph(&sentence(channel));
    if let Some(refusal) = &channel.refusal {
        page.warning(&format!("{refusal}."));
    }
    for message in &channel.messages {
        page.warning(message);
    }
    let Some(evidence) = channel.evidence.as_deref() else { return };
    curves(page, channel, evidence);
    parameters(page, channel, evidence);
    believed::tables(page, &evidence.judged, &evidence.sets, "span");
    for finding in channel.findings.iter().filter(|f| !f.ambiguous_with.is_empty()) {
        if let Some(its) = effect::find(finding.code, Some(finding.form)) {
            page.paragraph(&format!(
                "What decides between {} and {}: {}.",
                finding.code,
                finding.ambiguous_with.join(", "),
                its.separated_by
            ));
        }
    }
    if !channel.blind_to.is_empty() {
        page.paragraph(&format!(
            "A plausible amount of these would not be seen here: {}.",
            channel.blind_to.join(", ")
        ));
    }
    if !channel.proposals.is_empty() {
        page.heading("Next run");
        let told = channel.proposals.iter();
        let told = told.map(|p| {
            format!("{}: would tell {} ({:.0} standard deviations)", p.what, p.decides.join(", "), p.distance)
        });
        page.list(&told.collect::<Vec<_>>());
    }
}

/// Figures for the first run of each command.
fn curves(page: &mut Page, channel: &ChannelDiagnosis, evidence: &Evidence) {
    let unit = channel.channel.unit();
    let extended = evidence.held.first().filter(|_| !channel.findings.is_empty());
    let mut seen = Vec::new();
    for series in &evidence.design.series {
        if seen.contains(&series.condition) {
            continue;
        }
        seen.push(series.condition);
        let base = evidence.base.fit.law.predict(series);
        let after = extended.map(|e| e.fit.law.predict(series));
        let axis = || Axis::new("time (s)");
        let mut whole = Figure::new(&series.file, axis(), Axis::new(&format!("{} ({unit})", channel.channel.word())))
            .with(Series::new("measured", over(series, &series.output), Stroke::Circles, 5))
            .with(Series::new("base", over(series, &base), Stroke::Solid, 0));
        let mut rest =
            Figure::new("Measured minus simulated", axis(), Axis::new(&format!("measured minus simulated ({unit})")))
                .with(Series::new("base", over(series, &less(&series.output, &base)), Stroke::Solid, 0));
        if let Some(after) = &after {
            whole = whole.with(Series::new("extended", over(series, after), Stroke::Dashed, 1));
            rest = rest.with(Series::new("extended", over(series, &less(&series.output, after)), Stroke::Dashed, 1));
        }
        (whole.size, rest.size) = ((860.0, 260.0), (860.0, 200.0));
        let noise = evidence.noise.sensor;
        let caption = format!(
            "Noise of one sample: {} {unit} at rest, correlated over {} s.",
            number(noise.sigma),
            number(noise.correlation_s)
        );
        page.figure(&whole.svg(), "");
        page.figure(&rest.svg(), &caption);
    }
}

fn over(series: &Run, values: &[f64]) -> Vec<(f64, f64)> {
    let each = series.time_s.iter().zip(values).zip(&series.compared);
    each.map(|((t, y), compared)| (*t, if *compared { *y } else { f64::NAN })).collect()
}

fn less(measured: &[f64], simulated: &[f64]) -> Vec<f64> {
    measured.iter().zip(simulated).map(|(m, s)| m - s).collect()
}

fn parameters(page: &mut Page, channel: &ChannelDiagnosis, evidence: &Evidence) {
    let interval = |(low, high): (f64, f64)| format!("{} to {}", number(low), number(high));
    let after = evidence.held.first().filter(|_| !channel.findings.is_empty()).map(|e| e.estimates(None));
    let mut rows = Vec::new();
    for (at, (name, value, bounds)) in evidence.base.estimates(None).into_iter().enumerate() {
        let extended = after.as_ref().and_then(|list| list.get(at));
        let told = extended.map_or_else(|| ("".to_owned(), String::new()), |e| (number(e.1), interval(e.2)));
        rows.push(vec![name.to_owned(), number(value), interval(bounds), told.0, told.1]);
    }
    for finding in &channel.findings {
        for (name, value, bounds) in &finding.parameters {
            let name = format!("{}: {name}", finding.code);
            rows.push(vec![name, String::new(), String::new(), number(*value), interval(*bounds)]);
        }
    }
    page.table(&["parameter", "base", "95 %", "extended", "95 %"], &rows);
    if let Some(held_out) = evidence.held_out.as_ref().filter(|_| !channel.findings.is_empty()) {
        let unit = channel.channel.unit();
        let fall = |was: f64, is: f64| format!("{} to {} {unit}", number(was), number(is));
        if let Some(gain) = &held_out.gain {
            page.paragraph(&format!(
                "Gain: {} On repeats of these commands that no fit has seen, the root mean square error falls from {}. Another \
                 session of the same commands would show that.",
                repeats(gain),
                fall(gain.before, gain.after)
            ));
        }
        page.paragraph(&format!(
            "On commands of other kinds than the fit has seen it goes from {}, and without what each run's own gain, zero and \
             time make of it from {}. Base and effects are both fitted without them.",
            fall(held_out.rmse_before, held_out.rmse_after),
            fall(held_out.of_law.0, held_out.of_law.1)
        ));
    }
}
