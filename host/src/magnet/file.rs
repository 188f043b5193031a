//! Reading `magnet.toml`.

use std::collections::BTreeMap;
use std::path::Path;

use lut_gen::magnet::curve::Built;
use lut_gen::magnet::design::{Design, Region};
use lut_gen::magnet::field::Geometry;
use lut_gen::magnet::shape::Shape;

use super::expression::Parameters;
use super::uncertain;
use super::{Control, Line, Magnet, Named, boundary, material, part};
use crate::experiment::section::{Document, Section};
use crate::experiment::{ExperimentError, Problem, text_of};

const KEYS: [&str; 17] = [
    "title",
    "source",
    "geometry",
    "depth_mm",
    "boundary",
    "mirror",
    "material",
    "coil",
    "region",
    "point",
    "line",
    "probe",
    "control",
    "built",
    "out_of_plane",
    "parameters",
    "uncertain",
];

/// Most points of a line.
const MOST_POINTS: i64 = 10_000;

/// Reads a magnet.
///
/// # Errors
/// The first mistake found, with file, line and column.
pub fn read(file: &Path) -> Result<Magnet, ExperimentError> {
    parse(file, &text_of(file)?, &BTreeMap::new())
}

/// Reads a magnet that is already in memory; `file` is where it would be. `set` are parameters that take the place of the
/// file's.
///
/// # Errors
/// As [`read`].
pub fn parse(file: &Path, text: &str, set: &BTreeMap<String, f64>) -> Result<Magnet, ExperimentError> {
    let document = Document { file, text };
    let root = document.table()?;
    let root = Section::new(document, "the file".to_owned(), 0..0, root.get_ref());
    root.only(&KEYS)?;
    let parameters = parameters(&root, set)?;
    let geometry = root.word("geometry", &[("plane", Geometry::Plane), ("axisymmetric", Geometry::Axisymmetric)])?;
    let geometry = geometry.ok_or_else(|| root.missing("geometry", "\"plane\" or \"axisymmetric\""))?;
    let expected = "how deep the magnet is out of the plane, mm";
    let depth_mm = match (parameters.number(&root, "depth_mm", 1e-3..=1e5, expected)?, geometry) {
        (Some(depth), _) => depth,
        (None, Geometry::Axisymmetric) => 0.0,
        (None, Geometry::Plane) => return Err(root.missing("depth_mm", expected)),
    };
    let mut materials = BTreeMap::new();
    for (name, section) in root.named("material")? {
        materials.insert(name, material::read(&section, &parameters)?);
    }
    let coil_sections = root.named("coil")?;
    let coils: Vec<String> = coil_sections.iter().map(|(name, _)| name.clone()).collect();
    let sections = root.array("region")?;
    if sections.is_empty() {
        return Err(root.missing("region", "at least one [[region]] with a name, a material and a shape"));
    }
    let regions: Vec<Region> = sections
        .iter()
        .map(|section| part::region(section, &materials, &coils, &parameters))
        .collect::<Result<_, _>>()?;
    let coils = coil_sections.iter().enumerate().map(|(i, (name, section))| {
        part::coil(name, section, geometry, depth_mm, mean_radius_mm(&regions, i), &parameters)
    });
    let coils = coils.collect::<Result<_, _>>()?;
    let out_of_plane = boundary::out_of_plane(&root, geometry, &parameters)?;
    let (mirror, edge) = (boundary::mirror(&root, geometry)?, boundary::edge(&root, &parameters)?);
    let design = Design { geometry, depth_mm, out_of_plane, mirror, edge, regions, coils };
    design.check().map_err(|error| {
        let text = error.to_string();
        let at = sections.iter().zip(&design.regions).find(|(_, r)| text.contains(&format!("\"{}\"", r.name)));
        let span = at.map_or(root.span.clone(), |(section, _)| section.span.clone());
        document.error(span, Problem::Contradiction(text))
    })?;
    let (points, probes) = (points(&root, &parameters)?, probes(&root, &design)?);
    let stem = file.file_stem().map_or("magnet".into(), |n| n.to_string_lossy().into_owned());
    Ok(Magnet {
        title: root.text("title", "a text in quotes")?.map_or(stem, str::to_owned),
        source: root.text("source", "a text in quotes")?.unwrap_or_default().to_owned(),
        lines: lines(&root, &parameters)?,
        control: control(&root, &points, &probes)?,
        built: built(&root, &parameters)?,
        uncertain: uncertain::read(&root, &parameters)?,
        parameters,
        design,
        points,
        probes,
    })
}

