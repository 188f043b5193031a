//! Files of `palpate tune`: the page and its pictures.

use std::path::{Path, PathBuf};

use miette::IntoDiagnostic;

use super::{DEFAULT_FOLDER, told};
use crate::actuator::Actuator;
use crate::ownership::OwnFolder;
use crate::report::{Page, tuning};
use crate::tune::limits::Rule;
use crate::tune::study::Study;

/// Names of the pictures, in their order.
const NAMES: [&str; 7] = ["step", "command", "bode-gain", "bode-phase", "nyquist", "roots-plant", "roots-equation"];

/// Writes them; the page is the first.
pub(super) fn write(folder: &Path, actuator: &Actuator, name: &str, study: &Study) -> miette::Result<Vec<PathBuf>> {
    let mut folder = OwnFolder::open(folder, "--out", Some(DEFAULT_FOLDER)).into_diagnostic()?;
    let figures = tuning::figures(study);
    let mut page =
        Page::new("Gains of the position loop", &format!("{}; {}", actuator.title, told::loop_name(study, name)));
    let lines = told::lines(actuator, name, study);
    if let Some(verdict) = lines.first() {
        page.verdict(verdict.trim_start_matches("gains").trim());
    }
    let mut rows = vec![told::row("these gains", &study.judged)];
    rows.extend(study.others.iter().map(|(name, judged)| told::row(name, judged)));
    page.table(&told::HEAD, &rows);
    page.paragraph(&problem(study));
    let (steps, rest) = figures.split_at(2);
    for (figure, caption) in steps {
        page.figure(&figure.svg(), caption);
    }
    page.section("Worst case");
    page.paragraph(&format!("Box: {}.", told::box_text(study)));
    page.list(&told::worst_text(study));
    page.paragraph(
        "Certified: for every plant of the box, by dividing it until on every part a linear change with a bound of what it leaves out \
         (small gain) is close to the worst plant that was found. Rounding and the time between samples are not part of the proof: \
         together they are below 0.1 %.",
    );
    page.section("Frequency response");
    page.paragraph(&format!(
        "{}.",
        lines.iter().find_map(|line| line.strip_prefix("loop ")).unwrap_or_default().trim()
    ));
    for (figure, caption) in rest {
        page.figure(&figure.svg(), caption);
    }
    page.paragraph(&format!("Search: {}.", told::search_text(study)));
    let mut files = vec![folder.write("tuning.html", page.html().as_bytes()).into_diagnostic()?];
    for ((figure, _), name) in figures.iter().zip(NAMES) {
        files.push(folder.write(&format!("{name}.svg"), figure.svg().as_bytes()).into_diagnostic()?);
    }
    Ok(files)
}

/// What was least, and what was kept, in sentences.
fn problem(study: &Study) -> String {
    let limits = &study.asked.limits;
    let least = match study.asked.rule {
        Rule::Text => "Least: the integral of the absolute error over 100 s (Eqs. 53 and 54).",
        Rule::AppendixE => {
            "Least: the sum of the absolute error over 1001 samples of 10 s, with overshoot and undershoot that are at their limits \
             (Appendix E)."
        }
    };
    let mut kept = format!(
        "Limits on a step of {} mm: command {} V{}, overshoot {} %, undershoot {} %",
        limits.step_mm,
        limits.command_v,
        if limits.cut { " (cut there)" } else { "" },
        100.0 * limits.overshoot,
        100.0 * limits.undershoot
    );
    kept += &limits.sensitivity.map_or(String::new(), |most| format!(", peak sensitivity {most}"));
    kept += &limits.phase_deg.map_or(String::new(), |least| format!(", phase margin {least} degrees"));
    let robust = if study.asked.robust { " Worst of the plant and all corners of the box." } else { "" };
    format!("{least} {kept}.{robust}")
}
