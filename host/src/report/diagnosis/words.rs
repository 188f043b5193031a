//! The words of a diagnosis: sentences for verdicts, names for effects.

use lut_gen::effect::{self, Owner};

use crate::diagnose::coordinate::Candidate;
use crate::diagnose::{Diagnosis, Evidence, Finding, Refusal, Verdict};
use crate::experiment::Experiment;

/// The verdict in one sentence that needs no other, with the stable code in brackets.
#[must_use]
pub fn sentence(found: &Diagnosis) -> String {
    let code = found.verdict.word();
    // an experiment that names no material has one all the same
    let material = if found.material == "specimen" { "the specimen" } else { found.material.as_str() };
    match found.verdict {
        Verdict::Clean => {
            format!(
                "Nothing wrong is visible: the simulation explains {} to within the noise of these data ({code}).",
                material
            )
        }
        Verdict::Named => {
            format!("The simulation of {} is wrong here, and the data say why: {} ({code}).", material, causes(found))
        }
        Verdict::Ambiguous => format!(
            "The simulation of {} is wrong here, and these data leave more than one cause: {} ({code}).",
            material,
            causes(found)
        ),
        Verdict::Unknown if found.evidence.as_deref().is_some_and(Evidence::is_nameless) => format!(
            "The simulation of {} is wrong here, and no effect in the catalogue explains it clearly better than a departure without a name{} ({code}).",
            material,
            shows(found)
        ),
        Verdict::Unknown => format!(
            "The simulation of {} is wrong here, and no effect in the catalogue explains how{} ({code}).",
            material,
            shows(found)
        ),
        Verdict::TooFewData => {
            format!("There are too few data on {} to say anything: {} ({code}).", material, reason(found))
        }
        Verdict::Refused => format!("No diagnosis of {} is made: {} ({code}).", material, reason(found)),
    }
}

/// What the stable code promises, and what it does not.
#[must_use]
pub fn meaning(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Clean => {
            "clean: no part of the residual is larger than what noise alone makes of one data set in two hundred. It does not mean that the simulation is right: the blind spots below would not have been seen."
        }
        Verdict::Named => {
            "named: one explanation beats noise and placebo effects, predicts conditions that were left out better than the base, stays within physical bounds, leaves nothing visible, and is a hundred times likelier than any other of that kind."
        }
        Verdict::Ambiguous => {
            "ambiguous: one explanation meets every demand on a name, and others leave nothing visible either and are within a likelihood ratio of 100 of it. Each of them would mend the simulation here; only another run can tell which is at work."
        }
        Verdict::Unknown => {
            "unknown: the residual is larger than noise makes it, and no explanation meets every demand on a name, or the likeliest is not clearly likelier than any smooth function of depth and radius, or than relaxation in more times than two. A cause outside the catalogue is as possible as more causes at once than were tried."
        }
        Verdict::TooFewData => "too-few-data: no run of this material can be compared with a simulation.",
        Verdict::Refused => {
            "refused: something that every further answer would rest on is missing or broken, so that no answer is given at all."
        }
    }
}

/// Why there is no answer, in a few words that fit into a sentence.
fn reason(found: &Diagnosis) -> String {
    match &found.refusal {
        None => "no reason was given".to_owned(),
        Some(Refusal::NothingToFit(_)) => "no run can be used".to_owned(),
        Some(Refusal::NoNoise) => {
            "no condition repeats and no noise is stated, so that noise and discrepancy cannot be told apart".to_owned()
        }
        Some(Refusal::NoSuchNoise) => "repeats differ by what is no noise".to_owned(),
        Some(Refusal::Faulty(told)) => told.trim_end_matches('.').to_owned(),
    }
}

fn shows(found: &Diagnosis) -> String {
    if found.shows_in.is_empty() {
        return String::new();
    }
    format!("; it shows in {}", listed(&found.shows_in, "and"))
}

fn causes(found: &Diagnosis) -> String {
    let each: Vec<String> = found.findings.iter().map(cause).collect();
    match each.len() {
        0 | 1 => each.concat(),
        _ => format!("together {}", each.join(", with ")),
    }
}

fn cause(finding: &Finding) -> String {
    let codes: Vec<&str> = std::iter::once(finding.code).chain(finding.ambiguous_with.iter().copied()).collect();
    let of: Vec<&str> = finding.of.iter().map(String::as_str).collect();
    let named = |code: &&str| match of.as_slice() {
        names @ [_, ..] if *code == finding.code => format!("{} ({})", name(code), listed(names, "or")),
        _ => name(code).to_owned(),
    };
    let each: Vec<String> = codes.iter().map(named).collect();
    listed(&each.iter().map(String::as_str).collect::<Vec<_>>(), "or")
}

