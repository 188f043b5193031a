//! `palpate identify A B C...`: a table of many experiments.

use std::path::{Path, PathBuf};
use std::time::Instant;

use jiff::Timestamp;
use serde_json::{Value, json};

use crate::results::table::{Row, Table};
use crate::results::{Folder, FolderError, Place, Provenance};

use super::identify::{Arguments, Fitted};
use super::keep;

/// Identifies every experiment, whatever becomes of the others, and tells all in one table.
///
/// # Errors
/// What failed, after the table was told: experiments, or a folder that cannot be written.
pub(super) fn run(arguments: &Arguments, experiments: &[PathBuf]) -> miette::Result<()> {
    let start = Instant::now();
    let folder = arguments.place().map(|place| Folder::open(&place, "table", Timestamp::now()));
    let (folder, mut failed) = match folder.transpose() {
        Ok(folder) => (folder, Vec::new()),
        Err(why) => (None, vec![why.to_string()]),
    };
    let (mut table, mut answers) = (Table::default(), Vec::new());
    for path in experiments {
        let named = path.display().to_string();
        match arguments.fitted(path) {
            Ok(fitted) => {
                let mut answer = fitted.json(None);
                answer["experiment"] = json!(named);
                answer["name"] = json!(fitted.experiment.name);
                match folder.as_ref().map(|folder| kept(folder.path(), &fitted)).transpose() {
                    Ok(None) => {}
                    Ok(Some(results)) => answer["results"] = json!(results.display().to_string()),
                    Err(why) => failed.push(format!("{named}: {why}")),
                }
                answers.push(answer);
                table.rows.push(Row {
                    experiment: named,
                    name: fitted.experiment.name.clone(),
                    found: Ok(fitted.found),
                });
            }
            Err(why) => {
                errln!("{named}: {why:?}");
                answers.push(json!({ "experiment": named, "outcome": "failed", "error": told(&why) }));
                table.rows.push(Row { experiment: named, name: String::new(), found: Err(told(&why)) });
            }
        }
    }
    if arguments.json {
        outln!("{}", json!({ "experiments": answers }));
    } else {
        crate::print::out(format_args!("{}", table.text()));
    }
    if let Some(folder) = &folder {
        let written = all(folder, &table, answers, start)?;
        if !arguments.json {
            outln!("table            {}", written.display());
        }
    }
    failed.extend(table.failed().iter().map(|row| format!("{}: failed, see above", row.experiment)));
    if failed.is_empty() { Ok(()) } else { Err(miette::miette!("{}", failed.join("\n"))) }
}

/// What is wrong, with its causes, on one line.
fn told(why: &miette::Report) -> String {
    why.chain().map(ToString::to_string).collect::<Vec<_>>().join(": ")
}

/// A folder for one experiment, below that of the table.
fn kept(below: &Path, fitted: &Fitted) -> Result<PathBuf, FolderError> {
    let place = Place::Inside(below.to_owned());
    let folder = keep::identified(&place, &fitted.experiment, &fitted.found, &fitted.provenance, fitted.seconds)?;
    let notes = keep::rest(&folder, &fitted.experiment, &fitted.found, &fitted.provenance)?;
    notes.iter().for_each(|note| errln!("{note}"));
    Ok(folder.path().to_owned())
}

/// The table as CSV and JSON and as a page.
fn all(folder: &Folder, table: &Table, answers: Vec<Value>, start: Instant) -> Result<PathBuf, FolderError> {
    let of_call = Provenance::of([]);
    let provenance = of_call.json(start.elapsed().as_secs_f64());
    folder.sign(&provenance)?;
    let written = folder.write("table.csv", table.csv().as_bytes())?;
    let answer = json!({ "experiments": answers, "provenance": provenance });
    folder.write("result.json", format!("{answer}\n").as_bytes())?;
    let mut page = table.page();
    of_call.section(&mut page);
    folder.page("report.html", &page)?;
    Ok(written)
}