/// The file's parameters, those of `set` in their place.
fn parameters(root: &Section<'_>, set: &BTreeMap<String, f64>) -> Result<Parameters, ExperimentError> {
    let mut list = BTreeMap::new();
    if let Some(section) = root.section("parameters", "[parameters]".to_owned())? {
        for key in section.keys() {
            let expected = "a number";
            let value = section.number(key.get_ref(), f64::MIN..=f64::MAX, expected)?;
            list.insert(key.get_ref().to_string(), value.ok_or_else(|| section.missing(key.get_ref(), expected))?);
        }
    }
    for (name, value) in set {
        let Some(own) = list.get_mut(name) else {
            let known: Vec<&str> = list.keys().map(String::as_str).collect();
            let known = if known.is_empty() { "none".to_owned() } else { known.join(", ") };
            let text = format!("`{name}` is set, and the file has no such parameter; it has {known}");
            return Err(ExperimentError::of_file(root.document.file, Problem::Contradiction(text)));
        };
        *own = *value;
    }
    Ok(Parameters(list))
}

/// Mean radius of a coil whose regions are rectangles; about an axis a turn is as long as its circle.
fn mean_radius_mm(regions: &[Region], coil: usize) -> Option<f64> {
    let (mut sum, mut area) = (0.0, 0.0);
    for region in regions.iter().filter(|r| r.coil.is_some_and(|(own, _)| own == coil)) {
        for shape in &region.shapes {
            let Shape::Rectangle(a, b) = shape else { return None };
            let own = (b[0] - a[0]) * (b[1] - a[1]);
            sum += own * 0.5 * (a[0] + b[0]);
            area += own;
        }
    }
    (area > 0.0).then(|| sum / area)
}

fn name_of(section: &Section<'_>) -> Result<String, ExperimentError> {
    let name = section.text("name", "a text in quotes")?;
    name.map(str::to_owned).ok_or_else(|| section.missing("name", "a text in quotes"))
}

fn position(section: &Section<'_>, key: &str, parameters: &Parameters) -> Result<[f64; 2], ExperimentError> {
    let expected = "[x, y] in mm";
    let numbers = parameters.numbers(section, key, expected)?.ok_or_else(|| section.missing(key, expected))?;
    numbers.try_into().map_err(|_| match section.value(key) {
        Some(value) => section.bad(key, value, expected),
        None => section.missing(key, expected),
    })
}

fn points(root: &Section<'_>, parameters: &Parameters) -> Result<Vec<Named<[f64; 2]>>, ExperimentError> {
    let read = |section: &Section<'_>| {
        section.only(&["name", "at"])?;
        Ok(Named { name: name_of(section)?, value: position(section, "at", parameters)? })
    };
    root.array("point")?.iter().map(read).collect()
}

fn lines(root: &Section<'_>, parameters: &Parameters) -> Result<Vec<Named<Line>>, ExperimentError> {
    let read = |section: &Section<'_>| {
        section.only(&["name", "from", "to", "points"])?;
        let count = section.integer("points", 2..=MOST_POINTS, "how many points, 2 to 10000")?.unwrap_or(101);
        let line = Line {
            from: position(section, "from", parameters)?,
            to: position(section, "to", parameters)?,
            points: usize::try_from(count).unwrap_or(2),
        };
        Ok(Named { name: name_of(section)?, value: line })
    };
    root.array("line")?.iter().map(read).collect()
}

fn probes(root: &Section<'_>, design: &Design) -> Result<Vec<Named<usize>>, ExperimentError> {
    let read = |section: &Section<'_>| {
        section.only(&["name", "region"])?;
        let known: Vec<&str> = design.regions.iter().map(|r| r.name.as_str()).collect();
        let expected = format!("the name of a region: {}", known.join(", "));
        let region = section.text("region", &expected)?.ok_or_else(|| section.missing("region", &expected))?;
        let number = known.iter().position(|own| *own == region).ok_or_else(|| match section.value("region") {
            Some(value) => section.bad("region", value, &expected),
            None => section.missing("region", &expected),
        })?;
        Ok(Named { name: name_of(section)?, value: number + 1 })
    };
    root.array("probe")?.iter().map(read).collect()
}

