//! The explanation that figures show beside the base.

use crate::diagnose::search::Explanation;
use crate::diagnose::{Diagnosis, Verdict};
use crate::experiment::Experiment;

use super::words;

/// The likeliest explanation, where the verdict stands by it.
pub(super) fn explanation(found: &Diagnosis) -> Option<&Explanation> {
    let stands = matches!(found.verdict, Verdict::Named | Verdict::Ambiguous);
    found.evidence.as_deref().and_then(|evidence| evidence.held.first()).filter(|_| stands)
}

/// An explanation that figures show beside the base, and what they call it.
pub(super) struct Drawn<'a> {
    pub explanation: &'a Explanation,
    pub name: String,
    /// The verdict stands by it.
    pub named: bool,
}

/// The explanation that the verdict stands by, or, where there is no name, the one that comes closest.
pub(super) fn drawn<'a>(experiment: &Experiment, found: &'a Diagnosis) -> Option<Drawn<'a>> {
    let named = explanation(found);
    let evidence = found.evidence.as_deref().filter(|_| found.verdict != Verdict::Clean)?;
    let explanation = named.or(evidence.held.first()).or(evidence.singles.first())?;
    let effects = match explanation.fit.candidates.as_slice() {
        [one] => words::candidate(experiment, one),
        // a legend has room for codes only
        several => several.iter().map(|c| c.effect.code).collect::<Vec<_>>().join(" + "),
    };
    let name = if named.is_some() { format!("with {effects}") } else { format!("closest, no name: {effects}") };
    Some(Drawn { explanation, name, named: named.is_some() })
}
