//! `palpate diagnose`.

use std::path::{Path, PathBuf};

use clap::Args;
use miette::{IntoDiagnostic, WrapErr};

use crate::diagnose::{self, Diagnosis, Evidence, Finding, Models};
use crate::experiment::{self, Experiment};
use crate::extended::ExtendedModel;
use crate::extended::display::DisplayModel;
use crate::report::{self, Page, number};

use super::progress::Progress;

/// What to diagnose, and how to tell it.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Folder with experiment.toml
    experiment: PathBuf,
    /// Print one JSON object on standard output
    #[arg(long)]
    json: bool,
    /// Folder of the HTML report with figures [default: out/diagnose; with --json none]
    #[arg(long, value_name = "DIR")]
    report: Option<PathBuf>,
    /// File for the extended model, if anything is named [default: model.toml beside the report]
    #[arg(long, value_name = "FILE")]
    model: Option<PathBuf>,
}

impl Arguments {
    /// Folder of the report: people get the figures without asking, scripts say where they want them.
    fn folder(&self) -> Option<PathBuf> {
        self.report.clone().or_else(|| (!self.json).then(|| PathBuf::from("out/diagnose")))
    }

    /// Writes a page where there is a folder for it, and says where it is.
    fn written(&self, file: &str, page: impl FnOnce() -> Page) -> miette::Result<Option<String>> {
        let Some(file) = self.folder().map(|folder| folder.join(file)) else { return Ok(None) };
        let cannot = || format!("cannot write the report to {}", file.display());
        page().write(&file).into_diagnostic().wrap_err_with(cannot)?;
        Ok(Some(file.display().to_string()))
    }
}

/// Reads, diagnoses, tells.
///
/// # Errors
/// Bad input, a force model that fails, or a report that cannot be written.
pub fn run(arguments: &Arguments) -> miette::Result<()> {
    let experiment = experiment::read(&arguments.experiment)?;
    let tables = diagnose::table::diagnose(&experiment).map_err(|cause| miette::miette!("{cause}"))?;
    if let Some(table) = &tables {
        let others = experiment.runs.iter().any(|run| run.test != experiment::Test::Table);
        report_table(arguments, &experiment, table, others)?;
        if !others {
            return Ok(());
        }
    }
    let progress = Progress::new();
    // The display is asked first: it costs no finite elements.
    let display = diagnose::display::diagnose(&experiment, &|what: &str, done, total| progress.set(what, done, total));
    if let Some(display) = &display {
        let others =
            experiment.runs.iter().any(|run| ![experiment::Test::Display, experiment::Test::Table].contains(&run.test));
        progress.end();
        report_display(arguments, &experiment, display, others)?;
        if !others {
            return Ok(());
        }
    }
    let compressed = diagnose::compression::diagnose(&experiment);
    let indented = experiment.runs.iter().any(|run| run.test == experiment::Test::Indentation);
    if !compressed.is_empty() {
        report_compressed(arguments, &experiment, &compressed, indented)?;
        if !indented {
            return Ok(());
        }
    }
    let progress = Progress::new();
    let models = Models::kept();
    let tell = |what: &str, done: usize, total: usize| progress.set(what, done, total);
    let found = diagnose::diagnose(&experiment, &models, &tell);
    progress.end();
    let found = found.map_err(|cause| miette::miette!("{cause}"))?;
    let folder = arguments.folder();
    let written = arguments.written("report.html", || report::diagnosis::page(&experiment, &found))?;
    let beside = folder.as_ref().map(|folder| folder.join("model.toml"));
    let models = match arguments.model.as_ref().or(beside.as_ref()) {
        Some(file) => save(&experiment, &found, file)?,
        None => vec![None; found.len()],
    };
    let told = |(one, model): (&Diagnosis, &Option<String>)| {
        let mut answer = diagnose::answer::json(one, written.as_deref());
        answer["model"] = serde_json::json!(model);
        answer
    };
    if let (true, Some(display)) = (arguments.json, &display) {
        let told: Vec<_> = found.iter().zip(&models).map(told).collect();
        outln!(
            "{}",
            serde_json::json!({ "materials": told, "display": diagnose::display::answer::json(display, None) })
        );
        return Ok(());
    }
    if arguments.json {
        let found: Vec<(&Diagnosis, &Option<String>)> = found.iter().zip(&models).collect();
        match found.as_slice() {
            [only] if compressed.is_empty() => outln!("{}", told(*only)),
            all => {
                let mut each: Vec<serde_json::Value> = all.iter().copied().map(told).collect();
                each.extend(compressed.iter().map(|one| diagnose::compression::answer::json(one, written.as_deref())));
                outln!("{}", serde_json::json!({ "materials": each }));
            }
        }
        return Ok(());
    }
    if found.is_empty() {
        outln!("verdict          nothing to diagnose: the experiment holds no run that indents a soft specimen");
    }
    for (one, model) in found.iter().zip(&models) {
        print(one);
        if let Some(file) = model {
            outln!("model            {file}");
        }
    }
    if let Some(file) = written {
        outln!("report           {file}");
    }
    Ok(())
}

