//! Two beef muscles: Ogden with relaxation, each piece for itself.

use std::path::Path;

use palpate::identify::Identification;
use palpate::identify::spec::{FitSpec, FittedLaw};

use super::drawing::{Drawn, Over, write};
use super::words::{misfit, parameter, table};
use super::{Outcome, recorded};

/// Prony terms: one leaves 3 % of the peak in the holds.
const TERMS: usize = 2;
/// Most solves of a piece, half a second each.
const SOLVES: usize = 100;
/// Shown with their intervals, and shown alone.
const NAMES: [&str; 3] = ["mu_MPa", "alpha", "D_mu"];
const RELAXING: [&str; 6] = ["g_1", "k_1", "tau_1_s", "g_2", "k_2", "tau_2_s"];

/// The section.
pub fn section(figures: &Path) -> Outcome<Option<String>> {
    let Some(mut experiment) = recorded::experiment("beef_ball_hold", "beef_ball")? else { return Ok(None) };
    let muscles: Vec<String> = experiment.specimens.iter().map(|s| s.material.clone()).collect();
    for specimen in &mut experiment.specimens {
        specimen.material.clone_from(&specimen.name);
    }
    let spec = FitSpec { law: Some(FittedLaw::Ogden), relaxation: TERMS, most_solves: SOLVES, ..FitSpec::default() };
    let mut rows = Vec::new();
    let mut pieces: Vec<(String, Identification)> = Vec::new();
    for found in recorded::all(&experiment, &spec)? {
        let at = experiment.specimens.iter().position(|s| s.name == found.material).unwrap_or(0);
        let mut row = vec![muscles[at].clone(), found.material.clone()];
        row.extend(NAMES.iter().map(|name| parameter(&found, name)));
        let short = |name: &&str| value(&found, name).map_or_else(|| "-".to_owned(), |v| format!("{v:.2}"));
        row.push(RELAXING.iter().map(short).collect::<Vec<_>>().join(", "));
        row.push(misfit(&found, &|_| true));
        rows.push(row);
        pieces.push((muscles[at].clone(), found));
    }
    let head = ["muscle", "piece", "mu (MPa)", "alpha", "D mu", "g, k, tau (s) of both terms", "misfit (%)"];
    let mut spreads = Vec::new();
    for muscle in ["FF", "RDG"] {
        let mine: Vec<&Identification> = pieces.iter().filter(|(of, _)| of == muscle).map(|(_, f)| f).collect();
        spreads.push(spread(muscle, &mine));
    }
    picture(figures, &pieces)?;
    let over = ["muscle", "mu (MPa)", "alpha", "mu after the relaxation (MPa)", "left after 10 s (%)"];
    Ok(Some(format!(
        "{}\nGeometric mean and spread (factor of one standard deviation) over the pieces:\n\n{}\n![Loading](figures/real-beef-loading.svg)\n![Hold](figures/real-beef-hold.svg)\n",
        table(&head, &rows),
        table(&over, &spreads)
    )))
}

fn value(found: &Identification, name: &str) -> Option<f64> {
    found.fit.as_ref()?.parameters.iter().find(|p| p.name == name).map(|p| p.value)
}

/// Mean and spread over pieces, of values that differ by factors.
fn spread(muscle: &str, pieces: &[&Identification]) -> Vec<String> {
    let over = |of: &dyn Fn(&Identification) -> Option<f64>| -> String {
        let logs: Vec<f64> = pieces.iter().filter_map(|found| of(found)).map(f64::ln).collect();
        let count = logs.len() as f64;
        let mean = logs.iter().sum::<f64>() / count;
        let variance = logs.iter().map(|l| (l - mean).powi(2)).sum::<f64>() / (count - 1.0).max(1.0);
        format!("{} (x/ {:.2})", palpate::report::number(mean.exp()), variance.sqrt().exp())
    };
    let left = |found: &Identification| Some(1.0 - value(found, "g_1")? - value(found, "g_2")?);
    let held = |found: &Identification| {
        let run = found.fit.as_ref()?.runs.first()?;
        let data = &found.selection.curves[run.curve];
        let peak = data.force_n[..data.hold_from].last()?;
        (data.hold_from < data.force_n.len()).then(|| 100.0 * data.force_n[data.force_n.len() - 1] / peak)
    };
    vec![
        muscle.to_owned(),
        over(&|found| value(found, "mu_MPa")),
        over(&|found| value(found, "alpha")),
        over(&|found| Some(value(found, "mu_MPa")? * left(found)?)),
        over(&held),
    ]
}

fn picture(figures: &Path, pieces: &[(String, Identification)]) -> Outcome<()> {
    for (file, over) in [("real-beef-loading.svg", Over::Depth), ("real-beef-hold.svg", Over::Time)] {
        let drawn: Vec<Drawn<'_>> = pieces
            .iter()
            .filter_map(|(_, found)| {
                let run = found.fit.as_ref()?.runs.first()?;
                Some(Drawn { found, run, label: &found.material, over, measured: true })
            })
            .collect();
        write(&figures.join(file), "Beef: measured (circles) and fitted (lines), each piece for itself", &drawn)?;
    }
    Ok(())
}
