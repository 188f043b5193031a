//! The text of an `experiment.toml` with what was guessed and why.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use crate::experiment::Test;

use super::channels::Stated;
use super::options::Options;

/// What stands where a number is to be filled in; reading it is an error that names the key.
pub(super) const FILL_IN: &str = "\"FILL IN\"";

/// Where a key belongs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Table {
    /// `[format]`, of all runs if they agree.
    Format,
    /// `[columns]`, of all runs if they agree.
    Columns,
    /// The format of this run.
    RunFormat,
    /// The run itself.
    Run,
}

/// A key, its value as TOML, and why.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Key {
    pub table: Table,
    pub name: String,
    pub value: String,
    pub why: String,
}

impl Key {
    pub fn new(table: Table, name: &str, value: String, why: &str) -> Self {
        Self { table, name: name.to_owned(), value, why: why.to_owned() }
    }
}

/// A run that was found in a file.
#[derive(Debug, Clone)]
pub struct RunDraft {
    /// The data file.
    pub path: PathBuf,
    /// File, and what of it.
    pub label: String,
    /// What was done, as far as the file says it.
    pub test: Test,
    /// What should be looked at.
    pub notes: Vec<String>,
    pub(super) keys: Vec<Key>,
    pub(super) stated: Stated,
    /// What the data show, once they were read.
    pub(super) shown: String,
}

impl RunDraft {
    pub(super) fn new(path: &Path, test: Test, stated: Stated) -> Self {
        let label = path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
        Self { path: path.to_owned(), label, test, notes: Vec::new(), keys: Vec::new(), stated, shown: String::new() }
    }

    /// The keys that it needs, as (key, value in TOML).
    pub fn keys(&self) -> impl Iterator<Item = (&str, &str)> {
        self.keys.iter().map(|key| (key.name.as_str(), key.value.as_str()))
    }
}

/// A text as TOML.
pub(super) fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}

/// The whole text.
pub(super) fn text(runs: &[RunDraft], folder: &Path, options: &Options) -> String {
    let name = folder.file_name().map_or("experiment".into(), |name| name.to_string_lossy());
    let mut text = "# Written by `palpate init`. Behind each # stands why; look at every GUESS.\n".to_owned();
    let _ = writeln!(text, "name = {}\n", quoted(&name));
    for (table, title) in [(Table::Columns, "columns"), (Table::Format, "format")] {
        let keys = shared(runs, table);
        if !keys.is_empty() {
            let _ = writeln!(text, "[{title}]");
            keys.iter().for_each(|key| line(&mut text, &key.name, &key.value, &key.why));
            text.push('\n');
        }
    }
    specimen(&mut text, runs, options);
    for run in runs {
        text.push_str("[[run]]");
        text.push_str(&if run.shown.is_empty() { "\n".to_owned() } else { format!("    # {}\n", run.shown) });
        let file = between(folder, &run.path);
        line(&mut text, "file", &quoted(&file.to_string_lossy().replace('\\', "/")), "");
        if run.test != Test::Indentation {
            line(&mut text, "test", &quoted(word(run.test)), "");
        }
        if run.test != Test::Table {
            line(&mut text, "specimen", "\"specimen\"", "");
        }
        if run.test == Test::Indentation {
            line(&mut text, "indenter", "\"ball\"", "");
        }
        for key in run.keys.iter().filter(|key| key.table == Table::Run) {
            line(&mut text, &key.name, &key.value, &key.why);
        }
        inline(&mut text, runs, run, "format", &[Table::Format, Table::RunFormat]);
        inline(&mut text, runs, run, "columns", &[Table::Columns]);
        text.push('\n');
    }
    text
}

fn line(text: &mut String, key: &str, value: &str, why: &str) {
    let pair = format!("{key} = {value}");
    let _ = if why.is_empty() {
        writeln!(text, "{pair}")
    } else {
        writeln!(text, "{pair:<40} # {}", why.replace(['\n', '\r'], " "))
    };
}

