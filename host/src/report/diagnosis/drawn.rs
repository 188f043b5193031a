//! The set of effects that figures show beside the base.

use crate::diagnose::evidence::Adequacy;
use crate::diagnose::fit::Fit;
use crate::diagnose::{Diagnosis, Verdict};
use crate::experiment::Experiment;

use super::words;

/// The fit of the likeliest set, where the verdict stands by it.
pub(super) fn named(found: &Diagnosis) -> Option<&Fit> {
    found.evidence.as_deref().filter(|_| found.is_named()).and_then(|e| e.held.first()).map(|set| &set.fit)
}

/// A set that figures show beside the base, and what they call it.
pub(super) struct Drawn<'a> {
    pub name: String,
    /// What it leaves.
    pub left: Option<&'a Adequacy>,
    /// The verdict stands by it.
    pub named: bool,
}

/// The set that the verdict stands by, or, where there is no name, the likeliest.
pub(super) fn drawn<'a>(experiment: &Experiment, found: &'a Diagnosis) -> Option<Drawn<'a>> {
    let evidence = found.evidence.as_deref().filter(|_| found.verdict != Verdict::Clean)?;
    let effects = match evidence.shown.as_ref()?.fit.candidates.as_slice() {
        [one] => words::candidate(experiment, one),
        // a legend has room for codes only
        several => several.iter().map(|c| c.effect.code).collect::<Vec<_>>().join(" + "),
    };
    let named = found.is_named();
    let name = if named { format!("with {effects}") } else { format!("likeliest, no name: {effects}") };
    Some(Drawn { name, left: evidence.left.as_ref(), named })
}
