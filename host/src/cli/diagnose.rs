//! `palpate diagnose`.

use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::Args;
use miette::IntoDiagnostic;
use serde_json::{Value, json};

use crate::diagnose::{self, Diagnosis, Evidence, Finding, Models};
use crate::experiment::{self, Experiment, Test};
use crate::extended::ExtendedModel;
use crate::extended::display::DisplayModel;
use crate::extended::magnet::MagnetModel;
use crate::report::{self, number};
use crate::results::{Folder, FolderError, Place, Provenance, curves, parameters};

use super::keep;
use super::progress::Progress;

/// What to diagnose, and how to tell it.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Folder with experiment.toml
    experiment: PathBuf,
    /// Print one JSON object on standard output
    #[arg(long)]
    json: bool,
    /// Folder of the results [default: a new one below out/diagnose; with --json none]
    #[arg(long, value_name = "DIR")]
    report: Option<PathBuf>,
    /// File for the model, if anything is named or nothing is wrong [default: model.toml beside the report]
    #[arg(long, value_name = "FILE")]
    model: Option<PathBuf>,
}

/// What was found, by what the runs were made on.
#[derive(Default)]
struct Found {
    table: Option<diagnose::table::Diagnosis>,
    display: Option<diagnose::display::Diagnosis>,
    compressed: Vec<diagnose::compression::Diagnosis>,
    /// None where no finite elements were asked: no run indents, and others were diagnosed.
    indented: Option<Vec<Diagnosis>>,
}

/// Files that were written, by what is told of them.
#[derive(Default)]
struct Written {
    report: Option<String>,
    /// One a material, none where nothing is to be kept of it.
    models: Vec<Option<String>>,
    display_model: Option<String>,
    table_model: Option<String>,
}

/// Reads, diagnoses, tells, and then keeps what was found.
///
/// # Errors
/// Bad input, a force model that fails, or results that cannot be kept: what was found is told before.
pub fn run(arguments: &Arguments) -> miette::Result<()> {
    let start = Instant::now();
    let experiment = experiment::read(&arguments.experiment)?;
    let provenance = Provenance::of_experiment(&arguments.experiment, &experiment, &[]);
    let mut found = Found::default();
    let failed = found.find(&experiment, arguments.json).err();
    let seconds = start.elapsed().as_secs_f64();
    let place = keep::place(arguments.report.as_ref(), arguments.json, "out/diagnose");
    if let (Some(failed), true) = (&failed, found.is_empty()) {
        return Err(miette::miette!("{failed}"));
    }
    let call = Call { arguments, experiment: &experiment, provenance: &provenance, found: &found };
    let mut written = Written::default();
    let folder = place.map(|place| call.answer(&place, seconds, &mut written)).transpose();
    let saved = call.models(folder.as_ref().ok().and_then(Option::as_ref), &mut written);
    if arguments.json {
        outln!("{}", found.json(&written));
    } else {
        written
            .models
            .iter()
            .flatten()
            .chain(&written.display_model)
            .chain(&written.table_model)
            .for_each(|file| outln!("model            {file}"));
    }
    if let Some(folder) = folder? {
        call.pages(&folder)?;
        if !arguments.json {
            outln!("results          {}", folder.path().display());
            outln!("report           {}", written.report.unwrap_or_default());
        }
    }
    saved?;
    failed.map_or(Ok(()), |failed| Err(miette::miette!("{failed}")))
}

impl Found {
    /// Diagnoses what is cheap first, and tells each part as soon as it is there.
    fn find(&mut self, experiment: &Experiment, quiet: bool) -> Result<(), String> {
        let tell = |text: String| {
            if !quiet {
                crate::print::out(format_args!("{text}"));
            }
        };
        let others = |than: &[Test]| experiment.runs.iter().any(|run| !than.contains(&run.test));
        self.table = diagnose::table::diagnose(experiment).map_err(|cause| cause.to_string())?;
        if let Some(table) = &self.table {
            tell(report::readings::summary(table));
            if !others(&[Test::Table]) {
                return Ok(());
            }
        }
        let progress = Progress::new();
        let ahead = |what: &str, done: usize, total: usize| progress.set(what, done, total);
        self.display = diagnose::display::diagnose(experiment, &ahead);
        if let Some(display) = &self.display {
            progress.end();
            tell(report::display::summary(display));
            if !others(&[Test::Display, Test::Table]) {
                return Ok(());
            }
        }
        self.compressed = diagnose::compression::diagnose(experiment);
        self.compressed.iter().for_each(|one| tell(report::compression::summary(one)));
        let indents = experiment.runs.iter().any(|run| run.test == Test::Indentation);
        if !self.compressed.is_empty() && !indents {
            return Ok(());
        }
        let found = diagnose::diagnose(experiment, &Models::kept(), &ahead);
        progress.end();
        let found = found.map_err(|cause| cause.to_string())?;
        if !quiet {
            if found.is_empty() {
                outln!("verdict          nothing to diagnose: no run indents a soft specimen");
            }
            found.iter().for_each(print);
        }
        self.indented = Some(found);
        Ok(())
    }

    fn is_empty(&self) -> bool {
        self.table.is_none() && self.display.is_none() && self.compressed.is_empty() && self.indented.is_none()
    }

