//! The report of `palpate diagnose`: the verdict first, then everything it rests on.

pub mod bar;
mod candidates;
mod curves;
mod doubts;
mod drawn;
mod gain;
pub mod heat;
mod margins;
mod names;
pub mod panel;
mod words;

use crate::diagnose::{Diagnosis, Refusal, Verdict};
use crate::experiment::Experiment;

use super::Page;
use drawn::{drawn, named};

pub use candidates::{percent, probability, remainder};
pub use words::{meaning, name, sentence};

/// Builds the page for all materials of an experiment.
#[must_use]
pub fn page(experiment: &Experiment, found: &[Diagnosis]) -> Page {
    let mut page = Page::new(&format!("Diagnosis: {}", experiment.name), "");
    if found.is_empty() {
        page.warning("Nothing to diagnose: no run indents a soft specimen. `test` in [[run]] says what was done.");
    }
    for one in found {
        if found.len() > 1 {
            page.section(&format!("Material: {}", one.material));
        }
        material(&mut page, experiment, one);
    }
    page
}

fn material(page: &mut Page, experiment: &Experiment, found: &Diagnosis) {
    verdict(page, found);
    let evidence = found.evidence.as_deref();
    if let Some(evidence) = evidence {
        let drawn = drawn(experiment, found);
        curves::section(page, experiment, evidence, drawn.as_ref());
        gain::section(page, experiment, (found, evidence), named(found));
        names::confounded(page, found);
        names::next(page, found);
        names::blind(page, found);
        page.fold("Every effect that was tried, and where the residual is");
        margins::section(page, experiment, evidence, drawn.as_ref());
        candidates::section(page, experiment, evidence);
        page.unfold();
    }
    doubts::section(page, found, evidence);
    if let Some(evidence) = evidence {
        page.paragraph(&format!(
            "{} finite-element solves, {:.1} s. Units: mm, N, MPa, s.",
            evidence.solves, found.seconds
        ));
    }
}

/// Sentence, meaning, faults, and for a refusal what to do about it.
fn verdict(page: &mut Page, found: &Diagnosis) {
    page.section("Verdict");
    page.verdict(&sentence(found));
    if let Some(remainder) = candidates::remainder(found) {
        page.paragraph(&remainder);
    }
    page.paragraph(meaning(found.verdict));
    if !found.faults.is_empty() {
        page.heading("Faults of the data");
        for fault in &found.faults {
            page.warning(&format!("{fault} ({})", fault.code()));
        }
    }
    if let Some(advice) = advice(found) {
        if let Some(refusal) = &found.refusal {
            page.warning(&format!("{refusal}."));
        }
        page.heading("What to measure instead");
        page.paragraph(advice);
    }
    if found.verdict == Verdict::Clean && !found.blind_to.is_empty() {
        page.paragraph(&format!("Not seen here in any case: {}.", found.blind_to.join(", ")));
    }
}

/// What would make a diagnosis possible.
fn advice(found: &Diagnosis) -> Option<&'static str> {
    match found.refusal.as_ref()? {
        Refusal::NoNoise => Some(
            "Repeat at least one condition (same ball, rate, depth and cycle) on another spot, better three times. \
             If nothing can be repeated, state the sensor's noise in experiment.toml: [sensor] noise_N = ... \
             It is the standard deviation of one sample with the ball at rest.",
        ),
        Refusal::NothingToFit(_) => Some(
            "Record presses of a ball of known radius that start above the surface and go at least a tenth of the ball's radius deep, with at least a dozen samples on the way down.",
        ),
        Refusal::NoSuchNoise => Some(
            "Look at the repeats of each condition one over the other: something differs between them that is neither noise nor another contact, gain or zero, such as stick and slip.",
        ),
        Refusal::Faulty(_) => Some(
            "Check the sensor's cable and zero with a known mass, repeat the runs named above, or take them out of experiment.toml; then diagnose again.",
        ),
    }
}

#[cfg(test)]
mod tests;
