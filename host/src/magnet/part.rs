//! `[[region]]` and `[coil.NAME]`.

use std::collections::BTreeMap;
use std::ops::RangeInclusive;

use lut_gen::magnet::design::{Coil, Region};
use lut_gen::magnet::field::Geometry;
use lut_gen::magnet::shape::Shape;
use lut_gen::magnet::winding::{Winding, awg_mm};

use super::expression::Parameters;
use super::material::{self, Material};
use crate::experiment::section::Section;
use crate::experiment::{ExperimentError, Problem};

/// Keys of a shape; `degrees` belongs to `ring`.
const SHAPE: [&str; 5] = ["rectangle", "disc", "ring", "degrees", "polygon"];

/// Reads a region. `coils` are the names of the coils in their order.
pub(super) fn region(
    section: &Section<'_>,
    materials: &BTreeMap<String, Material>,
    coils: &[String],
    parameters: &Parameters,
) -> Result<Region, ExperimentError> {
    let own = ["name", "material", "magnetised_deg", "coil", "sense", "size_mm", "shape", "without"];
    section.only(&[own.as_slice(), SHAPE.as_slice()].concat())?;
    let name = section.text("name", "a text in quotes")?.ok_or_else(|| section.missing("name", "a text in quotes"))?;
    let material = of_material(section, materials)?;
    let mut shapes = Vec::new();
    if SHAPE.iter().any(|key| section.value(key).is_some()) {
        shapes.push(shape(section, parameters)?);
    }
    for more in section.array("shape")? {
        more.only(&SHAPE)?;
        shapes.push(shape(&more, parameters)?);
    }
    if shapes.is_empty() {
        return Err(section.missing("rectangle", "a rectangle, disc, ring or polygon; or several [[region.shape]]"));
    }
    let mut without = Vec::new();
    for less in section.array("without")? {
        less.only(&SHAPE)?;
        without.push(shape(&less, parameters)?);
    }
    let (law, coercive) = (material.law, coercive(section, name, material.coercive)?);
    let size_mm = parameters.number(section, "size_mm", 1e-6..=1e6, "the length of a triangle's side, mm")?;
    Ok(Region { name: name.to_owned(), shapes, without, law, coercive, coil: coil_of(section, coils)?, size_mm })
}

fn of_material(section: &Section<'_>, materials: &BTreeMap<String, Material>) -> Result<Material, ExperimentError> {
    let Some(value) = section.value("material") else {
        return material::by_name("air").ok_or_else(|| section.missing("material", "a material"));
    };
    let known: Vec<&str> = materials.keys().map(String::as_str).chain(lut_gen::magnet::material::NAMES).collect();
    let expected = format!("one of {}", known.join(", "));
    let name = section.text("material", &expected)?.unwrap_or_default();
    let found = materials.get(name).cloned().or_else(|| material::by_name(name));
    found.ok_or_else(|| section.bad("material", value, &expected))
}

/// The coercive field strength along its direction, A/mm.
fn coercive(section: &Section<'_>, name: &str, size: f64) -> Result<[f64; 2], ExperimentError> {
    let expected = "the direction of its magnetisation, degrees counter-clockwise from +x (or r)";
    let direction = section.number("magnetised_deg", -360.0..=360.0, expected)?;
    match (direction, size > 0.0) {
        (Some(degrees), true) => {
            // Right angles are exact: a hair of the other direction would be a current along the magnet's sides.
            let along = |angle: f64| if angle.abs() < 1e-15 { 0.0 } else { angle };
            Ok([size * along(degrees.to_radians().cos()), size * along(degrees.to_radians().sin())])
        }
        (None, true) => Err(section.missing("magnetised_deg", expected)),
        (Some(_), false) => {
            let text = format!("region \"{name}\" is magnetised, and its material is no permanent magnet");
            Err(section.document.error(section.span.clone(), Problem::Contradiction(text)))
        }
        (None, false) => Ok([0.0; 2]),
    }
}

fn coil_of(section: &Section<'_>, coils: &[String]) -> Result<Option<(usize, f64)>, ExperimentError> {
    let Some(value) = section.value("coil") else {
        return Ok(None);
    };
    let expected = format!("a coil that has a table [coil.NAME]: {}", coils.join(", "));
    let name = section.text("coil", &expected)?.unwrap_or_default();
    let number = coils.iter().position(|own| own == name).ok_or_else(|| section.bad("coil", value, &expected))?;
    let sense = section.word("sense", &[("out", 1.0), ("in", -1.0)])?.unwrap_or(1.0);
    Ok(Some((number, sense)))
}

