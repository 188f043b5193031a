//! What is believed of every effect, and the sets of effects that were weighed.

use lut_gen::effect;

use crate::diagnose::sets::{Judged, Weighed};
use crate::diagnose::{Diagnosis, Evidence, Verdict};
use crate::experiment::Experiment;
use crate::report::{Page, number};

use super::words;

/// Most sets that are told.
const SETS: usize = 10;
/// Probability below which an effect is told with others in one row.
const OF_NOTE: f64 = 0.01;

/// The section.
pub(super) fn section(page: &mut Page, experiment: &Experiment, evidence: &Evidence) {
    page.section("Every effect");
    page.paragraph(
        "Sets of up to three effects were compared by their evidence: how likely they make these data. Beside each set stands a smooth discrepancy \
         of unknown size, for whatever has no name. The probability of an effect is the sum over all sets with it. \
         'Explains' is the share of the squared misfit that this effect takes away.",
    );
    effects(page, &evidence.judged);
    kinds(page, &evidence.judged);
    sets(page, experiment, evidence);
}

/// Whole percents; what rounds to all or nothing and is neither says so.
#[must_use]
pub fn percent(share: f64) -> String {
    match share {
        s if s > 0.995 && s < 1.0 => "> 99 %".to_owned(),
        s if s > 0.0 && s < 0.005 => "< 1 %".to_owned(),
        s => format!("{} %", (100.0 * s).round() as i64),
    }
}

/// A probability in percent; none is certain.
#[must_use]
pub fn probability(p: f64) -> String {
    if p > 0.999 { "> 99.9 %".to_owned() } else { percent(p) }
}

fn effects(page: &mut Page, judged: &Judged) {
    let (told, others): (Vec<_>, Vec<_>) = judged.beliefs.iter().partition(|b| b.probability > OF_NOTE);
    let kind = |code: &str| effect::find(code, None).map_or("", |effect| effect.kind.words());
    let mut rows: Vec<Vec<String>> = told
        .iter()
        .map(|b| {
            let explains = b.explains.map_or_else(|| "-".to_owned(), percent);
            vec![b.name.to_owned(), kind(b.name).to_owned(), probability(b.probability), explains]
        })
        .collect();
    if !others.is_empty() {
        let codes: Vec<&str> = others.iter().map(|b| b.name).collect();
        rows.push(vec![words::listed(&codes, "and"), String::new(), "< 1 % each".to_owned(), "-".to_owned()]);
    }
    page.table(&["effect", "kind", "probability", "explains"], &rows);
}

/// What kind of thing is wrong, which may be certain while no form is.
fn kinds(page: &mut Page, judged: &Judged) {
    let kinds = judged.kinds();
    let likely = kinds.iter().filter(|(_, p)| *p > OF_NOTE);
    let each: Vec<String> = likely.map(|(kind, p)| format!("{} {}", kind.words(), probability(*p))).collect();
    if !each.is_empty() {
        page.paragraph(&format!("By kind: {}.", each.join(", ")));
    }
}

fn sets(page: &mut Page, experiment: &Experiment, evidence: &Evidence) {
    page.heading("The likeliest sets");
    let Some(best) = evidence.sets.first().map(|set| set.log) else { return };
    let each = evidence.sets.iter().zip(&evidence.judged.sets).take(SETS);
    let rows: Vec<Vec<String>> = each
        .map(|(set, p)| {
            vec![
                words::candidates(experiment, &set.fit.candidates),
                probability(*p),
                number(((set.log - best) * 10.0).round() / 10.0),
                beside(set, &evidence.judged),
            ]
        })
        .collect();
    page.table(
        &[
            "effects",
            "probability",
            "logarithm of the odds against the first",
            "beside them, without a name, % of the force",
        ],
        &rows,
    );
    page.paragraph(&evidence.judged.sensitivity_told());
}

/// Discrepancies beside a set.
fn beside(set: &Weighed, judged: &Judged) -> String {
    let each: Vec<String> =
        judged.beside(set).map(|(over, size)| format!("{over} {}", number(tenth(100.0 * size)))).collect();
    if each.is_empty() { "nothing".to_owned() } else { each.join(", ") }
}

/// What stays without a name, in a sentence; none where nothing is wrong or nothing was weighed.
#[must_use]
pub fn remainder(found: &Diagnosis) -> Option<String> {
    let judged = &found.evidence.as_deref().filter(|_| found.verdict != Verdict::Clean)?.judged;
    Some(match judged.remainder {
        None => "Nothing else is left beyond the noise.".to_owned(),
        Some(share) => format!(
            "About {} % of the force stays without a name, over {}.",
            number(tenth(100.0 * share)),
            words::listed(&judged.shows_in, "and")
        ),
    })
}

fn tenth(value: f64) -> f64 {
    (10.0 * value).round() / 10.0
}
