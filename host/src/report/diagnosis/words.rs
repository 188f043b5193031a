//! The words of a diagnosis: sentences for verdicts, names for effects.

use lut_gen::effect::{self, Owner};

use crate::diagnose::coordinate::Candidate;
use crate::diagnose::{Diagnosis, Finding, Refusal, Verdict};
use crate::experiment::Experiment;
use crate::report::number;

use super::candidates::percent;

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
        Verdict::Named => format!(
            "The simulation of {material} is wrong here, and the data say why: {}{} ({code}).",
            causes(found),
            share(found)
        ),
        Verdict::Ambiguous => format!(
            "The simulation of {material} is wrong here, and these data leave more than one cause: {}{} ({code}).",
            causes(found),
            share(found)
        ),
        Verdict::Unknown => {
            format!(
                "The simulation of {material} is {} here, and {}{} ({code}).",
                off(found),
                in_part(found),
                shows(found)
            )
        }
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
            "clean: every effect is less likely than not, and no discrepancy is a hundred times likelier than none. The simulation can still be wrong in what these runs cannot show: see the list below."
        }
        Verdict::Named => {
            "named: the probability of each effect is above 99 % (99.9 % for each further one). Together they explain more than half of the misfit. They also predict runs that were left out better than the base does."
        }
        Verdict::Ambiguous => {
            "ambiguous: one of these effects is there with a probability above 99 %. Each of them would mend the simulation, and only another run can tell which it is."
        }
        Verdict::Unknown => {
            "unknown: the simulation is wrong beyond noise, and no effect of the catalogue is both certain and large enough to be named. The cause may be outside the catalogue, or several effects at once."
        }
        Verdict::TooFewData => "too-few-data: no run of this material can be compared with a simulation.",
        Verdict::Refused => "refused: something that every answer needs is missing or broken.",
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

/// What the names explain of the misfit, where it is known.
fn share(found: &Diagnosis) -> String {
    let explains = found.evidence.as_deref().and_then(|evidence| evidence.judged.explains);
    explains.map_or_else(String::new, |share| format!(", {} of the misfit", percent(share)))
}

/// How wrong a simulation is that is wrong by what has no name.
fn off(found: &Diagnosis) -> String {
    let judged = found.evidence.as_deref().map(|evidence| &evidence.judged).filter(|judged| judged.partly.is_empty());
    match judged.and_then(|judged| judged.remainder) {
        Some(share) => format!("off by about {} % of the force", number((1000.0 * share).round() / 10.0)),
        None => "wrong".to_owned(),
    }
}

/// What is known of an unknown cause: an effect that is there and explains too little, one that may be, a kind, or nothing.
fn in_part(found: &Diagnosis) -> String {
    /// Probability from which an effect or a kind is told, and from which it is there for certain.
    const LIKELY: f64 = 0.5;
    const CERTAIN: f64 = 0.99;
    let nothing = "no effect in the catalogue explains how".to_owned();
    let Some(judged) = found.evidence.as_deref().map(|evidence| &evidence.judged) else { return nothing };
    if !judged.partly.is_empty() {
        let each: Vec<String> = judged.partly.iter().map(|twins| listed(&names(twins), "or")).collect();
        let each = listed(&each.iter().map(String::as_str).collect::<Vec<_>>(), "and");
        return match judged.explains {
            Some(share) if share < LIKELY => format!("{each} explains only {} of it", percent(share.max(0.0))),
            Some(share) => {
                format!("{each} would explain {} of it, but all that a name needs is not there", percent(share))
            }
            None => format!("{each} is a part of it, how large is not known"),
        };
    }
    match (judged.beliefs.first(), judged.kinds().first()) {
        (Some(first), Some((kind, p))) if *p > CERTAIN && first.probability <= CERTAIN => {
            format!("what is wrong is of one kind, {}, but its form is open", kind.words())
        }
        (Some(first), _) if first.probability > LIKELY => {
            let sure = percent(first.probability);
            format!("{} is the likeliest cause (probability {sure}) but no name", name(first.name))
        }
        _ => nothing,
    }
}

fn names<'a>(codes: &[&'a str]) -> Vec<&'a str> {
    codes.iter().map(|code| name(code)).collect()
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
