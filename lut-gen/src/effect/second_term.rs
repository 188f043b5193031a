//! A second term of the strain energy.

use super::{Effect, FormError, Kind, Owner, Quantity, Share, Stage};

/// A second term of the Hyperfoam energy (thesis Eq. 1 with N = 2).
pub const EFFECT: Effect = Effect {
    code: "second-term",
    form: "superposed",
    stage: Stage::Material,
    kind: Kind::ElasticLaw,
    assumption: "one term of the strain energy is enough",
    signature: "deep d/R, every rate, cycle and branch",
    twins: &["poisson", "thickness", "friction"],
    separated_by: "a small ball; confined compression",
    prior: "fits of one term leave 1 to 3 % of the force on real foams (docs/real-data.md), which a second term of a twentieth of the modulus makes",
    quantities: &[
        Quantity::amplitude("mu2_ratio", 0.0, (-0.3, 5.0), 0.3, &[0.1, 0.6]).about(0.05),
        Quantity::shape("alpha2", (1.8, 26.0), 20.0, &[3.0, 22.0]),
    ],
    owner: Owner::All,
    form_error: FormError::of(Share::Rough, Share::Elastic),
};
