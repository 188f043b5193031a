//! `palpate trial analyse`.

use std::path::{Path, PathBuf};

use miette::{IntoDiagnostic, WrapErr, miette};

use super::arguments::{Analyse, DEFAULT_FOLDER};
use super::told;
use crate::control::ControlCurve;
use crate::ownership::OwnFolder;
use crate::report::trial as picture;
use crate::trial::confusion::Confusion;
use crate::trial::exact::{trials_for_width, trials_to_beat_chance};
use crate::trial::journal::{is_journal, read};
use crate::trial::stiffness::{self, Stiffness};
use crate::trial::weber::{Estimate, References, answers, estimate};

/// An analysis.
#[derive(Debug)]
pub(super) struct Analysed {
    pub(super) table: Confusion,
    pub(super) stiffness: Vec<Option<Stiffness>>,
    /// Weber fraction that is compared with, and what it would answer.
    pub(super) weber: f64,
    pub(super) references: References,
    pub(super) predicted: Option<Vec<Vec<f64>>>,
    pub(super) estimate: Option<Estimate>,
    pub(super) sizes: Sizes,
}

/// How many trials a certainty takes.
#[derive(Debug)]
pub(super) struct Sizes {
    pub(super) right: f64,
    pub(super) half_width: f64,
    pub(super) for_width: Option<u32>,
    pub(super) power: f64,
    pub(super) to_beat_chance: Option<u32>,
}

pub(super) fn run(asked: &Analyse) -> miette::Result<()> {
    let found = analysed(asked)?;
    let mut folder = OwnFolder::open(&asked.out, "--out", Some(DEFAULT_FOLDER)).into_diagnostic()?;
    let lines = told::lines(&found);
    let figure = picture::shares(&found.table, found.predicted.as_deref(), found.weber).svg();
    let page = picture::page(&found.table, &lines, &figure);
    let files = [("trial.html", page.html()), ("shares.svg", figure)];
    let written = files.map(|(name, text)| folder.write(name, text.as_bytes()).into_diagnostic());
    let written = written.into_iter().collect::<miette::Result<Vec<PathBuf>>>()?;
    if asked.json {
        outln!("{}", told::json(&found, &written));
        return Ok(());
    }
    for line in told::table(&found.table).into_iter().chain(lines) {
        outln!("{line}");
    }
    outln!("written {}", written[0].display());
    Ok(())
}

fn analysed(asked: &Analyse) -> miette::Result<Analysed> {
    let table = table(&asked.files)?;
    if table.total().trials == 0 {
        return Err(miette!("{}: nothing is answered yet", table.title));
    }
    let read = |file: &PathBuf| ControlCurve::read(file).into_diagnostic();
    let curves = asked.curve.iter().map(read).collect::<miette::Result<Vec<_>>>()?;
    if let Some((name, _)) =
        asked.stiffness.iter().find(|(name, _)| !table.names.iter().any(|n| n.eq_ignore_ascii_case(name)))
    {
        return Err(miette!("--stiffness {name}: no such material; expected one of {}", table.names.join(", ")));
    }
    let stiffness = stiffness::of(&table.names, &asked.stiffness, &curves);
    let values: Option<Vec<f64>> = stiffness.iter().map(|one| one.as_ref().map(|one| one.value)).collect();
    let references = if asked.known { References::Known } else { References::Touched };
    let right = asked.right.unwrap_or_else(|| table.total().value());
    let chance = 1.0 / table.names.len() as f64;
    Ok(Analysed {
        predicted: values.as_ref().map(|values| answers(values, asked.weber, references)),
        estimate: values.as_ref().and_then(|values| estimate(&table.counts, values, references)),
        weber: asked.weber,
        references,
        stiffness,
        sizes: Sizes {
            right,
            half_width: asked.half_width,
            for_width: trials_for_width(right, asked.half_width),
            power: asked.power,
            to_beat_chance: trials_to_beat_chance(right, chance, asked.power),
        },
        table,
    })
}

/// Counts of the files: journals together, or one table.
fn table(files: &[PathBuf]) -> miette::Result<Confusion> {
    let example = |file: &Path| match file.to_str() {
        Some("thesis-table-8") => Some(Confusion::thesis_table_8()),
        Some("thesis-table-9") => Some(Confusion::thesis_table_9()),
        _ => None,
    };
    let text =
        |file: &Path| std::fs::read_to_string(file).into_diagnostic().wrap_err_with(|| file.display().to_string());
    if let [file] = files {
        if let Some(table) = example(file).filter(|_| !file.exists()) {
            return Ok(table);
        }
        let text = text(file)?;
        if !is_journal(&text) {
            return Ok(Confusion::parse(file, &text)?);
        }
    }
    let mut sessions = Vec::new();
    for file in files {
        if !is_journal(&text(file)?) {
            return Err(miette!(
                "{}: no journal of palpate trial run; a table or an example stands alone",
                file.display()
            ));
        }
        let (session, given) = read(file)?;
        sessions.push((file.clone(), session, given));
    }
    Ok(Confusion::of_journals(&sessions)?)
}