/// The shape of a section: exactly one of its keys.
fn shape(section: &Section<'_>, parameters: &Parameters) -> Result<Shape, ExperimentError> {
    let ways = ["rectangle", "disc", "ring", "polygon"];
    let told: Vec<&str> = ways.into_iter().filter(|key| section.value(key).is_some()).collect();
    let [way] = told.as_slice() else {
        let found = if told.is_empty() { "none".to_owned() } else { told.join(", ") };
        let text = format!("a shape is one of {}; found {found}", ways.join(", "));
        return Err(section.document.error(section.span.clone(), Problem::Contradiction(text)));
    };
    let expected = match *way {
        "rectangle" => "[x0, y0, x1, y1] in mm, the lower left and the upper right corner",
        "disc" => "[x, y, radius] in mm",
        "ring" => "[x, y, inner radius, outer radius] in mm",
        _ => "[x0, y0, x1, y1, x2, y2, ..] in mm, three corners or more",
    };
    let numbers = parameters.numbers(section, way, expected)?.unwrap_or_default();
    let wrong = || match section.value(way) {
        Some(value) => section.bad(way, value, expected),
        None => section.missing(way, expected),
    };
    let degrees = parameters.numbers(section, "degrees", "[from, to] in degrees counter-clockwise from +x")?;
    let shape = match (*way, numbers.as_slice()) {
        ("rectangle", [x0, y0, x1, y1]) => Shape::Rectangle([*x0, *y0], [*x1, *y1]),
        ("disc", [x, y, radius]) => Shape::Disc([*x, *y], *radius),
        ("ring", [x, y, inner, outer]) => {
            let degrees = match degrees.as_deref() {
                None => [0.0, 360.0],
                Some([from, to]) => [*from, *to],
                Some(_) => return Err(section.missing("degrees", "[from, to], two numbers")),
            };
            Shape::Ring { centre: [*x, *y], radii: [*inner, *outer], degrees }
        }
        ("polygon", list) if list.len() >= 6 && list.len() % 2 == 0 => {
            Shape::Polygon(list.chunks(2).map(|pair| [pair[0], pair[1]]).collect())
        }
        _ => return Err(wrong()),
    };
    shape.check().map_err(|error| {
        let span = section.value(way).map_or(section.span.clone(), toml::Spanned::span);
        section.document.error(span, Problem::Contradiction(error.to_string()))
    })?;
    Ok(shape)
}

/// Varnish of a wire where none is told: a single coat of a thin wire, 12 % of its diameter (assumed; IEC 60317-0-1).
const VARNISHED: f64 = 1.12;

/// Reads a coil. Lengths of turns are told, or follow from depth and ends, or from the radius of the winding's middle.
pub(super) fn coil(
    name: &str,
    section: &Section<'_>,
    geometry: Geometry,
    depth_mm: f64,
    mean_radius_mm: Option<f64>,
    parameters: &Parameters,
) -> Result<Coil, ExperimentError> {
    section.only(&[
        "turns",
        "wire_awg",
        "wire_mm",
        "insulated_mm",
        "turn_mm",
        "end_mm",
        "share",
        "room_C",
        "limit_C",
        "cooling_W_K",
    ])?;
    let number =
        |key: &str, range: RangeInclusive<f64>, expected: &str| parameters.number(section, key, range, expected);
    let turns = number("turns", 1.0..=1e6, "a number of 1 to 1e6")?;
    let turns = turns.ok_or_else(|| section.missing("turns", "how many turns"))?;
    let wire_mm = match (
        number("wire_mm", 0.01..=10.0, "the bare wire's diameter, 0.01 to 10 mm")?,
        number("wire_awg", 0.0..=50.0, "an American wire gauge, 0 to 50")?,
    ) {
        (Some(_), Some(_)) => {
            let text = "wire_mm and wire_awg are both given; expected one of the two".to_owned();
            return Err(section.document.error(section.span.clone(), Problem::Contradiction(text)));
        }
        (Some(wire_mm), None) => wire_mm,
        (None, Some(gauge)) => awg_mm(gauge),
        (None, None) => return Err(section.missing("wire_mm", "the bare wire's diameter, mm, or wire_awg")),
    };
    let expected = "the wire's diameter with its varnish, mm, at least the bare one's";
    let insulated_mm = number("insulated_mm", wire_mm..=20.0, expected)?.unwrap_or(VARNISHED * wire_mm);
    let told = number("turn_mm", 1e-3..=1e5, "the mean length of a turn, mm")?;
    let end_mm = number("end_mm", 0.0..=1e5, "the length of a turn's end before and behind the core, mm")?;
    let turn_mm = match (told, geometry, mean_radius_mm) {
        (Some(turn_mm), _, _) => turn_mm,
        (None, Geometry::Plane, _) => {
            2.0 * (depth_mm
                + end_mm.ok_or_else(|| section.missing("end_mm", "the length of a turn's end, mm; or turn_mm"))?)
        }
        (None, Geometry::Axisymmetric, Some(radius)) => std::f64::consts::TAU * radius,
        (None, Geometry::Axisymmetric, None) => return Err(section.missing("turn_mm", "the mean length of a turn, mm")),
    };
    let room_c = number("room_C", -50.0..=100.0, "a temperature, C")?.unwrap_or(25.0);
    let limit_c = number("limit_C", room_c + 1.0..=400.0, "what the varnish stands, C, more than the room's")?;
    let cooling = number("cooling_W_K", 0.0..=1e3, "what the winding gives to its surroundings, W/K")?;
    let share = number("share", -1e3..=1e3, "its current over the one that is asked for")?.unwrap_or(1.0);
    let winding = Winding {
        turns,
        wire_mm,
        insulated_mm,
        turn_mm,
        room_c,
        limit_c: limit_c.unwrap_or(130.0),
        cooling_w_k: cooling.unwrap_or(0.0),
    };
    Ok(Coil { name: name.to_owned(), winding, share })
}