/// Writes the extended model of every material that something was named for, and says where each is. Of several materials each has a
/// file of its own, with its name in the file's.
fn save(experiment: &Experiment, found: &[Diagnosis], file: &Path) -> miette::Result<Vec<Option<String>>> {
    let mut written = Vec::new();
    for one in found {
        let Some(model) = ExtendedModel::of(experiment, one) else {
            written.push(None);
            continue;
        };
        let mut path = file.to_owned();
        if found.len() > 1 {
            let stem = file.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
            let plain: String = one.material.chars().map(|c| if c.is_alphanumeric() { c } else { '-' }).collect();
            path.set_file_name(format!("{stem}-{plain}.toml"));
        }
        super::file::save(&path, model.to_toml().as_bytes())?;
        written.push(Some(path.display().to_string()));
    }
    Ok(written)
}

/// Writes and tells what was found about materials that are compressed only; with indentations beside them, JSON
/// comes later, in one object.
fn report_compressed(
    arguments: &Arguments,
    experiment: &Experiment,
    found: &[diagnose::compression::Diagnosis],
    indented: bool,
) -> miette::Result<()> {
    let file = if indented { "compression.html" } else { "report.html" };
    let written = arguments.written(file, || report::compression::page(experiment, found))?;
    if !arguments.json {
        for one in found {
            crate::print::out(format_args!("{}", report::compression::summary(one)));
        }
        if let Some(file) = written {
            outln!("report           {file}");
        }
    } else if !indented {
        let each: Vec<_> =
            found.iter().map(|one| diagnose::compression::answer::json(one, written.as_deref())).collect();
        match each.as_slice() {
            [only] => outln!("{only}"),
            all => outln!("{}", serde_json::json!({ "materials": all })),
        }
    }
    Ok(())
}

/// Writes and tells what was found about a table; with other runs beside it, JSON comes later, in one
/// object.
fn report_table(
    arguments: &Arguments,
    experiment: &Experiment,
    found: &diagnose::table::Diagnosis,
    others: bool,
) -> miette::Result<()> {
    let file = if others { "table.html" } else { "report.html" };
    let written = arguments.written(file, || report::readings::page(experiment, found))?;
    if !arguments.json {
        crate::print::out(format_args!("{}", report::readings::summary(found)));
        if let Some(file) = written {
            outln!("report           {file}");
        }
    } else if !others {
        outln!("{}", diagnose::table::answer::json(found, written.as_deref()));
    }
    Ok(())
}

/// Writes and tells what was found about a display; with other runs beside it, JSON comes later, in one object.
fn report_display(
    arguments: &Arguments,
    experiment: &experiment::Experiment,
    found: &diagnose::display::Diagnosis,
    others: bool,
) -> miette::Result<()> {
    let folder = arguments.folder();
    let stem = if others { "display-model.toml" } else { "model.toml" };
    let beside = folder.as_ref().map(|folder| folder.join(stem));
    let named = arguments.model.as_ref().filter(|_| !others).or(beside.as_ref());
    let mut model = None;
    if let (Some(file), Some(found)) = (named, DisplayModel::of(found)) {
        super::file::save(file, found.to_toml().as_bytes())?;
        model = Some(file.display().to_string());
    }
    let file = if others { "display.html" } else { "report.html" };
    let written = arguments.written(file, || report::display::page(experiment, found))?;
    if !arguments.json {
        crate::print::out(format_args!("{}", report::display::summary(found)));
        if let Some(file) = model {
            outln!("model            {file}");
        }
        if let Some(file) = written {
            outln!("report           {file}");
        }
    } else if !others {
        let mut answer = diagnose::display::answer::json(found, written.as_deref());
        answer["model"] = serde_json::json!(model);
        outln!("{answer}");
    }
    Ok(())
}

