//! A wrong height of the specimen, or a base that slides where it was thought bonded.

use super::{Effect, FormError, Kind, Owner, Quantity, Share, Stage};

/// The height under the ball is not the declared one.
pub const HEIGHT: Effect = Effect {
    code: "thickness",
    form: "height",
    stage: Stage::Specimen,
    kind: Kind::Geometry,
    assumption: "the specimen is as high as declared",
    signature: "grows with sqrt(R d) / h",
    twins: &["compliance", "radius", "second-term"],
    separated_by: "a specimen of twice the height; a third ball",
    prior: "a slab as wide as a palm is known to 2 % of its height: a calliper squeezes a soft foam by a few tenths of a millimetre in 12.7, and sheets are cut no closer",
    quantities: &[Quantity::amplitude("height_error_mm", 0.0, (-0.32, 0.4), 0.12, &[-0.12, 0.16])
        .about(0.02)
        .of_height()],
    owner: Owner::Specimen,
    form_error: FormError::of(Share::Rough, Share::Elastic),
};

/// The heights of all specimens are wrong by the same: the gauge that measured them was, or the table gives way by a layer that they all lie on.
pub const EVERY_HEIGHT: Effect = Effect {
    form: "every-height",
    assumption: "specimens are as high as declared",
    separated_by: "a specimen of another height; the gauge on a block of known height",
    owner: Owner::All,
    ..HEIGHT
};

/// The base gives way sideways: 1 is a base that slides freely.
pub const SLIDING: Effect = Effect {
    code: "thickness",
    form: "sliding-base",
    stage: Stage::Specimen,
    kind: Kind::Geometry,
    assumption: "the base is bonded",
    signature: "grows with sqrt(R d) / h",
    twins: &["compliance", "radius", "second-term"],
    separated_by: "a specimen of twice the height; glue",
    prior: "a base that is said to be bonded holds but for a tenth of what a free one does: glue and tape shear (laboratory judgement)",
    quantities: &[Quantity::amplitude("sliding", 0.0, (0.0, 1.0), 1.0, &[0.5]).about(0.1)],
    owner: Owner::Specimen,
    form_error: FormError::of(Share::Rough, Share::Elastic),
};
