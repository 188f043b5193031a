//! What is declared of specimens and indenters.

/// A length that the experimenter may not know.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Length {
    /// Measured, mm.
    Known(f64),
    /// Written `"unknown"`: a free parameter with stated bounds.
    Unknown,
}

impl Length {
    /// The value in mm if it is known.
    pub fn known(self) -> Option<f64> {
        match self {
            Length::Known(mm) => Some(mm),
            Length::Unknown => None,
        }
    }
}

/// Law that the specimen is assumed to follow.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BaseLaw {
    /// Compressible foam, thesis Eq. 1.
    Hyperfoam,
    /// Nearly incompressible rubber or tissue, thesis Eq. 2.
    Ogden,
    /// A stiff block: shows the machine, not the material.
    Rigid,
}

/// How the specimen rests on the table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Base {
    /// Glued, or too rough to slide.
    Bonded,
    /// Free to slide sideways.
    Sliding,
}

/// A block of material, a flat cylinder.
#[derive(Debug, Clone, PartialEq)]
pub struct Specimen {
    /// Name in the file.
    pub name: String,
    /// Name of what it is made of; specimens of one material share their parameters.
    pub material: String,
    /// Assumed law.
    pub base_law: BaseLaw,
    /// Terms of the law, at least 1.
    pub terms: usize,
    /// Height under the indenter.
    pub height_mm: Length,
    /// Radius of the cylinder.
    pub radius_mm: Length,
    /// Contact with the table.
    pub base: Base,
}

/// A rigid ball.
#[derive(Debug, Clone, PartialEq)]
pub struct Indenter {
    /// Name in the file.
    pub name: String,
    /// Radius of the ball.
    pub radius_mm: Length,
}
