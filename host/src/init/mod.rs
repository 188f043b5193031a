//! `palpate init`: looks at recordings and writes the `experiment.toml` that reads them.
//!
//! What a file shows is guessed, and why is written beside it; what nobody can guess, the ball's radius and the specimen's
//! height, is asked for.

mod block;
mod channels;
mod draft;
mod options;
mod roles;
mod sight;
mod written;

use std::io::Write as _;
use std::path::{Path, PathBuf};

use crate::experiment::{self, Experiment, Test, motion};

pub use draft::RunDraft;
pub use options::Options;

/// What the files hold.
#[derive(Debug, Clone, Default)]
pub struct Draft {
    /// Runs in the order of the files.
    pub runs: Vec<RunDraft>,
    /// Files that hold none, and why.
    pub left_out: Vec<(PathBuf, String)>,
    /// What reading the result says, if it cannot be read.
    pub unread: Option<String>,
}

/// Looks at files.
#[must_use]
pub fn look(files: &[PathBuf], options: &Options) -> Draft {
    let mut draft = Draft::default();
    for file in files {
        match sight::runs(file) {
            Ok(runs) => draft.runs.extend(runs),
            Err(why) => draft.left_out.push((file.clone(), why)),
        }
    }
    for run in draft.runs.iter_mut().filter(|run| run.test != Test::Table) {
        run.test = options.test.unwrap_or_else(|| guessed(run, options));
    }
    draft
}

/// What was done, by what the file and its name say; a stated ball was pressed in.
fn guessed(run: &RunDraft, options: &Options) -> Test {
    if options.ball_mm.is_some() {
        return Test::Indentation;
    }
    let name = run.label.to_lowercase();
    let words: Vec<&str> = name.split(|c: char| !c.is_alphanumeric()).collect();
    let has = |list: &[&str]| words.iter().any(|word| list.contains(word));
    if has(&["confcomp", "confined", "oedometer"]) {
        Test::Confined
    } else if has(&["tension", "tensile", "zug", "zugversuch"]) {
        Test::Tension
    } else if run.stated.compression || has(&["comp", "compression", "uniaxial", "druckversuch"]) {
        Test::Uniaxial
    } else {
        Test::Indentation
    }
}

impl Draft {
    /// Reads the runs as the text describes them and keeps what they show.
    pub fn check(&mut self, folder: &Path, options: &Options) -> Option<Experiment> {
        let text = draft::text(&self.runs, folder, options).replace(draft::FILL_IN, "\"unknown\"");
        match experiment::parse(&folder.join("experiment.toml"), &text) {
            Ok(read) => {
                for (run, found) in self.runs.iter_mut().zip(&read.runs) {
                    run.shown = shown(&found.recording);
                }
                Some(read)
            }
            Err(error) => {
                self.unread = Some(error.to_string());
                None
            }
        }
    }

    /// The text of `experiment.toml` in a folder.
    #[must_use]
    pub fn text(&self, folder: &Path, options: &Options) -> String {
        draft::text(&self.runs, folder, options)
    }

    /// Keys that are left to fill in.
    #[must_use]
    pub fn to_fill_in(&self, folder: &Path, options: &Options) -> Vec<String> {
        let text = self.text(folder, options);
        let mut table = "";
        let mut keys = Vec::new();
        for line in text.lines() {
            if line.starts_with('[') {
                table = line;
            } else if let Some((key, _)) = line.split_once(" = ").filter(|(_, value)| value.starts_with(draft::FILL_IN))
            {
                keys.push(format!("{table} {key}"));
            }
        }
        keys
    }
}

impl RunDraft {
    /// The name of its test in the contract.
    #[must_use]
    pub fn test_word(&self) -> &'static str {
        draft::word(self.test)
    }

    /// Rows, rate and motion in one line; empty if the run was not read.
    #[must_use]
    pub fn shown(&self) -> &str {
        &self.shown
    }
}

/// Rows, rate, loadings and hold of a recording in words.
fn shown(recording: &experiment::Recording) -> String {
    let mut parts = vec![format!("{} rows", recording.len())];
    let mut steps: Vec<f64> =
        recording.time_s.windows(2).map(|pair| pair[1] - pair[0]).filter(|dt| *dt > 0.0).collect();
    steps.sort_by(f64::total_cmp);
    if let Some(dt) = steps.get(steps.len() / 2) {
        parts.push(format!("{} Hz", figures(1.0 / dt)));
    }
    if let Some(motion) = motion::of(recording) {
        let depth = |at: usize| recording.depth_mm.get(at).copied().unwrap_or(f64::NAN);
        let travel = depth(motion.loading.end.saturating_sub(1)) - depth(motion.loading.start);
        let times = if motion.loadings.len() == 1 {
            "one loading".to_owned()
        } else {
            format!("{} loadings, the first", motion.loadings.len())
        };
        parts.push(format!("{times} of {} mm at {} mm/s", figures(travel), figures(motion.rate_mm_per_s)));
        let time = |at: usize| recording.time_s.get(at).copied().unwrap_or(f64::NAN);
        if let Some(hold) = &motion.hold {
            parts.push(format!("held for {} s", figures(time(hold.end.saturating_sub(1)) - time(hold.start))));
        }
    } else if !recording.depth_mm.is_empty() {
        parts.push("no loading found".to_owned());
    }
    parts.join(", ")
}

/// A number with three figures.
fn figures(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return value.to_string();
    }
    let decimals = (2 - value.abs().log10().floor() as i32).clamp(0, 9);
    let text = format!("{value:.*}", decimals as usize);
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// The folder that an experiment of these files goes to where none is named: that of the first file's name, or the next free one.
#[must_use]
pub fn free_folder(first: &Path) -> PathBuf {
    let stem = first.file_stem().map_or("experiment".into(), |stem| stem.to_string_lossy().into_owned());
    let taken = |folder: &Path| folder.symlink_metadata().is_ok();
    let plain = PathBuf::from(&stem);
    if !taken(&plain) {
        return plain;
    }
    (2..).map(|nth| PathBuf::from(format!("{stem}-{nth}"))).find(|folder| !taken(folder)).unwrap_or(plain)
}

/// Writes `experiment.toml` into a folder, which is made where there is none; never over another.
///
/// # Errors
/// What the operating system says, also that the file is there already.
pub fn write(folder: &Path, text: &str) -> std::io::Result<PathBuf> {
    std::fs::create_dir_all(folder)?;
    let file = folder.join("experiment.toml");
    std::fs::File::create_new(&file)?.write_all(text.as_bytes())?;
    Ok(file)
}
