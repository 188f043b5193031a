//! Experiment folders.

use std::cell::OnceCell;
use std::path::Path;

use palpate::experiment::{self, Experiment, motion, replicate};
use tempfile::TempDir;

use super::Held;

/// Line between description and data.
pub const SEPARATOR: &[u8] = b"\n%%\n";

/// The data file that the description may name.
const DATA: &str = "a.csv";

/// A folder with a description and one data file: refused with the file's name, or every sample is a finite number, time does not go back, all
/// columns are equally long, and the branches of each run lie within it.
///
/// # Errors
/// What does not hold.
pub fn experiment(bytes: &[u8]) -> Held {
    // One folder a thread, written over: making one each time takes longer than reading it.
    thread_local!(static FOLDER: OnceCell<TempDir> = const { OnceCell::new() });
    let cut = bytes.windows(SEPARATOR.len()).position(|window| window == SEPARATOR);
    let (description, data) = match cut {
        Some(at) => (&bytes[..at], &bytes[at + SEPARATOR.len()..]),
        None => (bytes, &[][..]),
    };
    FOLDER.with(|cell| {
        if cell.get().is_none() {
            let _ = cell.set(TempDir::new().map_err(|e| e.to_string())?);
        }
        let folder = cell.get().ok_or("no folder")?.path();
        let write = |name: &str, content: &[u8]| std::fs::write(folder.join(name), content).map_err(|e| e.to_string());
        write("experiment.toml", description)?;
        write(DATA, data)?;
        read(folder)
    })
}

fn read(folder: &Path) -> Held {
    match experiment::read(folder) {
        Ok(read) => sound(&read),
        Err(error) => {
            // With the lines of the file that it points at, as the tool prints it.
            let text = format!("{:?}", miette::Report::new(error));
            if text.contains("experiment.toml") || text.contains(DATA) || text.contains("no such file") {
                Ok(())
            } else {
                Err(format!("the error names no file: {text}"))
            }
        }
    }
}

fn sound(experiment: &Experiment) -> Held {
    for run in &experiment.runs {
        let recording = &run.recording;
        let rising = recording.time_s.windows(2).all(|pair| pair[0] <= pair[1]);
        let finite = [&recording.time_s, &recording.depth_mm, &recording.force_n]
            .iter()
            .all(|column| column.iter().all(|x| x.is_finite()));
        let even = [&recording.time_s, &recording.depth_mm, &recording.force_n]
            .into_iter()
            .chain(recording.others.values())
            .all(|column| column.is_empty() || column.len() == recording.len());
        if !(rising && finite && even) {
            return Err(format!(
                "run {}: time rising {rising}, numbers finite {finite}, columns even {even}",
                run.file
            ));
        }
    }
    let motions: Vec<_> = experiment.runs.iter().map(|run| motion::of(&run.recording)).collect();
    for (run, motion) in experiment.runs.iter().zip(&motions) {
        let Some(motion) = motion else { continue };
        let branches = [Some(&motion.loading), motion.hold.as_ref(), motion.unloading.as_ref()];
        if !branches.into_iter().flatten().all(|branch| branch.start <= branch.end && branch.end <= run.recording.len())
        {
            return Err(format!("run {} of {} samples has branches {motion:?}", run.file, run.recording.len()));
        }
    }
    let grouped: usize = replicate::groups(experiment, &motions).iter().map(Vec::len).sum();
    if grouped > experiment.runs.len() {
        return Err(format!("{grouped} runs in groups, of {}", experiment.runs.len()));
    }
    Ok(())
}
