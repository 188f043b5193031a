//! The file a user writes: `sweep.toml`, in the manner of `experiment.toml`.

use std::ops::Range;
use std::path::Path;

use lut_gen::sweep::{Parameter, Spacing, SweepAxis, SweepBase, SweepLaw, SweepMotion, SweepSpec};

use crate::experiment::section::{Document, Section};
use crate::experiment::{self, ExperimentError, Problem};

/// Parameters that `[material]` may fix.
const MATERIAL: [Parameter; 8] = [
    Parameter::Mu,
    Parameter::Alpha,
    Parameter::Nu,
    Parameter::D,
    Parameter::DMu,
    Parameter::G,
    Parameter::K,
    Parameter::Tau,
];

/// Most values of an axis given by its ends, and most depths.
const MOST_VALUES: i64 = 1_000_000;

/// Reads the description of a sweep.
///
/// # Errors
/// The first mistake found, with file, line and column.
pub fn read(file: &Path) -> Result<SweepSpec, ExperimentError> {
    parse(file, &experiment::text_of(file)?)
}

/// Reads a description that is already in memory; `file` is where it would be.
///
/// # Errors
/// As [`read`].
pub fn parse(file: &Path, text: &str) -> Result<SweepSpec, ExperimentError> {
    let document = Document { file, text };
    let root = document.table()?;
    let root = Section::new(document, "the file".to_owned(), 0..0, root.get_ref());
    root.only(&["name", "law", "specimen", "indenter", "material", "motion", "solve", "axis"])?;
    let stem = file.file_stem().map_or("sweep".into(), |n| n.to_string_lossy().into_owned());
    let name = root.text("name", "a text in quotes")?.map_or(stem, str::to_owned);
    let laws = [("hyperfoam", SweepLaw::Hyperfoam), ("ogden", SweepLaw::Ogden)];
    let law = root.word("law", &laws)?.ok_or_else(|| root.missing("law", "\"hyperfoam\" or \"ogden\""))?;
    let mut spec = SweepSpec::new(&name, law);
    // Lengths are stated, not assumed; what stays assumed is no friction and, for foams, no bulging.
    for p in [Parameter::Height, Parameter::SpecimenRadius, Parameter::BallRadius] {
        spec.fixed.remove(&p);
    }
    // Where a mistake that only the whole shows is pointed out.
    let mut places: Vec<(String, Range<usize>)> = Vec::new();
    let sections = root.array("axis")?;
    if sections.is_empty() {
        return Err(root.missing("axis", "at least one [[axis]] with a name and values"));
    }
    for section in sections {
        let axis = axis(&section)?;
        places.push((format!("axis {}", axis.parameter.name()), section.span.clone()));
        spec = spec.over(axis);
    }
    specimen(&root, &mut spec)?;
    if let Some(section) = root.section("indenter", "[indenter]".to_owned())? {
        section.only(&["radius_mm", "friction"])?;
        fix(&mut spec, &section, Parameter::BallRadius, "radius_mm")?;
        fix(&mut spec, &section, Parameter::Friction, "friction")?;
    }
    if let Some(section) = root.section("material", "[material]".to_owned())? {
        section.only(&MATERIAL.map(Parameter::name))?;
        for p in MATERIAL {
            fix(&mut spec, &section, p, p.name())?;
        }
    }
    let section = root
        .section("motion", "[motion]".to_owned())?
        .ok_or_else(|| root.missing("motion", "a table [motion] with rates_mm_s and depths"))?;
    spec.motion = motion(&section)?;
    places.push(("motion".to_owned(), section.span.clone()));
    if let Some(section) = root.section("solve", "[solve]".to_owned())? {
        section.only(&["refinement", "checks"])?;
        spec.refinement = section.number("refinement", 0.3..=6.0, "a number of 0.3 to 6")?.unwrap_or(1.0);
        let checks = section.integer("checks", 0..=10_000, "a whole number of 0 to 10000")?;
        spec.checks = usize::try_from(checks.unwrap_or(0)).unwrap_or(0);
    }
    spec.check().map_err(|error| {
        let place = places.iter().find(|(place, _)| *place == error.place);
        let problem = Problem::Contradiction(error.to_string());
        place.map_or_else(
            || ExperimentError::of_file(file, problem.clone()),
            |(_, span)| document.error(span.clone(), problem.clone()),
        )
    })?;
    Ok(spec)
}

fn specimen(root: &Section<'_>, spec: &mut SweepSpec) -> Result<(), ExperimentError> {
    let Some(section) = root.section("specimen", "[specimen]".to_owned())? else {
        return Ok(());
    };
    section.only(&["height_mm", "radius_mm", "base"])?;
    fix(spec, &section, Parameter::Height, "height_mm")?;
    fix(spec, &section, Parameter::SpecimenRadius, "radius_mm")?;
    let bases = [("bonded", SweepBase::Bonded), ("sliding", SweepBase::Sliding)];
    spec.base = section.word("base", &bases)?.unwrap_or(SweepBase::Bonded);
    Ok(())
}

/// Fixes a parameter if the section has its key.
fn fix(spec: &mut SweepSpec, section: &Section<'_>, parameter: Parameter, key: &str) -> Result<(), ExperimentError> {
    let expected = parameter.accepts(f64::NAN).1;
    if let (Some(found), Some(value)) = (section.number(key, f64::MIN..=f64::MAX, expected)?, section.value(key)) {
        if !parameter.accepts(found).0 {
            return Err(section.bad(key, value, expected));
        }
        spec.fixed.insert(parameter, found);
    }
    Ok(())
}