    fn indented(&self) -> &[Diagnosis] {
        self.indented.as_deref().unwrap_or_default()
    }

    /// The answer: an object of its own where one thing was diagnosed, else one with all of them.
    fn json(&self, written: &Written) -> Value {
        let report = written.report.as_deref();
        let mut materials: Vec<Value> = Vec::new();
        for (at, one) in self.indented().iter().enumerate() {
            let mut answer = diagnose::answer::json(one, report);
            answer["model"] = json!(written.models.get(at).cloned().flatten());
            materials.push(answer);
        }
        materials.extend(self.compressed.iter().map(|one| diagnose::compression::answer::json(one, report)));
        let display = self.display.as_ref().map(|display| {
            let mut answer = diagnose::display::answer::json(display, report);
            answer["model"] = json!(written.display_model);
            answer
        });
        let table = self.table.as_ref().map(|table| {
            let mut answer = diagnose::table::answer::json(table, report);
            answer["model"] = json!(written.table_model);
            answer
        });
        let alone = materials.is_empty() && self.indented.is_none();
        let mut answer = match (display, table.as_ref()) {
            (Some(display), _) if alone => display,
            (Some(display), _) => json!({ "materials": materials, "display": display }),
            (None, Some(table)) if alone => return table.clone(),
            (None, _) if materials.len() == 1 => materials.swap_remove(0),
            (None, _) => json!({ "materials": materials }),
        };
        if let Some(table) = table {
            answer["table"] = table;
        }
        answer
    }
}

/// A call with what it found.
struct Call<'a> {
    arguments: &'a Arguments,
    experiment: &'a Experiment,
    provenance: &'a Provenance,
    found: &'a Found,
}

impl Call<'_> {
    /// Answer, curves and parameters.
    fn answer(&self, place: &Place, seconds: f64, written: &mut Written) -> Result<Folder, FolderError> {
        let (experiment, indented) = (self.experiment, self.found.indented());
        let told = self.found.json(&Written::default());
        let kept = (&told, curves::diagnosed(experiment, indented), parameters::diagnosed(experiment, indented));
        let folder = keep::answer(place, experiment, self.provenance, kept, seconds)?;
        written.report = Some(folder.path().join("report.html").display().to_string());
        Ok(folder)
    }

    /// Models of materials and of a display, where there is a place for them.
    fn models(&self, folder: Option<&Folder>, written: &mut Written) -> miette::Result<()> {
        let found = self.found.indented();
        written.models = vec![None; found.len()];
        let named = self.arguments.model.as_deref();
        for (at, one) in found.iter().enumerate() {
            let Some(model) = ExtendedModel::kept(self.experiment, one) else { continue };
            let file = |file: &Path| if found.len() > 1 { keep::named(file, &one.material) } else { file.to_owned() };
            written.models[at] = save(named.map(file), folder, &file(Path::new("model.toml")), &model.to_toml())?;
        }
        let alone = self.found.compressed.is_empty() && self.found.indented.is_none();
        if let Some(model) = self.found.display.as_ref().and_then(DisplayModel::of) {
            let usual = if alone { "model.toml" } else { "display-model.toml" };
            let named = named.filter(|_| alone).map(Path::to_owned);
            written.display_model = save(named, folder, Path::new(usual), &model.to_toml())?;
        }
        if let Some(model) = self.found.table.as_ref().and_then(|found| MagnetModel::of(self.experiment, found)) {
            let alone = alone && self.found.display.is_none();
            let usual = if alone { "model.toml" } else { "magnet-model.toml" };
            let named = self.arguments.model.as_deref().filter(|_| alone).map(Path::to_owned);
            let model = model.fitted(self.experiment).into_diagnostic()?;
            written.table_model = save(named, folder, Path::new(usual), &model.to_toml())?;
        }
        Ok(())
    }

    /// One page for each kind of run; the page of the only one, or of the indentations, is `report.html`.
    fn pages(&self, folder: &Folder) -> Result<(), FolderError> {
        let (experiment, found) = (self.experiment, self.found);
        let mut pages = Vec::new();
        if let Some(table) = &found.table {
            pages.push(("table.html", report::readings::page(experiment, table)));
        }
        if let Some(display) = &found.display {
            pages.push(("display.html", report::display::page(experiment, display)));
        }
        if !found.compressed.is_empty() {
            pages.push(("compression.html", report::compression::page(experiment, &found.compressed)));
        }
        if let Some(indented) = &found.indented {
            pages.push(("report.html", report::diagnosis::page(experiment, indented)));
        }
        let last = pages.len().saturating_sub(1);
        for (at, (name, mut page)) in pages.into_iter().enumerate() {
            self.provenance.section(&mut page);
            folder.page(if at == last { "report.html" } else { name }, &page)?;
        }
        Ok(())
    }
}

/// Writes a model where it was asked for, else into the folder of the results; nowhere without either.
fn save(named: Option<PathBuf>, folder: Option<&Folder>, usual: &Path, text: &str) -> miette::Result<Option<String>> {
    let file = match (named, folder) {
        (Some(file), _) => {
            super::file::save(&file, text.as_bytes())?;
            file
        }
        (None, Some(folder)) => folder.write(&usual.to_string_lossy(), text.as_bytes()).into_diagnostic()?,
        (None, None) => return Ok(None),
    };
    Ok(Some(file.display().to_string()))
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
