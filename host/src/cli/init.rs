//! `palpate init`.

use std::io::{BufRead as _, IsTerminal as _};
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use miette::{IntoDiagnostic, WrapErr, miette};
use serde_json::json;

use crate::experiment::Test;
use crate::init::{self, Draft, Options};

/// Recordings as a machine wrote them, and what they do not say.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Data files: text in any layout, or workbooks (xlsx, xls, ods)
    #[arg(required = true, value_name = "FILES")]
    files: Vec<PathBuf>,
    /// Radius of the ball, mm
    #[arg(long, value_name = "MM", value_parser = length)]
    ball_mm: Option<f64>,
    /// Height of the specimen, mm
    #[arg(long, value_name = "MM", value_parser = length)]
    height_mm: Option<f64>,
    /// Radius of the specimen, mm
    #[arg(long, value_name = "MM", value_parser = length)]
    radius_mm: Option<f64>,
    /// What was done, where the files do not say it
    #[arg(long, value_enum)]
    test: Option<TestArgument>,
    /// Folder for experiment.toml [default: a new one named after the first file]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print one JSON object on standard output
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum TestArgument {
    Indentation,
    Uniaxial,
    Confined,
    Tension,
    Air,
}

impl TestArgument {
    fn test(self) -> Test {
        match self {
            TestArgument::Indentation => Test::Indentation,
            TestArgument::Uniaxial => Test::Uniaxial,
            TestArgument::Confined => Test::Confined,
            TestArgument::Tension => Test::Tension,
            TestArgument::Air => Test::Air,
        }
    }
}

/// A length that `experiment.toml` takes.
fn length(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| "expected a number of mm".to_owned())?;
    (0.05..=1000.0).contains(&value).then_some(value).ok_or_else(|| "expected 0.05 to 1000 mm".to_owned())
}

/// Looks at the files, writes the experiment and says what was found.
///
/// # Errors
/// No file with numbers, a folder that has an `experiment.toml` already, a file that cannot be written.
pub fn run(arguments: &Arguments) -> miette::Result<()> {
    let first = arguments.files.first().ok_or_else(|| miette!("no file is named"))?;
    let folder = arguments.out.clone().unwrap_or_else(|| init::free_folder(first));
    if folder.join("experiment.toml").symlink_metadata().is_ok() {
        return Err(miette!(
            "{} is there already and is not written over; name another folder with --out",
            folder.join("experiment.toml").display()
        ));
    }
    let mut options = Options {
        ball_mm: arguments.ball_mm,
        height_mm: arguments.height_mm,
        radius_mm: arguments.radius_mm,
        test: arguments.test.map(TestArgument::test),
    };
    let mut draft = init::look(&arguments.files, &options);
    if draft.runs.is_empty() {
        let why: Vec<String> = draft.left_out.iter().map(|(file, why)| format!("{}: {why}", file.display())).collect();
        return Err(miette!("none of the files holds a recording\n{}", why.join("\n")));
    }
    if !arguments.json && std::io::stdin().is_terminal() && std::io::stderr().is_terminal() {
        ask(&draft, &mut options);
    }
    std::fs::create_dir_all(&folder)
        .into_diagnostic()
        .wrap_err_with(|| format!("cannot make the folder {}", folder.display()))?;
    draft.check(&folder, &options);
    let text = draft.text(&folder, &options);
    let file = init::write(&folder, &text).into_diagnostic().wrap_err_with(|| {
        format!("cannot write {}; nothing is written over", folder.join("experiment.toml").display())
    })?;
    tell(&draft, &file, &options, arguments.json);
    Ok(())
}

/// Asks on the terminal for what is still to be filled in; an empty line leaves it.
fn ask(draft: &Draft, options: &mut Options) {
    let open = draft.to_fill_in(Path::new("."), options).join(" ");
    let wanted = [
        ("[indenter.ball] radius_mm", "Radius of the ball, mm", &mut options.ball_mm),
        ("[specimen.specimen] height_mm", "Height of the specimen, mm", &mut options.height_mm),
        ("[specimen.specimen] radius_mm", "Radius of the specimen, mm", &mut options.radius_mm),
    ];
    for (key, question, answer) in wanted {
        if !open.contains(key) {
            continue;
        }
        errln!("{question} (empty: fill it in later):");
        let mut line = String::new();
        if std::io::stdin().lock().read_line(&mut line).is_err() {
            return;
        }
        match line.trim() {
            "" => {}
            text => match length(&text.replace(',', ".")) {
                Ok(mm) => *answer = Some(mm),
                Err(why) => errln!("\"{text}\" is left out: {why}"),
            },
        }
    }
}

/// What was found and what is to be done, as a table or as JSON.
fn tell(draft: &Draft, file: &Path, options: &Options, as_json: bool) {
    let folder = file.parent().unwrap_or(Path::new(".")).to_owned();
    let open = draft.to_fill_in(&folder, options);
    if as_json {
        let runs: Vec<_> = draft
            .runs
            .iter()
            .map(|run| {
                let keys: serde_json::Map<_, _> =
                    run.keys().map(|(key, value)| (key.to_owned(), json!(value))).collect();
                json!({"file": run.path, "label": run.label, "test": run.test_word(), "keys": keys,
                       "shows": run.shown(), "notes": run.notes})
            })
            .collect();
        let left_out: Vec<_> = draft.left_out.iter().map(|(file, why)| json!({"file": file, "why": why})).collect();
        outln!(
            "{}",
            json!({"experiment": file, "runs": runs, "left_out": left_out, "to_fill_in": open, "unread": draft.unread})
        );
        return;
    }
    let wide = draft.runs.iter().map(|run| run.label.chars().count()).max().unwrap_or(0);
    for run in &draft.runs {
        outln!("{:wide$}  {:11}  {}", run.label, run.test_word(), run.shown());
        for note in &run.notes {
            outln!("{:wide$}  {note}", "");
        }
    }
    for (file, why) in &draft.left_out {
        outln!("{}: left out, {why}", file.display());
    }
    outln!("written {}", file.display());
    if let Some(error) = &draft.unread {
        outln!("it cannot be read as it is: {error}");
    }
    for key in &open {
        outln!("to fill in: {key}");
    }
    if draft.unread.is_none() && draft.runs.iter().any(|run| run.test != Test::Table) {
        outln!("then: palpate identify {}", folder.display());
    }
}
