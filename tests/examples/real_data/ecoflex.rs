//! Ecoflex cylinders: the homogeneous reading of a compression test against one with friction on the platens.

use std::path::Path;

use palpate::experiment::Experiment;
use palpate::identify::Identification;
use palpate::identify::grip::Grip;
use palpate::identify::spec::{Extra, FitSpec};

use super::drawing::{Drawn, Over, write};
use super::words::{misfit, parameter, table};
use super::{Outcome, recorded};

/// Repeats of each piece that are fitted: they agree within 2 %.
const REPEATS: usize = 2;
/// Most solves of the barrelling cylinder, a second or more each.
const SOLVES: usize = 60;

/// The section.
pub fn section(figures: &Path) -> Outcome<Option<String>> {
    let Some(mut experiment) = recorded::experiment("ecoflex", "ecoflex")? else { return Ok(None) };
    // Each piece for itself: the two of one silicone differ.
    for specimen in &mut experiment.specimens {
        specimen.material.clone_from(&specimen.name);
    }
    let mut taken = vec![0; experiment.specimens.len()];
    experiment.runs.retain(|run| {
        let Some(count) = run.specimen.and_then(|at| taken.get_mut(at)) else { return false };
        *count += 1;
        *count <= REPEATS
    });
    let smooth = FitSpec::default();
    let rubbing = FitSpec { free: vec![Extra::PlatenFriction], most_solves: SOLVES, ..FitSpec::default() };
    let mut rows = Vec::new();
    let (alike, barrelled) = (recorded::all(&experiment, &smooth)?, recorded::all(&experiment, &rubbing)?);
    for (one, other) in alike.iter().zip(&barrelled) {
        rows.push(row("none", one));
        rows.push(row("fitted", other));
        picture(figures, &experiment, one, other)?;
    }
    let head = ["piece", "friction", "mu (MPa)", "alpha", "D mu", "coefficient", "misfit (%)"];
    let pictures = alike.iter().map(|one| {
        let name = one.material.to_lowercase();
        format!("![{}](figures/real-ecoflex-{name}.svg)\n", one.material)
    });
    Ok(Some(format!("{}\n{}", table(&head, &rows), pictures.collect::<String>())))
}

fn row(friction: &str, found: &Identification) -> Vec<String> {
    vec![
        found.material.clone(),
        friction.to_owned(),
        parameter(found, "mu_MPa"),
        parameter(found, "alpha"),
        parameter(found, "D_mu"),
        parameter(found, "platen_friction"),
        misfit(found, &|grip| grip == Grip::Platens),
    ]
}

fn picture(figures: &Path, experiment: &Experiment, alike: &Identification, rubbing: &Identification) -> Outcome<()> {
    let (Some(one), Some(other)) = (&alike.fit, &rubbing.fit) else { return Ok(()) };
    let specimen = &experiment.specimens[alike.selection.pairings[0].specimen];
    let (height, radius) = (specimen.height_mm.known().unwrap_or(1.0), specimen.radius_mm.known().unwrap_or(1.0));
    let over = Over::Strain(height, std::f64::consts::PI * radius * radius);
    let drawn = [
        Drawn { found: alike, run: &one.runs[0], label: "no friction", over, measured: true },
        Drawn { found: rubbing, run: &other.runs[0], label: "friction", over, measured: false },
    ];
    let file = figures.join(format!("real-ecoflex-{}.svg", alike.material.to_lowercase()));
    write(&file, &format!("{}, first run: measured (circles) and fitted", alike.material), &drawn)
}
