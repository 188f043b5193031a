//! Displacement tables for materials of a table's library: `palpate lut --displacement`.

use std::path::PathBuf;

use miette::{IntoDiagnostic, miette};
use protocol::lut::MaterialSpec;

use crate::control::put;
use crate::displacement::table::Displacement;

/// Gives materials of the library the displacement of the files, without coil.
///
/// # Errors
/// A file with a mistake, a material that the library does not have, two files of one.
pub(super) fn give(files: &[PathBuf], library: &mut [MaterialSpec]) -> miette::Result<()> {
    let mut given: Vec<(String, &PathBuf)> = Vec::new();
    for file in files {
        let table = Displacement::read(file).into_diagnostic()?;
        if let Some((_, other)) = given.iter().find(|(material, _)| *material == table.material) {
            let (file, other) = (file.display(), other.display());
            return Err(miette!(
                "{file}: {} has a displacement table by {other} already; expected one",
                table.material
            ));
        }
        if !put(library, &table.material, &table.display()) {
            let mut known: Vec<&str> = library.iter().map(|one| one.name.as_str()).collect();
            known.dedup();
            let file = file.display();
            return Err(miette!("{file}: no material {} in the library; it has {}", table.material, known.join(", ")));
        }
        given.push((table.material, file));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use protocol::lut::DisplaySpec;

    use super::*;

    #[test]
    fn a_table_goes_to_its_material_and_strangers_are_told() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("eva.csv");
        let text = "# material = EVA\n# cap_mm2 = 314\n# thickness_mm = 12.7\n# provenance = test\nforce_N,shaft_mm\n0,0\n2,0.5\n";
        std::fs::write(&file, text).unwrap();
        let material = |name: &str| MaterialSpec {
            name: name.into(),
            mu_mpa: 0.1,
            alpha: 2.0,
            height_mm: 20.0,
            acceptance: 0.01,
            rate_mm_s: 0.0,
            force_n: vec![1.0, 2.0],
            display: DisplaySpec::even(1.0, &[1.0, 2.0]),
        };
        let mut library = [material("ICF"), material("EVA")];
        give(std::slice::from_ref(&file), &mut library).unwrap();
        assert_eq!(library[1].display, DisplaySpec { force_n: vec![0.0, 2.0], shaft_mm: vec![0.0, 0.5], coil: None });
        assert_eq!(library[0].display, material("ICF").display);
        let twice = give(&[file.clone(), file.clone()], &mut library).unwrap_err().to_string();
        assert!(twice.contains("EVA has a displacement table by"), "{twice}");
        let stranger = give(&[file], &mut library[..1]).unwrap_err().to_string();
        assert!(stranger.contains("no material EVA in the library; it has ICF"), "{stranger}");
    }
}