/// The keys that all runs have with the same value.
fn shared(runs: &[RunDraft], table: Table) -> Vec<&Key> {
    let Some(first) = runs.first() else { return Vec::new() };
    let same = |key: &Key| {
        runs.iter().all(|run| {
            run.keys.iter().any(|other| (other.table, &other.name, &other.value) == (key.table, &key.name, &key.value))
        })
    };
    first.keys.iter().filter(|key| key.table == table && same(key)).collect()
}

/// The keys of a run that others do not have or have with another value.
fn inline(text: &mut String, runs: &[RunDraft], run: &RunDraft, name: &str, tables: &[Table]) {
    let shared: Vec<&str> = tables
        .iter()
        .flat_map(|table| shared(runs, *table))
        .filter(|k| k.table != Table::RunFormat)
        .map(|k| k.name.as_str())
        .collect();
    let own = run.keys.iter().filter(|key| tables.contains(&key.table) && !shared.contains(&key.name.as_str()));
    for key in own {
        line(text, &format!("{name}.{}", key.name), &key.value, &key.why);
    }
}

fn specimen(text: &mut String, runs: &[RunDraft], options: &Options) {
    if runs.iter().all(|run| run.test == Test::Table) {
        return;
    }
    let said = runs.first().map(|run| run.stated).unwrap_or_default();
    let number = |value: Option<f64>| value.map(|value| format!("{value:?}"));
    let indented = runs.iter().any(|run| run.test == Test::Indentation);
    let height = match (options.height_mm, said.height_mm) {
        (None, Some(height)) => (format!("{height:?}"), "GUESS: stated above the numbers"),
        (given, _) => (number(given).unwrap_or(FILL_IN.to_owned()), "mm, under the indenter, or \"unknown\""),
    };
    let radius = match (options.radius_mm, said.diameter_mm) {
        (None, Some(diameter)) => {
            (format!("{:?}", 0.5 * diameter), "GUESS: half the diameter stated above the numbers")
        }
        (None, None) if indented => {
            ("\"unknown\"".to_owned(), "mm; of little weight where it is above five times the ball's")
        }
        (given, _) => (number(given).unwrap_or(FILL_IN.to_owned()), "mm"),
    };
    text.push_str("[specimen.specimen]\n");
    line(text, "base_law", "\"hyperfoam\"", "GUESS: a foam; \"ogden\" for rubber, gel and tissue");
    line(text, "height_mm", &height.0, height.1);
    line(text, "radius_mm", &radius.0, radius.1);
    line(text, "base", "\"bonded\"", "GUESS: \"sliding\" if it is free to slide on its table");
    text.push('\n');
    if indented {
        text.push_str("[indenter.ball]\n");
        line(text, "radius_mm", &number(options.ball_mm).unwrap_or(FILL_IN.to_owned()), "mm, of the ball");
        text.push('\n');
    }
}

/// The name of a test in the contract.
pub(super) fn word(test: Test) -> &'static str {
    match test {
        Test::Indentation => "indentation",
        Test::Uniaxial => "uniaxial",
        Test::Confined => "confined",
        Test::Tension => "tension",
        Test::Shear => "shear",
        Test::Air => "air",
        Test::Mass => "mass",
        Test::Display => "display",
        Test::Table => "table",
        Test::Print => "print",
    }
}

/// The way from a folder to a file; the file's own where they share nothing.
fn between(folder: &Path, file: &Path) -> PathBuf {
    let whole =
        |path: &Path| path.canonicalize().or_else(|_| std::path::absolute(path)).unwrap_or_else(|_| path.to_owned());
    let (folder, file) = (whole(folder), whole(file));
    let shared = folder.components().zip(file.components()).take_while(|(a, b)| a == b).count();
    if shared == 0 {
        return file;
    }
    let up = folder.components().skip(shared).map(|_| std::path::Component::ParentDir);
    up.chain(file.components().skip(shared)).collect()
}