/// "a, b and c".
pub(super) fn listed(words: &[&str], last: &str) -> String {
    match words {
        [] => String::new(),
        [one] => (*one).to_owned(),
        [head @ .., tail] => format!("{} {last} {tail}", head.join(", ")),
    }
}

/// What an effect is called in a sentence; its code where there is no better word.
#[must_use]
pub fn name(code: &str) -> &str {
    match code {
        "relaxation" => "relaxation of the material",
        "poisson" => "Poisson's ratio",
        "second-term" => "a second term of the strain energy",
        "softening" => "softening with earlier presses",
        "thickness" => "the specimen's height or base",
        "friction" => "friction under the ball",
        "adhesion" => "adhesion to the ball",
        "contact-offset" => "an offset of the contact point",
        "depth-gain" => "the gain of the depth gauge",
        "time-gain" => "the rate of the recording's clock",
        "compliance" => "compliance of the machine",
        "radius" => "the radius of a ball",
        "lag" => "lag or a rate limit of the motion",
        "sensor-gain" => "the gain of the force sensor",
        "sensor-nonlinearity" => "a force sensor that is not linear",
        "sensor-creep" => "creep or hysteresis of the force sensor",
        "drift" => "drift of the force's zero",
        "numerics" => "numerical error of the simulation",
        other => other,
    }
}

/// Code, form where the effect has several, and what it belongs to.
pub(super) fn candidate(experiment: &Experiment, candidate: &Candidate) -> String {
    let effect = candidate.effect;
    let forms = effect::CATALOGUE.iter().filter(|other| other.code == effect.code).count();
    let form = if forms > 1 { format!(", {}", effect.form) } else { String::new() };
    let owner = match effect.owner {
        Owner::All => None,
        Owner::Indenter => experiment.indenters.get(candidate.owner).map(|ball| format!(" of {}", ball.name)),
        // a single specimen needs no name
        Owner::Specimen if experiment.specimens.len() < 2 => None,
        Owner::Specimen => experiment.specimens.get(candidate.owner).map(|its| format!(" of {}", its.name)),
    };
    format!("{}{form}{}", effect.code, owner.unwrap_or_default())
}

/// All effects of an explanation.
pub(super) fn candidates(experiment: &Experiment, list: &[Candidate]) -> String {
    let each: Vec<String> = list.iter().map(|one| candidate(experiment, one)).collect();
    if each.is_empty() { "nothing".to_owned() } else { each.join(" + ") }
}

/// Name and unit of a parameter, from the name it has in files.
pub(super) fn quantity(name: &str) -> (String, &'static str) {
    const UNITS: [(&str, &str); 7] = [
        ("_N_per_mm", "N/mm"),
        ("_s_per_mm", "s/mm"),
        ("mm_per_N", "mm/N"),
        ("_per_N", "1/N"),
        ("N_per_h", "N/h"),
        ("_mm", "mm"),
        ("_s", "s"),
    ];
    for (ending, unit) in UNITS {
        if let Some(head) = name.strip_suffix(ending) {
            let word = if head.is_empty() { "amount" } else { head };
            return (word.replace('_', " "), unit);
        }
    }
    (name.replace('_', " "), "")
}

/// A rate to three digits.
pub(super) fn rate(mm_per_s: f64) -> String {
    let digits = 2 - mm_per_s.abs().max(1e-6).log10().floor() as i32;
    let text = format!("{mm_per_s:.*}", usize::try_from(digits).unwrap_or(0));
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_effect_of_the_catalogue_has_a_name() {
        for effect in effect::CATALOGUE {
            assert_ne!(name(effect.code), effect.code);
        }
        assert_eq!(name("gravity"), "gravity");
    }

    #[test]
    fn units_are_read_off_the_names_of_parameters() {
        let of = |name| quantity(name);
        assert_eq!(of("tau1_s"), ("tau1".to_owned(), "s"));
        assert_eq!(of("height_error_mm"), ("height error".to_owned(), "mm"));
        assert_eq!(of("limit_s_per_mm"), ("limit".to_owned(), "s/mm"));
        assert_eq!(of("work_N_per_mm"), ("work".to_owned(), "N/mm"));
        assert_eq!(of("mm_per_N"), ("amount".to_owned(), "mm/N"));
        assert_eq!(of("g1"), ("g1".to_owned(), ""));
    }

    #[test]
    fn lists_read_as_sentences() {
        assert_eq!(listed(&["a"], "or"), "a");
        assert_eq!(listed(&["a", "b", "c"], "and"), "a, b and c");
    }
}