fn control(
    root: &Section<'_>,
    points: &[Named<[f64; 2]>],
    probes: &[Named<usize>],
) -> Result<Option<Control>, ExperimentError> {
    let Some(value) = root.value("control") else {
        return Ok(None);
    };
    let names: Vec<&str> =
        points.iter().map(|p| p.name.as_str()).chain(probes.iter().map(|p| p.name.as_str())).collect();
    let expected = format!("the name of a point or probe: {}", names.join(", "));
    let name = root.text("control", &expected)?.unwrap_or_default();
    let at = points.iter().position(|p| p.name == name).map(Control::Point);
    let at = at.or_else(|| probes.iter().position(|p| p.name == name).map(Control::Probe));
    at.map(Some).ok_or_else(|| root.bad("control", value, &expected))
}

fn built(root: &Section<'_>, parameters: &Parameters) -> Result<Built, ExperimentError> {
    let mut built = Built::default();
    if let Some(section) = root.section("built", "[built]".to_owned())? {
        section.only(&["flux", "ampere_turns", "remanence_T"])?;
        let factor = |key: &str, expected: &str| parameters.number(&section, key, 1e-3..=1e3, expected);
        built.flux = factor("flux", "its flux density over that of the drawing, 0.001 to 1000")?.unwrap_or(1.0);
        built.ampere_turns = factor("ampere_turns", "its ampere turns over those of the drawing")?.unwrap_or(1.0);
        let expected = "its flux density without current, -1 to 1 T";
        built.remanence_t = parameters.number(&section, "remanence_T", -1.0..=1.0, expected)?.unwrap_or(0.0);
    }
    Ok(built)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    const RING: &str = include_str!("../../magnets/ring-probe.toml");

    fn error(text: &str) -> String {
        parse(Path::new("magnet.toml"), text, &BTreeMap::new()).unwrap_err().to_string()
    }

    #[test]
    fn a_file_is_the_magnet_that_it_describes() {
        let magnet = parse(Path::new("ring.toml"), RING, &BTreeMap::new()).unwrap();
        assert_eq!(magnet.design.coils[0].winding.turns, 770.0);
        assert!((magnet.design.coils[0].winding.wire_mm - 0.3211).abs() < 1e-4);
        let names: Vec<&str> = magnet.design.regions.iter().map(|r| r.name.as_str()).collect();
        assert!(names.contains(&"core") && names.contains(&"probe"), "{names:?}");
        let wanted = magnet.wanted();
        assert_eq!(wanted.points.len(), magnet.first_of_line(magnet.lines.len()));
        let line = &magnet.lines[0].value;
        assert_eq!(wanted.points[magnet.first_of_line(0)], line.from);
        assert!(
            (line.along_mm(line.points - 1) - (line.to[0] - line.from[0]).hypot(line.to[1] - line.from[1])).abs()
                < 1e-12
        );
    }

    #[test]
    fn mistakes_are_told_with_their_place_and_what_was_expected() {
        let cases = [
            ("geometry = \"plane\"", "geometry = \"flat\"", "expected one of \"plane\", \"axisymmetric\""),
            ("material = \"steel\"", "material = \"cheese\"", "`material` is \"cheese\"; expected one of"),
            ("turns = \"turns\"", "turns = 0", "`turns` is 0; expected a number of 1 to 1e6"),
            ("control = \"probe\"", "control = \"nose\"", "expected the name of a point or probe: "),
            ("\"open\"", "{ radius_mm = 15 }", "the boundary must be at least"),
            ("\"open\"", "\"opne\"", "`boundary` is \"opne\"; expected \"open\", or a table"),
            ("control = \"probe\"", "control = \"probe\"\nmirror = \"left\"", "expected one of \"across\", \"along\""),
            ("sense = \"in\"", "sense = \"left\"", "expected one of \"out\", \"in\""),
            ("\"gap / 2\"", "\"gab / 2\"", "a formula of `gab`, which is no parameter (known: "),
            ("by = 0.5", "by = 0", "expected what a built one may differ by"),
            ("region = \"probe\"", "region = \"prob\"", "expected the name of a region: "),
        ];
        for (from, to, told) in cases {
            assert!(RING.contains(from), "{from}");
            let text = error(&RING.replacen(from, to, 1));
            assert!(text.contains(told) && text.contains("magnet.toml, line "), "{to}: {text}");
        }
    }
}
