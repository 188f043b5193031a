//! Recordings of a ball pressed into a specimen: what `palpate diagnose` says.

use std::path::Path;

use palpate::diagnose::design::Branch;
use palpate::diagnose::noise::Source;
use palpate::diagnose::{Diagnosis, Evidence, Models, diagnose};
use palpate::experiment::{BaseLaw, Experiment, Length};
use palpate::report::diagnosis::sentence;
use palpate::report::figure::{Axis, Figure, Series, Stroke};
use palpate::report::number;
use tests::document::table;

use super::{Outcome, independent, picture, recorded};

fn short(x: f64) -> String {
    number(format!("{x:.2e}").parse().unwrap_or(x))
}

/// The verdict, and what it rests on.
fn told(what: &str, found: &Diagnosis) -> Vec<Vec<String>> {
    let mut rows = vec![vec![what.to_owned(), format!("**{}**", sentence(found))]];
    let mut row = |name: &str, text: String| {
        if !text.is_empty() {
            rows.push(vec![name.to_owned(), text]);
        }
    };
    for finding in &found.findings {
        let one = |(name, value, (low, high)): &(&str, f64, (f64, f64))| {
            format!("{name} {} ({} to {})", short(*value), short(*low), short(*high))
        };
        let values: Vec<String> = finding.parameters.iter().map(one).collect();
        row(&format!("{} ({})", finding.code, finding.form), values.join("; "));
        row("not told apart from it", finding.ambiguous_with.join(", "));
    }
    row("shows in", found.shows_in.join(", "));
    let faults: Vec<String> = found.faults.iter().map(|fault| format!("{fault} ({})", fault.code())).collect();
    row("faults", faults.join("; "));
    if let Some(evidence) = found.evidence.as_deref() {
        row("noise", noise(evidence));
        row("base", base(evidence));
        row("likeliest sets", nearest(evidence));
        if let Some(held) = &evidence.held_out {
            let (before, after) = (1e3 * held.rmse_before_n, 1e3 * held.rmse_after_n);
            row(
                "left-out conditions",
                format!("{before:.1} mN before, {after:.1} mN after ({})", held.conditions.join(", ")),
            );
        }
    }
    row("blind to", found.blind_to.join(", "));
    let next = found.proposals.first().map(|next| format!("{} (would tell {})", next.what, next.decides.join(", ")));
    row("next run", next.unwrap_or_default());
    rows
}

fn noise(evidence: &Evidence) -> String {
    let noise = &evidence.noise;
    let source = if noise.source == Source::Stated { "stated" } else { "from repeats" };
    format!(
        "{source}: sensor {} mN with a time of {} s, contact {} mm, gain {} %, zero {} mN",
        short(1e3 * noise.sensor.sigma_n),
        short(noise.sensor.correlation_s),
        short(noise.jitter.contact_mm),
        short(100.0 * noise.jitter.gain),
        short(1e3 * noise.jitter.zero_n)
    )
}

fn base(evidence: &Evidence) -> String {
    let [mu, alpha] = evidence.before.parameters;
    let nodes: usize = evidence.design.series.iter().map(|s| s.nodes.len()).sum();
    format!(
        "mu {} MPa ({} to {}), alpha {} ({} to {}); sum of squares {:.0} where {nodes} is expected",
        short(mu.0),
        short(mu.1.0),
        short(mu.1.1),
        short(alpha.0),
        short(alpha.1.0),
        short(alpha.1.1),
        evidence.base.square
    )
}

/// The three likeliest sets, with what stays without a name beside them.
fn nearest(evidence: &Evidence) -> String {
    let judged = &evidence.judged;
    let one = |(set, probability): (&palpate::diagnose::sets::Weighed, &f64)| {
        let codes: Vec<String> =
            set.fit.candidates.iter().map(|c| format!("{} ({})", c.effect.code, c.effect.form)).collect();
        let beside: Vec<String> =
            judged.beside(set).map(|(over, size)| format!("{over} {:.1} %", 100.0 * size)).collect();
        let beside = if beside.is_empty() { "nothing".to_owned() } else { beside.join(", ") };
        let names = if codes.is_empty() { "nothing".to_owned() } else { codes.join(" + ") };
        format!("{names}: probability {probability:.3}, beside it {beside}")
    };
    evidence.sets.iter().zip(&judged.sets).take(3).map(one).collect::<Vec<_>>().join("; ")
}

fn all(what: &str, experiment: &Experiment, models: &Models) -> Outcome<Vec<(String, Diagnosis)>> {
    let found = diagnose(experiment, models, &|step, done, total| {
        if done == total || done == 0 {
            eprintln!("{what}: {step} {done}/{total}");
        }
    })?;
    Ok(found.into_iter().map(|one| (what.to_owned(), one)).collect())
}

