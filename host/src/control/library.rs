//! Control curves in a table's library.

use std::path::{Path, PathBuf};

use protocol::lut::{CoilSpec, DisplaySpec, MaterialSpec};

use super::{ControlCurve, CurveError};

impl ControlCurve {
    /// The same as a display curve of a table: its rows are the nodes.
    pub fn display(&self) -> DisplaySpec {
        let each = |value: fn(&super::Row) -> f64| self.rows.iter().map(value).collect();
        DisplaySpec {
            force_n: each(|row| row.force_n),
            shaft_mm: each(|row| row.shaft_mm),
            coil: Some(CoilSpec {
                current_a: each(|row| row.current_a),
                reachable_n: self.reachable_n,
                bound_a: self.bound_a,
            }),
        }
    }
}

/// Control curves for one display: all are for one magnet and one fluid.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Curves {
    /// Where each comes from, and the curve.
    given: Vec<(PathBuf, ControlCurve)>,
}

impl Curves {
    /// Reads files, one a material.
    ///
    /// # Errors
    /// [`CurveError`] for a file that is no curve, two of one material, and two magnets or fluids.
    pub fn read<P: AsRef<Path>>(files: &[P]) -> Result<Self, CurveError> {
        let mut given = Vec::<(PathBuf, ControlCurve)>::new();
        for file in files {
            let file = file.as_ref();
            let curve = ControlCurve::read(file)?;
            let (file, second) = (file.to_owned(), |known: &PathBuf| (file.to_owned(), known.clone()));
            if let Some((known, _)) = given.iter().find(|(_, other)| other.material == curve.material) {
                let (file, other) = second(known);
                return Err(CurveError::Twice { file, other, material: curve.material });
            }
            if let Some((known, first)) = given.first().filter(|(_, first)| !first.same_display(&curve)) {
                let (file, other) = second(known);
                let (is, was) = (curve.display_words(), first.display_words());
                return Err(CurveError::OtherDisplay { file, is, other, was });
            }
            given.push((file, curve));
        }
        Ok(Curves { given })
    }

    /// Gives the thesis' foams the curves that come with the program. Returns what is left out: curves
    /// for another magnet or fluid than the given files'.
    pub fn give_built_in(&self, foams: &mut [MaterialSpec]) -> Vec<String> {
        let mut left_out = Vec::new();
        for foam in foams {
            let Some(curve) = ControlCurve::built_in(&foam.name) else { continue };
            match self.given.first().filter(|(_, first)| !first.same_display(&curve)) {
                Some((file, first)) => left_out.push(format!(
                    "{}: its own curve is for {}, and {} is for {}",
                    foam.name,
                    curve.display_words(),
                    file.display(),
                    first.display_words()
                )),
                None => foam.display = curve.display(),
            }
        }
        once(left_out)
    }

    /// Magnet and fluid that the files are for; `None` without files.
    pub fn display(&self) -> Option<(&str, &str)> {
        self.given.first().map(|(_, curve)| (curve.magnet.as_str(), curve.fluid.as_str()))
    }

    /// The curve that a file gives to the material of this name.
    fn given(&self, material: &str) -> Option<&ControlCurve> {
        self.given.iter().map(|(_, curve)| curve).find(|curve| curve.material == material)
    }

    /// The curve of a material: that of the files, or the one that comes with the program.
    pub fn of(&self, material: &str) -> Option<ControlCurve> {
        self.given(material).cloned().or_else(|| ControlCurve::built_in(material))
    }

    /// Whether a file gives a curve to the material of this name.
    pub fn names(&self, material: &str) -> bool {
        self.given(material).is_some()
    }

    /// Gives materials of the library the curves of the files.
    ///
    /// # Errors
    /// [`CurveError::Stranger`] for a curve of a material that the library does not have.
    pub fn give(&self, library: &mut [MaterialSpec]) -> Result<(), CurveError> {
        for (file, curve) in &self.given {
            if !put(library, &curve.material, &curve.display()) {
                let known: Vec<&str> = library.iter().map(|one| one.name.as_str()).collect();
                let (file, material) = (file.clone(), curve.material.clone());
                return Err(CurveError::Stranger { file, material, known: known.join(", ") });
            }
        }
        Ok(())
    }
}

impl ControlCurve {
    fn same_display(&self, other: &Self) -> bool {
        self.magnet == other.magnet && self.fluid == other.fluid
    }

    fn display_words(&self) -> String {
        format!("magnet {} with fluid {}", self.magnet, self.fluid)
    }
}

/// Gives the materials of a name a display curve; false where there is none.
pub fn put(library: &mut [MaterialSpec], material: &str, display: &DisplaySpec) -> bool {
    let mut found = false;
    for one in library.iter_mut().filter(|one| one.name == material) {
        one.display = display.clone();
        found = true;
    }
    found
}

/// Names of the materials of a library that the actuator displays alone, each once.
pub fn actuator_only(library: &[MaterialSpec]) -> Vec<&str> {
    once(library.iter().filter(|one| one.display.coil.is_none()).map(|one| one.name.as_str()).collect())
}

/// Each value once, in the order of its first place: a library has an entry for every rate and height.
fn once<T: PartialEq>(all: Vec<T>) -> Vec<T> {
    let mut kept = Vec::new();
    for one in all {
        if !kept.contains(&one) {
            kept.push(one);
        }
    }
    kept
}
