//! Reading `finger.toml`.

use std::path::Path;

use lut_gen::pad::body::finger::Finger;
use lut_gen::pad::body::section::Section as Cut;

use super::{Described, layer};
use crate::experiment::section::{Document, Section};
use crate::experiment::{ExperimentError, Problem, text_of};

const KEYS: [&str; 12] = [
    "title",
    "source",
    "section",
    "width_mm",
    "height_mm",
    "skin_mm",
    "element_mm",
    "pad_deg",
    "bone",
    "nail",
    "skin",
    "tissue",
];

/// What a length is, and the range of it that is read.
const LENGTH: &str = "a length of 0.1 to 100 mm";

/// Reads a finger.
///
/// # Errors
/// The first mistake found, with file, line and column.
pub fn read(file: &Path) -> Result<Described, ExperimentError> {
    parse(file, &text_of(file)?)
}

/// Reads a finger that is already in memory; `file` is where it would be.
///
/// # Errors
/// As [`read`].
pub fn parse(file: &Path, text: &str) -> Result<Described, ExperimentError> {
    let document = Document { file, text };
    let root = document.table()?;
    let root = Section::new(document, "the file".to_owned(), 0..0, root.get_ref());
    root.only(&KEYS)?;
    let section = root.word("section", &[("ring", Cut::Ring), ("plane", Cut::Plane)])?;
    let section = section.ok_or_else(|| root.missing("section", "\"ring\" or \"plane\""))?;
    let bone = table(&root, "bone", "width_mm, height_mm and above_mm of the rigid bone")?;
    rigid(&bone, "bone", &["width_mm", "height_mm", "above_mm"])?;
    let above = "how far the bone's centre is above that of the finger, -50 to 50 mm";
    let finger = Finger {
        half_width_mm: 0.5 * length(&root, "width_mm")?,
        height_mm: 0.5 * length(&root, "height_mm")?,
        skin_mm: length(&root, "skin_mm")?,
        bone_half_width_mm: 0.5 * length(&bone, "width_mm")?,
        bone_half_height_mm: 0.5 * length(&bone, "height_mm")?,
        bone_above_mm: bone.number("above_mm", -50.0..=50.0, above)?.unwrap_or(0.0),
        nail_deg: nail(&root)?,
        skin: layer::read(&table(&root, "skin", "the skin's mu_MPa or ogden, and nu or bulk_MPa")?)?,
        tissue: layer::read(&table(&root, "tissue", "the tissue's mu_MPa or ogden, and nu or bulk_MPa")?)?,
        edge_mm: root
            .number("element_mm", 0.02..=5.0, "the length of an element in the pad, 0.02 to 5 mm")?
            .unwrap_or(0.2),
        pad_deg: root
            .number("pad_deg", 5.0..=90.0, "how far round elements are that short, 5 to 90 degrees")?
            .unwrap_or(45.0),
    };
    finger.body().map_err(|error| document.error(root.span.clone(), Problem::Contradiction(error.to_string())))?;
    let stem = file.file_stem().map_or("finger".into(), |n| n.to_string_lossy().into_owned());
    Ok(Described {
        title: root.text("title", "a text in quotes")?.map_or(stem, str::to_owned),
        source: root.text("source", "a text in quotes")?.unwrap_or_default().to_owned(),
        section,
        finger,
    })
}

fn table<'a>(root: &Section<'a>, key: &str, expected: &str) -> Result<Section<'a>, ExperimentError> {
    root.section(key, format!("[{key}]"))?.ok_or_else(|| root.missing(key, expected))
}

fn length(section: &Section<'_>, key: &str) -> Result<f64, ExperimentError> {
    section.number(key, 0.1..=100.0, LENGTH)?.ok_or_else(|| section.missing(key, LENGTH))
}

/// Refuses a modulus of a part that is rigid, in words of its own, and other keys that nobody reads.
fn rigid(section: &Section<'_>, part: &str, known: &[&str]) -> Result<(), ExperimentError> {
    let elastic = ["young_MPa", "mu_MPa", "nu", "bulk_MPa", "ogden", "prony"];
    if let Some(value) = elastic.iter().find_map(|key| section.value(key)) {
        let text = format!("the {part} is rigid here and has no moduli; expected {} only", known.join(", "));
        return Err(section.document.error(value.span(), Problem::Contradiction(text)));
    }
    section.only(known)
}

