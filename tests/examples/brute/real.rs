//! The experiments under `tests/experiments`, fitted by the commands that the documents name.

use std::path::Path;

use palpate::experiment;
use palpate::identify::spec::{FitSpec, FittedLaw};

use crate::{Case, Outcome};

/// Folders whose runs are no more than others hold, or that only `diagnose` is meant for, are fitted by the default command.
pub fn cases() -> Outcome<Vec<Case>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("experiments");
    let one = FitSpec::default;
    let two = || FitSpec { terms: Some(2), ..FitSpec::default() };
    let held = |relaxation| FitSpec { law: Some(FittedLaw::Ogden), relaxation, ..FitSpec::default() };
    let wanted: [(&str, Vec<FitSpec>); 9] = [
        ("shoe_foam", vec![one(), two()]),
        ("shoe_foam_sixth", vec![one(), two()]),
        ("ecoflex", vec![one()]),
        ("beef_ball", vec![one()]),
        ("beef_ball_hold", vec![held(1), held(2)]),
        ("beef_diagnosed", vec![one()]),
        ("beef_diagnosed_pieces", vec![one()]),
        ("silicone_ball", vec![one()]),
        ("silicone_diagnosed", vec![one()]),
    ];
    let mut all = Vec::new();
    for (name, specs) in wanted {
        let experiment = match experiment::read(&folder.join(name)) {
            Ok(experiment) => experiment,
            Err(cause) => {
                println!("SKIPPED {name}: {cause}");
                continue;
            }
        };
        for spec in specs {
            let experiment = experiment.clone();
            all.push(Case { name: name.to_owned(), experiment, spec, models: Vec::new(), hidden: false });
        }
    }
    Ok(all)
}