/// Measured and predicted, over depth on the way down and over time in the hold.
fn drawn(title: &str, evidence: &Evidence) -> [Figure; 2] {
    let mut over_depth = Figure::new(title, Axis::new("recorded depth (mm)"), Axis::new("force (N)"));
    let mut over_time = Figure::new("The hold", Axis::new("time since it began (s)"), Axis::new("force (N)"));
    over_time.size.1 = 260.0;
    for (at, series) in evidence.design.series.iter().enumerate() {
        let base = &evidence.before.curves[at];
        let at_zero = |k: usize| base.force_n[k];
        let nodes = || series.nodes.iter().enumerate();
        let down = |value: &dyn Fn(usize) -> f64| -> Vec<(f64, f64)> {
            nodes().filter(|(_, n)| n.branch == Branch::Loading).map(|(k, n)| (n.depth_mm, value(k))).collect()
        };
        let held = |value: &dyn Fn(usize) -> f64| -> Vec<(f64, f64)> {
            nodes().filter(|(_, n)| n.branch == Branch::Hold).map(|(k, n)| (n.held_s, value(k))).collect()
        };
        let measured = |k: usize| series.nodes[k].force_n;
        let last = at + 1 == evidence.design.series.len();
        let label = if last { "base" } else { "" };
        over_depth = over_depth.with(Series::new("", down(&measured), Stroke::Circles, at)).with(Series::new(
            label,
            down(&at_zero),
            Stroke::Solid,
            at,
        ));
        over_time = over_time.with(Series::new("", held(&measured), Stroke::Circles, at)).with(Series::new(
            label,
            held(&at_zero),
            Stroke::Solid,
            at,
        ));
    }
    [over_depth, over_time]
}

fn answer(found: &[(String, Diagnosis)]) -> String {
    let rows: Vec<Vec<String>> = found.iter().flat_map(|(what, one)| told(what, one)).collect();
    table(&["", "`palpate diagnose` says"], &rows)
}

/// Two muscles, six places each.
pub fn beef(figures: &Path) -> Outcome<Option<String>> {
    let Some(experiment) = recorded::experiment("beef_diagnosed", "data/beef_ball")? else { return Ok(None) };
    let models = Models::default();
    let mut found = all("", &experiment, &models)?;
    for one in &mut found {
        one.0.clone_from(&one.1.material);
    }
    let shown = found.len();
    if let Some(pieces) = recorded::experiment("beef_diagnosed_pieces", "data/beef_ball")? {
        let more = all("", &pieces, &models)?;
        found.extend(
            more.into_iter().map(|(_, one)| (format!("{}, with a second piece at other rates", one.material), one)),
        );
    }
    let mut out = answer(&found) + "\n" + &independent::section(&experiment) + "\n";
    for (name, one) in found.iter().take(shown) {
        if let Some(evidence) = one.evidence.as_deref() {
            let file = format!("real-diagnosis-beef-{}.svg", name.to_lowercase());
            let title = format!("Beef, {name}: measured (circles) and base (lines)");
            out += &picture(figures, &file, &title, &drawn(&title, evidence))?;
        }
    }
    Ok(Some(out))
}

/// One sheet, the first touch and later ones.
pub fn silicone(figures: &Path) -> Outcome<Option<String>> {
    let Some(experiment) = recorded::experiment("silicone_diagnosed", "data/silicone_ball")? else { return Ok(None) };
    let models = Models::default();
    let mut found = all("all runs as repeats of one another", &experiment, &models)?;
    let mut cycles = experiment.clone();
    for run in &mut cycles.runs {
        (run.spot, run.cycle) = (Some(1), run.order);
    }
    found.extend(all("one place, pressed for the 1st, 3rd, 4th, 6th and 7th time; noise stated", &cycles, &models)?);
    let mut without = cycles.clone();
    without.sensor.noise_n = None;
    found.extend(all("the same, no noise stated", &without, &models)?);
    let mut later = cycles;
    later.runs.remove(0);
    found.extend(all("the same without the first touch; noise stated", &later, &models)?);
    if let Some(mut whole) = recorded::experiment("silicone_ball", "data/silicone_ball")? {
        for specimen in &mut whole.specimens {
            (specimen.base_law, specimen.height_mm) = (BaseLaw::Ogden, Length::Known(17.7));
        }
        whole.sensor.noise_n = experiment.sensor.noise_n;
        found.extend(all("whole files, with the run that stops and starts again (P002-7)", &whole, &models)?);
    }
    let mut out = answer(&found) + "\n" + &independent::section(&experiment) + "\n";
    if let Some(evidence) = found[1].1.evidence.as_deref() {
        let title = "Silicone: measured (circles) and base (lines)";
        out += &picture(figures, "real-diagnosis-silicone.svg", title, &drawn(title, evidence))?;
    }
    Ok(Some(out))
}
