//! Adhesion between ball and specimen.

use super::{Effect, FormError, Kind, Owner, Quantity, Share, Stage};

/// Attraction of a contact that follows the depth (Derjaguin, Muller and Toporov 1975, doi:10.1016/0021-9797(75)90018-1).
pub const EFFECT: Effect = Effect {
    code: "adhesion",
    form: "dmt",
    stage: Stage::Contact,
    kind: Kind::Contact,
    assumption: "nothing pulls the surfaces together",
    signature: "near contact and at pull-off, in proportion to the radius",
    twins: &["contact-offset", "friction"],
    separated_by: "the pull-off branch; powder",
    prior: "clean silicone has a work of adhesion of about 44 mJ/m2 = 4.4e-5 N/mm (Chaudhury and Whitesides 1991, doi:10.1021/la00053a033), foams less: 2e-4 mm of the largest force at a quarter of a newton",
    quantities: &[Quantity::amplitude("work_N_per_mm", 0.0, (0.0, 0.5), 5e-4, &[5e-4])
        .about(2e-4)
        .per_force(1)
        .understated_by(UNDERSTATED)],
    owner: Owner::All,
    form_error: FormError::of(Share::Adhesive, Share::Elastic),
};

/// Finite elements in which surfaces attract each other over a tenth of a millimetre pull with 0.64 (ball of 4 mm) to 0.72 (6 mm) of the attraction below, at exponents of 3.3
/// to 17 and whatever the work; with a shorter range it is the whole. The range is not known, and so is the work.
const UNDERSTATED: f64 = 0.6;

/// Attraction (N) of a ball: `2 pi R w` in contact, and over a gap what a traction of that range leaves of it.
#[must_use]
pub fn attraction_n(work_n_per_mm: f64, radius_mm: f64, depth_mm: f64) -> f64 {
    let whole = 2.0 * std::f64::consts::PI * radius_mm * work_n_per_mm;
    if depth_mm >= 0.0 { whole } else { whole * (depth_mm / RANGE_MM).exp() }
}

/// Gap (mm) over which the attraction of surfaces that are not in contact falls: that of a rough, soft surface, where
/// what is seen is the height of its asperities.
const RANGE_MM: f64 = 0.01;
