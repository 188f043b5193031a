//! The answer of an identification in plain sentences.

use crate::identify::fit::Parameter;
use crate::identify::newton::verdict::Standing;
use crate::identify::{Identification, Outcome};
use crate::infer;
use crate::report::number;
use crate::results::parameters::unit;

/// Most parameters that the first sentence tells; the table has all.
const TOLD: usize = 4;

/// Name of a parameter without its unit, and the unit.
#[must_use]
pub fn spoken(name: &str) -> (String, &'static str) {
    let unit = unit(name);
    let (own, of) = name.split_once(" of ").map_or((name, String::new()), |(own, of)| (own, format!(" of {of}")));
    let plain = match unit {
        "1/MPa" => own.trim_end_matches("_per_MPa"),
        "1" => own,
        _ => own.trim_end_matches(unit).trim_end_matches('_'),
    };
    (format!("{}{of}", plain.replace('_', " ")), if unit == "1" { "" } else { unit })
}

/// What was found, with its interval; or why nothing was, and what to do.
#[must_use]
pub fn answer(found: &Identification) -> String {
    let name = if found.material == "specimen" { "The specimen" } else { found.material.as_str() };
    let Some(fit) = found.fit.as_ref().filter(|_| found.outcome != Outcome::OutsideGrid) else {
        return format!("{name}: {}", without(found.outcome));
    };
    let told: Vec<&Parameter> =
        fit.parameters.iter().filter(|p| stands(p) || p.verdict.is_none() && !p.derived).take(TOLD).collect();
    if told.is_empty() {
        return format!("{name}: these runs identify no parameter. See the table for what they leave open.");
    }
    let each: Vec<String> = told.iter().map(|p| value(p)).collect();
    let law = found.law.word();
    format!("{name} is a {law} material: {} (95 % intervals in brackets).", each.join(", "))
}

fn value(p: &Parameter) -> String {
    let (name, unit) = spoken(&p.name);
    let gap = if unit.is_empty() { "" } else { " " };
    let (low, high) = (number(p.interval95.low), number(p.interval95.high));
    format!("{name} = {}{gap}{unit} [{low} to {high}]", number(p.value))
}

/// These runs identify the parameter.
fn stands(p: &Parameter) -> bool {
    !p.at_bound && p.verdict.as_ref().is_some_and(|verdict| verdict.standing == Standing::Identified)
}

/// What became of a fit without an answer.
fn without(outcome: Outcome) -> &'static str {
    match outcome {
        Outcome::Fitted => "a fit without parameters.",
        Outcome::TooFewPoints => {
            "nothing was fitted: no run has enough samples on its way down. Record more samples a second, or press more slowly."
        }
        Outcome::NoContact => {
            "nothing was fitted: force never rises above its noise. Check force_N and its scale in [columns]; press deeper."
        }
        Outcome::OutsideGrid => {
            "do not use these parameters: alpha ends on a bound of its search. Try --terms 2, or `palpate diagnose`."
        }
        Outcome::DeeperThanTable => {
            "nothing was fitted: all samples lie too deep. Check depth_mm and its scale in [columns], and the specimen's height_mm."
        }
    }
}

/// Parameters that are not identified, in one sentence a kind.
#[must_use]
pub fn open(found: &Identification) -> Vec<String> {
    let all = || found.fit.iter().flat_map(|fit| &fit.parameters).filter(|p| !p.derived);
    let of = |standing: Standing| -> Vec<String> {
        let those = all().filter(|p| !p.at_bound && p.verdict.as_ref().is_some_and(|v| v.standing == standing));
        those.map(|p| spoken(&p.name).0).collect()
    };
    let mut sentences = Vec::new();
    let (tied, unknown) = (of(Standing::InCombination), of(Standing::NotIdentifiable));
    if !tied.is_empty() {
        sentences.push(format!("Known only in combination: {}. The table says with what.", tied.join(", ")));
    }
    if !unknown.is_empty() {
        sentences.push(format!("Not identified by these runs: {}.", unknown.join(", ")));
    }
    sentences
}

/// What effects that these runs cannot see do to the intervals, one sentence a parameter.
#[must_use]
pub fn widened(found: &Identification) -> Vec<String> {
    let all = found.fit.iter().flat_map(|fit| &fit.parameters);
    let told = all.filter_map(|p| p.unseen.as_ref().and_then(|u| infer::unseen::sentence(&p.name, u.times, &u.by)));
    told.map(|told| format!("{}{}.", told[..1].to_uppercase(), &told[1..])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_spoken_without_their_units() {
        let spoken = |name| spoken(name);
        assert_eq!(spoken("mu_MPa"), ("mu".to_owned(), "MPa"));
        assert_eq!(spoken("height_mm of slab"), ("height of slab".to_owned(), "mm"));
        assert_eq!(spoken("tau_1_s"), ("tau 1".to_owned(), "s"));
        assert_eq!(spoken("alpha"), ("alpha".to_owned(), ""));
        assert_eq!(spoken("D_per_MPa"), ("D".to_owned(), "1/MPa"));
    }
}
