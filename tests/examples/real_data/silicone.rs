//! Silicone under a ball: Ogden, the height unknown. Every run stops at or below the ball's equator, so that no hold belongs to a depth
//! that the model covers.

use std::path::Path;

use palpate::identify::spec::{FitSpec, FittedLaw};

use super::drawing::{Drawn, Over, write};
use super::words::{misfit, parameter, table};
use super::{Outcome, recorded};

const NAMES: [&str; 4] = ["mu_MPa", "alpha", "D_mu", "height_mm"];

/// The section.
pub fn section(figures: &Path) -> Outcome<Option<String>> {
    let Some(mut experiment) = recorded::experiment("silicone_ball", "silicone_ball")? else { return Ok(None) };
    // The first touch ever is 1.5 times softer than what follows: it is predicted, not fitted. The faulty run stays out.
    for run in &mut experiment.runs {
        run.hold_out = run.cycle == Some(1);
    }
    experiment.runs.retain(|run| !run.file.contains("P002-7"));
    let spec = FitSpec { law: Some(FittedLaw::Ogden), ..FitSpec::default() };
    let found = recorded::first(&experiment, &spec)?;
    let rows: Vec<Vec<String>> = NAMES.iter().map(|name| vec![(*name).to_owned(), parameter(&found, name)]).collect();
    if let Some(fit) = &found.fit {
        let label = |at: usize| if at == 0 { "first touch (predicted)" } else { "later" };
        let one = |(at, run)| Drawn { found: &found, run, label: label(at), over: Over::Depth, measured: true };
        let drawn: Vec<Drawn<'_>> = fit.runs.iter().enumerate().map(one).collect();
        let title = "Silicone: measured (circles) and fitted (lines)";
        write(&figures.join("real-silicone-loading.svg"), title, &drawn)?;
    }
    Ok(Some(format!(
        "{}\nMisfit of all runs together, the predicted first touch included: {} % of the largest force; {} solves.\n\n![Loading](figures/real-silicone-loading.svg)\n",
        table(&["parameter", "value (95 % interval)"], &rows),
        misfit(&found, &|_| true),
        found.fe_solves
    )))
}
