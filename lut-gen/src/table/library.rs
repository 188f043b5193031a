//! Named foams a board recognises, and how the display renders them.

use crate::solid::law::{Hyperfoam, LawError};

/// A material of the library.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Foam {
    /// Name, at most 16 ASCII characters.
    pub name: &'static str,
    /// Shear modulus (MPa).
    pub mu_mpa: f64,
    /// Exponent.
    pub alpha: f64,
    /// Height of the specimen (mm).
    pub height_mm: f64,
    /// True for a curve that belongs to no specimen; it only makes the choice harder.
    pub dummy: bool,
}

/// The four foams of the thesis (Table 1 identified values: EVA, B1, ICF; A2 is
/// assumed, the thesis prints no parameters for it) and four dummy curves placed
/// between and around them, as in Fig. 30.
///
/// For the 4 mm ball at 4 mm the dummies reach 0.10, 0.72, 3.0 and 9.8 N, between and
/// around the foams' 0.29 (ICF), 1.8 (A2), 4.8 (B1) and 6.2 N (EVA). The closest pair
/// (EVA, B1) differs by 8.8 % of its larger peak on average over the curve.
#[must_use]
pub fn foams() -> Vec<Foam> {
    let foam = |name, mu_mpa, alpha, height_mm| Foam { name, mu_mpa, alpha, height_mm, dummy: false };
    let dummy = |name, mu_mpa, alpha, height_mm| Foam { name, mu_mpa, alpha, height_mm, dummy: true };
    vec![
        foam("EVA", 0.22, 10.53, 12.7),
        foam("B1", 0.188, 11.16, 19.05),
        foam("ICF", 0.0137, 14.8, 25.4),
        foam("A2", 0.05, 6.0, 19.05),
        dummy("dummy 1", 0.004, 12.0, 25.4),
        dummy("dummy 2", 0.025, 9.0, 19.05),
        dummy("dummy 3", 0.11, 10.0, 19.05),
        dummy("dummy 4", 0.3, 8.0, 12.7),
    ]
}

/// Radius of the flat cap that compresses the foam in the display's model (mm):
/// an assumption, about that of a fingertip's contact; the thesis does not state the cap's size.
pub const CAP_RADIUS_MM: f64 = 5.0;

/// Displacement (mm) of a flat cap of radius [`CAP_RADIUS_MM`] pressed onto a foam
/// of height `height_mm` by `force_n`.
///
/// Uniaxial with `nu = 0`, where the sides do not move: the stretch `l` solves
/// `F / (pi a^2) = 2 mu/alpha (1/l - l^(alpha - 1))`, the displacement is `h (1 - l)`
/// (thesis section 4.3: force over cap area to stress, stress to strain by the
/// material's curve, strain to displacement). The cap's edge is neglected.
/// Never negative, below `height_mm`, rising in force.
///
/// # Errors
/// [`LawError`] for parameters outside the law's range.
pub fn display_displacement_mm(mu_mpa: f64, alpha: f64, height_mm: f64, force_n: f64) -> Result<f64, LawError> {
    let law = Hyperfoam::one_term(mu_mpa, alpha)?;
    let wanted = -force_n.max(0.0) / (std::f64::consts::PI * CAP_RADIUS_MM * CAP_RADIUS_MM);
    // The stress rises from -infinity at l = 0 to 0 at l = 1: bisection to rounding.
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..60 {
        let l = 0.5 * (low + high);
        if law.uniaxial_stress_mpa(l) < wanted {
            low = l;
        } else {
            high = l;
        }
    }
    Ok(height_mm * (1.0 - high))
}
