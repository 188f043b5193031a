//! Table cells.

use palpate::identify::Identification;
use palpate::identify::fit::{Parameter, RunFit};
use palpate::identify::grip::Grip;
use palpate::identify::newton::verdict::Standing;
use palpate::report::number;
pub use tests::document::table;

/// Value and interval of a parameter, with a word where it is not identified.
pub fn parameter(found: &Identification, name: &str) -> String {
    let parameters = found.fit.iter().flat_map(|fit| &fit.parameters);
    parameters.into_iter().find(|p| p.name == name).map_or_else(|| "-".to_owned(), cell)
}

fn cell(parameter: &Parameter) -> String {
    let short = |x: f64| number(format!("{x:.2e}").parse().unwrap_or(x));
    let word = match (&parameter.verdict, parameter.at_bound) {
        (_, true) => ", on a bound",
        (Some(verdict), _) if verdict.standing == Standing::InCombination => ", only in combination",
        (Some(verdict), _) if verdict.standing == Standing::NotIdentifiable => ", not identifiable",
        _ => "",
    };
    let interval = parameter.interval95;
    format!("{} ({} to {}){word}", short(parameter.value), short(interval.low), short(interval.high))
}

/// Rms difference over the runs of a kind, in percent of their largest force; of a kind that was only predicted in italics.
pub fn misfit(found: &Identification, of: &dyn Fn(Grip) -> bool) -> String {
    let Some(fit) = &found.fit else { return "-".to_owned() };
    let grip = |run: &&RunFit| found.selection.pairings[found.selection.curves[run.curve].pairing].grip;
    let runs: Vec<&RunFit> = fit.runs.iter().filter(|run| of(grip(run))).collect();
    let share = |run: &&RunFit| {
        let peak = found.selection.curves[run.curve].force_n.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
        (run.rmse_n / peak).powi(2)
    };
    let percent = 100.0 * (runs.iter().map(share).sum::<f64>() / runs.len().max(1) as f64).sqrt();
    let predicted = runs.iter().all(|run| found.selection.curves[run.curve].hold_out);
    if predicted { format!("*{percent:.1}*") } else { format!("{percent:.1}") }
}
