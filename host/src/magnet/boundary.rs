//! Where a magnet's field ends, and what leaves the plane, as a file tells it.

use lut_gen::magnet::design::{Edge, Mirror, OutOfPlane};
use lut_gen::magnet::field::Geometry;

use super::expression::Parameters;
use crate::experiment::section::Section;
use crate::experiment::{ExperimentError, Problem};

pub(super) fn edge(root: &Section<'_>, parameters: &Parameters) -> Result<Edge, ExperimentError> {
    let expected = "\"open\", or a table such as { radius_mm = 150 }";
    if let Some(value) = root.value("boundary").filter(|value| value.get_ref().is_str()) {
        let edge = root.word("boundary", &[("open", Edge::Open)]).ok().flatten();
        return edge.ok_or_else(|| root.bad("boundary", value, expected));
    }
    let section =
        root.section("boundary", "[boundary]".to_owned())?.ok_or_else(|| root.missing("boundary", expected))?;
    section.only(&["radius_mm", "half_mm"])?;
    let radius =
        parameters.number(&section, "radius_mm", 1e-3..=1e6, "the radius of the circle where the field ends, mm")?;
    let half =
        parameters.number(&section, "half_mm", 1e-3..=1e6, "half the width of the box where the field ends, mm")?;
    match (radius, half) {
        (Some(radius), None) => Ok(Edge::Round { radius }),
        (None, Some(half)) => Ok(Edge::Box { half }),
        _ => Err(section.missing("radius_mm", "either radius_mm of a circle or half_mm of a box")),
    }
}

/// `mirror = "across"` or `"along"`: only x of 0 and more is computed.
pub(super) fn mirror(root: &Section<'_>, geometry: Geometry) -> Result<Option<Mirror>, ExperimentError> {
    let mirror = root.word("mirror", &[("across", Mirror::Across), ("along", Mirror::Along)])?;
    match (mirror, root.value("mirror")) {
        (Some(_), Some(value)) if geometry == Geometry::Axisymmetric => {
            let text = "`mirror` belongs to a plane drawing; about an axis only one half is drawn anyway".to_owned();
            Err(root.document.error(value.span(), Problem::Contradiction(text)))
        }
        _ => Ok(mirror),
    }
}

pub(super) fn out_of_plane(
    root: &Section<'_>,
    geometry: Geometry,
    parameters: &Parameters,
) -> Result<Option<OutOfPlane>, ExperimentError> {
    let Some(section) = root.section("out_of_plane", "[out_of_plane]".to_owned())? else { return Ok(None) };
    section.only(&["mean_radius_mm", "width_mm", "gap_mm"])?;
    if geometry == Geometry::Axisymmetric {
        let text = "[out_of_plane] belongs to a plane drawing; about an axis nothing leaves the plane".to_owned();
        return Err(section.document.error(section.span.clone(), Problem::Contradiction(text)));
    }
    let length = |key: &str, expected: &str| {
        parameters.number(&section, key, 1e-3..=1e5, expected)?.ok_or_else(|| section.missing(key, expected))
    };
    Ok(Some(OutOfPlane {
        mean_radius_mm: length("mean_radius_mm", "the mean radius of the core, mm")?,
        width_mm: length("width_mm", "the width of the core in the plane, mm")?,
        gap_mm: length("gap_mm", "the gap between the poles, mm")?,
    }))
}
