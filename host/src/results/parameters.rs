//! `parameters.csv`: one row a parameter.

use crate::diagnose::Diagnosis;
use crate::experiment::Experiment;
use crate::identify::Identification;
use crate::identify::fit::Parameter;

/// Columns of the file.
pub const HEAD: [&str; 9] =
    ["experiment", "material", "parameter", "unit", "value", "low95", "high95", "standing", "at_bound"];

/// Unit that the name of a parameter ends with; 1 for one without.
#[must_use]
pub fn unit(name: &str) -> &'static str {
    let name = name.split(" of ").next().unwrap_or(name);
    let units =
        [("_per_MPa", "1/MPa"), ("_MPa", "MPa"), ("_mm_per_N", "mm/N"), ("_mm", "mm"), ("_N", "N"), ("_s", "s")];
    units.iter().find(|(ending, _)| name.ends_with(ending)).map_or("1", |(_, unit)| unit)
}

/// What can be said of a parameter, in a word.
#[must_use]
pub fn standing(parameter: &Parameter) -> &'static str {
    match (&parameter.verdict, parameter.derived) {
        (_, true) => "derived",
        (Some(verdict), _) => verdict.standing.word(),
        (None, _) => "",
    }
}

/// Of an identification.
#[must_use]
pub fn identified(experiment: &Experiment, found: &[Identification]) -> String {
    let each =
        found.iter().flat_map(|one| one.fit.iter().flat_map(move |fit| fit.parameters.iter().map(move |p| (one, p))));
    let row = |(one, p): (&Identification, &Parameter)| {
        let range = (p.interval95.low, p.interval95.high);
        row(experiment, &one.material, &p.name, p.value, range, (standing(p), p.at_bound))
    };
    csv(each.map(row))
}

/// Of a diagnosis: the base, or with its effects the extended model.
#[must_use]
pub fn diagnosed(experiment: &Experiment, found: &[Diagnosis]) -> String {
    let mut rows = Vec::new();
    for one in found {
        let Some(evidence) = one.evidence.as_deref() else { continue };
        let extended = one.extended().filter(|_| one.is_named());
        let standing = if extended.is_some() { "extended" } else { "base" };
        let base = extended.unwrap_or(evidence.before.parameters);
        for (name, (value, range)) in ["mu_MPa", "alpha"].iter().zip(base) {
            rows.push(row(experiment, &one.material, name, value, range, (standing, false)));
        }
        for finding in &one.findings {
            for (name, value, range) in &finding.parameters {
                let name = format!("{}: {name}", finding.code);
                rows.push(row(experiment, &one.material, &name, *value, *range, ("effect", false)));
            }
        }
    }
    csv(rows.into_iter())
}

fn row(
    experiment: &Experiment,
    material: &str,
    name: &str,
    value: f64,
    (low, high): (f64, f64),
    (standing, at_bound): (&str, bool),
) -> [String; 9] {
    let number = |x: f64| if x.is_finite() { format!("{x}") } else { String::new() };
    [
        experiment.name.clone(),
        material.to_owned(),
        name.to_owned(),
        unit(name).to_owned(),
        number(value),
        number(low),
        number(high),
        standing.to_owned(),
        at_bound.to_string(),
    ]
}

fn csv(rows: impl Iterator<Item = [String; 9]>) -> String {
    super::table::csv(HEAD.map(str::to_owned).to_vec(), rows.map(|row| row.to_vec()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_follow_names() {
        let names = ["mu_MPa", "alpha", "D_per_MPa", "height_mm of slab", "tau_1_s", "share_2", "mu_MPa of eva"];
        assert_eq!(names.map(unit), ["MPa", "1", "1/MPa", "mm", "s", "1", "MPa"]);
    }
}
