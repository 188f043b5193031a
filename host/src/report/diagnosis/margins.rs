//! Where the residual is: bars over the margins, and strips over all runs.

use crate::diagnose::Evidence;
use crate::diagnose::design::Branch;
use crate::diagnose::margin::{Margin, Variable};
use crate::experiment::Experiment;
use crate::report::{Page, number};

use super::bar::{Bar, Bars, Group};
use super::curves::Shown;
use super::drawn::Drawn;
use super::heat::{Heat, Line};
use super::words;

const VARIABLES: [Variable; 13] = [
    Variable::Depth,
    Variable::Unloading,
    Variable::HoldTime,
    Variable::Cycle,
    Variable::Rate,
    Variable::Radius,
    Variable::Height,
    Variable::Clock,
    Variable::Confined,
    Variable::Compression,
    Variable::Block,
    Variable::Mass,
    Variable::Air,
];
/// Residuals of this many standard deviations are drawn darkest.
const DARKEST: f64 = 6.0;
const BRANCHES: [(Branch, &str); 3] =
    [(Branch::Loading, "loading"), (Branch::Hold, "hold"), (Branch::Unloading, "unloading")];

/// The section.
pub(super) fn section(page: &mut Page, experiment: &Experiment, evidence: &Evidence, drawn: Option<&Drawn<'_>>) {
    page.section("Where the residual is");
    let adequacy = &evidence.adequacy;
    let told = match adequacy.shows_in.as_slice() {
        [] => "No margin exceeds its threshold.".to_owned(),
        list => {
            let words: Vec<&str> = list.iter().map(|v| v.word()).collect();
            format!("It shows in {}, the worst first.", words::listed(&words, "and"))
        }
    };
    page.paragraph(&format!(
        "Each bar is the mean residual over one part of the data, divided by its scatter in simulated experiments without any error. \
         In 995 of 1000 of these no bar exceeds {}. {told}",
        number((100.0 * adequacy.threshold).round() / 100.0)
    ));
    if evidence.margins.is_empty() {
        page.warning("No depth, rate, ball or cycle varies here, so the residual cannot be located.");
    } else {
        page.figure(&bars(experiment, evidence, drawn).svg(), caption(drawn.is_some()));
    }
    if let Some(heat) = strips(experiment, evidence, "Every run, base", false) {
        page.figure(&heat.svg(), STRIPS);
    }
    if let Some(drawn) = drawn {
        let title = format!("Every run, {}", drawn.name);
        if let Some(heat) = strips(experiment, evidence, &title, true) {
            page.figure(&heat.svg(), "");
        }
    }
}

const STRIPS: &str = "One line a run, time from left to right within each branch; measured minus simulated over the standard deviation of everything \
     that repeats differ by. Cells with + lie above the simulation, with - below it. Single dark cells are chance; dark \
     columns, lines or blocks are not.";

fn caption(drawn: bool) -> &'static str {
    if drawn {
        "Grey: inside the threshold, which noise alone would reach. Dark bars lie beyond it. Diamonds: what the dashed curves above leave, in units of its own scatter."
    } else {
        "Grey: inside the threshold, which noise alone would reach. Dark bars lie beyond it."
    }
}

fn bars(experiment: &Experiment, evidence: &Evidence, drawn: Option<&Drawn<'_>>) -> Bars {
    let after = drawn.and_then(|drawn| drawn.left).map(|left| &left.readings);
    let groups = VARIABLES.iter().filter_map(|variable| {
        let own = evidence.margins.iter().enumerate().filter(|(_, m)| m.variable == *variable);
        let bars: Vec<Bar> = own
            .map(|(at, margin)| Bar {
                name: label(experiment, margin),
                value: evidence.adequacy.readings.get(at).copied().unwrap_or(f64::NAN),
                mark: after.and_then(|all| all.get(at)).copied(),
            })
            .collect();
        (!bars.is_empty()).then(|| Group { name: variable.word().to_owned(), bars })
    });
    Bars {
        title: "What the base leaves, by margin".to_owned(),
        axis: "mean residual, in units of its scatter".to_owned(),
        mark: drawn.map(|drawn| drawn.name.clone()),
        threshold: evidence.adequacy.threshold,
        groups: groups.collect(),
    }
}

