//! Poisson's ratio of the foam.

use super::{Effect, FormError, Kind, Owner, Quantity, Share, Stage};

/// Poisson's ratio is not 0.
pub const EFFECT: Effect = Effect {
    code: "poisson",
    form: "ratio",
    stage: Stage::Material,
    kind: Kind::ElasticLaw,
    assumption: "Poisson's ratio of the foam is 0",
    signature: "nearly none: another alpha imitates it",
    twins: &["second-term", "friction"],
    separated_by: "two heights on a bonded base; confined compression",
    prior: "open-cell foams in compression have ratios of 0 to 0.1 (Gibson and Ashby 1997, Cellular Solids, chapter 5); the thesis takes 0",
    quantities: &[Quantity::amplitude("nu", 0.0, (0.0, 0.38), 0.1, &[0.1]).about(0.05)],
    owner: Owner::All,
    form_error: FormError::of(Share::Elastic, Share::Elastic),
};
