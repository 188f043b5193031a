//! The experiments that describe public recordings.

use std::path::Path;

use palpate::experiment::{self, Experiment};
use palpate::identify::spec::FitSpec;
use palpate::identify::{Identification, identify};

use super::Outcome;

/// The experiment of a folder in `tests/experiments` over a set of recordings, or `None` with a visible message where they are absent.
pub fn experiment(folder: &str, set: &str) -> Outcome<Option<Experiment>> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    if tests::shared_or_skipped(&format!("data/{set}")).is_none() {
        return Ok(None);
    }
    Ok(Some(experiment::read(&root.join("experiments").join(folder))?))
}

/// The first material's identification.
pub fn first(experiment: &Experiment, spec: &FitSpec) -> Outcome<Identification> {
    let found = all(experiment, spec)?;
    found.into_iter().next().ok_or_else(|| "no run of a soft specimen".into())
}

/// Those of all materials.
pub fn all(experiment: &Experiment, spec: &FitSpec) -> Outcome<Vec<Identification>> {
    let told = |material: &str, solves: usize, _: usize| eprintln!("{material}: {solves} solves");
    Ok(identify(experiment, spec, &told)?)
}