fn print(found: &Diagnosis) {
    outln!("material         {}", found.material);
    outln!("verdict          {}", found.verdict.word());
    outln!("                 {}", report::diagnosis::sentence(found));
    if let Some(refusal) = &found.refusal {
        outln!("because          {refusal}");
    }
    for fault in &found.faults {
        outln!("fault            {fault} ({})", fault.code());
    }
    for finding in &found.findings {
        print_finding(finding);
    }
    if let Some(told) = report::diagnosis::remainder(found) {
        outln!("remainder        {told}");
    }
    if !found.shows_in.is_empty() {
        outln!("shows in         {}", found.shows_in.join(", "));
    }
    for note in found.notes() {
        outln!("note             {note}");
    }
    let Some(evidence) = &found.evidence else { return };
    if found.is_named() {
        print_gain(found, evidence);
    } else {
        for (name, (value, (low, high))) in ["mu_MPa", "alpha"].iter().zip(evidence.before.parameters) {
            outln!("{name:16} {:>10}  95 %: {} to {}", number(value), number(low), number(high));
        }
    }
    for told in evidence.widened(found.is_named()) {
        outln!("interval         {told}");
    }
    if !found.blind_to.is_empty() {
        outln!("blind to         {}", found.blind_to.join(", "));
    }
    for both in &found.cancelling {
        outln!("cannot exclude   {both}");
    }
    if let Some(next) = found.proposals.first() {
        outln!("next run         {}", next.what);
        outln!("  would tell     {}", next.decides.join(", "));
    }
    outln!("solves           {} in {:.1} s", evidence.solves, found.seconds);
}

fn print_finding(finding: &Finding) {
    let twins = match finding.ambiguous_with.as_slice() {
        [] => String::new(),
        others => format!(", or {}", others.join(", or ")),
    };
    let of = match finding.of.as_slice() {
        [] => String::new(),
        names => format!(" of {}", names.join(" or of ")),
    };
    outln!("effect           {} ({}){of}{twins}", finding.code, finding.form);
    outln!("  probability    {:>10}", report::diagnosis::probability(finding.probability));
    if let Some(share) = finding.explains {
        outln!("  explains       {:>10} of the misfit", report::diagnosis::percent(share));
    }
    for (name, value, (low, high)) in &finding.parameters {
        outln!("  {name:14} {:>10}  95 %: {} to {}", number(*value), number(*low), number(*high));
    }
    let separating = lut_gen::effect::find(finding.code, Some(finding.form)).map(|effect| effect.separated_by);
    if let Some(run) = separating.filter(|_| !finding.ambiguous_with.is_empty()) {
        outln!("  decided by     {run}");
    }
}

/// Parameters and held-out errors, before and after.
fn print_gain(found: &Diagnosis, evidence: &Evidence) {
    let Some(after) = found.extended() else { return };
    let before = evidence.before.parameters;
    for (name, (was, is)) in ["mu_MPa", "alpha"].iter().zip(before.iter().zip(&after)) {
        let (low, high) = is.1;
        outln!("{name:16} {:>10} -> {}  95 %: {} to {}", number(was.0), number(is.0), number(low), number(high));
    }
    if let Some(held_out) = found.held_out() {
        let (was, is) = (held_out.rmse_before_n, held_out.rmse_after_n);
        outln!("held out, N      {:>10} -> {}  rms", number(was), number(is));
        let (was, is) = held_out.percent_of_peak();
        outln!("  % of the peak  {:>10} -> {}", number(was), number(is));
    }
}
