//! The file of a tour.

use std::path::Path;

use crate::experiment::section::{Document, Section};
use crate::experiment::{ExperimentError, text_of};

/// Law of a specimen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Law {
    /// One term, Poisson's ratio 0.
    Hyperfoam,
    /// One term with `D` times the modulus.
    Ogden {
        /// Compressibility times modulus.
        d_mu: f64,
    },
}

/// A specimen at its place.
#[derive(Debug, Clone, PartialEq)]
pub struct Stop {
    /// Its name; that of a library's material is recognised.
    pub name: String,
    /// The middle of its face, mm.
    pub at_mm: [f64; 3],
    /// Its height, mm.
    pub height_mm: f64,
    /// Its law.
    pub law: Law,
    /// Instantaneous shear modulus, MPa.
    pub mu_mpa: f64,
    /// Exponent.
    pub alpha: f64,
    /// Parts of shear and bulk that relax, and the time, s.
    pub relaxes: Option<(f64, f64, f64)>,
    /// Part of the force that the first presses lose.
    pub softens: f64,
    /// How often it is pressed.
    pub visits: usize,
}

/// All stops.
#[derive(Debug, Clone, PartialEq)]
pub struct Tour {
    /// By name.
    pub stops: Vec<Stop>,
}

/// Presses after which two thirds of a softening are done (assumed).
const SOFTENS_IN: f64 = 10.0;
/// Most visits of one stop.
const MOST_VISITS: i64 = 10_000;

impl Stop {
    /// Force in a press, from 1, over that of a fresh specimen.
    #[must_use]
    pub fn softened(&self, press: usize) -> f64 {
        1.0 - self.softens * (1.0 - (-(press.saturating_sub(1) as f64) / SOFTENS_IN).exp())
    }

    fn read(name: String, own: &Section<'_>) -> Result<Self, ExperimentError> {
        own.only(&["at_mm", "height_mm", "law", "mu_MPa", "alpha", "D_mu", "relaxes", "softens", "visits"])?;
        let must = |key: &str, range: std::ops::RangeInclusive<f64>, expected: &str| {
            own.number(key, range, expected)?.ok_or_else(|| own.missing(key, expected))
        };
        const PLACE: &str = "three numbers, the middle of its face, mm";
        let at = own.numbers("at_mm", PLACE)?.ok_or_else(|| own.missing("at_mm", PLACE))?;
        let wrong = |key: &str, expected: &str| {
            own.value(key).map_or_else(|| own.missing(key, expected), |value| own.bad(key, value, expected))
        };
        let at_mm: [f64; 3] = at.try_into().map_err(|_| wrong("at_mm", PLACE))?;
        const LAW: &str = "hyperfoam or ogden";
        let is_foam =
            own.word("law", &[("hyperfoam", true), ("ogden", false)])?.ok_or_else(|| own.missing("law", LAW))?;
        let law = if is_foam {
            Law::Hyperfoam
        } else {
            Law::Ogden { d_mu: must("D_mu", 4e-4..=2.0, "D times mu, 0.0004 to 2")? }
        };
        const RELAXES: &str = "three numbers: the parts of shear and bulk, 0 to 0.95, and the time, 0.001 to 1000 s";
        let relaxes = own.numbers("relaxes", RELAXES)?.map(|v| match v[..] {
            [g, k, tau_s] if [g, k].iter().all(|p| (0.0..=0.95).contains(p)) && (1e-3..=1e3).contains(&tau_s) => {
                Ok((g, k, tau_s))
            }
            _ => Err(wrong("relaxes", RELAXES)),
        });
        Ok(Self {
            name,
            at_mm,
            height_mm: must("height_mm", 4.5..=200.0, "the height, 4.5 to 200 mm")?,
            law,
            mu_mpa: must("mu_MPa", 1e-5..=10.0, "the shear modulus, 0.00001 to 10 MPa")?,
            alpha: must("alpha", 1.0..=30.0, "the exponent, 1 to 30")?,
            relaxes: relaxes.transpose()?,
            softens: own.number("softens", 0.0..=0.9, "the part that is lost, 0 to 0.9")?.unwrap_or(0.0),
            visits: own
                .integer("visits", 1..=MOST_VISITS, "a whole number of visits, 1 to 10000")?
                .map_or(1, |visits| visits as usize),
        })
    }
}

impl Tour {
    /// The file of the thesis' bench.
    pub const THESIS: &str = include_str!("../../tours/thesis.toml");

    /// The thesis' bench.
    ///
    /// # Errors
    /// None that a test does not see.
    pub fn thesis() -> Result<Self, ExperimentError> {
        Self::parse(Path::new("thesis.toml"), Self::THESIS)
    }

    /// Reads a file.
    ///
    /// # Errors
    /// [`ExperimentError`] with file, line and column.
    pub fn read(file: &Path) -> Result<Self, ExperimentError> {
        Self::parse(file, &text_of(file)?)
    }

    fn parse(file: &Path, text: &str) -> Result<Self, ExperimentError> {
        let document = Document { file, text };
        let root = document.table()?;
        let root = Section::new(document, "the file".to_owned(), 0..0, root.get_ref());
        root.only(&["stop"])?;
        let stops = root.named("stop")?.into_iter().map(|(name, own)| Stop::read(name, &own));
        let stops = stops.collect::<Result<Vec<_>, _>>()?;
        if stops.is_empty() {
            return Err(root.missing("stop", "[stop.NAME] for each specimen"));
        }
        Ok(Self { stops })
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn the_thesis_bench_has_its_foams_and_tissues() {
        let tour = Tour::thesis().unwrap();
        let visits: Vec<(&str, usize)> = tour.stops.iter().map(|s| (s.name.as_str(), s.visits)).collect();
        assert_eq!(&visits[..4], [("A2", 42), ("B1", 50), ("EVA", 34), ("ICF", 24)]);
        assert_eq!(tour.stops.len(), 7);
        let b1 = &tour.stops[1];
        assert!(b1.softened(1) == 1.0 && (b1.softened(500) - 0.9).abs() < 1e-9 && tour.stops[0].softened(9) == 1.0);
    }

    #[test]
    fn mistakes_are_told_with_their_place() {
        let told = |from: &str, to: &str| {
            assert!(Tour::THESIS.contains(from), "{from}");
            Tour::parse(Path::new("t.toml"), &Tour::THESIS.replacen(from, to, 1)).unwrap_err().to_string()
        };
        for (from, to, expected) in [
            ("at_mm = [0, 0, 19.05]", "at_mm = [0, 0]", "expected three numbers, the middle of its face"),
            ("visits = 50", "visits = 0", "expected a whole number of visits, 1 to 10000"),
            ("relaxes = [0.15, 0.15, 2.0]", "relaxes = [1.5, 0.15, 2.0]", "expected three numbers: the parts"),
            ("law = \"hyperfoam\"", "law = \"steel\"", "steel"),
            ("D_mu = 0.1", "", "D times mu"),
            ("softens = 0.1", "soften = 0.1", "unknown key `soften`"),
        ] {
            let text = told(from, to);
            assert!(text.contains("t.toml, line ") && text.contains(expected), "{to}: {text}");
        }
        let none = Tour::parse(Path::new("t.toml"), "").unwrap_err().to_string();
        assert!(none.contains("[stop.NAME]"), "{none}");
    }
}