/// Where the nail begins, degrees above the horizontal.
fn nail(root: &Section<'_>) -> Result<f64, ExperimentError> {
    let Some(section) = root.section("nail", "[nail]".to_owned())? else { return Ok(0.0) };
    rigid(&section, "nail", &["from_deg"])?;
    let expected = "where the nail begins, 0 to 80 degrees above the horizontal through the finger's centre";
    section.number("from_deg", 0.0..=80.0, expected)?.ok_or_else(|| section.missing("from_deg", expected))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use lut_gen::pad::law::material::Material;

    use super::*;

    const ROUND: &str = include_str!("../../fingers/round.toml");

    fn error(text: &str) -> String {
        parse(Path::new("finger.toml"), text).unwrap_err().to_string()
    }

    /// The file of the reference finger is the one that other solvers computed.
    #[test]
    fn a_file_is_the_finger_that_it_describes() {
        let described = parse(Path::new("round.toml"), ROUND).unwrap();
        let expected = Finger::round().unwrap();
        assert_eq!(described.section, Cut::Ring);
        let (own, other) = (&described.finger, &expected);
        assert_eq!((own.half_width_mm, own.height_mm, own.skin_mm), (other.half_width_mm, other.height_mm, 0.8));
        assert_eq!((own.bone_half_width_mm, own.bone_half_height_mm, own.bone_above_mm), (3.0, 3.0, 0.0));
        assert!((own.skin.shear_mpa() - 0.08).abs() < 1e-12 && (own.tissue.shear_mpa() - 0.012).abs() < 1e-12);
        let plane = parse(Path::new("f"), &ROUND.replacen("\"ring\"", "\"plane\"", 1)).unwrap();
        assert_eq!((plane.section, plane.title), (Cut::Plane, described.title));
    }

    #[test]
    fn layers_may_have_terms_and_relax() {
        let ogden = "ogden = [{ mu_MPa = 0.05, alpha = 2 }, { mu_MPa = 0.03, alpha = -2 }]";
        let text = ROUND.replacen("mu_MPa = 0.08", ogden, 1);
        let read = parse(Path::new("f"), &text).unwrap();
        assert!((read.finger.skin.shear_mpa() - 0.08).abs() < 1e-12);
        let prony = format!("{text}prony = [{{ g = 0.3, tau_s = 0.5 }}]\n");
        assert!(matches!(parse(Path::new("f"), &prony).unwrap().finger.tissue, Material::Relaxing(_)));
    }

    #[test]
    fn mistakes_are_told_with_their_place_and_what_was_expected() {
        let bone = "[bone]\nwidth_mm = 6";
        let cases = [
            ("\"ring\"", "\"circle\"", "`section` is \"circle\"; expected one of \"ring\", \"plane\""),
            ("section = \"ring\" ", "# ", "lacks the key `section` (\"ring\" or \"plane\")"),
            ("\nskin_mm = 0.8", "\nskin_mm = -1", "`skin_mm` is -1; expected a length of 0.1 to 100 mm"),
            ("\nskin_mm = 0.8", "\nskin_m = 0.8", "unknown key `skin_m` in the file"),
            (bone, "[bone]\nwidth_mm = 14.6", "the tissue beside the bone (mm) is -0.0999"),
            (bone, "[bone]\nyoung_MPa = 17000\nwidth_mm = 6", "the bone is rigid here and has no moduli; expected"),
            (
                "[nail]\n",
                "[nail]\nyoung_MPa = 17\n",
                "the nail is rigid here and has no moduli; expected from_deg only",
            ),
            ("from_deg = 0", "from_deg = 90", "`from_deg` is 90; expected where the nail begins, 0 to 80 degrees"),
            ("mu_MPa = 0.08", "mu_MPa = 0", "`mu_MPa` is 0; expected a shear modulus of 1e-6 to 1e4 MPa"),
            ("mu_MPa = 0.08\n", "", "a layer is given by one of mu_MPa, ogden; found none"),
            ("nu = 0.475", "nu = 0.5", "`nu` is 0.5; expected Poisson's ratio at rest, 0 to 0.4999"),
            ("nu = 0.475", "nu = 0.475\nbulk_MPa = 1", "is given by one of nu, bulk_MPa; found nu, bulk_MPa"),
            ("mu_MPa = 0.08", "ogden = [{ mu_MPa = 0.1, alpha = 0 }]", "an Ogden term's alpha is 0: expected a number"),
            ("mu_MPa = 0.08", "ogden = [{ mu_MPa = 0.1 }]", "[[skin.ogden]] lacks the key `alpha`"),
            ("mu_MPa = 0.08", "prony = [{ g = 1.2, tau_s = 1 }]\nmu_MPa = 0.1", "`g` is 1.2; expected the part of"),
            ("mu_MPa = 0.08", "mu_MPa = 0.1\nprony = []", "the number of Prony terms is 0: expected 1 or more"),
        ];
        for (from, to, told) in cases {
            assert!(ROUND.contains(from), "{from}");
            let text = error(&ROUND.replacen(from, to, 1));
            assert!(text.contains(told) && text.contains("finger.toml, line "), "{to}: {text}");
        }
    }
}
