//! Shoe foam: one law from three modes, and from one to the others.

use std::path::Path;

use palpate::experiment::{Experiment, Test};
use palpate::identify::Identification;
use palpate::identify::fit::RunFit;
use palpate::identify::grip::Grip;
use palpate::identify::spec::{Extra, FitSpec};

use super::drawing::{Drawn, Over, write};
use super::words::{misfit, parameter, table};
use super::{Outcome, recorded};

/// Which runs a fit sees.
const SEEN: [(&str, &[Test]); 3] = [
    ("uniaxial", &[Test::Uniaxial]),
    ("both compressions", &[Test::Uniaxial, Test::Confined]),
    ("all three", &[Test::Uniaxial, Test::Confined, Test::Tension]),
];

fn fitted(experiment: &Experiment, seen: &[Test], terms: usize) -> Outcome<Identification> {
    let mut experiment = experiment.clone();
    for run in &mut experiment.runs {
        run.hold_out = !seen.contains(&run.test);
    }
    // One ramp with free sides shows two exponents, alpha and -nu alpha: the ratio is free in every fit.
    let spec = FitSpec { terms: Some(terms), free: vec![Extra::Nu], ..FitSpec::default() };
    recorded::first(&experiment, &spec)
}

fn row(loading: &str, seen: &str, terms: usize, found: &Identification) -> Vec<String> {
    let of = |names: [&str; 2]| {
        let cells: Vec<String> = names.iter().map(|name| parameter(found, name)).filter(|cell| cell != "-").collect();
        cells.join("; ")
    };
    let kind = |wanted: Grip| misfit(found, &move |grip| grip == wanted);
    vec![
        loading.to_owned(),
        seen.to_owned(),
        terms.to_string(),
        parameter(found, "mu_MPa"),
        of(["alpha", "alpha_1"]),
        of(["alpha_2", "-"]),
        parameter(found, "nu"),
        kind(Grip::Platens),
        kind(Grip::Ring),
        kind(Grip::Jaws),
    ]
}

/// The section.
pub fn section(figures: &Path) -> Outcome<Option<String>> {
    let mut rows = Vec::new();
    for (folder, loading) in [("shoe_foam", "first"), ("shoe_foam_sixth", "sixth")] {
        let Some(experiment) = recorded::experiment(folder, "shoe_foam")? else { return Ok(None) };
        for terms in [1, 2] {
            for (name, seen) in SEEN {
                let found = fitted(&experiment, seen, terms)?;
                rows.push(row(loading, name, terms, &found));
                if loading == "first" && terms == 1 && name != "both compressions" {
                    let file = format!("real-foam-{}.svg", name.replace(' ', "-"));
                    picture(&figures.join(file), &experiment, &found, &format!("Fitted: {name}; one term"))?;
                }
            }
        }
    }
    let head = ["loading", "fitted", "terms", "mu (MPa)", "alpha", "alpha 2", "nu", "uniaxial", "confined", "tension"];
    Ok(Some(format!(
        "{}\nThe last three columns: rms difference in percent of the largest force, *in italics* where the mode was only predicted.\n\n![Fitted to uniaxial compression](figures/real-foam-uniaxial.svg)\n![Fitted to all three](figures/real-foam-all-three.svg)\n",
        table(&head, &rows)
    )))
}

fn picture(file: &Path, experiment: &Experiment, found: &Identification, title: &str) -> Outcome<()> {
    let Some(fit) = &found.fit else { return Ok(()) };
    let labels = ["uniaxial", "confined", "tension 1", "tension 2"];
    // What was only predicted of tension would dwarf all else.
    let shown = |run: &&RunFit| {
        !found.selection.curves[run.curve].hold_out
            || run.rmse_n < fit.runs[0].model_n.iter().copied().fold(0.0, f64::max)
    };
    let drawn = fit.runs.iter().filter(shown).zip(labels).map(|(run, label)| {
        let specimen =
            &experiment.specimens[found.selection.pairings[found.selection.curves[run.curve].pairing].specimen];
        let (height, radius) = (specimen.height_mm.known().unwrap_or(1.0), specimen.radius_mm.known().unwrap_or(1.0));
        let over = Over::Strain(height, std::f64::consts::PI * radius * radius);
        Drawn { found, run, label, over, measured: true }
    });
    write(file, title, &drawn.collect::<Vec<_>>())
}
