//! What cannot be told apart, what would tell it apart, and what could not have been seen.

use lut_gen::effect;

use crate::diagnose::design::Design;
use crate::diagnose::{Diagnosis, Verdict};
use crate::report::{Page, number};

use super::words;

/// Most runs that are proposed.
const PROPOSALS: usize = 6;

/// The section on sets of names; none without one.
pub(super) fn confounded(page: &mut Page, found: &Diagnosis) {
    if found.verdict != Verdict::Ambiguous && found.verdict != Verdict::Named {
        return;
    }
    page.section("What this could be confused with");
    for finding in &found.findings {
        if finding.ambiguous_with.is_empty() {
            let twins = effect::find(finding.code, None).map_or(&[][..], |effect| effect.twins);
            let others: Vec<&str> = twins.iter().copied().filter(|twin| found.blind_to.contains(twin)).collect();
            let blind = if others.is_empty() {
                String::new()
            } else {
                format!(" It could hide {}, which these data would not show.", words::listed(&others, "or"))
            };
            page.paragraph(&format!("{}: without it these data are a hundred times less likely.{blind}", finding.code));
            continue;
        }
        page.paragraph(&format!(
            "{} or {}: these data fit each of them. One of these runs would decide:",
            finding.code,
            words::listed(&finding.ambiguous_with, "or")
        ));
        let codes = std::iter::once(finding.code).chain(finding.ambiguous_with.iter().copied());
        let rows: Vec<Vec<String>> = codes.filter_map(row).collect();
        page.table(&["if it is", "the base is wrong in that", "its twins", "a run that shows it"], &rows);
    }
}

fn row(code: &str) -> Option<Vec<String>> {
    let effect = effect::find(code, None)?;
    let twins = if effect.twins.is_empty() { "none".to_owned() } else { effect.twins.join(", ") };
    Some(vec![code.to_owned(), format!("it assumes: {}", effect.assumption), twins, effect.separated_by.to_owned()])
}

/// The section on what this design cannot see.
pub(super) fn blind(page: &mut Page, found: &Diagnosis) {
    page.section("What this design cannot see");
    if found.blind_to.is_empty() {
        page.paragraph("A plausible amount of every effect in the catalogue would have been seen here.");
        return;
    }
    page.paragraph(
        "Amounts of these effects that laboratories meet would not have shown in these runs: the noise hides them, or mu and alpha take them up. \
         They may be there.",
    );
    let rows: Vec<Vec<String>> = found
        .blind_to
        .iter()
        .filter_map(|code| {
            let effect = effect::find(code, None)?;
            Some(vec![
                (*code).to_owned(),
                effect.assumption.to_owned(),
                amounts(code, found.evidence.as_deref().map(|e| &e.design)),
                effect.signature.to_owned(),
                effect.separated_by.to_owned(),
            ])
        })
        .collect();
    page.table(&["effect", "assumed unseen", "amount looked for", "where it would show", "what would show it"], &rows);
}

/// What no run of this kind can exclude, and the runs that would tell more.
pub(super) fn next(page: &mut Page, found: &Diagnosis) {
    if !found.cancelling.is_empty() {
        page.paragraph("These runs cannot exclude that two effects hide each other:");
        page.list(&found.cancelling.iter().map(|told| (*told).to_owned()).collect::<Vec<_>>());
    }
    if found.proposals.is_empty() {
        return;
    }
    page.section("What to measure next");
    page.paragraph(
        "The most telling run comes first. Its distance says how many standard deviations it puts between the explanations that are left, \
         or how far an effect that is not seen yet would show.",
    );
    let rows: Vec<Vec<String>> = found
        .proposals
        .iter()
        .take(PROPOSALS)
        .map(|p| vec![p.what.clone(), p.decides.join(", "), number((10.0 * p.distance).round() / 10.0)])
        .collect();
    page.table(&["run", "would decide, or show", "distance"], &rows);
}

/// Plausible amounts of all forms of an effect in a design; of its largest ball or specimen.
fn amounts(code: &str, design: Option<&Design>) -> String {
    let forms = effect::CATALOGUE.iter().filter(|effect| effect.code == code);
    let each: Vec<String> = forms
        .filter_map(|effect| Some((effect.quantities.first()?, design?.sizes(effect, None))))
        .map(|(q, sizes)| {
            let (word, unit) = words::quantity(q.name);
            format!("{word} {} {unit}", number(q.scaled(q.plausible, &sizes))).trim_end().to_owned()
        })
        .collect();
    each.join("; ")
}
