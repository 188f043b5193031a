//! What is believed of effects, in sentences and tables: the same for a display, a table and compressed pieces.

use crate::infer::sets::{Judged, Weighed};

use super::diagnosis::{percent, probability};
use super::{Page, number};

/// Effects by their codes.
type Codes = Judged<&'static str>;

/// Probability from which an effect has a line of its own, is likely, or is certain.
const OF_NOTE: f64 = 0.01;
const LIKELY: f64 = 0.5;
const CERTAIN: f64 = 0.99;
/// Sets that are shown.
const SETS: usize = 4;

/// A name with what may stand in its place.
#[must_use]
pub fn twins(code: &str, others: &[&'static str]) -> String {
    std::iter::once(code).chain(others.iter().copied()).collect::<Vec<_>>().join(" or ")
}

/// What stands in the place of a name where there is none; `kind` is the likeliest kind of effects, with its
/// probability, where effects have kinds.
#[must_use]
pub fn unnamed(judged: Option<&Codes>, kind: Option<(&str, f64)>) -> String {
    let nameless = || "no effect of the catalogue explains it".to_owned();
    let Some(judged) = judged else { return nameless() };
    if !judged.partly.is_empty() {
        let each: Vec<String> = judged.partly.iter().map(|twins| twins.join(" or ")).collect();
        return match judged.explains {
            Some(share) => format!("{} explains {} of it", each.join(" and "), percent(share)),
            None => format!("{} is a part of it", each.join(" and ")),
        };
    }
    let Some(first) = judged.beliefs.first() else { return nameless() };
    match kind.filter(|(_, p)| *p > CERTAIN && first.probability <= CERTAIN) {
        Some((kind, _)) => format!("what is wrong is of one kind, {kind}, but its form is open"),
        None if first.probability > LIKELY => {
            format!(
                "{} is the likeliest cause (probability {}) but no name",
                first.name,
                probability(first.probability)
            )
        }
        None => nameless(),
    }
}

/// What stays without a name, as a part of what is read (`of`); none where nothing does.
#[must_use]
pub fn remainder(judged: &Codes, of: &str) -> Option<String> {
    let share = judged.remainder?;
    Some(format!("{} of the {of}, over {}", percent(share), judged.shows_in.join(", ")))
}

/// Every effect with its probability, the likeliest sets, the remainder, and what wider priors would say.
pub fn tables<T>(page: &mut Page, judged: &Codes, sets: &[Weighed<T>], of: &str) {
    page.fold("Every effect that was tried");
    let (told, others): (Vec<_>, Vec<_>) = judged.beliefs.iter().partition(|b| b.probability > OF_NOTE);
    let explains = |share: Option<f64>| share.map_or_else(|| "-".to_owned(), percent);
    let mut rows: Vec<Vec<String>> =
        told.iter().map(|b| vec![b.name.to_owned(), probability(b.probability), explains(b.explains)]).collect();
    if !others.is_empty() {
        let codes: Vec<&str> = others.iter().map(|b| b.name).collect();
        rows.push(vec![codes.join(", "), "< 1 % each".to_owned(), "-".to_owned()]);
    }
    page.table(&["effect", "probability", "explains"], &rows);
    page.heading("The likeliest sets");
    let each = sets.iter().zip(&judged.members).zip(&judged.sets).take(SETS);
    let rows: Vec<Vec<String>> = each
        .map(|((set, codes), p)| {
            let named = if codes.is_empty() { "none".to_owned() } else { codes.join(" + ") };
            let beside: Vec<String> =
                judged.beside(set).map(|(over, size)| format!("{over} {}", number(100.0 * size))).collect();
            vec![named, probability(*p), if beside.is_empty() { "-".to_owned() } else { beside.join(", ") }]
        })
        .collect();
    page.table(&["effects", "probability", &format!("without a name beside them (% of the {of})")], &rows);
    if let Some(told) = remainder(judged, of) {
        page.paragraph(&format!("Remainder: {told}."));
    }
    page.paragraph(&judged.sensitivity_told());
    page.unfold();
}