/// A margin's label with names in place of numbers.
fn label(experiment: &Experiment, margin: &Margin) -> String {
    let named = |head: &str, names: Vec<&str>| {
        let found = margin.label.strip_prefix(head).and_then(|rest| rest.split_once(','));
        let of = found.and_then(|(at, rest)| Some((names.get(at.trim().parse::<usize>().ok()?)?.to_owned(), rest)));
        of.map_or_else(|| margin.label.clone(), |(name, rest)| format!("{name},{rest}"))
    };
    match margin.variable {
        Variable::Radius => named("ball ", experiment.indenters.iter().map(|i| i.name.as_str()).collect()),
        Variable::Height => named("specimen ", experiment.specimens.iter().map(|s| s.name.as_str()).collect()),
        Variable::Rate => match margin.label.split_once(" mm/s") {
            Some((value, rest)) => {
                let shown = value.trim().parse().map_or_else(|_| value.to_owned(), words::rate);
                format!("{shown} mm/s{rest}")
            }
            None => margin.label.clone(),
        },
        _ => margin.label.clone(),
    }
}

/// Residuals of all runs; `None` for those after an explanation where there is none.
fn strips(experiment: &Experiment, evidence: &Evidence, title: &str, after: bool) -> Option<Heat> {
    let design = &evidence.design;
    let mut order: Vec<usize> = (0..design.series.len()).collect();
    let key = |at: usize| {
        let s = &design.series[at];
        (s.specimen, s.indenter, s.rate, s.spot, s.cycle)
    };
    order.sort_by_key(|at| key(*at));
    let mut lines: Vec<Line> = Vec::new();
    let mut last = None;
    for at in order {
        let shown = Shown::of(evidence, at);
        let residual = if after { shown.residual_after_n()? } else { shown.residual_n() };
        let series = &design.series[at];
        let nodes = series.nodes.iter().zip(residual.iter().zip(&shown.sigma_n));
        let of: Vec<(Branch, f64)> = nodes.map(|(n, (r, (_, sigma)))| (n.branch, r / sigma)).collect();
        let part = |branch: Branch| of.iter().filter(|(b, _)| *b == branch).map(|(_, z)| *z).collect();
        let name = if last == Some(series.group) { String::new() } else { name(experiment, evidence, at) };
        last = Some(series.group);
        lines.push(Line { name, parts: BRANCHES.iter().map(|(branch, _)| part(*branch)).collect() });
    }
    let mut parts: Vec<(String, f64)> = Vec::new();
    for (at, (_, word)) in BRANCHES.iter().enumerate() {
        let longest = lines.iter().map(|line| line.parts[at].len()).max().unwrap_or(0);
        parts.push(((*word).to_owned(), longest as f64));
    }
    // a branch that no run has takes no room
    let kept: Vec<usize> = (0..parts.len()).filter(|at| parts[*at].1 > 0.0).collect();
    let parts = kept.iter().map(|at| parts[*at].clone()).collect();
    for line in &mut lines {
        line.parts = kept.iter().map(|at| line.parts[*at].clone()).collect();
    }
    let unit = "size of the residual, in standard deviations".to_owned();
    Some(Heat { title: title.to_owned(), parts, lines, most: DARKEST, unit })
}

/// Ball, rate and, where there are several, specimen.
fn name(experiment: &Experiment, evidence: &Evidence, at: usize) -> String {
    let s = &evidence.design.series[at];
    let ball = experiment.indenters.get(s.indenter).map_or("", |i| i.name.as_str());
    let rate = words::rate(evidence.design.rates_mm_per_s[s.rate]);
    match experiment.specimens.get(s.specimen) {
        Some(its) if experiment.specimens.len() > 1 => format!("{}, {ball}, {rate} mm/s", its.name),
        _ => format!("{ball}, {rate} mm/s"),
    }
}
