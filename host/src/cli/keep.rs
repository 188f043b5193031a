//! Results into a folder, after they were told: answer and parameters first, laws and pages last.

use std::path::{Path, PathBuf};

use miette::IntoDiagnostic;
use serde_json::Value;

use crate::experiment::Experiment;
use crate::extended::ExtendedModel;
use crate::identify::Identification;
use crate::report::{self, number};
use crate::results::export::{self, Header};
use crate::results::folder::plain;
use crate::results::{Folder, FolderError, Place, Provenance, curves, material_name, parameters};

/// Where the results of a call go. People get them without asking, scripts say where they want them.
pub(super) fn place(report: Option<&PathBuf>, json: bool, usual: &str) -> Option<Place> {
    match report {
        Some(folder) => Some(Place::Named(folder.clone())),
        None => (!json).then(|| Place::Below(PathBuf::from(usual))),
    }
}

/// Makes the folder and writes the answer with curves and provenance, and the parameters: what cannot be computed
/// again in a moment.
pub(super) fn answer(
    place: &Place,
    experiment: &Experiment,
    provenance: &Provenance,
    (answer, curves, parameters): (&Value, Value, String),
    seconds: f64,
) -> Result<Folder, FolderError> {
    let folder = Folder::open(place, &experiment.name, provenance.at)?;
    let signed = provenance.json(seconds);
    folder.sign(&signed)?;
    let mut answer = answer.clone();
    answer["report"] = folder.path().join("report.html").display().to_string().into();
    answer["curves"] = curves;
    answer["provenance"] = signed;
    folder.write("result.json", format!("{answer}\n").as_bytes())?;
    folder.write("parameters.csv", parameters.as_bytes())?;
    Ok(folder)
}

/// The answer of an identification: [`answer`] with its curves.
pub(super) fn identified(
    place: &Place,
    experiment: &Experiment,
    found: &[Identification],
    provenance: &Provenance,
    seconds: f64,
) -> Result<Folder, FolderError> {
    let told = crate::identify::json(experiment, found, None);
    let kept = (&told, curves::identified(experiment, found), parameters::identified(experiment, found));
    answer(place, experiment, provenance, kept, seconds)
}

/// Laws for other programs, and the page with its figures. What other programs have no words for is returned, in sentences.
pub(super) fn rest(
    folder: &Folder,
    experiment: &Experiment,
    found: &[Identification],
    provenance: &Provenance,
) -> Result<Vec<String>, FolderError> {
    let mut notes = Vec::new();
    for one in found {
        notes.extend(laws(folder, experiment, one, found.len() > 1, provenance)?);
    }
    let mut page = report::identification::page(experiment, found);
    provenance.section(&mut page);
    folder.page("report.html", &page)?;
    Ok(notes)
}

fn laws(
    folder: &Folder,
    experiment: &Experiment,
    found: &Identification,
    several: bool,
    provenance: &Provenance,
) -> Result<Vec<String>, FolderError> {
    let Some(fit) = &found.fit else { return Ok(Vec::new()) };
    let mut notes = Vec::new();
    let own = fit.materials.len() > 1;
    for (specimen, material) in &fit.materials {
        let specimen = experiment.specimens[*specimen].name.as_str();
        let name = if own { specimen } else { material_name(experiment, &found.material) };
        let header = Header { name: name.to_owned(), lines: lines(experiment, found, provenance) };
        let of = if several || own { format!("-{}", plain(name)) } else { String::new() };
        for (ending, block) in [("inp", export::abaqus(material, &header)), ("feb", export::febio(material, &header))] {
            match block {
                Ok(text) => {
                    folder.write(&format!("material{of}.{ending}"), text.as_bytes())?;
                }
                Err(why) => notes.push(format!("{name}: no material{of}.{ending} is written: {why}")),
            }
        }
    }
    Ok(notes)
}

/// What a block of another program says of itself.
fn lines(experiment: &Experiment, found: &Identification, provenance: &Provenance) -> Vec<String> {
    let name = material_name(experiment, &found.material);
    let mut lines = vec![
        format!("{name} in \"{}\", identified by {} on {}", experiment.name, Provenance::version(), provenance.date()),
        "Not identified: density. Friction of the ball belongs to the contact.".to_owned(),
    ];
    for p in found.fit.iter().flat_map(|fit| &fit.parameters) {
        let (low, high) = (number(p.interval95.low), number(p.interval95.high));
        lines.push(format!("{} = {}  (95 %: {low} to {high})", p.name, number(p.value)));
    }
    let hash = |input: &crate::results::provenance::Input| {
        let hash = input.sha256.as_deref().unwrap_or("not readable");
        format!("input {} SHA-256 {hash}", input.path.display())
    };
    lines.extend(provenance.inputs.iter().map(hash));
    lines
}

/// Saves what was identified as model files; of several materials each has a file of its own, with its name in the file's.
/// Returns the files, and what they say otherwise than the fit.
pub(super) fn models(
    experiment: &Experiment,
    found: &[Identification],
    (file, force): (&Path, bool),
    friction: f64,
) -> miette::Result<(Vec<PathBuf>, Vec<String>)> {
    let mut all = Vec::new();
    for one in found {
        all.extend(ExtendedModel::identified(experiment, one, friction).into_diagnostic()?);
    }
    if all.is_empty() {
        return Err(miette::miette!("--save: nothing was fitted, so {} is not written", file.display()));
    }
    let (mut files, mut notes) = (Vec::new(), Vec::new());
    let several = all.len() > 1;
    for saved in &all {
        let path = if several { named(file, &saved.model.material) } else { file.to_owned() };
        if path.exists() && !force {
            return Err(miette::miette!("--save: {} exists and is kept; --force replaces it", path.display()));
        }
        super::file::save(&path, saved.model.to_toml().as_bytes())?;
        if saved.model.specimens.is_empty() {
            notes.push(format!("{}: no height is known; `palpate lut` asks for --height-mm", saved.model.material));
        }
        notes.extend(saved.notes.iter().cloned());
        files.push(path);
    }
    Ok((files, notes))
}

/// The file of one material of several: `model-eva.toml` beside `model.toml`.
pub(super) fn named(file: &Path, material: &str) -> PathBuf {
    let stem = file.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
    let plain: String = material.chars().map(|c| if c.is_alphanumeric() { c } else { '-' }).collect();
    file.with_file_name(format!("{stem}-{plain}.toml"))
}
