//! A machine that gives way.

use super::{Effect, FormError, Kind, Owner, Quantity, Share, Stage};

/// The recorded depth contains what the machine yields.
pub const EFFECT: Effect = Effect {
    code: "compliance",
    form: "linear",
    stage: Stage::Machine,
    kind: Kind::Machine,
    assumption: "the machine is rigid",
    signature: "grows with F and dF/dd",
    twins: &["thickness"],
    separated_by: "a press on a stiff block",
    // at the largest force: a machine that yields by more is seen to
    prior: "load cells give way by 0.1 to 0.3 mm at full scale, and a palpation uses a tenth of that",
    quantities: &[Quantity::amplitude("mm_per_N", 0.0, (0.0, 2.0), 0.05, &[0.02, 0.3]).about(0.02).per_force(-1)],
    owner: Owner::All,
    form_error: FormError::of(Share::Outside, Share::Elastic),
};

/// What one step of Newton's method adds to the depth of the ball: recorded depth `x = d + c F(d)`.
#[must_use]
pub fn correction(recorded_mm: f64, depth_mm: f64, force_n: f64, slope_n_per_mm: f64, mm_per_n: f64) -> f64 {
    (recorded_mm - mm_per_n * force_n - depth_mm) / (1.0 + mm_per_n * slope_n_per_mm)
}