fn motion(section: &Section<'_>) -> Result<SweepMotion, ExperimentError> {
    section.only(&["rates_mm_s", "depths_mm", "depth_mm", "depths", "holds_s"])?;
    let expected = "a rising list of rates above 0 mm/s, such as [0.1, 1.0, 10.0]";
    let rates_mm_s = section.numbers("rates_mm_s", expected)?.ok_or_else(|| section.missing("rates_mm_s", expected))?;
    let holds_s = section.numbers("holds_s", "a rising list of times above 0 s")?.unwrap_or_default();
    let listed = section.numbers("depths_mm", "a rising list of depths above 0 mm")?;
    let expected = "the largest depth, 0.001 to 1000 mm; or a list depths_mm";
    let depth = section.number("depth_mm", 0.001..=1000.0, expected)?;
    let count = section.integer("depths", 1..=MOST_VALUES, "how many depths, 1 to 1000000")?;
    let depths_mm = match (listed, depth) {
        (Some(_), Some(_)) => {
            let twice = "depths_mm and depth_mm are both given; expected one of the two".to_owned();
            return Err(section.document.error(section.span.clone(), Problem::Contradiction(twice)));
        }
        (Some(listed), None) => listed,
        (None, Some(depth)) => {
            let count = count.unwrap_or(200);
            (1..=count).map(|i| depth * i as f64 / count as f64).collect()
        }
        (None, None) => return Err(section.missing("depth_mm", expected)),
    };
    Ok(SweepMotion { rates_mm_s, depths_mm, holds_s })
}

fn axis(section: &Section<'_>) -> Result<SweepAxis, ExperimentError> {
    section.only(&["name", "values", "from", "to", "count", "spacing", "factor"])?;
    let names = Parameter::ALL.map(|p| (p.name(), p));
    let parameter = section
        .word("name", &names)?
        .ok_or_else(|| section.missing("name", "a parameter such as \"mu_MPa\" or \"alpha\""))?;
    let spacings = [("linear", Spacing::Linear), ("logarithmic", Spacing::Logarithmic)];
    let spacing = section.word("spacing", &spacings)?.unwrap_or(Spacing::Linear);
    let expected = "a list of numbers";
    let mut axis = match section.numbers("values", expected)? {
        Some(values) => {
            if let Some(key) = ["from", "to", "count"].into_iter().find(|key| section.value(key).is_some()) {
                let twice = format!("`{key}` is given beside values; expected one of the two");
                return Err(section.document.error(section.span.clone(), Problem::Contradiction(twice)));
            }
            SweepAxis { spacing, ..SweepAxis::listed(parameter, &values) }
        }
        None => {
            let end = |key: &str| {
                let expected = parameter.accepts(f64::NAN).1;
                let found = section.number(key, f64::MIN..=f64::MAX, expected)?;
                found.ok_or_else(|| section.missing(key, "an end of the axis; or a list `values`"))
            };
            let (low, high) = (end("from")?, end("to")?);
            let expected = "how many values, 1 to 1000000";
            let count = section.integer("count", 1..=MOST_VALUES, expected)?;
            let count = count.ok_or_else(|| section.missing("count", expected))?;
            SweepAxis::even(parameter, low, high, usize::try_from(count).unwrap_or(1), spacing)
        }
    };
    axis.factor = section.flag("factor")?.unwrap_or(false);
    Ok(axis)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;

    #[test]
    fn the_examples_are_what_they_say() {
        let bench = Path::new(env!("CARGO_MANIFEST_DIR")).join("../bench");
        let liver = read(&bench.join("sweeps/liver.toml")).unwrap();
        assert_eq!((liver.grid(), liver.motion.rates_mm_s.len(), liver.motion.samples()), (729, 3, 45));
        assert!(liver.axes.iter().all(|axis| axis.values.len() == 3 && !axis.factor));
        let small = read(&bench.join("slurm/small.toml")).unwrap();
        assert_eq!((small.jobs(), small.axes.len()), (16, 3));
    }

    #[test]
    fn the_documentation_shows_a_sweep_that_runs() {
        let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/experiment.md");
        let text = std::fs::read_to_string(&docs).unwrap();
        let section = text.split("\n## Sweeps").nth(1).expect("a section on sweeps");
        let example = section.split("```toml\n").nth(1).and_then(|rest| rest.split("```").next()).expect("an example");
        let spec = parse(&docs, example).unwrap();
        assert_eq!((spec.grid(), spec.motion.depths_mm.len(), spec.fixed[&Parameter::G]), (81, 40, 0.5));
    }

    #[test]
    fn a_length_may_be_an_axis() {
        let text = "law = \"hyperfoam\"\n[material]\nmu_MPa = 0.1\nalpha = 8\n[specimen]\nradius_mm = 25\n\
                    [indenter]\nradius_mm = 4\nfriction = 0.2\n[motion]\nrates_mm_s = [1]\ndepths_mm = [1, 2]\n\
                    [[axis]]\nname = \"height_mm\"\nvalues = [12.7, 19.05]\n";
        let spec = parse(Path::new("heights.toml"), text).unwrap();
        assert_eq!((spec.name.as_str(), spec.grid()), ("heights", 2));
        assert_eq!(spec.point(1).unwrap().get(Parameter::Height), Some(19.05));
        assert_eq!(spec.fixed[&Parameter::Friction], 0.2);
        assert_eq!(spec.fixed[&Parameter::Nu], 0.0);
    }
}
