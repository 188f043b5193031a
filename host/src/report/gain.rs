//! The report of `palpate gain`.

use crate::extended::gain::{Gain, Palpated};

use super::figure::{Axis, Figure, Series, Stroke};
use super::{Page, number};

/// Builds the page.
#[must_use]
pub fn page(gain: &Gain) -> Page {
    let mut page = Page::new(
        &format!("Gain of the extended model: {}", gain.material),
        "Recorded runs as palpations through the board's own logic, with a table of the base and with one of the extended model. Units: mm, N, MPa, s.",
    );
    page.section("Before and after");
    let rows: Vec<Vec<String>> = gain.rows().into_iter().map(Vec::from).collect();
    page.table(&["", "base", "extended"], &rows);
    page.paragraph(&format!(
        "{} palpations: {}. Errors are relative to {}. The library holds {}.",
        gain.trials.len(),
        gain.left_out_runs,
        gain.reference,
        gain.library.join(", ")
    ));
    page.figure(&plane(gain).svg(), "What the board found in every palpation; a right model gives one value.");
    page.section("What of the model was used");
    page.list(&gain.uses());
    page.section("Palpations");
    let row = |p: &Palpated| -> Vec<String> {
        let named = p.named.and_then(|at| gain.library.get(at)).map_or("none", String::as_str);
        let found = p.found.map_or(p.outcome.clone(), |(mu, alpha)| format!("{} / {}", number(mu), number(alpha)));
        vec![named.to_owned(), found, format!("{} of {}", number(p.error_n), number(p.limit_n))]
    };
    let rows: Vec<Vec<String>> = gain
        .trials
        .iter()
        .map(|t| {
            let head = vec![t.file.clone(), t.condition.clone()];
            head.into_iter().chain(row(&t.before)).chain(row(&t.after)).collect()
        })
        .collect();
    let head =
        ["file", "condition", "base: named", "mu / alpha", "misfit, N", "extended: named", "mu / alpha", "misfit, N"];
    page.table(&head, &rows);
    page
}

fn plane(gain: &Gain) -> Figure {
    let of = |arm: fn(&crate::extended::gain::Trial) -> &Palpated| -> Vec<(f64, f64)> {
        gain.trials.iter().filter_map(|t| arm(t).found).map(|(mu, alpha)| (alpha, mu)).collect()
    };
    Figure::new("Parameters that the board found", Axis::new("alpha"), Axis::new("mu (MPa)"))
        .with(Series::new("base", of(|t| &t.before), Stroke::Circles, 1))
        .with(Series::new("extended", of(|t| &t.after), Stroke::Circles, 0))
}
