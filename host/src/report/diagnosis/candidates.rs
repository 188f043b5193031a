//! Every candidate with what it explains and which demands it meets.

use crate::diagnose::search::{Explanation, RATIO_100};
use crate::diagnose::{Diagnosis, Evidence, Verdict};
use crate::experiment::Experiment;
use crate::report::{Page, number};

use super::words;

/// The section.
pub(super) fn section(page: &mut Page, experiment: &Experiment, evidence: &Evidence, verdict: Verdict) {
    page.section("Every candidate");
    if evidence.singles.is_empty() {
        page.paragraph("No effect was tried: where nothing is visible, whatever fits best would only fit the noise.");
        return;
    }
    let count = number(evidence.expected_square());
    page.paragraph(&format!(
        "Each effect of the catalogue was added to the base and everything was fitted again. In the noise that the likeliest of them leaves, the base has a sum of squares of {} where {count} is expected; \
         'explains' is the share of that excess that an effect removes. A name needs every demand; the order is that of the likelihood with a charge for each parameter. \
         'behind' is the distance to the best: {} is a likelihood ratio of 100.",
        number(evidence.compared_square.round()),
        number(RATIO_100),
    ));
    let best = evidence.singles.first().map_or(0.0, Explanation::score);
    table(page, experiment, evidence, &evidence.singles, best);
    let several = |e: &&Explanation| e.fit.candidates.len() > 1;
    let together: Vec<Explanation> = evidence.held.iter().filter(several).cloned().collect();
    if let Some(first) = together.first() {
        page.paragraph(if evidence.singles.iter().any(Explanation::holds) {
            "A single effect meets every demand, but a further one makes these data so much likelier that both are named:"
        } else {
            "No single effect meets every demand. These do together:"
        });
        table(page, experiment, evidence, &together, first.score());
    } else if verdict == Verdict::Unknown && evidence.held.is_empty() {
        page.paragraph("Two effects at once were tried as well; no pair meets every demand either.");
    }
}

/// Whole percents, without a minus before nothing.
fn percent(share: f64) -> String {
    format!("{} %", (100.0 * share).round() as i64)
}

/// What comes closest to a name where none is given.
pub(super) fn nearest(experiment: &Experiment, found: &Diagnosis) -> Option<String> {
    let evidence = found.evidence.as_deref().filter(|_| found.verdict == Verdict::Unknown)?;
    let first = evidence.singles.first()?;
    let share = evidence.explained(first.fit.square)?;
    Some(format!(
        "Of single effects, {} comes closest: it removes {} of what exceeds the noise, but {}. It is not a name for what is wrong here.",
        words::candidates(experiment, &first.fit.candidates),
        percent(share),
        if !first.holds() {
            told(first)
        } else if evidence.is_nameless() {
            "a departure without a name explains these data about as well".to_owned()
        } else {
            "it did not predict what was left out better than the base".to_owned()
        },
    ))
}

fn table(page: &mut Page, experiment: &Experiment, evidence: &Evidence, list: &[Explanation], best: f64) {
    let head = [
        "effect",
        "explains",
        "beats noise",
        "predicts left-out",
        "beats placebos",
        "in its bounds",
        "adequate residual",
        "behind",
        "",
    ];
    let rows: Vec<Vec<String>> = list
        .iter()
        .map(|e| {
            let share = evidence.explained(e.fit.square).map_or_else(|| "-".to_owned(), percent);
            vec![
                words::candidates(experiment, &e.fit.candidates),
                share,
                mark(e.beats_noise),
                mark(e.predicts),
                mark(e.beats_placebo),
                mark(!e.fit.at_bound),
                mark(e.adequacy.passes()),
                format!("{:.*}", usize::from(e.score() - best < 100.0), e.score() - best),
                told(e),
            ]
        })
        .collect();
    page.table(&head, &rows);
}

fn mark(met: bool) -> String {
    if met { "\u{2713} yes" } else { "\u{2717} no" }.to_owned()
}

/// The outcome in words.
fn told(explanation: &Explanation) -> String {
    if explanation.holds() {
        return "holds".to_owned();
    }
    if !explanation.beats_noise {
        return "gains no more than chance".to_owned();
    }
    if explanation.fit.at_bound {
        return "runs into a bound".to_owned();
    }
    if !explanation.predicts {
        return "does not predict what was left out".to_owned();
    }
    if !explanation.beats_placebo {
        return "does no better than a random curve".to_owned();
    }
    let left: Vec<&str> = explanation.adequacy.shows_in.iter().map(|v| v.word()).collect();
    format!("leaves {}", words::listed(&left, "and"))
}
